#include "codec/atlas/atlas_form.h"

#include "codec/atlas/page_layer.h"

namespace citystream::codec::atlas {

Result<AtlasFacts> check_atlas(std::span<const uint32_t> words, std::span<const uint32_t> step_words,
                               uint64_t dictionary_size) {
    if (is_page_layer(words)) {
        const auto view = PageLayerView::create(words, step_words);
        if (!view) return view.error();
        return AtlasFacts{AtlasForm::kPages, view->chart_count(), view->finest_mip(), {}, {}};
    }
    const auto view = AtlasLayerView::create(words, step_words, dictionary_size);
    if (!view) return view.error();
    AtlasFacts facts{AtlasForm::kCharts, view->chart_count(), view->finest_mip(), view->shared_charts(), {}};
    for (uint32_t chart = 0; chart < view->chart_count(); ++chart) {
        if (view->has_alpha(chart)) facts.alpha_charts.push_back(chart);
    }
    return facts;
}

}  // namespace citystream::codec::atlas
