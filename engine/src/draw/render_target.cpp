#include <cstring>
#include <string>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/draw/render_target.h>

#include "core/device.h"
#include "draw/draw_params.h"
#include "draw/pipelines.h"
#include "draw/target_state.h"

namespace vkmesh {

RenderTarget::State::~State() {
  const detail::Device& device = context.device();
  if (device.abandoned.load()) return;
  device.functions.vkDestroyFramebuffer(device.handle, framebuffer, nullptr);
  device.functions.vkDestroyDescriptorPool(device.handle, pool, nullptr);
}

Result<void> RenderTarget::State::make_view(VkDescriptorSetLayout layout) {
  const detail::Device& device = context.device();
  const auto& vk = device.functions;
  const std::string name = "parameters of the picture", what = "describing the " + name;
  VKMESH_TRY(view, Buffer::create(context, sizeof(kernels::DrawView), BufferMemory::kDevice, name.c_str()));
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1};
  const VkDescriptorPoolCreateInfo info{
      VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, nullptr, 0, 1, 1, &size};
  VKMESH_VK(vk.vkCreateDescriptorPool(device.handle, &info, nullptr, &pool), what);
  const VkDescriptorSetAllocateInfo allocation{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr, pool,
                                               1, &layout};
  VKMESH_VK(vk.vkAllocateDescriptorSets(device.handle, &allocation, &set), what);
  const VkDescriptorBufferInfo buffer{view.vk_buffer(), 0, VK_WHOLE_SIZE};
  VkWriteDescriptorSet write{};
  write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
  write.dstSet = set;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
  write.pBufferInfo = &buffer;
  vk.vkUpdateDescriptorSets(device.handle, 1, &write, 0, nullptr);
  return {};
}

RenderTarget::RenderTarget(std::unique_ptr<State> state) : state_(std::move(state)) {}
RenderTarget::~RenderTarget() = default;
RenderTarget::RenderTarget(RenderTarget&&) noexcept = default;
RenderTarget& RenderTarget::operator=(RenderTarget&&) noexcept = default;

Result<RenderTarget> RenderTarget::create(Context& context, std::uint32_t width, std::uint32_t height) {
  return detail::catching([&]() -> Result<RenderTarget> {
    detail::Device& device = context.device();
    VKMESH_TRY(const detail::DrawPipelines* pipelines, device.draw_pipelines());
    const std::string size = std::to_string(width) + " by " + std::to_string(height) + " pixels";
    if (width == 0 || height == 0) return fail(ErrorCode::kUsage, "a picture of " + size + " has no pixels");
    if (width > device.max_image_side || height > device.max_image_side)
      return fail(ErrorCode::kUsage, "a picture of " + size + " is too large: " + device.info.name +
                                         " draws at most " + std::to_string(device.max_image_side) +
                                         " a side");

    auto state = std::make_unique<State>(context);
    state->width = width;
    state->height = height;
    // Transient: the samples never leave the render pass, and tiled devices need no memory for them.
    constexpr VkImageUsageFlags kColor = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    constexpr VkImageUsageFlags kTransient = VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
    VKMESH_TRY(state->samples,
               detail::Image::create(context, width, height,
                                     {detail::DrawPipelines::kColorFormat, detail::DrawPipelines::kSamples,
                                      kColor | kTransient, VK_IMAGE_ASPECT_COLOR_BIT},
                                     "colour samples"));
    VKMESH_TRY(state->depth,
               detail::Image::create(
                   context, width, height,
                   {pipelines->depth_format(), detail::DrawPipelines::kSamples,
                    VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | kTransient, VK_IMAGE_ASPECT_DEPTH_BIT},
                   "depth samples"));
    VKMESH_TRY(state->resolved,
               detail::Image::create(context, width, height,
                                     {detail::DrawPipelines::kColorFormat, VK_SAMPLE_COUNT_1_BIT,
                                      kColor | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                                      VK_IMAGE_ASPECT_COLOR_BIT},
                                     "picture"));
    const VkImageView views[] = {state->samples.view(), state->depth.view(), state->resolved.view()};
    VkFramebufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
    info.renderPass = pipelines->render_pass();
    info.attachmentCount = 3;
    info.pAttachments = views;
    info.width = width;
    info.height = height;
    info.layers = 1;
    VKMESH_VK(device.functions.vkCreateFramebuffer(device.handle, &info, nullptr, &state->framebuffer),
              "making a frame buffer");
    VKMESH_CHECK(state->make_view(pipelines->set_layout()));
    VKMESH_TRY(state->pixels,
               Buffer::create(context, std::uint64_t{4} * width * height, BufferMemory::kReadback, "pixels"));
    return RenderTarget(std::move(state));
  });
}

std::uint32_t RenderTarget::width() const {
  return state_->width;
}

std::uint32_t RenderTarget::height() const {
  return state_->height;
}

VkImage RenderTarget::image() const {
  return state_->resolved.handle();
}

VkImageView RenderTarget::image_view() const {
  return state_->resolved.view();
}

Result<Picture> RenderTarget::download() const {
  VKMESH_TRY(Picture picture, Picture::create(state_->width, state_->height, {}));
  VKMESH_CHECK(state_->pixels.download(std::as_writable_bytes(picture.pixels())));
  // Alpha held coverage, which the samples have taken into account.
  for (Color& pixel : picture.pixels()) pixel.a = 255;
  return picture;
}

}  // namespace vkmesh
