// Light of walls by direction: the words, and what their directions mean.
#include "codec/radiance/local_light.h"

#include <gtest/gtest.h>

#include <random>

#include "codec/radiance/irradiance.h"
#include "codec/radiance/local_directions.h"
#include "tests/codec/radiance/lattice_scene.h"

namespace citystream::codec::radiance {
namespace {

constexpr uint32_t kSide = 8;

struct LitLayer {
    std::vector<uint32_t> words;
    WholeLight light;
};

LitLayer lit_layer(uint32_t local_side) {
    const RadianceTile tile = LatticeScene::towers(32, 2, 7).tile(32, 12, kSide);
    const auto layer = encode_radiance_layer(tile, local_side, 1);
    std::vector<std::span<const std::byte>> steps;
    uint64_t bytes = 0;
    for (const auto& step : *layer) {
        steps.emplace_back(step.wire);
        bytes += step.decoded_bytes;
    }
    std::mt19937_64 random(3);
    std::vector<Rgb> radiance(texel_count(kSide));
    for (Rgb& texel : radiance) {
        for (float& value : texel) value = static_cast<float>(random() % 1000) / 500;
    }
    return {*decode_radiance_layer(steps, bytes, MatrixForm::kBiclusters),
            whole_light(weighted_light(radiance, kSide))};
}

TEST(LocalLight, WordsAreOffByHalfAStepOfTheGreatestChannelAtMost) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        std::array<uint32_t, 3> value{};
        for (uint32_t& channel : value)
            channel = static_cast<uint32_t>(random() % (uint64_t{1} << 31)) >> random() % 31;
        const auto read = local_light_value(local_light_word(value));
        const uint32_t greatest = std::max({value[0], value[1], value[2]});
        for (size_t c = 0; c < 3; ++c) {
            const double error = std::abs(static_cast<double>(read[c]) - static_cast<double>(value[c]));
            ASSERT_LE(error, greatest / 256.0) << value[c];
            if (greatest < 512) {
                ASSERT_EQ(read[c], value[c]);
            }
        }
    }
    constexpr uint32_t kMost = 0x7fffffff;
    EXPECT_EQ(local_light_value(local_light_word({kMost, 0, 0}))[0], 1u << 31);
    EXPECT_EQ(local_light_word({0, 0, 0}), 0u);
}

TEST(LocalLight, OfAllDirectionsAddUpToTheIrradianceOfTheWall) {
    const LitLayer lit = lit_layer(8);
    const auto view = RadianceLayerView::create(lit.words);
    const auto local = local_light_words(*view, lit.light);
    const auto irradiance = irradiance_words(*view, lit.light);
    const uint32_t walls = wall_receivers(view->table());
    ASSERT_GT(walls, 100u);
    ASSERT_LT(walls, view->receivers()) << "ground and roofs have none";
    ASSERT_EQ(local.size(), size_t{walls} * LOCAL_LIGHT_DIRECTIONS);
    for (uint32_t r = 0; r < walls; ++r) {
        std::array<double, 3> sum{};
        for (uint32_t d = 0; d < LOCAL_LIGHT_DIRECTIONS; ++d) {
            const auto value = local_light_value(local[size_t{r} * LOCAL_LIGHT_DIRECTIONS + d]);
            for (size_t c = 0; c < 3; ++c) sum[c] += std::ldexp(static_cast<double>(value[c]), -LOCAL_LIGHT_UNIT_BITS);
        }
        const auto whole = irradiance_of(irradiance, r, {1, 1, 1});
        for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(sum[c], static_cast<double>(whole[c]), 0.004 * sum[c] + 1e-6) << r;
    }
}

TEST(LocalLight, LayersWithOtherDirectionsOrTexelsHaveNone) {
    const LitLayer lit = lit_layer(4);
    EXPECT_TRUE(local_light_words(*RadianceLayerView::create(lit.words), lit.light).empty());
    const LitLayer other = lit_layer(8);
    const WholeLight fewer = whole_light(weighted_light(std::vector<Rgb>(texel_count(4), Rgb{1, 1, 1}), 4));
    EXPECT_TRUE(local_light_words(*RadianceLayerView::create(other.words), fewer).empty());
}

/// The tilt of a normal on its class's axes.
ReceiverPlace wall_facing(double x, double y) {
    ReceiverPlace place;
    const bool is_x = std::abs(x) >= std::abs(y);
    const double own = is_x ? x : y;
    place.surface_class = (is_x ? 0u : 2u) + (own < 0 ? 1u : 0u);
    const double tilt = (is_x ? y : x) / std::abs(own) * RECEIVER_TILT_ONE;
    // The column's axes of x are y, z; of y they are z, x.
    place.tilt[is_x ? 0 : 1] = static_cast<int8_t>(std::lround(tilt));
    return place;
}

// Masks and BTFs take direction j of the wall's u, v, w for direction j of its receivers.
TEST(LocalLight, DirectionsOfReceiversAreThoseOfTheFacadeOnTheirWall) {
    const LocalDirections directions(8);
    for (int facing = 0; facing < 8; ++facing) {
        const double angle = facing * kPi / 4, w[2] = {std::cos(angle), std::sin(angle)};
        // Outwards is (along y, -along x).
        const double along[2] = {-w[1], w[0]};
        const Frame frame = unpack_frame(frame_of_place(wall_facing(w[0], w[1])));
        for (uint32_t j = 0; j < directions.count(); ++j) {
            const auto& d = directions.direction(j);
            const double facade[3] = {d[0] * along[0] + d[2] * w[0], d[0] * along[1] + d[2] * w[1],
                                      static_cast<double>(d[1])};
            GridDirection world{};
            for (size_t c = 0; c < 3; ++c) world[c] = static_cast<int32_t>(std::lround(facade[c]));
            const auto local = frame.to_local(world);
            EXPECT_EQ(directions.nearest(local), j) << facing;
            for (size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(static_cast<double>(local[c]) / kFrameOne, d[c], 0.005 * kFrameOne) << facing;
        }
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
