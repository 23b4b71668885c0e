#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <glm/geometric.hpp>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/draw/draw.h>

#include "core/device.h"
#include "draw/draw_params.h"
#include "draw/pipelines.h"
#include "draw/target_state.h"

namespace vkmesh {
namespace {

using glm::dot;

using detail::DrawShaders;

/// Without the feature fullDrawIndexUint32 that is how far an index buffer reaches.
constexpr std::uint32_t kMaxIndexedPoints = std::uint32_t{1} << 24;
/// How much nearer lines are drawn than the surface below them, as a share of the distance or the depth.
constexpr double kLineBias = 2e-3;

void put(float (&to)[4], const DVec3& xyz) {
  to[0] = static_cast<float>(xyz.x);
  to[1] = static_cast<float>(xyz.y);
  to[2] = static_cast<float>(xyz.z);
  to[3] = 0.0f;
}

double to_linear(std::uint8_t srgb) {
  const double x = srgb / 255.0;
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

void put_linear(float (&to)[4], const Color& c) {
  put(to, DVec3(to_linear(c.r), to_linear(c.g), to_linear(c.b)));
}

std::uint32_t packed(const Color& c) {
  return std::uint32_t{c.r} | std::uint32_t{c.g} << 8 | std::uint32_t{c.b} << 16 | std::uint32_t{c.a} << 24;
}

/// The part of the view that the camera decides.
Result<void> put_camera(kernels::DrawView& view, const Camera& camera, std::uint32_t width,
                        std::uint32_t height) {
  VKMESH_TRY(const CameraAxes axes, axes_of(camera));
  const bool perspective = camera.projection == Projection::kPerspective;
  const double n = camera.near, f = camera.far;
  if (!(n < f) || !std::isfinite(n) || !std::isfinite(f) || (perspective && !(n > 0.0)))
    return fail(ErrorCode::kUsage,
                "a camera sees from `near` to a larger `far`, and with perspective from above 0");
  if (perspective ? !(camera.field_of_view > 0.0 && camera.field_of_view < 180.0)
                  : !(camera.visible_height > 0.0))
    return fail(ErrorCode::kUsage,
                "a camera needs a field of view between 0 and 180 degrees, or a visible height");

  // Positions are taken relative to the target as it reads in single precision: nothing is lost by that.
  const DVec3 origin = DVec3(Vec3(camera.target));
  const DVec3 eye = camera.eye - origin;
  const double aspect = static_cast<double>(width) / static_cast<double>(height);
  const double scale_y = perspective ? 1.0 / std::tan(camera.field_of_view * 3.14159265358979323846 / 360.0)
                                     : 2.0 / camera.visible_height;
  // Rows of the matrix that takes positions to clip space: y points down there, depth runs from 1 to 0.
  struct Row {
    DVec3 xyz;
    double w;
  };
  const auto plane = [&](const DVec3& axis, double scale) {
    return Row{axis * scale, -dot(axis, eye) * scale};
  };
  Row depth = plane(axes.forward, -(perspective ? n : 1.0) / (f - n));
  const double at_eye = (perspective ? n * f : f) / (f - n);
  depth.w += at_eye;
  const Row rows[4] = {plane(axes.right, scale_y / aspect), plane(axes.up, -scale_y), depth,
                       perspective ? plane(axes.forward, 1.0) : Row{DVec3(0.0), 1.0}};
  for (std::size_t r = 0; r < 4; ++r) {
    view.clip_from_origin[r] = static_cast<float>(rows[r].xyz.x);
    view.clip_from_origin[4 + r] = static_cast<float>(rows[r].xyz.y);
    view.clip_from_origin[8 + r] = static_cast<float>(rows[r].xyz.z);
    view.clip_from_origin[12 + r] = static_cast<float>(rows[r].w);
  }
  put(view.origin, origin);
  put(view.eye, eye);
  put(view.up, axes.up);
  put(view.back, -axes.forward);
  const DVec3 lamp = -axes.forward + 0.45 * axes.up - 0.35 * axes.right;
  put(view.lamp, lamp / std::sqrt(dot(lamp, lamp)));
  view.nearest = static_cast<float>(n);
  view.nearest = static_cast<float>(n);
  view.depth = static_cast<float>(f - n);
  view.half_width = 0.5f * static_cast<float>(width);
  view.half_height = 0.5f * static_cast<float>(height);
  view.line_bias = static_cast<float>(kLineBias * (perspective ? at_eye : 4.0));
  return {};
}

void put_style(kernels::DrawView& view, const DrawStyle& style) {
  put_linear(view.plain, style.plain);
  put_linear(view.none, style.none);
  put_linear(view.flipped, style.flipped);
  put(view.edge, DVec3(style.edge.r, style.edge.g, style.edge.b) / 255.0);
  view.edge_width = style.edge_width;
  view.value_low = static_cast<float>(style.range.low);
  const double width = style.range.high - style.range.low;
  view.value_scale = width > 0.0 ? static_cast<float>(1.0 / width) : 0.0f;
  view.point_radius = 0.5f * style.point_size;
  view.splat_scale = style.splat_scale;
  const ColorTable table = color_table(style.map);
  for (std::size_t i = 0; i < table.size(); ++i) put_linear(view.table[i], table[i]);
}

Result<void> check(const DrawGeometry& geometry, const DrawStyle& style) {
  const bool valued = style.colors == DrawColors::kValue || style.colors == DrawColors::kDirect;
  const bool as_points = style.mode == DrawMode::kPoints || style.mode == DrawMode::kSplats;
  if (geometry.points == 0) return {};
  if (geometry.positions == nullptr) return fail(ErrorCode::kUsage, "there are no positions to draw");
  if (valued && geometry.values == nullptr)
    return fail(ErrorCode::kUsage, "colours by value were asked for, but the geometry has no values");
  if (valued && as_points && geometry.element != DrawElement::kPoint)
    return fail(ErrorCode::kUsage, "points cannot show the values of corners or faces");
  if (style.mode == DrawMode::kSplats && geometry.spacing == nullptr)
    return fail(ErrorCode::kUsage, "splats need the spacing of the points");
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  if (std::uint64_t{3} * (as_points ? geometry.points : geometry.triangles) > kMost)
    return fail(ErrorCode::kUnsuitable, "a draw call counts vertices in 32 bits: the mesh has too many");
  for (const DrawEdges& edges : geometry.edges)
    if (std::uint64_t{6} * edges.count > kMost)
      return fail(ErrorCode::kUnsuitable, "a draw call counts vertices in 32 bits: these edges are too many");
  return {};
}

std::uint64_t address_of(const Buffer* buffer) {
  return buffer == nullptr ? 0 : buffer->address();
}

}  // namespace

Result<DrawGeometry> geometry_of(DeviceMesh& mesh) {
  DrawGeometry geometry;
  geometry.points = mesh.vertex_count();
  geometry.triangles = mesh.face_count();
  VKMESH_TRY(const auto* corners, mesh.corners());
  if (geometry.points > 0) geometry.positions = &mesh.positions().buffer();
  if (geometry.triangles > 0) geometry.corners = &corners->buffer();
  return geometry;
}

Result<void> record_draw(Recorder& recorder, const DrawGeometry& geometry, const Camera& camera,
                         const DrawStyle& style, RenderTarget& target) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_CHECK(check(geometry, style));
    const RenderTarget::State& to = target.state();
    detail::Device& device = recorder.context().device();
    VKMESH_TRY(detail::DrawPipelines * pipelines, device.draw_pipelines());
    kernels::DrawView view{};
    VKMESH_CHECK(put_camera(view, camera, to.width, to.height));
    put_style(view, style);
    VKMESH_CHECK(recorder.update(to.view, std::as_bytes(std::span(&view, 1))));

    kernels::DrawParams params{};
    params.positions = address_of(geometry.positions);
    params.corners = address_of(geometry.corners);
    params.normals = address_of(geometry.normals);
    params.values = address_of(geometry.values);
    params.hidden = address_of(geometry.hidden_edges);
    params.spacing = style.mode == DrawMode::kSplats ? address_of(geometry.spacing) : 0;
    params.element = geometry.element == DrawElement::kPoint    ? VKMESH_PER_POINT
                     : geometry.element == DrawElement::kCorner ? VKMESH_PER_CORNER
                                                                : VKMESH_PER_FACE;
    params.flags = 0;
    if (style.mode != DrawMode::kFlat) params.flags |= VKMESH_SMOOTH;
    if (style.mode == DrawMode::kSplats) params.flags |= VKMESH_ORIENTED;
    if (camera.projection == Projection::kPerspective) params.flags |= VKMESH_PERSPECTIVE;

    const bool as_points = style.mode == DrawMode::kPoints || style.mode == DrawMode::kSplats;
    const bool by_points = style.mode == DrawMode::kShaded && geometry.corners != nullptr &&
                           geometry.normals != nullptr &&
                           (geometry.values == nullptr || geometry.element == DrawElement::kPoint) &&
                           geometry.points <= kMaxIndexedPoints;
    detail::DrawPipelineKey key;
    key.shaders = as_points   ? DrawShaders::kPoints
                  : by_points ? DrawShaders::kIndexed
                              : DrawShaders::kCorners;
    key.color_source = style.colors == DrawColors::kNormal   ? VKMESH_COLOR_NORMAL
                       : style.colors == DrawColors::kValue  ? VKMESH_COLOR_VALUE
                       : style.colors == DrawColors::kDirect ? VKMESH_COLOR_DIRECT
                                                             : VKMESH_COLOR_PLAIN;
    key.edges = style.mode == DrawMode::kWireframe    ? VKMESH_EDGES_ONLY
                : style.mode == DrawMode::kShadedWire ? VKMESH_EDGES_TOO
                                                      : VKMESH_NO_EDGES;
    key.show_flipped = style.show_flipped && !as_points ? 1 : 0;
    VKMESH_TRY(const VkPipeline surface, pipelines->pipeline(key));
    VkPipeline lines = VK_NULL_HANDLE;
    if (!geometry.edges.empty()) {
      VKMESH_TRY(lines, pipelines->pipeline({.shaders = DrawShaders::kLines}));
    }

    std::vector<const Buffer*> reads = {&to.view};
    for (const Buffer* buffer : {geometry.positions, geometry.corners, geometry.normals, geometry.values,
                                 geometry.hidden_edges, geometry.spacing})
      if (buffer != nullptr) reads.push_back(buffer);
    for (const DrawEdges& edges : geometry.edges) reads.push_back(edges.ends);
    const Buffer* writes[] = {&to.pixels};

    const auto commands = [&](VkCommandBuffer cmd) {
      const auto& vk = device.functions;
      VkClearValue clear[2]{};
      const Color& b = style.background;
      const std::uint8_t background[4] = {b.r, b.g, b.b, 255};
      for (std::size_t i = 0; i < 4; ++i)
        clear[0].color.float32[i] = static_cast<float>(background[i]) / 255.0f;
      VkRenderPassBeginInfo begin{};
      begin.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
      begin.renderPass = pipelines->render_pass();
      begin.framebuffer = to.framebuffer;
      begin.renderArea = {{0, 0}, {to.width, to.height}};
      begin.clearValueCount = 2;
      begin.pClearValues = clear;
      vk.vkCmdBeginRenderPass(cmd, &begin, VK_SUBPASS_CONTENTS_INLINE);
      const VkViewport viewport{0.0f, 0.0f, static_cast<float>(to.width), static_cast<float>(to.height),
                                0.0f, 1.0f};
      vk.vkCmdSetViewport(cmd, 0, 1, &viewport);
      vk.vkCmdSetScissor(cmd, 0, 1, &begin.renderArea);
      vk.vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines->layout(), 0, 1, &to.set, 0,
                                 nullptr);

      const auto use = [&](VkPipeline pipeline) {
        vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
        vk.vkCmdPushConstants(cmd, pipelines->layout(),
                              VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof params,
                              &params);
      };
      use(surface);
      if (as_points && geometry.points > 0) {
        vk.vkCmdDraw(cmd, 3 * geometry.points, 1, 0, 0);
      } else if (by_points && geometry.triangles > 0) {
        // Positions stand in for values that are not there, and are not read as such.
        const Buffer* values = geometry.values != nullptr ? geometry.values : geometry.positions;
        const VkBuffer buffers[] = {geometry.positions->vk_buffer(), geometry.normals->vk_buffer(),
                                    values->vk_buffer()};
        const VkDeviceSize offsets[] = {0, 0, 0};
        vk.vkCmdBindVertexBuffers(cmd, 0, 3, buffers, offsets);
        vk.vkCmdBindIndexBuffer(cmd, geometry.corners->vk_buffer(), 0, VK_INDEX_TYPE_UINT32);
        vk.vkCmdDrawIndexed(cmd, 3 * geometry.triangles, 1, 0, 0, 0);
      } else if (!as_points && geometry.triangles > 0) {
        vk.vkCmdDraw(cmd, 3 * geometry.triangles, 1, 0, 0);
      }
      for (const DrawEdges& edges : geometry.edges) {
        if (edges.count == 0) continue;
        params.corners = address_of(edges.ends);
        params.color = packed(edges.color);
        params.width = edges.width;
        use(lines);
        vk.vkCmdDraw(cmd, 6 * edges.count, 1, 0, 0);
      }
      vk.vkCmdEndRenderPass(cmd);

      VkBufferImageCopy region{};
      region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
      region.imageExtent = {to.width, to.height, 1};
      vk.vkCmdCopyImageToBuffer(cmd, to.resolved.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                to.pixels.vk_buffer(), 1, &region);
    };
    return recorder.graphics(commands, reads, writes);
  });
}

}  // namespace vkmesh
