#include "codec/radiance/receiver_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "tests/shaders/receiver_lookup_on_cpu.h"

namespace citystream::codec::radiance {
namespace {

constexpr uint32_t kSpacing = 11;  // 2 m
constexpr float kMetre = 1024;

/// Ground at height 0 and a roof at 10 m over columns 0..3 x 0..3, and one wall receiver.
std::vector<ReceiverPlace> few_places() {
    std::vector<ReceiverPlace> places = {{0, {2, -5}, 3000, {-7, 90}}};
    for (int32_t j = 0; j < 4; ++j) {
        for (int32_t i = 0; i < 4; ++i) {
            places.push_back({4, {i, j}, 0, {0, 0}});
            places.push_back({4, {i, j}, 10240, {0, 0}});
        }
    }
    return places;
}

std::vector<ReceiverPlace> random_places(uint32_t seed, size_t count) {
    std::mt19937 random(seed);
    std::vector<ReceiverPlace> places(count);
    for (ReceiverPlace& place : places) {
        place.surface_class = static_cast<uint32_t>(random() % 6);
        place.column = {static_cast<int32_t>(random() % 40) - 20, static_cast<int32_t>(random() % 40) - 20};
        place.depth = (static_cast<int32_t>(random() % 2000) - 1000) * 32;  // 64ths of the spacing
        place.tilt = {static_cast<int8_t>(random() % 255 - 127), static_cast<int8_t>(random() % 255 - 127)};
    }
    std::sort(places.begin(), places.end(), [](const ReceiverPlace& a, const ReceiverPlace& b) {
        return std::tuple(a.surface_class, a.column[1], a.column[0], a.depth) <
               std::tuple(b.surface_class, b.column[1], b.column[0], b.depth);
    });
    return places;
}

std::vector<uint32_t> written(std::span<const ReceiverPlace> places) {
    auto words = write_receiver_table(places, kSpacing);
    EXPECT_TRUE(words) << words.error().text();
    return std::move(*words);
}

ReceiverShares ask(const std::vector<uint32_t>& words, const std::array<float, 3>& metres,
                   const std::array<float, 3>& normal) {
    const auto view = ReceiverTableView::create(words);
    EXPECT_TRUE(view) << view.error().text();
    return view->shares({metres[0] * kMetre, metres[1] * kMetre, metres[2] * kMetre}, normal);
}

TEST(ReceiverTable, ReadsWhatWasWritten) {
    for (uint32_t seed = 0; seed < 30; ++seed) {
        const auto places = random_places(seed, seed * 37);
        const auto words = written(places);
        const auto view = ReceiverTableView::create(words);
        ASSERT_TRUE(view) << view.error().text();
        EXPECT_EQ(view->count(), places.size());
        EXPECT_EQ(view->spacing(), 2048);
        EXPECT_EQ(view->places(), places);
    }
}

TEST(ReceiverTable, KeepsItsBytes) {
    const std::vector<ReceiverPlace> places = {
        {0, {2, -5}, 3000, {-7, 90}}, {4, {0, 1}, 64, {0, 0}}, {4, {2, 1}, 0, {1, -1}}};
    std::vector<uint32_t> expected(RECEIVER_HEADER_WORDS, 0);
    expected[0] = RECEIVER_MAGIC;
    expected[1] = 3;
    expected[2] = kSpacing;
    expected[3] = 37;                         // receivers
    expected[4] = static_cast<uint32_t>(-5);  // +x: row, rows, table, depth
    expected[5] = 1;
    expected[6] = 28;
    expected[7] = 2048;
    expected[20] = 1;  // +z
    expected[21] = 1;
    expected[22] = 32;
    expected.insert(expected.end(), {0x00010002, 31, 0, 0x00010000});              // one column
    expected.insert(expected.end(), {0x00030000, 35, 1, 0x00010000, 0x00020001});  // three, the middle one empty
    expected.insert(expected.end(), {0x5af9001e, 0x00000002, 0xff010000});
    EXPECT_EQ(written(places), expected);
}

TEST(ReceiverTable, BetweenColumnsTheFourReceiversShareBilinearly) {
    const auto words = written(few_places());
    const auto shares = ask(words, {2.5F, 3, 0}, {0, 0, 1});
    ASSERT_EQ(shares.count, 4U);
    const auto view = ReceiverTableView::create(words);
    const auto places = view->places();
    const std::array<float, 4> weights = {0.375F, 0.125F, 0.375F, 0.125F};
    for (uint32_t k = 0; k < 4; ++k) {
        const ReceiverPlace& place = places[shares.receiver[k]];
        EXPECT_EQ(place.column,
                  (std::array<int32_t, 2>{1 + static_cast<int32_t>(k % 2), 1 + static_cast<int32_t>(k / 2)}));
        EXPECT_EQ(place.depth, 0);
        EXPECT_NEAR(shares.weight[k], weights[k], 1e-6);
    }
    const auto roof = ask(words, {2.5F, 3, 10}, {0, 0, 3});
    ASSERT_EQ(roof.count, 4U);
    EXPECT_EQ(places[roof.receiver[0]].depth, 10240);
}

TEST(ReceiverTable, WeightsOfThoseThatAreThereAddUpToOne) {
    const auto words = written(few_places());
    const auto border = ask(words, {-0.5F, 3, 0}, {0, 0, 1});
    ASSERT_EQ(border.count, 2U);
    EXPECT_NEAR(border.weight[0] + border.weight[1], 1, 1e-6);
    const auto corner = ask(words, {6, 6, 0}, {0, 0, 1});
    ASSERT_EQ(corner.count, 1U);
    EXPECT_EQ(corner.weight[0], 1);
}

TEST(ReceiverTable, OtherDepthsOtherNormalsAndOtherPlacesAreNotServed) {
    const auto words = written(few_places());
    const auto served = [&](const std::array<float, 3>& metres, const std::array<float, 3>& normal) {
        const auto shares = ask(words, metres, normal);
        return shares.own_surface ? shares.count : 0;
    };
    EXPECT_EQ(served({3, 3, 0.9F}, {0, 0, 1}), 4U);
    EXPECT_EQ(served({3, 3, 1.2F}, {0, 0, 1}), 0U);
    EXPECT_EQ(served({3, 3, 5}, {0, 0, 1}), 0U);
    EXPECT_EQ(served({3, 3, 0}, {0, 0, -1}), 0U);
    EXPECT_EQ(served({3, 3, 0}, {1, 0, 0}), 0U);
    EXPECT_EQ(served({3, 3, 0}, {0.5F, 0, 1}), 4U) << "27 degrees";
    EXPECT_EQ(served({3, 3, 0}, {0.65F, 0, 1}), 0U) << "33 degrees";
    EXPECT_EQ(served({40, 3, 0}, {0, 0, 1}), 0U);
}

TEST(ReceiverTable, WhereASurfaceHasNoneTheNearestOfAnotherStandsIn) {
    const auto words = written(few_places());
    const auto places = ReceiverTableView::create(words)->places();
    // The side of something small on the ground, and of something on the roof.
    const auto low = ask(words, {3, 3, 0.3F}, {0, 1, 0}), high = ask(words, {3, 3, 10.3F}, {0, 1, 0});
    for (const auto& shares : {low, high}) {
        ASSERT_EQ(shares.count, 1U);
        EXPECT_FALSE(shares.own_surface);
        EXPECT_EQ(shares.weight[0], 1);
    }
    EXPECT_EQ(places[low.receiver[0]].depth, 0);
    EXPECT_EQ(places[high.receiver[0]].depth, 10240);
    EXPECT_EQ(places[low.receiver[0]].column, (std::array<int32_t, 2>{1, 1}));
    EXPECT_EQ(low.normal, (std::array<float, 3>{0, 0, RECEIVER_TILT_ONE}));
    // What looks away takes none of the ground, not even by a little, and what is far from all has none.
    EXPECT_EQ(ask(words, {3, 3, 0.3F}, {0, 0, -1}).count, 0U);
    EXPECT_EQ(ask(words, {3, 3, 0.3F}, {0, 1, -0.1F}).count, 0U);
    EXPECT_EQ(ask(words, {3, 3, 5}, {0, 1, 0}).count, 0U);
    EXPECT_EQ(ask(words, {40, 3, 0}, {0, 0, 1}).count, 0U);
}

TEST(ReceiverTable, WhatIsTurnedAsTheSurfaceIsStandsInBeforeWhatIsALittleNearer) {
    // Under a crown: its base looks down 1 m below, the ground up 2 m below; beside it a wall.
    const std::vector<ReceiverPlace> places = {
        {0, {0, 0}, -1200, {0, 0}}, {4, {0, 0}, -2048, {0, 0}}, {5, {0, 0}, -512, {0, 0}}};
    const auto words = written(places);
    const auto side = ask(words, {0, 0, 0}, {1, 0, 0.2F});
    ASSERT_EQ(side.count, 1U);
    EXPECT_EQ(side.receiver[0], 0U);
    EXPECT_EQ(side.normal, (std::array<float, 3>{RECEIVER_TILT_ONE, 0, 0}));
    // The base stands in for what looks down alone, however near it is.
    const auto under = ask(words, {0, 0, -0.5F}, {0.8F, 0, -1});
    ASSERT_EQ(under.count, 1U);
    EXPECT_EQ(under.receiver[0], 2U);
    EXPECT_FALSE(under.own_surface);
    EXPECT_EQ(ask(words, {0, 0, -0.5F}, {0, 1, 0}).receiver[0], 0U);
    const auto other_side = ask(words, {0, 0, 0}, {-1, 0, 0.2F});
    ASSERT_EQ(other_side.count, 1U);
    EXPECT_EQ(other_side.receiver[0], 1U);
}

TEST(ReceiverTable, ASlopesReceiversAreFoundFromAnywhereOnIt) {
    // z = 0.5 x: a column's depth is that of the plane there.
    std::vector<ReceiverPlace> places;
    for (int32_t j = 0; j < 9; ++j) {
        for (int32_t i = 0; i < 9; ++i) places.push_back({4, {i, j}, i * 1024, {-64, 0}});
    }
    const auto words = written(places);
    for (int i = 0; i < 22; ++i) {
        const float x = 0.15F + 0.7F * static_cast<float>(i);
        EXPECT_EQ(ask(words, {x, 7.3F, x / 2}, {-0.5F, 0, 1}).count, 4U) << x;
        EXPECT_FALSE(ask(words, {x, 7.3F, x / 2 + 1.2F}, {-0.5F, 0, 1}).own_surface) << x;
    }
}

TEST(ReceiverTable, OfSeveralThatServeTheNearestInDepthDoes) {
    const auto words = written(std::vector<ReceiverPlace>{
        {4, {0, 0}, -900, {0, 0}}, {4, {0, 0}, -320, {0, 0}}, {4, {0, 0}, 256, {0, 0}}, {4, {0, 0}, 320, {120, 0}}});
    const auto at_zero = ask(words, {0, 0, 0}, {0, 0, 1});
    ASSERT_EQ(at_zero.count, 1U);
    EXPECT_EQ(at_zero.receiver[0], 2U);
    EXPECT_EQ(ask(words, {0, 0, -0.5F}, {0, 0, 1}).receiver[0], 1U);
    EXPECT_EQ(ask(words, {0, 0, 0.3F}, {0, 0, 1}).receiver[0], 2U) << "the nearer one is tilted";
}

TEST(ReceiverTable, AnyQuestionHasAnAnswer) {
    const auto words = written(random_places(5, 3000));
    const auto view = ReceiverTableView::create(words);
    ASSERT_TRUE(view);
    constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
    const std::array<float, 9> odd = {0, -0.0F, 1, -1, 1e38F, -1e38F, kInfinity, kNan, 1e-45F};
    for (uint32_t i = 0; i < 9 * 9 * 9 * 9; ++i) {
        const float a = odd[i % 9], b = odd[i / 9 % 9], c = odd[i / 81 % 9], d = odd[i / 729];
        for (const auto& [point, normal] :
             {std::pair<std::array<float, 3>, std::array<float, 3>>{{a, b, 1}, {c, d, 1}}, {{a, 5, b}, {0, c, d}}}) {
            const auto shares = view->shares(point, normal);
            ASSERT_LE(shares.count, 4U);
            for (uint32_t k = 0; k < shares.count; ++k) ASSERT_LT(shares.receiver[k], view->count());
        }
    }
}

/// The shader and the view say the same of one question.
void expect_twins(const std::vector<uint32_t>& words, const ReceiverTableView& view, const std::array<float, 3>& point,
                  const std::array<float, 3>& normal) {
    const auto shares = view.shares(point, normal);
    const auto twin = shaders_test::receivers_on_cpu(words, point, normal);
    ASSERT_EQ(twin.count, shares.count);
    if (shares.count == 0) return;
    EXPECT_EQ(twin.own_surface, shares.own_surface);
    EXPECT_EQ(twin.normal, shares.normal);
    for (uint32_t k = 0; k < shares.count; ++k) {
        EXPECT_EQ(twin.receiver[k], shares.receiver[k]);
        EXPECT_EQ(twin.weight[k], shares.weight[k]);
    }
}

TEST(ReceiverTable, TheShaderFindsTheSame) {
    std::mt19937 random(4);
    const auto number = [&random](uint32_t most) {
        return static_cast<float>(random() % (2 * most)) - static_cast<float>(most);
    };
    size_t found = 0;
    for (uint32_t seed = 0; seed < 5; ++seed) {
        const auto places = random_places(seed, 4000);
        const auto words = written(places);
        const auto view = ReceiverTableView::create(words);
        ASSERT_TRUE(view);
        for (const ReceiverPlace& place : places) {
            expect_twins(words, *view, {number(41000), number(41000), number(41000)},
                         {number(100), number(100), number(100)});
            // At a receiver's own column, within its tolerance or just out of it.
            const uint32_t own = place.surface_class / 2;
            std::array<float, 3> point{}, normal{};
            point[own] = static_cast<float>(place.depth) + number(1200);
            point[(own + 1) % 3] = static_cast<float>(place.column[0]) * 2048 + number(300);
            point[(own + 2) % 3] = static_cast<float>(place.column[1]) * 2048 + number(300);
            normal[own] = place.surface_class % 2 == 0 ? 1 : -1;
            normal[(own + 1) % 3] = static_cast<float>(place.tilt[0]) / 127;
            normal[(own + 2) % 3] = static_cast<float>(place.tilt[1]) / 127;
            expect_twins(words, *view, point, normal);
            found += view->shares(point, normal).count;
        }
    }
    EXPECT_GT(found, 10000U);
    const auto words = written(few_places());
    const auto view = ReceiverTableView::create(words);
    EXPECT_EQ(shaders_test::receivers_on_cpu(words, {2.5F * kMetre, 3 * kMetre, 0}, {0, 0, 1}).count, 4U);
    // Header and class, of each of two rows the row and two words of begins, of each column two receivers.
    EXPECT_LE(shaders_test::receivers_on_cpu(words, {2.5F * kMetre, 3 * kMetre, 0}, {0, 0, 1}).loads,
              2U + 2 * 5U + 4 * 2U);
}

TEST(ReceiverTable, WhatCannotBeWrittenIsSaid) {
    EXPECT_FALSE(write_receiver_table({}, 5));
    EXPECT_FALSE(write_receiver_table({}, 21));
    EXPECT_TRUE(write_receiver_table({}, 6));
    const auto fails = [](const std::vector<ReceiverPlace>& places) { return !write_receiver_table(places, kSpacing); };
    EXPECT_TRUE(fails({{6, {0, 0}, 0, {0, 0}}}));
    EXPECT_TRUE(fails({{4, {32768, 0}, 0, {0, 0}}}));
    EXPECT_TRUE(fails({{4, {0, 1}, 0, {0, 0}}, {4, {0, 0}, 0, {0, 0}}}));
    EXPECT_TRUE(fails({{4, {0, 0}, 5, {0, 0}}, {4, {0, 0}, 0, {0, 0}}}));
    EXPECT_TRUE(fails({{4, {0, 0}, 0, {0, 0}}, {4, {0, 1}, 1023 * 2048, {0, 0}}}));
    EXPECT_FALSE(fails({{4, {0, 0}, 0, {0, 0}}, {4, {0, 1}, 1022 * 2048, {0, 0}}}));
    EXPECT_TRUE(fails(std::vector<ReceiverPlace>(65536, {4, {0, 0}, 0, {0, 0}})));
    EXPECT_TRUE(fails(std::vector<ReceiverPlace>(RECEIVER_MOST + 1, {4, {0, 0}, 0, {0, 0}})));
}

TEST(ReceiverTable, EveryShorterTableIsRefused) {
    const auto words = written(random_places(9, 300));
    for (size_t size = 0; size < words.size(); ++size) {
        const auto view = ReceiverTableView::create(std::span(words).first(size));
        // Entries are the last words: without the last ones others take their place, but rows end in them.
        ASSERT_FALSE(view) << size;
        EXPECT_NE(view.error().offset, Error::kNoOffset);
    }
}

TEST(ReceiverTable, WordsThatNobodyVouchesForAreReadWithinTheirBounds) {
    const auto good = written(random_places(11, 400));
    std::mt19937 random(2);
    size_t accepted = 0;
    for (int round = 0; round < 20000; ++round) {
        // Exactly as large as the words, so that a sanitizer sees a word too many.
        std::vector<uint32_t> words(good.begin(), good.end() - (round % 5 == 0 ? random() % good.size() : 0));
        for (auto change = random() % 4; change-- > 0 && !words.empty();) {
            const size_t at =
                random() % 2 == 0 ? random() % words.size() : random() % std::min<size_t>(words.size(), 60);
            words[at] = random() % 3 == 0 ? static_cast<uint32_t>(random()) : words[at] ^ 1U << random() % 32;
        }
        const auto view = ReceiverTableView::create(words);
        if (!view) continue;
        ++accepted;
        ASSERT_EQ(view->places().size(), view->count());
        for (int question = 0; question < 20; ++question) {
            const auto number = [&] { return static_cast<float>(static_cast<int32_t>(random() % 100000) - 50000); };
            const auto shares = view->shares({number(), number(), number()}, {number(), number(), number()});
            for (uint32_t k = 0; k < shares.count; ++k) ASSERT_LT(shares.receiver[k], view->count());
            ASSERT_NO_THROW(
                shaders_test::receivers_on_cpu(words, {number(), number(), number()}, {number(), number(), number()}));
        }
    }
    EXPECT_GT(accepted, 1000U);
}

}  // namespace
}  // namespace citystream::codec::radiance
