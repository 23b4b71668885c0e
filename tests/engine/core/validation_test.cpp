// The other tests fail where the validation layer says something: here it must.
#include <span>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/draw/draw.h>

#include "core/device.h"
#include "passes/triangle_normals_params.h"
#include "shaders.h"
#include "support/device.h"
#include "support/shapes.h"

namespace vkmesh::test {
namespace {

using Catch::Contains;

/// One whose messages do not count for the run.
std::unique_ptr<Context> context_with(bool gpu_assisted) {
  ContextOptions options = device_options();
  options.gpu_assisted_validation = gpu_assisted;
  options.skip_exactness_check = true;  // Its kernel takes seconds to check.
  options.on_validation_message = nullptr;
  return require(Context::create(options));
}

void check_named(Context& context, const std::string& what) {
  const std::vector<std::string> messages = context.take_validation_messages();
  REQUIRE(messages.size() == 1);
  CHECK_THAT(messages[0], Contains(what));
}

}  // namespace

TEST_CASE("synchronization validation sees two writes without a barrier") {
  const auto context = context_with(false);
  const Buffer buffer = require(Buffer::create(*context, 16));
  Recorder recorder = require(Recorder::create(*context));
  const std::uint32_t value = 1;
  const auto write = [&](VkCommandBuffer commands) {
    context->device().functions.vkCmdUpdateBuffer(commands, buffer.vk_buffer(), 0, sizeof value, &value);
  };
  require_done(recorder.graphics(write, {}, {}));
  CHECK(context->take_validation_messages().empty());
  require_done(recorder.graphics(write, {}, {}));
  check_named(*context, "SYNC-HAZARD-WRITE-AFTER-WRITE");
}

TEST_CASE("GPU-assisted validation sees reads past the end of a buffer, of kernels and of drawing") {
  if (is_swiftshader(test_context())) {
    WARN("GPU-assisted validation needs shaderInt64, which SwiftShader lacks: not checked there");
    return;
  }
  const auto context = context_with(true);
  const auto run = [&](const auto& record) {
    Recorder recorder = require(Recorder::create(*context));
    require_done(record(recorder));
    require_done(recorder.submit_and_wait());
  };

  const IndexedFaceSet mesh = torus(8, 4);
  const DrawMesh on_device = require(DrawMesh::create(*context, mesh));
  DrawGeometry geometry = on_device.geometry();
  const Buffer vectors = require(Buffer::create(*context, 12 * (geometry.triangles + 1)));
  const auto compute = [&](std::uint32_t triangles) {
    run([&](Recorder& recorder) {
      using P = kernels::TrianglesParams;
      return Dispatch<P>(recorder, shaders::triangle_areas, triangles)
          .read(&P::positions, *geometry.positions)
          .read(&P::corners, *geometry.corners)
          .write(&P::vectors, vectors)
          .record();
    });
  };
  compute(geometry.triangles);
  CHECK(context->take_validation_messages().empty());
  compute(geometry.triangles + 1);
  check_named(*context, "access out of bounds");

  const Camera camera = require(frame_camera(mesh.points, 1.0));
  for (const DrawMode mode : {DrawMode::kFlat, DrawMode::kPoints}) {
    RenderTarget target = require(RenderTarget::create(*context, 16, 16));
    geometry = on_device.geometry();
    const auto draw = [&] {
      run([&](Recorder& recorder) {
        return record_draw(recorder, geometry, camera, {.mode = mode}, target);
      });
    };
    draw();
    CHECK(context->take_validation_messages().empty());
    // Eight, for docs/testing.md says what becomes of groups that are not full.
    geometry.triangles += 8;
    geometry.points += 8;
    draw();
    check_named(*context, "access out of bounds");
  }
}

}  // namespace vkmesh::test
