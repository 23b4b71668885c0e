// How many vertices stay whatever a decimation takes away.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/decimation/decimate.h>

#include "base/stop.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// A component by vertices of its own.
struct Part {
  std::vector<std::uint32_t> vertices;  ///< In the mesh, ascending.
  std::vector<std::uint32_t> corners;   ///< Three a face, by their places in `vertices`.
};

/// What is left of a part, in vertices, when all has gone that may.
using LeftAlone = std::function<Result<std::size_t>(const Part&)>;

/// The locked vertices of a mesh of so many faces and vertices, or what its components hold, if that is more:
/// four for each that is closed like a sphere, or, where there are so many of these that it may matter to a
/// target of `target` vertices, what `left_alone` leaves of each of up to kMostVertices vertices; it is tried
/// on some of them, spread evenly, for all. Takes a few per cent of the time of a decimation, and O(1) where
/// components are few and nothing can be locked. Errors: those of `left_alone`; kInterrupted where `stop` is
/// set.
[[nodiscard]] Result<std::size_t> held_vertices(const CollapseMesh& mesh, const DecimateOptions& options,
                                                std::size_t faces, std::size_t vertices, double target,
                                                const LeftAlone& left_alone, Stop& stop);

constexpr std::size_t kMostVertices = 1000;

}  // namespace vkmesh::detail
