// Whether options make sense.
#pragma once

#include <cstddef>

#include <vkmesh/base/result.h>
#include <vkmesh/decimation/decimate.h>

namespace vkmesh::detail {

/// For a mesh of so many vertices and corners. Errors: kUsage, naming the option; kUnsuitable for attributes
/// that are not finite.
[[nodiscard]] Result<void> check_options(const DecimateOptions& options, std::size_t vertices,
                                         std::size_t corners);

}  // namespace vkmesh::detail
