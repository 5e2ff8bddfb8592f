// Prepared images come back from disk mip by mip, and the cache over them keeps to its budget.
#include "tiles/layers/prepared_images.h"

#include <atomic>
#include <thread>

#include "tests/tiles/layers/image_files.h"
#include "tiles/layers/image_cache.h"

namespace citystream::tiles::layers {
namespace {

ChartImage noisy(uint32_t width, uint32_t height, uint32_t seed = 1) {
    return {width, height, false, false, 0, noise(size_t{3} * width * height, seed)};
}

class Prepared : public testing::Test {
  protected:
    void SetUp() override {
        auto made = PreparedImages::create(folder_.path(), kImages);
        ASSERT_TRUE(made.ok());
        images_ = std::move(made).value();
        catalog_.images.resize(kImages);
    }
    static constexpr size_t kImages = 40;
    ImageFolder folder_;
    city::CityCatalog catalog_;
    std::unique_ptr<PreparedImages> images_;
};

TEST_F(Prepared, EveryMipIsTheOneBeforeHalved) {
    ChartImage mip = noisy(37, 5);
    ASSERT_TRUE(images_->store(3, mip));
    EXPECT_EQ(images_->state(3), PreparedImages::State::kStored);
    ASSERT_EQ(images_->levels(3), 6U);
    for (uint32_t level = 0; level < 6; ++level) {
        const auto read = images_->read(3, level);
        ASSERT_TRUE(read.ok());
        EXPECT_EQ(read->width, mip.width);
        EXPECT_EQ(read->height, mip.height);
        EXPECT_EQ(read->rgb, mip.rgb);
        mip = codec::atlas::downsample(mip);
    }
    EXPECT_EQ(images_->read(3, 9)->rgb, images_->read(3, 5)->rgb) << "beyond the last, the last";
}

TEST_F(Prepared, WhatWasNotStoredIsSaid) {
    images_->fail(1);
    EXPECT_EQ(images_->state(0), PreparedImages::State::kUnknown);
    EXPECT_EQ(images_->state(1), PreparedImages::State::kFailed);
    EXPECT_EQ(images_->state(1000), PreparedImages::State::kUnknown);
    EXPECT_FALSE(images_->read(0, 0).ok());
    EXPECT_FALSE(images_->read(1, 0).ok());
    EXPECT_FALSE(images_->read(1000, 0).ok());
}

TEST_F(Prepared, ManyThreadsStoreAtATime) {
    std::atomic<uint32_t> next = 0;
    {
        std::vector<std::jthread> threads;
        for (int t = 0; t < 4; ++t) {
            threads.emplace_back([&] {
                for (uint32_t i = next++; i < kImages; i = next++)
                    EXPECT_TRUE(images_->store(i, noisy(200 + i, 190 - i, i)).ok());
            });
        }
    }
    for (uint32_t i = 0; i < kImages; ++i) {
        const auto read = images_->read(i, 0);
        ASSERT_TRUE(read.ok());
        EXPECT_EQ(read->rgb, noisy(200 + i, 190 - i, i).rgb);
    }
}

TEST_F(Prepared, TheFinestMipOfASizeIsFound) {
    ASSERT_TRUE(images_->store(0, noisy(128, 64)));
    EXPECT_EQ(images_->level_of_size(0, 8192), 0U);
    EXPECT_EQ(images_->level_of_size(0, 8191), 1U);
    EXPECT_EQ(images_->level_of_size(0, 1), 7U);
    EXPECT_EQ(images_->level_of_size(1, 1), 0U);
}

TEST_F(Prepared, TheCacheKeepsToItsBudget) {
    for (uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(images_->store(i, noisy(64, 64, i)));
    constexpr size_t kOne = 3 * 64 * 64, kBudget = 5 * kOne;
    ImageCache cache(catalog_, kBudget, images_.get());
    for (uint32_t turn = 0; turn < 2; ++turn) {
        for (uint32_t i = 0; i < kImages; ++i) {
            const auto image = cache.mip(i, 0);
            ASSERT_TRUE(image);
            EXPECT_EQ(image->rgb, noisy(64, 64, i).rgb);
            EXPECT_EQ(cache.mip(i, 3)->width, 8U);
        }
    }
    EXPECT_LE(cache.peak_bytes(), kBudget + kOne);
    EXPECT_EQ(cache.mip(7, 0), cache.mip(7, 0)) << "what is kept is not read again";
    EXPECT_EQ(cache.mip(7, 99), cache.mip(7, 6)) << "beyond the last mip, the last";
}

TEST_F(Prepared, TheCacheHasNothingOfFailedImages) {
    images_->fail(2);
    catalog_.materials.push_back({{9, 8, 7}, 2, true, 0});
    ImageCache cache(catalog_, 1 << 20, images_.get());
    EXPECT_EQ(cache.mip(2, 0), nullptr);
    EXPECT_EQ(cache.mean_colour(0), (std::array<uint8_t, 3>{9, 8, 7}));
    EXPECT_TRUE(cache.take_defects().empty()) << "who prepared it has said so";
}

TEST_F(Prepared, TheCacheDecodesWhatWasNotPrepared) {
    const ChartImage whole = noisy(20, 10);
    catalog_.images[4].pixels = std::make_shared<const city::Image>(city::Image{20, 10, whole.rgb});
    catalog_.images[5].path = folder_.path("absent.png");
    ImageCache cache(catalog_, 1 << 20, images_.get());
    EXPECT_EQ(cache.mip(4, 0)->rgb, whole.rgb);
    EXPECT_EQ(cache.mip(4, 1)->rgb, codec::atlas::downsample(whole).rgb);
    for (int turn = 0; turn < 3; ++turn) EXPECT_EQ(cache.mip(5, 0), nullptr);
    EXPECT_EQ(cache.take_defects().size(), 1U) << "once an image";
}

}  // namespace
}  // namespace citystream::tiles::layers
