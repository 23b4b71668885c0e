#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "decimation/decimate_support.h"
#include "decimation/decimation_state.h"
#include "decimation/parallel/coarsen.h"
#include "decimation/parallel/coarsen_batch.h"
#include "decimation/setup/initial_quadrics.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using detail::CoarsenBatch;
using detail::CollapseMesh;
using detail::VertexRange;
using detail::VertexRecord;
using test::ring_of;

CollapseMesh mesh_of(IndexedFaceSet set, std::uint32_t seed) {
  test::jitter(set, 0.05f, seed);
  CollapseMesh mesh = test::collapse_mesh_of(test::fitted(set));
  detail::sum_quadrics(mesh, {10, 0, -1, 0, nullptr});
  return mesh;
}

/// The sum of both quadrics at q.
double cost_of(const VertexRecord& p, const VertexRecord& q) {
  std::array<double, 3> x;
  for (std::size_t k = 0; k < 3; ++k)
    x[k] = static_cast<double>(q.position[k]) - static_cast<double>(p.position[k]);
  const std::array<std::array<std::size_t, 3>, 3> at = {{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}};
  double sum = p.quadric.c;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += 2 * static_cast<double>(p.quadric.b[i]) * x[i];
    for (std::size_t j = 0; j < 3; ++j) sum += static_cast<double>(p.quadric.a[at[i][j]]) * x[i] * x[j];
  }
  return std::max(sum, 0.0) + static_cast<double>(q.quadric.c);
}

/// The same with vertices that are next to each other 16 numbers apart: in one batch.
IndexedFaceSet spread(const IndexedFaceSet& set) {
  IndexedFaceSet result = set;
  const std::size_t n = set.points.size(), rows = n / 16;
  const auto to = [&](std::size_t v) { return v < 16 * rows ? v % rows * 16 + v / rows : v; };
  for (std::size_t v = 0; v < n; ++v) result.points[to(v)] = set.points[v];
  for (std::uint32_t& c : result.corners) c = static_cast<std::uint32_t>(to(c));
  return result;
}

/// With vertices of few neighbours and of many.
std::vector<IndexedFaceSet> shapes() {
  return {test::icosphere(3), test::torus(30, 16), test::grid(20, 22), test::fine_cube(8)};
}

Vec3 normal_of(const CollapseMesh& mesh, std::uint32_t f) {
  const auto at = [&](std::size_t i) {
    const auto& p = mesh.vertices[mesh.face(4 * f).origin[i]].position;
    return Vec3(p[0], p[1], p[2]);
  };
  return glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
}

}  // namespace

TEST_CASE("coarsening knows the ring of each vertex, and where that goes at the least cost", "[decimate]") {
  for (std::uint32_t seed = 0; seed < 24; ++seed) {
    CollapseMesh mesh = mesh_of(shapes()[seed % 4], seed);
    std::mt19937 random(seed);
    // What vertices have taken in is in their quadrics.
    for (std::uint32_t v = 0; v < mesh.apex(); ++v)
      mesh.vertices[v].quadric.c = 1e-7f * static_cast<float>(random() % 1000);
    const std::uint32_t n = mesh.apex();
    const VertexRange range = seed < 12 ? VertexRange{0, n} : VertexRange{n / 5, n / 5 + n / 2};
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t v = range.begin + seed % 12;
         v < range.end && chosen.size() < CoarsenBatch::kSize - seed % 3; v += 7)
      chosen.push_back(v);
    CoarsenBatch batch;
    batch.set(mesh, chosen, range);
    REQUIRE(batch.count == chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const auto ring = ring_of(mesh, chosen[i]);
      if (ring.size() > CoarsenBatch::kMaxNeighbours) {
        CHECK(!batch.has_best(i));
        continue;
      }
      // The apex is of no range.
      const bool inside = std::ranges::all_of(ring, [&](std::uint32_t v) { return range.holds(v); });
      REQUIRE(batch.is_inside[i] == (inside ? 1u : 0u));
      REQUIRE(batch.has_best(i) == inside);
      REQUIRE(batch.ring[i].size == ring.size());
      // It comes again, and can be read on from any neighbour.
      for (std::size_t k = 0; k < ring.size() + CoarsenBatch::kMaxNeighbours; ++k) {
        const std::uint32_t h = batch.ring[i].edge[k];
        REQUIRE(batch.ring[i].vertex[k] == ring[k % ring.size()]);
        REQUIRE(mesh.origin(h) == chosen[i]);
        REQUIRE(mesh.target(h) == ring[k % ring.size()]);
      }
      if (!inside) continue;
      std::vector<double> costs;
      for (const std::uint32_t r : ring) costs.push_back(cost_of(mesh.vertices[chosen[i]], mesh.vertices[r]));
      const double least = std::ranges::min(costs),
                   rounding = 1e-6 * static_cast<double>(mesh.vertices[chosen[i]].weight);
      CHECK(std::abs(costs[batch.best_of(i)] - least) <= 2e-6 * least + rounding);
      CHECK(std::abs(static_cast<double>(batch.cost_of(i)) - least) <= 2e-6 * least + rounding);
    }
  }
}

/// Connectivity, and that no two edges join the same vertices.
void check(const CollapseMesh& mesh) {
  for (std::uint32_t h = 0; h < mesh.half_edge_bound(); ++h) {
    if (h % 4 == 3 || !mesh.alive(h)) continue;
    const std::uint32_t t = mesh.twin(h);
    REQUIRE(mesh.alive(t));
    REQUIRE(mesh.twin(t) == h);
    REQUIRE(mesh.origin(t) == mesh.target(h));
    REQUIRE((mesh.origin(h) == mesh.apex() || mesh.vertices[mesh.origin(h)].alive()));
  }
  for (std::uint32_t v = 0; v < mesh.apex(); ++v) {
    if (!mesh.vertices[v].alive()) continue;
    const auto ring = ring_of(mesh, v);
    REQUIRE(std::set(ring.begin(), ring.end()).size() == ring.size());
  }
}

/// Any angle is allowed, as far as the options go.
detail::Limits any_angle() {
  detail::Limits limits;
  limits.cos_deviation = -1;
  return limits;
}

TEST_CASE("coarsening takes what costs little from its range alone, and leaves the surface what it is",
          "[decimate]") {
  for (std::uint32_t seed = 0; seed < 16; ++seed) {
    const IndexedFaceSet shape = shapes()[seed % 4];
    CollapseMesh mesh = mesh_of(seed < 8 ? shape : spread(shape), seed);
    const std::uint32_t n = mesh.apex();
    const VertexRange range = seed % 2 == 0 ? VertexRange{0, n} : VertexRange{n / 8, n};
    for (std::uint32_t v = 5; v < n; v += 31) mesh.vertices[v].source |= VertexRecord::kLocked;
    std::vector<VertexRecord> before;
    for (std::uint32_t v = 0; v < n; ++v) before.push_back(mesh.vertices[v]);
    std::vector<CollapseMesh::Face> faces_before;
    for (std::uint32_t h = 0; h < mesh.half_edge_bound(); h += 4) faces_before.push_back(mesh.face(h));
    std::size_t inner = 0;
    for (std::uint32_t v = range.begin; v < range.end; ++v)
      inner += std::ranges::all_of(ring_of(mesh, v), [&](std::uint32_t r) { return range.holds(r); }) ? 1 : 0;
    const detail::Limits limits = any_angle();
    detail::DecimationState state{mesh, limits, mesh.face_count(), n, false, {}};
    const float half = detail::cost_of_share(mesh, 0.5);
    REQUIRE(half < detail::cost_of_share(mesh, 1));
    detail::RangeCoarsening coarsening(state, range, half);
    coarsening.run_all();
    check(mesh);

    std::size_t gone = 0;
    for (std::uint32_t v = 0; v < n; ++v) {
      const VertexRecord& vertex = mesh.vertices[v];
      CHECK(vertex.position == before[v].position);
      if (!range.holds(v)) {
        CHECK(vertex.leading == before[v].leading);
        CHECK(vertex.source == before[v].source);
        CHECK(vertex.weight == before[v].weight);
      }
      if (vertex.alive()) {
        CHECK(!vertex.has(VertexRecord::kTouched));
        CHECK(!vertex.has(VertexRecord::kHasParked));
        CHECK(vertex.quadric.c <= half * 1.001f);
        continue;
      }
      ++gone;
      CHECK(range.holds(v));
      CHECK(!vertex.has(VertexRecord::kLocked));
    }
    for (std::size_t f = 0; f < faces_before.size(); ++f) {
      const CollapseMesh::Face &face = mesh.face(static_cast<std::uint32_t>(4 * f)), &old = faces_before[f];
      if (std::ranges::all_of(old.origin, [&](std::uint32_t v) { return range.holds(v); })) continue;
      CHECK(face.origin == old.origin);
      CHECK(face.twin == old.twin);
    }
    CHECK(8 * gone > inner);
    CHECK(state.vertices + gone == n);
    CHECK(state.faces + 2 * gone == mesh.face_count());
    std::size_t faces = 0;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) faces += mesh.alive(4 * f) ? 1 : 0;
    CHECK(faces == state.faces);

    // What could not go for the range's sake is told, each once.
    std::vector<std::uint32_t> deferred(coarsening.deferred().begin(), coarsening.deferred().end());
    std::ranges::sort(deferred);
    CHECK(std::ranges::adjacent_find(deferred) == deferred.end());
    for (std::uint32_t v = range.begin; v < range.end; ++v) {
      if (before[v].has(VertexRecord::kLocked) || !mesh.vertices[v].alive()) continue;
      const auto ring = ring_of(mesh, v);
      const auto leaves = [&](std::uint32_t r) { return !range.holds(r); };
      if (ring.size() <= CoarsenBatch::kMaxNeighbours && std::ranges::any_of(ring, leaves))
        CHECK(std::ranges::binary_search(deferred, v));
    }
    for (const std::uint32_t v : deferred) CHECK(mesh.vertices[v].alive());
  }
}

TEST_CASE("coarsening leaves alone where faces would turn much", "[decimate]") {
  const double least = std::cos(std::acos(-1.0) / 6) - 1e-4;
  std::size_t merged = 0, left = 0;
  for (std::uint32_t v = 0; v < 300; v += 3) {
    IndexedFaceSet shape = test::icosphere(3);
    test::jitter(shape, 0.3f, v);
    CollapseMesh mesh = mesh_of(shape, v);
    std::vector<Vec3> normals;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) normals.push_back(normal_of(mesh, f));
    const detail::Limits limits = any_angle();
    detail::DecimationState state{mesh, limits, mesh.face_count(), mesh.apex(), false, {}};
    // This one alone.
    detail::RangeCoarsening(state, {0, mesh.apex()}, std::numeric_limits<float>::infinity())
        .run(std::span(&v, 1));
    merged += state.vertices < mesh.apex() ? 1 : 0;
    left += state.vertices == mesh.apex() ? 1 : 0;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      if (mesh.alive(4 * f)) CHECK(static_cast<double>(glm::dot(normals[f], normal_of(mesh, f))) >= least);
  }
  CHECK(merged > 10);
  CHECK(left > 10);
}

TEST_CASE("a surface is coarsened where it is far from its target, the more the farther, and never beyond",
          "[decimate]") {
  const auto left_of = [](IndexedFaceSet shape, std::size_t divisor, auto&& change) {
    test::jitter(shape, 0.02f, 1);
    CollapseMesh mesh = test::collapse_mesh_of(test::fitted(shape));
    detail::sum_quadrics(mesh, {10, 0, -1, 0, nullptr});
    detail::Limits limits = any_angle();
    limits.faces = mesh.face_count() / divisor;
    detail::DecimationState state{mesh, limits, mesh.face_count(), mesh.apex(), false, {}};
    state.sizes.partition_faces = 128;
    state.sizes.range_faces = 1024;
    change(state, limits);
    detail::coarsen_if_far_from_target(state);
    check(mesh);
    std::size_t faces = 0;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) faces += mesh.alive(4 * f) ? 1 : 0;
    REQUIRE(faces == state.faces);
    CHECK(state.faces >= limits.faces);
    return state.faces;
  };
  const auto as_is = [](detail::DecimationState&, detail::Limits&) {};
  const IndexedFaceSet grid = test::grid(30, 330);
  const std::size_t all = grid.face_count(), near = left_of(grid, 8, as_is);
  CHECK(left_of(grid, 7, as_is) == all);
  CHECK(near < all * 2 / 3);
  // What is at the ends of ranges goes, too.
  const std::size_t in_one = left_of(grid, 8, [](auto& state, auto&) { state.sizes.range_faces = 1 << 20; });
  CHECK(near < in_one * 21 / 20);
  CHECK(left_of(grid, 16, as_is) == near);
  const std::size_t far = left_of(grid, 100, as_is);
  CHECK(far < near * 9 / 10);
  CHECK(left_of(grid, 10000, as_is) < far);
  CHECK(left_of(grid, 8, [](auto& state, auto&) { state.keep_events = true; }) == all);
  CHECK(left_of(grid, 8, [](auto&, auto& limits) { limits.error2 = 1; }) == all);
  CHECK(left_of(grid, 8, [](auto& state, auto&) { state.sizes.partition_faces = state.mesh.face_count(); }) ==
        all);
  // It stops where it is told to.
  for (const std::size_t rest : {std::size_t{1}, all * 4 / 5, all - 10}) {
    CollapseMesh mesh = test::collapse_mesh_of(test::fitted(grid));
    detail::sum_quadrics(mesh, {10, 0, -1, 0, nullptr});
    detail::Limits limits = any_angle();
    limits.faces = rest;
    detail::DecimationState state{mesh, limits, mesh.face_count(), mesh.apex(), false, {}};
    detail::RangeCoarsening(state, {0, mesh.apex()}, std::numeric_limits<float>::infinity()).run_all();
    CHECK(state.faces + 1 >= rest);
    CHECK((state.faces <= rest) == (rest > 1));
  }
}

TEST_CASE("ranges are coarsened side by side as one after another", "[decimate]") {
  const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 8);
  IndexedFaceSet shape = test::grid(60, 400);
  test::jitter(shape, 0.05f, 1);
  const auto coarsened = [&](int threads) {
    CollapseMesh mesh = test::collapse_mesh_of(test::fitted(shape));
    detail::sum_quadrics(mesh, {10, 0, -1, 0, nullptr});
    const detail::Limits limits = any_angle();
    detail::DecimationState state{mesh, limits, mesh.face_count(), mesh.apex(), false, {}};
    state.sizes.partition_faces = 1024;
    state.sizes.range_faces = 2048;
    tbb::task_arena(threads).execute([&] { detail::coarsen_if_far_from_target(state); });
    CHECK(state.faces < mesh.face_count() * 2 / 3);
    std::vector<std::uint32_t> words;
    for (std::uint32_t h = 0; h < mesh.half_edge_bound(); h += 4)
      for (std::size_t i = 0; i < 3; ++i) {
        words.push_back(mesh.face(h).origin[i]);
        words.push_back(mesh.face(h).twin[i]);
      }
    for (std::uint32_t v = 0; v < mesh.apex(); ++v) {
      words.push_back(mesh.vertices[v].leading);
      words.push_back(std::bit_cast<std::uint32_t>(mesh.vertices[v].quadric.c));
    }
    return words;
  };
  const auto one = coarsened(1);
  for (const int threads : {2, 8}) CHECK(coarsened(threads) == one);
}

TEST_CASE("decimation: what is far from its target is coarsened at first, on any number of threads alike",
          "[decimate]") {
  const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 8);
  // Six rows of the grid are a range.
  IndexedFaceSet mesh = test::both(test::icosphere(4), test::grid(40, 50));
  test::jitter(mesh, 0.05f, 1);
  for (const DecimateOptions& way : test::ways()) {
    const auto on = [&](int threads, const DecimateOptions& options) {
      tbb::task_arena arena(threads);
      return arena.execute([&] {
        auto result = detail::decimate_in_partitions({mesh.points, mesh.corners}, options);
        REQUIRE(result);
        REQUIRE(validate(result->mesh));
        return std::move(*result);
      });
    };
    const auto same = [](const Decimated& a, const Decimated& b) {
      return std::ranges::equal(a.mesh.origins(), b.mesh.origins()) && a.positions == b.positions &&
             a.vertex_map == b.vertex_map && a.collapses == b.collapses && a.error == b.error;
    };
    for (const double ratio : {0.0, 0.1, 0.2}) {
      DecimateOptions options = way;
      options.target.ratio = ratio;
      const Decimated one = on(1, options);
      for (const int threads : {2, 3, 8}) CHECK(same(on(threads, options), one));
      // The order tells in a history, and where an error is promised.
      options.keep_history = true;
      const Decimated in_order = on(1, options);
      CHECK(same(in_order, one) == (ratio > 0.125));
      if (in_order.stop == DecimateStop::kTargetReached) CHECK(one.stop == DecimateStop::kTargetReached);
      options.keep_history = false;
      options.bounds.error = Length::relative(10);
      CHECK(same(on(1, options), in_order));
    }
  }
}

}  // namespace vkmesh
