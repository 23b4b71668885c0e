// The Vulkan device that tests run on, watched by the validation layer: a run in which the layer says
// anything fails.
#pragma once

#include <string>

#include <vkmesh/engine/context.h>

namespace vkmesh::test {

/// VKMESH_TEST_DEVICE, by default "llvmpipe".
std::string device_name();

/// Options that open the test device with validation and synchronization validation; where
/// VKMESH_GPU_ASSISTED is 1, with GPU-assisted validation as well. On llvmpipe tests tagged [draw] and
/// [long-loops] must then be left out (docs/design.md).
ContextOptions device_options();

/// One context for the whole run. Fails the test where there is no such device.
Context& test_context();

}  // namespace vkmesh::test
