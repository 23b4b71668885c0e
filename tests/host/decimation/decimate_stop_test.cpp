// What ends a decimation before its target: the clock and the caller, inside every long step.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/decimation/decimate.h>

#include "decimate_support.h"
#include "decimation/cost/attribute_quadrics.h"
#include "decimation/decimation_state.h"
#include "decimation/parallel/coarsen.h"
#include "decimation/setup/build_mesh.h"
#include "decimation/setup/initial_quadrics.h"
#include "decimation/setup/prepare.h"
#include "decimation/setup/prune.h"
#include "support/asking_clock.h"
#include "support/data.h"
#include "support/shapes.h"

using namespace vkmesh;
using detail::Stop;

namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

/// Two tips over a ring of so many points, which are the neighbours of both.
IndexedFaceSet bicone(std::uint32_t valence) {
  IndexedFaceSet mesh;
  for (std::uint32_t i = 0; i < valence; ++i) {
    const double angle = 2 * std::numbers::pi * i / valence, radius = 1 + 0.01 * std::sin(7.0 * i);
    mesh.points.emplace_back(static_cast<float>(radius * std::cos(angle)),
                             static_cast<float>(radius * std::sin(angle)), 0.0f);
  }
  mesh.points.emplace_back(0.0f, 0.0f, 1.0f);
  mesh.points.emplace_back(0.0f, 0.0f, -1.0f);
  for (std::uint32_t i = 0; i < valence; ++i) {
    const std::uint32_t next = (i + 1) % valence;
    mesh.corners.insert(mesh.corners.end(), {i, next, valence, next, i, valence + 1});
  }
  return mesh;
}

}  // namespace

TEST_CASE("decimation: the clock is asked on any thread, the caller on its own", "[decimate]") {
  int calls = 0;
  const Progress cancel = [&](double) { return ++calls > 1; };
  Stop late(cancel, Stop::Clock::now(), 0);
  CHECK_FALSE(late.is_set());
  std::thread([&] { late.ask(); }).join();
  CHECK(late.is_time_over());
  CHECK_FALSE(late.is_cancelled());
  CHECK(calls == 0);

  Stop cancelled(cancel, Stop::Clock::now() - std::chrono::hours(1), kForever);
  std::thread([&] { cancelled.ask(); }).join();
  CHECK(calls == 0);
  cancelled.ask();  // who has not been heard for an hour
  CHECK(calls == 1);
  CHECK(cancelled.is_cancelled());
  CHECK(cancelled.check().error().code == ErrorCode::kInterrupted);

  Stop heard(cancel, Stop::Clock::now(), kForever);
  heard.ask();
  CHECK(calls == 1);  // not so long ago
  heard.report(0.5);
  CHECK(calls == 2);
  CHECK_FALSE(heard.is_set());
  CHECK(heard.check());
}

TEST_CASE("decimation: coarsening stops when the time is over", "[decimate]") {
  for (const bool in_time : {true, false}) {
    detail::CollapseMesh mesh = test::collapse_mesh_of(test::fitted(test::icosphere(5)));
    const detail::Limits limits;
    const Progress silent;
    Stop stop(silent, Stop::Clock::now(), in_time ? kForever : 0);
    detail::DecimationState state{
        .mesh = mesh, .limits = limits, .faces = mesh.face_count(), .vertices = mesh.apex(), .stop = &stop};
    detail::RangeCoarsening coarsening(state, {0, mesh.apex()}, std::numeric_limits<float>::max());
    coarsening.run_all();
    CHECK((state.outcome.collapses > 0) == in_time);
  }
}

TEST_CASE("decimation: without time left the surface is what it was, large ones too", "[decimate]") {
  for (const DecimateOptions& way : test::ways()) {
    const IndexedFaceSet mesh = test::icosphere(4);
    DecimateOptions options = way;
    options.target.ratio = 0.01;
    options.target.seconds = 0;
    const Decimated result = detail::decimate_in_partitions({mesh.points, mesh.corners}, options).value();
    CHECK(result.stop == DecimateStop::kTimeLimit);
    CHECK(result.collapses == 0);
    CHECK(result.positions == mesh.points);
    CHECK(std::ranges::equal(result.mesh.origins(), mesh.corners));
  }
}

TEST_CASE("decimation: a vertex of many neighbours takes no time out of proportion, whatever ranks removals",
          "[decimate]") {
  const IndexedFaceSet mesh = bicone(test::kSanitized ? 500 : 2000);
  for (const DecimateOptions& way : test::ways())
    for (int criterion = 0; criterion < 4; ++criterion) {
      CAPTURE(way.operation, criterion);
      DecimateOptions options = way;
      if (criterion == 1) options.weights.density = 1;
      if (criterion == 2) options.weights.aspect_ratio = 1;
      if (criterion == 3) options.weights.normals = 1;
      options.target.ratio = 0.1;
      // Many times what it takes, and a small part of what k^3 steps would.
      options.target.seconds = 20;
      CHECK(test::run(mesh, options).stop == DecimateStop::kTargetReached);
    }
}

namespace {

/// Values that differ on the two sides of some edges.
struct Shades {
  std::vector<float> values;
  std::vector<std::uint32_t> corners;

  explicit Shades(const IndexedFaceSet& mesh) {
    for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
      const Vec3& p = mesh.points[mesh.corners[c]];
      const bool low = mesh.points[mesh.corners[c - c % 3]].z < 0;
      values.push_back(low ? p.x : p.y + 5);
      corners.push_back(static_cast<std::uint32_t>(c));
    }
  }
};

/// A sphere, a small one beside it, and points of no face.
IndexedFaceSet two_spheres() {
  IndexedFaceSet mesh = test::icosphere(4);
  const IndexedFaceSet small = test::icosphere(1);
  mesh.points.insert(mesh.points.begin(), Vec3(9, 9, 9));
  for (std::uint32_t& c : mesh.corners) ++c;
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (const Vec3& p : small.points) mesh.points.push_back(0.1f * p + Vec3(3, 0, 0));
  for (const std::uint32_t c : small.corners) mesh.corners.push_back(first + c);
  mesh.points.emplace_back(-9.0f, 9.0f, 9.0f);
  return mesh;
}

}  // namespace

TEST_CASE(
    "decimation: it ends at whatever question the time is over, with a surface, or at the caller's word",
    "[decimate]") {
  const IndexedFaceSet mesh = two_spheres();
  const TriangleSurface surface{mesh.points, mesh.corners};
  const Shades shades(mesh);
  for (const DecimateOptions& way : test::ways())
    for (int attributes = 0; attributes < 2; ++attributes) {
      CAPTURE(way.operation, attributes);
      DecimateOptions options = way;
      options.target.ratio = 0.05;
      options.prune_size = Length::absolute(0.5);
      options.bounds.original_normal_deviation = 1.5;
      options.keep_history = true;
      if (attributes == 1) options.attributes.push_back({1, shades.values, shades.corners});
      const auto decimated = [&](const Progress& progress) {
        test::g_questions = 0;
        return detail::decimate_in_partitions(surface, options, {.partition_faces = 32, .range_faces = 512},
                                              progress, test::asking_clock);
      };
      REQUIRE(decimated({}));
      const int questions = test::g_questions;
      // The setup asks a few times; the fewer, the more of it may pass unasked.
      CHECK(questions > 30);
      bool unchanged = false, changed = false;
      for (int n = 1; n < questions; n += 1 + n / 16) {
        CAPTURE(n);
        options.target.seconds = n;
        const Decimated result = decimated({}).value();
        CHECK(validate(result.mesh));
        CHECK((result.stop == DecimateStop::kTimeLimit || result.collapses > 0));
        changed |= result.collapses > 0;
        CHECK_FALSE((changed && result.collapses == 0));
        if (result.collapses > 0) continue;
        unchanged = true;
        // All but the points of no face, and what small parts there are.
        CHECK(result.pruned_components == 0);
        CHECK(result.mesh.face_count() == mesh.face_count());
        REQUIRE(result.positions.size() == mesh.points.size() - 2);
        for (std::size_t c = 0; c < mesh.corners.size(); ++c)
          REQUIRE(result.source_vertex[result.mesh.origins()[c]] == mesh.corners[c]);
        for (std::uint32_t v = 0; v < mesh.points.size(); ++v)
          CHECK((v == 0 || v + 1 == mesh.points.size()) == (result.vertex_map[v] == kInvalid));
        for (std::size_t v = 0; v < result.positions.size(); ++v)
          CHECK(result.positions[v] == mesh.points[result.source_vertex[v]]);
        CHECK(result.source_face.size() == mesh.face_count());
      }
      CHECK(unchanged);
      CHECK(changed);
      options.target.seconds.reset();
      // The clock goes on so fast that each question on the caller's thread is one to the caller.
      int calls = 0;
      REQUIRE(decimated([&](double) { return ++calls > 0; }));
      const int all = calls;
      CHECK(all > 10);
      for (int n = 1; n <= all / 2; n += 1 + n / 16) {
        CAPTURE(n, all);
        calls = 0;
        const auto result = decimated([&](double) { return ++calls < n; });
        REQUIRE_FALSE(result);
        CHECK(result.error().code == ErrorCode::kInterrupted);
      }
    }
}

TEST_CASE("decimation: every long step before the first removal asks all along, and ends where it is told to",
          "[decimate]") {
  using namespace detail;
  // So many faces that those between two questions are few of them.
  const IndexedFaceSet mesh = test::grid(256, 256);
  const auto vertices = static_cast<std::uint32_t>(mesh.points.size());
  // The same in an order without locality.
  IndexedFaceSet spread = mesh;
  const auto place = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::uint64_t{v} * 40503 % vertices);
  };
  for (std::uint32_t v = 0; v < vertices; ++v) spread.points[place(v)] = mesh.points[v];
  for (std::uint32_t& c : spread.corners) c = place(c);
  std::vector<std::uint32_t> groups;
  std::vector<float> values;
  for (std::size_t c = 0; c < mesh.corners.size(); ++c)
    groups.push_back(c / 3 < mesh.face_count() / 2 ? 0 : 1);
  for (const Vec3& p : mesh.points) values.push_back(p.x);
  DecimateOptions options;
  options.corner_groups = groups;
  options.attributes = {{1, values, {}}};

  const Progress silent;
  const auto built = [](const IndexedFaceSet& set, Stop& stop) {
    return build_mesh(std::span<const Vec3>(set.points), std::span<const std::uint32_t>(set.corners), stop);
  };
  const auto wedges = [&](CollapseMesh& given, Stop& stop) {
    return *find_wedges(given, vertices, options, stop);
  };
  const auto done = [](const auto& result, const Stop& stop) {
    INFO((result ? std::string() : result.error().describe()));
    CHECK(result.has_value() == !stop.is_set());
  };
  Stop at_ease(silent, {}, kForever, test::asking_clock);
  BuiltMesh ready = built(mesh, at_ease).value();
  const Wedges whole = wedges(ready.mesh, at_ease);
  const auto attributes = [&](Stop& stop) {
    return AttributeQuadrics(ready.mesh, vertices, whole, options.attributes, mesh.corners, 1, true, stop);
  };
  const std::map<std::string, std::function<void(Stop&)>> steps = {
      {"connectivity", [&](Stop& stop) { done(built(mesh, stop), stop); }},
      {"connectivity along a curve", [&](Stop& stop) { done(built(spread, stop), stop); }},
      {"wedges", [&](Stop& stop) { wedges(ready.mesh, stop); }},
      {"attributes", [&](Stop& stop) { attributes(stop); }},
      {"quadrics", [&](Stop& stop) { sum_quadrics(ready.mesh, {}, &stop); }},
      {"components", [&](Stop& stop) { done(prune_components(ready.mesh, 0, stop), stop); }},
  };
  for (const auto& [name, step] : steps) {
    CAPTURE(name);
    test::check_asks(name == "components" ? 4 : name.starts_with("connectivity") ? 180 : 8, step);
  }
}

TEST_CASE("decimation: what the time leaves unchanged has the wedges of a decimation that removes nothing",
          "[decimate]") {
  const IndexedFaceSet mesh = test::icosphere(3);
  const Shades shades(mesh);
  for (const DecimateOptions& way : test::ways()) {
    DecimateOptions options = way;
    options.keep_history = true;
    options.bounds.report_distance = true;
    options.attributes.push_back({1, shades.values, shades.corners});
    options.target.ratio = 1;
    const Decimated nothing = test::run(mesh, options);
    options.target.ratio = 0.1;
    options.target.seconds = 0;
    const Decimated late = test::run(mesh, options);
    CHECK(late.stop == DecimateStop::kTimeLimit);
    CHECK(late.attributes.corners == nothing.attributes.corners);
    CHECK(late.attributes.values == nothing.attributes.values);
    // Which corner stands for a wedge is free.
    const std::vector<std::uint32_t>& stands = late.attributes.source_corner;
    REQUIRE(stands.size() == nothing.attributes.source_corner.size());
    for (std::uint32_t w = 0; w < stands.size(); ++w) CHECK((late.attributes.corners[stands[w]] == w));
    REQUIRE(late.changes.corners.size() == mesh.corners.size());
    for (std::size_t c = 0; c < mesh.corners.size(); ++c)
      CHECK((late.changes.corners[c] == stands[late.attributes.corners[c]]));
    CHECK(late.changes.values == nothing.changes.values);
    CHECK(late.distance_bound == 0.0);
    CHECK(late.source_face == nothing.source_face);
    CHECK(late.vertex_map == nothing.vertex_map);
    CHECK(std::ranges::equal(late.mesh.origins(), nothing.mesh.origins()));
    CHECK(std::ranges::equal(late.mesh.twins(), nothing.mesh.twins()));
  }
}
