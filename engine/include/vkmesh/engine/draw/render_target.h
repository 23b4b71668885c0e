// Targets that pictures are drawn into, without a window.
#pragma once

#include <cstdint>
#include <memory>

#include <vulkan/vulkan_core.h>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/buffer.h>
#include <vkmesh/engine/core/context.h>
#include <vkmesh/view/picture.h>

namespace vkmesh {

/// Images of one size: colour and depth with four samples a pixel, the resolved colour, and a buffer that the
/// host reads. About 40 bytes a pixel. Movable, not copyable. Must live until the work that draws has run.
class VKMESH_API RenderTarget {
 public:
  /// Makes a target. Errors: kUsage for a side of 0 pixels or more than the device takes; kNoDevice where the
  /// device cannot draw; kOutOfMemory.
  [[nodiscard]] static Result<RenderTarget> create(Context& context, std::uint32_t width,
                                                   std::uint32_t height);

  ~RenderTarget();
  RenderTarget(RenderTarget&&) noexcept;
  RenderTarget& operator=(RenderTarget&&) noexcept;

  [[nodiscard]] std::uint32_t width() const;
  [[nodiscard]] std::uint32_t height() const;
  /// Image of the picture in format R8G8B8A8_UNORM, sRGB-encoded, to sample or copy from: after record_draw()
  /// in the layout TRANSFER_SRC_OPTIMAL.
  [[nodiscard]] VkImage image() const;
  [[nodiscard]] VkImageView image_view() const;

  /// Downloads the picture that was drawn last, once that work has run. O(pixels). Errors: kOutOfMemory,
  /// kNoDevice.
  [[nodiscard]] Result<Picture> download() const;

  struct State;
  /// Internal: for the engine's own sources.
  [[nodiscard]] State& state() const { return *state_; }

 private:
  explicit RenderTarget(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace vkmesh
