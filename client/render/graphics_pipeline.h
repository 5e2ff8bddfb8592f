// The state that all drawing pipelines have in common: triangle lists, both sides, one sample, depth that grows towards
// the camera, no blending, viewport and scissor set while drawing.
#pragma once

#include <cstdint>
#include <span>

#include "client/render/frame_target.h"

namespace citystream::client {

/// What a drawing pass writes, and where; all test depth.
struct PassWrites {
    bool colour = true, depth = true;
    bool over_nothing = false;  ///< drawn where the depth is at most that of what is drawn, not where it is less
};

/// Vertices are pulled from layers.
inline constexpr VkPipelineVertexInputStateCreateInfo kNoAttributes = {
    VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO, nullptr, 0, 0, nullptr, 0, nullptr};

/// Of SPIR-V. The caller destroys it, once the pipelines are made.
VkShaderModule create_shader_module(const Device& device, std::span<const uint32_t> code);
/// `constants` (may be null) outlives the pipeline's making.
VkPipelineShaderStageCreateInfo shader_stage(VkShaderStageFlagBits stage, VkShaderModule module,
                                             const VkSpecializationInfo* constants = nullptr);
VkPipeline create_graphics_pipeline(const Device& device, VkRenderPass pass, VkPipelineLayout layout,
                                    std::span<const VkPipelineShaderStageCreateInfo> stages, PassWrites writes,
                                    const VkPipelineVertexInputStateCreateInfo& vertex_input = kNoAttributes);

}  // namespace citystream::client
