#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <utility>

#include "tests/tiles/tileset/synthetic_city.h"
#include "tiles/tileset/chart_index.h"
#include "tiles/tileset/subtree_order.h"
#include "tiles/tileset/tile_schema.h"

namespace citystream::tiles::tileset {
namespace {

using Bytes = std::vector<std::byte>;

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// Replaces text of the same length in a file.
Bytes replaced(const Bytes& bytes, const std::string& from, const std::string& to) {
    EXPECT_EQ(from.size(), to.size());
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    text = replaced(std::move(text), from, to);
    const auto other = bytes_of(text);
    return {other.begin(), other.end()};
}

SyntheticCity small_city() {
    return make_synthetic_city(7, 3, 2);
}

void add_chart_dictionary(Manifest& manifest, uint32_t seed) {
    manifest.shared_chart_count = 1 + seed;
    manifest.chart_index_bytes = 100 + seed;
    manifest.chart_index_decoded_bytes = 1000;
    manifest.chart_index_checksum = 0xfedcba9876543210 - seed;
    manifest.chart_levels_bytes = 12345;
}

TEST(TilesetJson, TheChartDictionaryIsThereOnlyWhereChartsAreShared) {
    Manifest manifest = small_city().manifest;
    EXPECT_EQ(write_tileset_json(manifest).find("chartDictionary"), std::string::npos);
    add_chart_dictionary(manifest, 4);
    const std::string json = write_tileset_json(manifest);
    const std::vector<std::array<std::string, 3>> kCases = {
        {"\"count\": 5", "\"count\": 0", "chartDictionary.count"},
        {"\"count\": 5", "\"count\": 99999999", "chartDictionary.count"},
        {"\"levelsUri\": \"charts/levels\"", "\"levelsUri\": \"../levels\"", "levelsUri"},
        {"\"indexUri\": \"charts/index\"", "\"indexUri\": \"charts\"", "chartDictionary.indexUri"},
        {"\"levelsBytes\": 12345", "\"levelsBytes\": 4294967296", "levelsBytes"},
        {"\"levelsBytes\"", "\"otherBytes\"", "levelsBytes"},
    };
    for (const auto& [from, to, named] : kCases) {
        const auto parsed = parse_tileset_json(bytes_of(replaced(json, from, to)));
        ASSERT_FALSE(parsed.ok()) << from << " -> " << to;
        EXPECT_NE(parsed.error().message.find(named), std::string::npos) << parsed.error().message;
    }
}

TEST(TilesetJson, SaysWhetherThereArePagesOrAlpha) {
    Manifest manifest = small_city().manifest;
    for (const bool there : {false, true}) {
        manifest.pages_or_alpha = there;
        const auto parsed = parse_tileset_json(bytes_of(write_tileset_json(manifest)));
        ASSERT_TRUE(parsed.ok()) << parsed.error().text();
        EXPECT_EQ(*parsed, manifest);
    }
    const std::string json = write_tileset_json(manifest);
    const std::string property = "\"pagesOrAlpha\": true,";
    EXPECT_FALSE(parse_tileset_json(bytes_of(replaced(json, property, ""))).ok());
}

TEST(TilesetJson, TheRadianceLayerSaysHowItWasBakedOnlyWhereItIsThere) {
    Manifest manifest = small_city().manifest;
    EXPECT_EQ(write_tileset_json(manifest).find("texelsAcross"), std::string::npos);
    manifest.has_layer[static_cast<size_t>(Layer::kRadiance)] = true;
    manifest.radiance_texels_across = 16;
    manifest.radiance_local_across = 12;
    manifest.radiance_lattice_metres = 2;
    const std::string json = write_tileset_json(manifest);
    const auto back = parse_tileset_json(bytes_of(json));
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(*back, manifest);
    const std::vector<std::array<std::string, 3>> kCases = {
        {"\"texelsAcross\": 16", "\"texelsAcross\": 65", "layers.radiance.texelsAcross"},
        {"\"texelsAcross\": 16", "\"texelsAcross\": 0", "layers.radiance.texelsAcross"},
        {"\"localAcross\": 12", "\"localAcross\": 33", "layers.radiance.localAcross"},
        {"\"latticeMetres\": 2", "\"latticeMetres\": 128", "layers.radiance.latticeMetres"},
        {"\"latticeMetres\"", "\"lattice\"", "layers.radiance.latticeMetres"},
    };
    for (const auto& [from, to, named] : kCases) {
        const auto parsed = parse_tileset_json(bytes_of(replaced(json, from, to)));
        ASSERT_FALSE(parsed.ok()) << from << " -> " << to;
        EXPECT_NE(parsed.error().message.find(named), std::string::npos) << parsed.error().message;
    }
}

TEST(TilesetJson, ManifestsComeBackExactly) {
    for (uint32_t seed = 0; seed < 20; ++seed) {
        Manifest manifest = make_synthetic_city(seed, 1 + seed % 5, 1 + seed % 4).manifest;
        manifest.root_geometric_error = 0.1 + seed / 3.0;
        manifest.extent.min[0] = -0.1 * seed;
        manifest.triangles = (uint64_t{1} << 53) + seed;
        manifest.facade_index_checksum = 0x0123456789abcdef * (seed + 1);
        manifest.has_layer[3] = seed % 2 == 1;
        if (seed % 3 == 0) manifest.greatest_subtree_bytes = 0;
        if (seed % 2 == 0) add_chart_dictionary(manifest, seed);
        const auto parsed = parse_tileset_json(bytes_of(write_tileset_json(manifest)));
        ASSERT_TRUE(parsed.ok()) << parsed.error().text();
        EXPECT_EQ(*parsed, manifest);
    }
}

TEST(TilesetJson, EveryTruncationIsRefused) {
    const std::string json = write_tileset_json(small_city().manifest);
    for (size_t size = 0; size + 2 < json.size(); ++size) {
        EXPECT_FALSE(parse_tileset_json(bytes_of(json.substr(0, size))).ok()) << size;
    }
}

TEST(TilesetJson, MutationsNeverCrash) {
    std::string json = write_tileset_json(small_city().manifest);
    size_t tried = 0;
    size_t accepted = 0;
    for (size_t i = json.find("\"root\""); i < json.size(); ++i) {
        const char kept = json[i];
        if (kept == ' ') continue;
        for (const char c : {'9', '"', '{', static_cast<char>(kept ^ 1)}) {
            json[i] = c;
            ++tried;
            accepted += parse_tileset_json(bytes_of(json)).ok() ? 1 : 0;
        }
        json[i] = kept;
    }
    EXPECT_LT(accepted, tried / 2);
}

TEST(TilesetJson, WrongFieldsAreNamed) {
    const std::string json = write_tileset_json(small_city().manifest);
    const std::vector<std::array<std::string, 3>> kCases = {
        {"\"version\": \"1.1\"", "\"version\": \"1.0\"", "asset.version"},
        {"\"REPLACE\"", "\"ADD\"", "refine"},
        {"\"QUADTREE\"", "\"OCTREE\"", "subdivisionScheme"},
        {"\"availableLevels\": 3", "\"availableLevels\": 25", "availableLevels"},
        {"\"availableLevels\": 3", "\"availableLevels\": 0", "availableLevels"},
        {"\"subtreeLevels\": 2", "\"subtreeLevels\": 9", "subtreeLevels"},
        {"\"subtreeLevels\": 2", "\"subtreeLevels\": 2.5", "subtreeLevels"},
        {"subtrees/{level}", "subtrees/{z}", "subtrees.uri"},
        {"\"gridBits\": 10", "\"gridBits\": 11", "gridBits"},
        {"\"rootSideLog2\": 10", "\"rootSideLog2\": 11", "boundingVolume.box"},
        {"\"rootSideLog2\": 10", "\"rootSideLog2\": 99", "rootSideLog2"},
        {"\"x\": 694157312", "\"x\": 694157313", "origin.x"},
        {"\"x\": 694157312", "\"x\": \"694157312m\"", "origin.x"},
        {"0.125", "1e999", "not valid JSON"},
        {"0.125", "2000.0", "extent.min"},
        {"\"epsg\": 25832", "\"epsg\": -1", "epsg"},
        {"CITYSTREAM_layers\": {", "OTHER_layers\": {", "CITYSTREAM_layers"},
        {"\"version\": 7,", "\"version\": 6,", "CITYSTREAM_layers.version"},
        {"\"version\": 7,", "\"version\": 8,", "CITYSTREAM_layers.version"},
        {"\"indexChecksum\": \"", "\"indexChecksum\": \"x", "indexChecksum"},
        {"tiles/{level}/{x}/{y}.atlas", "../{level}/{x}/{y}.atlas", "atlas.uri"},
        {"\"mapsUri\": \"facades/maps\"", "\"mapsUri\": \"http://a/b\"", "mapsUri"},
        {"\"wireBytes\": ", "\"wireBytes\": -", "wireBytes"},
        {"\"greatestSubtreeBytes\": ", "\"greatestSubtreeBytes\": -", "greatestSubtreeBytes"},
    };
    for (const auto& [from, to, named] : kCases) {
        const auto parsed = parse_tileset_json(bytes_of(replaced(json, from, to)));
        ASSERT_FALSE(parsed.ok()) << from << " -> " << to;
        EXPECT_NE(parsed.error().message.find(named), std::string::npos) << parsed.error().message;
    }
    EXPECT_FALSE(parse_tileset_json(bytes_of("[]")).ok());
    EXPECT_FALSE(parse_tileset_json(bytes_of(std::string(100'000, '['))).ok());
}

TEST(Subtree, RandomSubtreesComeBackExactly) {
    for (uint32_t seed = 0; seed < 30; ++seed) {
        const SyntheticCity city = make_synthetic_city(seed, 1 + seed % 6, 1 + seed % 4);
        for (const Subtree& subtree : city.subtrees) {
            const auto parsed = parse_subtree(write_subtree(subtree, city.manifest), subtree.root, city.manifest);
            ASSERT_TRUE(parsed.ok()) << parsed.error().text();
            EXPECT_EQ(*parsed, subtree);
        }
    }
}

TEST(Subtree, FullSubtreesOfEightLevelsComeBack) {
    Manifest manifest;
    manifest.levels = 9;
    manifest.subtree_levels = 8;
    manifest.root_side_log2 = 12;
    Subtree subtree;
    for (uint32_t depth = 0; depth < 8; ++depth) {
        for (uint32_t morton = 0; morton < (1U << (2 * depth)); ++morton) {
            subtree.tiles.emplace_back().address = tile_at({0, 0, 0}, depth, morton);
        }
    }
    for (uint32_t morton = 0; morton < (1U << 16); ++morton)
        subtree.child_subtrees.push_back(tile_at({0, 0, 0}, 8, morton));
    const Bytes bytes = write_subtree(subtree, manifest);
    const auto parsed = parse_subtree(bytes, {0, 0, 0}, manifest);
    ASSERT_TRUE(parsed.ok()) << parsed.error().text();
    EXPECT_EQ(*parsed, subtree);
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    EXPECT_NE(text.find("\"tileAvailability\":{\"constant\":1}"), std::string::npos);
}

TEST(Subtree, TilesFollowTheMortonCurve) {
    EXPECT_EQ(morton_code(0b11, 0b00), 0b0101U);
    EXPECT_EQ(morton_code(0b1010, 0b0011), 0b01001110U);
    EXPECT_EQ(morton_code(0b0110, 0b0101), 0b00110110U);
    for (uint32_t i = 0; i < 64; ++i) EXPECT_EQ(local_morton({2, 1, 3}, tile_at({2, 1, 3}, 3, i)), i);
    for (uint32_t i = 0; i < 4; ++i) EXPECT_EQ(tile_at({5, 9, 17}, 1, i), (TileAddress{5, 9, 17}.child(i)));
}

TEST(Subtree, TheOrderInWhichTilesAreGivenDoesNotMatter) {
    const SyntheticCity city = small_city();
    Subtree shuffled = city.subtrees[0];
    std::reverse(shuffled.tiles.begin(), shuffled.tiles.end());
    std::reverse(shuffled.child_subtrees.begin(), shuffled.child_subtrees.end());
    EXPECT_EQ(write_subtree(shuffled, city.manifest), write_subtree(city.subtrees[0], city.manifest));
}

TEST(Subtree, BoundsOffTheGridGrowToIt) {
    SyntheticCity city = small_city();
    TileRecord& record = city.subtrees[0].tiles[0];
    record.bounds = {{0.1, 0.2, 0.3}, {10.1, 20.2, 30.3}};
    const auto parsed = parse_subtree(write_subtree(city.subtrees[0], city.manifest), {0, 0, 0}, city.manifest);
    ASSERT_TRUE(parsed.ok());
    for (size_t axis = 0; axis < 3; ++axis) {
        const Bounds& bounds = parsed->tiles[0].bounds;
        EXPECT_LE(bounds.min[axis], record.bounds.min[axis]);
        EXPECT_GE(bounds.max[axis], record.bounds.max[axis]);
        EXPECT_LT(record.bounds.min[axis] - bounds.min[axis], kMetresPerGridUnit);
        EXPECT_LT(bounds.max[axis] - record.bounds.max[axis], kMetresPerGridUnit);
    }
}

TEST(Subtree, EveryTruncationIsRefused) {
    const SyntheticCity city = small_city();
    const Bytes bytes = write_subtree(city.subtrees[0], city.manifest);
    for (size_t size = 0; size < bytes.size(); ++size) {
        const Bytes cut(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size));
        EXPECT_FALSE(parse_subtree(cut, {0, 0, 0}, city.manifest).ok()) << size;
    }
    Bytes longer = bytes;
    longer.resize(bytes.size() + 8);
    EXPECT_FALSE(parse_subtree(longer, {0, 0, 0}, city.manifest).ok());
}

TEST(Subtree, MutationsNeverCrashAndWhatIsAcceptedKeepsTheRules) {
    const SyntheticCity city = make_synthetic_city(3, 2, 2);
    Bytes bytes = write_subtree(city.subtrees[0], city.manifest);
    for (size_t i = 0; i < bytes.size(); ++i) {
        const std::byte kept = bytes[i];
        for (const unsigned mask : {1U, 0x80U}) {
            bytes[i] = kept ^ static_cast<std::byte>(mask);
            const auto parsed = parse_subtree(bytes, {0, 0, 0}, city.manifest);
            if (!parsed) continue;
            for (const TileRecord& record : parsed->tiles) {
                EXPECT_LT(record.address.level, city.manifest.levels);
                for (const auto& steps : record.layers) EXPECT_FALSE(step_table_defect(steps)) << "byte " << i;
            }
        }
        bytes[i] = kept;
    }
}

TEST(Subtree, WrongRootsAreRefused) {
    const SyntheticCity city = small_city();
    const Bytes bytes = write_subtree(city.subtrees[0], city.manifest);
    for (const TileAddress root : {TileAddress{1, 0, 0}, {2, 4, 0}, {2, 0, 4}, {4, 0, 0}, {40, 0, 0}}) {
        EXPECT_FALSE(parse_subtree(bytes, root, city.manifest).ok()) << subtree_path(root);
    }
    // The root's subtree goes one level further down than what lies below level 2 may.
    const auto other = parse_subtree(bytes, {2, 0, 0}, city.manifest);
    ASSERT_FALSE(other.ok());
    EXPECT_NE(other.error().message.find("subtrees/2/0/0.subtree: tile 3/"), std::string::npos)
        << other.error().message;
}

TEST(Subtree, HostileJsonIsRefusedWithAReason) {
    const SyntheticCity city = small_city();
    const Bytes bytes = write_subtree(city.subtrees[0], city.manifest);
    const std::vector<std::array<std::string, 3>> kCases = {
        {"subt", "subs", "subt"},
        {"\"buffers\"", "\"bufferz\"", "buffers is missing"},
        {"\"buffer\":0", "\"buffer\":1", "bufferViews.0.buffer"},
        {"\"byteOffset\":8", "\"byteOffset\":7", "byteOffset"},
        {"\"class\":\"tile\"", "\"class\":\"tree\"", "class"},
        {"\"count\":", "\"count\" ", "JSON"},
        {"\"boundingBox\"", "\"boundingBax\"", "boundingBox is missing"},
        {"\"tileMetadata\":0", "\"tileMetadata\":1", "tileMetadata"},
        {"\"UINT32\"", "\"UINT16\"", "arrayOffsets"},
        {"\"UINT32\"", "\"STRING\"", "arrayOffsetType"},
        {"\"meshErrors\"", "\"meshErrorz\"", "meshErrors is missing"},
        {"\"boundingBox\":{\"values\":2}", "\"boundingBox\":{\"values\":0}", "values"},
        {"\"bitstream\":0", "\"bitstream\":9", "bitstream"},
    };
    for (const auto& [from, to, named] : kCases) {
        const auto parsed = parse_subtree(replaced(bytes, from, to), {0, 0, 0}, city.manifest);
        ASSERT_FALSE(parsed.ok()) << from << " -> " << to;
        EXPECT_NE(parsed.error().message.find(named), std::string::npos) << from << ": " << parsed.error().message;
    }
    Bytes huge = bytes;
    std::memset(huge.data() + 8, 0xF8, 8);
    EXPECT_FALSE(parse_subtree(huge, {0, 0, 0}, city.manifest).ok());
}

TEST(StepTable, RulesAreChecked) {
    const std::vector<StepRecord> good = {{10, 8, 2.0F, 1}, {30, 0, 2.0F, 2}, {31, 400, 0.0F, 3}};
    EXPECT_FALSE(step_table_defect(good));
    EXPECT_FALSE(step_table_defect({}));
    const auto with = [&](auto change) {
        std::vector<StepRecord> steps = good;
        change(steps);
        return step_table_defect(steps).has_value();
    };
    EXPECT_TRUE(with([](auto& steps) { steps[0].end = 0; }));
    EXPECT_TRUE(with([](auto& steps) { steps[1].end = 10; }));
    EXPECT_TRUE(with([](auto& steps) { steps[2].end = uint64_t{1} << 32; }));
    EXPECT_TRUE(with([](auto& steps) { steps[1].decoded_bytes = 6; }));
    EXPECT_TRUE(with([](auto& steps) { steps[1].decoded_bytes = 1U << 30; }));
    EXPECT_TRUE(with([](auto& steps) { steps[1].error = 2.5F; }));
    EXPECT_TRUE(with([](auto& steps) { steps[2].error = -1; }));
    EXPECT_TRUE(with([](auto& steps) { steps[0].error = std::numeric_limits<float>::quiet_NaN(); }));
    EXPECT_TRUE(with([](auto& steps) { steps[0].error = std::numeric_limits<float>::infinity(); }));
    EXPECT_TRUE(with([](auto& steps) {
        while (steps.size() < 17) steps.push_back({steps.back().end + 1, 0, 0, 0});
    }));
}

TEST(FacadeIndex, ComesBackAndItsDamageIsFound) {
    const SyntheticCity city = small_city();
    Bytes frame = city.entries.at(kFacadeIndexPath);
    const auto maps = parse_facade_index(frame, city.manifest);
    ASSERT_TRUE(maps.ok()) << maps.error().text();
    ASSERT_EQ(maps->size(), 3U);
    EXPECT_EQ(maps->back().levels().back().end, city.entries.at(kFacadeMapsPath).size());
    EXPECT_EQ((*maps)[1].width, 300);
    EXPECT_EQ((*maps)[1].height, 90);
    ASSERT_EQ((*maps)[1].level_count, 2U);
    EXPECT_EQ((*maps)[1].level[0].texel_cm, 16);
    EXPECT_EQ((*maps)[1].level[0].displacement_error, 0.3F);
    EXPECT_EQ((*maps)[0].level_count, 1U);
    for (size_t i = 0; i < frame.size(); ++i) {
        frame[i] ^= std::byte{1};
        EXPECT_FALSE(parse_facade_index(frame, city.manifest).ok()) << i;
        frame[i] ^= std::byte{1};
        EXPECT_FALSE(parse_facade_index(std::span(frame).first(i), city.manifest).ok()) << i;
    }
    Manifest hostile = city.manifest;
    hostile.facade_map_count = uint64_t{1} << 40;
    hostile.facade_index_decoded_bytes = hostile.facade_map_count * 25;
    EXPECT_FALSE(parse_facade_index(frame, hostile).ok());
    Manifest none;
    EXPECT_TRUE(parse_facade_index(write_facade_index({}, none), none).ok());
}

std::vector<FacadeMapRecord> two_maps() {
    FacadeMapRecord two_levels, one_level;
    two_levels.width = 800;
    two_levels.height = 600;
    two_levels.depth_min_mm = -100;
    two_levels.depth_max_mm = 30;
    two_levels.level_count = 2;
    two_levels.level[0] = {20, 160, 0x01020304, 16, 0.1F};
    two_levels.level[1] = {110, 800, 0xfffefdfc, 1, 0};
    one_level.width = 300;
    one_level.height = 275;
    one_level.depth_max_mm = 12;
    one_level.level_count = 1;
    one_level.level[0] = {174, 280, 77, 1, 0};
    return {two_levels, one_level};
}

TEST(FacadeIndex, ItsColumnsAreThoseOfTheFormatsExample) {
    Manifest manifest;
    const Bytes frame = write_facade_index(two_maps(), manifest);
    const auto raw = codec::bits::decompress_frame(frame, manifest.facade_index_decoded_bytes);
    ASSERT_TRUE(raw.ok());
    const std::vector<int> expected = {
        0x02, 0x01,                                                         // levels
        0x20, 0x2c, 0x03, 0x01, 0x58, 0x13, 0x02, 0x01,                     // sizes
        0x9c, 0x00, 0xff, 0x00, 0x1e, 0x0c, 0x00, 0x00,                     // depths
        0x14, 0x5a, 0x40, 0,    0,    0,    0,    0,    0, 0,    0,    0,   // payloads
        0x28, 0xc8, 0x46, 0,    0,    0,    0,    0,    0, 0,    0,    0,   // words
        0x10, 0x01, 0x01, 0,    0,    0,    0x64, 0,    0, 0,    0,    0,   // texels, errors
        0x04, 0xfc, 0x4d, 0x03, 0xfd, 0,    0x02, 0xfe, 0, 0x01, 0xff, 0};  // checksums
    ASSERT_EQ(raw->size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(static_cast<int>((*raw)[i]), expected[i]) << i;
    const auto back = parse_facade_index(frame, manifest);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(*back, two_maps());
}

TEST(FacadeIndex, EveryRecordThatBreaksARuleIsRefusedByName) {
    const auto refused = [](auto change) {
        std::vector<FacadeMapRecord> maps = two_maps();
        change(maps);
        Manifest manifest;
        const auto back = parse_facade_index(write_facade_index(maps, manifest), manifest);
        return back.ok() ? std::string() : back.error().text();
    };
    using Maps = std::vector<FacadeMapRecord>;
    EXPECT_EQ(refused([](Maps&) {}), "");
    EXPECT_NE(refused([](Maps& m) { m[1].level[0].end = 110; }), "");
    EXPECT_NE(refused([](Maps& m) { m[0].level[0].end = 0; }), "");
    EXPECT_NE(refused([](Maps& m) { m[1].level[0].end = UINT32_MAX; }), "");
    EXPECT_NE(refused([](Maps& m) { m[0].width = 0; }), "");
    EXPECT_NE(refused([](Maps& m) { m[1].height = 8193; }), "");
    EXPECT_NE(refused([](Maps& m) { m[1].depth_min_mm = 13; }), "");
    EXPECT_NE(refused([](Maps& m) { m[0].level[0].resident_bytes = 0; }), "");
    EXPECT_NE(refused([](Maps& m) { m[0].level[0].resident_bytes = kMaxFacadeResidentBytes + 4; }), "");
    EXPECT_NE(refused([](Maps& m) { m[0].level[0].texel_cm = 1; }), "");
    EXPECT_NE(refused([](Maps& m) { m[0].level[0].texel_cm = 0; }), "");
    EXPECT_NE(refused([](Maps& m) { m[1].level[0].texel_cm = 4; }), "");
    EXPECT_NE(refused([](Maps& m) { m[1].level[0].displacement_error = 0.5F; }), "");
    EXPECT_NE(refused([](Maps& m) {
                  m[0].level_count = 3;
                  m[0].level[1] = {100, 400, 0, 4, 0.2F};
                  m[0].level[2] = {110, 800, 0, 1, 0};
              }),
              "")
        << "the error grows";
    EXPECT_NE(refused([](Maps& m) { m[0].level_count = 0; }), "");
    const std::string named = refused([](Maps& m) { m[1].level[0].texel_cm = 4; });
    EXPECT_NE(named.find("map 1"), std::string::npos) << named;
}

TEST(FacadeIndex, AFrameOfOtherColumnsThanItsMapsNeedIsRefused) {
    Manifest manifest;
    const Bytes frame = write_facade_index(two_maps(), manifest);
    for (const uint64_t count : {0U, 1U, 3U, 7U}) {
        Manifest other = manifest;
        other.facade_map_count = count;
        EXPECT_FALSE(parse_facade_index(frame, other).ok()) << count;
    }
    // Every byte of the columns changed, in a frame that is right about itself: refused, or other records that keep
    // the rules; never a reading past an end.
    Bytes raw = codec::bits::decompress_frame(frame, manifest.facade_index_decoded_bytes).value();
    for (std::byte& byte : raw) {
        for (const int value : {0, 1, 2, 5, 0x7f, 0x80, 0xff}) {
            const std::byte kept = std::exchange(byte, static_cast<std::byte>(value));
            const Bytes changed = codec::bits::compress_frame(raw, 1);
            manifest.facade_index_bytes = changed.size();
            manifest.facade_index_checksum = checksum_of(changed.data(), changed.size());
            const auto maps = parse_facade_index(changed, manifest);
            if (maps.ok()) {
                EXPECT_TRUE(check_facade_maps(*maps).ok());
            }
            byte = kept;
        }
    }
}

TEST(FacadeIndex, TakesAtMostTenBytesALevelOfUnlikeMaps) {
    std::mt19937 random(3);
    const auto below = [&](uint32_t limit) { return std::uniform_int_distribution<uint32_t>(0, limit - 1)(random); };
    std::vector<FacadeMapRecord> maps(3000);
    uint64_t end = 0, levels = 0;
    for (FacadeMapRecord& map : maps) {
        map.width = static_cast<uint16_t>(300 + 25 * below(60));
        map.height = static_cast<uint16_t>(275 + 25 * below(60));
        map.depth_min_mm = static_cast<int16_t>(-100 - static_cast<int32_t>(below(8)) * 10);
        map.depth_max_mm = static_cast<int16_t>(40 + 10 * below(20));
        map.level_count = 2;
        map.level[0] = {end += 90 + below(150), 4 * (100 + below(200)), static_cast<uint32_t>(random()), 16,
                        static_cast<float>(100 + below(8) * 10) * 0.001F};
        map.level[1] = {end += 250 + below(500), 4 * (300 + below(600)), static_cast<uint32_t>(random()), 1, 0};
        levels += 2;
    }
    Manifest manifest;
    const Bytes frame = write_facade_index(maps, manifest);
    EXPECT_LE(static_cast<double>(frame.size()) / static_cast<double>(levels), 10);
    EXPECT_EQ(parse_facade_index(frame, manifest).value(), maps);
}

ChartRecord chart_of(uint16_t width, uint16_t height, uint8_t flags, const std::vector<uint32_t>& sizes) {
    ChartRecord chart;
    chart.width = width;
    chart.height = height;
    chart.flags = flags;
    chart.colour = {1, 2, static_cast<uint8_t>(width)};
    chart.level_count = static_cast<uint32_t>(sizes.size());
    for (size_t i = 0; i < sizes.size(); ++i) chart.level[i].bytes = sizes[i];
    return chart;
}

/// As FORMAT.md has them.
std::vector<ChartRecord> three_charts() {
    return {chart_of(200, 200, 3, {500, 900, 3000}), chart_of(16, 4, 0, {60}), chart_of(130, 70, 1, {700, 2000})};
}

TEST(ChartIndex, ItsColumnsAreThoseOfTheFormatsExample) {
    std::vector<ChartRecord> charts = three_charts();
    Manifest manifest;
    const Bytes frame = write_chart_index(charts, manifest);
    EXPECT_EQ(manifest.shared_chart_count, 3U);
    EXPECT_EQ(manifest.chart_levels_bytes, 7160U);
    const auto raw = codec::bits::decompress_frame(frame, manifest.chart_index_decoded_bytes);
    ASSERT_TRUE(raw.ok());
    const std::vector<int> expected = {
        0xc8, 0x10, 0x82, 0,    0,    0,                                 // widths
        0xc8, 0x04, 0x46, 0,    0,    0,                                 // heights
        3,    0,    1,                                                   // flags
        1,    1,    1,    2,    2,    2,    0xc8, 0x10, 0x82,            // colours
        0xf4, 0x84, 0xb8, 0x3c, 0xbc, 0xd0, 1,    3,    0x0b, 0, 2, 7,   // sizes: low bytes
        0,    0,    0,    0,    0,    0,    0,    0,    0,    0, 0, 0};  // high ones
    ASSERT_EQ(raw->size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(static_cast<int>((*raw)[i]), expected[i]) << i;
    const auto back = parse_chart_index(frame, manifest);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(*back, charts);
}

TEST(ChartIndex, LevelsOfABlockLieSideBySideCoarsestFirst) {
    std::vector<ChartRecord> charts = three_charts();
    EXPECT_EQ(place_chart_levels(charts), 7160U);
    EXPECT_EQ(charts[0].level[0].begin, 0U);
    EXPECT_EQ(charts[1].level[0].begin, 500U);
    EXPECT_EQ(charts[2].level[0].begin, 560U);
    EXPECT_EQ(charts[0].level[1].begin, 1260U) << "level 1 after all levels 0";
    EXPECT_EQ(charts[2].level[1].begin, 2160U);
    EXPECT_EQ(charts[0].level[2].begin, 4160U);
    EXPECT_EQ(charts[0].level[2].end(), 7160U);
    std::vector<ChartRecord> many(kChartsPerBlock + 1, charts[2]);
    place_chart_levels(many);
    EXPECT_EQ(many[kChartsPerBlock].level[0].begin, many[kChartsPerBlock - 1].level[1].end())
        << "the next block after the whole one before";
    EXPECT_EQ(many[kChartsPerBlock - 1].level[0].end(), many[0].level[1].begin);
}

TEST(ChartIndex, EveryDamageOfItsFrameIsFound) {
    std::vector<ChartRecord> charts = three_charts();
    Manifest manifest;
    Bytes frame = write_chart_index(charts, manifest);
    for (size_t i = 0; i < frame.size(); ++i) {
        frame[i] ^= std::byte{1};
        EXPECT_FALSE(parse_chart_index(frame, manifest).ok()) << i;
        frame[i] ^= std::byte{1};
        EXPECT_FALSE(parse_chart_index(std::span(frame).first(i), manifest).ok()) << i;
    }
    for (const uint64_t count : {uint64_t{0}, uint64_t{2}, uint64_t{4}, uint64_t{1} << 40}) {
        Manifest other = manifest;
        other.shared_chart_count = count;
        EXPECT_FALSE(parse_chart_index(frame, other).ok()) << count;
    }
    Manifest other = manifest;
    ++other.chart_levels_bytes;
    EXPECT_FALSE(parse_chart_index(frame, other).ok()) << "levels of another length";
}

TEST(ChartIndex, EveryRecordThatBreaksARuleIsRefusedByName) {
    using Charts = std::vector<ChartRecord>;
    const auto refused = [](auto change) {
        Charts charts = three_charts();
        change(charts);
        Manifest manifest;
        const auto back = parse_chart_index(write_chart_index(charts, manifest), manifest);
        return back.ok() ? std::string() : back.error().text();
    };
    EXPECT_EQ(refused([](Charts&) {}), "");
    EXPECT_NE(refused([](Charts& c) { c[0].width = 0; }), "");
    EXPECT_NE(refused([](Charts& c) { c[0].height = 8193; }), "");
    EXPECT_NE(refused([](Charts& c) { c[2].flags = 4; }), "");
    EXPECT_NE(refused([](Charts& c) { c[1].level[0].bytes = 4; }), "") << "a checksum and nothing else";
    EXPECT_NE(refused([](Charts& c) { c[1].width = 5120; }), "") << "needs more levels";
    EXPECT_NE(refused([](Charts& c) { c[0].level_count = 2; }), "");
    EXPECT_NE(refused([](Charts& c) { c[0].level[0].bytes = c[0].level[1].bytes = 0x80000000U; }), "")
        << "beyond 4 GiB";
    const std::string named = refused([](Charts& c) { c[2].flags = 4; });
    EXPECT_NE(named.find("chart 2"), std::string::npos) << named;
}

TEST(ChartIndex, AnyColumnsAreRefusedOrGiveRecordsThatKeepTheRules) {
    std::vector<ChartRecord> charts = three_charts();
    Manifest manifest;
    const Bytes frame = write_chart_index(charts, manifest);
    Bytes raw = codec::bits::decompress_frame(frame, manifest.chart_index_decoded_bytes).value();
    for (std::byte& byte : raw) {
        for (const int value : {0, 1, 2, 5, 0x1f, 0x7f, 0x80, 0xff}) {
            const std::byte kept = std::exchange(byte, static_cast<std::byte>(value));
            const Bytes changed = codec::bits::compress_frame(raw, 1);
            manifest.chart_index_bytes = changed.size();
            manifest.chart_index_checksum = checksum_of(changed.data(), changed.size());
            const auto back = parse_chart_index(changed, manifest);
            if (back.ok()) {
                EXPECT_TRUE(check_charts(*back).ok());
            }
            byte = kept;
        }
    }
}

TEST(ChartIndex, ChecksumsOfLevelsAreTheLowHalfOfTheDirectorys) {
    const std::vector<codec::atlas::ChartImage> image = {{2, 1, false, false, 1, {1, 2, 3, 4, 5, 6}}};
    const Bytes payload = codec::atlas::encode_chart_levels(codec::atlas::encode_atlas(image))[0];
    uint32_t checksum = 0;
    std::memcpy(&checksum, payload.data(), 4);
    EXPECT_EQ(checksum, static_cast<uint32_t>(checksum_of(payload.data() + 4, payload.size() - 4)));
}

TEST(Directory, PathsAndOriginsFollowTheAddress) {
    EXPECT_EQ(layer_path(Layer::kMesh, {3, 1, 2}), "tiles/3/1/2.mesh");
    EXPECT_EQ(layer_path(Layer::kRadiance, {0, 0, 0}), "tiles/0/0/0.radiance");
    EXPECT_EQ(subtree_path({4, 15, 0}), "subtrees/4/15/0.subtree");
    Manifest manifest;
    manifest.origin = {to_grid(1280), to_grid(-2560), 0};
    manifest.root_side_log2 = 9;
    TileRecord record;
    record.address = {2, 3, 1};
    record.base_height = 77;
    EXPECT_EQ(manifest.tile_origin(record), (GridPoint{to_grid(1280 + 3 * 128), to_grid(-2560 + 128), 77}));
    EXPECT_EQ(checksum_of("", 0), 0x2d06800538d394c2U);
}

}  // namespace
}  // namespace citystream::tiles::tileset
