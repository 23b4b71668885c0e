// The faces that a removal changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <vkmesh/math/vec.h>

#include "decimation/vertex_record.h"
#include "math/triangle_distance.h"

namespace vkmesh::detail {

/// Those that go or move, and those that cover their place afterwards; the same closed curve bounds both,
/// unless it runs along the boundary of the mesh.
struct LocalChange {
  struct Face {
    Triangle corner;       // local units
    std::uint32_t record;  // half-edges 4 record + i
  };
  std::vector<Face> before, after;
  /// The vertices that go or move, and where they are afterwards.
  std::vector<DVec3> inner_before, inner_after;
  /// Squared length of the edge that goes; of a vertex that goes, the mean over its edges.
  double length2 = 0;
  /// The most edges at one of the vertices that gain some, before and after.
  std::size_t edges_before = 0, edges_after = 0;

  void clear() {
    before.clear();
    after.clear();
    inner_before.clear();
    inner_after.clear();
  }
};

inline DVec3 point_of(const std::array<float, 3>& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

inline LocalChange::Face face_of(const CollapseMesh& mesh, std::uint32_t record) {
  const CollapseMesh::Face& face = mesh.face(4 * record);
  LocalChange::Face result{{}, record};
  for (std::size_t i = 0; i < 3; ++i) result.corner[i] = point_of(mesh.vertices[face.origin[i]].position);
  return result;
}

/// Records the collapse of the edge of h, whose ends move to this place; of each end the first `most` faces
/// from the edge on.
void record_collapse(LocalChange& change, const CollapseMesh& mesh, std::uint32_t h,
                     const std::array<float, 3>& place,
                     std::size_t most = std::numeric_limits<std::size_t>::max());

/// Records nothing of it but the length of the edge. O(1).
void record_length(LocalChange& change, const CollapseMesh& mesh, std::uint32_t h);

}  // namespace vkmesh::detail
