#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/engine/core/buffer.h>

#include "core/fake_loader.h"
#include "support/device.h"

namespace vkmesh::test {
namespace {

std::vector<std::byte> pattern(std::size_t bytes) {
  std::vector<std::byte> data(bytes);
  for (std::size_t i = 0; i < bytes; ++i) data[i] = static_cast<std::byte>((i * 7 + i / 256) & 0xff);
  return data;
}

int flushes = 0;
int invalidations = 0;

void VKAPI_PTR memory_that_is_not_coherent(VkPhysicalDevice device,
                                           VkPhysicalDeviceMemoryProperties* memory) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceMemoryProperties>("vkGetPhysicalDeviceMemoryProperties")(device,
                                                                                                   memory);
  for (std::uint32_t i = 0; i < memory->memoryTypeCount; ++i)
    memory->memoryTypes[i].propertyFlags &= ~static_cast<VkFlags>(VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
}

void VKAPI_PTR memory_of_one_mebibyte(VkPhysicalDevice device, VkPhysicalDeviceMemoryProperties* memory) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceMemoryProperties>("vkGetPhysicalDeviceMemoryProperties")(device,
                                                                                                   memory);
  for (std::uint32_t i = 0; i < memory->memoryHeapCount; ++i) memory->memoryHeaps[i].size = 1 << 20;
}

VkResult VKAPI_PTR count_flush(VkDevice device, std::uint32_t count, const VkMappedMemoryRange* ranges) {
  ++flushes;
  return FakeLoader::real<PFN_vkFlushMappedMemoryRanges>("vkFlushMappedMemoryRanges")(device, count, ranges);
}

VkResult VKAPI_PTR count_invalidation(VkDevice device, std::uint32_t count,
                                      const VkMappedMemoryRange* ranges) {
  ++invalidations;
  return FakeLoader::real<PFN_vkInvalidateMappedMemoryRanges>("vkInvalidateMappedMemoryRanges")(device, count,
                                                                                                ranges);
}

VkResult VKAPI_PTR map_fails(VkDevice, VkDeviceMemory, VkDeviceSize, VkDeviceSize, VkMemoryMapFlags, void**) {
  return VK_ERROR_MEMORY_MAP_FAILED;
}

void require_round_trip(Context& context, std::size_t bytes) {
  INFO(bytes << " bytes");
  const std::vector<std::byte> data = pattern(bytes);
  auto buffer = Buffer::create(context, bytes);
  REQUIRE(buffer);
  CHECK(buffer->size() == bytes);
  REQUIRE(buffer->upload(data));
  std::vector<std::byte> back(bytes);
  REQUIRE(buffer->download(back));
  CHECK(back == data);
  // A part in the middle, on no boundary of anything.
  if (bytes < 40) return;
  const std::vector<std::byte> part(bytes / 2 - 3, std::byte{0xee});
  REQUIRE(buffer->upload(part, 7));
  std::vector<std::byte> expected = data;
  std::copy(part.begin(), part.end(), expected.begin() + 7);
  REQUIRE(buffer->download(back));
  CHECK(back == expected);
  std::vector<std::byte> tail(13);
  REQUIRE(buffer->download(tail, bytes - 13));
  CHECK(tail == std::vector<std::byte>(expected.end() - 13, expected.end()));
}

}  // namespace

TEST_CASE("data goes to a buffer and back, directly and in rounds of staging") {
  for (const std::size_t bytes : {0u, 1u, 3u, 1000u, 1001u, 10007u})
    require_round_trip(test_context(), bytes);

  ContextOptions options = device_options();
  options.force_staging = true;
  options.staging_bytes = 1000;
  const auto staged = Context::create(options);
  REQUIRE(staged);
  auto buffer = Buffer::create(**staged, 100);
  REQUIRE(buffer);
  CHECK(buffer->mapped().empty());
  for (const std::size_t bytes : {0u, 1u, 3u, 999u, 1000u, 1001u, 10007u})
    require_round_trip(**staged, bytes);
}

TEST_CASE("memory that is not coherent is flushed and invalidated") {
  FakeLoader loader;
  loader.replace("vkGetPhysicalDeviceMemoryProperties", memory_that_is_not_coherent);
  loader.replace("vkFlushMappedMemoryRanges", count_flush);
  loader.replace("vkInvalidateMappedMemoryRanges", count_invalidation);
  for (const bool staging : {false, true}) {
    ContextOptions options = loader.options();
    options.force_staging = staging;
    const auto context = Context::create(options);
    REQUIRE(context);
    flushes = invalidations = 0;
    auto buffer = Buffer::create(**context, 64);
    REQUIRE(buffer);
    REQUIRE(buffer->upload(pattern(64)));
    CHECK(flushes == 1);
    CHECK(invalidations == 0);
    std::vector<std::byte> back(64);
    REQUIRE(buffer->download(back));
    CHECK(invalidations == 1);
    CHECK(back == pattern(64));
  }
}

TEST_CASE("ranges outside a buffer are refused") {
  auto buffer = Buffer::create(test_context(), 16);
  REQUIRE(buffer);
  std::vector<std::byte> data(16);
  for (const auto& result :
       {buffer->upload(data, 1), buffer->upload(data, 17), buffer->upload(data, ~std::uint64_t{0}),
        buffer->download(data, 1), buffer->download(data, ~std::uint64_t{0} - 7)}) {
    REQUIRE(!result);
    CHECK(result.error().code == ErrorCode::kUsage);
  }
}

TEST_CASE("a context counts the memory of its buffers") {
  Context& context = test_context();
  const std::uint64_t before = context.allocated_bytes();
  {
    auto a = Buffer::create(context, 100000);
    REQUIRE(a);
    const std::uint64_t one = context.allocated_bytes();
    CHECK(one >= before + 100000);
    Buffer moved = *std::move(a);
    CHECK(context.allocated_bytes() == one);
    CHECK(moved.address() != 0);
    CHECK(moved.address() % 16 == 0);
    auto b = Buffer::create(context, 50000);
    REQUIRE(b);
    moved = *std::move(b);
    CHECK(moved.size() == 50000);
    CHECK(context.allocated_bytes() < one);
    CHECK(context.allocated_bytes() >= before + 50000);
  }
  CHECK(context.allocated_bytes() == before);
}

TEST_CASE("more memory than there is, is an error that leaves the rest as it was") {
  Context& context = test_context();
  const std::uint64_t before = context.allocated_bytes();
  for (const std::uint64_t bytes : {context.info().memory + 1, std::uint64_t{1} << 60, ~std::uint64_t{0}}) {
    const auto buffer = Buffer::create(context, bytes, BufferMemory::kDevice, "giant");
    REQUIRE(!buffer);
    CHECK(buffer.error().code == ErrorCode::kOutOfMemory);
    CHECK_THAT(buffer.error().message, Catch::Contains("'giant' needs " + std::to_string(bytes) + " bytes"));
  }
  CHECK(context.allocated_bytes() == before);
}

TEST_CASE("buffers together get no more memory than the device has") {
  FakeLoader loader;
  loader.replace("vkGetPhysicalDeviceMemoryProperties", memory_of_one_mebibyte);
  const auto context = Context::create(loader.options());
  REQUIRE(context);
  {
    const auto first = Buffer::create(**context, 700000);
    REQUIRE(first);
    const auto second = Buffer::create(**context, 700000, BufferMemory::kDevice, "second");
    REQUIRE(!second);
    CHECK(second.error().code == ErrorCode::kOutOfMemory);
    CHECK_THAT(second.error().message, Catch::Contains("'second' needs 700000 bytes"));
  }
  CHECK(Buffer::create(**context, 700000));
}

TEST_CASE("a buffer that cannot be mapped leaves nothing behind") {
  FakeLoader loader;
  ContextOptions options = loader.options();
  options.skip_exactness_check = true;
  loader.replace("vkMapMemory", map_fails);
  const auto context = Context::create(options);
  REQUIRE(context);
  const auto buffer = Buffer::create(**context, 64, BufferMemory::kStaging, "staging");
  REQUIRE(!buffer);
  CHECK_THAT(buffer.error().message, Catch::Contains("VK_ERROR_MEMORY_MAP_FAILED"));
  CHECK((*context)->allocated_bytes() == 0);
}

}  // namespace vkmesh::test
