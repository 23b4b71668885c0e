#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "io/io_support.h"
#include "support/data.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

using Floats = std::vector<float>;

const std::string kHead = "#Inventor V2.1 ascii\n";
const std::string kFivePoints = "Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0, 0 0 1 ] }\n";
const std::string kTriangle = "IndexedFaceSet { coordIndex [ 0, 1, 2, -1 ] }\n";

MeshFile scene_file(const std::string& body) {
  return parse_file(kHead + body, "a.iv");
}

IndexedFaceSet scene(const std::string& body) {
  return std::get<IndexedFaceSet>(scene_file(body).geometry);
}

Error scene_error(const std::string& body) {
  return parse_error(kHead + body, "a.iv");
}

/// The first point of a triangle that `body` transforms.
Vec3 moved(const std::string& body, const std::string& point = "1 2 3") {
  const IndexedFaceSet mesh =
      scene(body + " Coordinate3 { point [ " + point + ", 0 0 0, 5 5 5 ] } " + kTriangle);
  REQUIRE(mesh.points.size() == 3);
  return mesh.points[0];
}

void check_near(const Vec3& a, const Vec3& b) {
  INFO(a.x << " " << a.y << " " << a.z);
  for (int axis = 0; axis < 3; ++axis) CHECK(a[axis] == Approx(b[axis]).margin(1e-6));
}

const std::string kEverything = R"(Separator { # a comment, with a comma
  renderCaching OFF
  DEF Points Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }
  Transform { translation 1 2 3 rotation 0 0 1 1.5 scaleFactor 1 2 1 center 1 1 1 }
  Normal { vector [ 0 0 1, 0 1 0 ] }
  NormalBinding { value PER_VERTEX_INDEXED }
  Material { diffuseColor [ 1 0 0, 0 1 0 ] }
  MaterialBinding { value PER_FACE }
  IndexedFaceSet { coordIndex [ 0, 1, 2, -1, 0, 2, 3, -1 ] normalIndex [ 0, 0, 1, -1, 1, 0, 1, -1 ] }
  Switch { whichChild 0 Group { USE Points PointSet { numPoints 2 } } }
  IndexedTriangleStripSet { vertexProperty VertexProperty { vertex [ 0 0 0, 1 0 0, 0 1 0, 1 1 0 ]
    orderedRGBA [ 0xff0000ff, 0x00ff0080 ] } coordIndex [ 0, 1, 2, 3, -1 ] }
  Cube { width 2 }
})";

}  // namespace

TEST_CASE("the mission's tetrahedron is read", "[io][inventor]") {
  const MeshFile file = parse_file(R"(#Inventor V2.1 ascii
VertexProperty { vertex [      0.0      0.0  1.73205,
                          0.0   1.63299 -0.57735,
                          -1.41421 -0.816497 -0.57735,
                          1.41421 -0.816497 -0.57735 ] }
IndexedFaceSet { coordIndex [ 0, 1, 2, -1,
                              0, 2, 3, -1,
                              0, 3, 1, -1,
                              1, 3, 2, -1 ] }
)",
                                   "a.bin");
  CHECK(file.format == FileFormat::kInventor);
  CHECK(file.encoding == FileEncoding::kAscii);
  CHECK(file.notes.empty());
  const IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file.geometry);
  CHECK(mesh.points == std::vector<Vec3>{{0, 0, 1.73205f},
                                         {0, 1.63299f, -0.57735f},
                                         {-1.41421f, -0.816497f, -0.57735f},
                                         {1.41421f, -0.816497f, -0.57735f}});
  CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2});
  CHECK(mesh.is_triangles());
}

TEST_CASE("Inventor headers are told apart", "[io][inventor]") {
  const std::string body = kFivePoints + kTriangle;
  CHECK(parse_file("#Inventor V2.0 ascii  \r\n" + body, "a").format == FileFormat::kInventor);
  CHECK(parse_file("#VRML V1.0 ascii\n" + body, "a").format == FileFormat::kVrml1);
  CHECK_THAT(parse_error("#Inventor V1.0 binary\n", "a.iv").message, Catch::Contains("V2.0 and V2.1"));
  CHECK_THAT(parse_error("#Inventor V2.1 binary\n", "a.iv").message, Catch::Contains("neither polygons"));
  CHECK(parse_file("#Inventor V1.0 ascii\n" + body, "a.iv").format == FileFormat::kInventor);
  CHECK_THAT(parse_error("#Inventor V3.0 ascii\n" + body, "a.iv").message,
             Catch::Contains("only Inventor in ascii"));
  CHECK_THAT(parse_error("#VRML V3.0 utf8\n" + body, "a.wrl").message,
             Catch::Contains("only Inventor in ascii"));
  for (const char* name : {"a.iv", "a.wrl", "a.vrml", "a.vrml1"})
    CHECK_THAT(parse_error(body, name).message, Catch::Contains("begins with its name and version"));
}

TEST_CASE("Inventor output is chosen by extension", "[io][inventor]") {
  const auto options = [](const char* name) { return write_options_for(name).value(); };
  CHECK(options("a.iv").format == FileFormat::kInventor);
  CHECK(options("a.vrml1").format == FileFormat::kVrml1);
  CHECK(options("a.wrl").format == FileFormat::kVrml2);
  CHECK(options("a.vrml").format == FileFormat::kVrml2);
  CHECK(options("a.WRZ").format == FileFormat::kVrml2);
  CHECK(options("a.wrz").gzip);
  CHECK_FALSE(options("a.wrl").gzip);
  CHECK(options("a.iv.gz").gzip);
  CHECK(options("a.iv").encoding == FileEncoding::kAscii);
  CHECK(name_of(FileFormat::kInventor) == "iv");
  CHECK(name_of(FileFormat::kVrml1) == "vrml1");
  CHECK(name_of(FileFormat::kVrml2) == "vrml2");
}

TEST_CASE("Inventor shapes become faces", "[io][inventor]") {
  using Corners = std::vector<std::uint32_t>;
  const auto faces = [](const std::string& shape) { return scene(kFivePoints + shape); };
  CHECK(faces("IndexedFaceSet { coordIndex [ 0 1 2 3 -1 4,1,2 ] }").corners == Corners{0, 1, 2, 3, 4, 1, 2});
  CHECK(faces("IndexedFaceSet { coordIndex [ 0 1 2 3 -1 4,1,2 ] }").face_offsets == Corners{0, 4, 7});
  CHECK(faces("FaceSet { numVertices [ 3 ] startIndex 2 }").corners == Corners{2, 3, 4});
  CHECK(faces("FaceSet { numVertices 5 }").face_offsets == Corners{0, 5});
  CHECK(faces("FaceSet { }").corners == Corners{0, 1, 2, 3, 4});
  CHECK(faces("FaceSet { startIndex 1 numVertices -1 }").corners == Corners{1, 2, 3, 4});
  CHECK(faces("IndexedTriangleStripSet { coordIndex [ 0 1 2 3 4 -1 4 3 2 -1 ] }").corners ==
        Corners{0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 2});
  CHECK(faces("TriangleStripSet { numVertices [ 4 ] startIndex 1 }").corners == Corners{1, 2, 3, 3, 2, 4});
  const IndexedFaceSet quads = scene(
      "Coordinate3 { point [ 9 9 9, 0 0 0, 1 0 0, 2 0 0, 0 1 0, 1 1 0, 2 1 0 ] } "
      "QuadMesh { startIndex 1 verticesPerRow 3 verticesPerColumn 2 }");
  CHECK(quads.corners == Corners{1, 4, 5, 2, 2, 5, 6, 3});
  CHECK(quads.face_offsets == Corners{0, 4, 8});
  const IndexedFaceSet cloud = faces("PointSet { numPoints 2 }");
  CHECK(cloud.points.size() == 5);
  CHECK(cloud.corners.empty());
}

TEST_CASE("Inventor coordinates may be homogeneous", "[io][inventor]") {
  const IndexedFaceSet mesh =
      scene("Coordinate4 { point [ 2 4 6 2, 1 0 0 1, 0 0 3 0.5 ] } IndexedFaceSet { coordIndex [ 0 1 2 ] }");
  CHECK(mesh.points == std::vector<Vec3>{{1, 2, 3}, {1, 0, 0}, {0, 0, 6}});
  CHECK_THAT(scene_error("Coordinate4 { point [ 2 4 6 0, 1 0 0 1, 0 0 3 1 ] }" + kTriangle).message,
             Catch::Contains("not finite"));
}

TEST_CASE("Inventor transforms move the points", "[io][inventor]") {
  const std::string quarter = "1.5707963267948966";
  CHECK(moved("Translation { translation 1 10 100 }") == Vec3(2, 12, 103));
  CHECK(moved("Scale { scaleFactor 2 3 -4 }") == Vec3(2, 6, -12));
  check_near(moved("Rotation { rotation 0 0 2 " + quarter + " }"), {-2, 1, 3});
  check_near(moved("RotationXYZ { axis X angle " + quarter + " }"), {1, -3, 2});
  check_near(moved("RotationXYZ { axis Y angle " + quarter + " }"), {3, 2, -1});
  check_near(moved("RotationXYZ { axis Z angle " + quarter + " }"), {-2, 1, 3});
  // The last row of the matrix is the translation.
  CHECK(moved("MatrixTransform { matrix 0 1 0 0  2 0 0 0  0 0 1 0  7 8 9 1 }") == Vec3(11, 9, 12));
  CHECK(moved("MatrixTransform { matrix 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 2 }") == Vec3(0.5f, 1, 1.5f));
  // Later nodes work inside earlier ones.
  CHECK(moved("Translation { translation 1 0 0 } Scale { scaleFactor 2 2 2 }") == Vec3(3, 4, 6));
  CHECK(moved("Scale { scaleFactor 2 2 2 } Translation { translation 1 0 0 }") == Vec3(4, 4, 6));
  CHECK(moved("Scale { scaleFactor 2 2 2 } ResetTransform { }") == Vec3(1, 2, 3));
  CHECK(moved("Scale { scaleFactor 2 2 2 } ResetTransform { whatToReset (TRANSFORM | BBOX) }") ==
        Vec3(1, 2, 3));
  CHECK(moved("Scale { scaleFactor 2 2 2 } ResetTransform { whatToReset BBOX }") == Vec3(2, 4, 6));
  check_near(moved("Units { units CENTIMETERS } Units { units MILLIMETERS }"), {1e-3f, 2e-3f, 3e-3f});
  // (1, 2, 3) less the centre is (0, 1, 2); scaled (0, 3, 2); turned (-3, 0, 2); back (-2, 1, 3); moved.
  check_near(
      moved("Transform { translation 10 0 0 rotation 0 0 1 " + quarter + " scaleFactor 2 3 1 center 1 1 1 }"),
      {8, 1, 3});
  // Turned back by a quarter (2, -1, 3), scaled (20, -1, 3), turned (1, 20, 3): y is stretched.
  check_near(moved("Transform { scaleFactor 10 1 1 scaleOrientation 0 0 1 " + quarter + " }"), {1, 20, 3});
  // The axes of the scale are turned before the rotation: z is stretched to 6, then x and y turn.
  check_near(moved("Transform { rotation 0 0 1 " + quarter + " scaleFactor 1 2 1 scaleOrientation 1 0 0 " +
                   quarter + " }"),
             {-2, 1, 6});
  CHECK(moved("Transform { rotation 0 0 0 1 }") == Vec3(1, 2, 3));
  CHECK_THAT(
      scene_error("Scale { scaleFactor 1e38 1 1 } Scale { scaleFactor 1e38 1 1 }" + kFivePoints + kTriangle)
          .message,
      Catch::Contains("not finite"));
  CHECK_THAT(scene_error("Scale { scaleFactor 1 2 }" + kFivePoints + kTriangle).message,
             Catch::Contains("holds 2 numbers instead of 3"));
}

TEST_CASE("Inventor state is inherited, and ends with its separator", "[io][inventor]") {
  const std::string move = "Translation { translation 1 0 0 } ", again = kFivePoints + kTriangle;
  const auto xs = [&](const std::string& body) {
    Floats first;
    const IndexedFaceSet mesh = scene(body);
    for (std::size_t i = 0; i < mesh.points.size(); i += 5) first.push_back(mesh.points[i].x);
    return first;
  };
  CHECK(xs("Separator { " + move + again + " } " + again) == Floats{1, 0});
  CHECK(xs("Annotation { " + move + again + " } " + again) == Floats{1, 0});
  CHECK(xs("Group { " + move + again + " } " + again) == Floats{1, 1});
  CHECK(xs("TransformSeparator { " + move + again + " } " + again) == Floats{1, 0});
  // What is no transform leaves a TransformSeparator, but no Separator.
  CHECK(scene("TransformSeparator { " + kFivePoints + " } " + kTriangle).corners.size() == 3);
  CHECK_THAT(scene_error("Separator { " + kFivePoints + " } " + kTriangle).message,
             Catch::Contains("but there are 0"));
  CHECK(xs("Separator { " + move + "Separator { " + move + again + " } " + again + " }") == Floats{2, 1});
  // A shape's own property is nobody else's.
  CHECK(scene(kFivePoints +
              "IndexedFaceSet { vertexProperty VertexProperty { vertex [ 7 0 0, 8 0 0, 9 0 0 ] } "
              "coordIndex [ 0 1 2 ] } IndexedFaceSet { coordIndex [ 2 3 4 ] }")
            .corners == std::vector<std::uint32_t>{0, 1, 2, 5, 6, 7});
}

TEST_CASE("Inventor switches and levels of detail show one child", "[io][inventor]") {
  const std::string children = kTriangle + "IndexedFaceSet { coordIndex [ 2 3 4 ] } }";
  const auto corners = [&](const std::string& head) { return scene(kFivePoints + head + children).corners; };
  using Corners = std::vector<std::uint32_t>;
  CHECK(corners("Switch { whichChild 0 ") == Corners{0, 1, 2});
  CHECK(corners("Switch { whichChild 1 ") == Corners{2, 3, 4});
  CHECK(corners("Switch { whichChild -3 ") == Corners{0, 1, 2, 2, 3, 4});
  CHECK(corners("LOD { range [ 1 ] ") == Corners{0, 1, 2});
  const MeshFile lod = scene_file(kFivePoints + "LevelOfDetail { " + children);
  CHECK(sentences(lod.notes) == std::vector<std::string>{"1 levels of detail but the first ignored"});
  const MeshFile none = scene_file(kFivePoints + kTriangle + "Switch { " + children);
  CHECK(std::get<IndexedFaceSet>(none.geometry).corners == Corners{0, 1, 2});
  CHECK(sentences(none.notes) ==
        std::vector<std::string>{"2 children that a 'Switch' does not choose ignored"});
  // What is not shown can be used.
  CHECK(scene("Switch { DEF P " + kFivePoints + "} USE P " + kTriangle).points.size() == 5);
}

TEST_CASE("Inventor nodes are used again", "[io][inventor]") {
  const std::string part = "DEF Part Separator { " + kFivePoints + kTriangle + " }";
  const IndexedFaceSet twice = scene(part + " Translation { translation 0 0 9 } USE Part");
  CHECK(twice.points.size() == 10);
  CHECK(twice.points[9] == Vec3(0, 0, 10));
  CHECK(twice.corners == std::vector<std::uint32_t>{0, 1, 2, 5, 6, 7});
  // The same points in the same place are the same points.
  CHECK(scene("DEF C " + kFivePoints + kTriangle + " USE C IndexedFaceSet { coordIndex [ 2 3 4 ] }")
            .points.size() == 5);
  CHECK(scene("DEF V VertexProperty { vertex [ 0 0 0, 1 0 0, 0 1 0 ] } "
              "IndexedFaceSet { vertexProperty USE V coordIndex [ 0 1 2 ] }")
            .points.size() == 3);
  // The last definition before the use counts, and a node cannot use itself.
  CHECK(scene("DEF A Translation { translation 1 0 0 } DEF A Translation { translation 5 0 0 } USE A " +
              kFivePoints + kTriangle)
            .points[0]
            .x == 11);
  const MeshFile self = scene_file("DEF A Separator { USE A " + kFivePoints + kTriangle + " }");
  CHECK(sentences(self.notes) ==
        std::vector<std::string>{"1 uses of names that no node before them has ignored"});
  CHECK(std::get<IndexedFaceSet>(self.geometry).corners.size() == 3);
}

TEST_CASE("Inventor normals, texture coordinates and colours follow their bindings", "[io][inventor]") {
  const std::string two = "IndexedFaceSet { coordIndex [ 0 1 2 -1 0 2 3 -1 ] ";
  const std::string points = "Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } ";
  const std::string colors = "Material { diffuseColor [ 0 0 0, 1 0 0, 0 1 0, 0 0 1, 1 1 0, 1 0 1 ] } ";
  const auto bound = [&](const std::string& value, const std::string& more = "") {
    return scene(points + colors + "MaterialBinding { value " + value + " } " + two + more + "}");
  };
  CHECK(values_of(bound("OVERALL").face_channels, "color") == Floats{0, 0, 0, 0, 0, 0});
  CHECK(values_of(bound("PER_FACE").face_channels, "color") == Floats{0, 0, 0, 1, 0, 0});
  CHECK(values_of(bound("PER_PART").face_channels, "color") == Floats{0, 0, 0, 1, 0, 0});
  CHECK(values_of(bound("PER_FACE_INDEXED", "materialIndex [ 2 0 ]").face_channels, "color") ==
        Floats{0, 1, 0, 0, 0, 0});
  CHECK(values_of(bound("PER_VERTEX").corner_channels, "color") ==
        Floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 1, 0, 1});
  CHECK(values_of(bound("PER_VERTEX_INDEXED", "materialIndex [ 5 1 1 -1 0 0 2 -1 ]").corner_channels,
                  "color") == Floats{1, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0});
  // Six colours for four points: the points carry theirs.
  CHECK(values_of(bound("PER_VERTEX_INDEXED").point_channels, "color") ==
        Floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  CHECK(values_of(bound("PER_VERTEX_INDEXED", "materialIndex [ 0 1 2 -1 0 2 3 -1 ]").point_channels,
                  "color") == Floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});

  const std::string normals = "Normal { vector [ 0 0 1, 0 1 0, 1 0 0, 0 0 -1 ] } ";
  CHECK(values_of(scene(points + normals + two + "}").point_channels, "normal") ==
        Floats{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1});
  CHECK(values_of(scene(points + normals + two + "normalIndex [ 3 3 3 -1 0 0 1 -1 ] }").corner_channels,
                  "normal") == Floats{0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 1, 0});
  CHECK(values_of(scene(points + normals + "NormalBinding { value PER_FACE } " + two + "}").face_channels,
                  "normal") == Floats{0, 0, 1, 0, 1, 0});
  const std::string uv = "TextureCoordinate2 { point [ 0 0, 1 0, 1 1, 0 1 ] } ";
  CHECK(values_of(scene(points + uv + two + "}").point_channels, "uv") == Floats{0, 0, 1, 0, 1, 1, 0, 1});
  CHECK(values_of(scene(points + uv + two + "textureCoordIndex [ 3 2 1 -1 0 0 0 ] }").corner_channels,
                  "uv") == Floats{0, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0});

  const IndexedFaceSet property = scene(
      "IndexedFaceSet { vertexProperty VertexProperty { vertex [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] "
      "normal [ 0 0 1, 0 1 0 ] normalBinding PER_FACE texCoord [ 0 0, 1 0, 1 1, 0 1 ] "
      "orderedRGBA [ 0xff000080, 255 ] materialBinding PER_FACE } coordIndex [ 0 1 2 -1 0 2 3 ] }");
  CHECK(values_of(property.face_channels, "normal") == Floats{0, 0, 1, 0, 1, 0});
  CHECK(values_of(property.point_channels, "uv") == Floats{0, 0, 1, 0, 1, 1, 0, 1});
  CHECK(find_channel(property.face_channels, "color")->values ==
        ChannelValues(std::vector<std::uint8_t>{255, 0, 0, 128, 0, 0, 0, 255}));
  CHECK(find_channel(scene(points + "PackedColor { orderedRGBA 0x01020304 } " + two + "}").face_channels,
                     "color")
            ->values == ChannelValues(std::vector<std::uint8_t>{1, 2, 3, 4, 1, 2, 3, 4}));
  CHECK(values_of(scene(points + "BaseColor { rgb 1 0.5 0 } " + two + "}").face_channels, "color") ==
        Floats{1, 0.5f, 0, 1, 0.5f, 0});

  // Strips: a part is a strip, a face a triangle.
  const std::string strip = "IndexedTriangleStripSet { coordIndex [ 0 1 2 3 -1 3 2 1 -1 ] ";
  CHECK(values_of(scene(points + colors + "MaterialBinding { value PER_PART } " + strip + "}").face_channels,
                  "color") == Floats{0, 0, 0, 0, 0, 0, 1, 0, 0});
  CHECK(values_of(scene(points + colors + "MaterialBinding { value PER_FACE } " + strip + "}").face_channels,
                  "color") == Floats{0, 0, 0, 1, 0, 0, 0, 1, 0});
  CHECK(values_of(scene(points + uv + strip + "textureCoordIndex [ 0 1 2 3 -1 0 0 3 -1 ] }").corner_channels,
                  "uv") == Floats{0, 0, 1, 0, 1, 1, 1, 1, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1});
  const IndexedFaceSet cloud =
      scene(points + colors + normals + "MaterialBinding { value PER_VERTEX } PointSet { }");
  CHECK(values_of(cloud.point_channels, "color") == Floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  CHECK(values_of(cloud.point_channels, "normal") == Floats{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1});
}

TEST_CASE("Inventor shapes without an attribute get a defined one", "[io][inventor]") {
  const MeshFile file = scene_file("Separator { " + kFivePoints +
                                   "Normal { vector [ 0 0 1 ] } NormalBinding { value OVERALL } "
                                   "TextureCoordinate2 { point [ 0.5 0.5, 0 1, 1 1, 0 0 ] } "
                                   "Material { diffuseColor 0.25 0.5 0 } " +
                                   kTriangle + " } Separator { " + kFivePoints + kTriangle + " }");
  const IndexedFaceSet& mesh = std::get<IndexedFaceSet>(file.geometry);
  CHECK(values_of(mesh.face_channels, "normal") == Floats{0, 0, 1, 0, 0, 0});
  CHECK(values_of(mesh.face_channels, "color") == Floats{0.25f, 0.5f, 0, 1, 1, 1});
  CHECK(values_of(mesh.corner_channels, "uv") == Floats{0.5f, 0.5f, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0});
  // Attributes meant for another shape are too few for this one.
  const MeshFile few = scene_file(kFivePoints + "Normal { vector [ 0 0 1 ] } " + kTriangle);
  CHECK(std::get<IndexedFaceSet>(few.geometry).corner_channels.empty());
  CHECK(sentences(few.notes) ==
        std::vector<std::string>{"normals of 1 shapes ignored: there are too few for them"});
}

TEST_CASE("Inventor normals are turned with their surface", "[io][inventor]") {
  const auto normal = [](const std::string& transform, const std::string& n) {
    const Floats v = values_of(scene(transform + kFivePoints + "Normal { vector [ " + n +
                                     " ] } NormalBinding { value OVERALL } " + kTriangle)
                                   .face_channels,
                               "normal");
    REQUIRE(v.size() == 3);
    return Vec3(v[0], v[1], v[2]);
  };
  CHECK(normal("", "0 0 3") == Vec3(0, 0, 3));
  check_near(normal("Rotation { rotation 1 0 0 1.5707963267948966 } ", "0 0 1"), {0, -1, 0});
  const float h = std::sqrt(0.2f);
  // The plane x + y = 0, stretched along x: (1, 1) becomes (1/2, 1).
  check_near(normal("Scale { scaleFactor 2 1 1 } ", "1 1 0"), {h, 2 * h, 0});
  check_near(normal("Scale { scaleFactor 1 1 -1 } ", "0 0 1"), {0, 0, -1});
  check_near(normal("Scale { scaleFactor -1 1 1 } ", "0 0 1"), {0, 0, 1});
  check_near(normal("Translation { translation 5 5 5 } ", "0 1 0"), {0, 1, 0});
}

TEST_CASE("Inventor faces may be clockwise or mirrored", "[io][inventor]") {
  using Corners = std::vector<std::uint32_t>;
  const std::string clockwise = "ShapeHints { vertexOrdering CLOCKWISE } ",
                    mirror = "Scale { scaleFactor 1 1 -1 } ";
  const std::string uv = "TextureCoordinate2 { point [ 0 0, 0.5 0, 1 0 ] } ";
  const std::string shape =
      kFivePoints + uv + "IndexedFaceSet { coordIndex [ 0 1 2 3 ] textureCoordIndex [ 0 1 2 0 ] }";
  CHECK(scene(shape).corners == Corners{0, 1, 2, 3});
  CHECK(scene(clockwise + shape).corners == Corners{0, 3, 2, 1});
  CHECK(values_of(scene(clockwise + shape).corner_channels, "uv") == Floats{0, 0, 0, 0, 1, 0, 0.5f, 0});
  CHECK(scene(mirror + shape).corners == Corners{0, 3, 2, 1});
  CHECK(scene(mirror + clockwise + shape).corners == Corners{0, 1, 2, 3});
  CHECK(scene("ShapeHints { vertexOrdering COUNTERCLOCKWISE } " + shape).corners == Corners{0, 1, 2, 3});
}

TEST_CASE("Inventor content that is not kept is named", "[io][inventor]") {
  const MeshFile file = scene_file(
      "Separator { Cube { } DEF A Sphere { radius 2 } USE A Info { string \"a } \\\" # {\" } Cube { } " +
      kFivePoints +
      "IndexedFaceSet { coordIndex [ 0 1 -1 -1 0 1 2 -1 3 -1 ] } Odd { fields [ SFNode a ] a Cube { } } }");
  CHECK(sentences(file.notes) == std::vector<std::string>{"2 faces of fewer than three corners skipped",
                                                          "1 spheres, cones and cylinders read as polygons",
                                                          "1 'Info' nodes ignored", "1 'Odd' nodes ignored"});
  // Two cubes, a sphere twice, a triangle.
  CHECK(std::get<IndexedFaceSet>(file.geometry).face_count() == 2 * 6 + 2 * 32 * 16 + 1);
  std::string many;
  for (int i = 0; i < 100; ++i) many += "Node" + std::to_string(i) + " { } ";
  const MeshFile odd = scene_file(many + kFivePoints + kTriangle);
  CHECK(odd.notes.size() == 65);
  CHECK(odd.notes.back().sentence == "36 nodes of other types ignored");
  // Unknown fields, connections and ignored flags are passed over.
  CHECK(scene("Separator { renderCulling OFF boundingBoxCaching AUTO foo ( A | B ) bar [ TRUE, FALSE ] "
              "baz \"text\" qux NULL Translation { translation 0 0 1 = USE Engine.out } "
              "Scale { scaleFactor 2 2 2 ~ } " +
              kFivePoints + kTriangle + "}")
            .points[0] == Vec3(0, 0, 1));
  // Nor does a value count that stands before such a flag.
  CHECK(scene("Scale { scaleFactor 2 2 2 ~ } Translation { translation ~ } " + kFivePoints + kTriangle)
            .points[1] == Vec3(1, 0, 0));
  CHECK(scene("Scale { scaleFactor 2 2 2 ~ = USE Engine.out } " + kFivePoints + kTriangle).points[1] ==
        Vec3(1, 0, 0));
}

TEST_CASE("malformed Inventor files are refused where they break", "[io][inventor][bad]") {
  struct Bad {
    std::string body;
    std::uint64_t line;
    const char* says;
  };
  const std::string points = "Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0 ] }\n";
  for (const Bad& bad : {
           Bad{points + "IndexedFaceSet { coordIndex [ 0, 1,\n3, -1 ] }", 4,
               "names point 3, but there are 3"},
           Bad{points + "IndexedFaceSet { coordIndex [ 0, 1,\n-2, -1 ] }", 4, "names point -2"},
           Bad{points + "IndexedFaceSet { coordIndex [ 0, 1,\n2.5, -1 ] }", 4, "expected a whole number"},
           Bad{points + "IndexedFaceSet { coordIndex [ 0, 1,\n99999999999 ] }", 4, "expected a whole number"},
           Bad{points + "Normal { vector [ 0 0 1 ] } IndexedFaceSet { coordIndex [ 0 1 2 ]\nnormalIndex [ 0 "
                        "0 1 ] }",
               4, "index 1, but there are 1 normals"},
           Bad{points +
                   "Normal { vector [ 0 0 1 ] } IndexedFaceSet { coordIndex [ 0 1 2 ]\nnormalIndex [ 0 0 ] }",
               4, "too few"},
           Bad{points + "IndexedTriangleStripSet { coordIndex [ 0 1 2\n7 ] }", 4, "names point 7"},
           Bad{points + "FaceSet { numVertices [ 3,\n1 ] }", 4, "1 points are asked for, but 0 are left"},
           Bad{points + "FaceSet { startIndex 4 }", 3, "starts at point 4 of 3"},
           Bad{points + "PointSet { numPoints 4 }", 3, "4 points from 0"},
           Bad{points + "QuadMesh { verticesPerRow 2 verticesPerColumn 2 }", 3, "2 × 2 points"},
           Bad{points + "QuadMesh { verticesPerRow 9223372036854775807 verticesPerColumn 2 }", 3, "points"},
           Bad{"Coordinate3 { point [ 0 0 0,\n1 x 0 ] }" + kTriangle, 3, "expected a number, found 'x'"},
           Bad{"Coordinate3 { point [ 0 0 0,\n1 0 ] }" + kTriangle, 2, "not rows of 3"},
           Bad{"Coordinate3 { point [ 0 0 0,\n1e99 0 0 ] }" + kTriangle, 3, "expected a number"},
           Bad{"Coordinate3 { point [ 0 0 0,\nnan 0 0 ] }" + kTriangle, 3, "expected a number"},
           Bad{points + "Separator {\n" + kTriangle, 3, "the node 'Separator' does not end"},
           Bad{points + "Cube {\n" + kTriangle, 3, "the node 'Cube' does not end"},
           Bad{points + "Info { string \"abc }\n" + kTriangle, 3, "does not end"},
           Bad{points + "Separator { name \"abc }\n" + kTriangle, 3, "a string does not end"},
           Bad{points + "IndexedFaceSet { coordIndex [ 0 1 2 }", 3, "a list does not end"},
           Bad{points + "}\n", 3, "expected the name of a node or field, found '}'"},
           Bad{points + "Separator\n", 4, "expected '{' after 'Separator'"},
           Bad{points + "DEF", 3, "expected a name after DEF"},
           Bad{points + "Material { diffuseColor }", 3, "expected the value of the field 'diffuseColor'"},
           Bad{points + "Switch { whichChild x " + kTriangle + "}", 3, "is no whole number"},
       }) {
    INFO(bad.body);
    const Error error = scene_error(bad.body);
    CHECK(error.code == ErrorCode::kUnreadable);
    CHECK(error.where.line == bad.line);
    CHECK_THAT(error.message, Catch::Contains(bad.says));
  }
  CHECK(scene_error("").message == "the file holds neither polygons nor points");
  CHECK(scene_error("Odd { } Info { }").message ==
        "the file holds neither polygons nor points (nodes ignored: 1 'Info', 1 'Odd')");
}

TEST_CASE("Inventor scenes do not outgrow their file", "[io][inventor][bad]") {
  const auto doubled = [](const std::string& first, int levels) {
    std::string text = "DEF N0 Separator { " + first + " }\n";
    for (int i = 1; i <= levels; ++i) {
      const std::string use = " USE N" + std::to_string(i - 1);
      text += "DEF N" + std::to_string(i) + " Group {" + use + use + use + use + " }\n";
    }
    return text;
  };
  // 4⁴ is fine, 4³⁰ is not, whether the nodes hold something or not.
  CHECK(scene(doubled(kFivePoints + kTriangle, 4)).corners.size() == 3 * (1 + 4 + 16 + 64 + 256));
  for (const std::string& first :
       {kFivePoints + kTriangle, kFivePoints + "PointSet { }", kFivePoints + "FaceSet { numVertices 0 }",
        std::string("Cube { }"), std::string("Translation { translation 1 0 0 }")}) {
    CHECK_THAT(scene_error(doubled(first, 30)).message, Catch::Contains("out of proportion to the file"));
    if (test::kSanitized) break;
  }
  // One list of points, and many short nodes that each use all of it.
  std::string points = "Coordinate3 { point [", shapes;
  for (int i = 0; i < 2000; ++i) points += " 1 2 3,";
  for (int i = 0; i < 20000; ++i) shapes += "FaceSet { }\n";
  CHECK_THAT(scene_error(points + " ] }\n" + shapes).message,
             Catch::Contains("out of proportion to the file"));
  // Long lists of nothing, used again and again.
  std::string ends;
  for (int i = 0; i < 2000; ++i) ends += " -1";
  CHECK_THAT(scene_error(doubled("IndexedFaceSet { coordIndex [" + ends + " ] }", 12)).message,
             Catch::Contains("out of proportion to the file"));
}

TEST_CASE("Inventor nodes do not stand too deep", "[io][inventor][bad]") {
  const auto nested = [](std::size_t depth) {
    std::string text;
    for (std::size_t i = 0; i < depth; ++i) text += "Separator { ";
    text += kFivePoints + kTriangle;
    for (std::size_t i = 0; i < depth; ++i) text += "} ";
    return text;
  };
  CHECK(scene(nested(250)).corners.size() == 3);
  CHECK_THAT(scene_error(nested(300)).message, Catch::Contains("more than 256 others"));
  CHECK_THAT(scene_error(nested(100000)).message, Catch::Contains("more than 256 others"));
  std::string chain = "DEF N0 Separator { " + kFivePoints + kTriangle + " }\n";
  for (int i = 1; i < 1000; ++i)
    chain += "DEF N" + std::to_string(i) + " Group { USE N" + std::to_string(i - 1) + " }\n";
  CHECK_THAT(scene_error("Switch { " + chain + "} USE N999").message,
             Catch::Contains("more than 256 others"));
  // Lists within unknown fields count, too.
  std::string lists = "Separator { a ";
  for (int i = 0; i < 100000; ++i) lists += "[ Group { a ";
  CHECK_THAT(scene_error(lists).message, Catch::Contains("more than 256 others"));
  CHECK(scene_error("Odd { " + std::string(1 << 20, '{')).where.line == 2u);
}

TEST_CASE("Inventor and VRML 1 round trips are lossless for what they hold", "[io][inventor]") {
  IndexedFaceSet cloud;
  cloud.points = icosphere(1).points;
  cloud.point_channels = {{"normal", 3, ramp<float>(126, 0.3)},
                          {"uv", 2, ramp<float>(84, 0.3)},
                          {"color", 3, ramp<float>(126, 0.005)}};
  IndexedFaceSet jittered = icosphere(3);
  jitter(jittered, 1e-3f, 7);
  for (const FileFormat format : {FileFormat::kInventor, FileFormat::kVrml1})
    for (const IndexedFaceSet& mesh :
         with_scene_channels({torus(12, 8), quad_cube(), mixed_polygons(), cloud, jittered}))
      for (const bool gzip : {false, true}) {
        WriteOptions options = write_as(format, FileEncoding::kAscii, gzip);
        options.comment = "made { by\na test";
        const std::string bytes = encode(mesh, options);
        const MeshFile file = parse_file(bytes, "a.bin");
        CHECK(file.format == format);
        CHECK(file.gzip == gzip);
        CHECK(file.notes.empty());
        require_same(mesh, std::get<IndexedFaceSet>(file.geometry));
        CHECK(encode(std::get<IndexedFaceSet>(file.geometry), options) == bytes);
      }
}

TEST_CASE("Inventor is written as documented", "[io][inventor]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 0.1f, -2e-9f}};
  mesh.corners = {0, 1, 2};
  mesh.point_channels = {{"normal", 3, ramp<float>(9, 0.5)}};
  mesh.corner_channels = {{"uv", 2, Floats{0, 0, 1, 0, 0, 0}}};
  mesh.face_channels = {{"color", 4, std::vector<std::uint8_t>{255, 0, 16, 128}}};
  WriteOptions options = write_as(FileFormat::kInventor, FileEncoding::kAscii);
  options.comment = "test";
  const std::string text = encode(mesh, options);
  CHECK(text == R"(#Inventor V2.1 ascii
# test
Separator {
  ShapeHints {
    vertexOrdering COUNTERCLOCKWISE
    faceType UNKNOWN_FACE_TYPE
  }
  Coordinate3 {
    point [
 0 0 0,
 1 0 0,
 0 0.1 -2e-09
    ]
  }
  Normal {
    vector [
 0 0.5 1,
 1.5 2 2.5,
 3 3.5 4
    ]
  }
  NormalBinding { value PER_VERTEX_INDEXED }
  TextureCoordinate2 {
    point [
 0 0,
 1 0
    ]
  }
  PackedColor {
    orderedRGBA [
 0xff001080
    ]
  }
  MaterialBinding { value PER_FACE }
  IndexedFaceSet {
    coordIndex [
0, 1, 2, -1
    ]
    textureCoordIndex [
0, 1, 0, -1
    ]
  }
}
)");
  require_same(mesh, parse(text, "a.iv"));
}

TEST_CASE("what Inventor and VRML cannot hold is named", "[io][inventor]") {
  IndexedFaceSet mesh = cube();
  mesh.point_channels = {{"normal", 3, Floats(24, std::nanf(""))},
                         {"quality", 1, Floats(8)},
                         {"color", 4, ramp<std::uint8_t>(32, 8)}};
  mesh.face_channels = {{"color", 3, Floats(36)}};
  TemporaryFolder folder;
  const auto notes = [&](const char* name) {
    const auto path = folder.path() / name;
    const auto written = write_mesh(path, mesh, write_options_for(path).value());
    REQUIRE(written);
    CHECK(read_mesh(path));
    return sentences(*written);
  };
  const auto expected = [](const std::string& name) {
    const std::string reason = "' left out: " + name + " holds one each of normals, uv and colours";
    return std::vector<std::string>{"24 values of point channel 'normal' that are not finite written as 0",
                                    "point channel 'quality" + reason, "face channel 'color" + reason};
  };
  CHECK(notes("a.iv") == expected("iv"));
  for (const auto& [file, name] : {std::pair("a.vrml1", "vrml1"), std::pair("a.wrl", "vrml2")}) {
    auto all = expected(name);
    all.insert(all.begin() + 1, "opacities of colours left out: written are red, green and blue");
    CHECK(notes(file) == all);
  }
}

TEST_CASE("Inventor files cut or changed anywhere are refused or sound", "[io][inventor][bad][fuzz]") {
  for (const std::string& content : {kHead + kEverything, "#VRML V1.0 ascii\n" + kEverything}) {
    CHECK(parse(content, "a.iv").face_count() == 4 + 6);  // With a cube.
    for (std::size_t size = 0; size < content.size(); ++size) check_sound(content.substr(0, size), "a.iv");
    std::mt19937 random(30);
    for (std::size_t at = kHead.size(); at < content.size(); ++at)
      for (int variant = 0; variant < 6; ++variant) {
        std::string bytes = content;
        if (variant == 0)
          bytes.erase(at, 1);
        else if (variant < 4)
          bytes[at] = "0123456789-+.eE#{}[]\"(), \n"[random() % 26];
        else
          bytes[at] = static_cast<char>(random());
        check_sound(bytes, "a.iv");
      }
  }
}

TEST_CASE("Inventor files are read with progress, and not when told to stop", "[io][inventor]") {
  const std::string text = encode(icosphere(6), write_as(FileFormat::kInventor, FileEncoding::kAscii));
  std::vector<double> fractions;
  ReadOptions options;
  options.progress = [&](double fraction) {
    fractions.push_back(fraction);
    return true;
  };
  REQUIRE(parse_mesh(as_bytes(text), "a.iv", options));
  CHECK(fractions.size() > 4);
  CHECK(std::is_sorted(fractions.begin(), fractions.end()));
  CHECK(fractions.back() > 0.5);
  CHECK(fractions.back() <= 1);
  int left = 3;
  options.progress = [&](double) { return --left > 0; };
  const auto stopped = parse_mesh(as_bytes(text), "a.iv", options);
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::kInterrupted);
}
