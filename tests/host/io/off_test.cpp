#include <set>
#include <string>
#include <vector>

#include "io/io_support.h"
#include "support/data.h"

using namespace vkmesh;
using namespace vkmesh::test;

TEST_CASE("OFF round trips are lossless for what it holds", "[io][off]") {
  const Channel normal{"normal", 3, ramp<float>(21, 0.1)}, uv{"uv", 2, ramp<float>(14, 0.3)},
      bytes{"color", 4, ramp<std::uint8_t>(28, 9)}, fractions{"color", 3, ramp<float>(21, 0.04)};
  std::vector<IndexedFaceSet> meshes = {icosphere(2), quad_cube()};
  for (const auto& channels : std::vector<std::vector<Channel>>{{},
                                                                {normal},
                                                                {bytes},
                                                                {fractions},
                                                                {uv},
                                                                {normal, bytes, uv},
                                                                {bytes, uv},
                                                                {fractions, uv},
                                                                {normal, uv}}) {
    meshes.push_back(mixed_polygons());
    meshes.back().point_channels = channels;
    meshes.back().face_channels = {{"color", 3, ramp<std::uint8_t>(9, 28)}};
  }
  for (const IndexedFaceSet& mesh : meshes)
    for (const bool gzip : {false, true}) {
      const WriteOptions options = write_as(FileFormat::kOff, FileEncoding::kAscii, gzip);
      const std::string text = encode(mesh, options);
      const MeshFile file = parse_file(text, "a.bin");
      CHECK(file.format == FileFormat::kOff);
      CHECK(file.gzip == gzip);
      CHECK(file.notes.empty());
      require_same(mesh, std::get<IndexedFaceSet>(file.geometry));
      CHECK(encode(std::get<IndexedFaceSet>(file.geometry), options) == text);
    }
}

TEST_CASE("OFF is written as documented", "[io][off]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 0.1f, -2e-9f}};
  mesh.corners = {0, 1, 2};
  mesh.point_channels = {{"uv", 2, ramp<float>(6, 0.25)},
                         {"color", 3, ramp<std::uint8_t>(9, 10)},
                         {"normal", 3, ramp<float>(9, 1)}};
  WriteOptions options = write_as(FileFormat::kOff, FileEncoding::kAscii);
  options.comment = "test";
  CHECK(encode(mesh, options) ==
        "STCNOFF\n3 1 0\n0 0 0 0 1 2 0 10 20 0 0.25\n1 0 0 3 4 5 30 40 50 0.5 0.75\n"
        "0 0.1 -2e-09 6 7 8 60 70 80 1 1.25\n3 0 1 2\n# test\n");
}

TEST_CASE("OFF text is read as real files write it", "[io][off]") {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const IndexedFaceSet mesh = parse("OFF\n3 1 3\n" + body, "a.off");
  CHECK(mesh.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2});
  for (const std::string head :
       {"OFF 3 1 3\n", "OFF\n3 1\n", "# first\n\nOFF # kind\n# second\n 3 1 0 # counts\n\n",
        "OFF\r\n3 1 0\r\n", "\n  OFF\n\t3\t1\t0\n", "3 1 0\n"})
    require_same(mesh, parse(head + body, "a.off"));
  require_same(mesh,
               parse("OFF\n3 1 0\n+0 0 0 #a\n1e0 0 .0\r\n\r\n0 10E-1 0.0 # b\n3  0 1 2\n\n# end", "a.off"));

  const MeshFile more = parse_file("OFF\n3 1 0\n0 0 0 9\n1 0 0 9\n0 1 0\n3 0 1 2\n", "a.off");
  CHECK(sentences(more.notes) ==
        std::vector<std::string>{
            "numbers beyond what the header announces ignored on the lines of 2 vertices"});
}

TEST_CASE("OFF files may hold more than they promise, but not less", "[io][off]") {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const MeshFile more = parse_file("OFF\n3 1 0\n" + body + "3 0 2 1\n\n# end\nanything\n", "a.off");
  CHECK(sentences(more.notes) == std::vector<std::string>{"2 lines behind what the header promises ignored"});
  CHECK(std::get<IndexedFaceSet>(more.geometry).corners == std::vector<std::uint32_t>{0, 1, 2});
  CHECK(parse_error("OFF\n3 2 0\n" + body, "a.off").message ==
        "expected the number of corners of face 1, found the end of the file");
}

TEST_CASE("OFF prefixes say what vertices have", "[io][off]") {
  const auto names = [](const std::string& head, const std::string& numbers) {
    const IndexedFaceSet mesh = parse(head + "\n1 0 0\n1 2 3 " + numbers + "\n", "a.off");
    std::vector<std::string> found;
    for (const Channel& c : mesh.point_channels) found.push_back(c.name);
    return found;
  };
  using Names = std::vector<std::string>;
  CHECK(names("NOFF", "0 0 1") == Names{"normal"});
  CHECK(names("COFF", "1 0 0 1") == Names{"color"});
  CHECK(names("CNOFF", "0 0 1 1 0 0 1") == Names{"normal", "color"});
  CHECK(names("NCOFF", "0 0 1 1 0 0 1") == Names{"normal", "color"});
  CHECK(names("STOFF", "0.5 1") == Names{"uv"});
  CHECK(names("STCNOFF", "0 0 1 1 0 0 0.5 1") == Names{"normal", "color", "uv"});
  for (const char* head : {"4OFF", "nOFF", "4nOFF"})
    CHECK(parse_error(std::string(head) + "\n1 0 0\n1 2 3 4\n", "a.off").message ==
          "only OFF files in three dimensions are read");
}

TEST_CASE("OFF colours are fractions or bytes, and partial ones are named", "[io][off]") {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const auto face_color = [&](const std::string& faces) {
    const MeshFile file = parse_file("OFF\n4 2 0\n" + points + faces, "a.off");
    const auto& channels = std::get<IndexedFaceSet>(file.geometry).face_channels;
    return std::pair(channels.empty() ? ChannelValues{} : channels[0].values, file.notes);
  };
  CHECK(face_color("3 0 1 2 255 0 1\n3 0 2 3 0 0 0\n").first ==
        ChannelValues(std::vector<std::uint8_t>{255, 0, 1, 0, 0, 0}));
  CHECK(face_color("3 0 1 2 1 0 1\n3 0 2 3 0 0 0\n").first ==
        ChannelValues(std::vector<float>{1, 0, 1, 0, 0, 0}));
  CHECK(face_color("3 0 1 2 1 0 0.5\n3 0 2 3 0 0 0\n").first ==
        ChannelValues(std::vector<float>{1, 0, .5, 0, 0, 0}));
  // Faces without a colour are white.
  CHECK(face_color("3 0 1 2 255 0 1\n3 0 2 3\n") ==
        std::pair(
            ChannelValues(std::vector<std::uint8_t>{255, 0, 1, 255, 255, 255}),
            std::vector<FileNote>{{"partial.color", "1 faces without a colour of 3 components made white"}}));
  CHECK(face_color("3 0 1 2\n3 0 2 3 0.5 0 1 0\n") ==
        std::pair(
            ChannelValues(std::vector<float>{1, 1, 1, 1, 0.5f, 0, 1, 0}),
            std::vector<FileNote>{{"partial.color", "1 faces without a colour of 4 components made white"}}));
  CHECK(face_color("3 0 1 2 7\n3 0 2 3\n") ==
        std::pair(ChannelValues{},
                  std::vector<FileNote>{
                      {"dropped.color", "colours of 1 faces ignored: they number colours of a table"}}));
}

TEST_CASE("real OFF, PLY and STL files are read, or refused for a reason", "[io][off][data]") {
  std::size_t read = 0;
  std::set<std::string> refused;
  for (const auto& path : cgal_meshes()) {
    INFO(path);
    const auto file = read_mesh(path);
    if (!file) {
      CHECK(file.error().code == ErrorCode::kUnreadable);
      CHECK((file.error().where.line || file.error().where.byte));
      refused.insert(path.filename().string());
      continue;
    }
    ++read;
    // It holds a face more than it promises.
    if (path.filename() == "prim.off") {
      CHECK(std::get<IndexedFaceSet>(file->geometry).face_count() == 7);
      CHECK(sentences(file->notes) ==
            std::vector<std::string>{"1 lines behind what the header promises ignored"});
    }
    CHECK(path.extension() == "." + name_of(file->format));
    const auto mesh = to_indexed_face_set(*file);
    REQUIRE(mesh);
    CHECK(mesh->points.size() > 0);
    for (const std::uint32_t c : mesh->corners) REQUIRE(c < mesh->points.size());

    // Written as binary PLY and read again it is the same but for colours that were fractions.
    const auto again =
        parse(encode(*mesh, write_as(FileFormat::kPly, FileEncoding::kBinaryLittleEndian)), "a.ply");
    CHECK(again.points == mesh->points);
    CHECK(again.corners == mesh->corners);
    CHECK(again.face_offsets == mesh->face_offsets);
  }
  CHECK(refused.empty());
  CHECK(read + refused.size() == cgal_meshes().size());
  CHECK(read > 100);
}
