// What smoothing asks of its options, on the host and on a device.
#pragma once

#include <string>

#include <vkmesh/base/result.h>
#include <vkmesh/passes/laplacian_smoothing.h>

namespace vkmesh::detail {

inline Result<void> require_smoothing_options(const LaplacianSmoothingOptions& options) {
  if (!(options.lambda >= 0.0f && options.lambda <= 1.0f))
    return fail(ErrorCode::kUsage, "lambda must lie in [0, 1], not " + std::to_string(options.lambda));
  if (!(options.mu >= -1.0f && options.mu <= 0.0f))
    return fail(ErrorCode::kUsage, "mu must lie in [-1, 0], not " + std::to_string(options.mu));
  return {};
}

/// Calls step(factor) for each step in order; stops at the first that fails.
template <class Step>
Result<void> for_each_smoothing_step(const LaplacianSmoothingOptions& options, Step&& step) {
  for (std::uint32_t i = 0; i < options.iterations; ++i) {
    VKMESH_CHECK(step(i, options.lambda));
    if (options.mu != 0.0f) VKMESH_CHECK(step(i, options.mu));
  }
  return {};
}

}  // namespace vkmesh::detail
