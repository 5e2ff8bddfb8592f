// Images before tiles: as fine as any tile shows them, no smaller than the metric allows, in bounded memory, each
// decoded once; what cannot be used is one line.
#include "tiles/layers/image_preparation.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>

#include "codec/atlas/resample.h"
#include "tests/tiles/layers/image_files.h"
#include "tests/tiles/layers/memory_count.h"
#include "tiles/layers/image_cache.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::ChartSize;
using codec::atlas::Metric;
using codec::atlas::MetricKind;
using Bytes = std::vector<uint8_t>;

ImageUse shown(double metres_u, double metres_v, bool clamped = false) {
    ImageUse use;
    use.coverage = {metres_u, metres_v, 4, 2, 2, 2, 0};
    use.clamped = clamped;
    use.lowest = {0, 0};
    use.highest = {2, 2};
    return use;
}

/// A soft pattern with some noise: something to lose, and something to save.
Bytes pattern(uint32_t width, uint32_t height, uint32_t seed = 1, double contrast = 6) {
    Bytes out = noise(size_t{3} * width * height, seed);
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const double soft = 120 + 60 * std::sin(6.2832 * 2 * x / width) + 50 * std::cos(6.2832 * y / height);
            for (size_t c = 0; c < 3; ++c) {
                uint8_t& value = out[3 * (size_t{y} * width + x) + c];
                value = static_cast<uint8_t>(soft + contrast * (value / 255.0 - 0.5));
            }
        }
    }
    return out;
}

/// The same with alpha: soft bars and noise at their edges.
Bytes pattern_with_alpha(uint32_t width, uint32_t height, uint32_t seed = 1) {
    const Bytes rgb = pattern(width, height, seed), grain = noise(size_t{width} * height, seed + 1);
    Bytes out;
    for (size_t i = 0; i < grain.size(); ++i) {
        const double bars = 128 + 200 * std::sin(6.2832 * 3 * static_cast<double>(i % width) / width) + grain[i] / 16.0;
        out.insert(out.end(), &rgb[3 * i], &rgb[3 * i] + 3);
        out.push_back(static_cast<uint8_t>(std::clamp(bars, 0.0, 255.0)));
    }
    return out;
}

/// As it is drawn at a size; four channels, whether it was stored with alpha or not.
codec::atlas::Image drawn(ChartImage chart, uint32_t width, uint32_t height) {
    if (chart.alpha.empty()) chart.alpha.assign(size_t{chart.width} * chart.height, 255);
    auto image = resample(linear_image(chart), width, height, codec::atlas::Shrink::kLanczos, {true, true});
    test_alpha(image);
    return image;
}

class ImagePreparation : public testing::Test {
  protected:
    uint32_t add_file(const std::string& path, const ImageUse& use) {
        catalog_.images.push_back({.path = path});
        uses_.push_back(use);
        return static_cast<uint32_t>(uses_.size() - 1);
    }
    uint32_t add_drawn(uint32_t width, uint32_t height, const Bytes& rgb, const ImageUse& use) {
        catalog_.images.push_back(
            {.path = {}, .pixels = std::make_shared<const city::Image>(city::Image{width, height, rgb})});
        uses_.push_back(use);
        return static_cast<uint32_t>(uses_.size() - 1);
    }
    ImagePreparationReport prepare() {
        const std::string folder = folder_.path("run" + std::to_string(runs_++));
        std::filesystem::create_directory(folder);
        auto made = PreparedImages::create(folder, catalog_.images.size());
        EXPECT_TRUE(made.ok());
        prepared_ = std::move(made).value();
        defects_.clear();
        auto report = prepare_images(catalog_, uses_, options_, *prepared_, defects_);
        EXPECT_TRUE(report.ok()) << (report ? "" : report.error().text());
        return report ? *report : ImagePreparationReport();
    }
    ChartImage image(uint32_t index) const {
        auto read = prepared_->read(index, 0);
        EXPECT_TRUE(read.ok()) << index;
        return read ? *std::move(read) : ChartImage();
    }

    ImageFolder folder_;
    city::CityCatalog catalog_;
    std::vector<ImageUse> uses_;
    ImagePreparationOptions options_;
    std::unique_ptr<PreparedImages> prepared_;
    std::vector<city::Defect> defects_;
    uint32_t runs_ = 0;
};

TEST_F(ImagePreparation, AnImageThatIsNoFinerThanSeenStaysAsItIs) {
    const Bytes rgb = noise(3 * 40 * 30);
    add_drawn(40, 30, rgb, shown(4, 3));
    const auto report = prepare();
    EXPECT_EQ(image(0).rgb, rgb);
    EXPECT_EQ(report.decoded_pixels, 1200U);
    EXPECT_EQ(report.prepared_pixels, 1200U);
    EXPECT_EQ(report.metric_calls, 0U);
}

TEST_F(ImagePreparation, AFinerImageIsFilteredInLinearLightDownToTheSizeSeen) {
    const Bytes rgb = noise(3 * 400 * 300);
    for (const bool clamped : {false, true}) add_drawn(400, 300, rgb, shown(1, 1.5, clamped));
    const auto report = prepare();
    EXPECT_EQ(report.matched_pixels, 2U * 50 * 75);
    for (const bool clamped : {false, true}) {
        const ChartImage whole{400, 300, false, false, 0, rgb};
        const codec::atlas::Edges edges{!clamped, !clamped};
        const ChartImage expected = chart_image(resample(whole, 50, 75, codec::atlas::Shrink::kLanczos, edges));
        EXPECT_EQ(image(clamped ? 1 : 0).rgb, expected.rgb) << "edges wrap where the image repeats";
    }
}

TEST_F(ImagePreparation, ImagesThatNothingShowsAreNotRead) {
    add_file(folder_.path("absent.png"), ImageUse());
    const auto report = prepare();
    EXPECT_EQ(report.images, 1U);
    EXPECT_EQ(report.used, 0U);
    EXPECT_TRUE(defects_.empty());
    EXPECT_EQ(prepared_->state(0), PreparedImages::State::kUnknown);
}

TEST_F(ImagePreparation, OneColourIsOneTexel) {
    add_drawn(64, 64, Bytes(3 * 64 * 64, 77), shown(100, 100));
    EXPECT_EQ(prepare().prepared_pixels, 1U);
    EXPECT_EQ(image(0).rgb, (Bytes{77, 77, 77}));
}

TEST_F(ImagePreparation, TheSearchKeepsToTheToleranceAgainstTheViewMatchedImage) {
    const Bytes rgb = pattern(256, 192);
    for (const char* metric : {"ssim:0.98", "flip:0.05", "hvse:0.1", "rmse:0.02"}) {
        catalog_.images.clear();
        uses_.clear();
        add_drawn(256, 192, rgb, shown(1.2, 1.2));
        options_.saliency = {};
        prepare();
        const ChartImage matched = image(0);
        options_.saliency = *codec::atlas::parse_metric(metric);
        const auto report = prepare();
        const ChartImage searched = image(0);
        EXPECT_LT(report.prepared_pixels, report.matched_pixels) << metric;
        EXPECT_GT(report.metric_calls, 0U);
        const codec::atlas::MetricReference reference(linear_image(matched), options_.saliency.kind);
        const auto shown_again = resample(linear_image(searched), matched.width, matched.height,
                                          codec::atlas::Shrink::kLanczos, {true, true});
        EXPECT_LE(reference.error(shown_again), options_.saliency.largest_error()) << metric;
        EXPECT_EQ(searched.width % 4, 0U);
    }
}

TEST_F(ImagePreparation, WhatIsStoredOfAnImageWithAlphaKeepsToTheToleranceToo) {
    const auto path = folder_.write("bars.png", 200, 160, 4, pattern_with_alpha(200, 160));
    for (const double metres : {100.0, 1.0}) {  // as it is, and view-matched
        for (const char* metric : {"ssim:0.9", "flip:0.1", "rmse:0.1", "hvse:0.3"}) {
            catalog_.images.clear();
            uses_.clear();
            add_file(path, shown(metres, metres));
            options_.saliency = {};
            prepare();
            const ChartImage matched = image(0);
            ASSERT_FALSE(matched.alpha.empty());
            options_.saliency = *codec::atlas::parse_metric(metric);
            const auto report = prepare();
            EXPECT_LT(report.prepared_pixels, report.matched_pixels) << metric;
            const uint32_t width = matched.width, height = matched.height;
            const codec::atlas::MetricReference reference(drawn(matched, width, height), options_.saliency.kind);
            const double error = reference.error(drawn(image(0), width, height));
            EXPECT_LE(error, options_.saliency.largest_error() + 1e-9) << metric;
        }
    }
}

TEST_F(ImagePreparation, AnImageOfWhichLittleIsShownMayLoseLess) {
    const Bytes rgb = pattern(128, 128, 3, 60);
    options_.saliency = {MetricKind::kSsim, 0.9};
    ImageUse part = shown(100, 100, true);
    part.highest = {0.3, 0.3};
    add_drawn(128, 128, rgb, shown(100, 100));
    add_drawn(128, 128, rgb, part);
    prepare();
    EXPECT_LT(image(0).rgb.size(), image(1).rgb.size());
}

TEST_F(ImagePreparation, DoesNotDependOnThreads) {
    options_.saliency = {MetricKind::kSsim, 0.95};
    for (uint32_t i = 0; i < 12; ++i)
        add_drawn(60 + 4 * i, 50, pattern(60 + 4 * i, 50, i + 1), shown(0.5 + 0.2 * i, 1));
    add_file(folder_.path("absent_b.png"), shown(1, 1));
    add_file(folder_.path("absent_a.png"), shown(1, 1));
    std::vector<Bytes> texels;
    std::vector<std::string> faults;
    for (const uint32_t jobs : {1U, 5U}) {
        options_.jobs = jobs;
        std::vector<Bytes> found;
        EXPECT_EQ(prepare().failed, 2U);
        for (uint32_t i = 0; i < 12; ++i) found.push_back(image(i).rgb);
        std::vector<std::string> lines;
        for (const auto& defect : defects_) lines.push_back(defect.what);
        if (jobs == 1) texels = found, faults = lines;
        EXPECT_EQ(found, texels);
        EXPECT_EQ(lines, faults);
    }
    ASSERT_EQ(faults.size(), 2U);
    EXPECT_NE(faults[0].find("absent_b.png"), std::string::npos) << "in the order of the images";
}

TEST_F(ImagePreparation, EveryBadImageIsOneLineAndTheOthersAreMade) {
    std::filesystem::create_directory(folder_.path("folder.png"));
    folder_.write("whole.png", 64, 64, 3, noise(3 * 64 * 64));
    const std::string cut = folder_.bytes_of("whole.png").substr(0, 3000);
    for (const std::string& path :
         {folder_.path("absent.png"), folder_.path("folder.png"), folder_.write_bytes("empty.png", ""),
          folder_.write_bytes("cut.png", cut), folder_.write_bytes("text.jpg", "no picture")})
        add_file(path, shown(10, 10));
    add_drawn(0, 0, {}, shown(10, 10));
    add_drawn(5, 5, Bytes(7), shown(10, 10));
    const uint32_t good = add_file(folder_.path("whole.png"), shown(10, 10));
    const auto report = prepare();
    EXPECT_EQ(report.failed, 7U);
    ASSERT_EQ(defects_.size(), 7U);
    for (const auto& defect : defects_) {
        EXPECT_NE(defect.what.find("; a flat colour is used"), std::string::npos) << defect.what;
        EXPECT_EQ(defect.what.find('\n'), std::string::npos) << defect.what;
        EXPECT_FALSE(defect.dropped_feature);
    }
    EXPECT_EQ(image(good).rgb.size(), 3U * 64 * 64);
    EXPECT_EQ(prepared_->state(0), PreparedImages::State::kFailed);
}

TEST_F(ImagePreparation, LinesOfOnePixelAreSearchedToo) {
    options_.saliency = {MetricKind::kSsim, 0.95};
    for (const auto& [width, height] : {std::array{1, 700}, std::array{700, 1}, std::array{16384, 1}}) {
        const auto path = folder_.write(std::to_string(width) + ".png", width, height, 3,
                                        pattern(static_cast<uint32_t>(width), static_cast<uint32_t>(height)));
        add_file(path, shown(20, 20));
    }
    EXPECT_EQ(prepare().failed, 0U);
    EXPECT_EQ(image(0).width, 1U);
    EXPECT_LE(image(0).height, 700U);
    EXPECT_LE(image(2).width, 1024U);
    EXPECT_EQ(image(2).height, 1U);
}

TEST_F(ImagePreparation, StopsWhenAsked) {
    const std::atomic<bool> cancel = true;
    options_.cancel = &cancel;
    add_drawn(8, 8, noise(192), shown(1, 1));
    auto made = PreparedImages::create(folder_.path(), 1);
    ASSERT_TRUE(made.ok());
    const auto report = prepare_images(catalog_, uses_, options_, **made, defects_);
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.error().text(), "interrupted");
}

TEST_F(ImagePreparation, TellsHowFarItIs) {
    for (uint32_t i = 0; i < 5; ++i) add_drawn(8, 8, noise(192, i), shown(1, 1));
    std::vector<uint64_t> seen;
    options_.progress = [&](std::string_view stage, uint64_t done, uint64_t total) {
        EXPECT_EQ(stage, "images");
        EXPECT_EQ(total, 5U);
        seen.push_back(done);
    };
    prepare();
    EXPECT_EQ(seen, (std::vector<uint64_t>{1, 2, 3, 4, 5}));
}

TEST(ImagePlan, NeverHoldsMoreThanTheBudgetButForTheImageItself) {
    uint32_t seed = 7;
    const auto random = [&seed](uint32_t most) {
        seed = seed * 1664525U + 1013904223U;
        return 1 + static_cast<uint32_t>(uint64_t{seed} * most >> 32);
    };
    for (int i = 0; i < 20000; ++i) {
        const ChartSize image{random(1U << random(16)), random(1U << random(16))};
        const ChartSize wanted{std::min(8192U, random(image.width)), std::min(8192U, random(image.height))};
        const uint64_t budget = (uint64_t{1} << 20) << random(10), strip = uint64_t{6} * 64 * image.width;
        const ImagePlan plan = plan_image({image, strip, false, i % 2 == 1}, wanted, random(2) == 1, budget);
        ASSERT_LE(plan.size.width, wanted.width);
        ASSERT_LE(plan.size.height, wanted.height);
        ASSERT_EQ(plan.halved, plan.size != wanted);
        if (strip + 4096 < budget) {
            ASSERT_LE(plan.bytes, budget) << image.width << " x " << image.height;
        }
    }
}

TEST(ImagePlan, ReadsByRowsOnlyWhatDoesNotFit) {
    constexpr uint64_t kMiB = 1 << 20;
    const ImagePlan roomy = plan_image({{4096, 4096}, kMiB}, {1024, 1024}, true, 1024 * kMiB);
    EXPECT_FALSE(roomy.by_rows);
    EXPECT_TRUE(roomy.searched);
    const ImagePlan tight = plan_image({{4096, 4096}, kMiB}, {1024, 1024}, true, 48 * kMiB);
    EXPECT_TRUE(tight.by_rows);
    EXPECT_FALSE(tight.halved);
    EXPECT_FALSE(tight.searched);
    const ImagePlan tiny = plan_image({{4096, 4096}, kMiB}, {1024, 1024}, true, 5 * kMiB);
    EXPECT_TRUE(tiny.halved);
    EXPECT_EQ(tiny.size, (ChartSize{512, 512}));
    EXPECT_LE(tiny.bytes, 5 * kMiB);
}

#ifdef CITYSTREAM_COUNTS_MEMORY

TEST_F(ImagePreparation, ACityOfImagesLargerThanTheBudgetIsPreparedWithinIt) {
    constexpr uint32_t kImages = 48, kSide = 512;
    constexpr uint64_t kBudget = uint64_t{12} << 20;
    for (uint32_t i = 0; i < kImages; ++i) {
        const auto path = folder_.write(std::to_string(i) + ".tif", kSide, kSide, 3, pattern(kSide, kSide, i + 1, 2));
        add_file(path, shown(i % 8 == 0 ? 20 : 3, 3));
    }
    static_assert(uint64_t{kImages} * kSide * kSide * 3 >= 3 * kBudget);
    options_.saliency = {MetricKind::kRmse, 0.02};
    options_.budget_bytes = kBudget;
    options_.jobs = 4;
    memory_count::start();
    const auto report = prepare();
    const uint64_t held = memory_count::peak();
    EXPECT_EQ(report.failed, 0U);
    EXPECT_TRUE(defects_.empty());
    EXPECT_LE(report.peak_bytes, kBudget) << "what was planned";
    EXPECT_LE(held, kBudget + (uint64_t{2} << 20)) << "what was really held, with the readers' own buffers";
    EXPECT_GT(held, report.peak_bytes / 4) << "the plan is not far from the truth";
    EXPECT_GT(report.metric_calls, 0U);
}

TEST_F(ImagePreparation, NoMetricHoldsMoreThanPlanned) {
    const Bytes rgb = pattern(320, 320, 1, 40);
    const auto bars = folder_.write("bars.tif", 320, 320, 4, pattern_with_alpha(320, 320));
    for (const char* metric : {"rmse:0.02", "nrmse:0.1", "tm:0.02", "mannos:0.05", "daly:0.05", "ahumada:0.05",
                               "hvse:0.1", "ssim:0.95", "flip:0.05"}) {
        for (const bool alpha : {false, true}) {
            catalog_.images.clear();
            uses_.clear();
            if (alpha) {
                add_file(bars, shown(100, 100));
            } else {
                add_drawn(320, 320, rgb, shown(100, 100));
            }
            options_.saliency = *codec::atlas::parse_metric(metric);
            options_.jobs = 1;
            memory_count::start();
            const auto report = prepare();
            EXPECT_GT(report.metric_calls, 0U) << metric;
            EXPECT_LE(memory_count::peak(), report.peak_bytes) << metric << (alpha ? " with alpha" : "");
        }
    }
}

TEST_F(ImagePreparation, AHugeImageIsReducedWhileItIsRead) {
    constexpr int kSide = 16384;
    {
        // Grey bands, a strip at a time: 256 MiB of pixels in a small file.
        auto output = OIIO::ImageOutput::create(folder_.path("huge.tif"));
        OIIO::ImageSpec spec(kSide, kSide, 1, OIIO::TypeDesc::UINT8);
        spec.attribute("compression", "packbits");
        ASSERT_TRUE(output && output->open(folder_.path("huge.tif"), spec));
        for (int y = 0; y < kSide; y += 64) {
            const Bytes strip(size_t{64} * kSide, static_cast<uint8_t>(40 + y / 1024 * 12));
            ASSERT_TRUE(output->write_scanlines(y, y + 64, 0, OIIO::TypeDesc::UINT8, strip.data()));
        }
        ASSERT_TRUE(output->close());
    }
    const uint32_t huge = add_file(folder_.path("huge.tif"), shown(6, 6));
    options_.budget_bytes = uint64_t{24} << 20;
    memory_count::start();
    const auto report = prepare();
    const uint64_t held = memory_count::peak();
    EXPECT_EQ(report.decoded_pixels, uint64_t{kSide} * kSide);
    EXPECT_LE(held, options_.budget_bytes);
    EXPECT_TRUE(defects_.empty());
    const ChartImage small = image(huge);
    ASSERT_EQ(small.width, 256U);
    ASSERT_EQ(small.height, 256U);
    for (uint32_t y = 0; y < 256; ++y) ASSERT_EQ(small.rgb[size_t{3} * 256 * y], 40 + (255 - y) / 16 * 12) << y;
}

#endif

}  // namespace
}  // namespace citystream::tiles::layers
