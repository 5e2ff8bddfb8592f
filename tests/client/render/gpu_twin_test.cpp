// The GPU's decoders against the CPU's, word for word, through the same includes that draw.
#include <cstdint>

#include "shaders/twin_atlas.comp.h"
#include "tests/client/render/gpu_twin.h"

namespace citystream::client::test {
namespace {

TEST_F(GpuTwin, AtlasTexelsAreTheSameBytes) {
    Random random;
    std::vector<codec::atlas::ChartImage> charts = {test_chart(1, 1), test_chart(130, 67), test_chart(5, 64),
                                                    test_chart(64, 64)};
    for (uint8_t& byte : charts[1].rgb) byte = static_cast<uint8_t>(random.next());
    charts.push_back(test_chart(43, 20));
    for (size_t i = 0; i < charts[4].rgb.size() / 3; ++i)
        charts[4].alpha.push_back(static_cast<uint8_t>(random.next()));
    const LayerSteps steps = codec::atlas::encode_atlas(charts);
    const std::vector<uint32_t> words = joined(steps);
    const auto view = codec::atlas::AtlasLayerView::create(words, step_words(steps));
    ASSERT_TRUE(view.ok()) << view.error().text();
    const LayerId layer = upload_words(words, true);
    for (uint32_t chart = 0; chart < charts.size(); ++chart) {
        for (uint32_t mip = 0; mip < view->mip_count(chart); ++mip) {
            const uint32_t width = std::max(1u, view->width(chart) >> mip);
            const uint32_t height = std::max(1u, view->height(chart) >> mip);
            TwinConstants constants{};
            constants.count = width * height;
            constants.first = chart;
            constants.second = mip;
            const std::vector<uint32_t> gpu = run(k_twin_atlas_comp, layer, constants, 1);
            for (uint32_t i = 0; i < width * height; ++i) {
                uint8_t rgb[3];
                view->texel(chart, mip, i % width, i / width, rgb);
                const uint32_t alpha = view->alpha(chart, mip, i % width, i / width);
                ASSERT_EQ(gpu[i], static_cast<uint32_t>(rgb[0] | rgb[1] << 8 | rgb[2] << 16) | alpha << 24)
                    << "chart " << chart << " mip " << mip;
            }
        }
    }
}

}  // namespace
}  // namespace citystream::client::test
