// What decimation does not give away for a target, and that it gets there where nothing forbids it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/io/mesh_io.h>

#include "decimation/decimate_support.h"
#include "decimation/reference.h"
#include "support/data.h"
#include "support/shapes.h"
#include "support/vectors.h"

namespace vkmesh {
namespace {

using test::cross, test::dot, test::length, test::run, test::ways;

std::array<DVec3, 3> corners_of(std::span<const std::uint32_t> origins, const std::vector<Vec3>& points,
                                std::size_t f) {
  return {DVec3(points[origins[3 * f]]), DVec3(points[origins[3 * f + 1]]),
          DVec3(points[origins[3 * f + 2]])};
}

double volume(std::span<const std::uint32_t> origins, const std::vector<Vec3>& points) {
  double sum = 0;
  for (std::size_t f = 0; f < origins.size() / 3; ++f) {
    const auto [a, b, c] = corners_of(origins, points, f);
    sum += dot(a, cross(b, c)) / 6;
  }
  return sum;
}
double area(std::span<const std::uint32_t> origins, const std::vector<Vec3>& points) {
  double sum = 0;
  for (std::size_t f = 0; f < origins.size() / 3; ++f) {
    const auto [a, b, c] = corners_of(origins, points, f);
    sum += length(cross(b - a, c - a)) / 2;
  }
  return sum;
}

/// Twice the area of a face over its longest side squared, the least of all.
double thinnest(std::span<const std::uint32_t> origins, const std::vector<Vec3>& points) {
  double least = 1;
  for (std::size_t f = 0; f < origins.size() / 3; ++f) {
    const auto [a, b, c] = corners_of(origins, points, f);
    const double longest2 = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    least = std::min(least, length(cross(b - a, c - a)) / longest2);
  }
  return least;
}

/// A sphere of circles and meridians, with u round and v along the axis: where faces meet in a pole, each has
/// a u of its own.
struct Globe {
  IndexedFaceSet mesh;
  std::vector<float> values;
  std::vector<std::uint32_t> corners;

  Globe(std::uint32_t circles, std::uint32_t meridians) {
    mesh.points.emplace_back(0.0f, 0.0f, 1.0f);
    for (std::uint32_t i = 1; i < circles; ++i)
      for (std::uint32_t j = 0; j < meridians; ++j) {
        const double t = std::numbers::pi * i / circles, p = 2 * std::numbers::pi * j / meridians;
        mesh.points.emplace_back(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
      }
    mesh.points.emplace_back(0.0f, 0.0f, -1.0f);
    const auto last = static_cast<std::uint32_t>(mesh.points.size() - 1);
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return 1 + (i - 1) * meridians + j % meridians; };
    const auto add = [&](std::uint32_t v, double u, double along) {
      mesh.corners.push_back(v);
      corners.push_back(static_cast<std::uint32_t>(corners.size()));
      values.push_back(static_cast<float>(u / meridians));
      values.push_back(static_cast<float>(along / circles));
    };
    for (std::uint32_t j = 0; j < meridians; ++j) {
      add(0, j + 0.5, 0), add(at(1, j), j, 1), add(at(1, j + 1), j + 1, 1);
      for (std::uint32_t i = 1; i + 1 < circles; ++i) {
        add(at(i, j), j, i), add(at(i + 1, j), j, i + 1), add(at(i + 1, j + 1), j + 1, i + 1);
        add(at(i, j), j, i), add(at(i + 1, j + 1), j + 1, i + 1), add(at(i, j + 1), j + 1, i);
      }
      add(last, j + 0.5, circles), add(at(circles - 1, j + 1), j + 1, circles - 1),
          add(at(circles - 1, j), j, circles - 1);
    }
  }
};

/// A box of n by n squares a side, thin in one direction.
IndexedFaceSet thin_box(int n, float thickness) {
  IndexedFaceSet box = test::fine_cube(n);
  for (Vec3& p : box.points) p.z *= thickness;
  return box;
}

/// Hills over a square, n by n.
IndexedFaceSet terrain(std::uint32_t n) {
  IndexedFaceSet mesh = test::grid(n, n);
  for (Vec3& p : mesh.points) {
    const auto x = static_cast<double>(p.x), y = static_cast<double>(p.y);
    p.z = static_cast<float>(0.33 * (1.5 * std::sin(.7 * x + .3 * y) * std::cos(.9 * y) +
                                     .4 * std::sin(2.3 * x) + .4 * std::cos(2.1 * y + x)));
  }
  return mesh;
}

}  // namespace

TEST_CASE("decimation: a pole loses its values one by one, and the sphere keeps its shape", "[decimate]") {
  const Globe globe(16, 32);
  const double whole = volume(globe.mesh.corners, globe.mesh.points);
  for (DecimateOptions options : ways()) {
    CAPTURE(static_cast<int>(options.operation));
    options.target.ratio = 0.1;
    options.attributes = {{2, globe.values, globe.corners, 0.01, AttributeKind::kPlain}};
    const Decimated d = run(globe.mesh, options);
    CHECK(d.stop == DecimateStop::kTargetReached);
    CHECK(d.mesh.face_count() <= 97);
    CHECK(volume(d.mesh.origins(), d.positions) > 0.85 * whole);
    for (const std::uint32_t pole : {0u, static_cast<std::uint32_t>(globe.mesh.points.size() - 1)})
      CHECK(d.positions[d.vertex_map[pole]] == globe.mesh.points[pole]);
    // No face runs over the seam, and the height of each corner tells its v.
    for (std::size_t c = 0; c < d.mesh.half_edge_count(); ++c) {
      const auto value = [&](std::size_t corner, std::size_t k) {
        return static_cast<double>(d.attributes.values[0][2 * d.attributes.corners[corner] + k]);
      };
      CHECK(std::fabs(value(c, 0) - value(c / 3 * 3, 0)) < 0.6);
      const double z = static_cast<double>(d.positions[d.mesh.origins()[c]].z);
      CHECK(std::fabs(value(c, 1) - std::acos(std::clamp(z, -1.0, 1.0)) / std::numbers::pi) < 0.06);
    }
  }
}

TEST_CASE("decimation: a target out of reach is not bought with what may go", "[decimate]") {
  const IndexedFaceSet sphere = test::icosphere(4);
  std::size_t locked = 0;
  for (DecimateOptions options : ways()) {
    options.target.ratio = 0.1;
    for (std::uint32_t v = 0; v < sphere.points.size(); ++v)
      if (sphere.points[v].z > 0) options.locked.vertices.push_back(v);
    locked = options.locked.vertices.size();
    const Decimated d = run(sphere, options);
    CHECK(d.stop == DecimateStop::kOutOfProportion);
    CHECK(d.mesh.vertex_count() >= locked + (sphere.points.size() - locked) / 100);
    CHECK(d.mesh.vertex_count() <= locked + (sphere.points.size() - locked) / 50);
    CHECK(volume(d.mesh.origins(), d.positions) > 0.75 * volume(sphere.corners, sphere.points));
    options.target.force = true;
    const Decimated forced = run(sphere, options);
    CHECK(forced.stop == DecimateStop::kNoLegalCollapse);
    CHECK(forced.mesh.vertex_count() < d.mesh.vertex_count());
    // What is within reach is reached.
    options.target = {};
    options.target.ratio = 0.6;
    CHECK(run(sphere, options).stop == DecimateStop::kTargetReached);
    // Without a target all goes that may.
    options.target = {};
    CHECK(run(sphere, options).stop == DecimateStop::kNoLegalCollapse);
  }

  // Two hundred tetrahedra can not have fewer than 800 faces.
  IndexedFaceSet small = test::tetrahedron();
  for (Vec3& p : small.points) p *= 0.01f;
  IndexedFaceSet all = test::icosphere(4);
  const std::size_t large = all.points.size();
  for (int i = 0; i < 200; ++i)
    all = test::both(all, small,
                     Vec3(3.0f + 0.1f * static_cast<float>(i % 20), 0.1f * static_cast<float>(i / 20), 0));
  for (DecimateOptions options : ways()) {
    options.target.ratio = 0.05;
    const Decimated d = run(all, options);
    CHECK(d.stop == DecimateStop::kOutOfProportion);
    std::size_t left = 0;
    for (const std::uint32_t v : d.source_vertex) left += v < large ? 1 : 0;
    CHECK(left >= 10);
  }
}

namespace {

IndexedFaceSet octahedron() {
  IndexedFaceSet mesh;
  mesh.points = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.corners = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5};
  return mesh;
}

/// A torus, and so many copies of a small part beside it.
IndexedFaceSet torus_and(std::uint32_t rings, std::uint32_t sides, IndexedFaceSet part, int count) {
  for (Vec3& p : part.points) p *= 0.01f;
  IndexedFaceSet all = test::torus(rings, sides);
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(all.points.size());
    for (const Vec3& p : part.points)
      all.points.push_back(
          p + Vec3(3.0f + 0.1f * static_cast<float>(i % 20), 0.1f * static_cast<float>(i / 20), 0));
    for (const std::uint32_t c : part.corners) all.corners.push_back(first + c);
  }
  return all;
}

}  // namespace

TEST_CASE("decimation: small parts that hold a target are not made up for by the rest",
          "[decimate][reference]") {
  const std::map<std::string, IndexedFaceSet> parts = {{"tetrahedra", test::tetrahedron()},
                                                       {"octahedra", octahedron()},
                                                       {"cards", test::grid(1, 1)},
                                                       {"spheres", test::icosphere(1)},
                                                       {"cubes", test::cube()}};
  for (const auto& [name, part] : parts)
    for (DecimateOptions options : ways()) {
      CAPTURE(name, static_cast<int>(options.operation));
      const auto of_torus = [](const auto& vertices, std::size_t torus) {
        return static_cast<std::size_t>(std::ranges::count_if(vertices, [&](auto v) { return v < torus; }));
      };
      const IndexedFaceSet all = torus_and(150, 100, part, 200);
      options.target.faces = 1200;
      const Decimated d = run(all, options);
      CHECK((d.stop == DecimateStop::kOutOfProportion || d.mesh.face_count() <= 1200));
      CHECK(of_torus(d.source_vertex, 15000) >= 60);

      // A small one, as the reference leaves it.
      const IndexedFaceSet small = torus_and(40, 30, part, 60);
      options.target.faces = small.face_count() / 12;
      const Decimated fast = run(small, options);
      std::set<std::uint32_t> left;
      for (const auto& face : detail::decimate_by_reference({small.points, small.corners}, options).faces)
        left.insert(face.begin(), face.end());
      const std::size_t expected = of_torus(left, 1200), found = of_torus(fast.source_vertex, 1200);
      CAPTURE(expected, found, left.size(), fast.positions.size());
      CHECK(found >= 10);
      CHECK(4 * found >= 3 * expected);
      CHECK(4 * found <= 5 * expected);
    }
}

TEST_CASE("decimation: vertices of thin parts go as they do by half-edge collapses",
          "[decimate][reference]") {
  const IndexedFaceSet box = thin_box(3, 0.01f);
  DecimateOptions options = ways()[2];
  options.target.faces = 12;
  const Decimated d = run(box, options);
  CHECK(d.mesh.face_count() == 12);
  CHECK(volume(d.mesh.origins(), d.positions) == Approx(volume(box.corners, box.points)));
  CHECK(detail::decimate_by_reference({box.points, box.corners}, options).faces.size() == 12);
  // The same on real meshes.
  for (const std::string name : {"cow.off", "elephant.off"}) {
    const auto paths = test::cgal_meshes();
    const auto path = std::ranges::find_if(paths, [&](const auto& p) { return p.filename() == name; });
    REQUIRE(path != paths.end());
    auto file = read_mesh(*path);
    REQUIRE(file);
    const auto mesh_of_file = to_indexed_face_set(std::move(*file));
    REQUIRE(mesh_of_file);
    const IndexedFaceSet& mesh = *mesh_of_file;
    options.target = {};
    options.target.ratio = 0.02;
    const Decimated removed = run(mesh, options);
    options.operation = DecimateOperation::kHalfEdgeCollapse;
    const Decimated collapsed = run(mesh, options);
    options.operation = DecimateOperation::kVertexRemoval;
    CAPTURE(name);
    CHECK(removed.mesh.face_count() <= collapsed.mesh.face_count() + 1);
    CHECK(volume(removed.mesh.origins(), removed.positions) >
          0.9 * volume(collapsed.mesh.origins(), collapsed.positions));
  }
}

TEST_CASE("decimation: removals from flat ground leave no slivers", "[decimate]") {
  // A square with a round hole.
  IndexedFaceSet mesh = test::cylinder(24, 64);
  for (Vec3& p : mesh.points) {
    const float r = 0.3f + 0.7f * p.z / 24, most = std::max(std::fabs(p.x), std::fabs(p.y));
    const float to_square = p.z / 24, grow = (1 - to_square) + to_square / most;
    p = Vec3(r * grow * p.x, r * grow * p.y, 0);
  }
  for (DecimateOptions options : ways()) {
    CAPTURE(static_cast<int>(options.operation));
    options.bounds.error = Length::relative(1e-5);
    const Decimated d = run(mesh, options);
    CHECK(d.mesh.face_count() < 200);
    CHECK(thinnest(d.mesh.origins(), d.positions) > 1e-4);
  }
}

TEST_CASE("decimation: a thin strip keeps its corners", "[decimate]") {
  IndexedFaceSet strip = test::grid(8, 2);
  for (Vec3& p : strip.points) p = Vec3(p.x / 8, p.y * 0.0005f, 0);
  for (DecimateOptions options : ways()) {
    CAPTURE(static_cast<int>(options.operation));
    options.target.faces = 2;
    const Decimated d = run(strip, options);
    CHECK(d.mesh.face_count() == 2);
    CHECK(area(d.mesh.origins(), d.positions) == Approx(0.001).epsilon(0.02));
  }
}

TEST_CASE("decimation: no face on a boundary that is kept stands upright", "[decimate][reference]") {
  const IndexedFaceSet hills = terrain(40);
  DecimateOptions options = ways()[2];
  options.curves.boundary = DecimateBoundary::kKept;
  options.target.ratio = 0.1;
  const Decimated d = run(hills, options);
  CHECK(d.mesh.face_count() == 320);
  std::size_t upright = 0;
  for (std::size_t f = 0; f < d.mesh.face_count(); ++f) {
    const auto [a, b, c] = corners_of(d.mesh.origins(), d.positions, f);
    const DVec3 n = cross(b - a, c - a);
    upright += n.z < 0.2 * length(n) ? 1 : 0;
  }
  CHECK(upright == 0);
}

}  // namespace vkmesh
