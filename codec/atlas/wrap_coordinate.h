// Where a corner of a surface lies in a chart that is packed into a page: the three ways of bringing it to the shader,
// and the packed one's codec. Twin: shaders/wrap_coordinate.glsl.
//
// Source: "Space-Optimized Texture Atlases" 8.1.1 to 8.1.3 (Table 1, Equation 2, Algorithms 7 and 8), as corrected in
// the notes: a size of 512 can be said (the field holds size / 4 - 1); a place that would round up to 64 repeats is
// refused, as is everything out of range, nothing is truncated; a chart that does not repeat never wraps at 1.
//
// A chart is given by its padded rectangle in texels of the page and by the border on all its sides
// (chart_border.h, BorderRule::kUniform), or, for transports 1 and 2, by its interior. A place is counted in repeats
// along an axis: 0 .. 1 is the chart once.
#pragma once

#include <array>
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

/// A place along an axis that does not repeat, clamped so that neither rounding nor filtering passes the chart's ends:
/// at most 511/512 and, where there is no border to filter into, half a texel from both ends (8.1.4). A multiple of
/// 1/512. Precondition: interior > 0.
double clamped_place(double place, uint32_t interior, uint32_t border);

/// Table 1. With the same packed places all three give the shader the same bits.
enum class ChartTransport : uint8_t {
    kPerDraw = 1,    ///< a uniform: the frame once per draw of equal charts
    kAttribute = 2,  ///< the frame at every corner
    kPacked = 3,     ///< in the coordinate itself: 8 bytes a corner for frame and place
};

/// Interior in texels of the page; a negative size: the axis does not repeat and the sampler clamps it.
struct ChartFrame {
    float origin_u = 0, origin_v = 0, size_u = 0, size_v = 0;
    bool operator==(const ChartFrame&) const = default;
};
static_assert(sizeof(ChartFrame) == 16);

struct ChartPlace {
    float u = 0, v = 0;
    bool operator==(const ChartPlace&) const = default;
};
static_assert(sizeof(ChartPlace) == 8);

struct PackedCoordinate {
    uint32_t u = 0, v = 0;
    bool operator==(const PackedCoordinate&) const = default;
};
static_assert(sizeof(PackedCoordinate) == 8);

/// Both axes; errors as of encode_wrap_axis.
Result<PackedCoordinate> encode_wrap_coordinate(const Rectangle& padded, uint32_t border, double u, double v);
ChartFrame frame_of(PackedCoordinate packed, uint32_t border);
ChartPlace place_of(PackedCoordinate packed);

/// For charts whose border is not the same on all sides (transports 1 and 2 only). Sides up to kMaxBinSide are exact.
ChartFrame frame_of(const Rectangle& interior, bool repeat_u, bool repeat_v);

/// What a renderer stores for a triangle of one chart; members that a transport has no use for are empty.
struct TriangleCoordinates {
    ChartTransport transport = ChartTransport::kPacked;
    uint32_t border = 0;                       ///< kPacked: uniform of the page
    ChartFrame frame;                          ///< kPerDraw
    std::array<ChartFrame, 3> frames{};        ///< kAttribute
    std::array<ChartPlace, 3> places{};        ///< kPerDraw, kAttribute
    std::array<PackedCoordinate, 3> packed{};  ///< kPacked
};

/// Encodes the three corners' places (u, v). Every transport takes places on the packed grid and refuses what the
/// packed coordinate refuses, so that frames are identical.
Result<TriangleCoordinates> encode_triangle(ChartTransport transport, const Rectangle& padded, uint32_t border,
                                            const std::array<std::array<double, 2>, 3>& places);

struct CornerCoordinate {
    ChartFrame frame;
    ChartPlace place;
    bool operator==(const CornerCoordinate&) const = default;
};

/// What the fragment shader sees at a corner (0..2).
CornerCoordinate decode_corner(const TriangleCoordinates& triangle, uint32_t corner);

/// Table 1: floats (or words of their size) for the charts of one triangle, beside its places.
struct TransportCost {
    uint32_t stored, sent;
};
TransportCost transport_cost(ChartTransport transport);

/// Equation 2 along an axis: see wrap_axis in the shader; the same floats. `size` as in ChartFrame; level >= 0.
float wrapped_texel(float origin, float size, float place, float level);

}  // namespace citystream::codec::atlas
