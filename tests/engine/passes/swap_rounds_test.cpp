// Rounds of edge swaps on the device against the CPU's, bit for bit.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/engine/passes/swap_rounds.h>

#include "support/device.h"
#include "support/shapes.h"

namespace vkmesh::test {
namespace {

bool same(const HalfEdgeMesh& a, const HalfEdgeMesh& b) {
  return std::ranges::equal(a.origins(), b.origins()) && std::ranges::equal(a.twins(), b.twins()) &&
         std::ranges::equal(a.leadings(), b.leadings());
}

}  // namespace

TEST_CASE("rounds of swaps on the device equal the CPU's bit for bit") {
  std::vector<IndexedFaceSet> shapes = noisy_shapes();
  for (IndexedFaceSet& shape : shapes) jitter(shape, 0.04f, 9);
  for (auto& [name, shape] : degenerate_shapes()) shapes.push_back(shape);
  shapes.emplace_back();
  if (gpu_assisted()) shapes.erase(shapes.begin() + 2, shapes.end() - 3);  // each takes seconds there
  std::size_t swaps = 0;
  for (const IndexedFaceSet& shape : shapes) {
    const HalfEdgeMesh mesh = half_edges(shape);
    std::vector<std::uint32_t> locked(mesh.half_edge_count(), 0);
    for (std::size_t h = 0; h < locked.size(); h += 5) locked[h] = 1;
    for (const SwapCriterion criterion : {SwapCriterion::kMinAngle, SwapCriterion::kAspectRatio})
      for (const bool with_locks : {false, true}) {
        SwapRoundsOptions options;
        options.criterion = criterion;
        if (with_locks) options.locked = locked;
        const SwapRounds wanted = require(swap_rounds(mesh, shape.points, options));
        DeviceMesh device = require(DeviceMesh::create(test_context(), mesh, shape.points));
        const SwapRounds found = require(run_swap_rounds(test_context(), device, options));
        CHECK(found.swaps == wanted.swaps);
        CHECK(same(found.mesh, wanted.mesh));
        CHECK(found.source_corner == wanted.source_corner);
        for (const std::uint32_t n : found.swaps) swaps += n;
      }
  }
  CHECK(swaps > (gpu_assisted() ? 100 : 1000));
}

TEST_CASE("rounds of swaps go on where an earlier recording ended") {
  IndexedFaceSet shape = torus(30, 20);
  jitter(shape, 0.06f, 4);
  const HalfEdgeMesh mesh = half_edges(shape);
  DeviceMesh device = require(DeviceMesh::create(test_context(), mesh, shape.points));
  DeviceSwapRounds state;
  for (const std::uint32_t rounds : {1u, 2u}) {
    Recorder recorder = require(Recorder::create(test_context()));
    REQUIRE(record_swap_rounds(recorder, device, state, rounds, 3).has_value());
    REQUIRE(recorder.submit_and_wait().has_value());
  }
  SwapRoundsOptions options;
  options.max_rounds = 3;
  const SwapRounds wanted = require(swap_rounds(mesh, shape.points, options));
  CHECK(wanted.swaps.back() > 0);
  CHECK(require(state.swaps.download()) == wanted.swaps);
  CHECK(require(state.corners.download()) ==
        std::vector(wanted.mesh.origins().begin(), wanted.mesh.origins().end()));
  CHECK(require(state.twins.download()) ==
        std::vector(wanted.mesh.twins().begin(), wanted.mesh.twins().end()));
  const SwapRounds found = require(run_swap_rounds(test_context(), device, options));
  CHECK(found.swaps == wanted.swaps);
  CHECK(same(found.mesh, wanted.mesh));
  options.max_rounds = 0;
  const SwapRounds none = require(run_swap_rounds(test_context(), device, options));
  CHECK(same(none.mesh, mesh));
  CHECK(none.source_corner == require(swap_rounds(mesh, shape.points, options)).source_corner);

  Recorder recorder = require(Recorder::create(test_context()));
  CHECK(record_swap_rounds(recorder, device, state, 1, 3).error().code == ErrorCode::kUsage);
  DeviceSwapRounds other;
  REQUIRE(other.locked.upload(test_context(), std::vector<std::uint32_t>(7)).has_value());
  CHECK(record_swap_rounds(recorder, device, other, 1, 3).error().code == ErrorCode::kUsage);
  const std::vector<std::uint32_t> few(7);
  options.locked = few;
  CHECK(run_swap_rounds(test_context(), device, options).error().code == ErrorCode::kUsage);
  options = {};
  CHECK(run_swap_rounds(test_context(), device, options, [](double) { return false; }).error().code ==
        ErrorCode::kInterrupted);
}

TEST_CASE("a plane of many points is Delaunay again after few rounds on the device") {
  // Slow devices take fewer points.
  const std::uint32_t n = gpu_assisted() || is_swiftshader(test_context()) ? 30 : 120;
  IndexedFaceSet plane = grid(n, n);
  jitter(plane, 0.3f, 1);
  for (Vec3& p : plane.points) p.z = 0.0f;
  const HalfEdgeMesh mesh = half_edges(plane);
  DeviceMesh device = require(DeviceMesh::create(test_context(), mesh, plane.points));
  const SwapRounds found = require(run_swap_rounds(test_context(), device));
  CHECK(found.swaps.size() <= 15);
  CHECK(same(found.mesh, require(swap_rounds(mesh, plane.points)).mesh));
}

}  // namespace vkmesh::test
