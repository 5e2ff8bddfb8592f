// Pictures of precision buffers, drawn by the GPU from the packed words: for tests and benches that look at what
// dropped bits do.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "client/render/device_choice.h"
#include "client/render/frame_constants.h"
#include "client/render/graphics_pipeline.h"
#include "client/render/pipelines.h"
#include "client/render/twin_layout.h"
#include "codec/mesh/binned_buffer.h"
#include "shaders/twin_precision_view.frag.h"
#include "shaders/twin_precision_view.vert.h"

namespace citystream::client::test {

/// A buffer to draw, at grid coordinates of the world.
struct PrecisionDraw {
    std::span<const uint32_t> words;  ///< of a buffer of three components
    const codec::mesh::PrecisionGrid* grid = nullptr;
    std::span<const float> normals;     ///< three a vertex, in the buffer's order
    std::span<const uint32_t> indices;  ///< likewise
    codec::mesh::DropRule rule;
};

/// Colour that nothing is drawn in: shading is grey.
inline constexpr std::array<uint8_t, 3> kNothingDrawn = {255, 0, 255};

class PrecisionPicture {
  public:
    /// Pixels are means of samples x samples.
    PrecisionPicture(const Device& device, uint32_t width, uint32_t height, uint32_t samples = 1)
        : device_(device),
          samples_(samples),
          target_(create_frame_target(device, width * samples, height * samples, 1)) {
        VkPushConstantRange range{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                  sizeof(TwinViewConstants)};
        auto info = vk_struct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
        info.pushConstantRangeCount = 1;
        info.pPushConstantRanges = &range;
        vk_check(vkCreatePipelineLayout(device.handle, &info, nullptr, &pass_.layout), "vkCreatePipelineLayout");
        const std::array<VkShaderModule, 2> modules = {create_shader_module(device, k_twin_precision_view_vert),
                                                       create_shader_module(device, k_twin_precision_view_frag)};
        const std::array<VkPipelineShaderStageCreateInfo, 2> stages = {
            shader_stage(VK_SHADER_STAGE_VERTEX_BIT, modules[0]),
            shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, modules[1])};
        pass_.handle = create_graphics_pipeline(device, target_.clear_pass, pass_.layout, stages, {});
        for (VkShaderModule module : modules) vkDestroyShaderModule(device.handle, module, nullptr);
    }
    ~PrecisionPicture() {
        destroy_pass(device_, pass_);
        destroy_frame_target(device_, target_);
    }
    PrecisionPicture(const PrecisionPicture&) = delete;
    PrecisionPicture& operator=(const PrecisionPicture&) = delete;

    /// RGBA8, rows from the top. World coordinates of buffers are below 2^30 grid units.
    std::vector<uint8_t> draw(const Camera& camera, std::span<const PrecisionDraw> draws, float shininess) {
        const CameraCell cell = camera_cell(camera.position);
        size_t bytes_to_read = 16;
        for (const PrecisionDraw& one : draws) {
            bytes_to_read += Arena::padded(one.words.size_bytes()) + Arena::padded(one.normals.size_bytes()) +
                             Arena::padded(one.indices.size_bytes());
        }
        Arena arena{create_buffer(device_, bytes_to_read, BufferPlace::kUpload)};
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            const float clear[4] = {1, 0, 1, 1};
            begin_target(commands, target_);
            begin_pass(commands, target_, target_.clear_pass, clear);
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.handle);
            for (const PrecisionDraw& one : draws) record(commands, camera, cell, one, shininess, arena);
            vkCmdEndRenderPass(commands);
            copy_colour(commands, target_, target_.readback);
            memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                           VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        });
        destroy_buffer(device_, arena.buffer);
        const auto* bytes = static_cast<const uint8_t*>(target_.readback.mapped);
        return mean_of_samples({bytes, size_t{4} * target_.width * target_.height});
    }

  private:
    std::vector<uint8_t> mean_of_samples(std::span<const uint8_t> rgba) const {
        std::vector<uint8_t> mean;
        const size_t row = size_t{4} * target_.width, count = size_t{samples_} * samples_;
        for (size_t y = 0; y < target_.height; y += samples_) {
            for (size_t x = 0; x < row; x += size_t{4} * samples_) {
                for (size_t c = 0; c < 4; ++c) {
                    size_t sum = count / 2;
                    for (size_t i = 0; i < count; ++i) sum += rgba[(y + i / samples_) * row + x + i % samples_ * 4 + c];
                    mean.push_back(static_cast<uint8_t>(sum / count));
                }
            }
        }
        return mean;
    }

    /// What a draw reads, one part after the other in one buffer: allocations are slow.
    struct Arena {
        Buffer buffer;
        size_t used = 0;
        static size_t padded(size_t bytes) { return (bytes + 15) / 16 * 16; }
        size_t append(std::span<const std::byte> bytes) {
            std::memcpy(static_cast<std::byte*>(buffer.mapped) + used, bytes.data(), bytes.size());
            const size_t at = used;
            used += padded(bytes.size());
            return at;
        }
    };

    void record(VkCommandBuffer commands, const Camera& camera, const CameraCell& cell, const PrecisionDraw& one,
                float shininess, Arena& arena) {
        TwinViewConstants constants{};
        constants.frame = make_frame_constants(camera, cell);
        const VkDeviceAddress words =
            (arena.buffer.address + arena.append(std::as_bytes(one.words))) | LAYER_REF_DIRECT;
        const VkDeviceAddress normals = arena.buffer.address + arena.append(std::as_bytes(one.normals));
        std::memcpy(constants.buffer_words, &words, sizeof words);
        std::memcpy(constants.normals, &normals, sizeof normals);
        for (size_t c = 0; c < 3; ++c) {
            constants.from_camera[c] = static_cast<int>(one.grid->origin[c] - cell.cell[c]);
        }
        constants.common_dropped = one.rule.common_dropped;
        constants.distance_per_unit = one.rule.distance_per_unit;
        constants.reading = static_cast<uint32_t>(one.grid->reading);
        constants.shininess = shininess;
        vkCmdPushConstants(commands, pass_.layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                           sizeof constants, &constants);
        vkCmdBindIndexBuffer(commands, arena.buffer.handle, arena.append(std::as_bytes(one.indices)),
                             VK_INDEX_TYPE_UINT32);
        vkCmdDrawIndexed(commands, static_cast<uint32_t>(one.indices.size()), 1, 0, 0, 0);
    }

    const Device& device_;
    uint32_t samples_;
    FrameTarget target_;
    Pass pass_;
};

inline size_t pixels_of_nothing(std::span<const uint8_t> rgba) {
    size_t count = 0;
    for (size_t i = 0; i + 3 < rgba.size(); i += 4)
        count += std::equal(kNothingDrawn.begin(), kNothingDrawn.end(), rgba.begin() + static_cast<std::ptrdiff_t>(i));
    return count;
}

/// Peak signal-to-noise ratio of 8-bit pictures, decibels; 99 for equal ones.
inline double psnr(std::span<const uint8_t> a, std::span<const uint8_t> b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        const double d = static_cast<double>(a[i]) - b[i];
        if (i % 4 != 3) sum += d * d;
    }
    if (sum == 0) return 99;
    return 10 * std::log10(255.0 * 255.0 * (static_cast<double>(a.size()) * 3 / 4) / sum);
}

}  // namespace citystream::client::test
