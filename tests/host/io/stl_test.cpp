#include <cstring>
#include <string>
#include <vector>

#include "io/io_support.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

const PolygonSoup& soup_of(const MeshFile& file) {
  return std::get<PolygonSoup>(file.geometry);
}

/// Points in the order in which faces name them, as welding numbers them.
IndexedFaceSet in_order_of_use(const IndexedFaceSet& mesh) {
  IndexedFaceSet out;
  std::vector<std::uint32_t> number(mesh.points.size(), 0xffffffffu);
  for (const std::uint32_t c : mesh.corners) {
    if (number[c] == 0xffffffffu) {
      number[c] = static_cast<std::uint32_t>(out.points.size());
      out.points.push_back(mesh.points[c]);
    }
    out.corners.push_back(number[c]);
  }
  return out;
}

}  // namespace

TEST_CASE("STL round trips keep every triangle", "[io][stl]") {
  for (const IndexedFaceSet& mesh : {icosphere(2), cube(), torus(8, 6)})
    for (const FileEncoding encoding : {FileEncoding::kAscii, FileEncoding::kBinaryLittleEndian})
      for (const bool gzip : {false, true}) {
        const WriteOptions options = write_as(FileFormat::kStl, encoding, gzip);
        const std::string bytes = encode(mesh, options);
        const MeshFile file = parse_file(bytes, "a.bin");
        CHECK(file.format == FileFormat::kStl);
        CHECK(file.encoding == encoding);
        CHECK(file.gzip == gzip);
        CHECK(file.notes.empty());
        REQUIRE(soup_of(file).corners.size() == mesh.corners.size());
        for (std::size_t c = 0; c < mesh.corners.size(); ++c)
          CHECK(soup_of(file).corners[c] == mesh.points[mesh.corners[c]]);
        const IndexedFaceSet back = parse(bytes, "a.bin");
        const IndexedFaceSet expected = in_order_of_use(mesh);
        CHECK(back.points == expected.points);
        CHECK(back.corners == expected.corners);
        CHECK(back.is_triangles());
        CHECK(encode(back, options) == bytes);
      }
}

TEST_CASE("STL facet normals follow from the positions", "[io][stl]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {4, 0, 0}};
  mesh.corners = {0, 1, 2, 0, 2, 1, 0, 1, 3};
  mesh.face_channels = {{"attribute", 1, std::vector<std::uint16_t>{0, 7, 65535}}};
  const std::string binary = encode(mesh, write_as(FileFormat::kStl, FileEncoding::kBinaryLittleEndian));
  CHECK(binary.size() == 84 + 3 * 50);
  const MeshFile file = parse_file(binary, "a.stl");
  const auto& channels = soup_of(file).face_channels;
  REQUIRE(channels.size() == 2);
  CHECK(channels[0].values == ChannelValues(std::vector<float>{0, 0, 1, 0, 0, -1, 0, 0, 0}));
  CHECK(channels[1].values == mesh.face_channels[0].values);

  WriteOptions options = write_as(FileFormat::kStl, FileEncoding::kAscii);
  options.comment = "thing";
  mesh.corners.resize(3);
  mesh.face_channels.clear();
  CHECK(encode(mesh, options) ==
        "solid thing\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 3 "
        "0\nendloop\nendfacet\n"
        "endsolid thing\n");
}

TEST_CASE("the size tells binary STL, whatever its header says", "[io][stl]") {
  std::string bytes = encode(icosphere(1), write_as(FileFormat::kStl, FileEncoding::kBinaryLittleEndian));
  for (const std::string word : {"solid ", "OFF ", "v 1 2 3\n"}) {
    bytes.replace(0, word.size(), word);
    const MeshFile file = parse_file(bytes, "model");
    CHECK(file.encoding == FileEncoding::kBinaryLittleEndian);
    CHECK(soup_of(file).face_count() == 80);
  }
  WriteOptions options = write_as(FileFormat::kStl, FileEncoding::kBinaryLittleEndian);
  options.comment = "solid rock";
  CHECK(encode(icosphere(0), options).substr(0, 17) == "binary solid rock");
}

TEST_CASE("STL text is read as real files write it", "[io][stl]") {
  const char* facet =
      "  FACET NORMAL nan 0 -1.0e+000\r\n    OUTER LOOP\r\n      VERTEX +0 0 0\r\n\tvertex 1 0 0\n vertex 0 "
      "1 0\n"
      "endloop\nendfacet\n";
  const MeshFile two = parse_file(
      std::string("solid a b c\n") + facet + "endsolid\n\nsolid\n" + facet + "endsolid b", "a.stl");
  CHECK(soup_of(two).face_count() == 2);
  CHECK(codes(two.notes) == std::vector<std::string>{"dropped.solids", "nonfinite.normal"});
  const MeshFile quad = parse_file(
      "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0 endloop "
      "endfacet\n"
      "endsolid\n",
      "a.stl");
  CHECK(soup_of(quad).face_offsets == std::vector<std::uint32_t>{0, 4});
}

TEST_CASE("polygons are not written to STL", "[io][stl]") {
  const auto bytes = encode_mesh(quad_cube(), write_as(FileFormat::kStl, FileEncoding::kBinaryLittleEndian));
  REQUIRE_FALSE(bytes);
  CHECK(bytes.error().code == ErrorCode::kUnsuitable);
  CHECK(bytes.error().message ==
        "face 0 has 4 corners and STL holds triangles only: triangulate the mesh first");
  const auto big = encode_mesh(cube(), write_as(FileFormat::kStl, FileEncoding::kBinaryBigEndian));
  REQUIRE_FALSE(big);
  CHECK(big.error().code == ErrorCode::kUsage);
}
