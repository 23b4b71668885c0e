// The Vulkan device that tests run on, watched by the validation layer.
#pragma once

#include <string>
#include <vector>

#include <vkmesh/engine/context.h>

namespace vkmesh::test {

/// VKMESH_TEST_DEVICE, by default "llvmpipe".
std::string device_name();

/// Options that open the test device with validation and synchronization validation; what the layer says goes into
/// the log that DeviceTest looks at, whichever context it came from.
ContextOptions device_options();

/// One context for the whole run. Fails the test where there is no such device.
Context& test_context();

/// Takes what the validation layer has said since the last call.
std::vector<std::string> take_validation_log();

/// The fixture of every test that needs a device, which also bears the tag [device]: the test fails when a validation
/// message arrives while it runs.
class DeviceTest {
 public:
  DeviceTest() = default;
  ~DeviceTest();
  DeviceTest(const DeviceTest&) = delete;
  DeviceTest& operator=(const DeviceTest&) = delete;
};

}  // namespace vkmesh::test
