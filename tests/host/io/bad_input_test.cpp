#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/io_support.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

struct Bad {
  const char* name;
  std::string content;
  std::optional<std::uint64_t> line, byte;
  const char* says;
};

std::string ply(const std::string& format, const std::string& vertices, const std::string& faces,
                const std::string& body) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

std::string ascii_ply(const std::string& body) {
  return ply("ascii", "3", "1", body);
}

IndexedFaceSet small() {
  IndexedFaceSet mesh = mixed_polygons();
  mesh.point_channels = {{"normal", 3, ramp<float>(21, 0.1)}, {"label", 1, ramp<std::int16_t>(7, 1)}};
  mesh.face_channels = {{"color", 3, ramp<std::uint8_t>(9, 28)}};
  return mesh;
}

/// One small valid file of each kind.
std::vector<std::pair<std::string, std::string>> valid_files() {
  std::vector<std::pair<std::string, std::string>> files;
  for (const bool gzip : {false, true})
    for (const FileFormat format : {FileFormat::kPly, FileFormat::kObj, FileFormat::kOff, FileFormat::kStl})
      for (const FileEncoding encoding :
           {FileEncoding::kAscii, FileEncoding::kBinaryLittleEndian, FileEncoding::kBinaryBigEndian}) {
        const bool text_only = format == FileFormat::kObj || format == FileFormat::kOff;
        if (text_only && encoding != FileEncoding::kAscii) continue;
        if (format == FileFormat::kStl && encoding == FileEncoding::kBinaryBigEndian) continue;
        files.emplace_back(
            "a." + name_of(format) + (gzip ? ".gz" : ""),
            encode(format == FileFormat::kStl ? tetrahedron() : small(), write_as(format, encoding, gzip)));
      }
  // Triangles alone take the packed way.
  files.emplace_back("b.ply",
                     encode(tetrahedron(), write_as(FileFormat::kPly, FileEncoding::kBinaryLittleEndian)));
  files.emplace_back(
      "b.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 -1/-1/-1\n");
  return files;
}

/// Whatever the bytes are, the answer is a sound mesh or one error with a sentence.
/// Runs `body` in a child process and returns what it returned.
int in_child(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// A user to whom permissions apply. True when the process is one now.
bool become_nobody() {
  return geteuid() != 0 || seteuid(65534) == 0;
}

}  // namespace

TEST_CASE("Files without points have one answer in every format, and none are written", "[io]") {
  const std::map<std::string, std::string> files = {
      {"a.off", "OFF\n0 0 0\n"},
      {"a.obj", "# nothing\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
       "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"},
      {"text.stl", "solid a\nendsolid a\n"},
      {"binary.stl", std::string(84, '\0')},
      {"a.wrl", "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate { point [] } } }\n"},
      {"a.iv", "#Inventor V2.1 ascii\nSeparator { Coordinate3 { point [] } IndexedFaceSet { } }\n"},
      {"a.gltf", R"({"asset":{"version":"2.0"}})"},
      {"a.xyz", "\n"}};
  for (const auto& [name, content] : files) {
    INFO(name);
    const Error error = parse_error(content, name);
    CHECK(error.code == ErrorCode::kUnreadable);
    CHECK_THAT(error.message, Catch::Matchers::StartsWith("the file holds no "));
  }
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.glb", "a.gltf", "a.iv", "a.wrl", "a.xyz"}) {
    INFO(name);
    const auto bytes = encode_mesh({}, write_options_for(name).value());
    REQUIRE_FALSE(bytes);
    CHECK(bytes.error().code == ErrorCode::kUnsuitable);
  }
}

TEST_CASE("A file that is refused as empty names what was passed over", "[io]") {
  const Error error = parse_error(
      "#VRML V2.0 utf8\nShape { geometry IndexedLineSet { coord Coordinate { point [0 0 0, 1 1 1] } "
      "coordIndex [0 1 -1] } }\n",
      "lines.wrl");
  CHECK_THAT(error.message, Catch::Matchers::Contains("IndexedLineSet"));
}

TEST_CASE("malformed files are refused with the place and a reason", "[io][bad]") {
  const std::string packed(36, '\0');
  const std::size_t packed_body = ply("binary_little_endian", "3", "1", "").size();
  const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::vector<Bad> cases = {
      {"a.ply", "", {}, {}, "the file is empty"},
      {"a", "\x01\x02garbage\x80", {}, {}, "the content is none of PLY, OBJ, OFF, STL"},
      {"a.ply",
       "\x7f\x45LF\x02\x01",
       1,
       {},
       "a PLY file begins with a line 'ply', this one with '\\x7fELF\\x02\\x01'"},
      {"a.off", "\x7f\x45LF\x02\x01", 1, {}, "expected the number of vertices, found '\\x7fELF\\x02\\x01'"},
      {"a.obj",
       "\x7f\x45LF\x02\x01",
       1,
       {},
       "the file holds no vertex (skipped: 1 '\\x7fELF\\x02\\x01' line)"},
      {"a.stl",
       "\x7f\x45LF\x02\x01",
       {},
       6,
       "the file ends within the 84 bytes that begin a binary STL file"},

      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", 4, {}, "the header ends without 'end_header'"},
      {"a.ply", "ply\nend_header\n", 2, {}, "the header gives no format"},
      {"a.ply", "ply\nformat ascii 2.0\nend_header\n", 2, {}, "the version of the format is not 1.0"},
      {"a.ply", "ply\nformat text 1.0\nend_header\n", 2, {}, "none of ascii, binary_little_endian"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex -3\n",
       3,
       {},
       "expected the count of element 'vertex', found '-3'"},
      {"a.ply", "ply\nformat ascii 1.0\nproperty float x\n", 3, {}, "a property precedes every element"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n",
       4,
       {},
       "unknown scalar type 'real'"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\n",
       5,
       {},
       "declared twice"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nelement vertex 1\n", 4, {}, "declared twice"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n",
       4,
       {},
       "no integer type"},
      {"a.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n", 4, {}, "no element 'vertex'"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
       3,
       {},
       "element 'vertex' has no scalar property 'z'"},
      {"a.ply", "ply\nformat ascii 1.0\nhello\n", 3, {}, "unknown keyword, 'hello'"},
      {"a.ply",
       ascii_ply("0 0 0\n1 0\n0 1 0\n3 0 1 2\n"),
       11,
       {},
       "vertex 1: expected 'z' (float), found the end of the line"},
      {"a.ply", ascii_ply("0 0 0\n1 0 0 7\n0 1 0\n3 0 1 2\n"), 11, {}, "more than its properties: '7'"},
      {"a.ply",
       ascii_ply("0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"),
       11,
       {},
       "vertex 1 has a coordinate that is not finite"},
      {"a.ply", ascii_ply("0 0 0\n1 0 -inf\n0 1 0\n3 0 1 2\n"), 11, {}, "not finite"},
      {"a.ply", ascii_ply("0 0 0\n1 0 1e39\n0 1 0\n3 0 1 2\n"), 11, {}, "expected 'z' (float), found '1e39'"},
      {"a.ply", ascii_ply("0 0 0\n1 0 1,5\n0 1 0\n3 0 1 2\n"), 11, {}, "expected 'z' (float), found '1,5'"},
      {"a.ply", ascii_ply("0 0 0\n1 0 0x1\n0 1 0\n3 0 1 2\n"), 11, {}, "found '0x1'"},
      {"a.ply", ascii_ply("0 0 0\n1 0 +-1\n0 1 0\n3 0 1 2\n"), 11, {}, "found '+-1'"},
      {"a.ply", ascii_ply(std::string("0 0 0\n1 0 0\0 1\n0 1 0\n3 0 1 2\n", 29)), 11, {}, "found '0\\x00'"},
      {"a.ply",
       ascii_ply("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
       13,
       {},
       "face 0 names vertex 3, but there are 3 vertices"},
      {"a.ply", ascii_ply("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), 13, {}, "face 0 names vertex -1"},
      {"a.ply", ascii_ply("0 0 0\n1 0 0\n0 1 0\n3 0 1 99999999999\n"), 13, {}, "found '99999999999'"},
      {"a.ply", ascii_ply("0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"), 13, {}, "found '1.5'"},
      {"a.ply",
       ascii_ply("0 0 0\n1 0 0\n0 1 0\n256 0 1 2\n"),
       13,
       {},
       "expected 'vertex_indices' (list of int), found '256'"},
      {"a.ply", ascii_ply("0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n"), 13, {}, "found the end of the line"},
      {"a.ply", ascii_ply("0 0 0\n1 0 0\n0 1 0\n3 0 1"), 13, {}, "found the end of the file"},
      {"a.ply", ascii_ply("0 0 0\n1 0 0\n0 1 0\n\n\n\n\n\n"), 18, {}, "found the end of the file"},
      {"a.ply",
       ascii_ply("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n"),
       14,
       {},
       "more than its header promises: '3'"},
      {"a.ply",
       ply("binary_little_endian", "3", "1", packed + std::string("\3\0\0\0\0\1\0", 7)),
       {},
       packed_body + 41,
       "the file ends within 'vertex_indices' of face 0"},
      {"a.ply",
       ply("binary_little_endian", "3", "1", packed + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0!", 14)),
       {},
       packed_body + 49,
       "1 bytes follow"},

      {"a.off", "OFF\n3 1\n0 0 0\n1 0 0\n", 2, {}, "promises 3 vertices and 1 faces, but only 13 bytes"},
      {"a.off", "OFF\n-3 1 0\n", 2, {}, "expected the number of vertices, found '-3'"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0 \n0 1 0\n3 0 1\n  ", 6, {}, "expected corner 2 of face 0"},
      {"a.off",
       "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n3 0 1 2\n1 1\n",
       6,
       {},
       "face 0 names vertex 3, but there are 3"},
      {"a.off",
       "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1\n3 0 1 2\n1 1\n",
       7,
       {},
       "a face has fewer corners than its line promises"},
      {"a.off",
       "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       6,
       {},
       "face 0 names vertex 3, but there are 3"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n", 6, {}, "face 0 names vertex -1"},
      {"a.off",
       "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n",
       4,
       {},
       "vertex 1 has a coordinate that is not finite"},
      {"a.off",
       "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2    \n",
       4,
       {},
       "expected coordinate z of vertex 1, found the end"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", 4, {}, "found 'x'"},
      {"a.off",
       "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 red\n",
       6,
       {},
       "expected the colour of face 0, found 'red'"},
      {"a.off", "4OFF\n3 1 0\n", 1, {}, "three dimensions"},
      {"a.off", "OFF BINARY\n", {}, 11, "the file ends within what its header promises"},
      {"a.off",
       std::string("OFF BINARY\n\0\0\0\1\0\0\0\1\0\0\0\0", 23),
       {},
       23,
       "promises 1 vertices and 1 faces"},
      {"a.off", "COFF\n1 0 0\n0 0 0 1 0\n", 3, {}, "a colour of 3 or 4 numbers"},

      {"a.obj", "# nothing\n", 2, {}, "the file holds no vertex"},
      {"a.obj", head + "f 1 2 0\n", 4, {}, "expected the index of a vertex (of 3 so far), found '0'"},
      {"a.obj", head + "f 1 2 -4\n", 4, {}, "found '-4'"},
      {"a.obj", head + "f 1 2 -9223372036854775808\n", 4, {}, "found '-9223372036854775808'"},
      {"a.obj", head + "f 1 2 4\nf 1 2 3\n", 4, {}, "a face names 'v' 4, but there are 3"},
      {"a.obj", head + "f 1 2 4294967297\n", 4, {}, "found '4294967297'"},
      {"a.obj", head + "f 1 2 3x\n", 4, {}, "expected a corner, found '3x'"},
      {"a.obj", head + "v 1 2\n", 4, {}, "expected coordinate z, found the end of the line"},
      {"a.obj", head + "v 1 2 inf\nf 1 2 4\n", 4, {}, "vertex 3 has a coordinate that is not finite"},
      {"a.obj", head + "v 1 2 -1.#IND00\nf 1 2 4\n", 4, {}, "a coordinate that is not finite"},
      {"a.obj", head + "v 1 2 1.#INF\nf 1 2 4\n", 4, {}, "a coordinate that is not finite"},
      {"a.obj", head + "v 1 2 3#4\n", 4, {}, "expected coordinate z"},
      {"a.obj", head + "vn 1 2\n", 4, {}, "expected a number of a normal"},
      {"a.obj", head + "vn 1 2 3 4\n", 4, {}, "expected the end of the line, found '4'"},
      {"a.obj", head + "f 1 2 3 \\", 4, {}, "found '\\'"},

      {"a.stl",
       "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n",
       7,
       {},
       "expected 'endloop', found the end of the file"},
      {"a.stl",
       "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n",
       4,
       {},
       "a coordinate is not finite"},
      {"a.stl",
       "solid\nfacet normal 0 0\nouter loop\n",
       3,
       {},
       "expected a number of a normal, found 'outer'"},
      {"a.stl", "solid thing\n", 2, {}, "the file ends without 'endsolid'"},
      {"a.stl",
       std::string(80, 'x') + std::string("\2\0\0\0", 4) + std::string(50, '\0'),
       {},
       80,
       "promises 2 facets, 184 bytes in all, but the file has 134"},
      {"a.stl", std::string(80, 'x') + "\xff\xff\xff\xff", {}, 80, "promises 4294967295 facets"},
      {"a.stl",
       std::string(80, 'x') + std::string("\1\0\0\0", 4) + std::string(12, '\0') + "\1\2\x80\x7f" +
           std::string(34, '\0'),
       {},
       96,
       "facet 0 has a coordinate that is not finite"},
  };
  for (const Bad& bad : cases) {
    INFO(bad.name << " " << bad.content.substr(0, 300));
    const Error error = parse_error(bad.content, bad.name);
    CHECK(error.code == ErrorCode::kUnreadable);
    CHECK(error.where.file == bad.name);
    CHECK_THAT(error.message, Catch::Contains(bad.says));
    CHECK(error.where.line == bad.line);
    CHECK(error.where.byte == bad.byte);
  }
}

TEST_CASE("binary PLY errors name the byte", "[io][bad]") {
  IndexedFaceSet mesh = tetrahedron();
  for (const FileEncoding encoding : {FileEncoding::kBinaryLittleEndian, FileEncoding::kBinaryBigEndian}) {
    const std::string good = encode(mesh, write_as(FileFormat::kPly, encoding));
    const std::size_t body = good.find("end_header\n") + 11;
    std::string bad = good;
    bad.replace(body + 12, 4,
                encoding == FileEncoding::kBinaryLittleEndian ? std::string("\0\0\x80\x7f", 4)
                                                              : std::string("\x7f\x80\0\0", 4));
    Error error = parse_error(bad, "a.ply");
    CHECK(error.where.byte == body + 12);
    CHECK_THAT(error.message, Catch::Contains("vertex 1 has a coordinate that is not finite"));

    const std::size_t faces = body + 48;
    bad = good;
    bad[faces + 13 + 5] = bad[faces + 13 + 8] = '\4';
    error = parse_error(bad, "a.ply");
    CHECK(error.where.byte == faces + 13 + 5);
    CHECK_THAT(error.message, Catch::Contains("face 1 names vertex "));
    bad = good;
    bad.replace(faces + 1, 4, "\xff\xff\xff\xff");
    CHECK_THAT(parse_error(bad, "a.ply").message, Catch::Contains("face 0 names vertex -1, but there are 4"));
    bad = good;
    bad[faces + 26] = '\2';
    // A face of two corners is skipped, but the bytes behind it do not come out.
    CHECK(parse_error(bad, "a.ply").code == ErrorCode::kUnreadable);
    error = parse_error(good.substr(0, good.size() - 1), "a.ply");
    CHECK(error.where.byte == good.size() - 4);
    CHECK(error.message == "the file ends within 'vertex_indices' of face 3");
  }
}

TEST_CASE("promises that the bytes cannot keep are refused at once", "[io][bad]") {
  for (const char* count : {"100000000", "4294967296", "1000000000000", "9223372036854775808",
                            "18446744073709551615", "1000000000000000000000000000000"}) {
    INFO(count);
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      CHECK(parse_error(ply(format, count, "1", "0 0 0\n"), "a.ply").where.line == 3u);
      CHECK(parse_error(ply(format, "0", count, "0 0 0\n"), "a.ply").where.line == 7u);
      const std::string other =
          std::string("ply\nformat ") + format + " 1.0\nelement thing " + count +
          "\nproperty list int int a\nelement vertex 0\nproperty float x\nproperty float y\n"
          "property float z\nend_header\n1 2\n";
      CHECK(parse_error(other, "a.ply").where.line == 3u);
    }
    CHECK(parse_error(std::string("OFF\n") + count + " 1 0\n0 0 0\n", "a.off").where.line == 2u);
    CHECK(parse_error(std::string("OFF\n1 ") + count + " 0\n0 0 0\n", "a.off").where.line == 2u);
    CHECK(parse_error(std::string("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n") + count + " 0 1 2\n", "a.off")
              .where.line == 6u);
  }
  const std::string list = ply("binary_little_endian", "1", "1", std::string(12, '\0') + "\x7f\xff\xff\xff");
  CHECK(parse_error(list, "a.ply").code == ErrorCode::kUnreadable);
}

TEST_CASE("very long lines are lines", "[io][bad]") {
  const std::string blanks(1 << 20, ' '), name(1 << 20, 'x');
  CHECK(parse(ascii_ply("0 0" + blanks + "0\n1 0 0\n0 1 0\n3 0 1 2\n"), "a.ply").points.size() == 3);
  CHECK(parse("#" + name + "\nv 0 0 0\n", "a.obj").points.size() == 1);
  CHECK(parse_error(name, "a.obj").message.size() < 200);
  CHECK(parse_error(ascii_ply(name), "a.ply").message.size() < 200);
  CHECK(parse_error("OFF\n1 0 0\n" + name, "a.off").message.size() < 200);
  CHECK(parse_error("OFF\n1 0 0\n0 0 1" + std::string(1 << 20, '0') + "\n", "a.off").where.line == 3u);
}

TEST_CASE("damaged gzip streams are refused", "[io][bad][gzip]") {
  const std::string good = encode(icosphere(2), write_as(FileFormat::kPly, FileEncoding::kAscii, true));
  const Error cut = parse_error(good.substr(0, good.size() - 1), "a.ply.gz");
  CHECK(cut.message == "the gzip stream is cut short");
  CHECK(cut.where.byte == good.size() - 1);
  std::string bad = good;
  bad[bad.size() - 6] = static_cast<char>(bad[bad.size() - 6] ^ 1);  // The checksum.
  CHECK(parse_error(bad, "a.ply.gz").message == "the gzip stream is damaged (incorrect data check)");
  bad = good;
  bad[bad.size() - 2] = static_cast<char>(bad[bad.size() - 2] ^ 1);  // The length.
  CHECK(parse_error(bad, "a.ply.gz").message == "the gzip stream is damaged (incorrect length check)");
  CHECK(parse_error(good + "more", "a.ply.gz").where.byte);
  require_same(icosphere(2), parse(good + std::string(700, '\0'), "a.ply.gz"));
  CHECK(parse_error(good + std::string(3, '\0') + good, "a.ply.gz").message ==
        "bytes that are not gzip follow the compressed data");
}

TEST_CASE("several gzip members are one file", "[io][gzip]") {
  const std::string text = encode(icosphere(3), write_as(FileFormat::kOff, FileEncoding::kAscii));
  TemporaryFolder folder;
  std::string members;
  for (std::size_t from = 0; from < text.size(); from += 5000) {
    const auto part = folder.path() / "part";
    write_bytes(part, text.substr(from, 5000));
    REQUIRE(std::system(("gzip -f " + part.string()).c_str()) == 0);
    members += read_bytes(part.string() + ".gz");
  }
  require_same(icosphere(3), parse(members, "a.off.gz"));
  write_bytes(folder.path() / "a.off.gz", members);
  const auto file = read_mesh(folder.path() / "a.off.gz");
  REQUIRE(file);
  CHECK(file->gzip);
  require_same(icosphere(3), std::get<IndexedFaceSet>(file->geometry));
}

TEST_CASE("files cut anywhere are refused or sound", "[io][bad][fuzz]") {
  for (const auto& [name, content] : valid_files())
    for (std::size_t size = 0; size < content.size(); ++size) check_sound(content.substr(0, size), name);
}

TEST_CASE("files with wrong bytes are refused or sound", "[io][bad][fuzz]") {
  std::mt19937 random(20);
  for (const auto& [name, content] : valid_files())
    for (int variant = 0; variant < 2000; ++variant) {
      std::string bytes = content;
      for (unsigned change = 0; change <= random() % 4; ++change) {
        const std::size_t at = random() % bytes.size();
        switch (random() % 4) {
          case 0:
            bytes[at] = static_cast<char>(random());
            break;
          case 1:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random() % 8)));
            break;
          case 2:
            bytes[at] = "0123456789-+.eE#/\\ \n"[random() % 20];
            break;
          default:
            bytes.erase(at, 1 + random() % 3);
            break;
        }
        if (bytes.empty()) break;
      }
      check_sound(bytes, name);
    }
}

TEST_CASE("files that cannot be opened say why", "[io][bad]") {
  TemporaryFolder folder;
  const auto error_of = [](const std::filesystem::path& path) {
    const auto file = read_mesh(path);
    REQUIRE_FALSE(file);
    CHECK(file.error().code == ErrorCode::kUnreadable);
    CHECK(file.error().where.file == path.string());
    return file.error().message;
  };
  CHECK(error_of(folder.path()) == "cannot be read: Is a directory");
  CHECK(error_of(folder.path() / "missing.ply") == "cannot be read: No such file or directory");
  CHECK(error_of("/dev/null") == "the file is empty");
  const auto secret = folder.path() / "secret.ply";
  write_bytes(secret, encode(cube(), {}));
  std::filesystem::permissions(secret, std::filesystem::perms::none);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  CHECK(in_child([&] {
          if (!become_nobody()) return 2;
          const auto file = read_mesh(secret);
          return !file && file.error().message == "cannot be read: Permission denied" ? 0 : 1;
        }) == 0);
}

TEST_CASE("extensions that no writer serves are a usage error", "[io]") {
  for (const char* name : {"a", "a.gz", "a.fbx", "a.ply.zip", ".ply"}) {
    const auto options = write_options_for(name);
    REQUIRE_FALSE(options);
    CHECK(options.error().code == ErrorCode::kUsage);
    CHECK_THAT(options.error().message, Catch::Contains(".ply, .obj, .off, .stl"));
  }
  const auto options = write_options_for("folder.x/A.Stl.GZ");
  REQUIRE(options);
  CHECK(options->format == FileFormat::kStl);
  CHECK(options->gzip);
  CHECK(options->encoding == FileEncoding::kBinaryLittleEndian);
  CHECK(write_options_for("-")->format == FileFormat::kPly);
  CHECK(write_options_for("a.obj")->encoding == FileEncoding::kAscii);
}

TEST_CASE("meshes that no file should hold are not written", "[io]") {
  const auto refused = [](const IndexedFaceSet& mesh) {
    const auto bytes = encode_mesh(mesh, {});
    REQUIRE_FALSE(bytes);
    return bytes.error().code;
  };
  IndexedFaceSet mesh = cube();
  mesh.corners[3] = 8;
  CHECK(refused(mesh) == ErrorCode::kUsage);
  mesh = cube();
  mesh.corners.pop_back();
  CHECK(refused(mesh) == ErrorCode::kUsage);
  mesh = quad_cube();
  mesh.face_offsets.back() = 25;
  CHECK(refused(mesh) == ErrorCode::kUsage);
  mesh = quad_cube();
  mesh.face_offsets = {0, 2, 24};
  CHECK(refused(mesh) == ErrorCode::kUnsuitable);
  mesh = cube();
  mesh.points[2].y = std::numeric_limits<float>::quiet_NaN();
  CHECK(refused(mesh) == ErrorCode::kUnsuitable);
  mesh = cube();
  mesh.point_channels = {{"quality", 1, std::vector<float>(7)}};
  CHECK(refused(mesh) == ErrorCode::kUsage);
}

TEST_CASE("output appears whole or not at all", "[io][write]") {
  TemporaryFolder folder;
  const auto path = folder.path() / "out.ply";
  REQUIRE(write_mesh(path, cube(), {}));
  CHECK(folder.entries() == 1);
  const std::string before = read_bytes(path);
  CHECK(before == encode(cube(), {}));

  SECTION("a file is replaced, keeps its permissions, and a link to it stays a link") {
    std::filesystem::permissions(path, std::filesystem::perms(0640));
    const auto link = folder.path() / "link.ply";
    std::filesystem::create_symlink("out.ply", link);
    REQUIRE(write_mesh(link, icosphere(1), {}));
    CHECK(std::filesystem::is_symlink(link));
    CHECK(read_bytes(path) == encode(icosphere(1), {}));
    CHECK(std::filesystem::status(path).permissions() == std::filesystem::perms(0640));
    CHECK(folder.entries() == 2);
  }
  SECTION("a mesh that cannot be written leaves the file as it was") {
    WriteOptions options = write_as(FileFormat::kStl, FileEncoding::kBinaryLittleEndian);
    REQUIRE_FALSE(write_mesh(path, quad_cube(), options));
    CHECK(read_bytes(path) == before);
    CHECK(folder.entries() == 1);
  }
  SECTION("a disk that is full leaves the file as it was") {
    for (const bool gzip : {false, true}) {
      CHECK(in_child([&] {
              signal(SIGXFSZ, SIG_IGN);
              const rlimit limit{10000, 10000};
              if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return 2;
              const auto written =
                  write_mesh(path, icosphere(5), write_as(FileFormat::kPly, FileEncoding::kAscii, gzip));
              return !written && written.error().code == ErrorCode::kNotWritable &&
                             written.error().message == "cannot be written: File too large"
                         ? 0
                         : 1;
            }) == 0);
      CHECK(read_bytes(path) == before);
      CHECK(folder.entries() == 1);
    }
  }
  SECTION("what is no regular file is written directly") {
    REQUIRE(write_mesh("/dev/null", cube(), {}));
    CHECK(std::filesystem::is_character_file("/dev/null"));
    const auto full = write_mesh("/dev/full", cube(), {});
    REQUIRE_FALSE(full);
    CHECK(full.error().code == ErrorCode::kNotWritable);
    CHECK(full.error().message == "cannot be written: No space left on device");
    CHECK(std::filesystem::is_character_file("/dev/full"));

    const auto pipe = folder.path() / "pipe";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    const pid_t child = fork();
    if (child == 0) _exit(write_mesh(pipe, cube(), {}) ? 0 : 1);
    CHECK(read_bytes(pipe) == before);
    int status = -1;
    waitpid(child, &status, 0);
    CHECK(status == 0);
    CHECK(std::filesystem::is_fifo(pipe));
  }
  SECTION("places where nothing can be written say why") {
    const auto message = [](const std::filesystem::path& to) {
      const auto written = write_mesh(to, cube(), {});
      REQUIRE_FALSE(written);
      CHECK(written.error().code == ErrorCode::kNotWritable);
      CHECK(written.error().where.file == to.string());
      return written.error().message;
    };
    CHECK(message(folder.path()) == "cannot be written: Is a directory");
    CHECK(message(folder.path() / "no" / "out.ply") == "cannot be written: No such file or directory");
    CHECK(message(path / "out.ply") == "cannot be written: Not a directory");
    std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
    CHECK(in_child([&] {
            if (!become_nobody()) return 2;
            const auto written = write_mesh(folder.path() / "new.ply", cube(), {});
            return !written && written.error().code == ErrorCode::kNotWritable &&
                           written.error().message == "cannot be written: Permission denied"
                       ? 0
                       : 1;
          }) == 0);
    std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
    CHECK(folder.entries() == 1);
  }
}

TEST_CASE("standard streams are read and written", "[io]") {
  TemporaryFolder folder;
  const auto path = folder.path() / "stream";
  CHECK(in_child([&] {
          const int out = ::open(path.c_str(), O_WRONLY | O_CREAT, 0600);
          if (out < 0 || dup2(out, 1) < 0) return 2;
          return write_mesh("-", icosphere(3), {}) ? 0 : 1;
        }) == 0);
  CHECK(read_bytes(path) == encode(icosphere(3), {}));
  CHECK(in_child([&] {
          const int in = ::open(path.c_str(), O_RDONLY);
          if (in < 0 || dup2(in, 0) < 0) return 2;
          const auto file = read_mesh("-");
          return file && std::get<IndexedFaceSet>(file->geometry).corners == icosphere(3).corners ? 0 : 1;
        }) == 0);
}
