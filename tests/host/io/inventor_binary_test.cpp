#include <limits>
#include <random>
#include <string>
#include <vector>

#include "io/io_support.h"
#include "support/inventor_bytes.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

const InventorBytes kOld{false}, kNew{true};

std::string file_of(const InventorBytes& iv, const std::string& nodes) {
  return iv.header() + nodes;
}

/// A triangle, and what `before` draws it with.
std::string triangle(const std::string& before = {}) {
  return before +
         kNew.node("Coordinate3", {iv_field("point", iv_list(iv_reals({0, 0, 0, 1, 0, 0, 0, 1, 0}), 3))}) +
         kNew.node("FaceSet", {});
}

Error error_of(const std::string& nodes) {
  return parse_error(file_of(kNew, nodes), "a.iv");
}

}  // namespace

TEST_CASE("a binary Inventor file holds what its text holds", "[io][inventor]") {
  for (const InventorBytes& iv : {kOld, kNew}) {
    const MeshFile binary = parse_file(file_of(iv, inventor_scene(iv)), "a.iv");
    const MeshFile text = parse_file(inventor_text(iv.has_flags), "a.iv");
    CHECK(binary.format == FileFormat::kInventor);
    CHECK(binary.encoding == FileEncoding::kBinaryBigEndian);
    CHECK(text.encoding == FileEncoding::kAscii);
    CHECK(binary.notes == text.notes);
    const auto& mesh = std::get<IndexedFaceSet>(binary.geometry);
    CHECK(mesh.corners.size() > 100);
    require_same(mesh, std::get<IndexedFaceSet>(text.geometry));
  }
}

TEST_CASE("version 2.0 of Inventor packs colours the other way round", "[io][inventor]") {
  const std::string body = "Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] } FaceSet { }\n";
  const IndexedFaceSet ordered =
      parse("#Inventor V2.1 ascii\nPackedColor { orderedRGBA 0x407fff80 }\n" + body, "a.iv");
  const IndexedFaceSet reversed =
      parse("#Inventor V2.0 ascii\nPackedColor { rgba 0x80ff7f40 }\n" + body, "a.iv");
  const Channel* color = find_channel(ordered.face_channels, "color");
  REQUIRE(color != nullptr);
  CHECK(std::get<std::vector<std::uint8_t>>(color->values) ==
        std::vector<std::uint8_t>{0x40, 0x7f, 0xff, 0x80});
  require_same(ordered, reversed);
}

TEST_CASE("a binary Inventor file may end anywhere", "[io][inventor][bad]") {
  for (const InventorBytes& iv : {kOld, kNew}) {
    const std::string whole = file_of(iv, inventor_scene(iv));
    for (std::size_t size = 0; size < whole.size(); ++size) {
      // A copy of that size, so that a byte read behind it is found.
      const std::vector<char> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      const Error error = parse_error({part.data(), part.size()}, "a.iv");
      INFO(size << ": " << error.message);
      CHECK(error.code == ErrorCode::kUnreadable);
      CHECK(error.message.size() > 10);
    }
  }
}

TEST_CASE("malformed binary Inventor files are refused where they break", "[io][inventor][bad]") {
  constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
  struct Bad {
    std::string nodes;
    const char* says;
  };
  const std::string start = iv_string("Coordinate3") + iv_word(0);
  for (const Bad& bad : {
           Bad{iv_word(kMost), "string of 4294967295 bytes"},
           Bad{iv_word(0), "expected the type of a node, found an empty string"},
           Bad{iv_string("Two words"), "expected the type of a node"},
           Bad{iv_string("DEF") + iv_string("") + start, "expected a name after DEF"},
           Bad{iv_string("USE") + iv_string("{"), "expected a name after USE"},
           Bad{iv_string("Cube") + iv_word(8), "'Cube' has flags that are none"},
           Bad{iv_string("Cube") + iv_word(0) + iv_word(0x100), "'Cube' has no number of fields"},
           Bad{start + iv_word(1) + iv_string("point") + iv_word(kMost),
               "within a value of 12884901885 words"},
           Bad{start + iv_word(255) + iv_field("point", iv_word(0)), "the file ends"},
           Bad{start + iv_word(1) + iv_string("point") + iv_list(iv_reals({1, 2, 3}), 3) + iv_word(77),
               "the value of the field 'point' does not end here"},
           Bad{start + iv_word(1) + iv_string("colour"),
               "the field 'colour' of the node 'Coordinate3' is none"},
           Bad{iv_string("Separator") + iv_word(2) + iv_word(0) + iv_word(kMost), "the file ends"},
           Bad{iv_string("Texture2") + iv_word(0) + iv_word(1) + iv_string("image") + iv_word(kMost) +
                   iv_word(kMost) + iv_word(4),
               "an image of a size that none has"},
           Bad{iv_string("Texture2") + iv_word(0) + iv_word(1) + iv_string("image") + iv_word(0xffff) +
                   iv_word(0xffff) + iv_word(4),
               "within a value of 4294836225 words"},
           Bad{iv_string("Cone") + iv_word(0) + iv_word(1) + iv_string("parts") + iv_string("SIDES"),
               "the file ends"},
           Bad{iv_string("Own") + iv_word(0) + iv_word(0x4001) + iv_string("SFVec7f") + iv_string("a"),
               "is of the type 'SFVec7f', whose length is not known"},
           Bad{kNew.node("Coordinate3", {iv_field("point", iv_list(iv_reals({0, 1}), 1))}), "the file ends"},
           Bad{triangle(kNew.node(
                   "Translation",
                   {iv_field("translation", iv_reals({0, std::numeric_limits<float>::infinity(), 0}))})),
               "expected a number, found inf"},
           Bad{kNew.node("Coordinate3", {iv_field("point", iv_list(iv_reals({0, 0, 0}), 3))}) +
                   kNew.node("IndexedFaceSet", {iv_field("coordIndex", iv_list(iv_wholes({0, 0, 7})))}),
               "names point 7, but there are 1"},
           Bad{kNew.node("Coordinate3", {iv_field("point", iv_list(iv_reals({0, 0, 0}), 3))}) +
                   kNew.described("IndexedFaceSet", {"MFFloat", "coordIndex"},
                                  {iv_field("coordIndex", iv_list(iv_reals({0, 0, 0})))}, {}),
               "expected a whole number, found 0.0"},
       }) {
    const Error error = error_of(bad.nodes);
    INFO(error.describe());
    CHECK(error.code == ErrorCode::kUnreadable);
    CHECK_FALSE(error.where.line.has_value());
    CHECK(error.where.byte.has_value());
    CHECK_THAT(error.message, Catch::Contains(bad.says));
  }
  // The byte is that of what is wrong.
  const std::string before = triangle();
  CHECK(error_of(before + iv_string("Cube") + iv_word(8)).where.byte ==
        kNew.header().size() + before.size() + 8);
  CHECK(error_of(kNew.node("Coordinate3", {iv_field("point", iv_list(iv_reals({0, 0, 0}), 3))}) +
                 kNew.node("IndexedFaceSet", {iv_field("coordIndex", iv_list(iv_wholes({0, 0, 7})))}))
            .where.byte == kNew.header().size() + 16 + 8 + 12 + 16 + 4 + 20 + 8 + 16 + 4 + 8);
}

TEST_CASE("binary Inventor nodes do not stand too deep, nor outgrow their file", "[io][inventor][bad]") {
  const auto nested = [](int depth) {
    std::string bytes;
    for (int i = 0; i < depth; ++i) bytes += iv_string("Separator") + iv_word(2) + iv_word(0) + iv_word(1);
    return bytes + kNew.group("Separator", {}, {kNew.group("Group", {}, {}), kNew.node("Cube", {})});
  };
  CHECK(std::get<IndexedFaceSet>(parse_file(file_of(kNew, nested(240)), "a.iv").geometry).face_count() == 6);
  for (const int depth : {300, 100000})
    CHECK_THAT(error_of(nested(depth)).message, Catch::Contains("more than 256 others"));
  std::string fields;
  for (int i = 0; i < 100000; ++i)
    fields += iv_string("WWWInline") + iv_word(0) + iv_word(1) + iv_string("alternateRep");
  CHECK_THAT(error_of(fields).message, Catch::Contains("more than 256 others"));
  std::string doubled =
      iv_string("DEF") + iv_string("N0") + kNew.group("Separator", {}, {kNew.node("Cube", {})});
  for (int i = 1; i < 30; ++i) {
    const std::string use = iv_string("USE") + iv_string("N" + std::to_string(i - 1));
    doubled +=
        iv_string("DEF") + iv_string("N" + std::to_string(i)) + kNew.group("Group", {}, {use, use, use, use});
  }
  CHECK_THAT(error_of(doubled).message, Catch::Contains("out of proportion to the file"));
}

TEST_CASE("a binary Inventor file names the file that it inlines", "[io][inventor]") {
  const MeshFile file = parse_file(
      file_of(kNew, triangle() + kNew.node("File", {iv_field("name", iv_string("b c.iv"))})), "a.iv");
  CHECK(sentences(file.notes) ==
        std::vector<std::string>{"the inlined file 'b c.iv' ignored: this one was not read from a folder",
                                 "1 'File' nodes ignored"});
}

TEST_CASE("damaged binary Inventor files do no harm", "[io][inventor][bad]") {
  std::mt19937 random(20);
  for (const InventorBytes& iv : {kOld, kNew}) {
    const std::string whole = file_of(iv, inventor_scene(iv));
    for (int round = 0; round < 3000; ++round) {
      std::string damaged = whole;
      for (int i = 0; i < 1 + round % 3; ++i)
        damaged[iv.header().size() + random() % (whole.size() - iv.header().size())] =
            static_cast<char>(round % 2 == 0 ? random() : random() % 4);
      const auto file = parse_mesh(as_bytes(damaged), "a.iv");
      if (!file && (file.error().code != ErrorCode::kUnreadable || file.error().message.empty()))
        FAIL(file.error().describe());
    }
  }
}
