// Every pass on the device against its CPU reference, bit for bit. (tests/host/passes/ checks
// the reference.)
#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/engine/passes/bilateral_smoothing.h>
#include <vkmesh/engine/passes/collapse_costs.h>
#include <vkmesh/engine/passes/curvatures.h>
#include <vkmesh/engine/passes/dihedral_angles.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/engine/passes/restore_volume.h>
#include <vkmesh/engine/passes/surface_measures.h>
#include <vkmesh/engine/passes/swap_scores.h>
#include <vkmesh/engine/passes/triangle_normals.h>
#include <vkmesh/engine/passes/vertex_normals.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/triangle_normals.h>
#include <vkmesh/passes/vertex_normals.h>
#include <vkmesh/repair/consolidate.h>

#include "core/fake_loader.h"
#include "support/data.h"
#include "support/device.h"
#include "support/shapes.h"

using namespace vkmesh;

namespace {

using test::require, test::require_done;

// The number of places where two arrays differ in any bit, plus the difference in their lengths.
std::size_t differences(std::span<const float> a, std::span<const float> b) {
  std::size_t count = std::max(a.size(), b.size()) - std::min(a.size(), b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    count += std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]);
  return count;
}

std::size_t differences(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return differences(std::span(a.empty() ? nullptr : &a[0].x, 3 * a.size()),
                     std::span(b.empty() ? nullptr : &b[0].x, 3 * b.size()));
}

int allocations = 0;

VkResult VKAPI_PTR count_allocation(VkDevice device, const VkMemoryAllocateInfo* info,
                                    const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
  ++allocations;
  return test::FakeLoader::real<PFN_vkAllocateMemory>("vkAllocateMemory")(device, info, callbacks, memory);
}

// Runs `record` on a fresh device mesh.
template <class Record>
DeviceMesh run(const HalfEdgeMesh& mesh, std::span<const Vec3> positions, Record&& record) {
  DeviceMesh device = require(DeviceMesh::create(test::test_context(), mesh, positions));
  Recorder recorder = require(Recorder::create(test::test_context()));
  require_done(record(recorder, device));
  require_done(recorder.submit_and_wait());
  return device;
}

// The first fills of the queues.
void check_exact_costs(const HalfEdgeMesh& mesh, std::span<const Vec3> points) {
  for (const CollapsePlacement placement :
       {CollapsePlacement::kOptimal, CollapsePlacement::kMidpoint, CollapsePlacement::kEndpoint}) {
    CollapseCostOptions options = unit_frame(points);
    options.placement = placement;
    options.boundary_weight = 30.0f;
    DeviceCollapseCosts result;
    run(mesh, points, [&](Recorder& recorder, DeviceMesh& device) {
      return record_collapse_costs(recorder, device, result, options);
    });
    const auto found = require(result.quadrics.download()),
               wanted = require(vertex_quadrics(mesh, points, options));
    CHECK(differences(std::span(found.empty() ? nullptr : found[0].data(), 6 * found.size()),
                      std::span(wanted.empty() ? nullptr : wanted[0].data(), 6 * wanted.size())) == 0);
    CHECK(differences(require(result.costs.download()),
                      require(collapse_costs(mesh, points, wanted, options))) == 0);
  }
  for (const SwapCriterion criterion : {SwapCriterion::kMinAngle, SwapCriterion::kAspectRatio}) {
    DeviceArray<float> scores;
    run(mesh, points, [&](Recorder& recorder, DeviceMesh& device) {
      return record_swap_scores(recorder, device, scores, criterion);
    });
    CHECK(differences(require(scores.download()), require(swap_scores(mesh, points, criterion))) == 0);
  }
}

// Smoothing that takes the volume away, and getting it back, in one submission.
void check_exact_volume(const HalfEdgeMesh& mesh, std::span<const Vec3> points) {
  const LaplacianSmoothingOptions options{.lambda = 0.8f, .iterations = 3};
  const auto smoothed = require(laplacian_smoothing(require(node_neighbours(mesh)), points, options));
  const auto wanted = restore_volume(mesh, points, smoothed);
  DeviceMesh device = require(DeviceMesh::create(test::test_context(), mesh, points));
  DeviceSurfaceMeasures before, after;
  DeviceSmoothing smoothing;
  Recorder recorder = require(Recorder::create(test::test_context()));
  require_done(record_surface_measures(recorder, device, before));
  require_done(record_laplacian_smoothing(recorder, device, smoothing, options));
  const auto restored = record_restore_volume(recorder, device, before, after);
  REQUIRE(restored.has_value() == wanted.has_value());
  if (!wanted) {
    CHECK(restored.error().code == wanted.error().code);
    return;
  }
  require_done(recorder.submit_and_wait());
  CHECK(differences(require(device.positions().download()), *wanted) == 0);
}

// With σ_f of so many mean edge lengths.
void check_exact_bilateral(const HalfEdgeMesh& mesh, std::span<const Vec3> points, double widths) {
  const double edge = mean_edge_length(mesh, points);
  const BilateralSmoothingOptions options{.spatial = static_cast<float>(widths * edge),
                                          .influence = static_cast<float>(0.3 * edge)};
  const auto wanted = bilateral_smoothing(mesh, points, options);
  auto nearby = NearbyFaces::create(test::test_context(), mesh, points, options);
  REQUIRE(nearby.has_value() == wanted.has_value());
  if (!wanted) {
    CHECK(nearby.error().code == wanted.error().code);
    return;
  }
  const DeviceMesh moved = run(mesh, points, [&](Recorder& recorder, DeviceMesh& device) {
    return record_bilateral_smoothing(recorder, device, *nearby);
  });
  CHECK(differences(require(moved.positions().download()), *wanted) == 0);
}

// Under GPU-assisted validation, on SwiftShader and under the sanitizers a coarser one, mended: the fine one
// takes minutes there.
bool coarse_dragon() {
  return test::kSanitized || test::gpu_assisted() || test::is_swiftshader(test::test_context());
}

IndexedFaceSet dragon() {
  const char* name = coarse_dragon() ? "dragon_vrip_res3.ply.gz" : "dragon_vrip.ply.gz";
  return require(consolidate(require(to_indexed_face_set(require(read_mesh(test::dragon(name))))))).face_set;
}

// Runs all passes on both sides and compares every output.
void check_exact(const IndexedFaceSet& set) {
  const HalfEdgeMesh mesh = test::half_edges(set);
  Context& context = test::test_context();
  for (const NormalWeights weights : {NormalWeights::kAngle, NormalWeights::kUniform}) {
    DeviceVertexNormals result;
    run(mesh, set.points, [&](Recorder& recorder, DeviceMesh& device) {
      return record_vertex_normals(recorder, device, result, {.weights = weights});
    });
    CHECK(differences(require(result.normals.download()),
                      require(vertex_normals(mesh, set.points, {.weights = weights}))) == 0);
  }
  check_exact_costs(mesh, set.points);
  check_exact_volume(mesh, set.points);
  const NodeNeighbours neighbours = require(node_neighbours(mesh));
  DeviceArray<VertexCurvature> curved;
  DeviceSurfaceMeasures measures;
  run(mesh, set.points, [&](Recorder& recorder, DeviceMesh& device) -> Result<void> {
    VKMESH_CHECK(record_curvatures(recorder, device, curved));
    return record_surface_measures(recorder, device, measures);
  });
  const auto bent = require(curved.download());
  const auto expected = require(curvatures(neighbours, set.points));
  CHECK(differences(std::span(bent.empty() ? nullptr : &bent[0].mean, 4 * bent.size()),
                    std::span(expected.empty() ? nullptr : &expected[0].mean, 4 * expected.size())) == 0);
  const SurfaceMeasures measured = require(measures.download());
  const SurfaceMeasures wanted = require(surface_measures(mesh, set.points));
  CHECK(measured.area == wanted.area);
  CHECK(measured.volume == wanted.volume);
  CHECK(measured.centroid == wanted.centroid);
  CHECK(differences(std::vector{measured.low, measured.high}, std::vector{wanted.low, wanted.high}) == 0);
  std::vector<std::uint32_t> locks(neighbours.boundary_bits.size());
  std::mt19937 random(23);
  for (std::uint32_t& word : locks) word = static_cast<std::uint32_t>(random() & random());
  for (const LaplacianSmoothingOptions& options :
       {LaplacianSmoothingOptions{
            .lambda = 0.63f, .iterations = 3, .boundary = SmoothingBoundary::kFree, .mu = -0.67f},
        LaplacianSmoothingOptions{.iterations = 3, .boundary = SmoothingBoundary::kAlongItself},
        LaplacianSmoothingOptions{
            .lambda = 0.9f, .iterations = 4, .weights = SmoothingWeights::kCotangent, .mu = -0.95f},
        LaplacianSmoothingOptions{
            .iterations = 3, .boundary = SmoothingBoundary::kFree, .weights = SmoothingWeights::kCotangent},
        LaplacianSmoothingOptions{.iterations = 3,
        .boundary = SmoothingBoundary::kAlongItself,
        .weights = SmoothingWeights::kCotangent}})
    for (const bool locked : {false, true}) {
      DeviceSmoothing smoothing;
      if (locked) require_done(smoothing.locked.upload(context, locks));
      const DeviceMesh smoothed = run(mesh, set.points, [&](Recorder& recorder, DeviceMesh& device) {
        return record_laplacian_smoothing(recorder, device, smoothing, options);
      });
      LaplacianSmoothingOptions on_host = options;
      if (locked) on_host.locked = locks;
      CHECK(differences(require(smoothed.positions().download()),
                        require(laplacian_smoothing(neighbours, set.points, on_host))) == 0);
    }
  for (const LaplacianSmoothingOptions& options :
       {LaplacianSmoothingOptions{.lambda = 0.5f, .iterations = 1, .boundary = SmoothingBoundary::kFixed},
        LaplacianSmoothingOptions{.lambda = 0.37f, .iterations = 10, .boundary = SmoothingBoundary::kFree}}) {
    DeviceMesh device = require(DeviceMesh::create(context, mesh, set.points));
    DeviceArray<Vec3> of_triangles;
    DeviceVertexNormals of_vertices;
    DeviceDihedralAngles found;
    DeviceSmoothing smoothing;
    Recorder recorder = require(Recorder::create(context));
    require_done(record_triangle_normals(recorder, device, of_triangles));
    require_done(record_vertex_normals(recorder, device, of_vertices));
    require_done(record_dihedral_angles(recorder, device, found));
    require_done(record_laplacian_smoothing(recorder, device, smoothing, options));
    require_done(recorder.submit_and_wait());

    const DihedralAngles angles = require(dihedral_angles(mesh, set.points));
    CHECK(differences(require(of_triangles.download()), require(triangle_normals(mesh, set.points))) == 0);
    CHECK(differences(require(of_vertices.normals.download()), require(vertex_normals(mesh, set.points))) ==
          0);
    CHECK(differences(require(found.half_edge.download()), angles.half_edge) == 0);
    CHECK(differences(require(found.vertex_maximum.download()), angles.vertex_maximum) == 0);
    CHECK(differences(require(device.positions().download()),
                      require(laplacian_smoothing(require(node_neighbours(mesh)), set.points, options))) ==
          0);
  }
}

}  // namespace

TEST_CASE("passes equal their references bit for bit on shapes, noisy and scaled") {
  std::vector<IndexedFaceSet> shapes = {test::tetrahedron(), test::cube(),       test::icosphere(4),
                                        test::torus(50, 31), test::grid(33, 17), test::cylinder(9, 11)};
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    check_exact(shapes[i]);
    test::jitter(shapes[i], 0.05f, i);
    check_exact(shapes[i]);
    for (Vec3& p : shapes[i].points) p *= 0x1p-45f;
    check_exact(shapes[i]);
    for (Vec3& p : shapes[i].points) p *= 0x1p95f;
    check_exact(shapes[i]);
  }
}

TEST_CASE("passes equal their references where lengths vanish: subnormal, coincident and collinear points") {
  IndexedFaceSet set = test::icosphere(3);
  std::mt19937 random(17);
  for (Vec3& p : set.points)
    for (int k = 0; k < 3; ++k) {
      const int exponent = static_cast<int>(random() % 150u) - 149;
      p[k] = std::ldexp(p[k], exponent);
    }
  check_exact(set);
  for (Vec3& p : set.points) p.y = p.x;
  check_exact(set);
  for (Vec3& p : set.points) p = Vec3(0.25f);
  check_exact(set);
}

TEST_CASE("passes leave isolated vertices alone, and take a mesh without faces and an empty one") {
  IndexedFaceSet set = test::grid(3, 3);
  set.points.insert(set.points.begin(), Vec3(5.0f, 6.0f, 7.0f));
  for (auto& c : set.corners) ++c;
  check_exact(set);
  set.corners.clear();
  check_exact(set);
  set.points.clear();
  check_exact(set);
}

TEST_CASE("passes equal their references bit for bit on the dragon") {
  const IndexedFaceSet set = dragon();
  CHECK(set.face_count() == (coarse_dragon() ? 47400 : 871414));
  check_exact(set);
}

// Under GPU-assisted validation with at most 520 faces around a vertex: docs/testing.md says why.
TEST_CASE("bilateral smoothing equals its reference with widths from a part of an edge to the whole mesh") {
  const bool few = test::gpu_assisted();
  for (IndexedFaceSet set :
       {test::icosphere(few ? 2 : 3), test::grid(20, 13), few ? test::torus(20, 12) : test::torus(30, 20)}) {
    test::jitter(set, 0.05f, 3);
    set.points.push_back(Vec3(100.0f, 0.0f, 0.0f));  // Isolated, and far away.
    for (const double widths : {0.02, 0.5, 3.0, 40.0})
      check_exact_bilateral(test::half_edges(set), set.points, widths);
  }
}

TEST_CASE("bilateral smoothing equals its reference on shapes, where lengths vanish, and on the dragon") {
  std::vector<IndexedFaceSet> shapes = {test::tetrahedron(), test::cube(),       test::icosphere(4),
                                        test::torus(50, 31), test::grid(33, 17), test::cylinder(9, 11)};
  for (std::uint32_t i = 0; i < shapes.size(); ++i)
    for (const bool noisy : {false, true}) {
      if (noisy) test::jitter(shapes[i], 0.05f, i);
      check_exact_bilateral(test::half_edges(shapes[i]), shapes[i].points, 1.0);
    }
  IndexedFaceSet vanishing = test::icosphere(test::gpu_assisted() ? 2 : 3);
  std::mt19937 random(17);
  for (Vec3& p : vanishing.points)
    for (int k = 0; k < 3; ++k) p[k] = std::ldexp(p[k], static_cast<int>(random() % 150u) - 149);
  check_exact_bilateral(test::half_edges(vanishing), vanishing.points, 1.0);
  const IndexedFaceSet scanned = dragon();
  check_exact_bilateral(test::half_edges(scanned), scanned.points, 1.0);
}

TEST_CASE("a vertex of more neighbours than the device's loops have rounds is refused, and not cut short") {
  constexpr std::uint32_t kSides = 70000;
  IndexedFaceSet fan;
  fan.points.push_back(Vec3(0.0f, 0.0f, 1.0f));
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 6.283185307179586 * i / kSides;
    fan.points.push_back(
        Vec3(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.0f));
    for (const std::uint32_t v : {0u, 1 + i, 1 + (i + 1) % kSides}) fan.corners.push_back(v);
  }
  const HalfEdgeMesh mesh = test::half_edges(fan);
  DeviceMesh device = require(DeviceMesh::create(test::test_context(), mesh, fan.points));
  Recorder recorder = require(Recorder::create(test::test_context()));
  DeviceVertexNormals normals;
  DeviceSmoothing smoothing;
  for (const Result<void>& recorded : {record_vertex_normals(recorder, device, normals),
                                       record_laplacian_smoothing(recorder, device, smoothing)}) {
    if (test::test_context().info().loop_rounds > kSides) {
      CHECK(recorded);
    } else {
      REQUIRE_FALSE(recorded);
      CHECK(recorded.error().code == ErrorCode::kUnsuitable);
      CHECK_THAT(recorded.error().message, Catch::Contains("vertex 0 has 70000 neighbours"));
    }
  }
  const BilateralSmoothingOptions wide{.spatial = 4.0f, .influence = 1.0f};
  const auto nearby = NearbyFaces::create(test::test_context(), mesh, fan.points, wide);
  CHECK(nearby.has_value() == (test::test_context().info().loop_rounds > kSides));
}

TEST_CASE("normals after smoothing in one submission are those of the smoothed positions") {
  IndexedFaceSet set = test::icosphere(3);
  test::jitter(set, 0.05f, 1);
  const HalfEdgeMesh mesh = test::half_edges(set);
  const LaplacianSmoothingOptions options{.lambda = 0.6f, .iterations = 7};
  DeviceMesh device = require(DeviceMesh::create(test::test_context(), mesh, set.points));
  DeviceSmoothing smoothing;
  DeviceVertexNormals normals;
  Recorder recorder = require(Recorder::create(test::test_context()));
  require_done(record_laplacian_smoothing(recorder, device, smoothing, options));
  require_done(record_vertex_normals(recorder, device, normals));
  require_done(recorder.submit_and_wait());
  const auto smoothed = require(laplacian_smoothing(require(node_neighbours(mesh)), set.points, options));
  CHECK(differences(require(normals.normals.download()), require(vertex_normals(mesh, smoothed))) == 0);
}

TEST_CASE("results that are kept are written again without an allocation, for smaller meshes, too") {
  test::FakeLoader loader;
  loader.replace("vkAllocateMemory", count_allocation);
  const auto context = require(Context::create(loader.options()));
  const IndexedFaceSet small = test::cube(), large = test::icosphere(3);
  const HalfEdgeMesh small_mesh = test::half_edges(small), large_mesh = test::half_edges(large);
  DeviceMesh small_device = require(DeviceMesh::create(*context, small_mesh, small.points)),
             large_device = require(DeviceMesh::create(*context, large_mesh, large.points));
  // Adjacency is uploaded ahead.
  for (DeviceMesh* device : {&small_device, &large_device}) {
    REQUIRE(device->corners());
    REQUIRE(device->corner_offsets());
  }
  const auto allocations_of = [&](DeviceMesh& device, DeviceVertexNormals& normals) {
    allocations = 0;
    Recorder recorder = require(Recorder::create(*context));
    require_done(record_vertex_normals(recorder, device, normals));
    require_done(recorder.submit_and_wait());
    return allocations;
  };
  const auto wanted_small = require(vertex_normals(small_mesh, small.points)),
             wanted_large = require(vertex_normals(large_mesh, large.points));
  DeviceVertexNormals kept;
  CHECK(allocations_of(large_device, kept) == 2);  // Normals and scratch.
  for (int frame = 0; frame < 3; ++frame) {
    CHECK(allocations_of(small_device, kept) == 0);
    CHECK(differences(require(kept.normals.download()), wanted_small) == 0);
    CHECK(allocations_of(large_device, kept) == 0);
    CHECK(differences(require(kept.normals.download()), wanted_large) == 0);
  }
}

TEST_CASE("passes on the device: options out of range, and what was made for another mesh, are errors") {
  const IndexedFaceSet set = test::cube();
  const HalfEdgeMesh mesh = test::half_edges(set);
  Context& context = test::test_context();
  DeviceMesh device = require(DeviceMesh::create(context, mesh, set.points));
  Recorder recorder = require(Recorder::create(context));
  const auto is_usage = [](const Result<void>& result) {
    return !result && result.error().code == ErrorCode::kUsage;
  };
  DeviceSmoothing smoothing;
  CHECK(is_usage(record_laplacian_smoothing(recorder, device, smoothing, {.lambda = 1.5f})));
  CHECK(is_usage(record_laplacian_smoothing(recorder, device, smoothing, {.mu = 0.5f})));
  const std::vector<std::uint32_t> locks(1, 0u), too_many(2, 0u);
  CHECK(is_usage(record_laplacian_smoothing(recorder, device, smoothing, {.locked = locks})));
  require_done(smoothing.locked.upload(context, too_many));
  CHECK(is_usage(record_laplacian_smoothing(recorder, device, smoothing)));
  DeviceCollapseCosts costs;
  CHECK(is_usage(record_collapse_costs(recorder, device, costs, {.scale = 0.0f})));
  NearbyFaces of_another =
      require(NearbyFaces::create(context, test::half_edges(test::tetrahedron()), test::tetrahedron().points,
                                  {.spatial = 0.5f, .influence = 0.1f}));
  CHECK(is_usage(record_bilateral_smoothing(recorder, device, of_another)));
  DeviceSurfaceMeasures never_measured, after;
  CHECK(is_usage(record_restore_volume(recorder, device, never_measured, after)));
  CHECK(is_usage(DeviceMesh::create(context, mesh, std::vector<Vec3>(7)).map([](const DeviceMesh&) {})));
}
