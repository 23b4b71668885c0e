#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "io/io_support.h"
#include "support/data.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

void append_u32(std::string& to, std::size_t value) {
  for (int i = 0; i < 4; ++i) to += static_cast<char>(value >> (8 * i) & 0xff);
}

/// A GLB file of this JSON and these bytes.
std::string glb(std::string json, std::string binary = "") {
  while (json.size() % 4 != 0) json += ' ';
  while (binary.size() % 4 != 0) binary += '\0';
  std::string out = "glTF";
  append_u32(out, 2);
  append_u32(out, 20 + json.size() + (binary.empty() ? 0 : 8 + binary.size()));
  append_u32(out, json.size());
  out += "JSON" + json;
  if (binary.empty()) return out;
  append_u32(out, binary.size());
  return out + std::string("BIN\0", 4) + binary;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string out(values.size() * sizeof(T), '\0');
  std::memcpy(out.data(), values.data(), out.size());
  return out;
}

/// Buffer views and accessors put together piece by piece, each view beginning at a multiple of 4.
struct Builder {
  std::string binary, views, accessors;

  int view(const std::string& bytes, const std::string& more = "") {
    const std::size_t begin = binary.size();
    binary += bytes;
    while (binary.size() % 4 != 0) binary += '\0';
    views += std::string(views.empty() ? "" : ",") + R"({"buffer":0,"byteOffset":)" + std::to_string(begin) +
             R"(,"byteLength":)" + std::to_string(bytes.size()) + more + "}";
    return view_count++;
  }
  int accessor(int view, int type, std::size_t count, const std::string& shape,
               const std::string& more = "") {
    accessors += std::string(accessors.empty() ? "" : ",") +
                 (view >= 0 ? R"({"bufferView":)" + std::to_string(view) + "," : "{") +
                 R"("componentType":)" + std::to_string(type) + R"(,"count":)" + std::to_string(count) +
                 R"(,"type":")" + shape + "\"" + more + "}";
    return accessor_count++;
  }
  int floats(const std::vector<float>& values, const std::string& shape, std::size_t width) {
    return accessor(view(bytes_of(values)), 5126, values.size() / width, shape);
  }
  int positions(const std::vector<float>& values) { return floats(values, "VEC3", 3); }

  /// The file, with what else stands in its JSON.
  std::string file(const std::string& rest) const {
    return glb(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(binary.size()) +
                   R"(}],"bufferViews":[)" + views + R"(],"accessors":[)" + accessors + "]," + rest + "}",
               binary);
  }
  int view_count = 0, accessor_count = 0;
};

std::string primitive(const std::string& content) {
  return R"("meshes":[{"primitives":[{)" + content + "}]}]";
}

using Corners = std::vector<std::uint32_t>;
const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

const WriteOptions kBinary = write_as(FileFormat::kGltf, FileEncoding::kBinaryLittleEndian);
const WriteOptions kText = write_as(FileFormat::kGltf, FileEncoding::kAscii);

std::string says(const std::string& content, const std::string& name = "a.glb") {
  const Error error = parse_error(content, name);
  CHECK(error.code == ErrorCode::kUnreadable);
  CHECK(error.where.file == name);
  return error.message;
}

IndexedFaceSet colourful() {
  IndexedFaceSet mesh = torus(9, 7);
  const std::size_t n = mesh.points.size();
  std::vector<float> normals;
  for (std::size_t i = 0; i < n; ++i) normals.insert(normals.end(), {0, i % 2 ? 1.0f : -1.0f, 0});
  mesh.point_channels = {{"normal", 3, normals},
                         {"uv", 2, ramp<float>(2 * n, 0.0078125)},
                         {"color", 4, ramp<std::uint8_t>(4 * n, 1)},
                         {"quality", 1, ramp<float>(n, 0.1)},
                         {"label", 3, ramp<std::uint16_t>(3 * n, 5)},
                         {"flag", 1, ramp<std::int8_t>(n, 1)}};
  std::vector<std::uint32_t> material;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) material.push_back(f < 30 ? 0 : f < 40 ? 1 : 2);
  mesh.face_channels = {{"material", 1, material, {"stone", "", "w\u00e4ter \"1\""}}};
  return mesh;
}

}  // namespace

TEST_CASE("glTF round trips keep points, faces, attributes and materials", "[io][gltf]") {
  IndexedFaceSet cloud;
  cloud.points = {{1, 2, 3}, {-0.5f, 1e-20f, 3e20f}};
  cloud.point_channels = {{"color", 3, std::vector<float>{0, 0.25f, 1, 0.1f, 0.2f, 0.3f}}};
  IndexedFaceSet lonely = tetrahedron();
  lonely.points.push_back({9, 9, 9});
  for (const IndexedFaceSet& mesh : {tetrahedron(), icosphere(2), colourful(), cloud, lonely})
    for (const WriteOptions& options : {kBinary, kText})
      for (const bool gzip : {false, true}) {
        WriteOptions o = options;
        o.gzip = gzip;
        const std::string bytes = encode(mesh, o);
        const MeshFile file = parse_file(bytes, "a.bin");
        CHECK(file.format == FileFormat::kGltf);
        CHECK(file.encoding == options.encoding);
        CHECK(file.gzip == gzip);
        CHECK(file.notes.empty());
        const IndexedFaceSet back = parse(bytes, "a.bin");
        if (mesh.face_channels.empty()) {
          require_same(mesh, back);
        } else {
          // Faces without material come first among the labels that are left; the rest is as it was.
          require_same_channels(mesh.point_channels, back.point_channels);
          CHECK(back.points == mesh.points);
          CHECK(back.corners == mesh.corners);
          REQUIRE(back.face_channels.size() == 1);
          const Channel& material = back.face_channels[0];
          CHECK(material.labels == std::vector<std::string>{"stone", "w\u00e4ter \"1\"", ""});
          const auto& number = std::get<std::vector<std::uint32_t>>(material.values);
          CHECK(number[29] == 0);
          CHECK(number[30] == 2);
          CHECK(number[40] == 1);
        }
        CHECK(encode(parse(bytes, "a.bin"), o) == encode(parse(encode(back, o), "a.bin"), o));
      }
}

TEST_CASE("glTF files have the indices and bounds that the format asks for", "[io][gltf]") {
  const std::string text = encode(grid(2, 1), kText);
  CHECK(text.find("\"componentType\": 5123") != std::string::npos);
  CHECK(text.find("\"componentType\": 5125") == std::string::npos);
  for (const std::size_t points : {std::size_t{65535}, std::size_t{65536}}) {
    IndexedFaceSet mesh = tetrahedron();
    mesh.points.resize(points, Vec3(0));
    const bool small = encode(mesh, kText).find("\"componentType\": 5123") != std::string::npos;
    CHECK(small == (points == 65535));
  }
  IndexedFaceSet mesh = tetrahedron();
  mesh.points[1].y = -2.5f;
  mesh.points[2].z = 0.1f;
  std::string compact;
  for (const char c : encode(mesh, kText))
    if (c != ' ' && c != '\n') compact += c;
  CHECK(compact.find("\"min\":[") != std::string::npos);
  CHECK(compact.find("-2.5,") != std::string::npos);
  CHECK(compact.find("\"target\":34962") != std::string::npos);
  CHECK(compact.find("\"target\":34963") != std::string::npos);

  WriteOptions options = kText;
  options.comment = "maker 1.0";
  CHECK(encode(mesh, options).find("\"generator\": \"maker 1.0\"") != std::string::npos);
}

TEST_CASE("glTF splits points where their corners differ", "[io][gltf]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {5, 5, 5}};
  mesh.corners = {0, 1, 2, 2, 1, 3};
  // Point 2 has one uv in both triangles, point 1 has two.
  mesh.corner_channels = {{"uv", 2, std::vector<float>{0, 0, 1, 0, 0, 1, 0, 1, 0.5f, 0, 1, 1}}};
  const auto encoded = encode_mesh(mesh, kBinary);
  REQUIRE(encoded);
  const IndexedFaceSet back = parse(as_text(*encoded), "a.glb");
  CHECK(back.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}});
  CHECK(back.corners == Corners{0, 1, 2, 2, 3, 4});
  REQUIRE(back.point_channels.size() == 1);
  CHECK(back.point_channels[0].values == ChannelValues(std::vector<float>{0, 0, 1, 0, 0, 1, 0.5f, 0, 1, 1}));

  const TemporaryFolder folder;
  const auto notes = write_mesh(folder.path() / "a.glb", mesh, kBinary);
  REQUIRE(notes);
  REQUIRE(notes->size() == 1);
  CHECK(notes->front().sentence.find("1 points without a face left out") == 0);
}

TEST_CASE("glTF names what it leaves out, and refuses polygons", "[io][gltf]") {
  const TemporaryFolder folder;
  IndexedFaceSet mesh = tetrahedron();
  mesh.point_channels = {{"normal", 3, std::vector<float>{0, 0, 2, 0, 0, 1, 1, 0, 0, 0, 1, 0}},
                         {"Odd name", 1, ramp<float>(4, 1)},
                         {"exact", 1, ramp<double>(4, 1)},
                         {"broken", 1, std::vector<float>{0, NAN, 0, 0}}};
  mesh.face_channels = {{"material", 1, ramp<std::uint32_t>(4, 1), {"only one"}}};
  auto notes = write_mesh(folder.path() / "a.glb", mesh, kBinary);
  REQUIRE(notes);
  CHECK(notes->size() == 5);
  const IndexedFaceSet back = parse(read_bytes(folder.path() / "a.glb"), "a.glb");
  REQUIRE(back.point_channels.size() == 1);
  CHECK(back.point_channels[0].values ==
        ChannelValues(std::vector<float>{0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0}));
  CHECK(back.face_channels.empty());

  mesh = tetrahedron();
  mesh.point_channels = {{"normal", 3, std::vector<float>(12, 0.0f)}};
  notes = write_mesh(folder.path() / "b.glb", mesh, kBinary);
  REQUIRE(notes);
  REQUIRE(notes->size() == 1);
  CHECK(notes->front().sentence.find("no length") != std::string::npos);

  for (const auto& [bad, code] :
       std::vector<std::pair<IndexedFaceSet, ErrorCode>>{{quad_cube(), ErrorCode::kUnsuitable}}) {
    const auto refused = write_mesh(folder.path() / "c.glb", bad, kBinary);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == code);
    CHECK(refused.error().message.find("glTF holds") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder.path() / "c.glb"));
  }
  CHECK(
      encode_mesh(tetrahedron(), write_as(FileFormat::kGltf, FileEncoding::kBinaryBigEndian)).error().code ==
      ErrorCode::kUsage);
}

TEST_CASE("names of glTF files", "[io][gltf]") {
  CHECK(write_options_for("a.gltf")->format == FileFormat::kGltf);
  CHECK(write_options_for("a.gltf")->encoding == FileEncoding::kAscii);
  CHECK(write_options_for("a.GLB.gz")->format == FileFormat::kGltf);
  CHECK(write_options_for("a.GLB.gz")->encoding == FileEncoding::kBinaryLittleEndian);
  CHECK(write_options_for("a.GLB.gz")->gzip);
  CHECK(name_of(FileFormat::kGltf) == "gltf");
}

TEST_CASE("glTF primitives of every mode", "[io][gltf]") {
  Builder b;
  const int position = b.positions(kSquare);
  const std::string at = R"("attributes":{"POSITION":)" + std::to_string(position) + "}";
  const auto indices8 =
      b.accessor(b.view(bytes_of(std::vector<std::uint8_t>{0, 1, 2, 1, 3, 2})), 5121, 6, "SCALAR");
  const auto indices16 = b.accessor(b.view(bytes_of(std::vector<std::uint16_t>{3, 1, 0})), 5123, 3, "SCALAR");
  const auto indices32 =
      b.accessor(b.view(bytes_of(std::vector<std::uint32_t>{0, 0, 1, 2, 3})), 5125, 5, "SCALAR");
  const auto with = [&](const std::string& more) { return b.file(primitive(at + more)); };
  const auto corners = [&](const std::string& more) { return parse(with(more), "a.glb").corners; };
  CHECK(corners(R"(,"indices":)" + std::to_string(indices8)) == Corners{0, 1, 2, 1, 3, 2});
  CHECK(corners(R"(,"indices":)" + std::to_string(indices16)) == Corners{3, 1, 0});
  CHECK(corners(R"(,"mode":4)") == Corners{0, 1, 2});
  CHECK(sentences(parse_file(with(""), "a.glb").notes) ==
        std::vector<std::string>{"1 corners that complete no triangle ignored"});
  CHECK(corners(R"(,"mode":5)") == Corners{0, 1, 2, 1, 3, 2});
  CHECK(corners(R"(,"mode":6)") == Corners{1, 2, 0, 2, 3, 0});
  CHECK(corners(R"(,"mode":0)").empty());
  CHECK(parse(with(R"(,"mode":0)"), "a.glb").points.size() == 4);
  // The first triangle of this strip has no area, and the second keeps its turn.
  CHECK(corners(R"(,"mode":5,"indices":)" + std::to_string(indices32)) == Corners{0, 2, 1, 1, 2, 3});
  CHECK(says(with(R"(,"mode":1)")).find("no points") != std::string::npos);
  CHECK(says(with(R"(,"mode":7)")).find("mode 7") != std::string::npos);
}

TEST_CASE("glTF accessors: strides, sparse and normalised ones", "[io][gltf]") {
  Builder b;
  // Position, then colour: 12 + 4 bytes.
  std::string interleaved;
  for (std::size_t i = 0; i < 4; ++i)
    interleaved += bytes_of(std::vector<float>(kSquare.begin() + static_cast<std::ptrdiff_t>(3 * i),
                                               kSquare.begin() + static_cast<std::ptrdiff_t>(3 * i + 3))) +
                   bytes_of(std::vector<std::uint8_t>{static_cast<std::uint8_t>(10 * i), 0, 255, 7});
  const int view = b.view(interleaved, R"(,"byteStride":16)");
  const int position = b.accessor(view, 5126, 4, "VEC3");
  const int color = b.accessor(view, 5121, 4, "VEC3", R"(,"byteOffset":12,"normalized":true)");
  const int uv = b.accessor(b.view(bytes_of(std::vector<std::uint16_t>{0, 65535, 65535, 0, 0, 0, 13107, 0})),
                            5123, 4, "VEC2", R"(,"normalized":true)");
  const int normal = b.accessor(
      b.view(bytes_of(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, -127, 0, 0, -128, 0, 0, 127, 0, 0, 0}),
             R"(,"byteStride":4)"),
      5120, 4, "VEC3", R"(,"normalized":true)");
  IndexedFaceSet mesh =
      parse(b.file(primitive(R"("mode":5,"attributes":{"POSITION":)" + std::to_string(position) +
                             R"(,"COLOR_0":)" + std::to_string(color) + R"(,"TEXCOORD_0":)" +
                             std::to_string(uv) + R"(,"NORMAL":)" + std::to_string(normal) + "}")),
            "a.glb");
  CHECK(mesh.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  CHECK(find_channel(mesh.point_channels, "color")->values ==
        ChannelValues(std::vector<std::uint8_t>{0, 0, 255, 10, 0, 255, 20, 0, 255, 30, 0, 255}));
  // Upwards here, downwards there.
  CHECK(find_channel(mesh.point_channels, "uv")->values ==
        ChannelValues(std::vector<float>{0, 0, 1, 1, 0, 1, 0.2f, 1}));
  CHECK(find_channel(mesh.point_channels, "normal")->values ==
        ChannelValues(std::vector<float>{0, 0, 1, 0, 0, -1, 0, -1, 0, 1, 0, 0}));

  // Over bytes, and over zeros.
  const int replaced = b.view(bytes_of(std::vector<std::uint16_t>{1, 3}));
  const int values = b.view(bytes_of(std::vector<float>{7, 8, 9, -1, -2, -3}));
  const std::string sparse = R"(,"sparse":{"count":2,"indices":{"bufferView":)" + std::to_string(replaced) +
                             R"(,"componentType":5123},"values":{"bufferView":)" + std::to_string(values) +
                             "}}";
  const int over = b.accessor(view, 5126, 4, "VEC3", sparse);
  const int alone = b.accessor(-1, 5126, 4, "VEC3", sparse);
  mesh =
      parse(b.file(primitive(R"("mode":0,"attributes":{"POSITION":)" + std::to_string(over) + "}")), "a.glb");
  CHECK(mesh.points == std::vector<Vec3>{{0, 0, 0}, {7, 8, 9}, {0, 1, 0}, {-1, -2, -3}});
  mesh = parse(b.file(primitive(R"("mode":0,"attributes":{"POSITION":)" + std::to_string(alone) + "}")),
               "a.glb");
  CHECK(mesh.points == std::vector<Vec3>{{0, 0, 0}, {7, 8, 9}, {0, 0, 0}, {-1, -2, -3}});

  // Positions of 16 bits, as KHR_mesh_quantization has them.
  const int quantized =
      b.accessor(b.view(bytes_of(std::vector<std::int16_t>{0, 1, -2, 0, 300, 0, 0, 0}), R"(,"byteStride":8)"),
                 5122, 2, "VEC3");
  mesh = parse(b.file(R"("extensionsRequired":["KHR_mesh_quantization"],)" +
                      primitive(R"("mode":0,"attributes":{"POSITION":)" + std::to_string(quantized) + "}")),
               "a.glb");
  CHECK(mesh.points == std::vector<Vec3>{{0, 1, -2}, {300, 0, 0}});
}

TEST_CASE("glTF nodes place meshes, and mirrored ones turn their faces", "[io][gltf]") {
  Builder b;
  const int position = b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int normal = b.positions({0, 0, 1, 0, 0, 1, 1, 1, 0});
  const std::string meshes = primitive(R"("attributes":{"POSITION":)" + std::to_string(position) +
                                       R"(,"NORMAL":)" + std::to_string(normal) + "}");
  const auto read = [&](const std::string& nodes,
                        const std::string& scenes = R"("scene":0,"scenes":[{"nodes":[0]}])") {
    return parse(b.file(meshes + R"(,"nodes":[)" + nodes + "]," + scenes), "a.glb");
  };
  // A quarter turn about z after a scale of 2 in x; the parent moves all that.
  const std::string half = std::to_string(std::sqrt(0.5));
  IndexedFaceSet mesh =
      read(R"({"translation":[10,0,0],"children":[1]},{"mesh":0,"scale":[2,1,1],"rotation":[0,0,)" + half +
           "," + half + "]}");
  REQUIRE(mesh.points.size() == 3);
  const std::vector<Vec3> expected = {{10, 0, 0}, {10, 2, 0}, {9, 0, 0}};
  for (std::size_t i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis)
      CHECK(mesh.points[i][axis] == Approx(expected[i][axis]).margin(1e-6));
  CHECK(mesh.corners == Corners{0, 1, 2});
  // Normals go with the inverse transpose: (1, 1, 0) becomes (1/2, 1, 0) becomes (-1, 1/2, 0), of unit
  // length.
  const auto normals = std::get<std::vector<float>>(mesh.point_channels[0].values);
  CHECK(normals[2] == Approx(1));
  CHECK(normals[6] == Approx(-2 / std::sqrt(5.0)));
  CHECK(normals[7] == Approx(1 / std::sqrt(5.0)));

  mesh = read(R"({"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,5,1]})");
  CHECK(mesh.points == std::vector<Vec3>{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}});
  CHECK(mesh.corners == Corners{0, 2, 1});
  CHECK(std::get<std::vector<float>>(mesh.point_channels[0].values)[2] == -1);

  // Two instances; a scene that is not the default one; no default; no scene at all.
  const std::string two = R"({"mesh":0},{"mesh":0,"translation":[0,0,1]},{"mesh":0})";
  CHECK(read(two, R"("scene":1,"scenes":[{"nodes":[2]},{"nodes":[0,1]}])").corners ==
        Corners{0, 1, 2, 3, 4, 5});
  CHECK(read(two, R"("scenes":[{"nodes":[2]},{"nodes":[2,1]}])").points.size() == 6);
  CHECK(parse(b.file(meshes), "a.glb").points.size() == 3);

  const auto refused = [&](const std::string& nodes) {
    return says(b.file(meshes + R"(,"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes + "]"));
  };
  CHECK(refused(R"({"children":[1]},{"mesh":0,"children":[0]})").find("reached twice") != std::string::npos);
  CHECK(refused(R"({"children":[1,2]},{"children":[2]},{"mesh":0})").find("reached twice") !=
        std::string::npos);
  CHECK(refused(R"({"children":[7]})").find("node 7 of 1") != std::string::npos);
  CHECK(refused(R"({"mesh":3})").find("mesh 3 of 1") != std::string::npos);
  CHECK(refused(R"({"mesh":0,"matrix":[1,2,3]})").find("wrong size") != std::string::npos);
  CHECK(refused(R"({"mesh":0,"scale":[1e300,1,1]})").find("not finite") != std::string::npos);
}

namespace {

/// A matrix of doubles that acts on columns, by rows.
using Matrix = std::array<std::array<double, 4>, 4>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

}  // namespace

TEST_CASE("glTF skins pose points as the sum over their joints, in double precision", "[io][gltf][oracle]") {
  std::mt19937 random(8);
  const auto real = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
  };
  for (int round = 0; round < 50; ++round) {
    // Joints below one another or below a node beside them, and a node with the mesh whose place does not
    // count.
    const std::size_t joints = 2 + random() % 4, points = 12;
    std::string nodes = R"({"mesh":0,"skin":0,"translation":[77,-5,3],"scale":[3,3,3]})", names;
    std::vector<Matrix> world(joints), inverse(joints);
    std::vector<float> matrices;
    const std::size_t above = random() % 2;  // A chain below the first joint, or all side by side.
    for (std::size_t j = 0; j < joints; ++j) {
      const float x = real(-1, 1), y = real(-1, 1), z = real(-1, 1), w = real(-1, 1);
      const float n = std::sqrt(x * x + y * y + z * z + w * w);
      const std::array<float, 4> q = {x / n, y / n, z / n, w / n};
      const std::array<float, 3> t = {real(-5, 5), real(-5, 5), real(-5, 5)},
                                 s = {real(0.5, 2), real(0.5, 2), real(0.5, 2)};
      std::ostringstream node;
      node.precision(9);
      node << R"(,{"rotation":[)" << q[0] << "," << q[1] << "," << q[2] << "," << q[3]
           << R"(],"translation":[)" << t[0] << "," << t[1] << "," << t[2] << R"(],"scale":[)" << s[0] << ","
           << s[1] << "," << s[2] << "]";
      if (above == 1 && j + 1 < joints) node << R"(,"children":[)" << j + 2 << "]";
      nodes += node.str() + "}";
      names += (j > 0 ? "," : "") + std::to_string(j + 1);
      const double a = q[0], b = q[1], c = q[2], d = q[3];
      const double turn[3][3] = {{1 - 2 * (b * b + c * c), 2 * (a * b - c * d), 2 * (a * c + b * d)},
                                 {2 * (a * b + c * d), 1 - 2 * (a * a + c * c), 2 * (b * c - a * d)},
                                 {2 * (a * c - b * d), 2 * (b * c + a * d), 1 - 2 * (a * a + b * b)}};
      Matrix local{};
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) local[i][k] = turn[i][k] * s[k];
        local[i][3] = t[i];
      }
      local[3][3] = 1;
      world[j] = above == 1 && j > 0 ? product(world[j - 1], local) : local;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 4; ++k) inverse[j][i][k] = real(-2, 2);
      inverse[j][3] = {0, 0, 0, 1};
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t i = 0; i < 4; ++i) matrices.push_back(static_cast<float>(inverse[j][i][k]));
    }
    std::vector<float> positions, weights;
    std::vector<std::uint8_t> used;
    std::vector<DVec3> expected;
    for (std::size_t p = 0; p < points; ++p) {
      const std::array<double, 4> at = {real(-3, 3), real(-3, 3), real(-3, 3), 1};
      for (std::size_t axis = 0; axis < 3; ++axis) positions.push_back(static_cast<float>(at[axis]));
      // Quarters, so that they add up to 1 exactly.
      std::array<int, 4> quarters = {0, 0, 0, 0};
      for (int i = 0; i < 4; ++i) ++quarters[random() % 4];
      DVec3 sum(0.0);
      for (const int quarter : quarters) {
        const std::size_t joint = random() % joints;
        used.push_back(static_cast<std::uint8_t>(joint));
        weights.push_back(static_cast<float>(quarter) / 4);
        const Matrix pose = product(world[joint], inverse[joint]);
        for (int axis = 0; axis < 3; ++axis)
          for (std::size_t k = 0; k < 4; ++k)
            sum[axis] += quarter / 4.0 * pose[static_cast<std::size_t>(axis)][k] * at[k];
      }
      expected.push_back(sum);
    }
    Builder b;
    const int position = b.positions(positions);
    const int joint = b.accessor(b.view(bytes_of(used)), 5121, points, "VEC4");
    const int weight = b.floats(weights, "VEC4", 4);
    const int bind = b.floats(matrices, "MAT4", 16);
    std::string roots = "0,1";
    for (std::size_t j = 1; above == 0 && j < joints; ++j) roots += "," + std::to_string(j + 1);
    const IndexedFaceSet mesh = parse(
        b.file(primitive(R"("attributes":{"POSITION":)" + std::to_string(position) + R"(,"JOINTS_0":)" +
                         std::to_string(joint) + R"(,"WEIGHTS_0":)" + std::to_string(weight) + "}") +
               R"(,"nodes":[)" + nodes + R"(],"skins":[{"joints":[)" + names + R"(],"inverseBindMatrices":)" +
               std::to_string(bind) + R"(}],"scenes":[{"nodes":[)" + roots + "]}]"),
        "a.glb");
    REQUIRE(mesh.points.size() == points);
    for (std::size_t p = 0; p < points; ++p)
      for (int axis = 0; axis < 3; ++axis)
        CHECK(static_cast<double>(mesh.points[p][axis]) ==
              Approx(expected[p][axis]).epsilon(1e-5).margin(1e-4));
  }
}

TEST_CASE("glTF primitives that share accessors share points", "[io][gltf]") {
  Builder b;
  const int position = b.positions(kSquare), other = b.positions({5, 5, 5, 6, 5, 5, 5, 6, 5});
  const int first = b.accessor(b.view(bytes_of(std::vector<std::uint8_t>{0, 1, 2})), 5121, 3, "SCALAR");
  const int second = b.accessor(b.view(bytes_of(std::vector<std::uint8_t>{1, 3, 2})), 5121, 3, "SCALAR");
  const int uv = b.floats({0, 0.5f, 1, 0.5f, 0, 0.25f}, "VEC2", 2);
  const auto part = [&](int points, int indices, const std::string& more, const std::string& attribute = "") {
    return R"({"attributes":{"POSITION":)" + std::to_string(points) + attribute + "}" +
           (indices >= 0 ? R"(,"indices":)" + std::to_string(indices) : "") + more + "}";
  };
  const IndexedFaceSet mesh =
      parse(b.file(R"("materials":[{"name":"red"},{}],"meshes":[{"primitives":[)" +
                   part(position, first, R"(,"material":1)") + "," + part(position, second, "") + "," +
                   part(other, -1, R"(,"material":0)", R"(,"TEXCOORD_0":)" + std::to_string(uv)) + "]}]"),
            "a.glb");
  CHECK(mesh.points.size() == 7);
  CHECK(mesh.corners == Corners{0, 1, 2, 1, 3, 2, 4, 5, 6});
  REQUIRE(mesh.face_channels.size() == 1);
  CHECK(mesh.face_channels[0].values == ChannelValues(std::vector<std::uint32_t>{1, 2, 0}));
  CHECK(mesh.face_channels[0].labels == std::vector<std::string>{"red", "material 1", ""});
  REQUIRE(mesh.point_channels.size() == 1);
  CHECK(mesh.point_channels[0].values ==
        ChannelValues(std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0.5f, 1, 0.5f, 0, 0.75f}));
}

TEST_CASE("glTF buffers lie in the file, beside it, or nowhere that is read", "[io][gltf]") {
  const TemporaryFolder folder;
  const std::string bytes = bytes_of(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
  const auto file = [&](const std::string& uri, std::size_t length = 36) {
    return R"( {"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(length) +
           R"(,"uri":")" + uri +
           R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,)" +
           R"("count":3,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  };
  const auto read = [&](const std::string& content) {
    write_bytes(folder.path() / "a.gltf", content);
    return read_mesh(folder.path() / "a.gltf");
  };
  const auto refusal = [&](const std::string& content) {
    const auto result = read(content);
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kUnreadable);
    return result.error().message;
  };
  // Longer than promised is fine. A plus sign is itself.
  std::filesystem::create_directory(folder.path() / "sub");
  write_bytes(folder.path() / "sub" / "b c+d.bin", bytes + "more");
  auto mesh = read(file("sub/b%20c+d.bin"));
  REQUIRE(mesh);
  CHECK(std::get<IndexedFaceSet>(mesh->geometry).points.size() == 3);
  CHECK(mesh->notes.empty());
  CHECK(mesh->encoding == FileEncoding::kAscii);
  mesh = read(file("../" + folder.path().filename().string() + "/sub/b c+d.bin"));
  REQUIRE(mesh);
  REQUIRE(mesh->notes.size() == 1);
  CHECK(mesh->notes[0].sentence.find("outside the folder") != std::string::npos);

  CHECK(says(file("sub/b%20c+d.bin"), "a.gltf").find("only a glTF file read from a folder") !=
        std::string::npos);
  CHECK(refusal(file("missing.bin")).find("is no file") != std::string::npos);
  CHECK(refusal(file("sub")).find("is no file") != std::string::npos);
  CHECK(refusal(file("sub/b%20c+d.bin", 50)).find("promises 50 bytes, but has 40") != std::string::npos);
  CHECK(refusal(file("/etc/passwd")).find("absolute") != std::string::npos);
  CHECK(refusal(file("%2Fetc/passwd")).find("absolute") != std::string::npos);
  CHECK(refusal(file("https://example.org/a.bin")).find("only files and data: URIs") != std::string::npos);
  CHECK(refusal(file("file:///etc/passwd")).find("only files and data: URIs") != std::string::npos);
  CHECK(refusal(file("")).find("empty uri") != std::string::npos);
  CHECK(refusal(file("data:text/html,x")).find("data URI") != std::string::npos);
  CHECK(refusal(file("data:application/octet-stream;base64,AAAA")).find("promises 36 bytes, but has 3") !=
        std::string::npos);
}

TEST_CASE("glTF that asks for what is not supported is refused by name", "[io][gltf]") {
  Builder b;
  b.positions(kSquare);
  const std::string mesh = primitive(R"("mode":5,"attributes":{"POSITION":0})");
  for (const std::string name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "ACME_unknown"})
    CHECK(says(b.file(R"("extensionsRequired":[")" + name + R"("],)" + mesh))
              .find("requires the extension " + name) != std::string::npos);
  const MeshFile file = parse_file(
      b.file(R"("extensionsUsed":["ACME_unknown"],"extensionsRequired":["KHR_materials_unlit"],)"
             R"("images":[{"uri":"missing.png"}],"skins":[{"joints":[0]}],)" +
             primitive(R"("mode":5,"targets":[{"POSITION":0}],"attributes":{"POSITION":0,"TANGENT":0})")),
      "a.glb");
  CHECK(file.notes.size() == 5);

  std::string old = b.file(mesh);
  old.replace(old.find("2.0"), 3, "1.0");
  CHECK(says(old).find("version '1.0' of glTF") != std::string::npos);
  old = b.file(mesh);
  old[4] = 1;
  CHECK(says(old).find("version 1 of the GLB") != std::string::npos);
  CHECK(says(R"({"scene":0})", "a.gltf").find("no 'asset'") != std::string::npos);
  CHECK(says(R"({"asset":)", "a.gltf").find("malformed") != std::string::npos);
  CHECK(says(R"({"asset":)" + std::string(100000, '['), "a.gltf").find("nests deeper") != std::string::npos);
  CHECK(says(R"({"asset":{"version":"2.0"},"scene":1e999})", "a.gltf").find("out of range") !=
        std::string::npos);
}

TEST_CASE("glTF that reaches beyond its bytes is refused", "[io][gltf]") {
  const std::string big = "18446744073709551615";
  const auto file = [&](const std::string& view, const std::string& accessor,
                        const std::string& rest = primitive(R"("mode":0,"attributes":{"POSITION":0})")) {
    return glb(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":48}],"bufferViews":[{"buffer":0,)" +
                   view + R"(}],"accessors":[{)" + accessor + "}]," + rest + "}",
               bytes_of(kSquare));
  };
  const std::string view = R"("byteLength":48)";
  const auto vec3 = [](const std::string& count, const std::string& more = R"("bufferView":0,)") {
    return more + R"("componentType":5126,"type":"VEC3","count":)" + count;
  };
  CHECK(parse(file(view, vec3("4")), "a.glb").points.size() == 4);
  for (const std::string& content :
       {file(view, vec3("5")),
        file(view, vec3(big)),
        file(view, vec3("4611686018427387905")),
        file(view, vec3("4", R"("bufferView":0,"byteOffset":4,)")),
        file(view, vec3("1", R"("bufferView":0,"byteOffset":)" + big + ",")),
        file(view, vec3("1", R"("bufferView":1,)")),
        file(R"("byteLength":49)", vec3("1")),
        file(R"("byteLength":)" + big, vec3("1")),
        file(R"("byteLength":4,"byteOffset":)" + big, vec3("1")),
        file(view + R"(,"byteStride":8)", vec3("2")),
        file(view + R"(,"byteStride":20)", vec3("4")),
        file(view, vec3(big, "")),
        file(view, vec3("4000000000", "")),
        file(view, R"("bufferView":0,"componentType":5126,"type":"MAT4","count":1)"),
        file(view, R"("bufferView":0,"componentType":5124,"type":"VEC3","count":1)"),
        file(view, R"("bufferView":0,"componentType":5126,"type":"VEC2","count":1)"),
        file(view, vec3("0")),
        file(view, vec3("4"), primitive(R"("attributes":{"POSITION":9})")),
        file(view, vec3("4"), primitive(R"("attributes":{"POSITION":-5})")),
        file(view, vec3("4"), primitive(R"("attributes":{"POSITION":0},"indices":0)")),
        file(view, vec3("4"), primitive(R"("attributes":{"POSITION":0},"material":0)")),
        file(view, vec3("4"), primitive(R"("attributes":{"POSITION":0,"TEXCOORD_0":0})"))})
    CHECK_FALSE(says(content).empty());

  // Sparse: an index, a count and bytes out of range.
  const auto sparse = [&](const std::string& count, const std::string& indices, const std::string& values) {
    return file(view, vec3("4", R"("sparse":{"count":)" + count +
                                    R"(,"indices":{"bufferView":0,"componentType":5121)" + indices +
                                    R"(},"values":{"bufferView":0)" + values + "}},"));
  };
  CHECK(parse(sparse("1", "", ""), "a.glb").points.size() == 4);
  CHECK(says(sparse("5", "", "")).find("sparse") != std::string::npos);
  CHECK(says(sparse("-1", "", "")).find("sparse") != std::string::npos);
  CHECK(says(sparse("1", R"(,"byteOffset":15)", "")).find("does not have") != std::string::npos);
  CHECK(says(sparse("4", R"(,"byteOffset":45)", "")).find("beyond") != std::string::npos);
  CHECK(says(sparse("1", "", R"(,"byteOffset":40)")).find("beyond") != std::string::npos);
  CHECK(says(sparse("1", "", R"(,"byteOffset":-4)")).find("sparse") != std::string::npos);

  if (test::kSanitized) return;
  // Few bytes that ask for very many points: 5,000 nodes of 20,000 zeros.
  std::string nodes = "{\"mesh\":0}", roots = "0";
  for (int i = 1; i < 5000; ++i) {
    nodes += ",{\"mesh\":0}";
    roots += "," + std::to_string(i);
  }
  CHECK(says(file(view, vec3("20000", ""),
                  primitive(R"("mode":0,"attributes":{"POSITION":0})") + R"(,"nodes":[)" + nodes +
                      R"(],"scenes":[{"nodes":[)" + roots + "]}]"))
            .find("more elements than a file of this size") != std::string::npos);
}

TEST_CASE("a damaged glTF file is refused or read, and never worse", "[io][gltf]") {
  Builder b;
  const int position = b.positions(kSquare);
  const int indices =
      b.accessor(b.view(bytes_of(std::vector<std::uint16_t>{0, 1, 2, 1, 3, 2})), 5123, 6, "SCALAR");
  const int replaced = b.view(bytes_of(std::vector<std::uint8_t>{2}));
  const int color = b.accessor(-1, 5126, 4, "VEC4",
                               R"(,"sparse":{"count":1,"indices":{"bufferView":)" + std::to_string(replaced) +
                                   R"(,"componentType":5121},"values":{"bufferView":0}})");
  const std::string scene = b.file(
      R"("materials":[{"name":"m"}],"nodes":[{"mesh":0,"scale":[1,2,-3],"children":[1]},{"mesh":0}],)"
      R"("scenes":[{"nodes":[0]}],"scene":0,"images":[{"bufferView":0,"mimeType":"image/png"}],)" +
      primitive(R"("material":0,"indices":)" + std::to_string(indices) + R"(,"attributes":{"POSITION":)" +
                std::to_string(position) + R"(,"COLOR_0":)" + std::to_string(color) + "}"));
  std::mt19937 random(4);
  for (const std::string& valid : {scene, encode(tetrahedron(), kText), encode(colourful(), kBinary)}) {
    CHECK(parse_mesh(as_bytes(valid), "a.glb"));
    for (std::size_t length = 1; length<valid.size(); length += valid.size()> 4000 ? 7 : 1) {
      // A copy, so that a read past its end is seen by the sanitizer.
      const std::string cut = valid.substr(0, length);
      const auto file = parse_mesh(as_bytes(cut), "a.glb");
      // The text ends in a line feed.
      if (file && length + 1 < valid.size()) FAIL("accepted " << length << " bytes of " << valid.size());
    }
    for (int round = 0; round < (kSanitized ? 1000 : 3000); ++round) {
      std::string mutated = valid;
      for (std::uint32_t n = random() % 4; n < 4; ++n) {
        const std::size_t at = random() % mutated.size();
        if (random() % 2 == 0)
          mutated[at] = static_cast<char>(random() & 0xff);
        else
          mutated[at] = "0123456789-[]{},\":e"[random() % 19];
      }
      const auto file = parse_mesh(as_bytes(mutated), "a.glb");
      if (!file) {
        CHECK_FALSE(file.error().message.empty());
        continue;
      }
      const auto mesh = to_indexed_face_set(*file);
      REQUIRE(mesh);
      CHECK(encode_mesh(*mesh, write_as(FileFormat::kPly, FileEncoding::kBinaryLittleEndian)));
    }
  }
}
