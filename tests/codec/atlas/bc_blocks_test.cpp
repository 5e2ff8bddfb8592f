// The block decoders of codec/atlas against shaders/bc_blocks.glsl, bit for bit.
#include <gtest/gtest.h>

#include <random>

#include "codec/atlas/bc1.h"
#include "codec/atlas/bc4.h"
#include "tests/shaders/bc_blocks_on_cpu.h"

namespace citystream::codec::atlas {
namespace {

constexpr int kBlocks = 1000000;

TEST(BcBlocks, Bc1ShaderShowsTheDecodersTexelsOfAMillionRandomBlocks) {
    std::mt19937 random(1);
    for (int round = 0; round < kBlocks; ++round) {
        const uint32_t block[2] = {static_cast<uint32_t>(random()), static_cast<uint32_t>(random())};
        const auto i = static_cast<uint32_t>(random() % 16);
        uint8_t rgb[3];
        decode_bc1_texel(block, i, rgb);
        const auto shown = shaders_test::bc1_texel_on_cpu(block, i);
        for (size_t c = 0; c < 3; ++c) ASSERT_EQ(shown[c], rgb[c]) << block[0] << " " << block[1] << " " << i;
    }
}

TEST(BcBlocks, Bc4ShaderShowsTheDecodersTexelsOfEveryPairOfEndsAndEveryCode) {
    std::mt19937 random(3);
    for (uint32_t ends = 0; ends < 65536; ++ends) {
        uint64_t bits = ends;
        for (uint32_t i = 0; i < 16; ++i) bits |= uint64_t{(i + ends) % 8} << (16 + 3 * i);
        const uint32_t block[2] = {static_cast<uint32_t>(bits), static_cast<uint32_t>(bits >> 32)};
        for (uint32_t i = 0; i < 16; ++i)
            ASSERT_EQ(shaders_test::bc4_texel_on_cpu(block, i), decode_bc4_texel(block, i)) << ends << " " << i;
    }
}

TEST(BcBlocks, Bc3ShaderShowsTheDecodersTexelsOfAMillionRandomBlocks) {
    std::mt19937 random(4);
    for (int round = 0; round < kBlocks; ++round) {
        uint32_t block[4];
        for (uint32_t& word : block) word = static_cast<uint32_t>(random());
        const auto i = static_cast<uint32_t>(random() % 16);
        uint8_t rgba[4];
        decode_bc1_texel(block + 2, i, rgba);
        rgba[3] = decode_bc4_texel(block, i);
        const auto shown = shaders_test::bc3_texel_on_cpu(block, i);
        for (size_t c = 0; c < 4; ++c) ASSERT_EQ(shown[c], rgba[c]) << round << " " << i;
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
