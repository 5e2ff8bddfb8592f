// Unit vectors where they are used (Meyer 2012, sections 4.8.7 and 4.10): decoded in the vertex shader from vertices of
// 64 bits, and written and read as texels of a G-buffer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "client/render/device_choice.h"
#include "client/render/graphics_pipeline.h"
#include "client/render/normal_draw_layout.h"
#include "codec/mesh/octahedral.h"
#include "shaders/twin_normal.frag.h"
#include "shaders/twin_normal.vert.h"
#include "tests/client/render/device_test.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

namespace mesh = codec::mesh;

constexpr uint32_t kHeight = 256, kWidth = 2 * kHeight;
using Pixels = std::vector<std::array<uint8_t, 4>>;

class NormalDrawing : public DeviceTest {
  protected:
    void SetUp() override {
        DeviceTest::SetUp();
        if (HasFatalFailure()) return;
        target_ = create_frame_target(device_, kWidth, kHeight, 1);
        create_pipeline();
    }

    void TearDown() override {
        vkDestroyPipeline(device_.handle, pipeline_, nullptr);
        vkDestroyPipelineLayout(device_.handle, layout_, nullptr);
        destroy_frame_target(device_, target_);
        DeviceTest::TearDown();
    }

    Pixels draw(NormalDraw constants, const std::vector<uint32_t>& words, uint32_t vertices) {
        Buffer buffer = create_buffer(device_, 4 * std::max<size_t>(words.size(), 1), BufferPlace::kUpload);
        if (!words.empty()) std::memcpy(buffer.mapped, words.data(), 4 * words.size());
        std::memcpy(constants.vertices, &buffer.address, 8);
        constants.height = kHeight;
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            constexpr float kNothing[4] = {0, 0, 0, 0};
            begin_target(commands, target_);
            begin_pass(commands, target_, target_.clear_pass, kNothing);
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
            vkCmdPushConstants(commands, layout_, kStages, 0, sizeof constants, &constants);
            vkCmdDraw(commands, vertices, 1, 0, 0);
            vkCmdEndRenderPass(commands);
            copy_colour(commands, target_, target_.readback);
            memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                           VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        });
        destroy_buffer(device_, buffer);
        Pixels pixels(size_t{kWidth} * kHeight);
        std::memcpy(pixels.data(), target_.readback.mapped, 4 * pixels.size());
        return pixels;
    }

    /// All directions, as a G-buffer of RG or RGBA bytes.
    Pixels g_buffer(uint32_t bits, bool nearest) {
        return draw({{}, NORMAL_DRAW_EXACT, bits, nearest ? 1U : 0U, 0}, {}, 3);
    }

    static constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

  private:
    void create_pipeline() {
        const VkPushConstantRange range{kStages, 0, sizeof(NormalDraw)};
        auto info = vk_struct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
        info.pushConstantRangeCount = 1;
        info.pPushConstantRanges = &range;
        vk_check(vkCreatePipelineLayout(device_.handle, &info, nullptr, &layout_), "vkCreatePipelineLayout");
        const VkShaderModule modules[2] = {create_shader_module(device_, k_twin_normal_vert),
                                           create_shader_module(device_, k_twin_normal_frag)};
        const VkPipelineShaderStageCreateInfo stages[2] = {shader_stage(VK_SHADER_STAGE_VERTEX_BIT, modules[0]),
                                                           shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, modules[1])};
        pipeline_ = create_graphics_pipeline(device_, target_.clear_pass, layout_, stages, {});
        for (VkShaderModule module : modules) vkDestroyShaderModule(device_.handle, module, nullptr);
    }

    FrameTarget target_;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

struct Texels {
    double largest = 0, mean = 0;  ///< angles
    size_t count = 0;
};

/// Texels of the G-buffer decoded by the codec against the directions that were drawn.
Texels texel_errors(const Pixels& pixels, uint32_t bits) {
    Texels result;
    for (uint32_t y = 0; y < kHeight; ++y) {
        for (uint32_t x = 0; x < kWidth; ++x) {
            const double u = (x % kHeight + 0.5) / kHeight * 2 - 1, v = (y + 0.5) / kHeight * 2 - 1;
            const double square = 1 - u * u - v * v;
            if (square < 1e-3) continue;  // at the rim the shader's float of the square is too coarse
            const auto& [r, g, b, a] = pixels[size_t{y} * kWidth + x];
            const uint64_t code = bits > 8 ? r | g << 8 | uint64_t{b} << 16 | uint64_t{a} << 24 : r | uint64_t{g} << 8;
            const mesh::Direction n = {u, v, x < kHeight ? std::sqrt(square) : -std::sqrt(square)};
            const double error = mesh::angle_between(mesh::unpack_octahedral(code, bits), n);
            result.largest = std::max(result.largest, error);
            result.mean += error;
            ++result.count;
        }
    }
    result.mean /= static_cast<double>(result.count);
    return result;
}

TEST_F(NormalDrawing, GBuffersOfTwoAndFourBytesAPixelKeepTheOctahedronsBounds) {
    for (const uint32_t bits : {8U, 16U}) {
        const double step = 2 / (2.0 * mesh::octahedral_side(bits));
        const Texels rounded = texel_errors(g_buffer(bits, false), bits);
        const Texels nearest = texel_errors(g_buffer(bits, true), bits);
        EXPECT_GT(rounded.count, 100'000U);
        EXPECT_LT(rounded.largest, std::sqrt(18.0) / 2 * step * 1.005 + 1e-5) << bits;
        EXPECT_LT(nearest.largest, std::numbers::sqrt2 * step * 1.005 + 1e-5) << bits;
        EXPECT_LT(nearest.mean, rounded.mean) << bits;
        EXPECT_GT(rounded.largest, std::numbers::sqrt2 * step) << bits << ": the fast way is the coarser one";
    }
}

struct SphereVertex {
    mesh::Direction position = {}, normal = {};
};

/// Triangles of a wavy unit sphere, three vertices each.
std::vector<SphereVertex> sphere_triangles() {
    constexpr int kRings = 60, kSectors = 120;
    const auto vertex = [](int ring, int sector) {
        const double polar = std::numbers::pi * ring / kRings, longitude = 2 * std::numbers::pi * sector / kSectors;
        const mesh::Direction n = {std::sin(polar) * std::cos(longitude), std::sin(polar) * std::sin(longitude),
                                   std::cos(polar)};
        const mesh::Direction position = {n[0] * 0.99, n[1] * 0.99, n[2] * 0.99};
        return SphereVertex{position, mesh::unit_direction({n[0] + 0.1 * std::sin(9 * n[1]), n[1], n[2]})};
    };
    std::vector<SphereVertex> vertices;
    for (int ring = 0; ring < kRings; ++ring) {
        for (int sector = 0; sector < kSectors; ++sector) {
            for (const auto& [r, s] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
                vertices.push_back(vertex(ring + r, sector + s));
        }
    }
    return vertices;
}

std::vector<uint32_t> float_words(const std::vector<SphereVertex>& vertices) {
    std::vector<uint32_t> words;
    for (const SphereVertex& v : vertices) {
        for (const double c : v.position) words.push_back(std::bit_cast<uint32_t>(static_cast<float>(c)));
        for (const double c : v.normal) words.push_back(std::bit_cast<uint32_t>(static_cast<float>(c)));
    }
    return words;
}

std::vector<uint32_t> packed_words(const std::vector<SphereVertex>& vertices) {
    std::vector<uint32_t> words;
    for (const SphereVertex& v : vertices) {
        const auto quantised = [&](size_t axis) {
            return static_cast<uint32_t>(std::lround((v.position[axis] + 1) / 2 * 65535));
        };
        words.push_back(quantised(0) | quantised(1) << 16);
        words.push_back(quantised(2) | static_cast<uint32_t>(mesh::pack_octahedral(v.normal, 8)) << 16);
    }
    return words;
}

double psnr(const Pixels& a, const Pixels& b) {
    double squares = 0;
    for (size_t i = 0; i < a.size(); ++i) squares += (a[i][0] - b[i][0]) * (a[i][0] - b[i][0]);
    return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.size()) / squares);
}

TEST_F(NormalDrawing, VerticesOfSixtyFourBitsLookLikeThoseOfAHundredAndNinetyTwo) {
    const std::vector<SphereVertex> vertices = sphere_triangles();
    const std::vector<uint32_t> floats = float_words(vertices), packed = packed_words(vertices);
    ASSERT_EQ(floats.size(), 3 * packed.size());
    const auto count = static_cast<uint32_t>(vertices.size());
    const Pixels reference = draw({{}, NORMAL_DRAW_FLOATS, NORMAL_DRAW_LIGHT, 0, 0}, floats, count);
    const Pixels shown = draw({{}, NORMAL_DRAW_PACKED, NORMAL_DRAW_LIGHT, 0, 0}, packed, count);
    const auto drawn = std::ranges::count_if(reference, [](const auto& pixel) { return pixel[3] != 0; });
    EXPECT_GT(drawn, kHeight * kHeight / 2);
    EXPECT_GT(psnr(reference, shown), 42);
}

}  // namespace
}  // namespace citystream::client::test
