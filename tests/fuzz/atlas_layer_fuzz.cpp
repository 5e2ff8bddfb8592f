// Any words as an atlas layer of a city with 1,000 shared charts: what the view accepts has its first and last texel of
// every mip, and names no other charts.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/atlas/atlas_layer.h"
#include "tests/fuzz/layer_words.h"

static constexpr uint32_t kShared = 1000;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const citystream::LayerInput input({data, size});
    const auto view = citystream::codec::atlas::AtlasLayerView::create(input.words, input.step_words, kShared);
    if (!view) return 0;
    for (const auto& use : view->shared_charts()) {
        if (use.number >= kShared || use.chart_in_tile >= view->chart_count() || !(use.metres_per_texel >= 0))
            std::abort();
    }
    for (uint32_t chart = 0; chart < view->chart_count(); ++chart) {
        for (uint32_t mip = view->finest_mip(); mip < view->mip_count(chart); ++mip) {
            const uint32_t right = std::max(1u, view->width(chart) >> mip) - 1;
            const uint32_t top = std::max(1u, view->height(chart) >> mip) - 1;
            uint8_t rgb[3];
            view->texel(chart, mip, 0, 0, rgb);
            view->texel(chart, mip, right, top, rgb);
            view->alpha(chart, mip, right, top);
        }
    }
    return 0;
}
