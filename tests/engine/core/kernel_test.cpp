#include <array>
#include <set>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/engine/core/kernel.h>

#include "core/fake_loader.h"
#include "core/spirv.h"
#include "shaders.h"
#include "support/device.h"
#include "support/pointer_bitcast.h"

namespace vkmesh::test {
namespace {

Error error_of(const KernelSource& source) {
  const auto kernel = Kernel::get(test_context(), source);
  if (kernel) FAIL("kernel '" << source.name << "' was made");
  return kernel.error();
}

void VKAPI_PTR properties_of_swiftshader(VkPhysicalDevice device, VkPhysicalDeviceProperties2* properties) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceProperties2>("vkGetPhysicalDeviceProperties2")(device, properties);
  auto* next = static_cast<VkBaseOutStructure*>(properties->pNext);
  if (next != nullptr && next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES)
    reinterpret_cast<VkPhysicalDeviceDriverProperties*>(next)->driverID = VK_DRIVER_ID_GOOGLE_SWIFTSHADER;
}

}  // namespace

TEST_CASE("every embedded kernel is made, once for a context") {
  for (const KernelSource& source : shaders::kernels()) {
    INFO(source.name);
    const auto first = Kernel::get(test_context(), source);
    REQUIRE(first);
    CHECK((*first)->name() == source.name);
    CHECK((*first)->workgroup_size() == 128);
    CHECK((*first)->push_constant_bytes() % 8 == 0);
    const auto second = Kernel::get(test_context(), source);
    REQUIRE(second);
    CHECK(*first == *second);
  }
}

TEST_CASE("threads that ask for the same kernel get the same one") {
  const auto context = Context::create(device_options());
  REQUIRE(context);
  std::array<const Kernel*, 4> kernels{};
  std::vector<std::thread> threads;
  for (const Kernel*& kernel : kernels)
    threads.emplace_back([&] {
      const auto made = Kernel::get(**context, shaders::vertex_normals);
      if (made) kernel = *made;
    });
  for (std::thread& thread : threads) thread.join();
  REQUIRE(kernels[0] != nullptr);
  for (const Kernel* kernel : kernels) CHECK(kernel == kernels[0]);
}

TEST_CASE("what is no kernel is refused") {
  KernelSource source = shaders::vertex_normals;
  REQUIRE(Kernel::get(test_context(), source));
  source.spirv = shaders::vertex_maxima.spirv;
  CHECK_THAT(error_of(source).message, Catch::Contains("two different kernels are named 'vertex_normals'"));

  source.name = "empty";
  source.spirv = {};
  CHECK(error_of(source).code == ErrorCode::kUsage);
  const std::vector<std::uint32_t> noise(100, 0x12345678u);
  source.name = "noise";
  source.spirv = noise;
  CHECK(error_of(source).code == ErrorCode::kUsage);
}

TEST_CASE("a kernel that the driver is known to crash on is refused there, and made elsewhere") {
  KernelSource source = shaders::vertex_normals;
  static const std::vector<std::uint32_t> spirv =
      with_pointer_bitcast(source.spirv);  // The context keeps its place.
  source.name = "bitcasts a pointer";
  source.spirv = spirv;
  const auto require_refused = [&](Context& context) {
    const auto refused = Kernel::get(context, source);
    REQUIRE(!refused);
    CHECK(refused.error().code == ErrorCode::kNoDevice);
    CHECK_THAT(refused.error().message,
               Catch::Contains("'bitcasts a pointer'") && Catch::Contains(context.info().name + " crashes"));
  };
  if (is_swiftshader(test_context())) {
    require_refused(test_context());
    return;
  }
  REQUIRE(Kernel::get(test_context(), source));
  FakeLoader loader;
  loader.replace("vkGetPhysicalDeviceProperties2", properties_of_swiftshader);
  const auto context = Context::create(loader.options());
  REQUIRE(context);
  require_refused(**context);
}

TEST_CASE("SPIR-V that is cut off or changed anywhere is inspected without harm", "[no-device]") {
  const auto spirv = shaders::vertex_normals.spirv;
  REQUIRE(detail::inspect_spirv(spirv));
  // Where a module may end: after its header, and after each instruction.
  std::set<std::size_t> ends = {5};
  const auto instructions = detail::spirv_instructions(spirv);
  REQUIRE(instructions);
  for (const auto& i : *instructions) ends.insert(i.offset + i.words.size());
  for (std::size_t words = 0; words < spirv.size(); ++words) {
    // Memory of its own, so that a read past the end is seen.
    const std::vector<std::uint32_t> part(spirv.begin(), spirv.begin() + static_cast<std::ptrdiff_t>(words));
    CHECK(detail::spirv_instructions(part).has_value() == ends.contains(words));
    (void)detail::inspect_spirv(part);
  }
  for (std::size_t i = 0; i < spirv.size(); ++i)
    for (const std::uint32_t value : {0u, 0xffffffffu, spirv[i] ^ 1u, spirv[i] + 0x10000u}) {
      std::vector<std::uint32_t> changed(spirv.begin(), spirv.end());
      changed[i] = value;
      if (detail::inspect_spirv(changed))
        (void)detail::with_float_controls(changed,
                                          {.round_to_nearest_even = true, .keep_signed_zeros = true});
    }
}

}  // namespace vkmesh::test
