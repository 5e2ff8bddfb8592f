// Runs the twin passes: decoders, lookups and ray casting on the GPU through the includes that draw.
#pragma once

#include <cstring>
#include <map>
#include <vector>

#include "client/render/device_choice.h"
#include "client/render/frame_constants.h"
#include "client/render/pipelines.h"
#include "client/render/twin_layout.h"
#include "tests/client/render/device_test.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {

class GpuTwin : public DeviceTest {
  protected:
    void SetUp() override {
        DeviceTest::SetUp();
        if (HasFatalFailure()) return;
        pool_ = create_slot_pool(device_, 64 << 20);
    }

    void TearDown() override {
        destroy_slot_pool(pool_);
        for (auto& [code, pass] : passes_) destroy_pass(device_, pass);
        for (Buffer& buffer : buffers_) destroy_buffer(device_, buffer);
        DeviceTest::TearDown();
    }

    // Uploads words so that they lie in slots out of order, or in one piece: both ways of reading are tested.
    LayerId upload_words(std::span<const uint32_t> words, bool scattered) {
        const LayerId layer = create_layer(pool_);
        constexpr size_t kSlotWords = kSlotBytes / 4;
        for (size_t at = 0; at < words.size(); at += kSlotWords) {
            const size_t count = std::min(kSlotWords, words.size() - at);
            EXPECT_TRUE(append_words(pool_, layer, words.subspan(at, count)).ok());
            if (!scattered) continue;
            EXPECT_TRUE(append_words(pool_, create_layer(pool_), words.first(1)).ok());
        }
        return layer;
    }

    /// Layers and buffers of earlier runs: their memory is given back.
    void forget_layers() {
        for (LayerId layer = 0; layer < pool_.layers.size(); ++layer) {
            if (is_live(pool_, layer)) destroy_layer(pool_, layer);
        }
        for (Buffer& buffer : buffers_) destroy_buffer(device_, buffer);
        buffers_.clear();
    }

    Buffer& host_buffer(uint64_t bytes) {
        return buffers_.emplace_back(create_buffer(device_, std::max<uint64_t>(bytes, 4), BufferPlace::kReadback));
    }

    // Runs a twin pass over `layer`; returns count * words_each words.
    std::vector<uint32_t> run(std::span<const uint32_t> code, LayerId layer, const TwinConstants& constants,
                              uint32_t words_each, std::span<const uint32_t> input = {}) {
        const SlotLayer& slots = pool_.layers[layer];
        if (is_contiguous(pool_, slots))
            return run_at(code, slot_address(pool_, slots.slots[0]) | LAYER_REF_DIRECT, constants, words_each, input);
        const Buffer pages = host_buffer(8 * slots.slots.size());
        for (size_t i = 0; i < slots.slots.size(); ++i) {
            const VkDeviceAddress address = slot_address(pool_, slots.slots[i]);
            std::memcpy(static_cast<std::byte*>(pages.mapped) + 8 * i, &address, 8);
        }
        return run_at(code, pages.address, constants, words_each, input);
    }

    // The same with a layer's reference (draw_layout.h).
    std::vector<uint32_t> run_at(std::span<const uint32_t> code, VkDeviceAddress reference, TwinConstants constants,
                                 uint32_t words_each, std::span<const uint32_t> input) {
        const Buffer in = host_buffer(input.size_bytes());
        if (!input.empty()) std::memcpy(in.mapped, input.data(), input.size_bytes());
        const Buffer out = host_buffer(uint64_t{4} * constants.count * words_each);
        std::memcpy(constants.layer, &reference, 8);
        std::memcpy(constants.input_words, &in.address, 8);
        std::memcpy(constants.output_words, &out.address, 8);
        // Compiling takes longer than running.
        Pass& pass = passes_[code.data()];
        if (pass.handle == VK_NULL_HANDLE) pass = create_compute_pass(device_, code, sizeof constants);
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass.handle);
            vkCmdPushConstants(commands, pass.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
            vkCmdDispatch(commands, (constants.count + TWIN_GROUP - 1) / TWIN_GROUP, 1, 1);
            memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                           VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        });
        const auto* words = static_cast<const uint32_t*>(out.mapped);
        return {words, words + size_t{constants.count} * words_each};
    }

    SlotPool pool_;
    std::vector<Buffer> buffers_;
    std::map<const uint32_t*, Pass> passes_;
};

}  // namespace citystream::client::test
