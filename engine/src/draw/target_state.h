// The objects behind a RenderTarget.
#pragma once

#include <cstdint>

#include <vkmesh/engine/core/buffer.h>
#include <vkmesh/engine/draw/render_target.h>

#include "draw/image.h"

namespace vkmesh {

struct VKMESH_LOCAL RenderTarget::State {
  explicit State(const Context& c) : context(c.shared_device()) {}
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  [[nodiscard]] Result<void> make_view(VkDescriptorSetLayout layout);

  Context context;  ///< On the same device as the caller's, which may go.
  std::uint32_t width = 0, height = 0;
  detail::Image samples;  ///< Colour, before it is resolved.
  detail::Image depth;
  detail::Image resolved;
  VkFramebuffer framebuffer = VK_NULL_HANDLE;
  Buffer view;  ///< A kernels::DrawView.
  VkDescriptorPool pool = VK_NULL_HANDLE;
  VkDescriptorSet set = VK_NULL_HANDLE;  ///< Laid out by DrawPipelines::set_layout(): `view`.
  Buffer pixels;                         ///< Four bytes a pixel, for the host.
};

}  // namespace vkmesh
