// The two forms of a tile's atlas layer, told apart by the first word: charts with mips and bounds of their own
// (atlas_layer.h), and charts that share pages (page_layer.h). What everyone who takes an atlas layer asks first.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/atlas_layer.h"
#include "codec/result.h"

namespace citystream::codec::atlas {

enum class AtlasForm : uint8_t { kCharts, kPages };

/// What the checked words of a prefix say, whatever their form.
struct AtlasFacts {
    AtlasForm form = AtlasForm::kCharts;
    uint32_t chart_count = 0;
    uint32_t finest_mip = 0;  ///< finest level of a chart (kCharts) or of all pages (kPages) that the prefix holds
    std::vector<SharedChartUse> shared_charts;  ///< ascending by chart_in_tile; pages have none
    std::vector<uint32_t> alpha_charts;         ///< those of the tile's own with alpha, ascending; pages have none
};

/// Checks a prefix as the view of its form does (AtlasLayerView, PageLayerView) and refuses what that refuses; words
/// that begin like neither are refused as charts.
Result<AtlasFacts> check_atlas(std::span<const uint32_t> words, std::span<const uint32_t> step_words,
                               uint64_t dictionary_size = 0);

}  // namespace citystream::codec::atlas
