// From charts to atlas pages: how large each chart becomes, on which page it lies and where, so that blocks and mips
// never mix charts. What a builder calls.
//
// Source: "Space-Optimized Texture Atlases" 7.3 and 8.1.4 to 8.1.6. Beyond it: charts that exceed one page are spread
// over several; borders only where they are needed (chart_border.h); pages that are no powers of two and so need no
// stretching; growth that stops at the source image's size, or is stated where it does not.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/chart_border.h"
#include "codec/atlas/rectangle_packing.h"
#include "codec/atlas/rectangle_packing_fill.h"
#include "codec/atlas/rectangle_packing_stretch.h"
#include "codec/result.h"

namespace citystream::codec::atlas {

/// Texels, without borders.
struct ChartRequest {
    RectangleSize wanted;  ///< at least this large: what coverage and saliency ask for
    RectangleSize source;  ///< more than this shows nothing new: the original or view-matched image; wanted fits in it
    bool repeat_u = false, repeat_v = false;
};

enum class PageShape : uint8_t {
    kPowerOfTwo,  ///< as predicted in 7.3.1, doubled until the charts fit; halved where fill that may go beyond the
                  ///< source (kSubtrees) then meets max_chart_side before the page is full: charts come on several
    kTight,       ///< any multiple of the alignment unit, as small as the packers manage: nothing need be stretched
};

struct AtlasPackingOptions {
    uint32_t mips = 2;               ///< M of the paper, at most kMostMips: levels 0..M are kept
    bool blocks = true;              ///< 4 x 4 blocks (BC1): unit 4 * 2^M, else 2^M
    bool packed_coordinates = true;  ///< origins and sizes at least multiples of 4 (wrap_coordinate.h)
    BorderRule border = BorderRule::kUniform;
    uint32_t max_page_side = 4096;  ///< at most kMaxBinSide
    uint32_t max_chart_side = 512;  ///< of padded charts; the packed coordinate holds no more than 512
    PageShape shape = PageShape::kPowerOfTwo;
    PackEffort effort = PackEffort::kStrongest;  ///< with a fill that needs a tree: kStrongestTree instead
    bool stretch = false;                        ///< Algorithm 6: charts grow from wanted towards source
    FillMode fill = FillMode::kNone;             ///< Algorithm 5
    /// Fill may make charts larger than their source (100.00 % of a page, with texels that show nothing new). False:
    /// fill stops there, and the page keeps empty texels.
    bool fill_beyond_source = false;
};

/// Where the texels of a page went. All of them: wanted + grown + beyond_source + border + empty.
struct PageOccupancy {
    uint64_t texels = 0;
    uint64_t wanted = 0;         ///< what was asked for
    uint64_t grown = 0;          ///< interior beyond that, up to the source's size: shows more detail
    uint64_t beyond_source = 0;  ///< interior larger than the source (alignment and fill): of no use
    uint64_t border = 0;
    uint64_t empty = 0;

    /// Texels in charts: 1 when the page is filled.
    double covered() const;
    /// Texels of use: wanted, grown, and the borders that the rule asks for.
    double usable() const;
};

struct AtlasPage {
    uint32_t width = 0, height = 0;
    uint32_t stretch = 0;  ///< of kStretchSteps
    PageOccupancy occupancy;
};

struct PackedChart {
    uint32_t page = 0;
    Rectangle padded;    ///< origin and size are multiples of the unit
    Rectangle interior;  ///< padded without its border: resample the chart to exactly this size
    ChartBorder border;
};

struct AtlasPacking {
    uint32_t unit = 1;
    std::vector<AtlasPage> pages;
    std::vector<PackedChart> charts;  ///< like the requests
};

/// The sum over pages.
PageOccupancy total_occupancy(const AtlasPacking& packing);

/// Packs. Refuses (never truncates): a chart that is empty, wants more than its source has, or is larger than
/// max_chart_side with its border and alignment; options out of range; more than kMostRectangles charts. No charts: no
/// pages. Interiors are at least `wanted` and as large as alignment makes them, so a chart can exceed its source by
/// less than a unit; counted as beyond_source. Deterministic. Time (one page, n charts): some tens of packings with
/// stretch, one to nine without (kTight: some tens); see optimise_stretch and pack_rectangles.
Result<AtlasPacking> pack_atlas(std::span<const ChartRequest> requests, const AtlasPackingOptions& options);

}  // namespace citystream::codec::atlas
