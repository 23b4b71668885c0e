// What every way to decimate shares: the limits, and what has been done.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/decimation/reason.h>

#include "base/stop.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

class AttributeQuadrics;
class Criteria;

struct Limits {
  std::size_t faces = 0, vertices = 0;
  std::size_t vertices_asked = 0;  // less than `vertices` where the target is out of reach
  double error2 = std::numeric_limits<double>::infinity();  // mean squared distance, local units
  float cos_deviation = 0;
};

/// From how many faces on work is shared out: of each partition whose edges are collapsed, and of each range
/// that is coarsened.
struct PartitionSizes {
  std::size_t partition_faces = std::size_t{1} << 16, range_faces = std::size_t{3} << 16;
};

struct Event {
  std::uint32_t kept, removed;
  std::array<float, 3> position;
  bool moved;  // from where the input has it
  std::array<std::uint32_t, 2> faces;
  std::uint32_t bucket = 0;  // of its cost, where partitions are decimated side by side
};

struct Outcome {
  DecimateStop stop = DecimateStop::kTargetReached;
  double error2 = 0, attribute_error2 = 0;  // the largest of a removal, mean squares in local units
  std::size_t collapses = 0;
  CountByReason rejected;  // each time that one was
  CountByReason blocked;   // of what is left in the end, where no target was reached
  std::vector<Event> events;
  std::vector<DecimationChanges::Face> changed_faces;  // by removals, if events are kept

  /// What partitions have done meanwhile by collapses of edges.
  Outcome& operator+=(const Outcome& more) {
    error2 = std::max(error2, more.error2);
    attribute_error2 = std::max(attribute_error2, more.attribute_error2);
    collapses += more.collapses;
    rejected += more.rejected;
    events.insert(events.end(), more.events.begin(), more.events.end());
    return *this;
  }
};

struct DecimationState {
  CollapseMesh& mesh;
  const Limits& limits;
  std::size_t faces = 0, vertices = 0;  // that are left
  bool keep_events = false;
  Outcome outcome = {};
  AttributeQuadrics* attributes = nullptr;  // none
  Criteria* criteria = nullptr;             // none
  bool boundary_kept = false;
  double mean_weight = 0;  // of all vertices at first
  PartitionSizes sizes = {};
  Stop* stop = nullptr;                       // none
  double progress_from = 0, progress_to = 1;  // what these removals are of all that is to be done
  std::size_t first_faces = mesh.face_count(), first_vertices = mesh.apex();  // when they began
  std::size_t input_faces = mesh.face_count();

  [[nodiscard]] bool at_target() const { return faces <= limits.faces || vertices <= limits.vertices; }
  [[nodiscard]] bool at_what_was_asked() const {
    return faces <= limits.faces || vertices <= limits.vertices_asked;
  }
  /// Whether no more is to be removed.
  [[nodiscard]] bool reached() const { return at_target() || (stop != nullptr && stop->is_set()); }
  void ask() {
    if (stop != nullptr) stop->ask();
  }
};

/// What happens in one of several partitions of a surface, while threads work side by side.
class PartitionState {
 public:
  explicit PartitionState(const DecimationState& all)
      : limits_(all.limits),
        state{.mesh = all.mesh,
              .limits = limits_,
              .keep_events = all.keep_events,
              .boundary_kept = all.boundary_kept,
              .mean_weight = all.mean_weight,
              .stop = all.stop,
              .input_faces = all.input_faces} {
    limits_.faces = 1;  // a removal takes two
    limits_.vertices = 0;
  }
  PartitionState(const PartitionState&) = delete;
  PartitionState& operator=(const PartitionState&) = delete;

  /// It may take so many away.
  void start(std::size_t faces, std::size_t vertices) {
    state.faces = faces_ = faces;
    state.vertices = vertices_ = vertices;
  }
  /// When no partition is at work.
  void report_to(DecimationState& all) {
    all.faces -= faces_ - state.faces;
    all.vertices -= vertices_ - state.vertices;
    all.outcome += state.outcome;
    state.outcome = {};
  }

 private:
  Limits limits_;
  std::size_t faces_ = 0, vertices_ = 0;

 public:
  DecimationState state;
};

/// The i-th of some numbers below `all`, spread as evenly as multiples of the golden ratio are.
[[nodiscard]] inline std::size_t spread_evenly(std::uint32_t i, std::size_t all) {
  return static_cast<std::size_t>((std::uint64_t{i * 0x9e3779b1u} * all) >> 32);
}

/// As `decimate`; for tests, in partitions so small that any surface has several, and by another clock.
[[nodiscard]] Result<Decimated> decimate_in_partitions(
    const TriangleSurface& surface, const DecimateOptions& options,
    const PartitionSizes& sizes = {.partition_faces = 32, .range_faces = 512}, const Progress& progress = {},
    Stop::Now now = &Stop::Clock::now);

constexpr std::size_t kRemovalsBetweenReports = 8192;

}  // namespace vkmesh::detail
