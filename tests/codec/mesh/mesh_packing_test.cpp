// Step 0 of a mesh as it travels: differences in whole bytes and back.
#include "codec/mesh/mesh_packing.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "codec/bits/zstd_frame.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_layout.h"
#include "codec/step_wire.h"

namespace citystream::codec::mesh {
namespace {

using Bytes = std::vector<std::byte>;

/// Walls of four corners each, many charts: what a dressed city is made of.
MeshTile walls(uint32_t count, uint32_t charts, uint32_t seed) {
    std::mt19937 random(seed);
    const auto below = [&](uint32_t limit) { return static_cast<int32_t>(random() % limit); };
    MeshTile tile;
    for (uint32_t i = 0; i < count; ++i) {
        const int32_t x = below(200000), y = below(200000), dx = below(20000) - 10000, dy = below(20000) - 10000,
                      top = 3000 + below(30000);
        const auto base = static_cast<uint32_t>(tile.vertices.size());
        const auto dxf = static_cast<float>(dx), dyf = static_cast<float>(dy);
        for (const auto& [far, high] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
            tile.vertices.push_back(
                {{x + far * dx, y + far * dy, high * top}, {dyf, -dxf, 0.25F}, {far * 65536, high * 65536}});
        }
        for (const uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) tile.indices.push_back(base + k);
        const auto chart = static_cast<uint32_t>(below(charts));
        tile.triangle_chart.insert(tile.triangle_chart.end(), {chart, chart});
    }
    return tile;
}

MeshTile one_triangle() {
    MeshTile tile;
    tile.vertices = {
        {{0, 0, 0}, {0, 0, 1}, {0, 0}}, {{1024, 0, 0}, {0, 0, 1}, {65536, 0}}, {{0, 1024, 512}, {0, 0, 1}, {0, 65536}}};
    tile.indices = {0, 1, 2};
    tile.triangle_chart = {0};
    return tile;
}

std::vector<uint32_t> first_step(const MeshTile& tile, float error = 0) {
    return encode_mesh(tile, error)[0].words;
}

TEST(PackMesh, WordsComeBackBitForBit) {
    std::vector<MeshTile> tiles = {MeshTile{}, one_triangle()};
    for (uint32_t i = 0; i < 30; ++i) tiles.push_back(walls(1 + 40 * i, 1 + 7 * i, i));
    for (size_t i = 0; i < tiles.size(); ++i) {
        for (const float error : {0.0F, 0.5F, 30.0F}) {
            const std::vector<uint32_t> words = first_step(tiles[i], error);
            const auto packed = pack_mesh(words);
            ASSERT_TRUE(packed) << i;
            const auto back = unpack_mesh(*packed, words.size());
            ASSERT_TRUE(back.ok()) << i << ": " << back.error().text();
            EXPECT_EQ(*back, words) << i;
        }
    }
}

TEST(PackMesh, WallsTravelInFarFewerBytesThanTheirWords) {
    const std::vector<uint32_t> words = first_step(walls(4000, 900, 7), 1);
    const Bytes packed = encode_step(words), plain = bits::compress_frame(std::as_bytes(std::span(words)));
    EXPECT_LT(2 * packed.size(), plain.size());
}

TEST(PackMesh, TheExampleOfTheFormatIsThis) {
    const auto packed = pack_mesh(first_step(one_triangle()));
    ASSERT_TRUE(packed);
    std::string text;
    for (const std::byte byte : *packed) {
        constexpr const char* kDigits = "0123456789abcdef";
        text += kDigits[std::to_integer<uint32_t>(byte) >> 4];
        text += kDigits[std::to_integer<uint32_t>(byte) & 15U];
    }
    EXPECT_EQ(text,
              "43534d50"
              "03000000"
              "01000000"
              "00000000"
              "00000000"
              "00000000"
              "00000000"
              "02000506"
              "01000000"
              "03000000"
              "01000000"
              "00000100"
              "00000100"
              "00000000"
              "00000000"
              "000000"
              "00"
              "7f7f7f7f7f7f"
              "000000"
              "008000"
              "000000"
              "000080"
              "00201f"
              "000020"
              "000010");
}

TEST(PackMesh, LeavesEverythingElseAsItIs) {
    std::vector<uint32_t> words = first_step(walls(20, 3, 1));
    EXPECT_FALSE(pack_mesh(std::span(words).first(10)));
    for (const size_t word : {size_t{MESH_WORD_MAGIC}, size_t{MESH_WORD_WIDTHS}, size_t{MESH_WORD_NORMALS}}) {
        std::vector<uint32_t> other = words;
        ++other[word];
        EXPECT_FALSE(pack_mesh(other)) << "word " << word;
        const Bytes frame = encode_step(other);
        const auto back = decode_step(frame, 4 * other.size());
        ASSERT_TRUE(back.ok());
        EXPECT_EQ(*back, other) << "word " << word;
    }
    words.push_back(0);
    EXPECT_FALSE(pack_mesh(words));
}

TEST(UnpackMesh, DamagedBytesGiveTheSaidNumberOfWordsOrAnError) {
    std::mt19937 random(5);
    const std::vector<uint32_t> words = first_step(walls(40, 9, 3));
    const Bytes packed = pack_mesh(words).value();
    for (size_t size = 0; size < packed.size(); ++size)
        EXPECT_FALSE(unpack_mesh(std::span(packed).first(size), words.size()).ok()) << size;
    size_t accepted = 0;
    for (int i = 0; i < 20000; ++i) {
        Bytes damaged = packed;
        const size_t at = i % 2 == 0 ? random() % 60 : random() % damaged.size();
        damaged[at] ^= static_cast<std::byte>(1 + random() % 255);
        const auto back = unpack_mesh(damaged, words.size());
        if (!back) continue;
        ++accepted;
        ASSERT_EQ(back->size(), words.size());
    }
    EXPECT_GT(accepted, 0U);
    EXPECT_FALSE(unpack_mesh(packed, words.size() + 1).ok());
    EXPECT_FALSE(unpack_mesh(packed, 0).ok());
}

TEST(DecodeStep, RefusesContentOfAnotherSizeThatIsNotPacked) {
    const std::vector<uint32_t> words(100, 7);
    const Bytes frame = bits::compress_frame(std::as_bytes(std::span(words)));
    EXPECT_TRUE(decode_step(frame, 400).ok());
    for (const size_t wrong : {size_t{0}, size_t{396}, size_t{404}, size_t{1} << 40}) {
        const auto back = decode_step(frame, wrong);
        ASSERT_FALSE(back.ok()) << wrong;
        EXPECT_NE(back.error().text().find("expected"), std::string::npos) << back.error().text();
    }
}

TEST(DecodeStep, RefusesAPackedMeshOfAnotherSize) {
    const std::vector<uint32_t> words = first_step(walls(40, 9, 3));
    const Bytes frame = encode_step(words);
    EXPECT_EQ(decode_step(frame, 4 * words.size()).value(), words);
    EXPECT_FALSE(decode_step(frame, 4 * words.size() + 4).ok());
    EXPECT_FALSE(decode_step(frame, 4 * words.size() - 1).ok());
}

}  // namespace
}  // namespace citystream::codec::mesh
