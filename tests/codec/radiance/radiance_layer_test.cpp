// The radiance layer from a tile to its steps, and from any prefix of them to words in GPU memory.
#include "codec/radiance/radiance_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "codec/bits/range_coder.h"
#include "codec/radiance/irradiance.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/place_wire.h"
#include "codec/radiance/radiance_resident.h"
#include "codec/radiance/source_light.h"
#include "codec/radiance/transfer.h"
#include "tests/codec/radiance/lattice_scene.h"
#include "tests/hexadecimal.h"

namespace citystream::codec::radiance {
namespace {

using Bytes = std::vector<std::byte>;

constexpr uint64_t kHash = 0x0123456789abcdefu;
constexpr uint32_t kLocalSide = 4, kSteps = 3;

RadianceTile rounded(RadianceTile tile) {
    for (ReceiverPlace& place : tile.places) place.depth = rounded_depth(place.depth, tile.spacing_log2);
    return tile;
}

RadianceTile small_city(uint32_t side = 8) {
    return LatticeScene::towers(32, 2, 7).tile(32, 12, side);
}

/// Receivers of a made-up tile without boxes: all see the whole upper half.
RadianceTile open_field(uint32_t side) {
    return LatticeScene({}).tile(8, 12, side);
}

std::vector<RadianceTile> tiles() {
    RadianceTile none;
    none.spacing_log2 = 12;
    none.visibility.side = 8;
    RadianceTile shut_in = small_city(4);
    std::fill(shut_in.visibility.words.begin(), shut_in.visibility.words.end(), 0);
    RadianceTile one = open_field(3);
    one.places.resize(1);
    one.visibility.frames.resize(1);
    one.visibility = first_receivers(one.visibility, 1);
    return {none, shut_in, one, open_field(5), small_city(), LatticeScene::towers(24, 3, 2).tile(24, 11, 4)};
}

std::vector<RadianceLayerStep> encoded(const RadianceTile& tile, uint32_t local_side = kLocalSide) {
    auto steps = encode_radiance_layer(tile, local_side, kHash);
    EXPECT_TRUE(steps.ok()) << steps.error().text();
    return std::move(*steps);
}

std::vector<uint32_t> words_of(const std::vector<RadianceLayerStep>& steps, size_t count, MatrixForm form) {
    const LayerPrefix prefix(steps, count);
    auto words = decode_radiance_layer(prefix.steps, prefix.decoded_bytes, form);
    EXPECT_TRUE(words.ok()) << words.error().text();
    return std::move(*words);
}

TEST(RadianceLayer, BringsTheTileBackAndLessOfItWithEveryStepLess) {
    for (const RadianceTile& tile : tiles()) {
        const auto steps = encoded(tile);
        ASSERT_EQ(steps.size(), kSteps);
        EXPECT_EQ(*read_bake_hash(steps[0].wire), kHash);
        EXPECT_EQ(steps.back().error, 0);
        for (size_t count = 1; count <= kSteps; ++count) {
            const LayerPrefix prefix(steps, count);
            const auto decoded = decode_radiance_tile(prefix.steps, prefix.decoded_bytes);
            ASSERT_TRUE(decoded.ok()) << decoded.error().text();
            EXPECT_EQ(decoded->places, rounded(tile).places);
            EXPECT_EQ(decoded->spacing_log2, tile.spacing_log2);
            EXPECT_EQ(decoded->visibility.frame_of, tile.visibility.frame_of);
            EXPECT_TRUE(count < kSteps || *decoded == rounded(tile));
            EXPECT_LE(steps[count - 1].error, steps[std::max<size_t>(count, 2) - 2].error);
            EXPECT_EQ(steps[count - 1].decoded_bytes % 4, 0u);
        }
    }
}

TEST(RadianceLayer, HasTheSameRowsInBothFormsWithinTheDecodedBytes) {
    for (const RadianceTile& tile : tiles()) {
        const auto steps = encoded(tile);
        const LocalDirections local(kLocalSide);
        for (size_t count = 1; count <= kSteps; ++count) {
            const LayerPrefix prefix(steps, count);
            const auto bits = decode_radiance_tile(prefix.steps, prefix.decoded_bytes);
            const Transfer expected = make_transfer(bits->visibility, local);
            std::vector<Channels<uint32_t>> light(texel_count(tile.visibility.side));
            for (uint32_t k = 0; k < light.size(); ++k) light[k] = {k * k, 3 * k + 1, 0xffffffff - k};
            const auto rows = product_by_entries(expected, std::span<const Channels<uint32_t>>(light));
            for (const MatrixForm form : {MatrixForm::kBiclusters, MatrixForm::kRows}) {
                const auto words = words_of(steps, count, form);
                EXPECT_LE(4 * words.size(), prefix.decoded_bytes);
                const auto view = RadianceLayerView::create(words);
                ASSERT_TRUE(view.ok()) << view.error().text();
                ASSERT_EQ(view->receivers(), tile.places.size());
                const auto table = ReceiverTableView::create(view->table());
                EXPECT_EQ(table->places(), rounded(tile).places);
                EXPECT_TRUE(std::all_of(view->irradiance().begin(), view->irradiance().end(),
                                        [](uint32_t word) { return word == 0; }));
                const auto matrix = ResidentRadianceView::create(view->matrix());
                const auto distinct = matrix->product(std::span<const Channels<uint32_t>>(light));
                for (uint32_t row = 0; row < rows.size(); ++row)
                    ASSERT_EQ(distinct[matrix->row_of(row / local.count(), row % local.count())], rows[row]);
            }
        }
    }
}

TEST(RadianceLayer, ClustersAreSmallerThanRowsInACity) {
    const auto steps = encoded(small_city(16), 8);
    EXPECT_LT(words_of(steps, kSteps, MatrixForm::kBiclusters).size(),
              words_of(steps, kSteps, MatrixForm::kRows).size());
}

TEST(RadianceLayer, WritesTheSameBytesAndWordsEachTime) {
    const auto steps = encoded(small_city()), again = encoded(small_city());
    for (size_t i = 0; i < kSteps; ++i) EXPECT_EQ(steps[i].wire, again[i].wire);
    EXPECT_EQ(words_of(steps, kSteps, MatrixForm::kBiclusters), words_of(again, kSteps, MatrixForm::kBiclusters));
}

TEST(RadianceLayer, KeepsTheBytesOfItsFormatPage) {
    RadianceTile tile;
    tile.spacing_log2 = 12;
    tile.places = {{4, {0, 0}, 0, {}}, {4, {1, 0}, 0, {}}};
    tile.visibility = cast_rays({{{0, 0, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}}}, 4, 0,
                                [](const Receiver& r, const Point& d) { return d[0] < (r.position[0] + 1) * d[2]; });
    const auto steps = encoded(tile, 1);
    EXPECT_EQ(test::hexadecimal(steps[0].wire), "efcdab89674523010c0103000000ab645583ffffca0875fe56");
    EXPECT_EQ(test::hexadecimal(steps[1].wire), "77078dacd26a");
    EXPECT_EQ(test::hexadecimal(steps[2].wire), "cad35913");
    EXPECT_EQ(steps[0].decoded_bytes, 344u);
    EXPECT_EQ(steps[1].decoded_bytes, 0u);
    EXPECT_EQ(steps[2].decoded_bytes, 0u);
    const auto words = words_of(steps, kSteps, MatrixForm::kBiclusters);
    EXPECT_EQ(words.size(), 75u);
}

TEST(RadianceLayer, PlacesTakeLessThanAByteAReceiverInACity) {
    const RadianceTile city = LatticeScene::towers(96, 4, 1).tile(96, 12, 1);
    EXPECT_LT(encode_places(city.places, city.spacing_log2).size(), city.places.size());
}

TEST(RadianceLayer, RefusesWhatIsNoTile) {
    const RadianceTile good = small_city(4);
    EXPECT_TRUE(encode_radiance_layer(good, kLocalSide, 0).ok());
    EXPECT_FALSE(encode_radiance_layer(good, 0, 0).ok());
    EXPECT_FALSE(encode_radiance_layer(good, kMostLocalSide + 1, 0).ok());
    RadianceTile bad = good;
    std::swap(bad.places.front(), bad.places.back());
    EXPECT_FALSE(encode_radiance_layer(bad, kLocalSide, 0).ok());
    bad = good;
    bad.spacing_log2 = RECEIVER_LEAST_SPACING - 1;
    EXPECT_FALSE(encode_radiance_layer(bad, kLocalSide, 0).ok());
    bad = good;
    bad.places.pop_back();
    EXPECT_FALSE(encode_radiance_layer(bad, kLocalSide, 0).ok());
    bad = good;
    bad.places.back().tilt[0] = 40;
    EXPECT_FALSE(encode_radiance_layer(bad, kLocalSide, 0).ok()) << "a frame that is not its place's";
    bad = good;
    bad.places.back().depth = kMostDepth + 1;
    EXPECT_FALSE(encode_radiance_layer(bad, kLocalSide, 0).ok());
    bad = good;
    bad.visibility.words.pop_back();
    EXPECT_FALSE(encode_radiance_layer(bad, kLocalSide, 0).ok());
}

TEST(RadianceLayer, RefusesEveryTruncationAndWhatFollows) {
    const auto steps = encoded(LatticeScene::towers(16, 1, 3).tile(16, 12, 4), 2);
    for (size_t which = 0; which < kSteps; ++which) {
        LayerPrefix prefix(steps, kSteps);
        const Bytes& whole = steps[which].wire;
        // A message may end in bytes that are not needed to tell it from its beginning, at most the padding.
        for (size_t size = 0; size + bits::RangeDecoder::kPaddingBytes < whole.size(); ++size) {
            prefix.steps[which] = std::span(whole).first(size);
            EXPECT_FALSE(decode_radiance_layer(prefix.steps, prefix.decoded_bytes, MatrixForm::kRows).ok()) << size;
            EXPECT_FALSE(decode_radiance_tile(prefix.steps, prefix.decoded_bytes).ok()) << size;
        }
        Bytes longer = whole;
        longer.insert(longer.end(), 8, std::byte{0x55});
        prefix.steps[which] = longer;
        EXPECT_FALSE(decode_radiance_layer(prefix.steps, prefix.decoded_bytes, MatrixForm::kRows).ok());
    }
    EXPECT_FALSE(decode_radiance_layer({}, 1 << 20, MatrixForm::kRows).ok());
    EXPECT_FALSE(read_bake_hash(std::span(steps[0].wire).first(13)).ok());
}

TEST(RadianceLayer, TakesNoMoreThanItsDecodedBytes) {
    const auto steps = encoded(small_city());
    for (size_t count = 1; count <= kSteps; ++count) {
        const LayerPrefix prefix(steps, count);
        const uint64_t bytes = 4 * words_of(steps, count, MatrixForm::kRows).size();
        EXPECT_LE(bytes, prefix.decoded_bytes);
        EXPECT_TRUE(decode_radiance_layer(prefix.steps, bytes, MatrixForm::kRows).ok());
        for (const uint64_t less : {bytes - 4, bytes / 2, uint64_t{200}, uint64_t{0}})
            EXPECT_FALSE(decode_radiance_layer(prefix.steps, less, MatrixForm::kRows).ok()) << less;
        EXPECT_FALSE(decode_radiance_tile(prefix.steps, 12 * prefix.steps.size()).ok());
    }
}

TEST(RadianceLayer, SurvivesEveryMutation) {
    const auto steps = encoded(LatticeScene::towers(16, 1, 3).tile(16, 12, 2), 2);
    std::mt19937_64 random(5);
    const LayerPrefix whole(steps, kSteps);
    for (int i = 0; i < 2000; ++i) {
        std::vector<Bytes> bytes;
        for (const auto& step : steps) bytes.push_back(step.wire);
        const size_t changes = 1 + random() % 4;
        for (size_t change = 0; change < changes; ++change) {
            Bytes& some = bytes[random() % kSteps];
            some[random() % some.size()] = static_cast<std::byte>(random());
        }
        const std::vector<std::span<const std::byte>> wires(bytes.begin(), bytes.end());
        const auto words = decode_radiance_layer(wires, whole.decoded_bytes, MatrixForm::kBiclusters);
        if (!words) continue;
        EXPECT_LE(4 * words->size(), whole.decoded_bytes);
        ASSERT_TRUE(RadianceLayerView::create(*words).ok());
    }
}

TEST(RadianceLayerView, RefusesWordsThatAreNone) {
    const auto words = words_of(encoded(small_city(4)), kSteps, MatrixForm::kBiclusters);
    ASSERT_TRUE(RadianceLayerView::create(words).ok());
    for (size_t size = 0; size < words.size(); ++size)
        EXPECT_FALSE(RadianceLayerView::create(std::span(words).first(size)).ok()) << size;
    auto wrong = words;
    wrong[RECEIVER_WORD_COUNT] += 1;
    EXPECT_FALSE(RadianceLayerView::create(wrong).ok());
    wrong = words;
    wrong[RECEIVER_WORD_ENTRIES] = 0xffffffff;
    EXPECT_FALSE(RadianceLayerView::create(wrong).ok());
    const auto shape = radiance_layer_shape(words, words.size());
    wrong = words;
    wrong[shape->matrix_word + RADIANCE_WORD_RECEIVERS] -= 1;
    EXPECT_FALSE(RadianceLayerView::create(wrong).ok());
}

/// Irradiance of all receivers under a sky.
std::vector<std::array<float, 3>> lit(const RadianceTile& tile, const std::vector<Rgb>& radiance, uint32_t local_side,
                                      MatrixForm form = MatrixForm::kBiclusters) {
    const auto words = words_of(encoded(tile, local_side), kSteps, form);
    const auto view = RadianceLayerView::create(words);
    const WholeLight light = whole_light(weighted_light(radiance, tile.visibility.side));
    const auto irradiance = irradiance_words(*view, light);
    EXPECT_EQ(irradiance.size(), IRRADIANCE_WORDS * tile.places.size());
    std::vector<std::array<float, 3>> result;
    for (uint32_t r = 0; r < view->receivers(); ++r)
        result.push_back(irradiance_of(irradiance, r, irradiance_unit(light)));
    return result;
}

TEST(Irradiance, OfAUniformSkyOnOpenGroundIsPi) {
    for (const uint32_t side : {16u, 32u}) {
        RadianceTile tile = open_field(side);
        for (ReceiverPlace& place : tile.places) place.tilt = {};
        tile.visibility.frames = {frame_of_place(tile.places[0])};
        tile.visibility.frame_of.assign(tile.places.size(), 0);
        const auto above = samples_above(unpack_frame(tile.visibility.frames[0]), side);
        tile.visibility.words.clear();
        for (size_t r = 0; r < tile.places.size(); ++r)
            tile.visibility.words.insert(tile.visibility.words.end(), above.begin(), above.end());
        for (const auto& irradiance : lit(tile, std::vector<Rgb>(texel_count(side), {1, 0.5F, 100}), 8)) {
            EXPECT_NEAR(irradiance[0] / kPi, 1, 0.005);
            EXPECT_NEAR(irradiance[1] / kPi, 0.5, 0.0025);
            EXPECT_NEAR(irradiance[2] / kPi, 100, 0.5);
        }
    }
}

TEST(Irradiance, OfASunInOneTexelReachesOnlyWhoSeesIt) {
    const RadianceTile tile = small_city();
    const uint32_t side = tile.visibility.side, sun = cell_of(std::array<double, 3>{0.6, 0.3, 0.5}, side);
    std::vector<Rgb> sky(texel_count(side), {0, 0, 0});
    sky[sun] = {1e6F, 1e6F, 1e6F};
    const std::vector<std::array<float, 3>> of_sun = lit(tile, sky, kLocalSide);
    for (uint32_t k = 0; k < sky.size(); ++k) sky[k] = k == sun ? sky[k] : Rgb{1, 1, 1};
    const std::vector<std::array<float, 3>> of_both = lit(tile, sky, kLocalSide);
    uint32_t shaded = 0;
    for (uint32_t r = 0; r < tile.places.size(); ++r) {
        bool sees = false;
        for (uint32_t s = 0; s < sample_count(side); ++s)
            sees |= texel_of_sample(side, s) == sun && tile.visibility.sees(r, s);
        shaded += sees ? 0 : 1;
        EXPECT_EQ(of_sun[r][0] > 0, sees) << r;
        EXPECT_GE(of_both[r][0], of_sun[r][0] * 0.999F);
        EXPECT_TRUE(sees || of_both[r][0] <= kPi * 1.1) << "light of a sun that is not seen";
    }
    EXPECT_GT(shaded, tile.places.size() / 8);
    EXPECT_LT(shaded, tile.places.size());
}

TEST(Irradiance, OfNoLightIsNone) {
    for (const auto& irradiance : lit(small_city(4), std::vector<Rgb>(texel_count(4), {0, -3, 0}), 3)) {
        EXPECT_EQ(irradiance, (std::array<float, 3>{}));
    }
}

TEST(Irradiance, OfBothFormsIsTheSame) {
    const RadianceTile tile = small_city();
    std::mt19937_64 random(1);
    std::vector<Rgb> sky(texel_count(8));
    for (Rgb& value : sky) {
        for (float& v : value) v = static_cast<float>(random() % 1000);
    }
    EXPECT_EQ(lit(tile, sky, kLocalSide), lit(tile, sky, kLocalSide, MatrixForm::kRows));
}

TEST(Irradiance, IsNotMadeOfLightOfAnotherCube) {
    const auto words = words_of(encoded(small_city(4)), kSteps, MatrixForm::kRows);
    const auto view = RadianceLayerView::create(words);
    const auto light = [](uint32_t side) { return whole_light(std::vector<Rgb>(texel_count(side), {1, 1, 1})); };
    EXPECT_TRUE(irradiance_words(*view, light(5)).empty());
    EXPECT_TRUE(irradiance_words(*view, whole_light(std::vector<Rgb>(7, {1, 1, 1}))).empty());
    EXPECT_FALSE(irradiance_words(*view, light(4)).empty());
}

TEST(Irradiance, HalvesAreTheNearestToTheirSums) {
    std::mt19937_64 random(3);
    for (int i = 0; i < 20000; ++i) {
        const uint64_t sum = random() >> (64 - IRRADIANCE_SUM_BITS) >> random() % IRRADIANCE_SUM_BITS;
        const double exact = std::ldexp(static_cast<double>(sum), -IRRADIANCE_SUM_BITS);
        const uint32_t half = irradiance_half(sum);
        ASSERT_LE(half, IRRADIANCE_LIT);
        const double off = std::abs(half_value(half) - exact);
        ASSERT_LE(off, std::abs(half_value(std::max(half, 1u) - 1) - exact));
        ASSERT_LE(off, std::abs(half_value(half + 1) - exact));
    }
    EXPECT_EQ(irradiance_half(0), 0u);
    EXPECT_EQ(half_value(IRRADIANCE_LIT), 1);
}

}  // namespace
}  // namespace citystream::codec::radiance
