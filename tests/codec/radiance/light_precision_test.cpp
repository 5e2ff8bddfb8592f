// Light in whole numbers, as the light passes add it up, against doubles: how near it comes, and what becomes of light
// that is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "codec/radiance/bicluster.h"
#include "codec/radiance/irradiance.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/source_light.h"
#include "codec/radiance/transfer_product.h"
#include "tests/codec/radiance/lattice_scene.h"

namespace citystream::codec::radiance {
namespace {

constexpr uint32_t kSide = 32;
using Sky = std::vector<Rgb>;

Sky sky_of(const std::function<float(const std::array<double, 3>& direction)>& radiance) {
    Sky sky;
    for (uint32_t k = 0; k < texel_count(kSide); ++k) {
        const GridDirection d = cell_direction(kSide, k);
        const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
        const float value = radiance({x / length, y / length, z / length});
        sky.push_back({value, 0.5F * value, 2 * value});
    }
    return sky;
}

std::vector<Sky> skies() {
    return {sky_of([](const auto&) { return 1.0F; }),
            sky_of([](const auto& d) { return static_cast<float>(0.3 + 0.7 * std::max(0.0, d[2])); }),
            sky_of([](const auto& d) { return static_cast<float>(0.5 + 0.4 * std::sin(9 * d[0] + 5 * d[1])); })};
}

uint32_t sun_texel() {
    return cell_of(std::array<double, 3>{0.4, 0.3, 0.6}, kSide);
}

const Transfer& city() {
    static const Transfer transfer =
        make_transfer(first_receivers(TowerCity().visibility(32, kSide), 300), LocalDirections(8));
    return transfer;
}

struct RowError {
    double greatest = 0;      ///< of all rows, over the row's own light
    double of_brightest = 0;  ///< over the brightest row's
    uint32_t rows = 0;
};

/// Of rows with light that do not see texel `sun`, by clusters in whole numbers against entries in doubles.
RowError row_error(const Sky& sky, uint32_t sun) {
    const auto weighted = weighted_light(sky, kSide);
    std::vector<Channels<double>> exact_light;
    for (const Rgb& value : weighted) exact_light.push_back({value[0], value[1], value[2]});
    const WholeLight whole = whole_light(weighted);
    const auto exact = product_by_entries(city(), std::span<const Channels<double>>(exact_light));
    const auto found =
        product_by_clusters(find_biclusters(city(), {}), std::span<const Channels<uint32_t>>(whole.values));
    Channels<double> brightest{};
    for (const auto& row : exact) {
        for (size_t c = 0; c < 3; ++c) brightest[c] = std::max(brightest[c], row[c]);
    }
    RowError error;
    for (uint32_t j = 0; j < city().rows(); ++j) {
        const auto begin = city().column.begin() + city().row_begin[j];
        const auto end = city().column.begin() + city().row_begin[j + 1];
        if (begin == end || std::find(begin, end, sun) != end) continue;
        ++error.rows;
        for (size_t c = 0; c < 3; ++c) {
            const double off = std::abs(found[j][c] * double{whole.unit[c]} - exact[j][c]);
            error.greatest = std::max(error.greatest, off / exact[j][c]);
            error.of_brightest = std::max(error.of_brightest, off / brightest[c]);
        }
    }
    return error;
}

TEST(LightPrecision, RowsUnderASkyAreWithinAHundredThousandthOfDoubles) {
    for (size_t i = 0; i < skies().size(); ++i) {
        const RowError error = row_error(skies()[i], texel_count(kSide));
        EXPECT_LE(error.of_brightest, 1e-5);
        EXPECT_GT(error.rows, 3000U);
        // Under a sky of stripes some rows see little but a dark texel: their light is fewer units.
        if (i == 2) continue;
        EXPECT_LE(error.greatest, 1e-5);
    }
}

TEST(LightPrecision, RowsThatMissASunAreWithinAThousandthOfDoubles) {
    for (Sky sky : skies()) {
        sky[sun_texel()].fill(1e4F);
        const RowError error = row_error(sky, sun_texel());
        EXPECT_LE(error.greatest, 1e-3);
        EXPECT_GT(error.rows, 3000U);
    }
}

/// Irradiance of all receivers of a layer's words.
std::vector<std::array<float, 3>> lit(std::span<const uint32_t> words, const Sky& sky) {
    const auto view = RadianceLayerView::create(words);
    const WholeLight light = whole_light(weighted_light(sky, kSide));
    const auto irradiance = irradiance_words(*view, light);
    std::vector<std::array<float, 3>> result;
    for (uint32_t r = 0; r < view->receivers(); ++r)
        result.push_back(irradiance_of(irradiance, r, irradiance_unit(light)));
    return result;
}

std::vector<uint32_t> city_words() {
    const auto steps = encode_radiance_layer(LatticeScene::towers(32, 2, 7).tile(32, 13, kSide), 8, 0);
    const LayerPrefix prefix(*steps, steps->size());
    return *decode_radiance_layer(prefix.steps, prefix.decoded_bytes, MatrixForm::kBiclusters);
}

TEST(LightPrecision, WhatIsNoLightGivesWhatDarknessThereGives) {
    const auto words = city_words();
    const float none = std::numeric_limits<float>::quiet_NaN(), endless = std::numeric_limits<float>::infinity();
    const uint32_t place = sun_texel();
    Sky dark = skies()[1];
    dark[place] = {0, 0, 0};
    const auto expected = lit(words, dark);
    for (const float value : {none, -1.0F, -endless}) {
        Sky sky = dark;
        sky[place] = {value, value, value};
        EXPECT_EQ(lit(words, sky), expected) << value;
    }
    // Endless light is finite, and only who sees it has it.
    Sky sky = dark;
    sky[place] = {endless, endless, endless};
    for (const auto& irradiance : lit(words, sky)) {
        for (const float channel : irradiance) EXPECT_TRUE(std::isfinite(channel) && channel >= 0);
    }
    EXPECT_NE(lit(words, sky), expected);
}

TEST(LightPrecision, NothingButNoLightIsDark) {
    const auto words = city_words();
    const float none = std::numeric_limits<float>::quiet_NaN();
    for (const float value : {0.0F, -0.0F, -5.0F, none}) {
        for (const auto& irradiance : lit(words, Sky(texel_count(kSide), Rgb{value, value, value})))
            EXPECT_EQ(irradiance, (std::array<float, 3>{})) << value;
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
