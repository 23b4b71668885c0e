// Pictures, judged by statements about their pixels, and compared with reference pictures.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/surface_values.h>
#include <vkmesh/engine/draw/draw.h>
#include <vkmesh/engine/passes/vertex_normals.h>
#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/passes/vertex_normals.h>
#include <vkmesh/picture/png.h>

#include "support/device.h"
#include "support/shapes.h"

namespace vkmesh::test {
namespace {

constexpr Color kWhite{255, 255, 255, 255};

/// Subdivisions of a sphere. Under GPU-assisted validation few enough for llvmpipe to take all vertices at
/// once: docs/testing.md says why.
std::uint32_t levels(std::uint32_t wanted) {
  return gpu_assisted() ? std::min(wanted, 3u) : wanted;
}

template <class T>
T value(Result<T> result) {
  if (!result) FAIL(result.error().describe());
  return *std::move(result);
}

void succeed(const Result<void>& result) {
  if (!result) FAIL(result.error().describe());
}

/// From +z at the origin; the picture is four units high.
Camera front_view() {
  Camera camera;
  camera.eye = {0, 0, 5};
  camera.target = {0, 0, 0};
  camera.projection = Projection::kOrthographic;
  camera.visible_height = 4;
  camera.near = 1;
  camera.far = 9;
  return camera;
}

Picture draw(const DrawGeometry& geometry, const DrawStyle& style, const Camera& camera,
             std::uint32_t width = 128, std::uint32_t height = 128) {
  RenderTarget target = value(RenderTarget::create(test_context(), width, height));
  Recorder recorder = value(Recorder::create(test_context()));
  succeed(record_draw(recorder, geometry, camera, style, target));
  succeed(recorder.submit_and_wait());
  return value(target.download());
}

/// Under GPU-assisted validation repeats the last values until there are eight elements or a multiple, as
/// llvmpipe then needs (docs/testing.md). What is drawn a second time, or has no area, does not show.
template <class T>
std::vector<T> filled(std::span<const T> values, std::size_t per_element = 1, std::size_t repeated = 1) {
  std::vector<T> result(values.begin(), values.end());
  while (gpu_assisted() && result.size() % (8 * per_element) != 0)
    result.push_back(result[result.size() - repeated]);
  return result;
}

Picture draw(const IndexedFaceSet& mesh, const DrawStyle& style, const Camera& camera,
             const DrawMeshData& data = {}, std::uint32_t width = 128, std::uint32_t height = 128) {
  const std::size_t per_element = data.element == DrawElement::kCorner ? 3 : 1;
  IndexedFaceSet whole;
  whole.points = filled<Vec3>(mesh.points);
  whole.corners = filled<std::uint32_t>(mesh.corners, 3);
  const auto normals = filled(data.normals);
  const auto values = filled(data.values, per_element);
  const auto colors = filled(data.colors, per_element);
  const auto source_face = filled(data.source_face);
  const auto spacing = filled(data.spacing);
  DrawMeshData whole_data{.normals = normals,
                          .values = values,
                          .colors = colors,
                          .element = data.element,
                          .source_face = source_face,
                          .spacing = spacing,
                          .edges = data.edges};
  std::vector<std::vector<std::uint32_t>> ends;
  for (DrawMeshData::Edges& edges : whole_data.edges) {
    ends.push_back(filled(edges.ends, 2, 2));
    edges.ends = ends.back();
  }
  const DrawMesh on_device = value(DrawMesh::create(test_context(), whole, whole_data));
  return draw(on_device.geometry(), style, camera, width, height);
}

bool same(const Picture& a, const Picture& b) {
  return a.width() == b.width() && a.height() == b.height() &&
         std::equal(a.pixels().begin(), a.pixels().end(), b.pixels().begin());
}

std::size_t covered(const Picture& picture, Color background = kWhite) {
  return picture.pixels().size() -
         static_cast<std::size_t>(std::count(picture.pixels().begin(), picture.pixels().end(), background));
}

int largest_difference(Color a, Color b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

int largest_difference(const Picture& a, const Picture& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.pixels().size(); ++i)
    largest = std::max(largest, largest_difference(a.pixels()[i], b.pixels()[i]));
  return largest;
}

IndexedFaceSet turned_over(IndexedFaceSet mesh) {
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3)
    std::swap(mesh.corners[i + 1], mesh.corners[i + 2]);
  return mesh;
}

PolygonSoup soup_of(const IndexedFaceSet& mesh) {
  PolygonSoup soup;
  for (const std::uint32_t c : mesh.corners) soup.corners.push_back(mesh.points[c]);
  return soup;
}

/// The light that a person sees around a pixel: the mean of three by three.
std::vector<std::array<double, 3>> blurred(const Picture& picture) {
  std::vector<std::array<double, 3>> result;
  for (std::uint32_t y = 1; y + 1 < picture.height(); ++y)
    for (std::uint32_t x = 1; x + 1 < picture.width(); ++x) {
      std::array<double, 3> sum{};
      for (std::uint32_t dy = 0; dy < 3; ++dy)
        for (std::uint32_t dx = 0; dx < 3; ++dx) {
          const Color& c = picture.at(x + dx - 1, y + dy - 1);
          sum[0] += c.r / 9.0;
          sum[1] += c.g / 9.0;
          sum[2] += c.b / 9.0;
        }
      result.push_back(sum);
    }
  return result;
}

/// By how much pixels differ, of 255, when both pictures are blurred.
struct Difference {
  double mean = 0, largest = 0;
};

Difference difference(const Picture& picture, const Picture& expected) {
  const auto a = blurred(picture), b = blurred(expected);
  Difference found;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      found.mean += std::abs(a[i][c] - b[i][c]) / (3.0 * static_cast<double>(a.size()));
      found.largest = std::max(found.largest, std::abs(a[i][c] - b[i][c]));
    }
  return found;
}

/// Drivers place the samples of edges a little differently, and round colours by a step or two. A shift by
/// one pixel is more than this.
constexpr Difference kTolerance{1.0, 24.0};

/// For what is lines and points alone: SwiftShader draws them a shade darker than llvmpipe, which drew the
/// references (by 2.3 on average and 25.1 at most). There, too, a shift by one pixel is more: 3.9 on average.
Difference tolerance_of_lines() {
  return is_swiftshader(test_context()) ? Difference{2.5, 28.0} : kTolerance;
}

void compare_with_reference(const Picture& picture, const std::string& name,
                            const Difference& tolerance = kTolerance) {
  const std::filesystem::path reference = std::filesystem::path(VKMESH_REFERENCE_DIR) / (name + ".png");
  const std::filesystem::path actual = std::filesystem::temp_directory_path() / ("vkmesh_" + name + ".png");
  const auto differs = [&](const std::string& how) {
    succeed(write_png(actual, picture));
    FAIL_CHECK(name << " " << how << "; the picture drawn is " << actual.string());
  };
  std::ifstream file(reference, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.empty()) return differs("has no reference " + reference.string());
  const Picture expected = value(decode_png(std::as_bytes(std::span(bytes))));
  if (expected.width() != picture.width() || expected.height() != picture.height())
    return differs("has another size than its reference");
  const Difference found = difference(picture, expected);
  if (found.mean > tolerance.mean || found.largest > tolerance.largest)
    differs("differs from its reference by " + std::to_string(found.mean) + " on average, " +
            std::to_string(found.largest) + " at most");
}

}  // namespace

TEST_CASE("a sphere's silhouette is a disc of its radius around its centre", "[draw]") {
  IndexedFaceSet sphere = icosphere(levels(5));
  // Off centre, so that a picture that is mirrored or turned is seen.
  for (Vec3& p : sphere.points) p += Vec3(0.5f, 0.25f, 0.0f);
  const std::vector<Vec3> normals = value(point_normals(sphere));
  for (const DrawMode mode : {DrawMode::kShaded, DrawMode::kFlat}) {
    const Picture picture = draw(sphere, {.mode = mode}, front_view(), {.normals = normals});
    // Four units are 128 pixels: the centre is 16 to the right of the middle and 8 above it.
    double wrong = 0, x_sum = 0, y_sum = 0, count = 0;
    for (std::uint32_t y = 0; y < 128; ++y)
      for (std::uint32_t x = 0; x < 128; ++x) {
        const double from_center = std::hypot(x + 0.5 - 80.0, y + 0.5 - 56.0);
        const bool drawn = picture.at(x, y) != kWhite;
        if ((from_center < 31.0 && !drawn) || (from_center > 33.0 && drawn)) ++wrong;
        if (!drawn) continue;
        x_sum += x + 0.5;
        y_sum += y + 0.5;
        ++count;
      }
    CHECK(wrong == 0);
    CHECK(x_sum / count == Approx(80.0).margin(0.1));
    CHECK(y_sum / count == Approx(56.0).margin(0.1));
  }
}

TEST_CASE("perspective shows a sphere as large as its tangent cone", "[draw]") {
  Camera camera = front_view();
  camera.projection = Projection::kPerspective;
  camera.field_of_view = 40;
  const Picture picture = draw(icosphere(levels(5)), {}, camera);
  // The cone touches at asin(1/5) off the axis.
  const double radius = 64.0 * std::tan(std::asin(1.0 / 5.0)) / std::tan(20.0 * std::numbers::pi / 180.0);
  const double area = std::numbers::pi * radius * radius;
  const auto drawn = static_cast<double>(covered(picture));
  CHECK(drawn > std::numbers::pi * (radius - 0.5) * (radius - 0.5));
  CHECK(drawn < area + 2.0 * std::numbers::pi * radius);
}

TEST_CASE("the normal colours of a cube are its six", "[draw]") {
  IndexedFaceSet box = cube();
  for (Vec3& p : box.points) p -= Vec3(0.5f);
  const DrawStyle style{.mode = DrawMode::kFlat, .colors = DrawColors::kNormal};
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {1.0, -1.0}) {
      Camera camera = front_view();
      camera.eye = DVec3(0.0);
      camera.eye[axis] = 5.0 * side;
      camera.up = axis == 1 ? DVec3(0, 0, 1) : DVec3(0, 1, 0);
      const Picture picture = draw(box, style, camera);
      const auto component = [&](int c) {
        return static_cast<std::uint8_t>(c != axis ? 128 : side > 0 ? 255 : 0);
      };
      const Color expected{component(0), component(1), component(2)};
      CAPTURE(axis, side);
      // 0.5 may be written as 127 or 128.
      CHECK(largest_difference(picture.at(64, 64), expected) <= 1);
    }
  // From a corner three faces are seen, each of one colour.
  const Camera corner = value(frame_camera(
      box.points, 1.0, {.azimuth = 40, .elevation = 30, .projection = Projection::kOrthographic}));
  const Picture picture = draw(box, style, corner);
  std::map<std::tuple<int, int, int>, int> colors;
  for (const Color& c : picture.pixels()) ++colors[{c.r, c.g, c.b}];
  std::size_t faces = 0;
  for (const auto& [color, count] : colors)
    if (count > 500 && color != std::tuple(255, 255, 255)) ++faces;
  CHECK(faces == 3);
}

TEST_CASE("what lies behind the camera is not drawn", "[draw]") {
  const IndexedFaceSet sphere = icosphere(3);
  const std::vector<std::uint32_t> ends = {0, 1, 2, 3, 4, 5};
  const std::vector<float> spacing(sphere.points.size(), 0.1f);
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic})
    for (const DrawMode mode :
         {DrawMode::kShaded, DrawMode::kWireframe, DrawMode::kPoints, DrawMode::kSplats}) {
      Camera camera = front_view();
      camera.projection = projection;
      camera.target = {0, 0, 10};
      const Picture picture =
          draw(sphere, {.mode = mode}, camera, {.spacing = spacing, .edges = {{ends, {200, 0, 0}, 3.0f}}});
      CHECK(covered(picture) == 0);
    }
}

TEST_CASE("a camera inside a mesh sees it all around", "[draw]") {
  Camera camera;
  camera.eye = {0.1, 0, 0};
  camera.target = {0, 0, 1};
  camera.near = 0.01;
  camera.far = 3;
  CHECK(covered(draw(icosphere(3), {}, camera)) == 128 * 128);
}

TEST_CASE("positions that are not finite are refused, and the first is named") {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    IndexedFaceSet mesh = tetrahedron();
    mesh.points[2].y = bad;
    const auto refused = DrawMesh::create(test_context(), mesh);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::kUnsuitable);
    CHECK(refused.error().message.find("point 2") != std::string::npos);
    CHECK_FALSE(DrawMesh::create(test_context(), soup_of(mesh)));
  }
}

TEST_CASE("an empty mesh gives a plain picture") {
  for (const DrawMode mode : {DrawMode::kShaded, DrawMode::kFlat, DrawMode::kPoints, DrawMode::kSplats}) {
    const Picture picture = draw(IndexedFaceSet{}, {.mode = mode, .background = {10, 20, 30}}, front_view());
    CHECK(covered(picture, {10, 20, 30, 255}) == 0);
  }
}

TEST_CASE("flipped faces show the warning colour on request, and are lit like others otherwise", "[draw]") {
  const IndexedFaceSet sphere = icosphere(4), flipped = turned_over(sphere);
  const std::vector<Vec3> normals = value(point_normals(sphere)), inward = value(point_normals(flipped));
  const DrawStyle plain, warning{.show_flipped = true};
  const Picture good = draw(sphere, plain, front_view(), {.normals = normals});
  const Picture watched = draw(sphere, warning, front_view(), {.normals = normals});
  if (is_swiftshader(test_context())) {
    // Its pipelines for the two take other values at the silhouette.
    CHECK(difference(watched, good).mean <= kTolerance.mean);
    CHECK(difference(watched, good).largest <= kTolerance.largest);
  } else {
    CHECK(same(watched, good));
  }
  const Picture bad = draw(flipped, warning, front_view(), {.normals = inward});
  CHECK(largest_difference(bad.at(64, 64), warning.flipped) <= 1);
  for (std::uint32_t y = 0; y < 128; ++y)
    for (std::uint32_t x = 0; x < 128; ++x)
      if (std::hypot(x + 0.5 - 64.0, y + 0.5 - 64.0) < 31.0) {
        const Color c = bad.at(x, y);
        if (!(c.r > 180 && c.g < 20 && c.b > 110)) FAIL("no warning colour at " << x << ", " << y);
      }
  CHECK(largest_difference(draw(flipped, plain, front_view(), {.normals = inward}), good) <= 2);
  // A single flipped face, among neighbours whose normals are right.
  IndexedFaceSet one = sphere;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < one.corners.size(); i += 3)
    if (one.points[one.corners[i]].z > one.points[one.corners[nearest]].z) nearest = i;
  std::swap(one.corners[nearest + 1], one.corners[nearest + 2]);
  CHECK(largest_difference(draw(one, plain, front_view(), {.normals = normals}), good) <= 2);
}

TEST_CASE("light comes from before and above the mesh", "[draw]") {
  const IndexedFaceSet sphere = icosphere(4);
  const std::vector<Vec3> normals = value(point_normals(sphere));
  const Picture picture = draw(sphere, {}, front_view(), {.normals = normals});
  CHECK(picture.at(64, 46).g > picture.at(64, 82).g + 20);
  CHECK(picture.at(64, 64).g > picture.at(64, 90).g + 20);
  CHECK(picture.at(64, 64).g > picture.at(92, 64).g + 20);
}

TEST_CASE("the same input gives the same bytes", "[draw]") {
  IndexedFaceSet mesh = gpu_assisted() ? torus(30, 20) : torus(60, 40);
  jitter(mesh, 0.05f, 3);
  const std::vector<Vec3> normals = value(point_normals(mesh));
  const std::vector<float> spacing = value(point_spacing(mesh.points));
  for (const DrawMode mode : {DrawMode::kShaded, DrawMode::kFlat, DrawMode::kWireframe, DrawMode::kShadedWire,
                              DrawMode::kPoints, DrawMode::kSplats}) {
    const DrawMeshData data{.normals = normals, .spacing = spacing};
    const Picture first = draw(mesh, {.mode = mode}, front_view(), data);
    CHECK(covered(first) > 500);
    CHECK(same(first, draw(mesh, {.mode = mode}, front_view(), data)));
  }
}

TEST_CASE("a soup is drawn like the face set that it was made from", "[draw]") {
  const IndexedFaceSet mesh = torus(20, 12);
  const DrawMesh soup = value(DrawMesh::create(test_context(), soup_of(mesh)));
  const DrawStyle style{.mode = DrawMode::kFlat};
  const Picture picture = draw(mesh, style, front_view());
  CHECK(covered(picture) > 1000);
  CHECK(same(draw(soup.geometry(), style, front_view()), picture));
}

TEST_CASE("vertex and index buffers, and corners one by one, give the same picture", "[draw]") {
  const IndexedFaceSet mesh = torus(32, 20);
  const std::vector<Vec3> normals = value(point_normals(mesh));
  const DrawMeshData data{.normals = normals};
  const Picture indexed = draw(mesh, {}, front_view(), data);
  // Edges of no width take the other way.
  const Picture corners =
      draw(mesh, {.mode = DrawMode::kShadedWire, .edge_width = -2.0f}, front_view(), data);
  CHECK(largest_difference(indexed, corners) <= 1);
}

TEST_CASE("a mesh on the device is drawn right after the pass that makes its normals", "[draw]") {
  const IndexedFaceSet mesh = torus(40, 24);
  const HalfEdgeMesh connectivity = half_edges(mesh);
  DeviceMesh on_device = value(DeviceMesh::create(test_context(), connectivity, mesh.points));
  DeviceVertexNormals with;
  RenderTarget target = value(RenderTarget::create(test_context(), 128, 128));
  Recorder recorder = value(Recorder::create(test_context()));
  succeed(record_vertex_normals(recorder, on_device, with));
  DrawGeometry geometry = value(geometry_of(on_device));
  geometry.normals = &with.normals.buffer();
  succeed(record_draw(recorder, geometry, front_view(), {}, target));
  // Once more into the same target, which must wait for the first.
  succeed(record_draw(recorder, geometry, front_view(), {}, target));
  // Within the pass; before the first drawing; around the second one's parameters. Validation sees no reads
  // by address, and a device in software works in order, so that a barrier that is not there shows nowhere
  // else.
  CHECK(recorder.counts().barriers == 4);
  succeed(recorder.submit_and_wait());
  const std::vector<Vec3> normals = value(point_normals(mesh));
  CHECK(same(value(target.download()), draw(mesh, {}, front_view(), {.normals = normals})));
}

TEST_CASE("faces, corners and points carry colours of their own", "[draw]") {
  // Two triangles: the left one, and the right one.
  IndexedFaceSet mesh;
  mesh.points = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.corners = {0, 2, 3, 0, 1, 2};
  const DrawStyle direct{.colors = DrawColors::kDirect};
  const std::vector<Color> faces = {{200, 0, 0}, {0, 0, 200}};
  const Picture by_face = draw(mesh, direct, front_view(), {.colors = faces, .element = DrawElement::kFace});
  const Color left = by_face.at(50, 54), right = by_face.at(78, 74);
  CHECK((left.r > 120 && left.g == 0 && left.b == 0));
  CHECK((right.r == 0 && right.g == 0 && right.b > 120));

  // Corner colours: all of the first triangle red but its corner 3, which is green.
  const std::vector<Color> corners = {{200, 0, 0}, {200, 0, 0}, {0, 200, 0},
                                      {0, 0, 200}, {0, 0, 200}, {0, 0, 200}};
  const Picture by_corner =
      draw(mesh, direct, front_view(), {.colors = corners, .element = DrawElement::kCorner});
  CHECK(by_corner.at(34, 34).g > by_corner.at(34, 34).r);
  CHECK(by_corner.at(62, 60).r > by_corner.at(62, 60).g);
  CHECK(by_corner.at(78, 74).b > 120);

  // Values: 0 and 1 are the ends of the map, one without a value is grey.
  const std::vector<Vec3> normals(4, Vec3(0, 0, 1));
  const DrawStyle mapped{.colors = DrawColors::kValue};
  const std::vector<float> values = {0.0f, std::numeric_limits<float>::quiet_NaN()};
  const Picture by_value =
      draw(mesh, mapped, front_view(), {.values = values, .element = DrawElement::kFace});
  const Color low = by_value.at(50, 54), none = by_value.at(78, 74);
  CHECK(low.b > low.g);
  CHECK((none.r == none.g && none.g == none.b));
  const std::vector<float> ones(4, 1.0f);
  const Color high = draw(mesh, mapped, front_view(), {.normals = normals, .values = ones}).at(64, 70);
  CHECK((high.r > 2 * high.b && high.g > 2 * high.b));
}

TEST_CASE("edges are drawn over the surface they lie on, and hidden behind another", "[draw]") {
  const IndexedFaceSet mesh = fin();
  Camera camera = front_view();
  // From below, where the shared edge is a ridge.
  camera.target = {0.5, 0, 0};
  camera.eye = {0.5, -1, -5};
  const Color red{220, 20, 30};
  const std::vector<std::uint32_t> shared = {0, 1};
  const auto reds = [&](const Picture& picture) {
    return std::count(picture.pixels().begin(), picture.pixels().end(), red);
  };
  const Picture shown = draw(mesh, {}, camera, {.edges = {{shared, red, 4.0f}}});
  // One unit is 32 pixels long, and the line 4 wide.
  CHECK(reds(shown) > 80);
  CHECK(reds(shown) < 180);
  CHECK(reds(draw(mesh, {}, camera)) == 0);

  IndexedFaceSet covered_edge = icosphere(3);
  const auto first = static_cast<std::uint32_t>(covered_edge.points.size());
  covered_edge.points.insert(covered_edge.points.end(),
                             {{-0.5f, 0, -2}, {0.5f, 0, -2}, {-0.5f, 0, 2}, {0.5f, 0, 2}});
  const std::vector<std::uint32_t> behind = {first, first + 1}, before = {first + 2, first + 3};
  CHECK(reds(draw(covered_edge, {}, front_view(), {.edges = {{behind, red, 4.0f}}})) == 0);
  CHECK(reds(draw(covered_edge, {}, front_view(), {.edges = {{before, red, 4.0f}}})) > 100);
}

TEST_CASE("an edge that reaches behind the camera is drawn up to its plane", "[draw]") {
  IndexedFaceSet mesh;
  mesh.points = {{0, -1, 0}, {0, -1, 20}};
  Camera camera = front_view();
  camera.projection = Projection::kPerspective;
  camera.near = 0.01;
  for (const std::vector<std::uint32_t>& ends :
       {std::vector<std::uint32_t>{0, 1}, std::vector<std::uint32_t>{1, 0}}) {
    const Picture picture = draw(mesh, {}, camera, {.edges = {{ends, {220, 20, 30}, 4.0f}}});
    // It runs downwards from its far end to the lower edge of the picture, and nowhere else.
    std::size_t above = 0, below = 0;
    for (std::uint32_t y = 0; y < 128; ++y)
      for (std::uint32_t x = 0; x < 128; ++x)
        if (picture.at(x, y) != kWhite) {
          ++(y < 64 ? above : below);
          CHECK(std::abs(static_cast<int>(x) - 64) <= 3);
        }
    CHECK(above == 0);
    CHECK(below > 60);
  }
}

TEST_CASE("points are dots, and splats are discs across their normals", "[draw]") {
  IndexedFaceSet cloud;
  cloud.points = {{0, 0, 0}};
  const Picture dot = draw(cloud, {.mode = DrawMode::kPoints, .point_size = 20.0f}, front_view());
  CHECK(static_cast<double>(covered(dot)) == Approx(std::numbers::pi * 100).epsilon(0.25));
  CHECK(dot.at(64, 64) != kWhite);

  const std::vector<float> radius = {1.0f};
  const DrawStyle splats{.mode = DrawMode::kSplats, .splat_scale = 0.5f};
  const auto covered_with = [&](const std::vector<Vec3>& normals) {
    return static_cast<double>(
        covered(draw(cloud, splats, front_view(), {.normals = normals, .spacing = radius})));
  };
  // Half a unit is 16 pixels.
  const double round = covered_with({}), facing = covered_with({{0, 0, 1}});
  const double oblique = covered_with({{0.8660254f, 0, 0.5f}}), edge_on = covered_with({{1, 0, 0}});
  CHECK(round == Approx(std::numbers::pi * 256).epsilon(0.15));
  CHECK(facing == Approx(round).epsilon(0.05));
  CHECK(oblique == Approx(round / 2).epsilon(0.2));
  CHECK(edge_on < 40);

  // None is smaller than a pixel across, whatever the shape of the picture.
  const std::vector<float> tiny = {1e-6f};
  const std::size_t smallest = covered(draw(cloud, splats, front_view(), {.spacing = tiny}, 512, 64));
  CHECK(smallest > 0);
  CHECK(smallest <= 4);
}

TEST_CASE("wireframes show the edges of polygons, and not those that cut them into triangles", "[draw]") {
  IndexedFaceSet quads = quad_cube();
  for (Vec3& p : quads.points) p = (p - Vec3(0.5f)) * 2.0f;
  const Triangulated cut = value(triangulate(quads));
  const DrawStyle style{.mode = DrawMode::kWireframe};
  const Picture polygons = draw(cut.mesh, style, front_view(), {.source_face = cut.source_face});
  CHECK(covered(polygons) > 100);
  std::size_t inside = 0;
  for (std::uint32_t y = 36; y < 92; ++y)
    for (std::uint32_t x = 36; x < 92; ++x) inside += polygons.at(x, y) != kWhite;
  CHECK(inside == 0);
  // With every edge of the triangles both diagonals cross the middle, or lie on each other.
  CHECK(draw(cut.mesh, style, front_view()).at(63, 63) != draw(cut.mesh, style, front_view()).at(63, 40));
}

TEST_CASE("a picture of no pixels, or more than the device draws, is refused with the limit") {
  for (const auto& [width, height] : {std::pair{0u, 0u}, std::pair{0u, 10u}, std::pair{10u, 0u}}) {
    const auto refused = RenderTarget::create(test_context(), width, height);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::kUsage);
  }
  const auto refused = RenderTarget::create(test_context(), 100000, 100000);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::kUsage);
  CHECK(refused.error().message.find("at most") != std::string::npos);
}

TEST_CASE("cameras and styles that make no sense are refused") {
  const DrawMesh mesh = value(DrawMesh::create(test_context(), tetrahedron()));
  RenderTarget target = value(RenderTarget::create(test_context(), 16, 16));
  Recorder recorder = value(Recorder::create(test_context()));
  const auto refused = [&](const DrawStyle& style, const std::function<void(Camera&)>& change) {
    Camera camera = front_view();
    change(camera);
    const auto result = record_draw(recorder, mesh.geometry(), camera, style, target);
    return !result && result.error().code == ErrorCode::kUsage;
  };
  CHECK(refused({}, [](Camera& c) { c.target = c.eye; }));
  CHECK(refused({}, [](Camera& c) { c.up = {0, 0, 1}; }));
  CHECK(refused({}, [](Camera& c) { c.far = c.near; }));
  CHECK(refused({}, [](Camera& c) { c.visible_height = 0; }));
  CHECK(refused({}, [](Camera& c) {
    c.projection = Projection::kPerspective;
    c.near = 0;
  }));
  CHECK(refused({.colors = DrawColors::kValue}, [](Camera&) {}));
  CHECK(refused({.mode = DrawMode::kSplats}, [](Camera&) {}));
  CHECK_FALSE(refused({}, [](Camera&) {}));
}

TEST_CASE("meshes far from zero keep their shape", "[draw]") {
  // At 2^20 a float resolves an eighth: the sphere is made of multiples of that.
  IndexedFaceSet sphere = icosphere(levels(4), 64.0f);
  for (Vec3& p : sphere.points)
    p = Vec3(std::round(p.x * 8), std::round(p.y * 8), std::round(p.z * 8)) / 8.0f;
  IndexedFaceSet far_away = sphere;
  for (Vec3& p : far_away.points) p += Vec3(1048576.0f, -1048576.0f, 1048576.0f);
  const auto picture = [&](const IndexedFaceSet& mesh) {
    return draw(mesh, {.mode = DrawMode::kFlat}, value(frame_camera(mesh.points, 1.0)));
  };
  CHECK(largest_difference(picture(sphere), picture(far_away)) <= 2);
}

TEST_CASE("pictures look like their references", "[draw]") {
  IndexedFaceSet mesh = torus(36, 18);
  const std::vector<Vec3> normals = value(point_normals(mesh));
  const std::vector<float> spacing = value(point_spacing(mesh.points));
  const auto edges = value(surface_edges(mesh));
  const auto angles = value(signed_dihedral_angles(mesh, edges));
  const std::vector<float> curvature = value(mean_curvatures(mesh, edges, angles));
  const DrawMesh on_device = value(
      DrawMesh::create(test_context(), mesh, {.normals = normals, .values = curvature, .spacing = spacing}));
  const Camera camera = value(frame_camera(mesh.points, 4.0 / 3.0, {.azimuth = 25, .elevation = 35}));
  const auto picture = [&](const DrawStyle& style) {
    return draw(on_device.geometry(), style, camera, 160, 120);
  };
  compare_with_reference(picture({}), "torus_shaded");
  compare_with_reference(picture({.mode = DrawMode::kFlat}), "torus_flat");
  compare_with_reference(picture({.mode = DrawMode::kWireframe}), "torus_wireframe", tolerance_of_lines());
  compare_with_reference(picture({.mode = DrawMode::kShadedWire}), "torus_shaded_wire");
  compare_with_reference(picture({.mode = DrawMode::kSplats, .splat_scale = 0.5f}), "torus_splats");
  compare_with_reference(picture({.mode = DrawMode::kPoints}), "torus_points", tolerance_of_lines());
  compare_with_reference(picture({.colors = DrawColors::kNormal}), "torus_normals");
  compare_with_reference(
      picture({.colors = DrawColors::kValue, .map = ColorMap::kDiverging, .range = {-2.0, 2.0}}),
      "torus_curvature");
}

}  // namespace vkmesh::test
