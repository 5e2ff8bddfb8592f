// Pictures of mesh layers, drawn by the GPU from their words: for tests that look for cracks.
#pragma once

#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "client/render/device_choice.h"
#include "client/render/frame_constants.h"
#include "client/render/graphics_pipeline.h"
#include "client/render/mesh_draws.h"
#include "client/render/pipelines.h"
#include "client/render/twin_layout.h"
#include "codec/mesh/mesh_resident.h"
#include "shaders/twin_mesh_view.frag.h"
#include "shaders/twin_mesh_view.vert.h"

namespace citystream::client::test {

/// A layer to draw, without ranges of strip code.
struct MeshDraw {
    std::span<const uint32_t> words;
    std::span<const codec::mesh::MeshRange> ranges;
    std::array<int64_t, 3> corner{};  ///< of the tile, grid units of the world
    codec::mesh::DropRule rule;
    uint32_t least_dropped = 0;
};

class MeshPicture {
  public:
    MeshPicture(const Device& device, uint32_t width, uint32_t height)
        : device_(device), target_(create_frame_target(device, width, height, 1)) {
        VkPushConstantRange range{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(TwinMeshViewConstants)};
        auto info = vk_struct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
        info.pushConstantRangeCount = 1;
        info.pPushConstantRanges = &range;
        vk_check(vkCreatePipelineLayout(device.handle, &info, nullptr, &pass_.layout), "vkCreatePipelineLayout");
        const std::array<VkShaderModule, 2> modules = {create_shader_module(device, k_twin_mesh_view_vert),
                                                       create_shader_module(device, k_twin_mesh_view_frag)};
        const std::array<VkPipelineShaderStageCreateInfo, 2> stages = {
            shader_stage(VK_SHADER_STAGE_VERTEX_BIT, modules[0]),
            shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, modules[1])};
        pass_.handle = create_graphics_pipeline(device, target_.clear_pass, pass_.layout, stages, {});
        for (VkShaderModule module : modules) vkDestroyShaderModule(device.handle, module, nullptr);
    }
    ~MeshPicture() {
        destroy_pass(device_, pass_);
        destroy_frame_target(device_, target_);
    }
    MeshPicture(const MeshPicture&) = delete;
    MeshPicture& operator=(const MeshPicture&) = delete;

    /// RGBA8, rows from the top; magenta where nothing is drawn.
    std::span<const uint8_t> draw(const Camera& camera, std::span<const MeshDraw> draws) {
        size_t words = 4;
        for (const MeshDraw& one : draws) words += words_of(one);
        Buffer buffer = create_buffer(device_, 4 * words, BufferPlace::kUpload);
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            const float clear[4] = {1, 0, 1, 1};
            begin_target(commands, target_);
            begin_pass(commands, target_, target_.clear_pass, clear);
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.handle);
            size_t used = 0;
            for (const MeshDraw& one : draws) {
                record(commands, camera, one, buffer, used);
                used += 4 * words_of(one);
            }
            vkCmdEndRenderPass(commands);
            copy_colour(commands, target_, target_.readback);
            memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                           VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        });
        destroy_buffer(device_, buffer);
        return {static_cast<const uint8_t*>(target_.readback.mapped), size_t{4} * target_.width * target_.height};
    }

  private:
    /// A layer's, to a multiple of 16 bytes, and those of its ranges.
    static size_t layer_words(const MeshDraw& one) { return (one.words.size() + 3) / 4 * 4; }
    static size_t words_of(const MeshDraw& one) {
        return layer_words(one) + (one.ranges.size() * MESH_DRAW_WORDS + 3) / 4 * 4;
    }

    /// From byte `begin` of the buffer on.
    void record(VkCommandBuffer commands, const Camera& camera, const MeshDraw& one, const Buffer& buffer,
                size_t begin) {
        const CameraCell cell = camera_cell(camera.position);
        TwinMeshViewConstants constants{};
        constants.frame = make_frame_constants(camera, cell);
        auto* const memory = static_cast<std::byte*>(buffer.mapped);
        std::memcpy(memory + begin, one.words.data(), one.words.size_bytes());
        const VkDeviceAddress mesh = (buffer.address + begin) | LAYER_REF_DIRECT;
        std::memcpy(constants.mesh, &mesh, sizeof mesh);
        for (size_t c = 0; c < 3; ++c) constants.from_camera[c] = static_cast<int>(one.corner[c] - cell.cell[c]);
        constants.distance_per_unit = one.rule.distance_per_unit;
        constants.least_dropped = one.least_dropped;
        const std::vector<MeshDrawConstants> records = mesh_draw_constants(one.words);
        const size_t records_at = begin + 4 * layer_words(one);
        std::memcpy(memory + records_at, records.data(), records.size() * sizeof records[0]);
        for (size_t range = 0; range < one.ranges.size(); ++range) {
            const VkDeviceAddress record = buffer.address + records_at + range * sizeof records[0];
            std::memcpy(constants.draw, &record, sizeof record);
            vkCmdPushConstants(commands, pass_.layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof constants, &constants);
            vkCmdDraw(commands, 3 * one.ranges[range].triangles, 1, 0, 0);
        }
    }

    const Device& device_;
    FrameTarget target_;
    Pass pass_;
};

}  // namespace citystream::client::test
