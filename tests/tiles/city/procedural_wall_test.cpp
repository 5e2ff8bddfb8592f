// Wall textures: what a drawing promises.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <thread>
#include <vector>

#include "tiles/city/procedural_wall.h"

namespace citystream::tiles::city::procedural {
namespace {

std::vector<WallTexture> some_of_every_use(uint32_t each, uint64_t seed = 1) {
    std::vector<WallTexture> textures;
    for (int use = 0; use < kWallUses; ++use) {
        for (uint32_t number = 0; number < each; ++number)
            textures.push_back(describe_wall(static_cast<WallUse>(use), number, seed));
    }
    return textures;
}

/// Mean difference of neighbouring texels across the line before column `x` (or row, transposed).
double step_across(const Image& image, uint32_t at, bool rows) {
    const uint32_t length = rows ? image.width : image.height, period = rows ? image.height : image.width;
    const auto texel = [&](uint32_t along, uint32_t across) {
        const size_t x = rows ? along : across, y = rows ? across : along;
        return image.rgb.data() + 3 * (y * image.width + x);
    };
    double sum = 0;
    for (uint32_t i = 0; i < length; ++i) {
        for (int c = 0; c < 3; ++c) sum += std::abs(texel(i, at)[c] - texel(i, (at + period - 1) % period)[c]);
    }
    return sum / (3.0 * length);
}

double greatest_step(const Image& image, bool rows) {
    double greatest = 0;
    for (uint32_t at = 1; at < (rows ? image.height : image.width); ++at)
        greatest = std::max(greatest, step_across(image, at, rows));
    return greatest;
}

TEST(WallTexture, IsDrawnAlikeEveryTimeFromAnyThread) {
    const auto textures = some_of_every_use(3);
    std::vector<Image> here, there(textures.size());
    for (const WallTexture& texture : textures) here.push_back(draw_wall(texture));
    {
        std::vector<std::jthread> threads;
        for (size_t first = 0; first < 3; ++first) {
            threads.emplace_back([&, first] {
                for (size_t i = first; i < textures.size(); i += 3) there[i] = draw_wall(textures[i]);
            });
        }
    }
    for (size_t i = 0; i < textures.size(); ++i) EXPECT_EQ(here[i].rgb, there[i].rgb) << i;
}

TEST(WallTexture, IsAboutFiveHundredTexelsWideAndOftenNoPowerOfTwo) {
    size_t powers = 0, total = 0;
    for (const WallTexture& texture : some_of_every_use(100)) {
        EXPECT_GE(texture.width, 380);
        EXPECT_LE(texture.width, 680);
        EXPECT_GE(texture.height, 120);
        EXPECT_LE(texture.height, 600);
        EXPECT_GE(texture.width_mm, 4000);
        EXPECT_LE(texture.width_mm, 40000);
        if (texture.use == WallUse::kPlain) {
            EXPECT_EQ(texture.width_mm, texture.height_mm);
        }
        powers += texture.width == 512;
        ++total;
    }
    EXPECT_GT(powers, total / 10);
    EXPECT_LT(powers, total / 2);
}

TEST(WallTexture, DiffersFromEveryOtherOfTheCityAndOfOtherSeeds) {
    std::set<std::vector<uint8_t>> seen;
    size_t total = 0;
    for (const uint64_t seed : {1, 2}) {
        for (const WallTexture& texture : some_of_every_use(16, seed)) {
            const Image image = draw_wall(texture);
            ASSERT_EQ(image.rgb.size(), size_t{3} * texture.width * texture.height);
            seen.insert(image.rgb);
            ++total;
        }
    }
    EXPECT_EQ(seen.size(), total);
}

TEST(WallTexture, RepeatsWithoutASeam) {
    for (const WallTexture& texture : some_of_every_use(8)) {
        const Image image = draw_wall(texture);
        const bool stacked =
            texture.use != WallUse::kHall && texture.use != WallUse::kHouseDoor && texture.use != WallUse::kShop;
        for (const bool rows : {false, true}) {
            if (rows && !stacked) continue;  // one storey, with a foot and a head
            EXPECT_LE(step_across(image, 0, rows), 1.05 * greatest_step(image, rows) + 2)
                << "use " << static_cast<int>(texture.use) << (rows ? " rows" : " columns");
        }
    }
}

TEST(WallTexture, HasContrastWhereItHasWindows) {
    for (const WallTexture& texture : some_of_every_use(8)) {
        const Image image = draw_wall(texture);
        int darkest = 255, brightest = 0;
        for (size_t i = 1; i < image.rgb.size(); i += 3) {
            darkest = std::min<int>(darkest, image.rgb[i]);
            brightest = std::max<int>(brightest, image.rgb[i]);
        }
        EXPECT_GT(brightest - darkest, texture.use == WallUse::kPlain ? 8 : 60) << static_cast<int>(texture.use);
    }
}

}  // namespace
}  // namespace citystream::tiles::city::procedural
