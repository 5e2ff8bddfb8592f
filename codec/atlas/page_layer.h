// Atlas layer of a tile whose charts share pages, as the thesis packs them: charts with borders in common images, mips
// 0..M of whole pages as steps, coarse to fine. The other form of the layer (atlas_layer.h) gives every chart mips and
// bounds of its own; this one has the coordinates of all charts in one image, which vertices can carry packed
// (wrap_coordinate.h).
//
// Source: "Space-Optimized Texture Atlases" 7.3 and 8.1, as corrected in the notes. Beyond it: flat charts are a
// colour in the chart table and take no texel; pages need not be powers of two.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/page_layout.h"
#include "codec/atlas/rectangle_packing_atlas.h"
#include "codec/atlas/wrap_coordinate.h"
#include "codec/layer_steps.h"
#include "codec/result.h"

namespace citystream::codec::atlas {

struct PageOptions {
    uint32_t mips = 2;  ///< M: levels 0..M; at most kMostMips
    uint32_t rate_distortion = 0;
    uint32_t max_page_side = 4096;  ///< a multiple of 4 * 2^M, at most 4096
    /// kTight: charts of their own size on pages as small as can be. kPowerOfTwo: as the thesis has it (7.3): pages as
    /// predicted from what charts are asked for, charts stretched from there towards their own size (Algorithm 6), and
    /// what is left filled (Algorithm 5), so that every texel is a chart's, as far as none exceeds longest_page_chart.
    PageShape shape = PageShape::kTight;
};

/// Longest side of a chart's interior: what a packed coordinate can say less its borders. Larger charts are shrunk to
/// it, in linear light.
uint32_t longest_page_chart(uint32_t mips);

/// The most mips, up to `mips`, whose borders and alignment leave a quarter of the pages to the charts' own texels; up
/// to 3 in any case, as distant frames lose 2 dB with one less. Pages of more would show small charts enlarged: at
/// M = 7 none takes less than 512 x 512 texels.
uint32_t affordable_mips(std::span<const ChartImage> charts, uint32_t mips);

/// Encodes. `asked`: of each chart, metres a texel that it need not be finer than, 0: none (empty: all); regarded by
/// kPowerOfTwo. Charts keep their size but for alignment (they are enlarged by less than 4 * 2^M texels, and shrunk
/// where they are longer than longest_page_chart) with kTight. M + 1 steps; a step's error: the largest
/// metres_per_texel of any chart at that level, flat charts apart. No charts, or flat ones only: one step without
/// pages. Refuses options out of range.
Result<LayerSteps> encode_pages(std::span<const ChartImage> charts, const PageOptions& options = {},
                                std::span<const float> asked = {});

/// Whether the words begin like those of encode_pages.
bool is_page_layer(std::span<const uint32_t> words);

/// A chart of a page layer.
struct PageChart {
    uint32_t page = 0;
    uint32_t flags = 0;                          ///< PAGES_CHART_*
    PackedCoordinate packed;                     ///< at place 0; of flat charts nothing
    std::optional<std::array<uint8_t, 3>> flat;  ///< its colour

    bool repeats_u() const { return (flags & PAGES_CHART_REPEAT_U) != 0; }
    bool repeats_v() const { return (flags & PAGES_CHART_REPEAT_V) != 0; }
};

/// A checked view of a prefix; nothing can be read outside the words afterwards, and every chart lies in its page.
class PageLayerView {
  public:
    static Result<PageLayerView> create(std::span<const uint32_t> words, std::span<const uint32_t> step_words);
    uint32_t chart_count() const;
    uint32_t page_count() const;
    uint32_t mips() const;        ///< M
    uint32_t border() const;      ///< texels of level 0, on all sides of every chart
    uint32_t finest_mip() const;  ///< finest level that this prefix holds
    uint32_t width(uint32_t page) const;
    uint32_t height(uint32_t page) const;
    PageChart chart(uint32_t index) const;
    /// One texel of a level that the prefix holds; x, y inside the level's size.
    void texel(uint32_t page, uint32_t mip, uint32_t x, uint32_t y, uint8_t rgb[3]) const;

  private:
    std::span<const uint32_t> words_;
    uint32_t finest_mip_ = 0;
};

}  // namespace citystream::codec::atlas
