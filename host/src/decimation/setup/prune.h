// Small components taken away before decimation.
#pragma once

#include <cstddef>

#include <vkmesh/base/result.h>

#include "base/stop.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

struct Pruned {
  std::size_t components = 0, faces = 0, vertices = 0;
};

/// Takes away each component whose bounding box has a diagonal of at most `size`, the one of most faces
/// excepted. O(faces), 8 bytes a face for the time. Errors: kInterrupted where `stop` is set before any has
/// gone.
[[nodiscard]] Result<Pruned> prune_components(CollapseMesh& mesh, float size, Stop& stop);

}  // namespace vkmesh::detail
