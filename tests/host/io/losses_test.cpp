// What comes back of what was written, and whether what does not is told.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "io/io_support.h"
#include "support/data.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

enum class Of { kPoints, kCorners, kFaces };

const std::vector<Channel>& channels(const IndexedFaceSet& mesh, Of of) {
  return of == Of::kPoints    ? mesh.point_channels
         : of == Of::kCorners ? mesh.corner_channels
                              : mesh.face_channels;
}

/// What the channel of that name gives each corner, wherever it is kept; of a point cloud, each point. Empty
/// where there is none. Colours as fractions.
std::vector<double> corner_values(const IndexedFaceSet& mesh, const std::string& name) {
  for (const Of of : {Of::kCorners, Of::kPoints, Of::kFaces}) {
    const Channel* channel = find_channel(channels(mesh, of), name);
    if (channel == nullptr) continue;
    std::vector<double> values;
    const auto add = [&](std::size_t element) {
      for (unsigned k = 0; k < channel->components; ++k)
        std::visit(
            [&](const auto& v) {
              using T = typename std::decay_t<decltype(v)>::value_type;
              const double one = name == "color" && std::is_integral_v<T>
                                     ? static_cast<double>(std::numeric_limits<T>::max())
                                     : 1.0;
              values.push_back(static_cast<double>(v[element * channel->components + k]) / one);
            },
            channel->values);
    };
    std::size_t corner = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      for (const std::uint32_t point : mesh.face(f)) {
        add(of == Of::kPoints ? point : of == Of::kCorners ? corner : f);
        ++corner;
      }
    for (std::size_t p = 0; mesh.corners.empty() && p < mesh.points.size(); ++p) add(p);
    return values;
  }
  return {};
}

std::vector<std::string> corner_labels(const IndexedFaceSet& mesh, const std::string& name) {
  std::vector<std::string> labels;
  const Channel* channel = find_channel(mesh.face_channels, name);
  if (channel == nullptr || channel->labels.empty()) return labels;
  for (const double value : corner_values(mesh, name))
    labels.push_back(channel->labels[static_cast<std::size_t>(value)]);
  return labels;
}

struct Target {
  const char* file;
  FileEncoding encoding;
};
const std::vector<Target> kTargets = {{"a.ply", FileEncoding::kAscii},
                                      {"a.ply", FileEncoding::kBinaryLittleEndian},
                                      {"a.ply", FileEncoding::kBinaryBigEndian},
                                      {"a.obj", FileEncoding::kAscii},
                                      {"a.off", FileEncoding::kAscii},
                                      {"a.stl", FileEncoding::kAscii},
                                      {"a.stl", FileEncoding::kBinaryLittleEndian},
                                      {"a.gltf", FileEncoding::kAscii},
                                      {"a.glb", FileEncoding::kBinaryLittleEndian},
                                      {"a.iv", FileEncoding::kAscii},
                                      {"a.vrml1", FileEncoding::kAscii},
                                      {"a.wrl", FileEncoding::kAscii},
                                      {"a.xyz", FileEncoding::kAscii}};

bool has_code(const std::vector<FileNote>& notes, const std::string& tail) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const FileNote& note) { return note.is_loss() && note.code.ends_with("." + tail); });
}

template <class T>
ChannelValues spread(std::size_t count, double scale) {
  std::vector<T> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(static_cast<T>(scale * static_cast<double>(1 + i % 7)));
  return values;
}

ChannelValues typed(std::size_t type, std::size_t count) {
  switch (type) {
    case 0:
      return spread<float>(count, 0.1);
    case 1:
      return spread<double>(count, 0.1);
    case 2:
      return spread<std::int8_t>(count, 15);
    case 3:
      return spread<std::uint8_t>(count, 30);
    case 4:
      return spread<std::int16_t>(count, 4000);
    case 5:
      return spread<std::uint16_t>(count, 9000);
    case 6:
      return spread<std::int32_t>(count, 300000000);
    case 7:
      return spread<std::uint32_t>(count, 600000000);
    default:
      return std::vector<float>(count, NAN);
  }
}

/// Writes and reads again. What of the channel is not the same must be told by a code that ends with its
/// name.
void check_told(const IndexedFaceSet& mesh, const std::string& name, const TemporaryFolder& folder) {
  for (const Target& target : kTargets) {
    INFO(target.file << " " << name_of(target.encoding));
    const auto path = folder.path() / target.file;
    WriteOptions options = write_options_for(path).value();
    options.encoding = target.encoding;
    const auto written = write_mesh(path, mesh, options);
    if (!written) {
      // STL has no clouds and no polygons, XYZ nothing else, glTF no polygons.
      CHECK(written.error().code == ErrorCode::kUnsuitable);
      const bool stl = options.format == FileFormat::kStl, gltf = options.format == FileFormat::kGltf;
      CHECK((mesh.corners.empty()
                 ? stl
                 : options.format == FileFormat::kXyz || (!mesh.is_triangles() && (stl || gltf))));
      continue;
    }
    CHECK(losses_of(mesh, options).value() == *written);
    const auto file = read_mesh(path);
    if (!file) FAIL(file.error().describe());
    const IndexedFaceSet back = to_indexed_face_set(*file).value();
    REQUIRE(back.corners.size() == mesh.corners.size());
    if (back.points.size() < mesh.points.size()) CHECK(has_code(*written, "isolated_points"));
    const std::vector<double> before = corner_values(mesh, name), after = corner_values(back, name);
    bool same = before.size() == after.size();
    for (std::size_t i = 0; same && i < before.size(); ++i)
      same = std::abs(before[i] - after[i]) <= 1e-6 * std::abs(before[i]) ||
             (std::isnan(before[i]) && std::isnan(after[i]));
    if (!same) {
      INFO("values of " << name << " differ");
      CHECK((has_code(*written, name) || (name == "color" && has_code(*written, "opacities"))));
    }
    if (corner_labels(mesh, name) != corner_labels(back, name)) {
      INFO("labels of " << name << " differ");
      CHECK((has_code(*written, name) || has_code(*written, "labels")));
    }
  }
}

}  // namespace

TEST_CASE("what a format does not bring back is told by its code", "[io][losses]") {
  const TemporaryFolder folder;
  const std::pair<const char*, unsigned> kinds[] = {{"normal", 3},   {"uv", 2},       {"color", 3},
                                                    {"color", 4},    {"quality", 1},  {"temperature", 1},
                                                    {"velocity", 3}, {"Two words", 1}};
  for (const auto& [name, components] : kinds)
    for (const Of of : {Of::kPoints, Of::kCorners, Of::kFaces})
      // Under sanitizers a few of each.
      for (std::size_t type = 0; type < 27; type += test::kSanitized ? 5 : 1) {
        INFO(name << " x" << components << " of " << static_cast<int>(of) << " type " << type % 9);
        // Triangles, polygons, points alone.
        if (type >= 18 && of != Of::kPoints) continue;
        IndexedFaceSet mesh = type < 9 ? tetrahedron() : quad_cube();
        if (type >= 18) mesh.corners = mesh.face_offsets = {};
        mesh.points.push_back({9, 9, 9});  // No face uses it.
        const std::size_t elements = of == Of::kPoints    ? mesh.points.size()
                                     : of == Of::kCorners ? mesh.corners.size()
                                                          : mesh.face_count();
        Channel channel{name, components, typed(type % 9, elements * components)};
        (of == Of::kPoints    ? mesh.point_channels
         : of == Of::kCorners ? mesh.corner_channels
                              : mesh.face_channels)
            .push_back(std::move(channel));
        check_told(mesh, name, folder);
      }
}

TEST_CASE("names that a format does not bring back are told by their code", "[io][losses]") {
  const TemporaryFolder folder;
  for (const char* name : {"material", "group", "object", "zone"}) {
    INFO(name);
    IndexedFaceSet mesh = tetrahedron();
    mesh.face_channels = {{name, 1, std::vector<std::uint32_t>{0, 0, 1, 1}, {"red paint", "#2"}}};
    check_told(mesh, name, folder);
  }
  IndexedFaceSet mesh = tetrahedron();
  WriteOptions options = write_as(FileFormat::kPly, FileEncoding::kAscii);
  options.material_libraries = {"a.mtl"};
  CHECK(codes(losses_of(mesh, options).value()) == std::vector<std::string>{"dropped.material_libraries"});
  options.format = FileFormat::kObj;
  CHECK(losses_of(mesh, options).value().empty());
  CHECK(parse_file(encode(mesh, options), "a.obj").material_libraries == options.material_libraries);
}

TEST_CASE("colours are one thing in every type, and in every format that holds them", "[io][losses]") {
  // A quarter, a half and all of what the type can say.
  const auto tinted = [](auto one) {
    using T = decltype(one);
    IndexedFaceSet mesh = tetrahedron();
    std::vector<T> values;
    for (int p = 0; p < 4; ++p)
      for (const double part : {0.25, 0.5, 1.0})
        values.push_back(static_cast<T>(part * static_cast<double>(one)));
    mesh.point_channels = {{"color", 3, std::move(values)}};
    return mesh;
  };
  const std::vector<IndexedFaceSet> meshes = {tinted(std::uint8_t{255}),
                                              tinted(std::uint16_t{65535}),
                                              tinted(std::numeric_limits<std::uint32_t>::max()),
                                              tinted(std::numeric_limits<std::int32_t>::max()),
                                              tinted(std::int32_t{255}),
                                              tinted(std::uint16_t{255}),
                                              tinted(1.0f),
                                              tinted(1.0),
                                              tinted(255.0f),
                                              tinted(255.0),
                                              tinted(65535.0f)};
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (const char* name : {"a.ply", "a.obj", "a.off", "a.glb", "a.iv", "a.wrl", "a.vrml1"}) {
      INFO(m << " " << name);
      const auto options = write_options_for(name);
      REQUIRE(options);
      const IndexedFaceSet back = parse(encode(meshes[m], *options), name);
      const std::vector<double> found = corner_values(back, "color");
      REQUIRE(found.size() == 36);
      for (std::size_t i = 0; i < 3; ++i)
        CHECK(found[i] == Approx(i == 0 ? 0.25 : i == 1 ? 0.5 : 1).margin(0.003));
    }
}

TEST_CASE("positions far from the origin keep what their numbers say", "[io][offset]") {
  std::mt19937 random(5);
  const TemporaryFolder folder;
  for (const DVec3& place : {DVec3(500000, 4649776, 10), DVec3(-3e7, 0, 12345678), DVec3(0, 0, 1e9)}) {
    // Text of centimetres, with which strtod() of the C library is compared.
    std::vector<DVec3> exact;
    std::string obj, off = "OFF\n12 4 0\n", ply, xyz;
    ply =
        "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty double y\nproperty double z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    std::string stl = "solid\n",
                wrl = "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate { point [";
    std::uniform_int_distribution<int> centimetres(0, 30);
    for (int i = 0; i < 12; ++i) {
      DVec3 p;
      std::string line;
      for (int axis = 0; axis < 3; ++axis) {
        char text[64];
        std::snprintf(text, sizeof text, "%.2f", place[axis] + centimetres(random) / 100.0);
        p[axis] = std::strtod(text, nullptr);
        line += std::string(axis > 0 ? " " : "") + text;
      }
      exact.push_back(p);
      obj += "v " + line + "\n";
      off += line + "\n";
      ply += line + "\n";
      xyz += line + "\n";
      wrl += line + ", ";
      if (i % 3 == 0) stl += "facet normal 0 0 0\nouter loop\n";
      stl += "vertex " + line + "\n";
      if (i % 3 == 2) stl += "endloop\nendfacet\n";
    }
    wrl += "] } coordIndex [";
    for (int f = 0; f < 4; ++f) {
      const std::string a = std::to_string(3 * f), b = std::to_string(3 * f + 1),
                        c = std::to_string(3 * f + 2);
      obj += "f " + std::to_string(3 * f + 1) + " " + std::to_string(3 * f + 2) + " " +
             std::to_string(3 * f + 3) + "\n";
      off += "3 " + a + " " + b + " " + c + "\n";
      ply += "3 " + a + " " + b + " " + c + "\n";
      wrl += a + ", " + b + ", " + c + ", -1, ";
    }
    stl += "endsolid\n";
    wrl += "] } }\n";
    const std::pair<const char*, std::string> files[] = {{"a.obj", obj}, {"a.off", off}, {"a.ply", ply},
                                                         {"a.xyz", xyz}, {"a.stl", stl}, {"a.wrl", wrl}};
    ReadOptions find;
    find.find_offset = true;
    for (const auto& [name, content] : files) {
      INFO(name << " at " << place.x << " " << place.y << " " << place.z);
      auto file = parse_mesh(as_bytes(content), name, find);
      REQUIRE(file);
      CHECK(file->offset != DVec3(0.0));
      CHECK(codes(file->notes) == std::vector<std::string>{"offset.positions"});
      const auto check = [&](const std::vector<Vec3>& points, const DVec3& offset) {
        REQUIRE(points.size() == 12);
        for (std::size_t i = 0; i < 12; ++i)
          for (int axis = 0; axis < 3; ++axis)
            CHECK(std::abs(static_cast<double>(points[i][axis]) + offset[axis] - exact[i][axis]) < 1e-7);
      };
      const DVec3 offset = file->offset;
      std::vector<Vec3> points;
      if (const auto* soup = std::get_if<PolygonSoup>(&file->geometry))
        points = soup->corners;
      else
        points = std::get<IndexedFaceSet>(file->geometry).points;
      check(points, offset);
      // Where a format holds doubles or text, all comes back.
      IndexedFaceSet mesh;
      mesh.points = points;
      if (std::string(name) != "a.xyz")
        for (std::uint32_t c = 0; c < 12; ++c) mesh.corners.push_back(c);
      for (const char* other :
           {"b.obj", "b.off", "b.ply", "b.gltf", "b.glb", "b.iv", "b.wrl", "b.vrml1", "b.xyz"}) {
        INFO(other);
        WriteOptions options = write_options_for(other).value();
        if (options.format == FileFormat::kXyz) mesh.corners.clear();
        options.offset = offset;
        const std::string bytes = encode(mesh, options);
        const auto again = parse_mesh(as_bytes(bytes), other, find);
        REQUIRE(again);
        check(std::get<IndexedFaceSet>(again->geometry).points, again->offset);
      }
      // Relative to the same offset they are the same bits.
      ReadOptions same;
      same.offset = offset;
      const auto twice = parse_mesh(as_bytes(content), name, same);
      REQUIRE(twice);
      CHECK(twice->offset == offset);
      // Without an offset, what is lost is told.
      CHECK(codes(parse_file(content, name).notes) == std::vector<std::string>{"rounded.positions"});
    }
  }
  // Near the origin nothing is subtracted.
  ReadOptions find;
  find.find_offset = true;
  const auto near = parse_mesh(as_bytes("v 0.1 0 0\nv 1.3 0.7 0\nv 0 1 4\nf 1 2 3\n"), "a.obj", find);
  REQUIRE(near);
  CHECK(near->offset == DVec3(0.0));
  CHECK(near->notes.empty());
}

TEST_CASE("STL says what binary floats lose of an offset", "[io][offset]") {
  IndexedFaceSet mesh = tetrahedron();
  WriteOptions options = write_as(FileFormat::kStl, FileEncoding::kBinaryLittleEndian);
  options.offset = DVec3(1e6, 0, 0);
  IndexedFaceSet whole = mesh;
  for (Vec3& p : whole.points) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
  CHECK(losses_of(whole, options).value().empty());  // Floats hold these numbers.
  CHECK(codes(losses_of(mesh, options).value()) == std::vector<std::string>{"rounded.positions"});
  options.encoding = FileEncoding::kAscii;
  CHECK(losses_of(mesh, options).value().empty());
}

TEST_CASE("formats refuse what they cannot hold at all", "[io][losses]") {
  IndexedFaceSet cloud;
  cloud.points = {{0, 0, 0}, {1, 2, 3}};
  const auto refused = encode_mesh(cloud, write_as(FileFormat::kStl, FileEncoding::kAscii));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::kUnsuitable);
  const auto faces = encode_mesh(tetrahedron(), write_as(FileFormat::kXyz, FileEncoding::kAscii));
  REQUIRE_FALSE(faces);
  CHECK(faces.error().code == ErrorCode::kUnsuitable);
  cloud.point_channels = {{"normal", 3, std::vector<float>{0, 0, 1, 1, 0, 0}},
                          {"color", 3, std::vector<std::uint8_t>{9, 8, 7, 255, 0, 1}}};
  require_same(cloud, parse(encode(cloud, write_as(FileFormat::kXyz, FileEncoding::kAscii)), "a.xyz"));
}
