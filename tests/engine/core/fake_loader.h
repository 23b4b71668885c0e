// A Vulkan loader that behaves like the real one but for the functions that a test replaces.
#pragma once

#include <map>
#include <string>

#include <vulkan/vulkan_core.h>

#include <vkmesh/engine/core/context.h>

namespace vkmesh::test {

/// One at a time, and one context of it at a time; while it lives, entry() hands out its replacements, to
/// contexts made after them.
class FakeLoader {
 public:
  FakeLoader();
  ~FakeLoader();
  FakeLoader(const FakeLoader&) = delete;
  FakeLoader& operator=(const FakeLoader&) = delete;

  /// Null makes the function absent.
  template <class Function>
  void replace(const char* name, Function function) {
    replaced_[name] = reinterpret_cast<PFN_vkVoidFunction>(function);
  }

  /// device_options() with this loader.
  [[nodiscard]] ContextOptions options() const;
  /// The function as the system's loader has it, for the instance made last and its devices.
  template <class Function>
  [[nodiscard]] static Function real(const char* name) {
    return reinterpret_cast<Function>(find_real(name));
  }

  [[nodiscard]] static PFN_vkVoidFunction VKAPI_PTR entry(VkInstance instance, const char* name);

 private:
  [[nodiscard]] static PFN_vkVoidFunction VKAPI_PTR device_entry(VkDevice device, const char* name);
  [[nodiscard]] static PFN_vkVoidFunction find_real(const char* name);

  std::map<std::string, PFN_vkVoidFunction> replaced_;
};

/// vkGetInstanceProcAddr of the system's loader.
[[nodiscard]] PFN_vkGetInstanceProcAddr system_loader();

}  // namespace vkmesh::test
