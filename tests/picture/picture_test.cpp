// Pictures, colour maps, legends, cameras, and the numbers that are seen in pictures.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/surface_values.h>
#include <vkmesh/passes/vertex_normals.h>
#include <vkmesh/picture/contact_sheet.h>
#include <vkmesh/picture/png.h>
#include <vkmesh/picture/text.h>
#include <vkmesh/view/camera.h>
#include <vkmesh/view/color_map.h>
#include <vkmesh/view/picture.h>

#include "support/shapes.h"

namespace vkmesh::test {
namespace {

constexpr Color kWhite{255, 255, 255, 255}, kBlack{0, 0, 0, 255};

template <class T>
T value(Result<T> result) {
  if (!result) FAIL(result.error().describe());
  return *std::move(result);
}

std::ptrdiff_t count(const Picture& picture, Color color) {
  return std::count(picture.pixels().begin(), picture.pixels().end(), color);
}

/// CIE lightness, computed from the definition of sRGB.
double lightness(Color c) {
  const auto linear = [](double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); };
  const double y = 0.2126 * linear(c.r / 255.0) + 0.7152 * linear(c.g / 255.0) + 0.0722 * linear(c.b / 255.0);
  return y > 216.0 / 24389.0 ? 116.0 * std::cbrt(y) - 16.0 : y * 24389.0 / 27.0;
}

int step(Color a, Color b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

}  // namespace

TEST_CASE("a PNG holds the picture, and is the same each time") {
  Picture picture = value(Picture::create(33, 7, kWhite));
  std::uint8_t next = 0;
  for (Color& c : picture.pixels())
    c = {next, static_cast<std::uint8_t>(next * 3), static_cast<std::uint8_t>(++next), 255};
  const std::vector<std::byte> png = value(encode_png(picture));
  CHECK(png == value(encode_png(picture)));
  const Picture back = value(decode_png(png));
  CHECK(back.width() == 33);
  CHECK(back.height() == 7);
  CHECK(std::equal(back.pixels().begin(), back.pixels().end(), picture.pixels().begin()));

  CHECK(encode_png(Picture{}).error().code == ErrorCode::kUsage);
  CHECK(decode_png({}).error().code == ErrorCode::kUnreadable);
  for (std::size_t length : {std::size_t{10}, png.size() / 2})
    CHECK(decode_png(std::span(png).first(length)).error().code == ErrorCode::kUnreadable);
  CHECK(Picture::create(kMaxPictureSide + 1, 1, kWhite).error().code == ErrorCode::kUsage);
}

TEST_CASE("a picture that cannot be written leaves nothing") {
  const auto folder = std::filesystem::temp_directory_path() / "vkmesh_picture_test";
  std::filesystem::create_directories(folder / "taken.png");
  const Picture picture = value(Picture::create(2, 2, kWhite));
  CHECK(write_png(folder / "none" / "a.png", picture).error().code == ErrorCode::kNotWritable);
  CHECK(write_png(folder / "taken.png", picture).error().code == ErrorCode::kNotWritable);
  CHECK(write_png(folder / "good.png", picture));
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++files;
  CHECK(files == 2);
  std::filesystem::remove_all(folder);
}

TEST_CASE("colours are read as they are written in style sheets") {
  CHECK(value(parse_color("#10a0ff")) == Color{0x10, 0xa0, 0xff});
  CHECK(value(parse_color("#1af")) == Color{0x11, 0xaa, 0xff});
  CHECK(value(parse_color("white")) == kWhite);
  for (const char* bad : {"", "#", "#12", "#1234567", "#12345g", "red", "-12345", "#-1"}) {
    CAPTURE(bad);
    CHECK_FALSE(parse_color(bad));
  }
}

TEST_CASE("text takes the place that it says, and no other") {
  const std::string text = "\xc3\x84gypten|8, 50 % \xe2\x80\xa6";
  for (const std::uint32_t size : {11u, 15u, 30u}) {
    CAPTURE(size);
    TextFace face = value(TextFace::create(size));
    const std::int64_t high = line_height(size), wide = face.width(text);
    Picture picture = value(Picture::create(static_cast<std::uint32_t>(wide) + 20,
                                            static_cast<std::uint32_t>(high) + 10, kWhite));
    face.draw(picture, 10, 5, text, kBlack);
    std::int64_t left = 1000, right = 0, top = 1000, bottom = 0;
    std::size_t black = 0, grey = 0;
    for (std::uint32_t y = 0; y < picture.height(); ++y)
      for (std::uint32_t x = 0; x < picture.width(); ++x) {
        if (picture.at(x, y) == kWhite) continue;
        ++(picture.at(x, y) == kBlack ? black : grey);
        left = std::min<std::int64_t>(left, x);
        right = std::max<std::int64_t>(right, x + 1);
        top = std::min<std::int64_t>(top, y);
        bottom = std::max<std::int64_t>(bottom, y + 1);
      }
    CHECK(left >= 10);
    CHECK(left <= 10 + size / 5);
    CHECK(right <= 10 + wide);
    CHECK(right >= 10 + wide - size / 3);
    CHECK(top >= 5);
    CHECK(bottom <= 5 + high);
    CHECK(bottom - top >= size);  // from the dots of the first letter down to the tail of the second
    CHECK(grey > 0);              // anti-aliased
    if (size == 30) CHECK(black > 0);
    // Half outside of the picture, and far outside.
    face.draw(picture, -20, -3, text, kBlack);
    face.draw(picture, wide, high, text, kBlack);
    face.draw(picture, 4000, 4000, text, kBlack);
  }
}

TEST_CASE("text is UTF-8: letters have their own shapes, what is none has one") {
  TextFace face = value(TextFace::create(20));
  const auto drawn = [&](std::string_view text) {
    Picture picture = value(Picture::create(60, 30, kWhite));
    face.draw(picture, 5, 2, text, kBlack);
    return std::vector<Color>(picture.pixels().begin(), picture.pixels().end());
  };
  CHECK(drawn("a") != drawn("\xc3\xa4"));
  CHECK(drawn("\xc3\xa4") != drawn("\xce\xbb"));
  const auto replacement = drawn("\xef\xbf\xbd");
  CHECK(replacement != drawn(""));
  // A stray byte, an overlong form, half of a pair, beyond Unicode, a form cut off.
  for (const char* bad : {"\x80", "\xff"}) CHECK(drawn(bad) == replacement);
  CHECK(drawn("\xc0\xaf") == drawn("\xef\xbf\xbd\xef\xbf\xbd"));
  for (const char* bad : {"\xed\xa0\x80", "\xe0\x80\xaf"})
    CHECK(drawn(bad) == drawn("\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd"));
  CHECK(drawn("\xe2\x80") == drawn("\xef\xbf\xbd\xef\xbf\xbd"));
  CHECK(face.width("\xf4\x90\x80\x80") == face.width("\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd"));
}

TEST_CASE("text too long is shortened at a whole character, at its beginning or its end") {
  TextFace face = value(TextFace::create(14));
  CHECK(face.end_that_fits("short.ply", 400) == "short.ply");
  CHECK(face.beginning_that_fits("short.ply", 400) == "short.ply");
  const std::string path = "a/very/long/\xc3\xa4\xc3\xb6\xc3\xbc/path/to/the/mesh.ply";
  for (std::int64_t width = 0; width < face.width(path); width += 3) {
    const std::string end = face.end_that_fits(path, width),
                      beginning = face.beginning_that_fits(path, width);
    for (const std::string& text : {end, beginning}) REQUIRE(face.width(text) <= width);
    if (end.empty()) continue;
    const auto begins_character = [&](std::size_t place) {
      return (static_cast<unsigned char>(path[place]) & 0xc0u) != 0x80u;
    };
    REQUIRE((end.size() == 3 || begins_character(path.size() - (end.size() - 3))));
    REQUIRE(begins_character(beginning.size() - 3));
    REQUIRE(end.starts_with("\xe2\x80\xa6"));
    REQUIRE(path.ends_with(end.substr(3)));
    REQUIRE(beginning.ends_with("\xe2\x80\xa6"));
    REQUIRE(path.starts_with(beginning.substr(0, beginning.size() - 3)));
    // One more character would not fit.
    std::size_t more = beginning.size() - 2;
    while (more < path.size() && !begins_character(more)) ++more;
    REQUIRE(face.width(path.substr(0, more) + "\xe2\x80\xa6") > width);
  }
  CHECK(face.end_that_fits(path, 90).ends_with("mesh.ply"));
}

TEST_CASE("a font that is not there is an error that says what to do") {
  REQUIRE(setenv("VKMESH_FONT", "/nowhere/font.ttf", 1) == 0);
  const auto missing = TextFace::create(12);
  REQUIRE(unsetenv("VKMESH_FONT") == 0);
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ErrorCode::kUnsuitable);
  CHECK_THAT(missing.error().describe(), Catch::Matchers::Contains("/nowhere/font.ttf") &&
                                             Catch::Matchers::Contains("fonts-dejavu-core"));
  CHECK(TextFace::create(0).error().code == ErrorCode::kUsage);
}

TEST_CASE("colour maps rise evenly, and neighbouring colours are close") {
  const ColorTable sequential = color_table(ColorMap::kSequential),
                   diverging = color_table(ColorMap::kDiverging);
  double smallest = 100, largest = 0;
  for (std::size_t i = 16; i < 256; i += 16) {
    const double rise = lightness(sequential[i]) - lightness(sequential[i - 16]);
    smallest = std::min(smallest, rise);
    largest = std::max(largest, rise);
  }
  CHECK(smallest > 2.5);
  CHECK(largest < 2 * smallest);
  for (std::size_t i = 1; i < 256; ++i) {
    CHECK(step(sequential[i], sequential[i - 1]) <= 4);
    // From white the diverging map leaves faster, so that a small value shows its sign.
    CHECK(step(diverging[i], diverging[i - 1]) <= 10);
  }
  CHECK(lightness(sequential[0]) < 25);
  CHECK(lightness(sequential[255]) > 80);
  for (std::size_t i = 0; i < 128; ++i)
    CHECK(lightness(diverging[i]) == Approx(lightness(diverging[255 - i])).margin(8));
  CHECK(lightness(diverging[127]) > 90);
  CHECK(diverging[0].b > diverging[0].r + 60);
  CHECK(diverging[255].r > diverging[255].b + 60);
  const ColorTable categorical = color_table(ColorMap::kCategorical);
  for (std::size_t i = 1; i < 256; ++i) CHECK(step(categorical[i], categorical[i - 1]) > 60);
}

TEST_CASE("a robust range leaves outliers out") {
  std::vector<float> values;
  for (int i = 0; i <= 100; ++i) values.push_back(static_cast<float>(i));
  values.push_back(1e30f);
  values.push_back(std::numeric_limits<float>::quiet_NaN());
  values.push_back(-std::numeric_limits<float>::infinity());
  const ValueRange range = robust_range(values, 0.02);
  CHECK(range.low == Approx(2).margin(1));
  CHECK(range.high == Approx(99).margin(1));
  CHECK(robust_range(values, 0).high == Approx(1e30));
  const std::vector<float> nearly_constant = {3, 3, 3, 3, 3, 3, 3, 5};
  CHECK(robust_range(nearly_constant, 0.2).low == 3);
  CHECK(robust_range(nearly_constant, 0.2).high == 5);
  CHECK(robust_range({}, 0.02).low == 0);
  CHECK(robust_range({}, 0.02).high == 1);
}

TEST_CASE("ticks are round numbers inside the range") {
  CHECK(round_ticks({0, 1}, 7) == std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1});
  CHECK(round_ticks({-1, 1}, 5) == std::vector<double>{-1, -0.5, 0, 0.5, 1});
  CHECK(round_ticks({3, 47}, 6) == std::vector<double>{10, 20, 30, 40});
  CHECK(round_ticks({2, 2}, 5) == std::vector<double>{2});
  for (double low = -3.7; low < 4; low += 0.37)
    for (double width = 1e-3; width < 1e6; width *= 3.7) {
      const auto ticks = round_ticks({low, low + width}, 6);
      CHECK(!ticks.empty());
      CHECK(ticks.size() <= 6);
      CHECK(ticks.front() >= low - 1e-9 * width);
      CHECK(ticks.back() <= low + width * (1 + 1e-9));
    }
}

TEST_CASE("legends and contact sheets are as large as they say") {
  const Legend legend{"title", ColorMap::kSequential, {0, 1}, {{{1, 2, 3, 255}, "three edges"}}};
  const Picture strip = value(legend_strip(legend, 200, kWhite, 12));
  CHECK(strip.height() == legend_height(legend, 12));
  CHECK(legend_height(legend, 48) == 2 * legend_height(legend, 24));
  CHECK(legend_height({}, 12) == 0);
  CHECK(value(legend_strip({}, 200, kWhite, 12)).height() == 0);
  CHECK(count(strip, {1, 2, 3, 255}) == 81);
  // Both ends of the map are there.
  const ColorTable table = color_table(ColorMap::kSequential);
  CHECK(count(strip, table[0]) > 0);
  CHECK(count(strip, table[255]) > 0);

  std::vector<SheetCell> cells;
  for (int i = 0; i < 3; ++i)
    cells.push_back(
        {value(Picture::create(40, 30, {static_cast<std::uint8_t>(i), 200, 7, 255})), {"caption"}});
  const Picture sheet = value(contact_sheet(cells, 2, kWhite));
  CHECK(sheet.width() == 80);
  CHECK(sheet.height() > 60);
  CHECK(sheet.height() % 2 == 0);
  CHECK(sheet.at(0, 0) == Color{0, 200, 7, 255});
  CHECK(sheet.at(79, 29) == Color{1, 200, 7, 255});
  CHECK(sheet.at(0, sheet.height() / 2) == Color{2, 200, 7, 255});
  CHECK(sheet.at(79, sheet.height() - 1) == kWhite);
  for (int i = 0; i < 3; ++i) CHECK(count(sheet, {static_cast<std::uint8_t>(i), 200, 7, 255}) == 40 * 30);
  CHECK(contact_sheet({}, 1, kWhite).error().code == ErrorCode::kUsage);
}

TEST_CASE("a framing sees every point, and none could stand nearer") {
  IndexedFaceSet mesh = torus(30, 20);
  jitter(mesh, 0.1f, 5);
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic})
    for (const UpAxis up : {UpAxis::kY, UpAxis::kZ})
      for (const double elevation : {-90.0, -20.0, 35.0, 90.0})
        for (const double shape : {0.5, 1.0, 2.0}) {
          CAPTURE(static_cast<int>(projection), static_cast<int>(up), elevation, shape);
          const FramingOptions options{
              .azimuth = 50, .elevation = elevation, .up = up, .projection = projection};
          const Camera camera = value(frame_camera(mesh.points, shape, options));
          const CameraAxes axes = value(axes_of(camera));
          double x_most = 0, y_most = 0;
          for (const Vec3& p : mesh.points) {
            const DVec3 q = DVec3(p) - camera.eye;
            const auto along = [&](const DVec3& a) { return a.x * q.x + a.y * q.y + a.z * q.z; };
            const double depth = along(axes.forward);
            CHECK((depth > camera.near && depth < camera.far));
            const double half = projection == Projection::kPerspective
                                    ? depth * std::tan(camera.field_of_view * std::numbers::pi / 360)
                                    : camera.visible_height / 2;
            x_most = std::max(x_most, std::abs(along(axes.right)) / (half * shape));
            y_most = std::max(y_most, std::abs(along(axes.up)) / half);
          }
          // The margin of 5 % on each side is reached in one direction, and kept in both.
          CHECK(std::max(x_most, y_most) == Approx(0.9).epsilon(1e-6));
        }
}

TEST_CASE("azimuth and elevation turn the camera as documented") {
  const std::vector<Vec3> points = {{-1, -1, -1}, {1, 1, 1}};
  const auto axes = [&](double azimuth, double elevation, UpAxis up) {
    return value(
        axes_of(value(frame_camera(points, 1, {.azimuth = azimuth, .elevation = elevation, .up = up}))));
  };
  const auto near = [](const DVec3& a, const DVec3& b) {
    return std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z) < 1e-9;
  };
  CHECK(near(axes(0, 0, UpAxis::kY).forward, {0, 0, -1}));
  CHECK(near(axes(0, 0, UpAxis::kY).right, {1, 0, 0}));
  CHECK(near(axes(90, 0, UpAxis::kY).forward, {-1, 0, 0}));
  CHECK(near(axes(0, 90, UpAxis::kY).forward, {0, -1, 0}));
  CHECK(near(axes(0, 0, UpAxis::kZ).forward, {0, 1, 0}));
  CHECK(near(axes(90, 0, UpAxis::kZ).forward, {-1, 0, 0}));
  CHECK(near(axes(0, 0, UpAxis::kZ).up, {0, 0, 1}));
}

TEST_CASE("framings of nothing and of a single point are cameras; wrong options are refused") {
  CHECK(frame_camera({}, 1));
  const std::vector<Vec3> one = {{3, 4, 5}};
  const Camera camera = value(frame_camera(one, 1));
  CHECK(camera.near < camera.far);
  CHECK(axes_of(camera));
  CHECK_FALSE(frame_camera(one, 0));
  CHECK_FALSE(frame_camera(one, 1, {.elevation = 91}));
  CHECK_FALSE(frame_camera(one, 1, {.azimuth = std::numeric_limits<double>::quiet_NaN()}));
  CHECK_FALSE(frame_camera(one, 1, {.field_of_view = 0}));
  CHECK_FALSE(frame_camera(one, 1, {.margin = 0.5}));
}

TEST_CASE("edges know how many faces they have") {
  const auto faces_of = [](const IndexedFaceSet& mesh) {
    std::multiset<std::uint32_t> faces;
    for (const SurfaceEdge& e : value(surface_edges(mesh))) {
      CHECK(e.a < e.b);
      faces.insert(e.faces);
    }
    return faces;
  };
  CHECK(faces_of(tetrahedron()) == std::multiset<std::uint32_t>{2, 2, 2, 2, 2, 2});
  CHECK(faces_of(fin()) == std::multiset<std::uint32_t>{1, 1, 1, 1, 1, 1, 3});
  CHECK(faces_of(quad_cube()).size() == 12);
  CHECK(faces_of(cube()).size() == 18);
  IndexedFaceSet flipped = tetrahedron();
  std::swap(flipped.corners[0], flipped.corners[1]);
  std::size_t opposed = 0;
  for (const SurfaceEdge& e : value(surface_edges(flipped))) opposed += e.opposed;
  CHECK(opposed == 3);
  flipped.corners[4] = 9;
  CHECK(surface_edges(flipped).error().code == ErrorCode::kUsage);
}

TEST_CASE("angles are positive on convex edges, and those of a cube are right") {
  for (const IndexedFaceSet& mesh : {quad_cube(), cube()}) {
    const auto edges = value(surface_edges(mesh));
    const auto angles = value(signed_dihedral_angles(mesh, edges));
    for (const float angle : angles)
      CHECK((std::abs(angle) < 1e-6f || angle == Approx(std::numbers::pi / 2)));
    const auto largest = value(largest_angles(mesh, edges, angles));
    for (const float angle : largest) CHECK(angle == Approx(std::numbers::pi / 2));
  }
  IndexedFaceSet inside_out = quad_cube();
  for (std::size_t f = 0; f < 6; ++f)
    std::reverse(inside_out.corners.begin() + static_cast<std::ptrdiff_t>(4 * f),
                 inside_out.corners.begin() + static_cast<std::ptrdiff_t>(4 * f + 4));
  for (const float angle : value(signed_dihedral_angles(inside_out, value(surface_edges(inside_out)))))
    CHECK(angle == Approx(-std::numbers::pi / 2));
}

TEST_CASE("the mean curvature of a sphere is the inverse of its radius") {
  for (const float radius : {0.5f, 1.0f, 4.0f}) {
    const IndexedFaceSet mesh = icosphere(4, radius);
    const auto edges = value(surface_edges(mesh));
    const auto curvature = value(mean_curvatures(mesh, edges, value(signed_dihedral_angles(mesh, edges))));
    double sum = 0;
    for (std::size_t v = 0; v < curvature.size(); ++v) {
      // In sum the curvature of edges is right; at a point with n regular triangles it is 3 / (4 cos²(π / n))
      // of the sphere's. The first twelve points have five.
      const double cosine = std::cos(std::numbers::pi / (v < 12 ? 5 : 6));
      CHECK(curvature[v] * radius == Approx(0.75 / (cosine * cosine)).epsilon(0.1));
      sum += static_cast<double>(curvature[v]);
    }
    CHECK(sum / static_cast<double>(curvature.size()) * static_cast<double>(radius) ==
          Approx(1).epsilon(0.01));
  }
}

TEST_CASE("valences, components and qualities of known meshes") {
  const IndexedFaceSet ball = icosphere(2);
  const auto valence = value(valences(ball, value(surface_edges(ball))));
  CHECK(std::count(valence.begin(), valence.end(), 5.0f) == 12);
  CHECK(std::count(valence.begin(), valence.end(), 6.0f) == static_cast<std::ptrdiff_t>(valence.size()) - 12);

  // A tetrahedron, a cube with more faces, and a point of neither.
  IndexedFaceSet two = tetrahedron();
  two.points.emplace_back(9.0f, 9.0f, 9.0f);
  const IndexedFaceSet box = cube();
  for (const std::uint32_t c : box.corners) two.corners.push_back(c + 5);
  two.points.insert(two.points.end(), box.points.begin(), box.points.end());
  const ConnectedComponents parts = value(connected_components(two));
  CHECK(parts.faces == std::vector<std::size_t>{12, 4});
  CHECK(parts.of_point[0] == 1.0f);
  CHECK(std::isnan(parts.of_point[4]));
  CHECK(parts.of_point[5] == 0.0f);

  for (const float q : value(triangle_qualities(tetrahedron()))) CHECK(q == Approx(1).epsilon(1e-4));
  for (const float q : value(triangle_qualities(cube()))) CHECK(q == Approx(std::sqrt(3.0) / 2));
  IndexedFaceSet flat = tetrahedron();
  flat.points[1] = flat.points[0];
  CHECK(value(triangle_qualities(flat))[0] == 0.0f);
  CHECK(triangle_qualities(quad_cube()).error().code == ErrorCode::kUnsuitable);
}

TEST_CASE("normals of a manifold are those of the pass, and of any other mesh they are there") {
  IndexedFaceSet mesh = torus(20, 10);
  jitter(mesh, 0.05f, 9);
  CHECK(value(point_normals(mesh)) == value(vertex_normals(half_edges(mesh), mesh.points)));
  for (const Vec3& n : value(point_normals(fin()))) CHECK(n != Vec3(0.0f));
}

TEST_CASE("the spacing of points is that found by trying all pairs") {
  IndexedFaceSet mesh = torus(12, 9);
  jitter(mesh, 0.2f, 11);
  mesh.points.push_back(mesh.points[0]);
  const auto& p = mesh.points;
  for (const unsigned k : {1u, 6u, 20u}) {
    const auto spacing = value(point_spacing(p, k));
    for (std::size_t i = 1; i + 1 < p.size(); ++i) {
      std::vector<float> squared;
      for (std::size_t j = 0; j < p.size(); ++j) {
        const Vec3 d = p[i] - p[j];
        if (j != i) squared.push_back(d.x * d.x + d.y * d.y + d.z * d.z);
      }
      std::sort(squared.begin(), squared.end());
      CHECK(spacing[i] == std::sqrt(squared[k - 1]));
    }
  }
  // Points that coincide get what is usual around the others.
  const auto nearest = value(point_spacing(p, 1));
  CHECK(nearest.front() > 0);
  CHECK(nearest.front() == nearest.back());
  CHECK(value(point_spacing(std::vector<Vec3>{{1, 2, 3}})) == std::vector<float>{0});
}

}  // namespace vkmesh::test
