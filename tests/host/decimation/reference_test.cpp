#include "decimation/reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/analysis/topology.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/half_edge_mesh.h>

#include "decimation/decimate_support.h"
#include "decimation/decimation_state.h"
#include "support/data.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using detail::decimate_by_reference, detail::ReferenceResult;
using test::half_edges, test::run;

/// What is left, by the least vertex of the input that each vertex stands for: it does not matter which of
/// them gave its number.
struct Remains {
  std::map<std::uint32_t, DVec3> points;
  std::set<std::array<std::uint32_t, 3>> faces;
};

template <class Corners, class Points>
Remains remains(const std::vector<std::uint32_t>& vertex_map, const Corners& corners, const Points& points) {
  std::map<std::uint32_t, std::uint32_t> least;
  for (std::uint32_t v = 0; v < vertex_map.size(); ++v) least.try_emplace(vertex_map[v], v);
  Remains result;
  for (std::size_t c = 0; c < corners.size(); c += 3) {
    std::array<std::uint32_t, 3> face;
    for (std::size_t i = 0; i < 3; ++i) {
      face[i] = least.at(corners[c + i]);
      result.points[face[i]] = DVec3(points[corners[c + i]]);
    }
    std::rotate(face.begin(), std::ranges::min_element(face), face.end());
    result.faces.insert(face);
  }
  return result;
}
std::vector<std::uint32_t> corners_of(const ReferenceResult& r) {
  std::vector<std::uint32_t> corners;
  for (const auto& face : r.faces) corners.insert(corners.end(), face.begin(), face.end());
  return corners;
}
Remains remains(const ReferenceResult& r) {
  return remains(r.vertex_map, corners_of(r), r.positions);
}
Remains remains(const Decimated& d) {
  return remains(d.vertex_map, d.mesh.origins(), d.positions);
}

/// How far the points lie apart at most; infinite where the faces differ.
double apart(const Remains& a, const Remains& b) {
  if (a.faces != b.faces) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (const auto& [v, p] : a.points) {
    const DVec3 d = p - b.points.at(v);
    most = std::max(most, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
  }
  return most;
}

IndexedFaceSet mesh_of(const ReferenceResult& r) {
  IndexedFaceSet mesh;
  std::map<std::uint32_t, std::uint32_t> number;
  mesh.corners = corners_of(r);
  for (std::uint32_t& v : mesh.corners) {
    const auto [at, is_new] = number.try_emplace(v, static_cast<std::uint32_t>(number.size()));
    if (is_new) mesh.points.emplace_back(r.positions[v]);
    v = at->second;
  }
  return mesh;
}

IndexedFaceSet rough(IndexedFaceSet mesh, std::uint32_t seed) {
  test::jitter(mesh, 0.04f, seed);
  return mesh;
}

/// By the exact order: any weight of another criterion takes the heap, and this one counts next to nothing.
DecimateOptions in_exact_order(DecimateOperation operation) {
  DecimateOptions options;
  options.operation = operation;
  options.weights.density = 1e-8;
  return options;
}

constexpr std::array kOperations = {DecimateOperation::kEdgeCollapse, DecimateOperation::kHalfEdgeCollapse,
                                    DecimateOperation::kVertexRemoval};

}  // namespace

TEST_CASE("decimation in the exact order is that of the reference", "[decimate][reference]") {
  for (const auto operation : kOperations) {
    std::size_t cases = 0, same = 0;
    for (const auto boundary : {DecimateBoundary::kInShape, DecimateBoundary::kKept, DecimateBoundary::kFree})
      for (std::uint32_t seed = 1; seed <= (test::kSanitized ? 1u : 3u); ++seed)
        for (const IndexedFaceSet& mesh :
             {test::icosphere(2), test::torus(12, 10), test::grid(9, 9), test::cylinder(6, 9)})
          for (const double ratio : {0.5, 0.2}) {
            const IndexedFaceSet input = rough(mesh, seed);
            DecimateOptions options = in_exact_order(operation);
            options.curves.boundary = boundary;
            options.target.ratio = ratio;
            const Decimated fast = run(input, options);
            const ReferenceResult reference = decimate_by_reference({input.points, input.corners}, options);
            ++cases;
            same += apart(remains(fast), remains(reference)) < 1e-4 ? 1 : 0;
          }
    // Floats order a few costs otherwise that are alike but for rounding.
    INFO("operation " << static_cast<int>(operation) << ": the same " << same << " of " << cases << " times");
    CHECK(4 * same >= 3 * cases);
  }
}

TEST_CASE("the reference leaves a manifold of the same topology, and what is locked",
          "[decimate][reference]") {
  for (const auto operation : kOperations)
    for (const IndexedFaceSet& mesh : {test::icosphere(2), test::torus(12, 10), test::grid(9, 9),
                                       test::cylinder(6, 9), test::double_torus()}) {
      const IndexedFaceSet input = rough(mesh, 4);
      DecimateOptions options;
      options.operation = operation;
      options.target.faces = 0;
      options.bounds.normal_deviation = 3;
      options.locked.vertices = {0, 5, 9};
      const ReferenceResult result = decimate_by_reference({input.points, input.corners}, options);
      CHECK(result.steps > input.points.size() / 2);
      for (const std::uint32_t v : options.locked.vertices) {
        CHECK(result.vertex_map[v] == v);
        CHECK(result.positions[v] == DVec3(input.points[v]));
      }
      const IndexedFaceSet left = mesh_of(result);
      REQUIRE(validate(half_edges(left)));
      const auto before = surface_topology(input), after = surface_topology(left);
      REQUIRE((before && after));
      CHECK(after->whole.euler_characteristic() == before->whole.euler_characteristic());
      CHECK(after->whole.boundary_loops == before->whole.boundary_loops);
      // The fast one may go no farther: nothing that is left is legal.
      options.target = {};
      options.locked = {};
      for (std::uint32_t v = 0; v < input.points.size(); ++v) options.locked.vertices.push_back(v);
      CHECK(decimate_by_reference({input.points, input.corners}, options).steps == 0);
    }
}

TEST_CASE("the reference heeds the bound of the error", "[decimate][reference]") {
  const IndexedFaceSet input = rough(test::icosphere(2), 5);
  for (const auto operation : kOperations) {
    DecimateOptions options = in_exact_order(operation);
    options.bounds.error = Length::absolute(0.02);
    const ReferenceResult reference = decimate_by_reference({input.points, input.corners}, options);
    CHECK(reference.error <= 0.02);
    CHECK(reference.error > 0.01);
    const Decimated fast = run(input, options);
    CHECK(static_cast<double>(fast.collapses) == Approx(static_cast<double>(reference.steps)).epsilon(0.02));
  }
}

TEST_CASE("what is nearly the cheapest does as well as the cheapest", "[decimate][reference]") {
  IndexedFaceSet mesh = test::icosphere(test::kSanitized ? 3 : 5);
  for (Vec3& p : mesh.points)
    p *= 1.0f + 0.05f * std::sin(9 * p.x) * std::sin(11 * p.y + 1) + 0.02f * std::sin(23 * p.z);
  const TriangleSurface surface{mesh.points, mesh.corners};
  for (const auto operation : kOperations)
    for (const double ratio : {0.3, 0.1, 0.03}) {
      if (test::kSanitized && ratio != 0.1) continue;
      INFO("operation " << static_cast<int>(operation) << " to " << ratio);
      DecimateOptions options;
      options.operation = operation;
      options.target.ratio = ratio;
      const auto mean = [&](const std::vector<Vec3>& points, std::span<const std::uint32_t> corners) {
        const auto distance =
            surface_distance(surface, {points, corners}, {test::kSanitized ? 10000u : 50000u, 1});
        REQUIRE(distance);
        return distance->two_sided().mean;
      };
      const IndexedFaceSet exact = mesh_of(decimate_by_reference(surface, options));
      const double least = mean(exact.points, exact.corners);
      const Decimated fast = run(mesh, options);
      CHECK(fast.stop == DecimateStop::kTargetReached);
      CHECK(fast.mesh.face_count() == exact.face_count());
      CHECK(mean(fast.positions, fast.mesh.origins()) < (test::kSanitized ? 1.05 : 1.03) * least);
      if (operation == DecimateOperation::kVertexRemoval) continue;  // of one partition
      // Most of these partitions is interface; of large ones it is little.
      const auto partitioned = detail::decimate_in_partitions(surface, options);
      REQUIRE(partitioned);
      CHECK(mean(partitioned->positions, partitioned->mesh.origins()) <
            (test::kSanitized ? 1.1 : 1.08) * least);
    }
}

}  // namespace vkmesh
