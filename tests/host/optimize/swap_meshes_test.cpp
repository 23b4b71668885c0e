// Edge swaps of real meshes, and of random ones.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/optimize/intrinsic_triangulation.h>
#include <vkmesh/optimize/swap_edges.h>
#include <vkmesh/passes/swap_rounds.h>
#include <vkmesh/repair/consolidate.h>

#include "fuzz/random_manifold.h"
#include "support/data.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

/// What swaps of any surface keep.
void check_kept(const HalfEdgeMesh& before, const HalfEdgeMesh& after) {
  const auto valid = validate(after);
  if (!valid) FAIL(valid.error().describe());
  CHECK(after.vertex_count() == before.vertex_count());
  CHECK(after.face_count() == before.face_count());
  CHECK(after.edge_count() == before.edge_count());
  CHECK(after.boundary_half_edge_count() == before.boundary_half_edge_count());
  CHECK(after.boundary_loops().size() == before.boundary_loops().size());
  for (std::uint32_t v = 0; v < before.vertex_count(); ++v)
    REQUIRE(before.is_boundary(VertexId(v)) == after.is_boundary(VertexId(v)));
}

}  // namespace

TEST_CASE("swaps of real meshes end by themselves, and keep their topology", "[optimize]") {
  std::size_t tried = 0, swaps = 0, flips = 0;
  for (const auto& path : test::cgal_meshes_for_long_work()) {
    CAPTURE(path.string());
    auto file = read_mesh(path);
    if (!file) continue;
    auto set = to_indexed_face_set(std::move(*file));
    if (!set || set->face_count() == 0 || set->face_count() > 40000) continue;
    auto cut = triangulate(*set);
    if (!cut) continue;
    auto made = consolidate(std::move(cut->mesh));
    if (!made || !made->mesh.is_triangles()) continue;
    ++tried;
    for (const SwapCost cost : {SwapCost::kMinAngle, SwapCost::kDelaunay, SwapCost::kMeanCurvature}) {
      SwapEdgesOptions options;
      options.costs = {{cost, 1}};
      const auto result = swap_edges(made->mesh, made->face_set.points, options);
      REQUIRE(result.has_value());
      CHECK(result->stop == SwapStop::kNoGain);
      check_kept(made->mesh, result->mesh);
      // Nothing that is legal is left: a second run swaps nothing.
      const auto again = swap_edges(result->mesh, made->face_set.points, options);
      REQUIRE(again.has_value());
      CHECK(again->swaps == 0);
      swaps += result->swaps;
    }
    auto intrinsic = IntrinsicTriangulation::create(made->mesh, made->face_set.points);
    REQUIRE(intrinsic.has_value());
    const auto done = intrinsic->flip_to_delaunay();
    REQUIRE(done.has_value());
    CHECK(done->finished);
    flips += done->flips;
    for (std::uint32_t h = 0; h < intrinsic->half_edge_count(); ++h)
      if (intrinsic->twins()[h] != kInvalid && intrinsic->twins()[h] / 3 != h / 3)
        REQUIRE((intrinsic->cotangent_sum(h) >= -1e-6 || !intrinsic->can_flip(h)));
  }
  CHECK(tried > test::cgal_meshes_for_long_work().size() / 3);
  CHECK(swaps > 1000);
  CHECK(flips > 1000);
}

TEST_CASE("swaps of random surfaces keep them valid, swap by swap and round by round", "[optimize]") {
  std::size_t swaps = 0;
  for (std::uint32_t seed = 0; seed < (test::kSanitized ? 40u : 160u); ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::vector<std::uint8_t> bytes(400);
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
    fuzz::Bytes input(bytes);
    const fuzz::RandomManifold surface(input);
    IndexedFaceSet set;
    for (const auto& [x, y, z] : surface.points())
      set.points.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    set.corners = surface.corners();
    if (!check_positions(set.points)) continue;
    const HalfEdgeMesh mesh = test::half_edges(set);
    const auto cost = static_cast<SwapCost>(seed % 8);
    SwapEdgesOptions options;
    options.costs = {{cost, 1}};
    options.max_swaps = 1;
    HalfEdgeMesh at = mesh;
    for (int i = 0; i < 20; ++i) {
      const auto one = swap_edges(at, set.points, options);
      REQUIRE(one.has_value());
      check_kept(at, one->mesh);
      if (one->swaps == 0) break;
      at = one->mesh;
    }
    options.max_swaps.reset();
    const auto all = swap_edges(mesh, set.points, options);
    REQUIRE(all.has_value());
    CHECK(all->stop == SwapStop::kNoGain);
    check_kept(mesh, all->mesh);
    swaps += all->swaps;
    SwapRoundsOptions rounds;
    rounds.criterion = seed % 2 == 0 ? SwapCriterion::kMinAngle : SwapCriterion::kAspectRatio;
    const auto done = swap_rounds(mesh, set.points, rounds);
    REQUIRE(done.has_value());
    CHECK(done->swaps.back() == 0);
    check_kept(mesh, done->mesh);
    auto intrinsic = IntrinsicTriangulation::create(mesh, set.points);
    REQUIRE(intrinsic.has_value());
    REQUIRE(intrinsic->flip_to_delaunay().has_value());
  }
  CHECK(swaps > 500);
}

}  // namespace vkmesh
