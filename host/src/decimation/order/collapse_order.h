// Which edge goes next.
#pragma once

#include <vkmesh/decimation/decimate.h>

namespace vkmesh::detail {

enum class CollapseOrder {
  kFast,        ///< What `decimate` does.
  kExact,       ///< The cheapest edge at any time, from a heap: many times slower, to compare with.
  kPartitioned  ///< As kFast does with large surfaces, in partitions so small that any surface has several.
};

[[nodiscard]] Result<Decimated> decimate(const TriangleSurface& surface, const DecimateOptions& options,
                                         CollapseOrder order, const Progress& progress = {});

}  // namespace vkmesh::detail
