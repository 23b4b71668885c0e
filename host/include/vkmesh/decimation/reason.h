// Why decimation does not remove an edge or vertex.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace vkmesh {

/// The first condition that a removal fails, in the order in which they are judged.
enum class Reason : std::uint8_t {
  kNone,        ///< Nothing forbids it.
  kLocked,      ///< Both ends of the edge, or the vertex, are locked.
  kBoundary,    ///< They are locked because the boundary is kept; among removals tried it counts as kLocked.
  kSeam,        ///< It would close, part or join seams.
  kErrorBound,  ///< Its error is larger than the bound.
  kLinkCondition,  ///< The surface would not stay a manifold of the same topology.
  kFoldOver,       ///< A face would fold over, or turn by more than DecimateBounds::normal_deviation.
  kCriterion       ///< One of DecimateBounds forbids it.
};

/// All reasons but kNone.
inline constexpr std::array kReasons = {Reason::kLocked,     Reason::kBoundary,      Reason::kSeam,
                                        Reason::kErrorBound, Reason::kLinkCondition, Reason::kFoldOver,
                                        Reason::kCriterion};

/// A number for each reason.
struct CountByReason {
  std::array<std::size_t, kReasons.size() + 1> counts{};

  [[nodiscard]] std::size_t& operator[](Reason reason) { return counts[static_cast<std::size_t>(reason)]; }
  [[nodiscard]] std::size_t operator[](Reason reason) const {
    return counts[static_cast<std::size_t>(reason)];
  }
  CountByReason& operator+=(const CountByReason& more) {
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += more.counts[i];
    return *this;
  }
  bool operator==(const CountByReason&) const = default;
};

}  // namespace vkmesh
