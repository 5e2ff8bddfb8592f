#include "tiles/layers/page_places.h"

#include <algorithm>
#include <vector>

#include "codec/atlas/wrap_coordinate.h"

namespace citystream::tiles::layers {
namespace {

/// Whole repeats to leave out of an axis that repeats.
double shift_of(std::span<const double> places) {
    const auto [low, high] = std::minmax_element(places.begin(), places.end());
    if (*low >= 0 && *high < codec::atlas::kWrapPlaceEnd) return 0;
    const auto shift = codec::atlas::wrap_shift(places);
    return shift ? *shift : 0;
}

void fit_axis(std::span<ChartPlaceOfCorner> corners, size_t axis, bool repeats, uint32_t texels) {
    std::vector<double> places;
    places.reserve(corners.size());
    for (const ChartPlaceOfCorner& corner : corners) places.push_back(codec::atlas::rounded_place(corner[axis]));
    const double shift = repeats ? shift_of(places) : 0, half_texel = 0.5 / texels;
    for (size_t i = 0; i < corners.size(); ++i) {
        const bool is_end = !repeats && places[i] < 0 && places[i] >= -half_texel;
        corners[i][axis] = is_end ? 0 : places[i] - shift;
    }
}

}  // namespace

void fit_page_places(std::span<ChartPlaceOfCorner> corners, const codec::atlas::ChartImage& chart) {
    fit_axis(corners, 0, chart.repeat_u, chart.width);
    fit_axis(corners, 1, chart.repeat_v, chart.height);
}

}  // namespace citystream::tiles::layers
