// What decimation keeps of each vertex, and the mesh of such vertices.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "math/quadric.h"
#include "mesh/edit/edit_mesh.h"

namespace vkmesh::detail {

/// What decimation knows of a vertex, in one cache line: its place, the sum of the weighted planes that
/// it stands for as a quadric, the sum of their weights, and where its fan begins.
struct alignas(64) VertexRecord {
  std::array<float, 3> position;
  std::uint32_t source;  // its number in the input, and flags
  float weight;
  Quadric quadric;  // about its place
  /// A half-edge that leaves it; kGone | the vertex that absorbed it; kInvalid when it is isolated.
  std::uint32_t leading;

  static constexpr std::uint32_t kGone = kVertexGone;
  static constexpr std::uint32_t kLocked = 1u << 28;
  static constexpr std::uint32_t kMoved = 1u << 29;
  static constexpr std::uint32_t kTouched = 1u << 30;    // a collapse of this batch has changed it
  static constexpr std::uint32_t kHasParked = 1u << 31;  // some edge at it is parked
  /// Coarsening, which parks nothing, tags what it has removed.
  static constexpr std::uint32_t kAbsorbed = kHasParked;
  static constexpr std::uint32_t kSourceMask = kLocked - 1;

  /// Where in the record's sixteen words each member begins, for loops that take records apart into lanes.
  enum Word : std::size_t { kX, kY, kZ, kSource, kWeight, kA, kC = kA + 6, kB, kLeading = kB + 3 };

  [[nodiscard]] bool has(std::uint32_t flag) const { return (source & flag) != 0; }
  [[nodiscard]] bool alive() const { return (leading & kGone) == 0; }
};
static_assert(sizeof(VertexRecord) == 64);
static_assert(offsetof(VertexRecord, source) == 4 * VertexRecord::kSource &&
              offsetof(VertexRecord, quadric.a) == 4 * VertexRecord::kA &&
              offsetof(VertexRecord, quadric.c) == 4 * VertexRecord::kC &&
              offsetof(VertexRecord, quadric.b) == 4 * VertexRecord::kB &&
              offsetof(VertexRecord, leading) == 4 * VertexRecord::kLeading);

/// The mesh that is decimated. The source of a face is its number in the input.
using CollapseMesh = EditMesh<VertexRecord>;

}  // namespace vkmesh::detail
