// The builder's stage "images", end to end: what images become in the archive, and what is said of bad ones.
#include <mutex>
#include <set>

#include "tests/tiles/layers/city_builds.h"
#include "tiles/layers/inspect_city.h"
#include "tiles/tileset/chart_index.h"

namespace citystream::tiles::layers {
namespace {

class BuildImages : public CityBuildTest {
  protected:
    Result<BuildSummary> build(const std::vector<std::string>& images,
                               const std::function<void(BuildOptions&)>& change = {}) const {
        return CityBuildTest::build("city.3tz", street_of(images), change);
    }
    /// A ramp; `kind`s have other colours.
    std::string soft_image(const std::string& name, int side = 256, int kind = 0) const {
        std::vector<uint8_t> rgb;
        for (int i = 0; i < side * side; ++i) {
            for (const int shift : {0, 40, 80})
                rgb.push_back(static_cast<uint8_t>(shift + 9 * kind + i / side / 2 + i % side / 4));
        }
        return folder_.write(name, side, side, 3, rgb);
    }
};

TEST_F(BuildImages, ASearchedCityIsSmallerAndSaysSo) {
    const std::string image = soft_image("soft.png");
    const auto plain = build({image});
    ASSERT_TRUE(plain.ok());
    const auto searched = build({image}, [](BuildOptions& options) {
        options.saliency = {codec::atlas::MetricKind::kSsim, 0.98};
    });
    ASSERT_TRUE(searched.ok());
    constexpr auto kAtlas = static_cast<size_t>(tileset::Layer::kAtlas);
    EXPECT_LT(searched->manifest.wire_bytes[kAtlas], plain->manifest.wire_bytes[kAtlas]);
    EXPECT_NE(searched->manifest.build_options.find("saliency=ssim:0.98"), std::string::npos);
    EXPECT_EQ(plain->manifest.build_options.find("saliency"), std::string::npos);
    ASSERT_TRUE(searched->images && plain->images);
    EXPECT_EQ(plain->images->prepared_pixels, 65536U);
    EXPECT_LT(2 * searched->images->prepared_pixels, 65536U);
}

TEST_F(BuildImages, WithoutAnAtlasNothingIsSearched) {
    const auto summary = build({soft_image("soft.png")}, [](BuildOptions& options) {
        options.saliency = {codec::atlas::MetricKind::kSsim, 0.98};
        options.layers = {true, false, false, false};
    });
    ASSERT_TRUE(summary.ok());
    EXPECT_EQ(summary->images->metric_calls, 0U);
    EXPECT_EQ(summary->manifest.build_options.find("saliency"), std::string::npos);
}

TEST_F(BuildImages, WithoutAnAtlasMeshesCarryNothingOfPictures) {
    const auto mesh_bytes_of = [&](const std::string& image) {
        EXPECT_TRUE(build({image}, [](BuildOptions& options) { options.layers = {true, false, false, false}; }).ok());
        const OpenCity city = open_city(path("city.3tz"));
        const auto bytes = city.reader->find(tileset::layer_path(tileset::Layer::kMesh, {}));
        return std::vector<std::byte>(bytes.begin(), bytes.end());
    };
    const auto bare = mesh_bytes_of(path("absent.png"));
    EXPECT_FALSE(bare.empty());
    EXPECT_EQ(mesh_bytes_of(soft_image("soft.png")), bare);
}

TEST_F(BuildImages, ImagesComeBeforeTiles) {
    std::vector<std::string> stages;
    const auto summary = build({soft_image("a.png"), soft_image("b.png")}, [&](BuildOptions& options) {
        options.progress = [&](std::string_view stage, uint64_t, uint64_t) {
            if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
        };
    });
    ASSERT_TRUE(summary.ok());
    ASSERT_GE(stages.size(), 2U);
    EXPECT_EQ(stages.front(), "images");
    EXPECT_EQ(std::count(stages.begin(), stages.end(), "images"), 1);
}

TEST_F(BuildImages, EveryBadImageIsOneDefectAndTheCityIsBuilt) {
    std::filesystem::create_directory(folder_.path("folder.png"));
    const std::vector<std::string> bad = {folder_.path("absent.png"), folder_.path("folder.png"),
                                          folder_.write_bytes("empty.png", ""),
                                          folder_.write_bytes("text.png", "no picture")};
    std::vector<std::string> images = bad;
    images.push_back(soft_image("good.png"));
    const auto summary = build(images);
    ASSERT_TRUE(summary.ok());
    EXPECT_EQ(summary->report.defect_count, bad.size());
    for (size_t i = 0; i < bad.size(); ++i)
        EXPECT_NE(summary->report.defects[i].what.find(bad[i]), std::string::npos) << summary->report.defects[i].what;
    EXPECT_TRUE(summary->report.dropped_features.empty());
    EXPECT_EQ(summary->images->failed, bad.size());
    EXPECT_EQ(summary->images->used, images.size());
}

TEST_F(BuildImages, ACityWhoseImagesExceedTheMemoryLimitIsTheSameCity) {
    std::vector<std::string> images;
    for (int i = 0; i < 40; ++i) {
        images.push_back(folder_.write(std::to_string(i) + ".png", 128, 128, 3,
                                       noise(size_t{3} * 128 * 128, static_cast<uint32_t>(i + 1))));
    }
    const auto roomy = build(images);
    ASSERT_TRUE(roomy.ok());
    const std::string bytes = folder_.bytes_of("city.3tz");
    constexpr uint64_t kLimit = uint64_t{640} << 10;  // the images take 1,920 KiB
    const auto tight = build(images, [](BuildOptions& options) { options.memory_limit = kLimit; });
    ASSERT_TRUE(tight.ok());
    EXPECT_EQ(tight->report.defect_count, 0U);
    EXPECT_LE(tight->images->peak_bytes, kLimit / 2);
    EXPECT_TRUE(folder_.bytes_of("city.3tz") == bytes);
}

TEST_F(BuildImages, RateDistortionGivesTheSameBytesWhateverTheThreads) {
    std::vector<std::string> images;
    for (int i = 0; i < 12; ++i)
        images.push_back(soft_image(std::to_string(i) + ".png", 64, i % 4));  // three show each picture
    const struct {
        codec::atlas::AtlasForm form;
        bool shared;
    } ways[] = {{codec::atlas::AtlasForm::kCharts, false},
                {codec::atlas::AtlasForm::kCharts, true},
                {codec::atlas::AtlasForm::kPages, false}};
    for (const auto& way : ways) {
        const auto bytes = [&](uint32_t strength, uint32_t jobs) {
            const auto built = build(images, [&](BuildOptions& options) {
                options.atlas_form = way.form;
                options.shared_charts = way.shared;
                options.leaf_triangles = 1;
                options.rate_distortion = strength;
                options.jobs = jobs;
            });
            EXPECT_TRUE(built.ok());
            return bytes_of("city.3tz");
        };
        const std::string one = bytes(64, 1);
        EXPECT_TRUE(bytes(64, 3) == one) << way.shared;
        EXPECT_TRUE(bytes(64, 2) == one) << way.shared;
        EXPECT_LT(one.size(), bytes(0, 1).size()) << "it changes nothing: the test is too easy";
    }
}

/// What is reported of sizes, beside the entries of the file: thesis tables 7 to 13 print ratios ten times too large.
TEST_F(BuildImages, RatiosOfTheReportAreThoseOfTheBytesOnDisk) {
    std::vector<std::string> images;
    for (int i = 0; i < 6; ++i) images.push_back(soft_image(std::to_string(i) + ".png", 256, i % 4));
    for (const bool shared : {false, true}) {
        const auto built = build(images, [&](BuildOptions& options) {
            options.shared_charts = shared;
            options.leaf_triangles = 1;
        });
        ASSERT_TRUE(built.ok());
        const OpenCity city = open_city(path("city.3tz"));
        uint64_t on_disk = 0, in_all = 0;
        for (const archive::ArchiveEntry& entry : city.reader->entries()) {
            on_disk += entry.name.ends_with(".atlas") ? entry.size : 0;
            in_all += entry.size;
        }
        uint64_t decoded = 0;
        for (const auto& [address, record] : city.tiles)
            decoded += 4 * layer_words(city, record, tileset::Layer::kAtlas).words.size();
        const auto info = read_city_info(path("city.3tz"));
        ASSERT_TRUE(info.ok());
        const auto& layer = (*info)["layers"]["atlas"];
        EXPECT_EQ(layer["wire_bytes"], on_disk);
        EXPECT_EQ(layer["decoded_bytes"], decoded);
        EXPECT_EQ(built->archive_bytes, std::filesystem::file_size(path("city.3tz")));
        EXPECT_EQ((*info)["archive_bytes"], built->archive_bytes);
        EXPECT_GT(built->archive_bytes, in_all);
        if (shared) {
            const auto& dictionary = (*info)["chart_dictionary"];
            const uint64_t levels = city.reader->find(tileset::kChartLevelsPath).size();
            EXPECT_GT(levels, 0U);
            EXPECT_EQ(dictionary["wire_bytes"], levels);
            EXPECT_EQ(dictionary["index_bytes"], city.reader->find(tileset::kChartIndexPath).size());
            on_disk += levels;
        }
        // A total of ratios taken from these bytes: RGB over blocks alone is six.
        EXPECT_EQ(built->images->decoded_pixels, 6U * 256 * 256);
        EXPECT_GT(3.0 * static_cast<double>(built->images->decoded_pixels), 6.0 * static_cast<double>(on_disk));
    }
}

}  // namespace
}  // namespace citystream::tiles::layers
