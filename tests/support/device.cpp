#define CATCH_CONFIG_EXTERNAL_INTERFACES
#include "support/device.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <dlfcn.h>

#if defined(VKMESH_ADDRESS_SANITIZER)
// The layer (1.3.239) keeps some of what it notes of each instance and shader. Objects that the engine
// forgets to destroy are not hidden by this: the layer names them.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libVkLayer_khronos_validation\n";
}
#endif

namespace vkmesh::test {
namespace {

/// What the layer said, and whether the test that runs now touched a device. Contexts report from any thread.
struct Watch {
  std::mutex mutex;
  std::vector<std::string> messages;
  std::atomic<bool> device_used{false};
};

Watch& watch() {
  static Watch instance;
  return instance;
}

std::unique_ptr<Context>& shared_context() {
  static std::unique_ptr<Context> context;
  return context;
}

Result<void> open_shared_context() {
  if (shared_context()) return {};
  VKMESH_TRY(shared_context(), Context::create(device_options()));
  return {};
}

/// Names the device at the start of a run, counts the tests that used one, and judges the run by what the
/// layer said.
class DeviceListener : public Catch::TestEventListenerBase {
 public:
  using Catch::TestEventListenerBase::TestEventListenerBase;

  void testRunStarting(const Catch::TestRunInfo& info) override {
    Catch::TestEventListenerBase::testRunStarting(info);
    // They stay loaded, so that the leak checker knows at the end whose memory it finds.
    for (const char* library : {"libVkLayer_khronos_validation.so", "libvulkan_lvp.so"})
      (void)dlopen(library, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    const auto opened = open_shared_context();
    if (!opened) {
      std::cerr << "device: none: " << opened.error().describe() << std::endl;
      return;
    }
    const DeviceInfo& device = shared_context()->info();
    std::cerr << "device: " << device.name << ", " << device.driver << ", Vulkan " << device.api_version
              << ", " << name_of(device.type) << std::endl;
    report("the start");
  }

  void testCaseStarting(const Catch::TestCaseInfo& info) override {
    Catch::TestEventListenerBase::testCaseStarting(info);
    watch().device_used = false;
  }

  void testCaseEnded(const Catch::TestCaseStats& stats) override {
    Catch::TestEventListenerBase::testCaseEnded(stats);
    const auto& tags = stats.testInfo.tags;
    if (watch().device_used) {
      ++device_tests_;
    } else if (std::find(tags.begin(), tags.end(), "no-device") == tags.end()) {
      std::cerr << "the test '" << stats.testInfo.name << "' touched no device, and is not tagged [no-device]"
                << std::endl;
      skipped_ = true;
    }
    report("the test '" + stats.testInfo.name + "'");
  }

  void testRunEnded(const Catch::TestRunStats& stats) override {
    Catch::TestEventListenerBase::testRunEnded(stats);
    // Closed before the verdict: the layer then names the objects that were left behind.
    shared_context().reset();
    report("the end");
    std::cerr << "device tests: " << device_tests_ << " run" << std::endl;
    if (said_something_) std::cerr << "the run fails: the validation layer was not silent" << std::endl;
    if (skipped_) std::cerr << "the run fails: a device test ran without the device" << std::endl;
    if (!said_something_ && !skipped_) return;
    // The framework lets no listener fail a run.
    std::_Exit(1);
  }

 private:
  void report(const std::string& when) {
    const std::lock_guard lock(watch().mutex);
    for (const std::string& message : std::exchange(watch().messages, {})) {
      std::cerr << "validation, in " << when << ": " << message << std::endl;
      said_something_ = true;
    }
  }

  int device_tests_ = 0;
  bool said_something_ = false;
  bool skipped_ = false;
};

CATCH_REGISTER_LISTENER(DeviceListener)

}  // namespace

std::string device_name() {
  const char* name = std::getenv("VKMESH_TEST_DEVICE");
  return name != nullptr && *name != '\0' ? name : "llvmpipe";
}

bool is_swiftshader(const Context& context) {
  return context.info().driver.starts_with("SwiftShader");
}

bool gpu_assisted() {
  const char* asked = std::getenv("VKMESH_GPU_ASSISTED");
  return asked != nullptr && std::string(asked) == "1";
}

ContextOptions device_options() {
  watch().device_used = true;
  ContextOptions options;
  options.device = device_name();
  options.validation = true;
  options.gpu_assisted_validation = gpu_assisted();
  options.on_validation_message = [](const std::string& message) {
    const std::lock_guard lock(watch().mutex);
    watch().messages.push_back(message);
  };
  return options;
}

Context& test_context() {
  const auto opened = open_shared_context();
  if (!opened) FAIL(opened.error().describe());
  watch().device_used = true;
  return *shared_context();
}

}  // namespace vkmesh::test
