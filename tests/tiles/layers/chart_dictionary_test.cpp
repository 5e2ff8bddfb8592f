// The chart dictionary: which pictures are shared, in which order, and what tiles find of them.
#include "tiles/layers/chart_dictionary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/shared_chart.h"
#include "tests/tiles/archive/temporary_folder.h"
#include "tiles/tileset/chart_index.h"

namespace citystream::tiles::layers {
namespace {

using archive::TemporaryFolder;
using Kind = ChartKey::Kind;

constexpr uint32_t kSide = 64;

city::Image noise(uint32_t seed, uint32_t side = kSide) {
    city::Image image{side, side, {}};
    for (uint32_t i = 0; i < 3 * side * side; ++i) {
        seed = seed * 1664525U + 1013904223U;
        image.rgb.push_back(static_cast<uint8_t>(seed >> 24));
    }
    return image;
}

class SharedCharts : public testing::Test {
  protected:
    uint32_t add_image(const city::Image& image) {
        city::ImageSource source;
        source.pixels = std::make_shared<const city::Image>(image);
        catalog_.images.push_back(source);
        return static_cast<uint32_t>(catalog_.images.size() - 1);
    }

    /// A tile that would make `texels` texels of an image.
    void wish(uint64_t tile, uint32_t image, double level = 0, uint64_t texels = kSide * kSide,
              Kind kind = Kind::kImage) {
        TileWishes wishes;
        wishes.take({kind, {image, 0}}, level, texels);
        wishes_.add(tile, wishes);
    }

    struct Made {
        ChartDictionary dictionary;
        std::vector<std::byte> entry;
        tileset::Manifest manifest;
    };
    Made make(CityWishes& wishes, uint32_t jobs = 2) {
        BuildOptions options;
        options.jobs = jobs;
        const std::string name = "run" + std::to_string(runs_++);
        const auto spool = quadtree::SpoolFile::create(folder_ / (name + ".spool")).value();
        MemoryGate gate(1 << 20);
        auto made = ChartDictionary::make(wishes, {images_, facades_, {}}, options, gate, *spool);
        EXPECT_TRUE(made.ok());
        Made out{std::move(made).value(), {}, {}};
        if (out.dictionary.records().empty()) return out;
        tileset::write_chart_index(out.dictionary.records(), out.manifest);
        const auto writer = archive::ArchiveWriter::create(folder_ / (name + ".3tz")).value();
        EXPECT_TRUE(out.dictionary.write_entry(*writer, *spool).ok());
        EXPECT_TRUE(writer->finish().ok());
        const auto reader = archive::ArchiveReader::open(folder_ / (name + ".3tz")).value();
        const auto entry = reader->find(tileset::kChartLevelsPath);
        out.entry.assign(entry.begin(), entry.end());
        return out;
    }
    Made make() { return make(wishes_); }

    static std::optional<SharedChart> find(Made& made, uint32_t image, Kind kind = Kind::kImage) {
        return made.dictionary.take({kind, {image, 0}}, 0, 0);
    }

    TemporaryFolder folder_;
    city::CityCatalog catalog_;
    ImageCache images_{catalog_, 1 << 24};
    FacadePainter facades_{catalog_, images_, 20000};
    CityWishes wishes_;
    int runs_ = 0;
};

TEST_F(SharedCharts, WhatSeveralTilesShowIsSharedAndComesBackFromTheEntry) {
    const uint32_t shared = add_image(noise(1)), alone = add_image(noise(2));
    wish(0, shared);
    wish(1, shared);
    wish(1, alone);
    Made made = make();
    ASSERT_EQ(made.dictionary.records().size(), 1U);
    EXPECT_FALSE(find(made, alone)) << "one tile shows it";
    EXPECT_FALSE(find(made, shared, Kind::kRepeatedImage)) << "nobody shows it repeated";
    const auto chart = find(made, shared);
    ASSERT_TRUE(chart);
    EXPECT_EQ(chart->number, 0U);
    const tileset::ChartRecord& record = made.dictionary.records()[0];
    EXPECT_TRUE(tileset::check_charts(made.dictionary.records()).ok());
    ASSERT_EQ(made.entry.size(), made.manifest.chart_levels_bytes);
    std::vector<uint32_t> words;
    for (uint32_t i = 0; i < record.level_count; ++i) {
        const auto level = codec::atlas::decode_chart_level(
            std::span(made.entry).subspan(record.level[i].begin, record.level[i].bytes), kSide, kSide, 0, i);
        ASSERT_TRUE(level.ok()) << level.error().text();
        words.insert(words.end(), level->begin(), level->end());
    }
    const auto image = images_.mip(shared, 0);
    const LayerSteps expected = codec::atlas::encode_atlas(std::span(image.get(), 1));
    std::vector<uint32_t> expected_words;
    for (const LayerStep& step : expected)
        expected_words.insert(expected_words.end(), step.words.begin(), step.words.end());
    EXPECT_EQ(words, expected_words);
    const auto mean = mean_of(*image);
    EXPECT_EQ(record.colour, mean);
}

TEST_F(SharedCharts, TheFinestThatAnyTileAsksForIsStored) {
    const uint32_t image = add_image(noise(3));
    wish(0, image, 3, 64);
    wish(1, image, 1, 1024);
    wish(2, image, 2, 256);
    for (const uint64_t tile : {3, 4, 5, 6}) wish(tile, image, 1, 1024);
    Made made = make();
    ASSERT_EQ(made.dictionary.records().size(), 1U);
    EXPECT_EQ(made.dictionary.records()[0].width, kSide / 2);
    EXPECT_EQ(find(made, image)->coarseness, 1);
}

TEST_F(SharedCharts, WhatIsSmallerInTheTilesStaysThere) {
    const uint32_t parts = add_image(noise(4)), most = add_image(noise(5));
    for (const uint64_t tile : {0, 1}) {
        wish(tile, parts, 0, kSide * kSide / 4);
        wish(tile, most, 0, kSide * kSide * 3 / 4);
    }
    Made made = make();
    EXPECT_FALSE(find(made, parts)) << "two tiles show a quarter each";
    EXPECT_TRUE(find(made, most));
}

TEST_F(SharedCharts, PicturesOfOneColourStayInTheTiles) {
    city::Image flat = noise(1);
    std::fill(flat.rgb.begin(), flat.rgb.end(), uint8_t{90});
    const uint32_t image = add_image(flat);
    for (const uint64_t tile : {0, 1, 2}) wish(tile, image);
    EXPECT_TRUE(make().dictionary.records().empty());
}

TEST_F(SharedCharts, EqualPicturesAreStoredOnce) {
    const uint32_t first = add_image(noise(6)), other = add_image(noise(7)), equal = add_image(noise(6));
    for (const uint32_t image : {first, other, equal}) {
        wish(image, image);
        wish(10, image);
    }
    Made made = make();
    EXPECT_EQ(made.dictionary.records().size(), 2U);
    EXPECT_EQ(find(made, first)->number, find(made, equal)->number);
    EXPECT_NE(find(made, first)->number, find(made, other)->number);
}

TEST_F(SharedCharts, OneImageIsTwoChartsWhereSomeTilesRepeatIt) {
    const uint32_t image = add_image(noise(8));
    for (const uint64_t tile : {0, 1}) {
        wish(tile, image);
        wish(tile, image, 0, kSide * kSide, Kind::kRepeatedImage);
    }
    Made made = make();
    ASSERT_EQ(made.dictionary.records().size(), 2U);
    const auto clamped = find(made, image), repeated = find(made, image, Kind::kRepeatedImage);
    EXPECT_EQ(made.dictionary.records()[clamped->number].flags, 0);
    EXPECT_EQ(made.dictionary.records()[repeated->number].flags, ATLAS_CHART_REPEAT_U | ATLAS_CHART_REPEAT_V);
}

TEST_F(SharedCharts, NumbersFollowTheFirstUseAndNeitherThreadsNorTheOrderOfTilesMatter) {
    std::vector<uint32_t> image;
    for (uint32_t i = 0; i < 12; ++i) image.push_back(add_image(noise(20 + i)));
    const auto note = [&](CityWishes& wishes, bool backwards) {
        for (uint32_t i = 0; i < 24; ++i) {
            const uint32_t tile = backwards ? 23 - i : i;
            TileWishes own;
            own.take({Kind::kImage, {image[(5 * tile) % 12], 0}}, tile % 2, 3000);
            wishes.add(tile, own);
        }
    };
    CityWishes forwards, backwards;
    note(forwards, false);
    note(backwards, true);
    Made a = make(forwards, 1), b = make(backwards, 3);
    ASSERT_EQ(a.dictionary.records().size(), 12U);
    for (uint32_t i = 0; i < 12; ++i) EXPECT_EQ(find(a, image[(5 * i) % 12])->number, i);
    EXPECT_EQ(a.entry, b.entry);
    EXPECT_TRUE(std::equal(a.dictionary.records().begin(), a.dictionary.records().end(), b.dictionary.records().begin(),
                           b.dictionary.records().end()));
}

TEST_F(SharedCharts, NoWishesGiveAnEmptyDictionary) {
    Made made = make();
    EXPECT_TRUE(made.dictionary.records().empty());
    EXPECT_FALSE(find(made, 0));
}

TEST(OwnTexels, AreThoseThatTheShelfDoesNotHave) {
    class OneImage final : public ChartShelf {
      public:
        std::optional<SharedChart> take(const ChartKey& key, double, uint64_t) override {
            if (key.name[0] != 7) return std::nullopt;
            return SharedChart{3, 1, 0};
        }
    } shelf;
    OwnTexels own(&shelf);
    EXPECT_EQ(own.take({ChartKey::Kind::kImage, {7, 0}}, 0, 1000)->number, 3U);
    EXPECT_EQ(own.count(), 0U);
    EXPECT_EQ(own.take({ChartKey::Kind::kImage, {8, 0}}, 2, 100)->coarseness, 2);
    own.take({ChartKey::Kind::kFacadePicture, {9, 0}}, 0.1, 20);
    EXPECT_EQ(own.count(), 120U);
    OwnTexels without(nullptr);
    without.take({ChartKey::Kind::kImage, {7, 0}}, 0, 1000);
    EXPECT_EQ(without.count(), 1000U);
}

}  // namespace
}  // namespace citystream::tiles::layers
