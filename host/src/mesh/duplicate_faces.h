// Faces with the same points.
#pragma once

#include <cstdint>
#include <vector>

#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh::detail {

struct DuplicateFace {
  std::uint32_t face;
  std::uint32_t first;  ///< The first face with the same points in the same cyclic order, or its reverse.
  bool reversed;        ///< It runs the other way round than `first`.
};

/// Every face that has a duplicate, `first` ones included, those of one `first` side by side in ascending
/// order. Degenerate faces take no part. O(n log n) for n corners.
[[nodiscard]] std::vector<DuplicateFace> duplicate_faces(const IndexedFaceSet& mesh);

}  // namespace vkmesh::detail
