#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#if defined(VKMESH_ADDRESS_SANITIZER)
#include <sanitizer/lsan_interface.h>
#endif

#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/draw/draw.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/engine/passes/surface_measures.h>
#include <vkmesh/engine/passes/vertex_normals.h>
#include <vkmesh/passes/vertex_normals.h>
#include <vkmesh/repair/consolidate.h>

#include "core/device.h"
#include "core/fake_loader.h"
#include "passes/dihedral_angles_params.h"
#include "passes/triangle_normals_params.h"
#include "shaders.h"
#include "support/device.h"
#include "support/shapes.h"

namespace vkmesh::test {
namespace {

template <class T>
Buffer buffer_of(Context& context, const std::vector<T>& values) {
  Buffer buffer = require(Buffer::create(context, values.size() * sizeof(T)));
  require_done(buffer.upload(std::as_bytes(std::span(values))));
  return buffer;
}

template <class T>
std::vector<T> values_of(const Buffer& buffer) {
  std::vector<T> values(buffer.size() / sizeof(T));
  require_done(buffer.download(std::as_writable_bytes(std::span(values))));
  return values;
}

/// The maximum kernel on a mesh of one vertex fan for each vertex: maxima[v] is the largest of the angles of
/// triangle v.
struct MaximaWork {
  std::uint32_t count = 0;
  std::vector<float> expected;
  Buffer angles, offsets, half_edges, maxima;

  MaximaWork(Context& context, std::uint32_t n) : count(n) {
    std::vector<float> a(3 * std::size_t{n});
    std::vector<std::uint32_t> o(std::size_t{n} + 1), h(n);
    for (std::size_t i = 0; i < a.size(); ++i) a[i] = static_cast<float>((i * 7919) % 1009) / 64.0f;
    std::iota(o.begin(), o.end(), 0u);
    for (std::uint32_t v = 0; v < n; ++v) {
      h[v] = 3 * v + 1;
      // Half-edge 3v + 1 and the one before it.
      expected.push_back(std::max(a[3 * v + 1], a[3 * v]));
    }
    angles = buffer_of(context, a);
    offsets = buffer_of(context, o);
    half_edges = buffer_of(context, h);
    maxima = buffer_of(context, std::vector<float>(n, -1.0f));
  }

  void record(Recorder& recorder) const {
    using P = kernels::VertexMaximaParams;
    require_done(Dispatch<P>(recorder, shaders::vertex_maxima, count)
                     .read(&P::angles, angles)
                     .read(&P::corner_offsets, offsets)
                     .read(&P::corner_half_edges, half_edges)
                     .write(&P::maxima, maxima)
                     .record());
  }
};

int timeouts_left = 0;

/// Waits truly, and then says that the time is up.
VkResult VKAPI_PTR wait_times_out(VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all,
                                  std::uint64_t timeout) {
  const VkResult result =
      FakeLoader::real<PFN_vkWaitForFences>("vkWaitForFences")(device, count, fences, all, timeout);
  return timeouts_left-- > 0 ? VK_TIMEOUT : result;
}

int failures_left = 0;
VkResult failure = VK_ERROR_OUT_OF_HOST_MEMORY;

/// Waits until the work is done, so that nothing runs when the test ends, and then fails all the same.
VkResult VKAPI_PTR wait_fails(VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all,
                              std::uint64_t) {
  constexpr std::uint64_t kMinute = 60'000'000'000;
  const VkResult result =
      FakeLoader::real<PFN_vkWaitForFences>("vkWaitForFences")(device, count, fences, all, kMinute);
  return failures_left-- > 0 ? failure : result;
}

/// Names of what was destroyed since it was last emptied.
std::vector<std::string> destroyed;

void VKAPI_PTR note_fence(VkDevice, VkFence, const VkAllocationCallbacks*) {
  destroyed.emplace_back("fence");
}
void VKAPI_PTR note_pool(VkDevice, VkCommandPool, const VkAllocationCallbacks*) {
  destroyed.emplace_back("command pool");
}
void VKAPI_PTR note_render_pass(VkDevice, VkRenderPass, const VkAllocationCallbacks*) {
  destroyed.emplace_back("render pass");
}
void VKAPI_PTR note_buffer(VkDevice, VkBuffer, const VkAllocationCallbacks*) {
  destroyed.emplace_back("buffer");
}

VkResult VKAPI_PTR wait_loses_device(VkDevice device, std::uint32_t count, const VkFence* fences,
                                     VkBool32 all, std::uint64_t timeout) {
  (void)FakeLoader::real<PFN_vkWaitForFences>("vkWaitForFences")(device, count, fences, all, timeout);
  return VK_ERROR_DEVICE_LOST;
}

void VKAPI_PTR families_without_timestamps(VkPhysicalDevice device, std::uint32_t* count,
                                           VkQueueFamilyProperties* families) {
  FakeLoader::real<PFN_vkGetPhysicalDeviceQueueFamilyProperties>("vkGetPhysicalDeviceQueueFamilyProperties")(
      device, count, families);
  for (std::uint32_t i = 0; families != nullptr && i < *count; ++i) families[i].timestampValidBits = 0;
}

}  // namespace

TEST_CASE("a kernel runs for every element, whatever their number") {
  for (const std::uint32_t n : {1u, 127u, 128u, 129u, 100000u}) {
    MaximaWork work(test_context(), n);
    Recorder recorder = require(Recorder::create(test_context()));
    work.record(recorder);
    require_done(recorder.submit_and_wait());
    CHECK(values_of<float>(work.maxima) == work.expected);
    CHECK(recorder.counts().dispatches == 1);
    CHECK(recorder.counts().barriers == 0);
  }
}

TEST_CASE("no elements are no work") {
  MaximaWork work(test_context(), 1);
  Recorder recorder = require(Recorder::create(test_context()));
  work.count = 0;
  work.record(recorder);
  require_done(recorder.copy(work.angles, work.maxima, 0));
  require_done(recorder.submit_and_wait());
  CHECK(recorder.counts().dispatches == 0);
  CHECK(recorder.counts().copies == 0);
  CHECK(values_of<float>(work.maxima) == std::vector<float>{-1.0f});
}

TEST_CASE("long work is split, without barriers between its parts") {
  ContextOptions options = device_options();
  options.max_threads_per_dispatch = 300;  // two groups of 128
  const auto context = require(Context::create(options));
  MaximaWork work(*context, 1000);
  Recorder recorder = require(Recorder::create(*context));
  work.record(recorder);
  require_done(recorder.submit_and_wait());
  CHECK(recorder.counts().dispatches == 4);
  CHECK(recorder.counts().barriers == 0);
  CHECK(values_of<float>(work.maxima) == work.expected);
}

TEST_CASE("a barrier goes exactly where one piece of work depends on another") {
  Context& context = test_context();
  const std::vector<std::uint32_t> ones(64, 1), twos(64, 2), threes(64, 3);
  const Buffer a = buffer_of(context, ones), b = buffer_of(context, twos), c = buffer_of(context, threes);
  Recorder recorder = require(Recorder::create(context));
  const auto copy = [&](const Buffer& from, const Buffer& to, std::uint64_t from_at, std::uint64_t to_at) {
    require_done(recorder.copy(from, to, 16, from_at, to_at));
    return recorder.counts().barriers;
  };
  CHECK(copy(a, b, 0, 0) == 0);    // the first work of all
  CHECK(copy(a, c, 0, 0) == 0);    // reads what was read
  CHECK(copy(b, c, 0, 16) == 1);   // reads what was written (and writes what was written)
  CHECK(copy(b, a, 0, 32) == 1);   // writes what was read, but before the barrier
  CHECK(copy(a, b, 32, 48) == 2);  // reads what was written, writes what was read
  CHECK(copy(c, b, 16, 16) == 3);  // writes what was written
  CHECK(copy(b, c, 16, 32) == 4);
  CHECK(copy(a, c, 0, 48) == 5);  // writes what was written
  require_done(recorder.submit_and_wait());
  CHECK(recorder.counts().copies == 8);

  const auto quarter = [](const Buffer& buffer, std::size_t which) {
    return values_of<std::uint32_t>(buffer)[which * 4];
  };
  CHECK(quarter(b, 0) == 1);
  CHECK(quarter(a, 2) == 1);  // a[2] ← b[0]
  CHECK(quarter(b, 3) == 1);  // b[3] ← a[2]
  CHECK(quarter(c, 2) == 1);  // c[2] ← b[1] ← c[1] ← b[0]
  CHECK(quarter(c, 3) == 1);
}

TEST_CASE("kernels and copies are ordered alike") {
  MaximaWork work(test_context(), 500);
  const Buffer copied = require(Buffer::create(test_context(), 2000));
  Recorder recorder = require(Recorder::create(test_context()));
  work.record(recorder);
  CHECK(recorder.counts().barriers == 0);
  require_done(recorder.copy(work.maxima, copied, 2000));  // reads what the kernel wrote
  CHECK(recorder.counts().barriers == 1);
  work.record(recorder);  // writes what the copy read
  CHECK(recorder.counts().barriers == 2);
  work.record(recorder);  // writes what the kernel wrote
  CHECK(recorder.counts().barriers == 3);
  require_done(recorder.submit_and_wait());
  CHECK(values_of<float>(copied) == work.expected);
}

TEST_CASE("a recorder refuses what it cannot do") {
  MaximaWork work(test_context(), 10);
  Recorder recorder = require(Recorder::create(test_context()));
  using P = kernels::VertexMaximaParams;
  const auto dispatch = [&](std::uint64_t threads) {
    return Dispatch<P>(recorder, shaders::vertex_maxima, threads);
  };
  const auto code = [](const Result<void>& result) { return result ? ErrorCode{} : result.error().code; };
  const auto others = Dispatch<kernels::TrianglesParams>(recorder, shaders::vertex_maxima, 1).record();
  CHECK(code(others) == ErrorCode::kUsage);
  CHECK_THAT(others.error().message, Catch::Contains("takes 40 bytes of push constants, not 32"));
  CHECK(code(dispatch(std::uint64_t{1} << 32).record()) == ErrorCode::kUsage);
  // Memory that was never made, and an array that could not be.
  CHECK(code(dispatch(1).read(&P::angles, DeviceArray<float>()).record()) == ErrorCode::kUsage);
  CHECK(code(dispatch(1)
                 .read(&P::corner_offsets, DeviceMesh::Indices(fail(ErrorCode::kUnsuitable, "first")))
                 .read(&P::corner_half_edges, DeviceMesh::Indices(fail(ErrorCode::kNoDevice, "second")))
                 .record()) == ErrorCode::kUnsuitable);
  CHECK(code(recorder.copy(work.angles, work.maxima, 41)) == ErrorCode::kUsage);
  CHECK(code(recorder.copy(work.angles, work.maxima, 8, 116, 0)) == ErrorCode::kUsage);
  CHECK(code(recorder.copy(work.angles, work.angles, 8, 0, 4)) == ErrorCode::kUsage);
  CHECK(code(recorder.wait(std::chrono::seconds(1))) == ErrorCode::kUsage);
  require_done(recorder.submit_and_wait());
  require_done(recorder.wait(std::chrono::seconds(1)));
  CHECK(code(recorder.submit_and_wait()) == ErrorCode::kUsage);
  CHECK(code(recorder.copy(work.angles, work.maxima, 4)) == ErrorCode::kUsage);
  CHECK(code(dispatch(1).record()) == ErrorCode::kUsage);
  CHECK(!Recorder::into(test_context(), VK_NULL_HANDLE));
}

TEST_CASE("what another context made is refused, whatever the work") {
  const auto other = require(Context::create(device_options()));
  const IndexedFaceSet torus_faces = torus(8, 4);
  const HalfEdgeMesh torus_mesh = require(to_half_edge_mesh(torus_faces));
  DeviceMesh mesh = require(DeviceMesh::create(*other, torus_mesh, torus_faces.points));
  const MaximaWork own(test_context(), 10), others(*other, 10);
  Recorder recorder = require(Recorder::create(test_context()));
  const auto refused = [](const Result<void>& result) {
    REQUIRE(!result);
    CHECK(result.error().code == ErrorCode::kUsage);
    CHECK_THAT(result.error().message, Catch::Contains("was given memory that another context made"));
  };
  DeviceVertexNormals normals;
  refused(record_vertex_normals(recorder, mesh, normals));
  DeviceSmoothing smoothing;
  refused(record_laplacian_smoothing(recorder, mesh, smoothing, {}));
  DeviceSurfaceMeasures measures;
  refused(record_surface_measures(recorder, mesh, measures));
  refused(recorder.copy(others.angles, own.maxima, 4));
  refused(recorder.copy(own.angles, others.maxima, 4));
  const std::uint32_t zero = 0;
  refused(recorder.update(others.maxima, std::as_bytes(std::span(&zero, 1))));
  const Buffer* foreign[] = {&others.maxima};
  refused(recorder.graphics([](VkCommandBuffer) { FAIL("nothing is to be drawn"); }, foreign, {}));
  refused(recorder.graphics([](VkCommandBuffer) { FAIL("nothing is to be drawn"); }, {}, foreign));
  CHECK(recorder.counts().copies == 1);  // record_surface_measures clears its own sums first.
  require_done(recorder.submit_and_wait());
}

TEST_CASE("what a context made outlives it, and works on") {
  const IndexedFaceSet torus_faces = torus(8, 4);
  const HalfEdgeMesh torus_mesh = require(to_half_edge_mesh(torus_faces));
  auto context = require(Context::create(device_options()));
  DeviceMesh mesh = require(DeviceMesh::create(*context, torus_mesh, torus_faces.points));
  RenderTarget target = require(RenderTarget::create(*context, 16, 16));
  DeviceVertexNormals normals;
  Recorder recorder = require(Recorder::create(*context));
  context.reset();
  require_done(record_vertex_normals(recorder, mesh, normals));
  const Camera camera = require(frame_camera(torus_faces.points, 1.0));
  require_done(record_draw(recorder, require(geometry_of(mesh)), camera, {}, target));
  require_done(recorder.submit_and_wait());
  CHECK(require(normals.normals.download()) ==
        require(vertex_normals(torus_mesh, torus_faces.points, VertexNormalsOptions{})));
  CHECK(target.download());
  require_done(mesh.upload_positions(torus_faces.points));
  // They may also go in any order.
  Recorder second = require(Recorder::create(recorder.context()));
  require_done(second.submit_and_wait());
}

TEST_CASE("sections are timed where the device can") {
  Context& context = test_context();
  MaximaWork work(context, 1000);
  Recorder recorder = require(Recorder::create(context));
  recorder.begin_section("first");
  work.record(recorder);
  recorder.begin_section("second");
  work.record(recorder);
  CHECK(recorder.section_times().empty());
  require_done(recorder.submit_and_wait());
  if (context.device().timestamp_bits == 0) {
    CHECK(recorder.section_times().empty());
  } else {
    REQUIRE(recorder.section_times().size() == 2);
    CHECK(recorder.section_times()[0].name == "first");
    CHECK(recorder.section_times()[1].name == "second");
    for (const SectionTime& time : recorder.section_times()) CHECK(time.milliseconds >= 0.0);
  }

  Recorder many = require(Recorder::create(context));
  for (int i = 0; i < 100; ++i) many.begin_section("section");
  require_done(many.submit_and_wait());
  CHECK(many.section_times().size() <= 64);
}

TEST_CASE("a device without time-stamps works, untimed") {
  FakeLoader loader;
  loader.replace("vkGetPhysicalDeviceQueueFamilyProperties", families_without_timestamps);
  const auto context = require(Context::create(loader.options()));
  MaximaWork work(*context, 100);
  Recorder recorder = require(Recorder::create(*context));
  recorder.begin_section("one");
  work.record(recorder);
  require_done(recorder.submit_and_wait());
  CHECK(recorder.section_times().empty());
  CHECK(values_of<float>(work.maxima) == work.expected);
}

TEST_CASE("work goes into the caller's command buffer, which the caller submits") {
  detail::Device& device = test_context().device();
  const auto& vk = device.functions;
  VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr, 0,
                                    device.queue_family};
  VkCommandPool pool = VK_NULL_HANDLE;
  REQUIRE(vk.vkCreateCommandPool(device.handle, &pool_info, nullptr, &pool) == VK_SUCCESS);
  VkCommandBufferAllocateInfo allocation{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool,
                                         VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  REQUIRE(vk.vkAllocateCommandBuffers(device.handle, &allocation, &commands) == VK_SUCCESS);
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, 0, nullptr};
  REQUIRE(vk.vkBeginCommandBuffer(commands, &begin) == VK_SUCCESS);

  MaximaWork work(test_context(), 700);
  {
    Recorder recorder = require(Recorder::into(test_context(), commands));
    recorder.begin_section("untimed");
    work.record(recorder);
    CHECK(recorder.counts().dispatches == 1);
    const auto submitted = recorder.submit_and_wait();
    REQUIRE(!submitted);
    CHECK(submitted.error().code == ErrorCode::kUsage);
  }
  CHECK(values_of<float>(work.maxima) == std::vector<float>(700, -1.0f));

  REQUIRE(vk.vkEndCommandBuffer(commands) == VK_SUCCESS);
  const VkFenceCreateInfo fence_info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
  VkFence fence = VK_NULL_HANDLE;
  REQUIRE(vk.vkCreateFence(device.handle, &fence_info, nullptr, &fence) == VK_SUCCESS);
  VkSubmitInfo submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  REQUIRE(device.submit(submit, fence));
  REQUIRE(vk.vkWaitForFences(device.handle, 1, &fence, VK_TRUE, 60'000'000'000) == VK_SUCCESS);
  CHECK(values_of<float>(work.maxima) == work.expected);
  vk.vkDestroyFence(device.handle, fence, nullptr);
  vk.vkDestroyCommandPool(device.handle, pool, nullptr);
}

TEST_CASE("work that takes too long is an error, and can be waited for again") {
  FakeLoader loader;
  loader.replace("vkWaitForFences", wait_times_out);
  timeouts_left = 0;
  const auto slow = require(Context::create(loader.options()));
  MaximaWork work(*slow, 100);
  Recorder recorder = require(Recorder::create(*slow));
  work.record(recorder);
  timeouts_left = 2;
  for (const auto& result : {recorder.submit_and_wait(std::chrono::milliseconds(250)),
                             recorder.wait(std::chrono::milliseconds(250))}) {
    REQUIRE(!result);
    CHECK(result.error().code == ErrorCode::kNoDevice);
    CHECK_THAT(result.error().message, Catch::Contains("did not finish its work within 250 ms"));
  }
  require_done(recorder.wait(std::chrono::seconds(60)));
  CHECK(values_of<float>(work.maxima) == work.expected);
}

TEST_CASE("a wait that fails for want of memory does not end the work") {
  FakeLoader loader;
  loader.replace("vkWaitForFences", wait_fails);
  failures_left = 0;
  const auto context = require(Context::create(loader.options()));
  for (const VkResult result :
       {VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_UNKNOWN}) {
    failure = result;
    MaximaWork work(*context, 100);
    {
      // It passes while there is time.
      Recorder recorder = require(Recorder::create(*context));
      work.record(recorder);
      failures_left = 3;
      require_done(recorder.submit_and_wait());
      CHECK(failures_left < 0);
      CHECK(values_of<float>(work.maxima) == work.expected);
    }
    // It lasts.
    Recorder recorder = require(Recorder::create(*context));
    work.record(recorder);
    failures_left = 1000000;
    for (const auto& waited : {recorder.submit_and_wait(std::chrono::milliseconds(3)),
                               recorder.wait(std::chrono::milliseconds(0))}) {
      REQUIRE(!waited);
      CHECK(waited.error().code ==
            (result == VK_ERROR_UNKNOWN ? ErrorCode::kInternal : ErrorCode::kOutOfMemory));
    }
    failures_left = 0;
    require_done(recorder.wait(std::chrono::seconds(60)));
    CHECK(values_of<float>(work.maxima) == work.expected);
  }
}

TEST_CASE("what a device that never answers may still use is not destroyed") {
#if defined(VKMESH_ADDRESS_SANITIZER)
  __lsan_disable();  // the point of this test is a leak
#endif
  for (const VkResult result :
       {VK_TIMEOUT, VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_UNKNOWN}) {
    INFO("vkWaitForFences returns " << result);
    FakeLoader loader;
    loader.replace("vkWaitForFences", wait_fails);
    failures_left = 0;
    ContextOptions options = loader.options();
    auto context = require(Context::create(options));
    detail::Device& device = context->device();
    if (device.draws) REQUIRE(device.draw_pipelines());
    // From here on nothing is destroyed, whatever is asked for.
    device.functions.vkDestroyFence = note_fence;
    device.functions.vkDestroyCommandPool = note_pool;
    device.functions.vkDestroyRenderPass = note_render_pass;
    device.functions.vkDestroyBuffer = note_buffer;
    destroyed.clear();
    {
      MaximaWork work(*context, 100);
      Recorder recorder = require(Recorder::create(*context));
      work.record(recorder);
      failure = result;
      failures_left = 2;
      destroyed.clear();  // what staging took
      CHECK(!recorder.submit_and_wait(std::chrono::milliseconds(0)));
    }
    CHECK(failures_left == 0);  // the recorder waited once more before it gave up
    CHECK(device.abandoned);
    CHECK(context->allocated_bytes() > 0);
    context.reset();
    CHECK(destroyed.empty());
  }
#if defined(VKMESH_ADDRESS_SANITIZER)
  __lsan_enable();
#endif
}

TEST_CASE("a device that is lost while it works is an error") {
  FakeLoader loader;
  ContextOptions options = loader.options();
  options.skip_exactness_check = true;
  loader.replace("vkWaitForFences", wait_loses_device);
  const auto context = require(Context::create(options));
  Recorder recorder = require(Recorder::create(*context));
  const auto result = recorder.submit_and_wait();
  REQUIRE(!result);
  CHECK(result.error().code == ErrorCode::kNoDevice);
  CHECK_THAT(result.error().message, Catch::Contains("the device was lost"));
}

}  // namespace vkmesh::test
