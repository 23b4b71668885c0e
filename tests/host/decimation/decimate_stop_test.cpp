// What ends a decimation before its target: the clock and the caller, inside every long step.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <thread>

#include <catch2/catch.hpp>

#include <vkmesh/decimation/decimate.h>

#include "decimate_support.h"
#include "decimation/decimation_state.h"
#include "decimation/parallel/coarsen.h"
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
