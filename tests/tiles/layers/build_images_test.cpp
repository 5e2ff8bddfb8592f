// The builder's stage "images", end to end: what images become in the archive, and what is said of bad ones.
#include <mutex>
#include <set>

#include "tests/tiles/layers/image_files.h"
#include "tiles/layers/build_city.h"

namespace citystream::tiles::layers {
namespace {

class BuildImages : public testing::Test {
  protected:
    /// A street of walls of 12 x 8 m, one for each image file, each showing its image once.
    CitySource walls(const std::vector<std::string>& images) const {
        return [images](city::CityHeader&, city::CityCatalog& catalog, city::CityReport& report,
                        const city::CitySink& sink) -> Status {
            double x = 0;
            for (const std::string& path : images) {
                catalog.images.push_back({.path = path});
                city::Material material;
                material.image = static_cast<int32_t>(catalog.images.size() - 1);
                city::CityObject object;
                object.id = "wall of " + path;
                object.kind = city::ObjectKind::kBuilding;
                object.vertices = {{x, 0, 0}, {x + 12, 0, 0}, {x + 12, 0, 8}, {x, 0, 8}};
                city::Triangle triangle;
                triangle.material = catalog.add_material(material);
                triangle.vertex = {0, 1, 2};
                triangle.texcoord = {{{0, 0}, {1, 0}, {1, 1}}};
                object.triangles.push_back(triangle);
                triangle.vertex = {0, 2, 3};
                triangle.texcoord = {{{0, 0}, {1, 1}, {0, 1}}};
                object.triangles.push_back(triangle);
                ++report.buildings_emitted;
                x += 13;
                if (!sink(std::move(object))) break;
            }
            return Done{};
        };
    }
    Result<BuildSummary> build(const std::vector<std::string>& images,
                               const std::function<void(BuildOptions&)>& change = {}) {
        BuildOptions options;
        options.output = folder_.path("city.3tz");
        options.jobs = 2;
        if (change) change(options);
        city::CityReport report;
        return build_city(options, walls(images), report);
    }
    std::string soft_image(const std::string& name) const {
        std::vector<uint8_t> rgb;
        for (int i = 0; i < 256 * 256; ++i) {
            for (const int shift : {0, 40, 80}) rgb.push_back(static_cast<uint8_t>(shift + i / 256 / 2 + i % 256 / 4));
        }
        return folder_.write(name, 256, 256, 3, rgb);
    }
    ImageFolder folder_;
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

}  // namespace
}  // namespace citystream::tiles::layers
