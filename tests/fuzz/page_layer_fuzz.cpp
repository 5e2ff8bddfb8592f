// Any words as an atlas layer in pages: what the view accepts has the first and last texel of every level that the
// prefix holds, and its charts lie in their pages.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/atlas/page_layer.h"
#include "tests/fuzz/layer_words.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec::atlas;
    const citystream::LayerInput input({data, size});
    const auto view = PageLayerView::create(input.words, input.step_words);
    if (!view) return 0;
    for (uint32_t page = 0; page < view->page_count(); ++page) {
        for (uint32_t mip = view->finest_mip(); mip <= view->mips(); ++mip) {
            uint8_t rgb[3];
            view->texel(page, mip, 0, 0, rgb);
            view->texel(page, mip, (view->width(page) >> mip) - 1, (view->height(page) >> mip) - 1, rgb);
        }
    }
    for (uint32_t i = 0; i < view->chart_count(); ++i) {
        const PageChart chart = view->chart(i);
        if (chart.flat) continue;
        const WrapAxis u = decode_wrap_axis(chart.packed.u, view->border());
        const WrapAxis v = decode_wrap_axis(chart.packed.v, view->border());
        if (u.size == 0 || v.size == 0 || u.origin + u.size > view->width(chart.page) ||
            v.origin + v.size > view->height(chart.page))
            std::abort();
    }
    return 0;
}
