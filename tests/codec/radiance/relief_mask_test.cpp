// Relief masks: which directions the relief of a facade hides, and what that makes of light.
#include "codec/radiance/relief_mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "codec/radiance/irradiance.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/series_angle.h"
#include "tests/codec/radiance/relief_facades.h"

namespace citystream::codec::radiance {
namespace {

using facade::RunGrid;

constexpr uint64_t kAll = ~uint64_t{0};

/// Whether the relief hides a direction from a point: in steps of a quarter of a texel over every texel's displacement.
bool is_hidden(const facade::FacadeMatrices& matrices, const std::array<double, 3>& from, const GridDirection& d) {
    const std::array<double, 3> along = {d[0] * 100.0, d[1] * 100.0, d[2] * 1000.0};
    const double step = 0.25 / std::max({std::abs(along[0]), std::abs(along[1]), along[2] / 50});
    std::array<double, 3> at = from;
    while (true) {
        for (size_t i = 0; i < 3; ++i) at[i] += step * along[i];
        if (at[0] < 0 || at[1] < 0 || at[0] >= matrices.width || at[1] >= matrices.height || at[2] > 2000) return false;
        const size_t texel = static_cast<size_t>(at[1]) * matrices.width + static_cast<size_t>(at[0]);
        const int depth = matrices.displacement_mm[texel];
        if (depth != facade::kOpenDisplacement && at[2] < depth) return true;
    }
}

/// Of a mask texel's surface.
const ReliefStart& start_of(const ReliefSurfaces& surfaces, uint32_t x, uint32_t y, uint32_t surface = 0) {
    const uint32_t texel = surfaces.texels[size_t{y} * surfaces.shape.across() + x];
    return surfaces.starts[(texel & ((1u << RELIEF_MASK_COUNT_SHIFT) - 1)) + surface];
}

TEST(ReliefWeights, OfFrontsAreThoseOfIrradiance) {
    const std::vector<uint32_t> weights = irradiance_weights(RELIEF_DIRECTIONS_ACROSS);
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) EXPECT_EQ(relief_weights()[RELIEF_FACE_FRONT][j], weights[j]) << j;
}

// Of the light from in front of the wall's plane a reveal gets half of what the wall does.
TEST(ReliefWeights, OfRevealsAddUpToHalfOfAFront) {
    const CellAverages averages = cell_averages(LocalDirections(RELIEF_DIRECTIONS_ACROSS));
    for (uint32_t face = 0; face < RELIEF_FACES; ++face) {
        double sum = 0;
        for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j)
            sum += averages.solid_angle[j] * relief_weights()[face][j] / 65536;
        EXPECT_NEAR(sum, face == RELIEF_FACE_FRONT ? kPi : kPi / 2, 0.001) << face;
    }
}

TEST(ReliefWeights, LookTheWayOfTheirFaces) {
    const LocalDirections directions(RELIEF_DIRECTIONS_ACROSS);
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
        const GridDirection& d = directions.direction(j);
        for (const int axis : {0, 1}) {
            const uint32_t towards = relief_weights()[relief_face(axis, 1)][j];
            const uint32_t away = relief_weights()[relief_face(axis, -1)][j];
            if (std::abs(d[static_cast<size_t>(axis)]) < 1000) continue;
            EXPECT_EQ(towards > away, d[static_cast<size_t>(axis)] > 0) << j;
        }
    }
}

TEST(ReliefMaskShape, HasTheSmallestSquaresThatAreFewEnough) {
    for (const uint32_t width : {1u, 100u, 128u, 129u, 2000u, 8192u}) {
        for (const uint32_t height : {1u, 77u, 1500u, 8192u}) {
            const ReliefMaskShape shape = relief_mask_shape(width, height);
            EXPECT_LE(shape.texels(), static_cast<uint32_t>(RELIEF_MASK_MOST_TEXELS));
            if (shape.log2_side > 0) {
                const ReliefMaskShape finer{width, height, shape.log2_side - 1};
                EXPECT_GT(finer.texels(), static_cast<uint32_t>(RELIEF_MASK_MOST_TEXELS));
            }
        }
    }
}

// A cornice and a groove, each lower than a mask texel and in the middle of none.
TEST(ReliefSurfaces, AreThoseThatCoverTheMostOfEachMaskTexel) {
    const RunGrid grid = relief_facade(1600, 1600, {{0, 801, 1600, 805, 250, 1}, {0, 809, 1600, 812, -90, 2}});
    const ReliefSurfaces surfaces = relief_surfaces(grid);
    ASSERT_EQ(surfaces.shape.log2_side, 4u);
    EXPECT_EQ(surfaces.texels.size(), surfaces.shape.texels());
    uint32_t next = 0;
    for (uint32_t y = 0; y < surfaces.shape.up(); ++y) {
        for (uint32_t x = 0; x < surfaces.shape.across(); ++x) {
            const uint32_t texel = surfaces.texels[size_t{y} * surfaces.shape.across() + x];
            EXPECT_EQ(texel & 0xffffff, next);
            EXPECT_EQ(texel >> 24, y == 50 ? 3u : 1u);
            next += texel >> 24;
        }
    }
    EXPECT_EQ(next, surfaces.starts.size());
    const std::array<std::array<int, 2>, 3> wanted = {{{0, 807}, {250, 803}, {-90, 810}}};
    for (uint32_t i = 0; i < 3; ++i) {
        const ReliefStart& start = start_of(surfaces, 7, 50, i);
        EXPECT_EQ(facade::displacement_of(start.label), wanted[i][0]);
        EXPECT_EQ(start.x, 7u * 16 + 8);
        EXPECT_EQ(static_cast<int>(start.y), wanted[i][1]);
    }
    const std::vector<uint32_t> words = make_relief_mask(grid);
    const auto mask = ReliefMaskView::create(words);
    ASSERT_TRUE(mask.ok());
    // The cornice stands free, the groove does not, and each is lit by its own surface.
    EXPECT_EQ(mask->bits(50, 50, 1), kAll);
    EXPECT_NE(mask->bits(50, 50, 2), kAll);
    const ReliefShares cornice = mask->shares({808, 803, 250}, facade::make_label(250, 1), 2, 1);
    const ReliefShares groove = mask->shares({808, 810, -90}, facade::make_label(-90, 2), 2, 1);
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
        EXPECT_FLOAT_EQ(cornice.free(j), 1);
        EXPECT_FLOAT_EQ(groove.free(j), (mask->bits(50, 50, 2) >> j & 1) != 0 ? 1.0F : 0.0F);
    }
    // Of the cornice's lower side the wall below it, and not the groove, is what lies in front.
    const ReliefShares side = mask->shares({808, 801, 120}, facade::make_label(250, 1), 1, -1);
    const std::vector<uint64_t> wall = {mask->bits(50, 49), mask->bits(50, 50)};
    for (uint32_t k = 0; k < 4; ++k) {
        if (side.share[k] > 0) {
            EXPECT_TRUE(std::ranges::count(wall, side.bits[k]) == 1) << k;
        }
    }
}

TEST(ReliefMask, OfAFlatMapLeavesAllFree) {
    const RunGrid grid = relief_facade(300, 200, {});
    const std::vector<uint32_t> words = make_relief_mask(grid);
    const auto mask = ReliefMaskView::create(words);
    ASSERT_TRUE(mask.ok());
    for (uint32_t y = 0; y < mask->shape().up(); ++y) {
        for (uint32_t x = 0; x < mask->shape().across(); ++x) ASSERT_EQ(mask->bits(x, y), kAll);
    }
    // So a front's light is its irradiance.
    std::array<double, RELIEF_DIRECTIONS> light{};
    std::iota(light.begin(), light.end(), 1.0);
    const std::vector<uint32_t> weights = irradiance_weights(RELIEF_DIRECTIONS_ACROSS);
    double irradiance = 0;
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) irradiance += light[j] * weights[j] / 65536;
    const ReliefShares shares = mask->shares({120.3F, 77.7F, 0}, grid.labels[0], 2, 1);
    EXPECT_NEAR(relief_irradiance(shares, RELIEF_FACE_FRONT, light), irradiance, 1e-6 * irradiance);
}

// Beside a long ridge on the right what points right is hidden up to the ridge's height.
TEST(ReliefMask, OfARidgeHidesWhatIsBelowItsHeight) {
    constexpr uint32_t kRidge = 200;
    constexpr int kHeight = 300;
    const RunGrid grid = relief_facade(260, 40, {{kRidge, 0, 260, 40, kHeight, 1}});
    const ReliefSurfaces surfaces = relief_surfaces(grid);
    for (const FacadeScales& scales : {FacadeScales{100, 100}, FacadeScales{50, 200}}) {
        const std::vector<uint32_t> words = make_relief_mask(grid, scales);
        const auto mask = ReliefMaskView::create(words);
        ASSERT_TRUE(mask.ok());
        EXPECT_EQ(mask->scales(), scales);
        const LocalDirections directions(RELIEF_DIRECTIONS_ACROSS);
        uint32_t hidden = 0;
        for (uint32_t x = 0; x < mask->shape().across(); ++x) {
            const uint32_t y = mask->shape().up() / 2;
            const uint32_t u = start_of(surfaces, x, y).x;
            const double metres = (kRidge - (u + 0.5)) / double{scales[0]};
            for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
                const GridDirection& d = directions.direction(j);
                // Where it comes to the ridge; beyond the map's upper or lower edge it is free.
                const double t = metres / d[0], height = t * d[2], across = std::abs(t * d[1]);
                if (u < kRidge && d[0] > 0 && across > 18 / double{scales[1]}) continue;
                const bool hides = u < kRidge && d[0] > 0 && 1000 * height < kHeight;
                if (u < kRidge && d[0] > 0 && std::abs(1000 * height - kHeight) < 1) continue;
                EXPECT_EQ((mask->bits(x, y) >> j & 1) == 0, hides) << x << ", direction " << j;
                hidden += hides ? 1 : 0;
            }
        }
        EXPECT_GT(hidden, 100U);
    }
}

TEST(ReliefMask, HasTheBitsOfRaysInSmallSteps) {
    const LocalDirections directions(RELIEF_DIRECTIONS_ACROSS);
    std::mt19937 random(1);
    uint64_t bits = 0, wrong = 0;
    for (const bool open : {false, true}) {
        const RunGrid grid = window_relief(open);
        const facade::FacadeMatrices matrices = facade::expand(grid);
        const ReliefSurfaces surfaces = relief_surfaces(grid);
        const std::vector<uint32_t> words = make_relief_mask(grid);
        const auto mask = ReliefMaskView::create(words);
        ASSERT_TRUE(mask.ok());
        for (int i = 0; i < 100; ++i) {
            const auto x = static_cast<uint32_t>(random() % mask->shape().across());
            const auto y = static_cast<uint32_t>(random() % mask->shape().up());
            const auto surface = static_cast<uint32_t>(random() % mask->surfaces(x, y));
            const ReliefStart& start = start_of(surfaces, x, y, surface);
            const int depth = matrices.displacement_mm[size_t{start.y} * grid.width() + start.x];
            ASSERT_EQ(facade::displacement_of(mask->label(x, y, surface)), depth);
            const uint64_t got = mask->bits(x, y, surface);
            if (depth == facade::kOpenDisplacement) {
                EXPECT_EQ(got, kAll);
                continue;
            }
            for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
                const bool free =
                    !is_hidden(matrices, {start.x + 0.5, start.y + 0.5, depth + 0.5}, directions.direction(j));
                wrong += free != ((got >> j & 1) != 0) ? 1 : 0;
                ++bits;
            }
        }
    }
    EXPECT_GT(bits, 8000U);
    EXPECT_LE(wrong * 200, bits);
}

TEST(ReliefShares, AddUpToOneAndAreThoseOfTheSurface) {
    const RunGrid grid = window_relief(false);
    const std::vector<uint32_t> words = make_relief_mask(grid);
    const auto mask = ReliefMaskView::create(words);
    ASSERT_TRUE(mask.ok());
    std::mt19937 random(2);
    std::uniform_real_distribution<float> unit(0, 1);
    const auto side = static_cast<float>(1u << mask->shape().log2_side);
    for (int i = 0; i < 2000; ++i) {
        const float u = unit(random) * static_cast<float>(grid.width());
        const float v = unit(random) * static_cast<float>(grid.height());
        const uint32_t label = label_at(grid, u, v);
        const auto depth = static_cast<float>(facade::displacement_of(label));
        const ReliefShares shares = mask->shares({u, v, depth}, label, 2, 1);
        EXPECT_NEAR(shares.share[0] + shares.share[1] + shares.share[2] + shares.share[3], 1, 1e-5);
        // In the middle of a mask texel it is that texel's alone.
        const auto x = static_cast<uint32_t>(u / side), y = static_cast<uint32_t>(v / side);
        const std::array<float, 3> middle = {(static_cast<float>(x) + 0.5F) * side,
                                             (static_cast<float>(y) + 0.5F) * side,
                                             static_cast<float>(facade::displacement_of(mask->label(x, y)))};
        const ReliefShares own = mask->shares(middle, mask->label(x, y), 2, 1);
        for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j)
            ASSERT_FLOAT_EQ(own.free(j), (mask->bits(x, y) >> j & 1) != 0 ? 1.0F : 0.0F);
    }
}

// Beside an edge light does not come from beyond it.
TEST(ReliefShares, DoNotCrossEdgesOfTheRelief) {
    const RunGrid grid = relief_facade(512, 128, {{256, 0, 512, 128, 400, 1}});
    const std::vector<uint32_t> words = make_relief_mask(grid);
    const auto mask = ReliefMaskView::create(words);
    ASSERT_TRUE(mask.ok());
    ASSERT_EQ(256 % (1u << mask->shape().log2_side), 0U);
    const uint32_t left = 256 / (1u << mask->shape().log2_side) - 1, y = mask->shape().up() / 2;
    ASSERT_NE(mask->bits(left, y), kAll);
    ASSERT_EQ(mask->bits(left + 1, y), kAll);
    const auto middle = (static_cast<float>(y) + 0.5F) * static_cast<float>(1u << mask->shape().log2_side);
    const auto is_of = [&](const ReliefShares& shares, uint64_t bits) {
        for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
            if (std::abs(shares.free(j) - ((bits >> j & 1) != 0 ? 1.0F : 0.0F)) > 1e-5F) return false;
        }
        return true;
    };
    EXPECT_TRUE(is_of(mask->shares({255.9F, middle, 0}, facade::make_label(0, 0), 2, 1), mask->bits(left, y)));
    EXPECT_TRUE(is_of(mask->shares({256.1F, middle, 400}, facade::make_label(400, 1), 2, 1), kAll));
    // The reveal looks to the left: what is in front of it counts, less and less towards its edge.
    for (const float height : {0.0F, 100.0F, 200.0F, 400.0F}) {
        const ReliefShares reveal = mask->shares({256, middle, height}, facade::make_label(400, 1), 0, -1);
        for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
            const float below = (mask->bits(left, y) >> j & 1) != 0 ? 1.0F : 0.0F;
            ASSERT_NEAR(reveal.free(j), below + (1 - below) * height / 400, 1e-5) << height << ' ' << j;
        }
    }
    // No texel is as deep as this: the one next in depth.
    EXPECT_TRUE(is_of(mask->shares({256, middle, 390}, facade::make_label(390, 1), 2, 1), kAll));
}

TEST(ReliefMaskView, RefusesWhatIsNoMask) {
    const std::vector<uint32_t> words = make_relief_mask(relief_facade(40, 30, {{5, 5, 20, 20, -100, 1}}));
    ASSERT_TRUE(ReliefMaskView::create(words).ok());
    for (size_t count = 0; count < words.size(); ++count)
        EXPECT_FALSE(ReliefMaskView::create(std::span(words).first(count)).ok()) << count;
    std::vector<uint32_t> longer = words;
    longer.push_back(0);
    EXPECT_FALSE(ReliefMaskView::create(longer).ok());
    for (const uint32_t word : {RELIEF_MASK_WORD_MAGIC, RELIEF_MASK_WORD_MAP, RELIEF_MASK_WORD_SIDE,
                                RELIEF_MASK_WORD_SURFACES, RELIEF_MASK_WORD_SCALES, RELIEF_MASK_WORD_SCALES + 1}) {
        for (const uint32_t value : {0u, ~0u, 0x7fc00000u}) {
            std::vector<uint32_t> other = words;
            other[word] = value;
            // A map one texel wide or high has no side to tell: zero is its right value there.
            if (other == words) continue;
            const auto view = ReliefMaskView::create(other);
            ASSERT_FALSE(view.ok()) << word << " " << value;
            EXPECT_FALSE(view.error().message.empty());
        }
    }
}

// Whatever the mask's own words say, nothing outside them is read.
TEST(ReliefMaskView, SurvivesMutatedWords) {
    const std::vector<uint32_t> words = make_relief_mask(relief_facade(33, 47, {{5, 5, 20, 20, -100, 1}}));
    std::mt19937 random(3);
    uint32_t accepted = 0;
    for (int i = 0; i < 2000; ++i) {
        std::vector<uint32_t> other = words;
        other[random() % other.size()] ^= 1u << random() % 32;
        const auto view = ReliefMaskView::create(other);
        if (!view.ok()) continue;
        ++accepted;
        const auto u = static_cast<float>(random() % 50), v = static_cast<float>(random() % 50);
        const ReliefShares shares =
            view->shares({u, v, -50}, static_cast<uint32_t>(random()), static_cast<int>(i % 3), 1);
        for (const float share : shares.share) EXPECT_TRUE(share >= 0 && share <= 1);
    }
    EXPECT_GT(accepted, 100U);
}

TEST(ReliefMask, IsTheSameEachTime) {
    EXPECT_EQ(make_relief_mask(window_relief(true)), make_relief_mask(window_relief(true)));
}

}  // namespace
}  // namespace citystream::codec::radiance
