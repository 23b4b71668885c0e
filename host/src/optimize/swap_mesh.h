// The mesh that edges are swapped in.
#pragma once

#include <array>
#include <cstdint>

#include <vkmesh/mesh/handles.h>
#include <vkmesh/optimize/swap_edges.h>

#include "mesh/edit/edit_mesh.h"

namespace vkmesh::detail {

struct SwapVertex {
  std::uint32_t leading = kInvalid;
};

/// Tag k of a half-edge: the reason that keeps its edge is SwapReason k + 1.
using SwapMesh = EditMesh<SwapVertex>;

/// The edge p → q of a half-edge h, and the vertices across from it in the faces (p, q, a) and (q, p, b).
struct SwapQuad {
  std::uint32_t h, t, p, q, a, b;

  SwapQuad(const SwapMesh& mesh, std::uint32_t of)
      : h(of),
        t(mesh.twin(of)),
        p(mesh.origin(h)),
        q(mesh.origin(t)),
        a(mesh.origin(SwapMesh::previous(h))),
        b(mesh.origin(SwapMesh::previous(t))) {}

  /// The half-edges q → a, a → p, p → b and b → q of its faces.
  [[nodiscard]] std::array<std::uint32_t, 4> sides() const {
    return {SwapMesh::next(h), SwapMesh::previous(h), SwapMesh::next(t), SwapMesh::previous(t)};
  }
};

}  // namespace vkmesh::detail
