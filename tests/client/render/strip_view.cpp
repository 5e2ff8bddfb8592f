#include "tests/client/render/strip_view.h"

#include <array>

#include "client/render/graphics_pipeline.h"
#include "tests/shaders/strip_view.frag.h"
#include "tests/shaders/strip_view.vert.h"

namespace citystream::client {

StripView create_strip_view(const Device& device, uint32_t width, uint32_t height) {
    StripView view;
    view.target = create_frame_target(device, width, height, 1);
    const VkShaderModule vertex = create_shader_module(device, k_strip_view_vert);
    const VkShaderModule fragment = create_shader_module(device, k_strip_view_frag);
    const VkPushConstantRange range{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(StripViewConstants)};
    auto info = vk_struct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &range;
    vk_check(vkCreatePipelineLayout(device.handle, &info, nullptr, &view.pass.layout), "vkCreatePipelineLayout");
    const std::array<VkPipelineShaderStageCreateInfo, 2> stages = {
        shader_stage(VK_SHADER_STAGE_VERTEX_BIT, vertex), shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment)};
    view.pass.handle = create_graphics_pipeline(device, view.target.clear_pass, view.pass.layout, stages, {});
    vkDestroyShaderModule(device.handle, vertex, nullptr);
    vkDestroyShaderModule(device.handle, fragment, nullptr);
    return view;
}

void destroy_strip_view(const Device& device, StripView& view) {
    destroy_pass(device, view.pass);
    destroy_frame_target(device, view.target);
}

void record_strip_view(VkCommandBuffer commands, const StripView& view, const StripViewConstants& constants,
                       const BufferRange& corners, std::span<const StripDraw> draws, bool first) {
    constexpr float kBlack[4] = {0, 0, 0, 1};
    if (first) {
        begin_target(commands, view.target);
    } else {
        barrier_between_passes(commands);
    }
    begin_pass(commands, view.target, first ? view.target.clear_pass : view.target.load_pass, kBlack);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, view.pass.handle);
    vkCmdPushConstants(commands, view.pass.layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof constants, &constants);
    vkCmdBindIndexBuffer(commands, corners.buffer->handle, corners.offset, VK_INDEX_TYPE_UINT32);
    for (const StripDraw& draw : draws) {
        vkCmdDrawIndexed(commands, draw.corners, 1, static_cast<uint32_t>(draw.first_corner),
                         static_cast<int32_t>(draw.first_vertex), 0);
    }
    vkCmdEndRenderPass(commands);
}

void finish_strip_view(VkCommandBuffer commands, const StripView& view) {
    copy_colour(commands, view.target, view.target.readback);
    memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                   VK_ACCESS_HOST_READ_BIT);
}

}  // namespace citystream::client
