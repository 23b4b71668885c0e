#include "support/device.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <mutex>
#include <utility>

namespace vkmesh::test {
namespace {

struct ValidationLog {
  std::mutex mutex;
  std::vector<std::string> messages;
};

ValidationLog& validation_log() {
  static ValidationLog log;
  return log;
}

std::unique_ptr<Context>& shared_context() {
  static std::unique_ptr<Context> context;
  return context;
}

/// Names the device at the start of a run, and at its end says how many device tests ran on it. The context is closed
/// before the verdict, so that what the layer says of objects left behind counts too.
class DeviceListener : public Catch::TestEventListenerBase {
 public:
  using TestEventListenerBase::TestEventListenerBase;

  void testCaseStarting(const Catch::TestCaseInfo& info) override {
    TestEventListenerBase::testCaseStarting(info);
    for (const std::string& tag : info.lcaseTags) {
      if (tag != "device") continue;
      if (device_tests_++ == 0) announce();
    }
  }

  void testRunEnded(const Catch::TestRunStats& stats) override {
    TestEventListenerBase::testRunEnded(stats);
    std::cerr << "device tests: " << device_tests_ << " run" << std::endl;
    shared_context().reset();
    const std::vector<std::string> left = take_validation_log();
    for (const std::string& message : left) std::cerr << "validation, outside of any test: " << message << '\n';
    std::cerr.flush();
    // The framework has no way to fail a run from here.
    if (!left.empty()) std::_Exit(1);
  }

 private:
  static void announce() {
    auto context = Context::create(device_options());
    if (!context) {
      std::cerr << "device: none: " << context.error().describe() << std::endl;
      return;
    }
    shared_context() = *std::move(context);
    const DeviceInfo& info = shared_context()->info();
    std::cerr << "device: " << info.name << ", " << info.driver << ", Vulkan " << info.api_version << ", "
              << name_of(info.type) << std::endl;
  }

  int device_tests_ = 0;
};

CATCH_REGISTER_LISTENER(DeviceListener)

}  // namespace

std::string device_name() {
  const char* name = std::getenv("VKMESH_TEST_DEVICE");
  return name != nullptr && *name != '\0' ? name : "llvmpipe";
}

ContextOptions device_options() {
  ContextOptions options;
  options.device = device_name();
  options.validation = true;
  options.on_validation_message = [](const std::string& message) {
    const std::lock_guard lock(validation_log().mutex);
    validation_log().messages.push_back(message);
  };
  return options;
}

Context& test_context() {
  if (!shared_context()) {
    auto context = Context::create(device_options());
    if (!context) FAIL(context.error().describe());
    shared_context() = *std::move(context);
  }
  return *shared_context();
}

std::vector<std::string> take_validation_log() {
  const std::lock_guard lock(validation_log().mutex);
  return std::exchange(validation_log().messages, {});
}

DeviceTest::~DeviceTest() {
  for (const std::string& message : take_validation_log()) FAIL_CHECK("validation: " << message);
}

}  // namespace vkmesh::test
