#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "io/io_support.h"
#include "support/data.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

using Floats = std::vector<float>;
using Corners = std::vector<std::uint32_t>;

const std::string kVrml2 = "#VRML V2.0 utf8\n";
const std::string kCoord = "coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } ";
const std::string kTwo = kCoord + "coordIndex [ 0 1 2 -1 0 2 3 -1 ] ";

MeshFile world_file(const std::string& body) {
  return parse_file(kVrml2 + body, "a.wrl");
}

IndexedFaceSet world(const std::string& body) {
  return std::get<IndexedFaceSet>(world_file(body).geometry);
}

std::string face_set(const std::string& fields) {
  return "Shape { geometry IndexedFaceSet { " + fields + "} } ";
}

}  // namespace

TEST_CASE("VRML 2 shapes become faces and points", "[io][vrml]") {
  const MeshFile file = world_file(face_set(kTwo));
  CHECK(file.format == FileFormat::kVrml2);
  CHECK(file.notes.empty());
  CHECK(std::get<IndexedFaceSet>(file.geometry).corners == Corners{0, 1, 2, 0, 2, 3});
  CHECK(world(face_set("ccw FALSE " + kTwo)).corners == Corners{0, 2, 1, 0, 3, 2});
  CHECK(world(face_set(kCoord + "coordIndex [ 0 1 2 3 ] ")).face_offsets == Corners{0, 4});
  const IndexedFaceSet cloud = world(
      "Shape { geometry PointSet { coord Coordinate { point [ 1 2 3, 4 5 6 ] } "
      "color Color { color [ 1 0 0, 0 0.5 0 ] } } }");
  CHECK(cloud.points == std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  CHECK(values_of(cloud.point_channels, "color") == Floats{1, 0, 0, 0, 0.5f, 0});
}

TEST_CASE("VRML 2 attributes are of points, corners or faces", "[io][vrml]") {
  const std::string color = "color Color { color [ 0 0 0, 1 0 0, 0 1 0, 0 0 1 ] } ";
  CHECK(values_of(world(face_set(kTwo + color)).point_channels, "color") ==
        Floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  CHECK(values_of(world(face_set(kTwo + color + "colorIndex [ 3 3 3 -1 1 1 0 -1 ] ")).corner_channels,
                  "color") == Floats{0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0, 0});
  CHECK(values_of(world(face_set(kTwo + color + "colorPerVertex FALSE ")).face_channels, "color") ==
        Floats{0, 0, 0, 1, 0, 0});
  CHECK(values_of(world(face_set(kTwo + color + "colorPerVertex FALSE colorIndex [ 3 2 ] ")).face_channels,
                  "color") == Floats{0, 0, 1, 0, 1, 0});
  const std::string normal = "normal Normal { vector [ 0 0 1, 0 1 0, 1 0 0, 0 0 -1 ] } ";
  CHECK(values_of(world(face_set(kTwo + normal)).point_channels, "normal") ==
        Floats{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1});
  CHECK(values_of(world(face_set(kTwo + normal + "normalPerVertex FALSE normalIndex [ 1 0 ] ")).face_channels,
                  "normal") == Floats{0, 1, 0, 0, 0, 1});
  const std::string uv = "texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] } ";
  CHECK(values_of(world(face_set(kTwo + uv)).point_channels, "uv") == Floats{0, 0, 1, 0, 1, 1, 0, 1});
  CHECK(values_of(world(face_set(kTwo + uv + "texCoordIndex [ 3 3 3 -1 1 1 0 -1 ] ")).corner_channels,
                  "uv") == Floats{0, 1, 0, 1, 0, 1, 1, 0, 1, 0, 0, 0});
  const std::string red =
      "Shape { appearance DEF Red Appearance { material Material { diffuseColor 1 0 0 } "
      "texture ImageTexture { url \"a.png\" } } geometry IndexedFaceSet { ";
  CHECK(values_of(world(red + kTwo + "} }").face_channels, "color") == Floats{1, 0, 0, 1, 0, 0});
  CHECK(values_of(world(red + kTwo + "} } " + face_set(kTwo)).face_channels, "color") ==
        Floats{1, 0, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1});
}

TEST_CASE("VRML 2 groups move and choose their children", "[io][vrml]") {
  const std::string triangle =
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 1 2 3, 0 0 0, 5 5 5 ] } "
      "coordIndex [ 0 1 2 ] } } ";
  const auto first = [&](const std::string& head, const std::string& tail) {
    return world(head + triangle + tail).points.at(0);
  };
  const auto check_near = [](const Vec3& a, const Vec3& b) {
    for (int axis = 0; axis < 3; ++axis) CHECK(a[axis] == Approx(b[axis]).margin(1e-6));
  };
  // As for Inventor's Transform; the children may precede the fields.
  const std::string quarter = "1.5707963267948966";
  check_near(first("Transform { children [ ",
                   "] translation 10 0 0 rotation 0 0 1 " + quarter + " scale 2 3 1 center 1 1 1 }"),
             {8, 1, 3});
  check_near(first("Transform { scale 10 1 1 scaleOrientation 0 0 1 " + quarter + " children ", "}"),
             {1, 20, 3});
  check_near(first("Transform { rotation 0 0 1 " + quarter + " scale 1 2 1 scaleOrientation 1 0 0 " +
                       quarter + " children ",
                   "}"),
             {-2, 1, 6});
  CHECK(first("Transform { translation 1 0 0 children Transform { scale 2 2 2 children [ ", "] } }") ==
        Vec3(3, 4, 6));
  // A transform ends with its node.
  CHECK(world("Transform { translation 1 0 0 } " + triangle).points[0] == Vec3(1, 2, 3));
  for (const char* group : {"Group", "Anchor", "Billboard", "Collision"})
    CHECK(first(std::string(group) + " { children [ ", "] }") == Vec3(1, 2, 3));
  const std::string other = face_set(kTwo);
  CHECK(world("Switch { whichChoice 1 choice [ " + triangle + other + "] }").corners.size() == 6);
  CHECK(world("Switch { choice [ " + triangle + other + "] whichChoice 0 }").corners.size() == 3);
  const MeshFile none = world_file(triangle + "Switch { choice [ " + triangle + other + "] }");
  CHECK(sentences(none.notes) ==
        std::vector<std::string>{"2 children that a 'Switch' does not choose ignored"});
  const MeshFile lod = world_file("LOD { range [ 5 ] level [ " + triangle + other + "] }");
  CHECK(std::get<IndexedFaceSet>(lod.geometry).corners.size() == 3);
  CHECK(sentences(lod.notes) == std::vector<std::string>{"1 levels of detail but the first ignored"});
}

TEST_CASE("VRML 2 nodes are used again", "[io][vrml]") {
  const IndexedFaceSet mesh =
      world("DEF S " + face_set(kTwo) + "Transform { translation 0 0 5 children [ USE S ] } USE S");
  CHECK(mesh.points.size() == 8);
  CHECK(mesh.corners.size() == 18);
  CHECK(mesh.points[4] == Vec3(0, 0, 5));
  const IndexedFaceSet coords =
      world(face_set("coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 1 1 0 ] } coordIndex [ 0 1 2 ] ") +
            face_set("coord USE C coordIndex [ 2 1 0 ] "));
  CHECK(coords.points.size() == 3);
  CHECK(coords.corners == Corners{0, 1, 2, 2, 1, 0});
  std::string laughs = "DEF N0 Group { children [ " + face_set(kTwo) + "] }\n";
  for (int i = 1; i < 40; ++i) {
    const std::string use = " USE N" + std::to_string(i - 1);
    laughs += "DEF N" + std::to_string(i) + " Group { children [" + use + use + use + use + " ] }\n";
  }
  CHECK_THAT(parse_error(kVrml2 + laughs, "a.wrl").message, Catch::Contains("out of proportion to the file"));
}

TEST_CASE("VRML 2 content that is not kept is named", "[io][vrml]") {
  const MeshFile file = world_file(
      "PROTO Wheel [ field SFVec3f s 1 1 1 exposedField SFNode n Group { } ] { Transform { scale IS s } }\n"
      "EXTERNPROTO Far [ field SFFloat r ] [ \"a.wrl#Far\" ]\nEXTERNPROTO Near [ ] \"b.wrl\"\n"
      "WorldInfo { title \"a\" } DEF T TimeSensor { } Wheel { s 2 2 2 } Wheel { } Inline { url \"c.wrl\" }\n"
      "Script { field SFBool a TRUE eventIn SFTime b url \"javascript: { }\" }\n"
      "Shape { geometry IndexedLineSet { coord Coordinate { point [ 0 0 0, 1 1 1 ] } coordIndex [ 0 1 ] } }\n"
      "Shape { geometry Box { } }\n" +
      face_set(kTwo) + "ROUTE T.fraction_changed TO P.set_fraction\n");
  CHECK(sentences(file.notes) ==
        std::vector<std::string>{"2 instances of PROTOs expanded", "2 EXTERNPROTO definitions ignored",
                                 "1 ROUTE statements ignored",
                                 "the inlined file 'c.wrl' ignored: this one was not read from a folder",
                                 "1 'IndexedLineSet' nodes ignored", "1 'Inline' nodes ignored",
                                 "1 'Script' nodes ignored", "1 'TimeSensor' nodes ignored",
                                 "1 'WorldInfo' nodes ignored"});
  CHECK(std::get<IndexedFaceSet>(file.geometry).corners.size() == 24 + 6);
}

TEST_CASE("a PROTO may define others within its body", "[io][vrml]") {
  const auto mesh = [](const std::string& body) { return parse(kVrml2 + body, "a.wrl"); };
  // The width of box number `box`.
  const auto width_of = [](const IndexedFaceSet& boxes, std::size_t box) {
    float low = boxes.points[8 * box].x, high = low;
    for (std::size_t p = 8 * box; p < 8 * box + 8; ++p) {
      low = std::min(low, boxes.points[p].x);
      high = std::max(high, boxes.points[p].x);
    }
    return high - low;
  };
  const auto width = [&](const std::string& body) { return width_of(mesh(body), 0); };
  const std::string box = "{ Shape { geometry Box { size IS size } } }\n";
  CHECK(width("Shape { geometry Box { size 3 1 1 } }") == 3);
  // Values go through both, and a value that the outer one does not give is the inner one's.
  const std::string nested =
      "PROTO Crate [ field SFVec3f outer 1 1 1 field MFNode more [ ] ] {\n"
      "  PROTO Side [ field SFVec3f size 5 1 1 eventIn SFTime pushed field MFNode kids [ ] ] {\n"
      "    Group { children [ Shape { geometry Box { size IS size } } Group { children IS kids } ] } }\n"
      "  Group { children [ Side { size IS outer pushed IS touched kids IS more } ] } }\n";
  CHECK(width(nested + "Crate { outer 2 1 1 }") == 2);
  CHECK(width(nested + "Crate { }") == 1);
  CHECK(mesh(nested + "Crate { more [ Shape { geometry Box { } } Shape { geometry Box { } } ] }")
            .face_count() == 18);
  CHECK(sentences(world_file(nested + "Crate { } Crate { }").notes) ==
        std::vector<std::string>{"4 instances of PROTOs expanded"});
  CHECK(width("PROTO A [ field SFVec3f a 7 1 1 ] { PROTO B [ field SFVec3f size 6 1 1 ] " + box +
              "B { } } A { }") == 6);
  // The inner one hides an outer one of its name, within the body alone; a PROTO that stands outside keeps to
  // those that it was written with.
  const std::string two = "PROTO Side [ field SFVec3f size 4 1 1 ] " + box +
                          "PROTO Pair [ ] { Side { } }\n"
                          "PROTO Own [ ] { PROTO Side [ field SFVec3f size 8 1 1 ] " +
                          box + "Group { children [ Side { } Pair { } ] } }\n";
  const IndexedFaceSet own = mesh(two + "Own { } Side { }");
  REQUIRE(own.points.size() == 24);
  CHECK(width_of(own, 0) == 8);
  CHECK(width_of(own, 1) == 4);
  CHECK(width_of(own, 2) == 4);
  // What is defined in a body is not known outside it.
  CHECK(sentences(world_file(nested + "Crate { } Side { }").notes).back() == "1 'Side' nodes ignored");
  // Three levels deep.
  CHECK(
      width("PROTO A [ field SFVec3f a 1 1 1 ] { PROTO B [ field SFVec3f b 1 1 1 ] { PROTO C [ field SFVec3f "
            "size 1 1 1 ] " +
            box + "C { size IS b } } B { b IS a } } A { a 9 1 1 }") == 9);
}

TEST_CASE("a PROTO that stands in itself is refused", "[io][vrml][bad]") {
  const auto error = [](const std::string& body) { return parse_error(kVrml2 + body, "a.wrl"); };
  const std::string shape = "Shape { geometry Box { } } ";
  const std::string itself = "PROTO A [ ] {\nGroup { children [ A { } ] } }\nA { }";
  // One of that name before it does not matter.
  for (const std::string& body : {itself, "PROTO A [ ] { " + shape + "} " + itself,
                                  std::string("PROTO A [ ] { PROTO B [ ] {\nA { } }\nB { } }\nA { }")}) {
    CHECK_THAT(error(body).message, Catch::Contains("the PROTO 'A' stands in itself"));
    CHECK(error(body).where.line == 3u);
  }
  CHECK(error("PROTO A [ ] { PROTO B [ ] { Group { children B { } } } B { } } A { }").message ==
        "the PROTO 'B' stands in itself");
  // Each holds the one before it twice; and names that are looked for among many.
  std::string doubled = "PROTO P0 [ ] { " + shape + "}\n", many;
  for (int i = 1; i < 40; ++i) {
    const std::string before = "P" + std::to_string(i - 1) + " { } ";
    doubled += "PROTO P" + std::to_string(i) + " [ ] { Group { children [ " + before + before + "] } }\n";
  }
  CHECK_THAT(error(doubled + "P39 { }").message, Catch::Contains("out of proportion to the file"));
  if (test::kSanitized) return;
  for (int i = 0; i < 20000; ++i) many += "PROTO Q [ ] { Group { } }\n";
  for (int i = 0; i < 20000; ++i) many += "Odd { }\n";
  CHECK_THAT(error(many + shape).message, Catch::Contains("out of proportion to the file"));
}

TEST_CASE("malformed VRML 2 files are refused where they break", "[io][vrml][bad]") {
  const auto error = [](const std::string& body) { return parse_error(kVrml2 + body, "a.wrl"); };
  CHECK(error(face_set(kCoord + "coordIndex [ 0 1\n9 -1 ] ")).where.line == 3u);
  CHECK(
      error(face_set(kTwo + "color Color { color [ 0 0 0 ] } colorIndex [ 0 0 0 -1\n0 0 1 ] ")).where.line ==
      3u);
  CHECK_THAT(error("Shape { geometry Text { } }").message,
             Catch::Contains("neither polygons nor points (nodes ignored: 1 'Text')"));
  CHECK_THAT(error("Group { children [ Group { } coordIndex 1 ] }").message, Catch::Contains("expected '{'"));
  CHECK_THAT(error("PROTO A [ ] { Group {").message, Catch::Contains("PROTO has no body that ends"));
  CHECK_THAT(error("Group { children [ Group { } ").message, Catch::Contains("list of nodes does not end"));
}

TEST_CASE("VRML 2 round trips are lossless for what they hold", "[io][vrml]") {
  IndexedFaceSet cloud;
  cloud.points = icosphere(1).points;
  cloud.point_channels = {{"color", 3, ramp<float>(126, 0.005)}};
  for (const IndexedFaceSet& mesh :
       with_scene_channels({torus(12, 8), quad_cube(), mixed_polygons(), cloud})) {
    WriteOptions options = write_as(FileFormat::kVrml2, FileEncoding::kAscii);
    options.comment = "made by a test";
    const std::string bytes = encode(mesh, options);
    const MeshFile file = parse_file(bytes, "a.bin");
    CHECK(file.format == FileFormat::kVrml2);
    CHECK(file.notes.empty());
    require_same(mesh, std::get<IndexedFaceSet>(file.geometry));
    CHECK(encode(std::get<IndexedFaceSet>(file.geometry), options) == bytes);
  }
}

TEST_CASE("VRML 2 files cut or changed anywhere are refused or sound", "[io][vrml][bad][fuzz]") {
  const std::string content =
      kVrml2 +
      "PROTO A [ field SFFloat r 1 ] { Group { } }\nDEF G Group { children [ Transform { rotation 0 1 0 1 "
      "scale 1 2 1 children [ " +
      face_set(
          kTwo +
          "ccw FALSE normal Normal { vector [ 0 0 1, 0 1 0 ] } normalPerVertex FALSE normalIndex [ 1 0 ] "
          "color Color { color [ 1 0 0, 0 1 0 ] } colorIndex [ 0 0 1 -1 1 1 0 -1 ] ") +
      "] } ] }\nLOD { level [ USE G ] }\nShape { geometry PointSet { coord Coordinate { point [ 1 2 3 ] } } "
      "}\n"
      "A { r 2 }\nROUTE G.a TO G.b\n";
  CHECK(parse(content, "a.wrl").face_count() == 4);
  for (std::size_t size = 0; size < content.size(); ++size) check_sound(content.substr(0, size), "a.wrl");
  std::mt19937 random(31);
  for (std::size_t at = kVrml2.size(); at < content.size(); ++at)
    for (int variant = 0; variant < 6; ++variant) {
      std::string bytes = content;
      if (variant == 0)
        bytes.erase(at, 1);
      else if (variant < 4)
        bytes[at] = "0123456789-+.eE#{}[]\"(), \n"[random() % 26];
      else
        bytes[at] = static_cast<char>(random());
      check_sound(bytes, "a.wrl");
    }
}
