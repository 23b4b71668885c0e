// Fuzzes swap_edges() and remesh() over random manifolds: after every swap, and after every iteration, the
// surface is a manifold of the same topology, and whatever the result says of itself holds.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/optimize/swap_edges.h>
#include <vkmesh/remesh/remesh.h>
#include <vkmesh/repair/consolidate.h>

#include "check.h"
#include "random_manifold.h"

namespace vkmesh::fuzz {
namespace {

Topology topology_of(const HalfEdgeMesh& mesh) {
  IndexedFaceSet set;
  set.points.resize(mesh.vertex_count());
  set.corners.assign(mesh.origins().begin(), mesh.origins().end());
  auto topology = surface_topology(set);
  require(topology.has_value(), "any face set has a topology");
  return topology->whole;
}

void require_same_surface(const HalfEdgeMesh& mesh, const Topology& before) {
  require(validate(mesh).has_value(), "the half-edges are valid");
  const Topology after = topology_of(mesh);
  require(after.manifold() && after.oriented(), "the result is an oriented manifold");
  require(after.euler_characteristic() == before.euler_characteristic() &&
              after.boundary_loops == before.boundary_loops,
          "the topology stays");
}

void fuzz_swaps(Bytes& bytes, const HalfEdgeMesh& mesh, const std::vector<Vec3>& points,
                const Topology& before) {
  SwapEdgesOptions options;
  options.costs.clear();
  for (std::uint32_t terms = 1 + bytes.below(2); terms > 0; --terms) {
    constexpr std::array<double, 4> kWeights = {1, 1e-6, 0.5, 1e6};
    const auto cost = static_cast<SwapCost>(bytes.below(kSwapCosts));
    options.costs.push_back({cost, kWeights[bytes.next() % 4]});
  }
  const std::vector<Vec3> normals(points.size(), Vec3(0, 0, 1));
  options.normals = normals;
  const std::uint8_t how = bytes.next();
  if (how % 4 == 0) options.crease_angle = 0.5;
  if (how / 4 % 4 == 0) options.max_dihedral_change = 0.3;
  if (how / 16 % 4 == 0) options.max_deviation = Length::relative(0.01);
  const auto whole = swap_edges(mesh, points, options);
  if (!whole) {
    require(whole.error().code == ErrorCode::kUnsuitable, "only coordinates beyond the largest are refused");
    return;
  }
  require(whole->stop == SwapStop::kNoGain, "it ends by itself");
  require(whole->mesh.edge_count() == mesh.edge_count() && whole->mesh.vertex_count() == mesh.vertex_count(),
          "swaps leave the counts");
  require(std::isfinite(whole->cost_before) && std::isfinite(whole->cost_after), "costs are finite");
  const auto alone = [&](SwapCost cost) {
    return std::ranges::all_of(options.costs,
                               [&](const WeightedSwapCost& term) { return term.cost == cost; });
  };
  // These alone ask for the worse of two triangles, not for a sum.
  if (!alone(SwapCost::kMinAngle) && !alone(SwapCost::kAspectRatio))
    require(whole->cost_after <= whole->cost_before, "no swap raises the cost");
  // One swap after the other: the state of the run after each.
  for (std::size_t swaps = 1; swaps <= std::min<std::size_t>(whole->swaps, 20); ++swaps) {
    options.max_swaps = swaps;
    const auto part = swap_edges(mesh, points, options);
    require(part.has_value() && part->swaps == swaps, "as many swaps as asked for");
    require_same_surface(part->mesh, before);
  }
  require_same_surface(whole->mesh, before);
  if (options.crease_angle) return;  // swaps beside a crease may have made it less than one
  options.max_swaps.reset();
  const auto again = swap_edges(whole->mesh, points, options);
  require(again.has_value() && again->swaps == 0, "a second run finds nothing");
}

void fuzz_remesh(Bytes& bytes, const HalfEdgeMesh& mesh, const std::vector<Vec3>& points,
                 const Topology& before) {
  RemeshOptions options;
  const std::uint8_t how = bytes.next();
  constexpr std::array<double, 4> kSizes = {0.2, 0.5, 1, 4};
  const double size = kSizes[how / 4 % 4];
  // No number of faces is asked for: among needles it comes to lengths that make a million of them.
  if (how % 4 == 0) options.size.edge_length = Length::relative(size);
  if (how % 4 == 1) options.size.deviation = Length::relative(0.1 * size);
  if (how / 16 % 2 == 0) options.curves.creases = CreaseOptions{.sharp_angle = 0.7, .soft_angle = 0.35};
  options.curves.boundary_kept = how / 32 % 2 == 0;
  if (how / 64 == 0) options.max_deviation = Length::relative(0.01);
  std::vector<std::uint32_t> locked;
  for (std::uint32_t left = bytes.next() % 8; left > 0; --left) locked.push_back(bytes.below(points.size()));
  options.locked = locked;
  for (const unsigned iterations : {1u, 2u, 4u}) {
    options.iterations = iterations;
    const auto result = remesh(mesh, points, options);
    if (!result) {
      require(result.error().code == ErrorCode::kUnsuitable || result.error().code == ErrorCode::kUsage,
              "refused for a reason: " + result.error().describe());
      return;
    }
    require(result->positions.size() == result->mesh.vertex_count() &&
                result->corner_origins.size() == result->mesh.origins().size() &&
                result->source_faces.size() == result->mesh.face_count(),
            "the arrays fit the mesh");
    for (const Vec3& p : result->positions)
      require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "places are finite");
    for (const SurfacePoint& origin : result->origins)
      require(origin.face < mesh.face_count(), "origins are on the input");
    require_same_surface(result->mesh, before);
  }
}

void fuzz(std::span<const std::uint8_t> all) {
  Bytes bytes(all);
  const bool swaps = bytes.next() % 2 == 0;
  const RandomManifold manifold(bytes);
  std::vector<Vec3> points;
  for (const auto& [x, y, z] : manifold.points()) {
    points.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    if (!std::isfinite(points.back().x + points.back().y + points.back().z)) return;
  }
  IndexedFaceSet set;
  set.points = points;
  set.corners = manifold.corners();
  const auto mesh = to_half_edge_mesh(set);
  require(mesh.has_value(), "a random manifold is one");
  if (points.empty()) return;
  const Topology before = topology_of(*mesh);
  if (swaps)
    fuzz_swaps(bytes, *mesh, points, before);
  else
    fuzz_remesh(bytes, *mesh, points, before);
}

}  // namespace
}  // namespace vkmesh::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vkmesh::fuzz::fuzz(std::span(data, size));
  return 0;
}
