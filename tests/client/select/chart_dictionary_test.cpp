#include "client/select/chart_dictionary.h"

#include <gtest/gtest.h>

#include "client/select/city_knowledge.h"
#include "codec/atlas/shared_chart.h"

namespace citystream::client {
namespace {

using codec::atlas::SharedChartUse;
using tiles::tileset::ChartRecord;

/// A chart of side x side texels, its payloads each 10 bytes longer than the one before.
ChartRecord record_of(uint32_t side) {
    ChartRecord record;
    record.width = record.height = static_cast<uint16_t>(side);
    record.colour = {1, 2, 3};
    record.level_count = codec::atlas::atlas_step_count(side, side, 0);
    for (uint32_t level = 0; level < record.level_count; ++level) record.level[level].bytes = 10 * (level + 1);
    return record;
}

/// Chart i has 1 + i % 3 levels.
ChartDictionary dictionary(uint32_t count) {
    std::vector<ChartRecord> records;
    for (uint32_t i = 0; i < count; ++i) records.push_back(record_of(64u << i % 3));
    tiles::tileset::place_chart_levels(records);
    ChartDictionary out;
    out.learn(std::move(records));
    return out;
}

TEST(ChartDictionary, PayloadsFollowEachOtherLevelByLevelInBlocksOfCharts) {
    const ChartDictionary d = dictionary(150);
    uint64_t at = 0;
    uint32_t pieces = 0;
    for (ChartPiece piece = 0; chart_of(piece) < d.size(); piece = d.next(piece)) {
        EXPECT_EQ(d.begin(piece), at) << "chart " << chart_of(piece) << ", level " << chart_level_of(piece);
        EXPECT_EQ(chart_piece(chart_of(piece), chart_level_of(piece)), piece);
        EXPECT_LT(piece, d.next(piece));
        at = d.end(piece);
        ++pieces;
    }
    EXPECT_EQ(pieces, 50u * (1 + 2 + 3));
    EXPECT_EQ(d.next(chart_piece(63, 0)), chart_piece(1, 1)) << "level 1 of the block, of which chart 0 has none";
    EXPECT_EQ(d.next(chart_piece(62, 2)), chart_piece(64, 0));
}

TEST(ChartDictionary, WantsTheShortestPrefixWhoseTexelsProjectBelowTheTolerance) {
    const ChartDictionary d = dictionary(3);
    const SharedChartUse use = {0, 2, 0.25f};  // levels hold texels of 1, 0.5 and 0.25 m
    const auto levels = [&](double pixels_per_metre, double tolerance) {
        const ChartPrefix wanted = d.wanted(use, pixels_per_metre, tolerance);
        EXPECT_EQ(wanted.chart, 2u);
        return wanted.levels;
    };
    EXPECT_EQ(levels(1, 1), 1u);
    EXPECT_EQ(levels(1.001, 1), 2u);
    EXPECT_EQ(levels(2, 1), 2u);
    EXPECT_EQ(levels(2.001, 1), 3u);
    EXPECT_EQ(levels(100, 1), 3u) << "there is no finer level";
    EXPECT_EQ(levels(2.001, 2.001), 1u);
    EXPECT_EQ(d.wanted({0, 0, 0.25f}, 100, 1).levels, 1u);
}

TEST(ChartDictionary, SizesOfPrefixesAreThoseOfTheirLevels) {
    const ChartDictionary d = dictionary(3);
    EXPECT_EQ(d.wire_bytes(ChartPrefix{2, 0}), 0u);
    EXPECT_EQ(d.wire_bytes(ChartPrefix{2, 2}), 30u);
    EXPECT_EQ(d.finest_mip({2, 1}), 2u);
    EXPECT_EQ(d.finest_mip({2, 3}), 0u);
    uint64_t bytes = 0;
    for (uint32_t level = 0; level < 3; ++level) {
        bytes += 4 * codec::atlas::atlas_step_words(256, 256, 0, level);
        EXPECT_EQ(d.decoded_bytes({2, level + 1}), bytes);
        EXPECT_EQ(d.finest_mip({2, level + 1}), codec::atlas::atlas_step_finest_mip(256, 256, 0, level));
    }
    EXPECT_EQ(d.colour(2), 0x030201u);
}

TEST(ChartDictionary, AMissingLevelEndsAChartUntilItIsBackAndADamagedOneForGood) {
    ChartDictionary d = dictionary(3);
    const SharedChartUse use = {0, 2, 0.25f};
    uint64_t changes = d.changes();
    d.set_missing(chart_piece(2, 1), true);
    EXPECT_GT(d.changes(), changes);
    EXPECT_EQ(d.wanted(use, 100, 1).levels, 1u);
    EXPECT_TRUE(d.usable(chart_piece(2, 0)));
    EXPECT_FALSE(d.usable(chart_piece(2, 2))) << "a level without the one before it is of no use";
    d.set_missing(chart_piece(2, 1), false);
    EXPECT_EQ(d.wanted(use, 100, 1).levels, 3u);

    changes = d.changes();
    EXPECT_FALSE(d.note_damage(chart_piece(2, 2)));
    EXPECT_FALSE(d.note_damage(chart_piece(2, 0))) << "each level has a second try of its own";
    EXPECT_EQ(d.changes(), changes);
    EXPECT_TRUE(d.note_damage(chart_piece(2, 0)));
    EXPECT_GT(d.changes(), changes);
    d.set_missing(chart_piece(2, 0), true);
    d.set_missing(chart_piece(2, 0), false);
    EXPECT_EQ(d.wanted(use, 100, 1).levels, 0u);
    EXPECT_EQ(d.usable_levels(1), 2u) << "other charts are well";
}

TEST(ChartDictionary, MergedPrefixesHoldEachChartOnceWithItsLongest) {
    std::vector<ChartPrefix> prefixes = {{5, 1}, {2, 3}, {5, 4}, {2, 1}, {9, 2}};
    merge_prefixes(prefixes);
    EXPECT_EQ(prefixes, (std::vector<ChartPrefix>{{2, 3}, {5, 4}, {9, 2}}));
    EXPECT_EQ(levels_in(prefixes, 5), 4u);
    EXPECT_EQ(levels_in(prefixes, 4), 0u);
    EXPECT_EQ(levels_in(prefixes, 10), 0u);
}

}  // namespace
}  // namespace citystream::client
