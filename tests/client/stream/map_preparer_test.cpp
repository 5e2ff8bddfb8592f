#include "client/stream/map_preparer.h"

#include <gtest/gtest.h>

#include "codec/facade/facade_wire.h"
#include "codec/facade/raw_map.h"

namespace citystream::client {
namespace {

using codec::facade::FacadeForm;
using codec::facade::RunGrid;

/// Windows in a wall, another wall for every seed.
RunGrid wall(uint32_t seed) {
    codec::facade::FacadeMatrices image;
    image.width = 120 + seed % 7;
    image.height = 90;
    image.displacement_mm.assign(size_t{image.width} * image.height, 0);
    image.material.assign(size_t{image.width} * image.height, 0);
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const bool window = x % 30 > 5 + seed % 5 && x % 30 < 25 && y % 45 > 10 && y % 45 < 40;
            if (!window) continue;
            image.displacement_mm[y * image.width + x] = static_cast<int16_t>(-100 - static_cast<int>(seed % 3) * 20);
            image.material[y * image.width + x] = 1;
        }
    }
    return *codec::facade::make_run_grid(image);
}

/// Every texel another displacement: no factors pay.
RunGrid noise() {
    codec::facade::FacadeMatrices image;
    image.width = image.height = 48;
    uint32_t state = 1;
    for (uint32_t i = 0; i < 48 * 48; ++i) {
        state = state * 1664525u + 1013904223u;
        image.displacement_mm.push_back(static_cast<int16_t>(state >> 20));
        image.material.push_back(static_cast<uint16_t>(state >> 8 & 7));
    }
    return *codec::facade::make_run_grid(image);
}

struct Shipped {
    std::vector<codec::facade::ShippedMap> maps;
    std::vector<MapJob> jobs() const {
        std::vector<MapJob> jobs;
        for (const auto& map : maps) jobs.push_back({map.wire, static_cast<uint32_t>(4 * map.words.size())});
        return jobs;
    }
};

Shipped walls(uint32_t count) {
    Shipped shipped;
    for (uint32_t i = 0; i < count; ++i) shipped.maps.push_back(codec::facade::encode_shipped_map(wall(i)));
    return shipped;
}

TEST(MapPreparer, WithoutATargetWordsAreThoseThatWereShipped) {
    const Shipped shipped = walls(9);
    const auto prepared = prepare_maps(shipped.jobs(), std::nullopt, 0);
    ASSERT_EQ(prepared.size(), shipped.maps.size());
    for (size_t i = 0; i < prepared.size(); ++i) {
        EXPECT_EQ(prepared[i].words, shipped.maps[i].words);
        EXPECT_FALSE(prepared[i].converted || prepared[i].refused);
    }
}

TEST(MapPreparer, EveryFormIsTheOneEncodedFromTheMapWhateverTheNumberOfThreads) {
    const Shipped shipped = walls(7);
    for (const FacadeForm form : codec::facade::kFacadeForms) {
        const auto one = prepare_maps(shipped.jobs(), MapTarget{form, true}, 1);
        const auto many = prepare_maps(shipped.jobs(), MapTarget{form, true}, 5);
        for (uint32_t i = 0; i < one.size(); ++i) {
            EXPECT_TRUE(one[i].converted) << codec::facade::form_name(form);
            EXPECT_EQ(one[i].words, many[i].words);
            const auto expected = codec::facade::encode_form(form, wall(i));
            ASSERT_TRUE(expected);
            EXPECT_EQ(one[i].words, *expected) << codec::facade::form_name(form);
        }
    }
}

TEST(MapPreparer, AMapThatAFormRefusesBecomesRawWithTheBoxesOfItsStepper) {
    Shipped shipped;
    shipped.maps.push_back(codec::facade::encode_shipped_map(noise()));
    uint32_t refused = 0;
    for (const FacadeForm form : {FacadeForm::kBinary, FacadeForm::kSvd}) {
        for (const bool boxes : {true, false}) {
            const auto prepared = prepare_maps(shipped.jobs(), MapTarget{form, boxes}, 1);
            ASSERT_EQ(prepared[0].refused, !prepared[0].converted);
            if (!prepared[0].refused) continue;
            EXPECT_EQ(prepared[0].words, *codec::facade::encode_raw_map(noise(), boxes));
            ++refused;
        }
    }
    EXPECT_GT(refused, 0u);
}

TEST(MapPreparer, RawWordsHaveBoxesOnlyWhereTheyAreAskedFor) {
    const Shipped shipped = walls(1);
    const auto with = prepare_maps(shipped.jobs(), MapTarget{FacadeForm::kRaw, true}, 1);
    const auto without = prepare_maps(shipped.jobs(), MapTarget{FacadeForm::kRaw, false}, 1);
    EXPECT_GT(with[0].words.size(), without[0].words.size());
}

TEST(MapPreparer, ABadPayloadFailsAloneAndSaysWhy) {
    Shipped shipped = walls(3);
    shipped.maps[1].wire.resize(shipped.maps[1].wire.size() / 2);
    const auto prepared = prepare_maps(shipped.jobs(), MapTarget{FacadeForm::kMaxMip, true}, 2);
    EXPECT_FALSE(prepared[0].words.empty());
    EXPECT_TRUE(prepared[1].words.empty());
    EXPECT_FALSE(prepared[1].failure.empty());
    EXPECT_FALSE(prepared[2].words.empty());
}

TEST(MapPreparer, NothingToDoIsDoneAtOnce) {
    EXPECT_TRUE(prepare_maps({}, std::nullopt, 0).empty());
}

}  // namespace
}  // namespace citystream::client
