#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <vkmesh/analysis/creases.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/repair/consolidate.h>

#include "decimation/collapse_neighbourhood.h"
#include "decimation/cost/tangential_drift.h"
#include "decimation/decimate_support.h"
#include "decimation/decimation_state.h"
#include "math/triangle_distance.h"
#include "support/data.h"
#include "support/shapes.h"
#include "support/vectors.h"

namespace vkmesh {
namespace {

using test::cross, test::dot;
using test::half_edges, test::run, test::ways;

/// Does a history over again on triangles in a list, and judges each step: no half-edges, no quadrics.
class Replay {
 public:
  Replay(const IndexedFaceSet& mesh, double max_deviation) : cos_deviation_(std::cos(max_deviation)) {
    for (const Vec3& p : mesh.points) points_.emplace_back(p);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      faces_[static_cast<std::uint32_t>(f)] = {mesh.face(f)[0], mesh.face(f)[1], mesh.face(f)[2]};
    judge();
  }

  void step(const Collapse<Vec3>& c) {
    // The others stay as they are.
    std::map<std::uint32_t, DVec3> normals;
    for (const auto& [f, face] : faces_)
      for (const std::uint32_t v : face)
        if (v == c.kept || v == c.removed) normals[f] = normal(face);
    points_[c.kept] = DVec3(c.position);
    std::size_t gone = 0;
    // Rounding of the library's positions, which are relative to the box.
    constexpr double kRounding = 1e-4;
    for (const auto& [f, was] : normals) {
      auto& face = faces_.at(f);
      std::replace(face.begin(), face.end(), c.removed, c.kept);
      if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
        CHECK((f == c.faces[0] || f == c.faces[1]));
        ++gone;
        faces_.erase(f);
        continue;
      }
      const DVec3 now = normal(face);
      const double lengths = std::sqrt(dot(now, now) * dot(was, was));
      CHECK(dot(now, was) >= (cos_deviation_ - kRounding) * lengths);
    }
    CHECK(gone == (c.faces[0] != kInvalid ? 1u : 0u) + (c.faces[1] != kInvalid ? 1u : 0u));
    CHECK(gone > 0);
    const int before = characteristic_;
    judge();
    CHECK(characteristic_ == before);
  }

  [[nodiscard]] const std::map<std::uint32_t, std::array<std::uint32_t, 3>>& faces() const { return faces_; }
  [[nodiscard]] const DVec3& point(std::uint32_t v) const { return points_[v]; }

 private:
  [[nodiscard]] DVec3 normal(const std::array<std::uint32_t, 3>& f) const {
    return cross(points_[f[1]] - points_[f[0]], points_[f[2]] - points_[f[0]]);
  }
  /// Simple and oriented, each directed edge at most once; and what Euler counts.
  void judge() {
    std::vector<bool> used(points_.size(), false);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const auto& [f, face] : faces_)
      for (std::size_t i = 0; i < 3; ++i) {
        used[face[i]] = true;
        edges.emplace_back(face[i], face[(i + 1) % 3]);
      }
    std::sort(edges.begin(), edges.end());
    REQUIRE(std::adjacent_find(edges.begin(), edges.end()) == edges.end());
    // An edge of two faces counts at the one from its lesser end.
    const auto counts = [&](const auto& edge) {
      return edge.first < edge.second ||
             !std::binary_search(edges.begin(), edges.end(), std::pair(edge.second, edge.first));
    };
    characteristic_ = static_cast<int>(std::count(used.begin(), used.end(), true)) -
                      static_cast<int>(std::count_if(edges.begin(), edges.end(), counts)) +
                      static_cast<int>(faces_.size());
  }

  double cos_deviation_;
  int characteristic_ = 0;
  std::vector<DVec3> points_;
  std::map<std::uint32_t, std::array<std::uint32_t, 3>> faces_;
};

/// Six grids welded along their edges: a cube of side 1 at (shift, shift, 0).
IndexedFaceSet cut_cube(float shift) {
  constexpr int kCuts = 8;
  IndexedFaceSet mesh;
  std::map<std::array<int, 3>, std::uint32_t> index;
  const auto point = [&](const std::array<int, 3>& p) {
    const auto [place, is_new] = index.try_emplace(p, static_cast<std::uint32_t>(mesh.points.size()));
    if (is_new)
      mesh.points.emplace_back(shift + static_cast<float>(p[0]) / kCuts,
                               shift + static_cast<float>(p[1]) / kCuts, static_cast<float>(p[2]) / kCuts);
    return place->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, kCuts})
      for (int i = 0; i < kCuts; ++i)
        for (int j = 0; j < kCuts; ++j) {
          std::array<std::uint32_t, 4> corner{};
          const int square[4][2] = {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
          for (std::size_t k = 0; k < 4; ++k) {
            std::array<int, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = square[k][0];
            p[(axis + 2) % 3] = square[k][1];
            corner[k] = point(p);
          }
          if (side == 0) std::swap(corner[1], corner[3]);
          mesh.corners.insert(mesh.corners.end(),
                              {corner[0], corner[1], corner[2], corner[0], corner[2], corner[3]});
        }
  return mesh;
}

}  // namespace

TEST_CASE("decimation: each collapse of a history is legal, and the history leads to the result",
          "[decimate]") {
  for (const DecimateOptions& way : ways()) {
    if (way.operation == DecimateOperation::kVertexRemoval) continue;  // histories tell no triangulation
    for (std::uint32_t seed = 0; seed < 6; ++seed) {
      const bool partitioned = seed >= 4;
      const std::vector<IndexedFaceSet> shapes =
          partitioned ? std::vector{test::icosphere(2), test::torus(14, 11), test::grid(14, 13),
                                    test::both(test::icosphere(1), test::torus(12, 9))}
                      : std::vector{test::icosphere(2), test::torus(9, 5), test::grid(6, 5),
                                    test::cylinder(4, 7), test::both(test::cube(), test::torus(5, 4))};
      for (const IndexedFaceSet& shape : shapes) {
        IndexedFaceSet mesh = shape;
        if (seed > 0) test::jitter(mesh, 0.1f * static_cast<float>(seed), seed);
        DecimateOptions options = way;
        options.keep_history = true;
        options.bounds.normal_deviation = seed % 2 == 0 ? 1.3 : 2.5;
        options.curves.boundary = seed == 2 ? DecimateBoundary::kFree : DecimateBoundary::kInShape;
        const TriangleSurface surface{mesh.points, mesh.corners};
        const auto done =
            partitioned ? detail::decimate_in_partitions(surface, options) : decimate(surface, options);
        REQUIRE(done);
        const Decimated& result = *done;
        REQUIRE(validate(result.mesh));
        REQUIRE(result.mesh.face_count() > 0);
        CHECK(result.stop == DecimateStop::kNoLegalCollapse);
        CHECK(result.history.size() == result.collapses);
        CHECK(result.collapses > 3);
        Replay replay(mesh, options.bounds.normal_deviation);
        std::vector<std::uint32_t> stands(mesh.points.size());
        std::iota(stands.begin(), stands.end(), 0u);
        for (const Collapse<Vec3>& c : result.history) {
          replay.step(c);
          std::replace(stands.begin(), stands.end(), c.removed, c.kept);
        }
        REQUIRE(replay.faces().size() == result.mesh.face_count());
        std::uint32_t f = 0;
        for (const auto& [source, face] : replay.faces()) {
          CHECK(result.source_face[f] == source);
          for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t v = result.mesh.origins()[3 * f + i];
            CHECK(result.source_vertex[v] == face[i]);
            CHECK(DVec3(result.positions[v]) == replay.point(face[i]));
          }
          ++f;
        }
        for (std::uint32_t v = 0; v < stands.size(); ++v)
          CHECK(result.source_vertex[result.vertex_map[v]] == stands[v]);
      }
    }
  }
}

TEST_CASE("decimation: partitions side by side do the same on any number of threads", "[decimate]") {
  // More threads than there may be cores.
  const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 8);
  IndexedFaceSet mesh = test::both(test::icosphere(4), test::grid(40, 50));
  test::jitter(mesh, 0.05f, 1);
  for (const DecimateOptions& way : ways()) {
    if (way.operation == DecimateOperation::kVertexRemoval) continue;  // of one partition
    for (const double ratio : {0.5, 0.1, 0.0}) {
      DecimateOptions options = way;
      options.target.ratio = ratio;
      options.keep_history = true;
      const auto on = [&](int threads) {
        tbb::task_arena arena(threads);
        return arena.execute([&] {
          auto result = detail::decimate_in_partitions({mesh.points, mesh.corners}, options);
          REQUIRE(result);
          REQUIRE(validate(result->mesh));
          return std::move(*result);
        });
      };
      const Decimated one = on(1);
      if (ratio > 0) {
        CHECK(one.stop == DecimateStop::kTargetReached);
        const auto target =
            static_cast<std::size_t>(std::llround(ratio * static_cast<double>(mesh.face_count())));
        CHECK(one.mesh.face_count() <= target);
        CHECK(one.mesh.face_count() + 2 > target);
      } else {
        CHECK(one.blocked[Reason::kLinkCondition] + one.blocked[Reason::kFoldOver] > 0);
        CHECK(test::sum(one.blocked) == one.mesh.edge_count());
      }
      for (const int threads : {2, 3, 8}) {
        const Decimated many = on(threads);
        CHECK(std::ranges::equal(many.mesh.origins(), one.mesh.origins()));
        CHECK(many.positions == one.positions);
        CHECK(many.vertex_map == one.vertex_map);
        CHECK(many.collapses == one.collapses);
        CHECK(many.rejected[Reason::kFoldOver] == one.rejected[Reason::kFoldOver]);
        CHECK(std::ranges::equal(many.history, one.history, [](const auto& a, const auto& b) {
          return a.kept == b.kept && a.removed == b.removed && a.position == b.position && a.faces == b.faces;
        }));
      }
    }
  }
}

TEST_CASE("decimation: flat sheets, cubes and tetrahedra, each way", "[decimate]") {
  for (DecimateOptions options : ways()) {
    options.target.faces = 0;
    const Decimated tetrahedron = run(test::tetrahedron(), options);
    CHECK(tetrahedron.stop == DecimateStop::kNoLegalCollapse);
    CHECK(tetrahedron.collapses == 0);

    const Decimated sheet = run(test::grid(12, 9), [&] {
      DecimateOptions o = options;
      o.target.faces = 2;
      return o;
    }());
    REQUIRE(sheet.mesh.face_count() == 2);
    // A few roundings of float, over the box of 15.
    CHECK(sheet.relative_error < 1e-5);
    for (const Vec3& p : sheet.positions) {
      CHECK(p.x == Approx(p.x < 6 ? 0 : 12).margin(1e-4));
      CHECK(p.y == Approx(p.y < 4 ? 0 : 9).margin(1e-4));
    }
    for (const float shift : {0.0f, 1000.0f, 1.0e6f}) {
      options.target.faces = 12;
      const Decimated cube = run(cut_cube(shift), options);
      REQUIRE(cube.mesh.face_count() == 12);
      CHECK(cube.positions.size() == 8);
      CHECK(cube.relative_error < 1e-5);
      for (const Vec3& p : cube.positions)
        for (const float x : {p.x - shift, p.y - shift, p.z})
          CHECK(std::min(std::fabs(x), std::fabs(x - 1)) < 1e-5f);
    }
  }
}

TEST_CASE("decimation: locked vertices and a boundary that is kept stay where they are", "[decimate]") {
  for (DecimateOptions options : ways()) {
    IndexedFaceSet mesh = test::grid(9, 9);
    test::jitter(mesh, 0.2f, 3);
    const HalfEdgeMesh input = half_edges(mesh);
    options.curves.boundary = DecimateBoundary::kKept;
    options.locked.vertices = {44, 55};
    const Decimated result = run(input, mesh.points, options);
    CHECK(result.collapses > 20);
    CHECK(result.rejected[Reason::kLocked] > 0);
    for (std::uint32_t v = 0; v < mesh.points.size(); ++v) {
      if (!input.is_boundary(VertexId(v)) && v != 44 && v != 55) continue;
      REQUIRE(std::binary_search(result.source_vertex.begin(), result.source_vertex.end(), v));
      CHECK(result.positions[result.vertex_map[v]] == mesh.points[v]);
    }
    CHECK(result.mesh.boundary_half_edge_count() == input.boundary_half_edge_count());
  }
}

TEST_CASE("decimation: each rule to stop by", "[decimate]") {
  IndexedFaceSet mesh = test::icosphere(4);
  test::jitter(mesh, 0.01f, 2);
  for (DecimateOptions options : ways()) {
    DecimateOptions by = options;
    by.target.vertices = 100;
    Decimated result = run(mesh, by);
    CHECK(result.stop == DecimateStop::kTargetReached);
    CHECK(result.mesh.vertex_count() == 100);
    by = options;
    by.target.ratio = 0.25;
    result = run(mesh, by);
    CHECK(result.stop == DecimateStop::kTargetReached);
    CHECK(result.mesh.face_count() == mesh.face_count() / 4);
    by.target.faces = mesh.face_count() / 2;  // the first that is met
    CHECK(run(mesh, by).mesh.face_count() == mesh.face_count() / 2);
    by = options;
    by.target.seconds = 0;
    result = run(mesh, by);
    CHECK(result.stop == DecimateStop::kTimeLimit);
    CHECK(result.collapses == 0);
    for (const double bound : {0.002, 0.01}) {
      by = options;
      by.bounds.error = Length::relative(bound);
      result = run(mesh, by);
      CHECK(result.stop == DecimateStop::kErrorBound);
      CHECK(result.rejected[Reason::kErrorBound] > 0);
      CHECK(result.relative_error <= bound);
      CHECK(result.relative_error > 0.5 * bound);
      by.bounds.error = Length::absolute(result.error);
      CHECK(run(mesh, by).error <= result.error);
    }
    for (const double wrong : {-1.0, std::nan("")}) {
      by = options;
      by.bounds.error = Length::relative(wrong);
      CHECK_FALSE(decimate(half_edges(mesh), mesh.points, by));
      by = options;
      by.target.ratio = wrong;
      CHECK_FALSE(decimate(half_edges(mesh), mesh.points, by));
      by = options;
      by.target.seconds = wrong;
      CHECK_FALSE(decimate(half_edges(mesh), mesh.points, by));
    }
    by = options;
    by.locked.vertices = {static_cast<std::uint32_t>(mesh.points.size())};
    CHECK_FALSE(decimate(half_edges(mesh), mesh.points, by));
  }
}

TEST_CASE("decimation: detail of a thousandth a million away, in double precision", "[decimate]") {
  const IndexedFaceSet sphere = test::icosphere(3);
  std::vector<DVec3> near, far;
  for (const Vec3& p : sphere.points) {
    near.push_back(DVec3(Vec3(std::round(p.x * 1024), std::round(p.y * 1024), std::round(p.z * 1024))) /
                   1048576.0);
    far.push_back(near.back() + DVec3(1e6, -1e6, 1e6));  // exact: steps of 2^-20
  }
  for (DecimateOptions options : ways()) {
    options.target.faces = 200;
    const auto a = run(half_edges(sphere), near, options), b = run(half_edges(sphere), far, options);
    CHECK(a.source_vertex == b.source_vertex);
    CHECK(a.error == b.error);
    // A double has steps of 2^-33 there.
    for (std::size_t v = 0; v < a.positions.size(); ++v)
      for (int k = 0; k < 3; ++k)
        CHECK(std::fabs(b.positions[v][k] - (k == 1 ? -1e6 : 1e6) - a.positions[v][k]) <
              std::ldexp(1.0, -32));
  }
}

TEST_CASE("decimation: shuffled input is put in order, and comes out in its own", "[decimate]") {
  IndexedFaceSet mesh = test::icosphere(6);  // 40,962 points
  std::mt19937 random(1);
  std::vector<std::uint32_t> place(mesh.points.size());
  std::iota(place.begin(), place.end(), 0u);
  std::shuffle(place.begin(), place.end(), random);
  IndexedFaceSet shuffled = mesh;
  for (std::size_t v = 0; v < place.size(); ++v) shuffled.points[place[v]] = mesh.points[v];
  for (std::uint32_t& c : shuffled.corners) c = place[c];
  for (DecimateOptions options : ways()) {
    options.target.faces = 2000;
    options.locked.vertices = {7, 40000};
    const auto result = decimate(TriangleSurface{shuffled.points, shuffled.corners}, options);
    REQUIRE(result);
    REQUIRE(validate(result->mesh));
    CHECK(result->mesh.face_count() == 2000);
    CHECK(std::is_sorted(result->source_vertex.begin(), result->source_vertex.end()));
    CHECK(std::is_sorted(result->source_face.begin(), result->source_face.end()));
    for (const std::uint32_t v : {7u, 40000u})
      CHECK(result->positions[result->vertex_map[v]] == shuffled.points[v]);
    // What stands for a point is near it: no triangle of 2,000 on the sphere spans more than half a radius.
    for (std::uint32_t v = 0; v < place.size(); ++v) {
      const DVec3 d = DVec3(result->positions[result->vertex_map[v]]) - DVec3(shuffled.points[v]);
      REQUIRE(dot(d, d) < 0.25);
    }
  }
}

TEST_CASE("decimation: arrays that are no oriented manifold are refused", "[decimate]") {
  for (const IndexedFaceSet& mesh :
       {test::bow_tie(), test::fin(), test::tori_sharing_a_point(), test::mobius(5)}) {
    const auto result = decimate(TriangleSurface{mesh.points, mesh.corners}, {});
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kUnsuitable);
  }
  const std::vector<Vec3> points(3);
  CHECK_FALSE(decimate(TriangleSurface{points, std::vector<std::uint32_t>{0, 1, 3}}, {}));
  CHECK_FALSE(decimate(TriangleSurface{points, std::vector<std::uint32_t>{0, 1}}, {}));
}

TEST_CASE("decimation: every manifold mesh of the CGAL collection, each way and at any ratio",
          "[decimate][data]") {
  std::size_t tried = 0;
  for (const auto& path : test::cgal_meshes_for_long_work()) {
    auto file = read_mesh(path);
    if (!file) continue;
    auto mesh = to_indexed_face_set(std::move(*file));
    if (!mesh || mesh->face_count() == 0) continue;
    auto triangles = triangulate(*mesh);
    REQUIRE(triangles);
    const auto input = to_half_edge_mesh(triangles->mesh);
    if (!input) continue;
    ++tried;
    for (DecimateOptions options : ways())
      for (const double ratio : {0.5, 0.1, 0.02, 0.005}) {
        if (test::kSanitized && ratio != 0.1) continue;
        INFO(path << " to " << ratio);
        options.target.ratio = ratio;
        const Decimated result = run(*input, triangles->mesh.points, options);
        const auto valid = validate(result.mesh);
        if (!valid) FAIL(valid.error().describe());
        CHECK(result.mesh.face_count() > 0);
        CHECK(result.mesh.boundary_loops().size() == input->boundary_loops().size());
      }
  }
  CHECK(tried > test::cgal_meshes_for_long_work().size() / 3);
}

TEST_CASE("decimation: fandisk to 5 % keeps every sharp edge within 0.1 % of its diagonal", "[decimate]") {
  const auto meshes = test::cgal_meshes();
  const auto path =
      std::find_if(meshes.begin(), meshes.end(), [](const auto& p) { return p.filename() == "fandisk.off"; });
  REQUIRE(path != meshes.end());
  const IndexedFaceSet mesh = to_indexed_face_set(read_mesh(*path).value()).value();
  const auto segments_of = [](const HalfEdgeMesh& half_edges, std::span<const Vec3> points, double degrees) {
    const DihedralAngles angles = dihedral_angles(half_edges, points).value();
    const double bent = degrees * std::numbers::pi / 180;
    std::vector<std::array<DVec3, 2>> segments;
    const auto creases =
        find_creases(half_edges, points, angles.half_edge, {.sharp_angle = bent, .soft_angle = bent}).value();
    for (const Crease& crease : creases)
      for (std::size_t i = 0; i < crease.half_edges.size(); ++i)
        segments.push_back({DVec3(points[crease.vertices[i]]),
                            DVec3(points[crease.vertices[(i + 1) % crease.vertices.size()]])});
    return segments;
  };
  const auto distance = [](DVec3 p, const std::array<DVec3, 2>& segment) {
    const DVec3 along = segment[1] - segment[0], to = p - segment[0];
    const double squared = along.x * along.x + along.y * along.y + along.z * along.z;
    const double t = std::clamp((to.x * along.x + to.y * along.y + to.z * along.z) / squared, 0.0, 1.0);
    const DVec3 off = to - t * along;
    return std::sqrt(off.x * off.x + off.y * off.y + off.z * off.z);
  };
  const HalfEdgeMesh input = half_edges(mesh);
  DecimateOptions options;
  options.target.ratio = 0.05;
  options.curves.crease_angle = 40 * std::numbers::pi / 180;
  const Decimated result = run(input, mesh.points, options);
  REQUIRE(result.mesh.face_count() <= mesh.face_count() / 20);
  // What is left of a sharp edge may be bent a little less.
  const auto before = segments_of(input, mesh.points, 40),
             after = segments_of(result.mesh, result.positions, 30);
  REQUIRE(before.size() > 600);
  REQUIRE_FALSE(after.empty());
  Vec3 low = mesh.points[0], high = low;
  for (const Vec3& p : mesh.points)
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  const DVec3 size = DVec3(high) - DVec3(low);
  const double diagonal = std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
  double farthest = 0;
  for (const auto& segment : before)
    for (int i = 0; i < 4; ++i) {
      const DVec3 p = segment[0] + i / 4.0 * (segment[1] - segment[0]);
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& other : after) nearest = std::min(nearest, distance(p, other));
      farthest = std::max(farthest, nearest);
    }
  INFO("farthest " << 100 * farthest / diagonal << " %");
  CHECK(farthest < 0.001 * diagonal);
}

TEST_CASE("the distance between the faces before and after a collapse", "[decimate]") {
  // Two fans around p and q that share the corners 0 and `split`, in a plane but for some height.
  std::mt19937 random(5);
  const auto uniform = [&] { return (static_cast<double>(random()) + 0.5) / 4294967296.0; };
  std::size_t by_ends = 0, by_spokes = 0, near = 0;
  for (int round = 0; round < 2000; ++round) {
    const std::size_t corners = 3 + random() % 18, split = 1 + random() % (corners - 1);
    const double height = round % 3 == 0 ? 0 : 0.3;
    std::vector<DVec3> ring(corners);
    for (std::size_t k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * (static_cast<double>(k) + 0.6 * uniform()) /
                           static_cast<double>(corners),
                   far = 1 + 2 * uniform();
      ring[k] = {far * std::cos(angle), far * std::sin(angle), height * uniform()};
    }
    const auto inside = [&] {
      return DVec3{0.5 * uniform() - 0.25, 0.5 * uniform() - 0.25, height * uniform()};
    };
    const DVec3 p = inside(), q = inside(), x = inside();

    detail::LargeArray<detail::VertexRecord> vertices(corners);
    for (std::size_t k = 0; k < corners; ++k) {
      vertices[k] = {};
      for (int i = 0; i < 3; ++i)
        vertices[k].position[static_cast<std::size_t>(i)] = static_cast<float>(ring[k][i]);
    }
    std::vector<std::uint32_t> at_p, at_q;
    for (std::size_t k = 0; k <= split; ++k) at_p.push_back(static_cast<std::uint32_t>(k));
    for (std::size_t k = split; k < corners; ++k) at_q.push_back(static_cast<std::uint32_t>(k));
    at_q.push_back(0);
    detail::CollapseNeighbourhood around;
    const auto padded = [](std::vector<std::uint32_t>& ids) {
      const std::size_t size = ids.size();
      ids.resize(size + detail::CollapseNeighbourhood::kBlock);
      return std::span<const std::uint32_t>(ids).first(size);
    };
    around.set(vertices, {padded(at_p), {}}, {padded(at_q), {}});
    const auto floats = [](const DVec3& v) {
      return std::array{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    };

    // By definition.
    std::vector<detail::Triangle> before = {{p, q, ring[0]}, {q, p, ring[split]}}, after;
    for (std::size_t k = 0; k < corners; ++k) {
      before.push_back({k < split ? p : q, ring[k], ring[(k + 1) % corners]});
      after.push_back({x, ring[k], ring[(k + 1) % corners]});
    }
    const auto from = [](const DVec3& point, const std::vector<detail::Triangle>& faces) {
      double least = std::numeric_limits<double>::infinity();
      for (const detail::Triangle& face : faces)
        least = std::min(least, detail::squared_distance(point, face));
      return least;
    };
    const double ends = std::max({from(p, after), from(q, after), from(0.5 * (p + q), after)});
    double all = ends;
    for (std::size_t k = 0; k < corners; ++k) {
      if (k <= split) all = std::max(all, from(0.5 * (p + ring[k]), after));
      if (k >= split || k == 0) all = std::max(all, from(0.5 * (q + ring[k]), after));
      all = std::max(all, from(0.5 * (x + ring[k]), before));
    }
    for (const double least : {1e-4, 1e-3, 1e-2, 1.0}) {
      const double expected = ends > least ? ends : std::max(all, least);
      (ends > least ? by_ends : all > least ? by_spokes : near) += 1;
      CAPTURE(round, corners, split, least);
      CHECK(static_cast<double>(detail::squared_distance_of_collapse(
                around, floats(p), floats(q), floats(x - p), static_cast<float>(least))) ==
            Approx(expected).epsilon(1e-3).margin(1e-6));
    }
  }
  CHECK(by_ends > 500);
  CHECK(by_spokes > 50);
  CHECK(near > 500);
}

}  // namespace vkmesh
