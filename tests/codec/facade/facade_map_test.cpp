#include "codec/facade/facade_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "codec/facade/facade_layout.h"
#include "tests/codec/damage.h"

namespace citystream::codec::facade {
namespace {

FacadeImage plain(uint32_t width, uint32_t height, int16_t depth = 0, uint8_t material = 0) {
    const size_t texels = size_t{width} * height;
    return {width, height, std::vector<int16_t>(texels, depth), std::vector<uint8_t>(texels, material)};
}

void fill(FacadeImage& image, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, int16_t depth, uint8_t material) {
    for (uint32_t y = y0; y < y1; ++y) {
        for (uint32_t x = x0; x < x1; ++x) {
            image.displacement_mm[size_t{y} * image.width + x] = depth;
            image.material[size_t{y} * image.width + x] = material;
        }
    }
}

FacadeImage windows(uint32_t columns, uint32_t rows) {
    FacadeImage image = plain(columns * 100, rows * 100);
    for (uint32_t r = 0; r < rows; ++r) {
        for (uint32_t c = 0; c < columns; ++c) {
            fill(image, c * 100 + 20, r * 100 + 30, c * 100 + 80, r * 100 + 90, 50, 2);
            fill(image, c * 100 + 26, r * 100 + 36, c * 100 + 74, r * 100 + 84, -150, 1);
        }
    }
    return image;
}

void expect_round_trip(const FacadeImage& image) {
    const auto words = encode_facade_map(image);
    ASSERT_TRUE(words.ok()) << words.error().text();
    const auto back = decode_facade_map(*words);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(*back, image);
}

TEST(FacadeMap, KeepsEveryEntryOfAllShapes) {
    expect_round_trip(plain(1, 1, -32768, 15));
    expect_round_trip(plain(1, 700, 32767, 3));
    expect_round_trip(plain(8192, 1));
    expect_round_trip(windows(5, 7));
    FacadeImage checkers = plain(41, 23);
    for (size_t i = 0; i < checkers.material.size(); ++i) {
        checkers.material[i] = static_cast<uint8_t>((i % 41 + i / 41) % 2);
        checkers.displacement_mm[i] = static_cast<int16_t>(checkers.material[i] * -70);
    }
    expect_round_trip(checkers);
    std::mt19937 random(1);
    FacadeImage noise = plain(97, 61);
    for (size_t i = 0; i < noise.material.size(); ++i) {
        noise.material[i] = static_cast<uint8_t>(random() % 16);
        noise.displacement_mm[i] = static_cast<int16_t>(random());
    }
    expect_round_trip(noise);
}

TEST(FacadeMap, AllDifferentTexelsFitUpToTheLimitOfLabels) {
    FacadeImage image = plain(255, 257);  // 65,535 texels
    for (size_t i = 0; i < image.material.size(); ++i)
        image.displacement_mm[i] = static_cast<int16_t>(static_cast<int>(i) - 32768);
    expect_round_trip(image);
    FacadeImage more = plain(256, 256);
    for (size_t i = 0; i < more.material.size(); ++i)
        more.displacement_mm[i] = static_cast<int16_t>(static_cast<int>(i) - 32768);
    const auto words = encode_facade_map(more);
    ASSERT_FALSE(words.ok());
    EXPECT_NE(words.error().message.find("65536 distinct"), std::string::npos) << words.error().text();
}

TEST(FacadeMap, RefusesImagesItCannotHold) {
    EXPECT_FALSE(encode_facade_map(plain(0, 5)).ok());
    EXPECT_FALSE(encode_facade_map(plain(5, 0)).ok());
    EXPECT_FALSE(encode_facade_map(plain(8193, 1)).ok());
    EXPECT_FALSE(encode_facade_map(plain(2, 2, 0, 16)).ok());
    FacadeImage ragged = plain(3, 3);
    ragged.material.pop_back();
    EXPECT_FALSE(encode_facade_map(ragged).ok());
}

TEST(FacadeMap, CutsOnlyWhereNeighboursDiffer) {
    const auto words = encode_facade_map(windows(3, 2));
    ASSERT_TRUE(words.ok());
    const auto map = FacadeMapView::create(*words);
    ASSERT_TRUE(map.ok()) << map.error().text();
    EXPECT_EQ(map->columns(), 3u * 4 + 1);
    EXPECT_EQ(map->rows(), 2u * 4 + 1);
    EXPECT_EQ(map->width(), 300u);
    EXPECT_EQ(map->height(), 200u);
    EXPECT_EQ(map->x_break(1), 20u);
    EXPECT_EQ(map->y_break(2), 36u);
    EXPECT_EQ(map->x_break(13), 300u);
    EXPECT_EQ(map->depth_min_mm(), -150);
    EXPECT_EQ(map->depth_max_mm(), 50);
    EXPECT_EQ(map->label(2, 2), 0xff6au | 1u << 16);
}

TEST(FacadeMap, GoldenWords) {
    FacadeImage image = plain(3, 2);
    fill(image, 1, 0, 3, 1, -2, 1);
    fill(image, 0, 1, 1, 2, 5, 0);
    const auto words = encode_facade_map(image);
    ASSERT_TRUE(words.ok());
    EXPECT_EQ(*words, (std::vector<uint32_t>{0x31465343u, 0x00020002u, 0x00020003u, 0x0005fffeu, 0x00020003u,
                                             0x000c000au, 15, 0,                     // header
                                             0x00010000u, 0x00000003u,               // x breaks 0 1 3
                                             0x00010000u, 0x00000002u,               // y breaks 0 1 2
                                             0x00000000u, 0x00000005u, 0x0001fffeu,  // labels
                                             0b00'01'10'00u}));                      // cells
}

TEST(FacadeMap, RefusesEveryTruncation) {
    const auto words = encode_facade_map(windows(2, 2));
    ASSERT_TRUE(words.ok());
    for (size_t size = 0; size < words->size(); ++size) {
        EXPECT_FALSE(FacadeMapView::create(exact_copy(std::span(*words).first(size))).ok()) << size;
    }
}

TEST(FacadeMap, NoDamagedWordMakesAnAccessorReadOutside) {
    const auto words = encode_facade_map(windows(1, 2));
    ASSERT_TRUE(words.ok());
    size_t accepted = 0;
    size_t refused = 0;
    for_each_mutation(*words, [&](std::span<const uint32_t> damaged) {
        const auto map = FacadeMapView::create(damaged);
        ++(map.ok() ? accepted : refused);
        if (!map.ok()) return;
        for (uint32_t row = 0; row < map->rows(); ++row) {
            for (uint32_t column = 0; column < map->columns(); ++column) {
                EXPECT_LT(map->label(column, row) >> 16, 16u);
                EXPECT_LT(map->x_break(column), map->x_break(column + 1));
            }
        }
        const double origin[3] = {10, 10, 1000};
        const double direction[3] = {1, 2, -20};
        EXPECT_TRUE(cast_facade_ray(*map, origin, direction).hit);
    });
    EXPECT_GT(accepted, 0u);
    EXPECT_GT(refused, 0u);
}

}  // namespace
}  // namespace citystream::codec::facade
