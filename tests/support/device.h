// The Vulkan device that tests run on, watched by the validation layer: a run in which the layer says
// anything fails.
#pragma once

#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/context.h>

namespace vkmesh::test {

/// VKMESH_TEST_DEVICE, by default "llvmpipe".
std::string device_name();

/// Whether SwiftShader is the context's driver.
bool is_swiftshader(const Context& context);

/// Whether VKMESH_GPU_ASSISTED is 1. Some tests then take smaller shapes: docs/testing.md says why.
bool gpu_assisted();

/// Options that open the test device with validation and synchronization validation, and GPU-assisted
/// validation where gpu_assisted() says so.
ContextOptions device_options();

/// One context for the whole run. Fails the test where there is no such device.
Context& test_context();

/// The value of a result; an error fails the test.
template <class T>
T require(Result<T> result) {
  if (!result) FAIL(result.error().describe());
  return *std::move(result);
}
inline void require_done(const Result<void>& result) {
  if (!result) FAIL(result.error().describe());
}

}  // namespace vkmesh::test
