#include <string>
#include <vector>

#include "io/io_support.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

const char* kSquarePoints = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("OBJ round trips are lossless for what it holds", "[io][obj]") {
  IndexedFaceSet attributed = mixed_polygons();
  attributed.point_channels = {{"normal", 3, ramp<float>(21, 0.1)}, {"uv", 2, ramp<float>(14, 0.3)}};
  IndexedFaceSet cornered = quad_cube();
  cornered.corner_channels = {{"normal", 3, ramp<float>(72, 0.1)}, {"uv", 2, std::vector<float>(48, 0.5f)}};
  IndexedFaceSet only_uv = icosphere(0);
  only_uv.point_channels = {{"uv", 2, ramp<float>(24, 0.3)}};
  IndexedFaceSet only_normal = icosphere(0);
  only_normal.point_channels = {{"normal", 3, ramp<float>(36, 0.3)}};
  IndexedFaceSet cloud;
  cloud.points = icosphere(0).points;
  cloud.point_channels = {{"normal", 3, ramp<float>(36, 0.3)}, {"color", 3, ramp<float>(36, 0.01)}};
  for (const IndexedFaceSet& mesh :
       {icosphere(2), quad_cube(), mixed_polygons(), attributed, cornered, only_uv, only_normal, cloud})
    for (const bool gzip : {false, true}) {
      const WriteOptions options = write_as(FileFormat::kObj, FileEncoding::kAscii, gzip);
      const std::string bytes = encode(mesh, options);
      const MeshFile file = parse_file(bytes, "a.obj");
      CHECK(file.format == FileFormat::kObj);
      CHECK(file.gzip == gzip);
      CHECK(file.notes.empty());
      require_same(mesh, std::get<IndexedFaceSet>(file.geometry));
      CHECK(encode(std::get<IndexedFaceSet>(file.geometry), options) == bytes);
    }
}

TEST_CASE("OBJ is written as documented", "[io][obj]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 0.1f, -2e-9f}};
  mesh.corners = {0, 1, 2};
  mesh.point_channels = {{"normal", 3, ramp<float>(9, 0.5)}};
  mesh.corner_channels = {{"uv", 2, std::vector<float>{0, 0, 1, 0, 0, 0}}};
  WriteOptions options = write_as(FileFormat::kObj, FileEncoding::kAscii);
  options.comment = "test";
  CHECK(encode(mesh, options) ==
        "# test\nv 0 0 0\nv 1 0 0\nv 0 0.1 -2e-09\nvt 0 0\nvt 1 0\nvn 0 0.5 1\nvn 1.5 2 2.5\nvn 3 3.5 4\n"
        "f 1/1/1 2/2/2 3/1/3\n");
}

TEST_CASE("OBJ takes every form of index", "[io][obj]") {
  const std::vector<std::uint32_t> quad = {0, 1, 2, 3};
  for (const char* face : {"f 1 2 3 4\n", "f -4 -3 -2 -1\n", "f 1 -3 3 -1", "f +1 2\t3 4  # comment\n",
                           "f 1 2 \\\n3 4\n", "f 1 2 \\\r\n  3 \\\n 4\r\n", "f 1 2\\\n 3 4\n"})
    CHECK(parse(std::string(kSquarePoints) + face, "a.obj").corners == quad);

  const std::string attributes = "vt 0.5 1\nvt 0.25\nvt 1 1 0\nvn 0 0 1\nvn 0 1 0\n";
  const IndexedFaceSet all = parse(kSquarePoints + attributes + "f 1/1/1 2/2/-1 3/3/1\n", "a.obj");
  REQUIRE(all.corner_channels.size() == 2);
  CHECK(std::get<std::vector<float>>(find_channel(all.corner_channels, "uv")->values) ==
        std::vector<float>{0.5f, 1, 0.25f, 0, 1, 1});
  CHECK(std::get<std::vector<float>>(find_channel(all.corner_channels, "normal")->values) ==
        std::vector<float>{0, 0, 1, 0, 1, 0, 0, 0, 1});
  const IndexedFaceSet uv = parse(kSquarePoints + attributes + "f 1/1 2/1/ 3/-3\n", "a.obj");
  REQUIRE(uv.corner_channels.size() == 1);
  CHECK(std::get<std::vector<float>>(uv.corner_channels[0].values) ==
        std::vector<float>{0.5f, 1, 0.5f, 1, 0.5f, 1});
  const IndexedFaceSet normal = parse(kSquarePoints + attributes + "f 1//1 2//2 3//2\n", "a.obj");
  REQUIRE(normal.corner_channels.size() == 1);
  CHECK(normal.corner_channels[0].name == "normal");
}

TEST_CASE("an OBJ face may precede its vertices", "[io][obj]") {
  CHECK(parse(std::string("f 1 2 3\n") + kSquarePoints, "a.obj").corners ==
        std::vector<std::uint32_t>{0, 1, 2});
  const Error error = parse_error(std::string("f 1 2 3\nf 1 2 5\n") + kSquarePoints, "a.obj");
  CHECK(error.where.line == 2u);
  CHECK(error.message == "a face names 'v' 5, but there are 4");
}

TEST_CASE("OBJ content that is not kept is named", "[io][obj]") {
  const MeshFile file = parse_file(
      std::string("mtllib a b.mtl\no thing\nversion 1\ng one two\nusemtl red\ns off\n") + kSquarePoints +
          "vn 0 0 1\nvt 0 0\nf 1//1 2//1 3//1\nf 1 2\nf 1 3 4\nl 1 2\nl 2 3\np 1\ncurv 0 1 \\\n1 "
          "2\nv 1 2 3 0.5\n",
      "a.obj");
  CHECK(sentences(file.notes) ==
        std::vector<std::string>{"1 'vt' lines ignored: no corner of a face names one",
                                 "3 corners without 'normal' got 0",
                                 "1 face of fewer than three corners skipped", "1 vertex weights ignored",
                                 "1 'curv' lines ignored", "2 'l' lines ignored", "1 'p' lines ignored",
                                 "1 's' lines ignored", "1 'version' lines ignored"});
  const IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file.geometry);
  CHECK(mesh.face_count() == 2);
  CHECK(mesh.points.size() == 5);
  REQUIRE(mesh.corner_channels.size() == 1);
  CHECK(mesh.corner_channels[0].values ==
        ChannelValues(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  CHECK(file.material_libraries == std::vector<std::string>{"a b.mtl"});
}

TEST_CASE("OBJ materials and groups are labels of faces", "[io][obj]") {
  using Numbers = std::vector<std::uint32_t>;
  using Labels = std::vector<std::string>;
  const std::string face = "f 1 2 3\n";
  const IndexedFaceSet mesh = parse(kSquarePoints + face + "usemtl  red paint \t# a comment\ng top\n" + face +
                                        face + "usemtl blue\no side\n" + face +
                                        "usemtl red paint\nusemtl unused\nusemtl\n" + face + "g top\n" + face,
                                    "a.obj");
  const Channel* material = find_channel(mesh.face_channels, "material");
  REQUIRE(material != nullptr);
  CHECK(material->components == 1);
  CHECK(material->labels == Labels{"", "red paint", "blue"});
  CHECK(material->values == ChannelValues(Numbers{0, 1, 1, 2, 0, 0}));
  const Channel* group = find_channel(mesh.face_channels, "group");
  REQUIRE(group != nullptr);
  CHECK(group->labels == Labels{"", "top"});
  CHECK(group->values == ChannelValues(Numbers{0, 1, 1, 1, 1, 1}));
  const Channel* object = find_channel(mesh.face_channels, "object");
  REQUIRE(object != nullptr);
  CHECK(object->labels == Labels{"", "side"});
  CHECK(object->values == ChannelValues(Numbers{0, 0, 0, 1, 1, 1}));

  const WriteOptions options = write_as(FileFormat::kObj, FileEncoding::kAscii);
  const std::string text = encode(mesh, options);
  CHECK(text == std::string(kSquarePoints) +
                    "f 1 2 3\ng top\nusemtl red paint\nf 1 2 3\nf 1 2 3\no side\nusemtl blue\n"
                    "f 1 2 3\nusemtl\nf 1 2 3\nf 1 2 3\n");
  const IndexedFaceSet again = parse(text, "a.obj");
  require_same(mesh, again);
  for (const char* name : {"material", "object", "group"})
    CHECK(find_channel(again.face_channels, name)->labels == find_channel(mesh.face_channels, name)->labels);

  // A name before the first face needs no empty one; names without faces are none.
  CHECK(parse(std::string("usemtl a\n") + kSquarePoints + face, "a.obj").face_channels[0].labels ==
        Labels{"a"});
  CHECK(parse(kSquarePoints + face + "usemtl a\n", "a.obj").face_channels.empty());
}

TEST_CASE("labels that OBJ cannot hold are named", "[io][obj]") {
  TemporaryFolder folder;
  const auto path = folder.path() / "a.obj";
  const auto left_out = [&](Channel channel) {
    IndexedFaceSet mesh = tetrahedron();
    mesh.face_channels = {std::move(channel)};
    const auto notes = write_mesh(path, mesh, write_as(FileFormat::kObj, FileEncoding::kAscii));
    REQUIRE(notes);
    REQUIRE(read_mesh(path));
    return notes->size();
  };
  using Numbers = std::vector<std::int32_t>;
  CHECK(left_out({"material", 1, Numbers{0, 1, 0, 1}, {"a", "b c"}}) == 0);
  CHECK(left_out({"group", 1, std::vector<std::uint8_t>{0, 1, 0, 1}, {"a", "b"}}) == 0);
  CHECK(left_out({"material", 1, Numbers{0, 1, 0, 1}, {"Grey #1", "#ff0000"}}) == 0);
  CHECK(left_out({"material", 1, Numbers{0, 1, 2, 1}, {"a", "b"}}) == 1);
  CHECK(left_out({"material", 1, Numbers{0, 1, -1, 1}, {"a", "b"}}) == 1);
  CHECK(left_out({"material", 1, Numbers{0, 1, 0, 1}, {}}) == 1);
  CHECK(left_out({"material", 1, std::vector<float>(4), {"a"}}) == 1);
  CHECK(left_out({"other", 1, Numbers{0, 1, 0, 1}, {"a", "b"}}) == 1);
  for (const char* label : {"a # b", "a\nf 1 2 3", "a\\", " a", "a "})
    CHECK(left_out({"material", 1, Numbers(4), {label}}) == 1);
}

TEST_CASE("OBJ vertex colours are fractions or bytes", "[io][obj]") {
  const IndexedFaceSet fractions = parse("v 0 0 0 1 0.5 0\nv 0 0 1 0 0 1\n", "a.obj");
  CHECK(fractions.point_channels[0].values == ChannelValues(std::vector<float>{1, 0.5f, 0, 0, 0, 1}));
  const IndexedFaceSet bytes = parse("v 0 0 0 255 128 0\nv 0 0 1 0 0 1\n", "a.obj");
  CHECK(bytes.point_channels[0].values == ChannelValues(std::vector<std::uint8_t>{255, 128, 0, 0, 0, 1}));
  const MeshFile some = parse_file("v 0 0 1\nv 0 0 0 1 0.5 0\nv 0 0 2\n", "a.obj");
  CHECK(some.notes == std::vector<FileNote>{{"partial.color", "2 vertices without a colour made white"}});
  CHECK(std::get<IndexedFaceSet>(some.geometry).point_channels[0].values ==
        ChannelValues(std::vector<float>{1, 1, 1, 1, 0.5f, 0, 1, 1, 1}));
}
