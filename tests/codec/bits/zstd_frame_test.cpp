#include "codec/bits/zstd_frame.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <random>

namespace citystream::codec::bits {
namespace {

std::vector<std::byte> sample_bytes(size_t count) {
    std::mt19937 random(7);
    std::vector<std::byte> bytes(count);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % 5);
    return bytes;
}

TEST(ZstdFrame, GivesBackWhatItWasGiven) {
    for (const size_t count : {0u, 1u, 1000u, 300000u}) {
        const std::vector<std::byte> raw = sample_bytes(count);
        const std::vector<std::byte> frame = compress_frame(raw);
        const auto back = decompress_frame(frame, raw.size());
        ASSERT_TRUE(back.ok()) << back.error().text();
        EXPECT_EQ(*back, raw);
        EXPECT_EQ(frame, compress_frame(raw)) << "the same bytes each time";
    }
}

TEST(ZstdFrame, RefusesAnotherSizeThanTheDirectorySaid) {
    const std::vector<std::byte> frame = compress_frame(sample_bytes(100));
    EXPECT_FALSE(decompress_frame(frame, 99).ok());
    EXPECT_FALSE(decompress_frame(frame, 101).ok());
    EXPECT_FALSE(decompress_frame(frame, 0).ok());
    EXPECT_FALSE(decompress_frame(frame, ~size_t{0}).ok());
}

TEST(ZstdFrame, RefusesEveryTruncationAndFollowingBytes) {
    const std::vector<std::byte> frame = compress_frame(sample_bytes(500));
    for (size_t size = 0; size < frame.size(); ++size) {
        EXPECT_FALSE(decompress_frame(
                         std::vector<std::byte>(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size)), 500)
                         .ok())
            << size;
    }
    std::vector<std::byte> longer = frame;
    longer.push_back(std::byte{0});
    const auto result = decompress_frame(longer, 500);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().offset, frame.size());
    longer = frame;
    longer.insert(longer.end(), frame.begin(), frame.end());
    EXPECT_FALSE(decompress_frame(longer, 500).ok()) << "two frames are not one";
}

TEST(ZstdFrame, NoticesEveryFlippedBitOfTheContent) {
    const std::vector<std::byte> raw = sample_bytes(500);
    const std::vector<std::byte> frame = compress_frame(raw);
    for (size_t bit = 0; bit < 8 * frame.size(); ++bit) {
        std::vector<std::byte> damaged = frame;
        damaged[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
        const auto back = decompress_frame(damaged, raw.size());
        // A few header bits (the window size, say) may flip without any effect on the content.
        if (back.ok()) {
            EXPECT_EQ(*back, raw) << "bit " << bit;
        }
    }
}

TEST(ZstdFrame, RefusesFramesWithoutChecksumOrSize) {
    const std::vector<std::byte> raw = sample_bytes(500);
    for (const ZSTD_cParameter flag : {ZSTD_c_checksumFlag, ZSTD_c_contentSizeFlag}) {
        ZSTD_CCtx* context = ZSTD_createCCtx();
        ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
        ZSTD_CCtx_setParameter(context, flag, 0);
        std::vector<std::byte> frame(ZSTD_compressBound(raw.size()));
        frame.resize(ZSTD_compress2(context, frame.data(), frame.size(), raw.data(), raw.size()));
        ZSTD_freeCCtx(context);
        EXPECT_FALSE(decompress_frame(frame, raw.size()).ok());
    }
}

TEST(ZstdFrame, RefusesASmallFrameThatClaimsMoreThanItsBlocksHoldBeforeAllocating) {
    // Single segment, 8-byte content size of 2^40, checksum; one empty last block; checksum of nothing.
    std::vector<std::byte> frame;
    for (const int byte : {0x28, 0xb5, 0x2f, 0xfd, 0xe4, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0x99, 0xe9, 0xd8, 0x51}) {
        frame.push_back(static_cast<std::byte>(byte));
    }
    const auto result = decompress_frame(frame, size_t{1} << 40);
    ASSERT_FALSE(result.ok());
    EXPECT_NE(result.error().message.find("than its blocks can hold"), std::string::npos) << result.error().text();
}

TEST(ZstdFrame, RefusesSkippableFrames) {
    std::vector<std::byte> frame(8, std::byte{0});
    frame[0] = std::byte{0x50};
    frame[1] = std::byte{0x2a};
    frame[2] = std::byte{0x4d};
    frame[3] = std::byte{0x18};
    EXPECT_FALSE(decompress_frame(frame, 0).ok());
}

}  // namespace
}  // namespace citystream::codec::bits
