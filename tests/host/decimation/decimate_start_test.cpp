#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <vkmesh/decimation/decimate.h>

#include "decimation/decimate_support.h"
#include "decimation/legality/wedges.h"
#include "decimation/parallel/partition.h"
#include "decimation/setup/initial_quadrics.h"
#include "decimation/vertex_record.h"
#include "support/shapes.h"
#include "support/vectors.h"

namespace vkmesh {
namespace {

using detail::CollapseMesh;
using detail::Partition;
using detail::VertexRecord;
using test::collapse_mesh_of;
using test::cross, test::dot;

/// The same with other numbers for the points.
IndexedFaceSet shuffle(const IndexedFaceSet& mesh, std::uint32_t seed) {
  std::vector<std::uint32_t> place(mesh.points.size());
  std::iota(place.begin(), place.end(), 0u);
  std::shuffle(place.begin(), place.end(), std::mt19937(seed));
  IndexedFaceSet shuffled = mesh;
  for (std::size_t v = 0; v < place.size(); ++v) shuffled.points[place[v]] = mesh.points[v];
  for (std::uint32_t& c : shuffled.corners) c = place[c];
  return shuffled;
}

/// Faces of different groups have a seam between them.
std::uint32_t group_of(std::uint32_t face) {
  return face / 4 % 3;
}

/// The weight of the planes at each vertex, and w n nᵀ, by definition.
class Sums {
 public:
  Sums(const IndexedFaceSet& mesh, const detail::ConstraintWeights& weights) : at(mesh.points.size()) {
    struct Face {
      DVec3 area;  // doubled
      std::uint32_t group;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, Face> faces;  // by half-edge
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      const auto corners = mesh.face(f);
      const DVec3 a(mesh.points[corners[0]]), b(mesh.points[corners[1]]), c(mesh.points[corners[2]]);
      const DVec3 area = cross(b - a, c - a);
      for (std::size_t i = 0; i < 3; ++i) {
        add(corners[i], area, std::sqrt(dot(area, area)) / 2);
        faces[{corners[i], corners[(i + 1) % 3]}] = {area, group_of(f)};
      }
    }
    for (const auto& [ends, face] : faces) {
      const DVec3& area = face.area;
      const DVec3 edge = DVec3(mesh.points[ends.second]) - DVec3(mesh.points[ends.first]);
      const auto other = faces.find({ends.second, ends.first});
      double weight = weights.boundary;
      if (other != faces.end()) {
        const DVec3& beyond = other->second.area;
        const double cosine = dot(area, beyond) / std::sqrt(dot(area, area) * dot(beyond, beyond));
        const bool crease = cosine < weights.crease_cosine, seam = face.group != other->second.group;
        weight = std::max(crease ? weights.crease : 0, seam ? weights.seam : 0);
        creases += crease ? 1 : 0;
        seams_in_creases += crease && seam ? 1 : 0;
      }
      for (const std::uint32_t v : {ends.first, ends.second})
        add(v, cross(edge, area), weight * dot(edge, edge));
    }
  }

  std::vector<std::array<double, 7>> at;
  std::size_t creases = 0, seams_in_creases = 0;

 private:
  void add(std::uint32_t v, const DVec3& normal, double weight) {
    const double squared = dot(normal, normal);
    if (!(squared > 0)) return;
    std::size_t to = 0;
    at[v][to++] += weight;
    for (int i = 0; i < 3; ++i)
      for (int k = i; k < 3; ++k) at[v][to++] += weight * normal[i] * normal[k] / squared;
  }
};

/// That the quadrics of all vertices are these sums.
void check_quadrics(const IndexedFaceSet& mesh, const detail::ConstraintWeights& weights, int threads) {
  const Sums expected(mesh, weights);
  tbb::task_arena arena(threads);
  CollapseMesh built = arena.execute([&] {
    CollapseMesh made = collapse_mesh_of(mesh);
    const detail::Wedges wedges(
        made, mesh.points.size(),
        [](std::uint32_t c, std::uint32_t d) { return group_of(c / 3) == group_of(d / 3); }, nullptr);
    detail::ConstraintWeights all = weights;
    all.wedges = &wedges;
    detail::sum_quadrics(made, all);
    return made;
  });
  std::size_t wrong = 0;
  for (std::uint32_t v = 0; v < mesh.points.size(); ++v) {
    const VertexRecord& vertex = built.vertices[v];
    const auto& sum = expected.at[v];
    const double rounding = 1e-5 * sum[0];
    bool same = std::fabs(static_cast<double>(vertex.weight) - sum[0]) <= rounding;
    for (std::size_t k = 0; k < 6; ++k)
      same &= std::fabs(static_cast<double>(vertex.quadric.a[k]) - sum[k + 1]) <= rounding;
    same &= vertex.quadric.c == 0 && vertex.quadric.b == std::array<float, 3>{};
    wrong += same ? 0 : 1;
  }
  INFO(mesh.face_count() << " faces, " << mesh.points.size() << " points, " << threads << " threads");
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("decimation: quadrics start as the sums over the planes of faces, boundaries, creases and seams",
          "[decimate]") {
  const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 8);
  // Some blocks of faces, the last of any size; a fold every few rows.
  IndexedFaceSet sheet = test::grid(46, 47);
  test::jitter(sheet, 0.2f, 1);
  for (Vec3& p : sheet.points) p.z += 2 * std::fabs(std::remainder(p.x, 8.0f));
  const IndexedFaceSet mesh = test::both(sheet, test::tetrahedron());
  for (const std::size_t faces : {std::size_t{1}, std::size_t{4}, std::size_t{64}, std::size_t{66},
                                  std::size_t{95}, std::size_t{2049}, mesh.face_count()}) {
    IndexedFaceSet some = mesh;
    some.corners.resize(3 * faces);  // these are manifolds, too
    for (const detail::ConstraintWeights& weights :
         {detail::ConstraintWeights{}, detail::ConstraintWeights{10, 0, -1, 0, nullptr},
          detail::ConstraintWeights{0.5f, 3, std::cos(0.8f), 0, nullptr},
          detail::ConstraintWeights{0, 0, -1, 2, nullptr},
          detail::ConstraintWeights{0.5f, 3, std::cos(0.8f), 4, nullptr}}) {
      const Sums sums(some, weights);
      CHECK((faces < 2000 || weights.crease == 0 || sums.creases > 100));
      CHECK((faces < 2000 || weights.crease == 0 || sums.seams_in_creases > 10));
      for (const int threads : {1, 2, 3, 8}) check_quadrics(some, weights, threads);
    }
  }
}

TEST_CASE("decimation: a vertex where threads divide the vertices has all its faces", "[decimate]") {
  const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 8);
  IndexedFaceSet mesh = test::grid(46, 40);
  test::jitter(mesh, 0.2f, 1);
  constexpr std::size_t kBlock = 2048;  // faces of which the range of vertices is known
  const std::span<const std::uint32_t> corners(mesh.corners);
  const std::size_t high = std::ranges::max(corners.first(3 * kBlock)),
                    low = std::ranges::min(corners.subspan(3 * kBlock));
  // Two threads have half of the points each, be they used or not.
  for (const std::size_t points : {2 * high - 2, 2 * high, 2 * high + 2, 2 * low, 2 * low + 2, 2 * low + 4}) {
    REQUIRE(points >= mesh.points.size());
    IndexedFaceSet more = mesh;
    more.points.resize(points);
    check_quadrics(more, {10, 0, -1, 0, nullptr}, 2);
  }
}

TEST_CASE(
    "decimation: partitions of a surface too large to be counted are of one size, however it is numbered",
    "[decimate]") {
  IndexedFaceSet mesh = test::grid(360, 250);
  for (Vec3& p : mesh.points) p = p / 360.0f - Vec3(0.5f);
  for (const bool shuffled : {false, true}) {
    CollapseMesh built = collapse_mesh_of(shuffled ? shuffle(mesh, 1) : mesh);
    const std::vector<std::uint8_t> labels = detail::partition_kd(built, 8);
    std::vector<std::size_t> size(8);
    for (std::uint32_t v = 0; v < built.apex(); ++v) ++size.at(labels[v] & ~Partition::kInner);
    const auto [least, most] = std::ranges::minmax(size);
    CHECK(10 * most < 11 * least);
  }
}

TEST_CASE("decimation: points that no face uses change nothing, but must be finite", "[decimate]") {
  for (const bool shuffled : {false, true}) {
    IndexedFaceSet mesh = test::icosphere(shuffled ? 6 : 3);
    test::jitter(mesh, 0.01f, 1);
    if (shuffled) mesh = shuffle(mesh, 1);
    DecimateOptions options;
    options.target.ratio = 0.3;
    const auto expected = decimate(TriangleSurface{mesh.points, mesh.corners}, options);
    REQUIRE(expected);
    IndexedFaceSet more = mesh;
    for (const float far : {1e10f, -3e20f, 7e-3f}) more.points.emplace_back(far, -far, 0.5f * far);
    const auto result = decimate(TriangleSurface{more.points, more.corners}, options);
    REQUIRE(result);
    CHECK(result->positions == expected->positions);
    CHECK(result->source_vertex == expected->source_vertex);
    CHECK(result->relative_error == expected->relative_error);
    CHECK(std::ranges::equal(result->mesh.origins(), expected->mesh.origins()));
    CHECK(result->vertex_map[mesh.points.size()] == kInvalid);
    for (const float wrong : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
      more.points.back().y = wrong;
      const auto refused = decimate(TriangleSurface{more.points, more.corners}, options);
      REQUIRE_FALSE(refused);
      CHECK(refused.error().code == ErrorCode::kUnsuitable);
    }
  }
}

TEST_CASE("decimation: corners that name no point are refused in any order of points", "[decimate]") {
  for (const bool shuffled : {false, true}) {
    const IndexedFaceSet sheet = test::grid(200, 180);
    const IndexedFaceSet mesh = shuffled ? shuffle(sheet, 1) : sheet;
    const auto count = static_cast<std::uint32_t>(mesh.points.size());
    for (const std::size_t corner : {std::size_t{0}, mesh.corners.size() / 2, mesh.corners.size() - 1})
      for (const std::uint32_t wrong : {count, count + 1, kInvalid}) {
        std::vector<std::uint32_t> corners = mesh.corners;
        corners[corner] = wrong;
        const auto result = decimate(TriangleSurface{mesh.points, corners}, {});
        REQUIRE_FALSE(result);
        CHECK(result.error().code == ErrorCode::kUsage);
      }
    // The other way to be refused.
    std::vector<std::uint32_t> corners = mesh.corners;
    corners[mesh.corners.size() - 1] = corners[mesh.corners.size() - 3];
    const auto result = decimate(TriangleSurface{mesh.points, corners}, {});
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kUnsuitable);
  }
}

TEST_CASE("decimation: a face of two points is refused, wherever it stands", "[decimate]") {
  const IndexedFaceSet sheet = test::grid(46, 47);
  const auto p = static_cast<std::uint32_t>(sheet.points.size()), q = p + 1;
  // Its half-edges fit together as those of a closed surface do.
  for (const std::array<std::uint32_t, 3>& face :
       {std::array{p, q, p}, std::array{p, p, q}, std::array{q, p, p}})
    for (const bool first : {false, true}) {
      IndexedFaceSet mesh = sheet;
      mesh.points.insert(mesh.points.end(), {{1, 2, 3}, {2, 3, 4}});
      mesh.corners.insert(first ? mesh.corners.begin() : mesh.corners.end(), face.begin(), face.end());
      const auto result = decimate(TriangleSurface{mesh.points, mesh.corners}, {});
      REQUIRE_FALSE(result);
      CHECK(result.error().code == ErrorCode::kUnsuitable);
    }
}

TEST_CASE("decimation: every face of a large surface comes from its own, by the map of vertices",
          "[decimate]") {
  for (const bool shuffled : {false, true}) {
    IndexedFaceSet mesh = test::grid(200, 180);
    test::jitter(mesh, 0.2f, 1);
    if (shuffled) mesh = shuffle(mesh, 1);
    for (const double ratio : {1.0, 0.6, 0.02}) {
      DecimateOptions options;
      options.target.ratio = ratio;
      options.keep_history = true;
      const auto result = decimate(TriangleSurface{mesh.points, mesh.corners}, options);
      REQUIRE(result);
      REQUIRE(validate(result->mesh));
      // As many faces as asked for, unless one more was left when the last collapse took two.
      const auto target =
          static_cast<std::size_t>(std::llround(ratio * static_cast<double>(mesh.face_count())));
      const bool took_two = !result->history.empty() && result->history.back().faces[0] != kInvalid &&
                            result->history.back().faces[1] != kInvalid;
      CHECK((result->mesh.face_count() == target || (took_two && result->mesh.face_count() + 1 == target)));
      std::size_t wrong = 0;
      for (std::size_t f = 0; f < result->mesh.face_count(); ++f)
        for (std::size_t i = 0; i < 3; ++i)
          wrong += result->mesh.origins()[3 * f + i] ==
                           result->vertex_map[mesh.corners[3 * result->source_face[f] + i]]
                       ? 0
                       : 1;
      CHECK(wrong == 0);
      // By the history, the other way round: what stands for a vertex stands for those it has absorbed.
      std::vector<std::uint32_t> stands(mesh.points.size());
      std::iota(stands.begin(), stands.end(), 0u);
      for (auto c = result->history.rbegin(); c != result->history.rend(); ++c)
        stands[c->removed] = stands[c->kept];
      for (std::size_t v = 0; v < stands.size(); ++v)
        wrong += result->vertex_map[v] < result->source_vertex.size() &&
                         result->source_vertex[result->vertex_map[v]] == stands[v]
                     ? 0
                     : 1;
      CHECK(wrong == 0);
    }
  }
}

}  // namespace vkmesh
