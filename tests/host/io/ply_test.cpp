#include "io/ply/ply.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "io/io_support.h"
#include "support/data.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

const std::vector<FileEncoding> kEncodings = {FileEncoding::kAscii, FileEncoding::kBinaryLittleEndian,
                                              FileEncoding::kBinaryBigEndian};

IndexedFaceSet with_channels(IndexedFaceSet mesh) {
  const std::size_t points = mesh.points.size(), faces = mesh.face_count();
  mesh.point_channels = {
      {"normal", 3, ramp<float>(3 * points, 0.1)},  {"color", 4, ramp<std::uint8_t>(4 * points, 3)},
      {"uv", 2, ramp<float>(2 * points, -0.01)},    {"quality", 1, ramp<float>(points, 1e-7)},
      {"label", 1, ramp<std::int16_t>(points, -7)}, {"weight", 2, ramp<double>(2 * points, 0.1)},
      {"flag", 1, ramp<std::int8_t>(points, -1)},   {"id", 1, ramp<std::uint32_t>(points, 1e8)}};
  mesh.face_channels = {{"color", 3, ramp<std::uint8_t>(3 * faces, 5)},
                        {"material", 1, ramp<std::uint16_t>(faces, 1000)},
                        {"group", 1, ramp<std::int32_t>(faces, -100000)}};
  return mesh;
}

}  // namespace

TEST_CASE("PLY round trips are lossless in every encoding", "[io][ply]") {
  const std::vector<IndexedFaceSet> meshes = {icosphere(2), quad_cube(), mixed_polygons(),
                                              with_channels(icosphere(1)), with_channels(mixed_polygons())};
  for (const IndexedFaceSet& mesh : meshes)
    for (const FileEncoding encoding : kEncodings)
      for (const bool gzip : {false, true}) {
        INFO(name_of(encoding) << (gzip ? " gzip" : "") << ", " << mesh.points.size() << " points");
        const WriteOptions options = write_as(FileFormat::kPly, encoding, gzip);
        const std::string bytes = encode(mesh, options);
        const MeshFile file = parse_file(bytes, "a.bin");
        CHECK(file.format == FileFormat::kPly);
        CHECK(file.encoding == encoding);
        CHECK(file.gzip == gzip);
        CHECK(file.notes.empty());
        const IndexedFaceSet& back = std::get<IndexedFaceSet>(file.geometry);
        require_same(mesh, back);
        CHECK(encode(back, options) == bytes);
      }
}

TEST_CASE("PLY is written as documented", "[io][ply]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 0.1f, -2e-9f}};
  mesh.corners = {0, 1, 2};
  mesh.point_channels = {{"normal", 3, ramp<float>(9, 0.5)},
                         {"color", 3, ramp<std::uint8_t>(9, 1)},
                         {"uv", 2, ramp<float>(6, 0.25)},
                         {"quality", 1, ramp<float>(3, 1)}};
  WriteOptions options = write_as(FileFormat::kPly, FileEncoding::kAscii);
  options.comment = "made by a test\nin two lines";
  CHECK(encode(mesh, options) ==
        "ply\nformat ascii 1.0\ncomment made by a test\ncomment in two lines\nelement vertex 3\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property float s\nproperty float t\nproperty float quality\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0.5 1 0 1 2 0 0.25 0\n"
        "1 0 0 1.5 2 2.5 3 4 5 0.5 0.75 1\n"
        "0 0.1 -2e-09 3 3.5 4 6 7 8 1 1.25 2\n"
        "3 0 1 2\n");

  mesh.point_channels.clear();
  const std::string big = encode(mesh, write_as(FileFormat::kPly, FileEncoding::kBinaryBigEndian));
  const std::string body = big.substr(big.find("end_header\n") + 11);
  REQUIRE(body.size() == 3 * 12 + 13);
  CHECK(body.substr(12, 4) == std::string("\x3f\x80\0\0", 4));  // 1.0f
  CHECK(body.substr(36) == std::string("\3\0\0\0\0\0\0\0\1\0\0\0\2", 13));
  const std::string little = encode(mesh, write_as(FileFormat::kPly, FileEncoding::kBinaryLittleEndian));
  CHECK(little.substr(little.find("end_header\n") + 11).substr(36) ==
        std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13));
}

TEST_CASE("a PLY face of more than 255 corners is counted in 32 bits", "[io][ply]") {
  IndexedFaceSet mesh = mixed_polygons();
  for (std::uint32_t i = 0; i < 300; ++i) {
    mesh.corners.push_back(static_cast<std::uint32_t>(mesh.points.size()));
    mesh.points.emplace_back(static_cast<float>(i), static_cast<float>(i * i), 0.0f);
  }
  mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  for (const FileEncoding encoding : kEncodings) {
    const std::string bytes = encode(mesh, write_as(FileFormat::kPly, encoding));
    CHECK(bytes.find("property list uint int vertex_indices\n") != std::string::npos);
    require_same(mesh, parse(bytes, "a.ply"));
  }
}

TEST_CASE("PLY channels that cannot be written are named", "[io][ply]") {
  IndexedFaceSet mesh = icosphere(0);
  mesh.point_channels = {{"two words", 1, ramp<float>(12, 1)},
                         {"x", 1, ramp<float>(12, 1)},
                         {"color", 3, std::vector<float>(36, 0.5f)}};
  mesh.corner_channels = {{"heat", 2, ramp<float>(120, 1)}};
  TemporaryFolder folder;
  const auto notes = write_mesh(folder.path() / "a.ply", mesh,
                                write_as(FileFormat::kPly, FileEncoding::kBinaryLittleEndian));
  REQUIRE(notes);
  CHECK(sentences(*notes) ==
        std::vector<std::string>{"point channel 'two words' left out: its name is not one word",
                                 "point channel 'x' left out: its property names are taken",
                                 "point channel 'color' rounded to 8 bits",
                                 "corner channel 'heat' left out: PLY holds uv of corners"});
  const IndexedFaceSet back = parse(read_bytes(folder.path() / "a.ply"), "a.ply");
  REQUIRE(back.point_channels.size() == 1);
  CHECK(std::get<std::vector<std::uint8_t>>(back.point_channels[0].values) ==
        std::vector<std::uint8_t>(36, 128));
}

TEST_CASE("PLY text is read as real files write it", "[io][ply]") {
  const std::string unix_text =
      "ply\nformat ascii 1.0\ncomment a  comment\nobj_info anything\nelement vertex 3\nproperty float32 x\n"
      "property double y\nproperty int z\nelement face 1\nproperty list uint8 uint32 "
      "vertex_index\nend_header\n"
      "0 0 0\n  +1.5e+0\t-2.5E-1 +3  \n\n1e-60 .5 -0\n3 0 1 2\n\n";
  const IndexedFaceSet mesh = parse(unix_text, "a.ply");
  CHECK(mesh.points == std::vector<Vec3>{{0, 0, 0}, {1.5f, -0.25f, 3}, {0, 0.5f, 0}});
  CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2});
  for (const char* line_end : {"\r\n", "\r"}) {
    std::string other;
    for (const char c : unix_text) other += c == '\n' ? std::string(line_end) : std::string(1, c);
    require_same(mesh, parse(other, "a.ply"));
  }
  require_same(mesh, parse(unix_text.substr(0, unix_text.size() - 2), "a.ply"));
}

TEST_CASE("a PLY body begins right after the header's line end", "[io][ply]") {
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    std::string file;
    for (const char* line : {"ply", "format binary_little_endian 1.0", "element vertex 1", "property uchar x",
                             "property uchar y", "property uchar z", "end_header"})
      file += line + line_end;
    const IndexedFaceSet mesh = parse(file + "\n\r\n", "a.ply");
    CHECK(mesh.points == std::vector<Vec3>{{10, 13, 10}});
  }
}

TEST_CASE("PLY properties become channels", "[io][ply]") {
  const IndexedFaceSet mesh = parse(
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float nz\nproperty float x\nproperty uint8 green\n"
      "property float y\nproperty float nx\nproperty uint8 red\nproperty float z\nproperty float ny\n"
      "property uint8 blue\nproperty float texture_u\nproperty float texture_v\nproperty short f_0\n"
      "property short f_1\nproperty short f_2\nproperty double confidence\nproperty float g_0\nend_header\n"
      "3 1 8 2 1 7 3 2 9 0.5 0.25 -1 -2 -3 1e-300 nan\n"
      "6 4 11 5 4 10 6 5 12 0.75 1 -4 -5 -6 0.1 inf\n",
      "a.ply");
  CHECK(mesh.points == std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  const auto values = [&](const char* name, auto type, unsigned components) {
    const Channel* c = find_channel(mesh.point_channels, name);
    REQUIRE(c != nullptr);
    CHECK(c->components == components);
    REQUIRE(std::holds_alternative<std::vector<decltype(type)>>(c->values));
    return std::get<std::vector<decltype(type)>>(c->values);
  };
  CHECK(values("normal", 0.0f, 3) == std::vector<float>{1, 2, 3, 4, 5, 6});
  CHECK(values("color", std::uint8_t{}, 3) == std::vector<std::uint8_t>{7, 8, 9, 10, 11, 12});
  CHECK(values("uv", 0.0f, 2) == std::vector<float>{0.5f, 0.25f, 0.75f, 1});
  CHECK(values("f", std::int16_t{}, 3) == std::vector<std::int16_t>{-1, -2, -3, -4, -5, -6});
  CHECK(values("confidence", 0.0, 1) == std::vector<double>{1e-300, 0.1});
  const auto g = values("g_0", 0.0f, 1);
  CHECK(g[0] != g[0]);
  CHECK(g[1] > 1e38f);
  CHECK(mesh.point_channels.size() == 6);
}

TEST_CASE("PLY content that is not kept is passed over and named", "[io][ply]") {
  const std::string header =
      " 1.0\nelement camera 2\nproperty list uchar short view\nproperty int id\nelement face 2\n"
      "property list uchar float texnumbers\nproperty uchar part\nproperty list ushort short vertex_indices\n"
      "element nothing 1000000000000\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "property list int double marks\nelement edge 1\nproperty int vertex1\nproperty int "
      "vertex2\nend_header\n";
  IndexedFaceSet expected;
  expected.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  expected.corners = {0, 1, 2, 0, 1, 2, 3};
  expected.face_offsets = {0, 3, 7};
  expected.face_channels = {{"part", 1, std::vector<std::uint8_t>{5, 6}}};
  const std::vector<std::string> notes = {
      "2 of element 'camera' ignored", "list property 'texnumbers' of element 'face' ignored",
      "1000000000000 of element 'nothing' ignored", "list property 'marks' of element 'vertex' ignored",
      "1 of element 'edge' ignored"};

  std::string ascii = "ply\nformat ascii" + header +
                      "2 7 8 1\n0 2\n6 0 0 1 0 1 1 5 3 0 1 2\n0 6 4 0 1 2 3\n"
                      "0 0 0 0\n1 0 0 2 0.5 0.25\n1 1 0 0\n0 1 0 1 9\n0 1\n";
  const MeshFile text = parse_file(ascii, "a.ply");
  require_same(expected, std::get<IndexedFaceSet>(text.geometry));
  CHECK(sentences(text.notes) == notes);

  for (const bool big : {false, true}) {
    std::string binary = "ply\nformat binary_" + std::string(big ? "big" : "little") + "_endian" + header;
    const auto put = [&](auto value) {
      std::string bytes(reinterpret_cast<const char*>(&value), sizeof(value));
      if (big) std::reverse(bytes.begin(), bytes.end());
      binary += bytes;
    };
    const auto u8 = [&](int v) { put(static_cast<std::uint8_t>(v)); };
    const auto i16 = [&](int v) { put(static_cast<std::int16_t>(v)); };
    u8(2), i16(7), i16(8), put(1);
    u8(0), put(2);
    u8(6);
    for (int i = 0; i < 6; ++i) put(0.5f);
    u8(5), i16(3), i16(0), i16(1), i16(2);
    u8(0), u8(6), i16(4), i16(0), i16(1), i16(2), i16(3);
    for (const Vec3& p : expected.points) {
      put(p.x), put(p.y), put(p.z), put(1);
      put(0.25);
    }
    put(0), put(1);
    const MeshFile file = parse_file(binary, "a.ply");
    require_same(expected, std::get<IndexedFaceSet>(file.geometry));
    CHECK(sentences(file.notes) == notes);
  }
}

TEST_CASE("PLY keeps the extremes of every scalar type", "[io][ply]") {
  IndexedFaceSet mesh = icosphere(0);
  const auto add = [&](const std::string& name, auto type) {
    using T = decltype(type);
    using Limits = std::numeric_limits<T>;
    // Twelve points.
    std::vector<T> values = {Limits::lowest(), Limits::max(), Limits::min(), T(0), T(1), T(100), T(7)};
    if constexpr (std::is_floating_point_v<T>)
      values = {Limits::lowest(), Limits::max(), Limits::min(),      Limits::denorm_min(), T(-0.0),
                T(0.1),           T(1) / 3,      Limits::infinity(), -Limits::infinity()};
    values.resize(mesh.points.size());
    mesh.point_channels.push_back({name, 1, values});
    std::vector<T> reversed(values.rbegin(), values.rend());
    reversed.resize(mesh.face_count());
    mesh.face_channels.push_back({name, 1, reversed});
  };
  add("int8", std::int8_t{}), add("uint8", std::uint8_t{}), add("int16", std::int16_t{});
  add("uint16", std::uint16_t{}), add("int32", std::int32_t{}), add("uint32", std::uint32_t{});
  add("float", 0.0f), add("double", 0.0);
  for (const FileEncoding encoding : kEncodings) {
    INFO(name_of(encoding));
    const IndexedFaceSet back = parse(encode(mesh, write_as(FileFormat::kPly, encoding)), "a.ply");
    require_same(mesh, back);
    for (std::size_t i = 0; i < mesh.point_channels.size(); ++i)
      std::visit(
          [&](const auto& values) {
            const auto& other = std::get<std::decay_t<decltype(values)>>(back.point_channels[i].values);
            // 0 equals -0, but its bits do not.
            CHECK(std::memcmp(values.data(), other.data(), values.size() * sizeof(values[0])) == 0);
          },
          mesh.point_channels[i].values);
  }
}

namespace {

/// What parsing in blocks of that size gives, as one string: all that is kept, or the error.
std::string parsed_in_blocks(const std::string& content, std::size_t block_bytes) {
  const Progress progress;
  const auto file = detail::ply::parse({content, "a.ply", progress, 0}, block_bytes);
  if (!file) return file.error().describe();
  std::string text;
  for (const FileNote& note : file->notes) text += note.sentence + "\n";
  const auto& mesh = std::get<IndexedFaceSet>(file->geometry);
  text += encode(mesh, write_as(FileFormat::kPly, FileEncoding::kBinaryLittleEndian));
  return text + (mesh.face_offsets.empty() ? "triangles" : "polygons");
}

const std::vector<std::size_t> kBlockSizes = {1, 13, 100, 1000};

// The address sanitizer makes each of many small parses ten times as long.
#ifdef VKMESH_ADDRESS_SANITIZER
constexpr std::size_t kStride = 37;
#else
constexpr std::size_t kStride = 1;
#endif

}  // namespace

TEST_CASE("PLY read in blocks is the same as read in one go", "[io][ply]") {
  IndexedFaceSet polygons = mixed_polygons();
  polygons.corners.insert(polygons.corners.end(), {0, 1, 2, 1, 2, 3});
  polygons.face_offsets.insert(polygons.face_offsets.end(), {15, 18});
  for (const IndexedFaceSet& mesh : {with_channels(icosphere(2)), icosphere(1), with_channels(polygons)})
    for (const FileEncoding encoding : kEncodings) {
      const std::string content = encode(mesh, write_as(FileFormat::kPly, encoding));
      const std::string whole = parsed_in_blocks(content, std::string::npos);
      REQUIRE(whole.ends_with(mesh.is_triangles() ? "triangles" : "polygons"));
      for (const std::size_t bytes : kBlockSizes) CHECK(parsed_in_blocks(content, bytes) == whole);
      if (encoding != FileEncoding::kAscii) continue;
      // Other line ends, and lines that hold nothing, which are no elements.
      for (const std::string line_end : {"\r\n", "\r", "\n \n\t\r\n"}) {
        const std::size_t body = content.find("end_header\n") + 11;
        std::string other;
        for (std::size_t i = 0; i < content.size(); ++i)
          if (content[i] == '\n')
            other += i < body ? line_end.substr(0, line_end.find(' ')) : line_end;
          else
            other += content[i];
        for (const std::size_t bytes : kBlockSizes) CHECK(parsed_in_blocks(other, bytes) == whole);
      }
    }
}

TEST_CASE("PLY read in blocks tells the first error of the file", "[io][ply]") {
  for (const FileEncoding encoding : kEncodings) {
    const std::string content = encode(with_channels(mixed_polygons()), write_as(FileFormat::kPly, encoding));
    const std::size_t body = content.find("end_header\n") + 11;
    std::size_t errors = 0, differences = 0;
    const auto compare = [&](const std::string& broken) {
      const std::string whole = parsed_in_blocks(broken, std::string::npos);
      errors += whole.starts_with("a.ply") ? 1 : 0;
      for (const std::size_t bytes : kBlockSizes)
        differences += parsed_in_blocks(broken, bytes) == whole ? 0 : 1;
    };
    for (std::size_t at = body; at < content.size(); at += kStride) {
      compare(content.substr(0, at));
      for (const std::string with : {"", "x", "9", "\n", "-", "\xff"}) {
        std::string broken = content;
        compare(broken.replace(at, 1, with));
        // A second error, behind the first.
        broken.replace(std::min(at + 40, broken.size() - 1), 1, "y");
        compare(broken);
      }
    }
    INFO(name_of(encoding));
    CHECK(errors > (content.size() - body) / kStride);
    CHECK(differences == 0);
  }
}

TEST_CASE("triangles before and after a quad are read alike from binary PLY", "[io][ply]") {
  // The packed reading of triangles ends at the quad, the general one goes on.
  IndexedFaceSet mesh = icosphere(1);
  mesh.face_offsets.clear();
  for (std::uint32_t f = 0; f <= 80; ++f) mesh.face_offsets.push_back(3 * f);
  mesh.corners.insert(mesh.corners.begin() + 30, {0, 1, 2, 3});
  for (std::size_t f = 11; f < mesh.face_offsets.size(); ++f) mesh.face_offsets[f] += 4;
  mesh.face_offsets.insert(mesh.face_offsets.begin() + 11, 34);
  require_same(mesh,
               parse(encode(mesh, write_as(FileFormat::kPly, FileEncoding::kBinaryLittleEndian)), "a.ply"));
}

TEST_CASE("the dragon is the same from text and binary PLY", "[io][ply][data]") {
  auto file = read_mesh(dragon());
  REQUIRE(file);
  CHECK(file->gzip);
  CHECK(file->encoding == FileEncoding::kAscii);
  const IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file->geometry);
  CHECK(mesh.points.size() == 437645);
  CHECK(mesh.face_count() == 871414);
  CHECK(mesh.is_triangles());
  CHECK(mesh.points.front() == Vec3(0.032027f, 0.056575f, -0.0503644f));
  CHECK(std::vector(mesh.corners.end() - 3, mesh.corners.end()) ==
        std::vector<std::uint32_t>{435598, 435560, 435559});
  TemporaryFolder folder;
  const auto path = folder.path() / "dragon.ply";
  const auto options = write_options_for(path);
  REQUIRE(options);
  REQUIRE(write_mesh(path, mesh, *options));
  const auto back = read_mesh(path);
  REQUIRE(back);
  CHECK(back->encoding == FileEncoding::kBinaryLittleEndian);
  require_same(mesh, std::get<IndexedFaceSet>(back->geometry));
}

TEST_CASE("reading tells its progress and can be interrupted", "[io][ply]") {
  TemporaryFolder folder;
  const auto path = folder.path() / "a.ply.gz";
  write_bytes(path, encode(icosphere(4), write_as(FileFormat::kPly, FileEncoding::kAscii, true)));
  ReadOptions options;
  std::vector<double> told;
  options.progress = [&](double fraction) {
    told.push_back(fraction);
    return true;
  };
  REQUIRE(read_mesh(path, options));
  REQUIRE(told.size() >= 2);
  CHECK(std::is_sorted(told.begin(), told.end()));
  CHECK(told.front() >= 0);
  CHECK(told.back() <= 1);
  for (std::size_t stop = 0; stop < told.size(); ++stop) {
    std::size_t calls = 0;
    options.progress = [&](double) { return calls++ < stop; };
    const auto stopped = read_mesh(path, options);
    REQUIRE_FALSE(stopped);
    CHECK(stopped.error().code == ErrorCode::kInterrupted);
  }
}

TEST_CASE("a PLY block that holds two elements is parted between them", "[io][ply]") {
  // Each line of a vertex would also do as a face.
  std::string content =
      "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\n"
      "property float q\nelement face 9\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 9; ++i) content += "3 0 1 2\n";
  for (int i = 0; i < 9; ++i) content += "3 8 7 6\n";
  const std::string whole = parsed_in_blocks(content, std::string::npos);
  for (std::size_t bytes = 1; bytes < 100; ++bytes) CHECK(parsed_in_blocks(content, bytes) == whole);
}
