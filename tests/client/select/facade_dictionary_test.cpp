#include "client/select/facade_dictionary.h"

#include <gtest/gtest.h>

#include "client/select/relief_arguments.h"

namespace citystream::client {
namespace {

using tiles::tileset::FacadeMapRecord;

/// Levels with these texels, each payload 10 bytes longer than the one before.
FacadeMapRecord record_of(uint64_t begin, const std::vector<uint16_t>& texels) {
    FacadeMapRecord record;
    record.width = record.height = 100;
    for (const uint16_t texel : texels) {
        auto& level = record.level[record.level_count++];
        begin += 10 * record.level_count;
        level.end = begin;
        level.resident_bytes = 400 / texel * 4;
        level.texel_cm = texel;
    }
    return record;
}

FacadeDictionary dictionary() {
    FacadeDictionary out;
    out.learn({record_of(0, {16, 4, 1}), record_of(60, {1}), record_of(70, {8, 4, 2, 1})});
    return out;
}

TEST(FacadeDictionary, PayloadsFollowEachOtherLevelByLevelAndMapByMap) {
    const FacadeDictionary d = dictionary();
    uint64_t at = 0;
    std::vector<MapPiece> order;
    for (MapPiece piece = 0; map_of(piece) < d.size(); piece = d.next(piece)) {
        EXPECT_EQ(d.begin(piece), at);
        at += d.wire_bytes(piece);
        order.push_back(piece);
    }
    EXPECT_EQ(order, (std::vector<MapPiece>{map_piece(0, 0), map_piece(0, 1), map_piece(0, 2), map_piece(1, 0),
                                            map_piece(2, 0), map_piece(2, 1), map_piece(2, 2), map_piece(2, 3)}));
    EXPECT_EQ(at, 170u);
}

TEST(FacadeDictionary, WantsTheCoarsestLevelWhoseTexelsAreSmallEnough) {
    const FacadeDictionary d = dictionary();
    EXPECT_EQ(d.wanted(0, {1.0, {}}), map_piece(0, 0));
    EXPECT_EQ(d.wanted(0, {0.16, {}}), map_piece(0, 0));
    EXPECT_EQ(d.wanted(0, {0.159, {}}), map_piece(0, 1));
    EXPECT_EQ(d.wanted(0, {0.039, {}}), map_piece(0, 2));
    EXPECT_EQ(d.wanted(0, {0.0001, {}}), map_piece(0, 2)) << "there is no finer one";
    EXPECT_EQ(d.wanted(1, {1.0, {}}), map_piece(1, 0));
    EXPECT_EQ(d.wanted(3, {1.0, {}}), std::nullopt);
}

TEST(FacadeDictionary, AForcedLevelIsTheFinestWhereAMapHasFewer) {
    const FacadeDictionary d = dictionary();
    EXPECT_EQ(d.wanted(0, {1.0, 2}), map_piece(0, 2));
    EXPECT_EQ(d.wanted(0, {0.0, 0}), map_piece(0, 0));
    EXPECT_EQ(d.wanted(0, {0.0, 3}), map_piece(0, 2));
    EXPECT_EQ(d.wanted(1, {0.0, 3}), map_piece(1, 0));
}

TEST(FacadeDictionary, TheNextCoarserLevelStandsInForOneThatCannotBeHadThenTheNextFiner) {
    FacadeDictionary d = dictionary();
    d.set_usable(map_piece(2, 2), false);
    EXPECT_EQ(d.wanted(2, {0.02, {}}), map_piece(2, 1));
    d.set_usable(map_piece(2, 1), false);
    d.set_usable(map_piece(2, 0), false);
    EXPECT_EQ(d.wanted(2, {0.02, {}}), map_piece(2, 3));
    EXPECT_TRUE(d.has_usable_level(2));
    d.set_usable(map_piece(2, 3), false);
    EXPECT_EQ(d.wanted(2, {0.02, {}}), std::nullopt);
    EXPECT_FALSE(d.has_usable_level(2));
    d.set_usable(map_piece(2, 1), true);
    EXPECT_EQ(d.wanted(2, {0.0, {}}), map_piece(2, 1));
}

TEST(FacadeDictionary, AConvertedSizeIsUsedOnceItIsLearntAndChoicesHearOfIt) {
    FacadeDictionary d = dictionary();
    const uint64_t shipped = d.resident_bytes(map_piece(0, 1)), before = d.changes(), host = d.host_bytes();
    EXPECT_EQ(shipped, 400u);
    d.learn_size(map_piece(0, 1), 40'000);
    EXPECT_EQ(d.resident_bytes(map_piece(0, 1)), 40'000u);
    EXPECT_EQ(d.resident_bytes(map_piece(0, 2)), 1600u);
    EXPECT_GT(d.changes(), before);
    EXPECT_GT(d.host_bytes(), host);
    const uint64_t after = d.changes();
    d.learn_size(map_piece(0, 1), 40'000);
    EXPECT_EQ(d.changes(), after) << "nothing new";
}

TEST(ReliefArguments, AutoAndLevelsAreUnderstoodAndNothingElse) {
    EXPECT_EQ(parse_relief_options("auto", 2.0)->map_level, std::nullopt);
    EXPECT_EQ(parse_relief_options("auto", 2.0)->tolerance_pixels, 2.0);
    EXPECT_EQ(parse_relief_options("3", std::nullopt)->map_level, 3u);
    for (const char* wrong : {"4", "-1", "", "auto ", "fine"}) {
        const auto parsed = parse_relief_options(wrong, std::nullopt);
        ASSERT_FALSE(parsed) << wrong;
        EXPECT_NE(parsed.error().text().find("--map-level"), std::string::npos);
    }
    EXPECT_EQ(map_level_names().size(), 5u);
}

}  // namespace
}  // namespace citystream::client
