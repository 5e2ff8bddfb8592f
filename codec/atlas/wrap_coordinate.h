// Where a corner of a surface lies in a chart that is packed into a page: the frame of the chart, and the codec of the
// coordinate that holds frame and place in 2 x 32 bits. Twin: shaders/wrap_coordinate.glsl. The transports that bring
// them to the shader: client/render/chart_transport.h.
//
// Source: "Space-Optimized Texture Atlases" 8.1.1 to 8.1.3 (Table 1, Equation 2, Algorithms 7 and 8), as corrected in
// the notes: a size of 512 can be said (the field holds size / 4 - 1); a place that would round up to 64 repeats is
// refused, as is everything out of range, nothing is truncated; a chart that does not repeat never wraps at 1.
//
// A chart is given by its padded rectangle in texels of the page and by the border on all its sides
// (chart_border.h, BorderRule::kUniform). A place is counted in repeats along an axis: 0 .. 1 is the chart once.
#pragma once

#include <cstdint>
#include <span>

#include "codec/atlas/rectangle_packing.h"
#include "codec/result.h"

namespace citystream::codec::atlas {

/// Finest step of a packed place, and the first place that cannot be packed because it rounds to 64.
constexpr double kWrapStep = 1.0 / 512;
constexpr double kWrapPlaceEnd = 64 - kWrapStep / 2;

/// One axis: bits as in wrap_coordinate_layout.h. `origin` and `size` are the padded chart's. The place is rounded to
/// the nearest 1/512. Refuses: origin or size no multiple of 4, size not 4..512, origin above 4092, size <= 2 * border,
/// place not in [0, kWrapPlaceEnd) or not a number.
Result<uint32_t> encode_wrap_axis(uint32_t origin, uint32_t size, uint32_t border, double place);

/// The same chart at another place. Refuses places as encode_wrap_axis does.
Result<uint32_t> move_wrap_axis(uint32_t word, double place);

/// The place that a packed coordinate makes of a finite one: the nearest multiple of 1/512.
double rounded_place(double place);

struct WrapAxis {
    uint32_t origin = 0, size = 0;  ///< of the interior, texels
    uint32_t place = 0;             ///< in 1/512 repeats, 0 .. 32767
};

/// Any word decodes; the interior of a chart that is all border has size 0. Safe for words that nobody vouches for, but
/// what they say may lie outside the page: check_wrap_axis.
WrapAxis decode_wrap_axis(uint32_t word, uint32_t border);

/// Refuses a word whose chart has no interior or leaves a page of `page_side` texels.
Status check_wrap_axis(uint32_t word, uint32_t border, uint32_t page_side);

/// What to subtract from a polygon's places along a repeating axis so that they start in [0, 1): a whole number, the
/// same for all its corners. Refuses a polygon that spans too much to be packed (it must be split) and places that are
/// not finite or beyond 2^31. No corners: 0.
Result<double> wrap_shift(std::span<const double> places);

/// Interior in texels of the page; a negative size: the axis does not repeat and the sampler clamps it.
struct ChartFrame {
    float origin_u = 0, origin_v = 0, size_u = 0, size_v = 0;
    bool operator==(const ChartFrame&) const = default;
};
static_assert(sizeof(ChartFrame) == 16);

struct PackedCoordinate {
    uint32_t u = 0, v = 0;
    bool operator==(const PackedCoordinate&) const = default;
};
static_assert(sizeof(PackedCoordinate) == 8);

/// Both axes; errors as of encode_wrap_axis.
Result<PackedCoordinate> encode_wrap_coordinate(const Rectangle& padded, uint32_t border, double u, double v);
/// Of a chart that repeats.
ChartFrame frame_of(PackedCoordinate packed, uint32_t border);

}  // namespace citystream::codec::atlas
