#include "draw/pipelines.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/device.h"
#include "draw/draw_params.h"
#include "shaders.h"

namespace vkmesh::detail {
namespace {

struct ShaderPair {
  std::span<const std::uint32_t> vertex, fragment;
};

ShaderPair shaders_of(DrawShaders which) {
  switch (which) {
    case DrawShaders::kIndexed:
      return {shaders::draw_indexed_vert.spirv, shaders::draw_surface_frag.spirv};
    case DrawShaders::kCorners:
      return {shaders::draw_corners_vert.spirv, shaders::draw_surface_frag.spirv};
    case DrawShaders::kPoints:
      return {shaders::draw_points_vert.spirv, shaders::draw_points_frag.spirv};
    case DrawShaders::kLines:
      break;
  }
  return {shaders::draw_lines_vert.spirv, shaders::draw_lines_frag.spirv};
}

/// Shader modules, needed only until the pipelines are made.
class Modules {
 public:
  explicit Modules(const Device& device) : device_(device) {}
  Modules(const Modules&) = delete;
  Modules& operator=(const Modules&) = delete;
  ~Modules() {
    for (const VkShaderModule module : modules_)
      device_.functions.vkDestroyShaderModule(device_.handle, module, nullptr);
  }
  Result<VkShaderModule> make(std::span<const std::uint32_t> spirv) {
    VkShaderModuleCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    info.codeSize = spirv.size_bytes();
    info.pCode = spirv.data();
    modules_.reserve(modules_.size() + 1);
    VkShaderModule module = VK_NULL_HANDLE;
    VKMESH_VK(device_.functions.vkCreateShaderModule(device_.handle, &info, nullptr, &module),
              "making a drawing shader");
    modules_.push_back(module);
    return module;
  }

 private:
  const Device& device_;
  std::vector<VkShaderModule> modules_;
};

}  // namespace

Result<std::unique_ptr<DrawPipelines>> DrawPipelines::create(Device& device) {
  if (!device.draws)
    return fail(ErrorCode::kNoDevice, "the queue of " + device.info.name + " computes, but does not draw");
  std::unique_ptr<DrawPipelines> result(new DrawPipelines(device));
  VKMESH_CHECK(result->make_render_pass());
  VKMESH_CHECK(result->make_layout());
  return result;
}

Result<DrawPipelines*> Device::draw_pipelines() {
  const std::lock_guard lock(draw_pipelines_mutex_);
  if (!draw_pipelines_) {
    VKMESH_TRY(draw_pipelines_, DrawPipelines::create(*this));
  }
  return draw_pipelines_.get();
}

DrawPipelines::~DrawPipelines() {
  if (device_.abandoned.load()) return;  // the device may still be using them
  const auto& vk = device_.functions;
  for (const auto& [key, pipeline] : pipelines_) vk.vkDestroyPipeline(device_.handle, pipeline, nullptr);
  vk.vkDestroyPipelineLayout(device_.handle, layout_, nullptr);
  vk.vkDestroyDescriptorSetLayout(device_.handle, set_layout_, nullptr);
  vk.vkDestroyRenderPass(device_.handle, render_pass_, nullptr);
}

Result<void> DrawPipelines::make_render_pass() {
  // Vulkan promises one of these two.
  for (const VkFormat format : {VK_FORMAT_D32_SFLOAT, VK_FORMAT_X8_D24_UNORM_PACK32}) {
    VkFormatProperties properties;
    device_.instance_functions.vkGetPhysicalDeviceFormatProperties(device_.physical_device, format,
                                                                   &properties);
    if ((properties.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) == 0) continue;
    depth_format_ = format;
    break;
  }
  if (depth_format_ == VK_FORMAT_UNDEFINED)
    return fail(ErrorCode::kNoDevice, device_.info.name + " has no depth buffer that drawing could use");

  VkAttachmentDescription attachments[3]{};
  for (VkAttachmentDescription& a : attachments) {
    a.format = kColorFormat;
    a.samples = kSamples;
    a.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    a.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    a.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    a.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    a.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    a.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  }
  attachments[1].format = depth_format_;
  attachments[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  attachments[2].samples = VK_SAMPLE_COUNT_1_BIT;
  attachments[2].loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachments[2].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  attachments[2].finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;

  const VkAttachmentReference color{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference resolved{2, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &color;
  subpass.pResolveAttachments = &resolved;
  subpass.pDepthStencilAttachment = &depth;

  // A picture may follow another in the same images, whose copy to the host must then be over.
  VkSubpassDependency dependencies[2]{};
  dependencies[0].srcSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[0].dstSubpass = 0;
  dependencies[0].srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                 VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  dependencies[0].srcAccessMask =
      VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[0].dstStageMask =
      VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT;
  dependencies[0].dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT |
                                  VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                  VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[1].srcSubpass = 0;
  dependencies[1].dstSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[1].srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  dependencies[1].srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  dependencies[1].dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
  dependencies[1].dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;

  VkRenderPassCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
  info.attachmentCount = 3;
  info.pAttachments = attachments;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = 2;
  info.pDependencies = dependencies;
  VKMESH_VK(device_.functions.vkCreateRenderPass(device_.handle, &info, nullptr, &render_pass_),
            "making the render pass");
  return {};
}

Result<void> DrawPipelines::make_layout() {
  constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  const VkDescriptorSetLayoutBinding view{0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, kStages, nullptr};
  const VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, nullptr, 0,
                                            1, &view};
  VKMESH_VK(device_.functions.vkCreateDescriptorSetLayout(device_.handle, &set, nullptr, &set_layout_),
            "making the layout of drawing");
  const VkPushConstantRange range{kStages, 0, sizeof(kernels::DrawParams)};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout_;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  VKMESH_VK(device_.functions.vkCreatePipelineLayout(device_.handle, &layout, nullptr, &layout_),
            "making the layout of drawing");
  return {};
}

Result<VkPipeline> DrawPipelines::pipeline(const DrawPipelineKey& key) {
  const std::lock_guard lock(mutex_);
  // The place in the map comes first, so that a made pipeline cannot be lost to an allocation that fails.
  const auto [place, inserted] = pipelines_.try_emplace(key, VkPipeline{VK_NULL_HANDLE});
  if (place->second == VK_NULL_HANDLE) VKMESH_CHECK(make_pipeline(key, place->second));
  return place->second;
}

Result<void> DrawPipelines::make_pipeline(const DrawPipelineKey& key, VkPipeline& pipeline) const {
  const VkVertexInputBindingDescription bindings[] = {{0, 12, VK_VERTEX_INPUT_RATE_VERTEX},
                                                      {1, 12, VK_VERTEX_INPUT_RATE_VERTEX},
                                                      {2, 4, VK_VERTEX_INPUT_RATE_VERTEX}};
  const VkVertexInputAttributeDescription attributes[] = {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0},
                                                          {1, 1, VK_FORMAT_R32G32B32_SFLOAT, 0},
                                                          {2, 2, VK_FORMAT_R32_UINT, 0}};
  VkPipelineInputAssemblyStateCreateInfo assembly{};
  assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{};
  viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo rasterization{};
  rasterization.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
  rasterization.polygonMode = VK_POLYGON_MODE_FILL;
  rasterization.cullMode = VK_CULL_MODE_NONE;
  rasterization.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  rasterization.lineWidth = 1.0f;
  // Depth runs from 1 at the near plane to 0 at the far one, where floating point is finest.
  VkPipelineDepthStencilStateCreateInfo depth{};
  depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
  depth.depthTestEnable = VK_TRUE;
  depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER;
  VkPipelineColorBlendAttachmentState blend{};
  blend.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                         VK_COLOR_COMPONENT_A_BIT;
  VkPipelineColorBlendStateCreateInfo blending{};
  blending.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
  blending.attachmentCount = 1;
  blending.pAttachments = &blend;
  const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{};
  dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = dynamic_states;

  Modules modules(device_);
  const ShaderPair shaders = shaders_of(key.shaders);
  const std::uint32_t constants[] = {key.color_source, key.edges, key.show_flipped};
  const VkSpecializationMapEntry entries[] = {{0, 0, 4}, {1, 4, 4}, {2, 8, 4}};
  const VkSpecializationInfo specialization{3, entries, sizeof constants, constants};
  VkPipelineShaderStageCreateInfo stages[2]{};
  for (VkPipelineShaderStageCreateInfo& stage : stages) {
    stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stage.pName = "main";
    stage.pSpecializationInfo = &specialization;
  }
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  VKMESH_TRY(stages[0].module, modules.make(shaders.vertex));
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  VKMESH_TRY(stages[1].module, modules.make(shaders.fragment));
  VkPipelineVertexInputStateCreateInfo input{};
  input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
  if (key.shaders == DrawShaders::kIndexed) {
    input.vertexBindingDescriptionCount = 3;
    input.pVertexBindingDescriptions = bindings;
    input.vertexAttributeDescriptionCount = 3;
    input.pVertexAttributeDescriptions = attributes;
  }
  VkPipelineMultisampleStateCreateInfo samples{};
  samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
  samples.rasterizationSamples = kSamples;
  // Dots and bare edges say by alpha how much of a pixel they cover.
  samples.alphaToCoverageEnable =
      key.shaders == DrawShaders::kPoints || key.edges == VKMESH_EDGES_ONLY ? VK_TRUE : VK_FALSE;

  VkGraphicsPipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &rasterization;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blending;
  info.pDynamicState = &dynamic;
  info.layout = layout_;
  info.renderPass = render_pass_;
  VKMESH_VK(device_.functions.vkCreateGraphicsPipelines(device_.handle, VK_NULL_HANDLE, 1, &info, nullptr,
                                                        &pipeline),
            "making a drawing pipeline");
  return {};
}

}  // namespace vkmesh::detail
