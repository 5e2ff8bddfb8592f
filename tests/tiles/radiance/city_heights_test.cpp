#include "tiles/radiance/city_heights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <thread>

#include "tests/tiles/radiance/box_city.h"

namespace citystream::tiles::radiance {
namespace {

using test::at;
using test::Surface;

constexpr HeightCell kLow = {-200, -150}, kHigh = {220, 190};

/// Small and large triangles, level and sloped ones, upright ones and some without area, over several blocks.
Surface noise(uint32_t seed, size_t count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-2500, 2500), size(-3, 3), height(-20, 120);
    Surface surface;
    for (size_t i = 0; i < count; ++i) {
        const double x = place(random), y = place(random), z = height(random), reach = i % 7 == 0 ? 600 : 4;
        const auto corner = [&] {
            return at(x + reach * size(random), y + reach * size(random), i % 3 == 0 ? z : z + 5 * size(random));
        };
        surface.push_back({{corner(), corner(), corner()}});
        if (i % 11 == 0) surface.back().corners[2] = surface.back().corners[1];
    }
    return surface;
}

void expect_same(const HeightGrid& a, const HeightGrid& b) {
    size_t told = 0;
    for (int64_t y = kLow.y; y <= kHigh.y; ++y) {
        for (int64_t x = kLow.x; x <= kHigh.x; ++x) {
            ASSERT_EQ(a.height({x, y}), b.height({x, y})) << x << " " << y;
            told += a.height({x, y}) ? 1 : 0;
        }
    }
    EXPECT_GT(told, 1000U);
}

TEST(CityHeights, AreThoseOfOneGridOverEverything) {
    const Surface surface = noise(1, 500);
    HeightGrid whole(kLow, kHigh, to_grid(-100));
    whole.add(surface);
    CityHeights heights(to_grid(-100));
    heights.add(surface);
    expect_same(heights.part(kLow, kHigh), whole);
}

TEST(CityHeights, DoNotDependOnTheOrderNorOnWhoAdds) {
    Surface surface = noise(2, 400);
    CityHeights one(to_grid(-100)), other(to_grid(-100));
    one.add(surface);
    std::reverse(surface.begin(), surface.end());
    {
        std::vector<std::jthread> threads;
        for (size_t i = 0; i < 4; ++i)
            threads.emplace_back([&, i] { other.add(std::span(surface).subspan(i * 100, 100)); });
    }
    expect_same(one.part(kLow, kHigh), other.part(kLow, kHigh));
}

TEST(CityHeights, APartIsWhatTheWholeHasThere) {
    CityHeights heights(to_grid(-100));
    heights.add(noise(3, 300));
    const HeightGrid whole = heights.part(kLow, kHigh), part = heights.part({-70, 63}, {65, 64});
    EXPECT_EQ(part.low(), (HeightCell{-70, 63}));
    EXPECT_EQ(part.high(), (HeightCell{65, 64}));
    for (int64_t x = -70; x <= 65; ++x) {
        for (const int64_t y : {63, 64}) EXPECT_EQ(part.height({x, y}), whole.height({x, y}));
    }
}

TEST(CityHeights, LevelGroundOfHundredsOfKilometresTakesLittleMemory) {
    constexpr double kSide = 400'000;
    CityHeights heights(0);
    heights.add(test::ground(0, 0, kSide, kSide, 7));
    // Along the diagonal of the two triangles blocks have cells.
    EXPECT_LT(heights.bytes(), uint64_t{64} << 20);
    for (const double x : {1.0, 1025.0, 200'000.0, kSide - 1}) {
        for (const double y : {1.0, 1025.0, 200'000.0, kSide - 1}) {
            const HeightCell cell = height_cell_of(to_grid(x), to_grid(y));
            EXPECT_EQ(heights.part(cell, cell).height(cell), to_grid(7)) << x << " " << y;
        }
    }
    const HeightCell outside = height_cell_of(to_grid(kSide + 2000), 0);
    EXPECT_FALSE(heights.part(outside, outside).height(outside));
    heights.add(test::tower(200'000, 200'000, 10, 50));
    const HeightCell tower = height_cell_of(to_grid(200'000), to_grid(200'000));
    EXPECT_EQ(heights.part(tower, tower).height(tower), to_grid(50));
}

TEST(CityHeights, FarApartTownsTakeNoMemoryBetween) {
    CityHeights heights(0);
    heights.add(test::city_tile(0, 0, true));
    const uint64_t one = heights.bytes();
    heights.add(test::city_tile(8000, 8000, true));  // 1,024 km away
    EXPECT_LE(heights.bytes(), 5 * one);
}

}  // namespace
}  // namespace citystream::tiles::radiance
