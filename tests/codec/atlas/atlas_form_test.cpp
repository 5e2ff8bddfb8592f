#include "codec/atlas/atlas_form.h"

#include <gtest/gtest.h>

#include "codec/atlas/page_layer.h"

namespace citystream::codec::atlas {
namespace {

/// Two charts, of 32 x 32 texels and of 1 x 1.
std::vector<ChartImage> two_charts() {
    std::vector<ChartImage> charts = {{32, 32, true, true, 0.1F, {}}, {1, 1, true, true, 0, {7, 8, 9}}};
    for (uint32_t i = 0; i < 3 * 32 * 32; ++i) charts[0].rgb.push_back(static_cast<uint8_t>(i * 89));
    return charts;
}

Result<AtlasFacts> facts_of(const LayerSteps& steps, size_t count, uint64_t dictionary_size = 0) {
    std::vector<uint32_t> words, step_words;
    for (size_t i = 0; i < count; ++i) {
        words.insert(words.end(), steps[i].words.begin(), steps[i].words.end());
        step_words.push_back(static_cast<uint32_t>(steps[i].words.size()));
    }
    return check_atlas(words, step_words, dictionary_size);
}

TEST(AtlasForm, ChartsAreToldByTheirMagicAndSayWhatTheyShare) {
    const std::vector<SharedChartUse> shared = {{1, 5, 0.5F}};
    const LayerSteps steps = encode_atlas(two_charts(), {}, shared);
    const auto facts = facts_of(steps, steps.size(), 6);
    ASSERT_TRUE(facts) << facts.error().text();
    EXPECT_EQ(facts->form, AtlasForm::kCharts);
    EXPECT_EQ(facts->chart_count, 3u);
    EXPECT_EQ(facts->finest_mip, 0u);
    EXPECT_EQ(facts->shared_charts, shared);
    EXPECT_FALSE(facts_of(steps, steps.size(), 5)) << "the dictionary has no chart 5";
}

TEST(AtlasForm, PagesAreToldByTheirMagicAndEveryStepIsALevel) {
    const LayerSteps steps = *encode_pages(two_charts(), {.mips = 2});
    ASSERT_EQ(steps.size(), 3u);
    for (uint32_t count = 1; count <= 3; ++count) {
        const auto facts = facts_of(steps, count);
        ASSERT_TRUE(facts) << facts.error().text();
        EXPECT_EQ(facts->form, AtlasForm::kPages);
        EXPECT_EQ(facts->chart_count, 2u);
        EXPECT_EQ(facts->finest_mip, 3 - count);
        EXPECT_TRUE(facts->shared_charts.empty());
    }
}

TEST(AtlasForm, FlatPagesHaveOneStepThatIsTheFinest) {
    const LayerSteps steps = *encode_pages(std::vector{two_charts()[1]}, {.mips = 2});
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_EQ(facts_of(steps, 1)->finest_mip, 0u);
}

TEST(AtlasForm, WordsThatBeginLikeNeitherAreRefused) {
    LayerSteps steps = encode_atlas(two_charts());
    steps[0].words[0] = 0x41414141;
    EXPECT_FALSE(facts_of(steps, steps.size()));
    EXPECT_FALSE(check_atlas({}, {}));
    LayerSteps pages = *encode_pages(two_charts());
    pages[0].words[1] += 1;
    EXPECT_FALSE(facts_of(pages, pages.size())) << "a damaged page layer is no chart layer";
}

}  // namespace
}  // namespace citystream::codec::atlas
