// The smallest version of a chart that a metric still takes for the original (thesis section 7.2, algorithms 1 and 2).
//
// Differences from the printed algorithms, as the notes correct them: sizes are bisected as integers, so that the
// search always ends; every candidate is compared with the original, also along the second axis, so that the tolerance
// is never exceeded; if nothing smaller is accepted, the original is the result. Both orders together end within the
// calls of one: they begin alike, with each side alone, and share what that says of the errors.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "codec/atlas/alpha_mask.h"
#include "codec/atlas/image.h"
#include "codec/atlas/image_metric.h"
#include "codec/atlas/resample.h"

namespace citystream::codec::atlas {

enum class SearchOrder : uint8_t {
    kWidthFirst,   ///< least width at full height, then least height: ceil(log2 w) + ceil(log2 h) metric calls at most
    kHeightFirst,  ///< the other way round
    /// The smallest area that either order, or a mix of both, is expected to find (algorithm 2): floor(log2 w + log2 h)
    /// + 2 metric calls at most, in all.
    kBoth,
    kAlternate,  ///< one step of width, one of height, ...: less anisotropic, as many calls as one order
    kBest,       ///< the smallest area of all of them, each to its end
};

struct SearchSettings {
    Metric metric;
    SearchOrder order = SearchOrder::kBoth;
    Shrink filter = Shrink::kLanczos;
    Edges edges;  ///< how the chart is continued beyond its edges, when it is shrunk and when it is shown
    /// Sizes are multiples of this (4 for charts of whole blocks), or the original's own size. Not 0.
    uint32_t multiple = 1;
    /// How much of an image with alpha is there (there_of). With it, as much of its charts is (keep_share), and they
    /// are judged as they are drawn, by test_alpha. Without it, alpha is as the filter leaves it, and what is seen over
    /// black and over white is judged.
    std::optional<AreaShare> there;
    ViewingConditions view;
};

struct SearchResult {
    Image image;       ///< the chart, exactly as 8-bit sRGB shows it; chart_image(image) loses nothing that can be seen
    double error = 0;  ///< of the image, enlarged bilinearly to the original's size: at most metric.largest_error()
    uint32_t calls = 0;  ///< of the metric, all of them
};

/// Precondition: `original` is not empty, has 1, 3 or 4 channels and sides of at most 65535. It is first rounded to
/// 8-bit sRGB, as it would be stored. Metric kNone: the original. Cost: `calls` times resampling plus metric, each
/// O(area).
SearchResult search_chart(const Image& original, const SearchSettings& settings);

/// The chart as the search judges it: enlarged to the original's size, and as `settings.there` says. `chart` outlives
/// the result.
ImageRows shown_rows(const Image& chart, uint32_t width, uint32_t height, const SearchSettings& settings);

/// "width", "height", "both", "alternate", "best".
std::optional<SearchOrder> parse_search_order(std::string_view text);
std::string_view name_of(SearchOrder order);

}  // namespace citystream::codec::atlas
