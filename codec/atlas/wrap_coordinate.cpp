#include "codec/atlas/wrap_coordinate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "codec/atlas/wrap_coordinate_layout.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kGrid = WRAP_GRID;
constexpr uint32_t kMaxChart = (WRAP_SIZE_MASK + 1) * kGrid;
constexpr uint32_t kMaxOrigin = (~0u >> WRAP_ORIGIN_SHIFT) * kGrid;
constexpr double kLargestPlace = 2147483648.0;
static_assert(kMaxChart == 512 && kMaxOrigin == 4092 && WRAP_PLACE_ONE * kWrapStep == 1);
static_assert((WRAP_PLACE_MASK + 1) * kWrapStep == 64 && WRAP_PLACE_MASK + 1 == 1u << WRAP_SIZE_SHIFT);

Status check_chart_axis(uint32_t origin, uint32_t size, uint32_t border) {
    if (origin % kGrid != 0 || size % kGrid != 0) {
        return Error{"chart at " + std::to_string(origin) + " of " + std::to_string(size) +
                     " texels: a packed coordinate holds multiples of 4"};
    }
    if (size == 0 || size > kMaxChart)
        return Error{"chart of " + std::to_string(size) + " texels: a packed coordinate holds 4 to 512"};
    if (origin > kMaxOrigin)
        return Error{"chart at " + std::to_string(origin) + ": a packed coordinate holds 0 to 4092"};
    if (size / 2 <= border)
        return Error{"chart of " + std::to_string(size) + " texels is all border (" + std::to_string(border) + ")"};
    return Done{};
}

}  // namespace

Result<uint32_t> encode_wrap_axis(uint32_t origin, uint32_t size, uint32_t border, double place) {
    if (Status checked = check_chart_axis(origin, size, border); !checked) return checked.error();
    return move_wrap_axis((origin / kGrid) << WRAP_ORIGIN_SHIFT | (size / kGrid - 1) << WRAP_SIZE_SHIFT, place);
}

Result<uint32_t> move_wrap_axis(uint32_t word, double place) {
    if (!(place >= 0 && place < kWrapPlaceEnd))
        return Error{"place " + std::to_string(place) + " in a chart: a packed coordinate holds 0 to 63.998"};
    return (word & ~WRAP_PLACE_MASK) | static_cast<uint32_t>(rounded_place(place) * WRAP_PLACE_ONE);
}

double rounded_place(double place) {
    return std::floor(place * WRAP_PLACE_ONE + 0.5) * kWrapStep;
}

WrapAxis decode_wrap_axis(uint32_t word, uint32_t border) {
    const uint64_t padded = ((word >> WRAP_SIZE_SHIFT & WRAP_SIZE_MASK) + 1) * kGrid;
    const uint64_t size = padded - std::min(padded, 2 * uint64_t{border});
    return {(word >> WRAP_ORIGIN_SHIFT) * kGrid + border, static_cast<uint32_t>(size), word & WRAP_PLACE_MASK};
}

Status check_wrap_axis(uint32_t word, uint32_t border, uint32_t page_side) {
    const uint32_t origin = (word >> WRAP_ORIGIN_SHIFT) * kGrid;
    const uint32_t size = ((word >> WRAP_SIZE_SHIFT & WRAP_SIZE_MASK) + 1) * kGrid;
    if (Status checked = check_chart_axis(origin, size, border); !checked) return checked;
    if (origin + size > page_side) {
        return Error{"chart at " + std::to_string(origin) + " of " + std::to_string(size) +
                     " texels leaves a page of " + std::to_string(page_side)};
    }
    return Done{};
}

Result<double> wrap_shift(std::span<const double> places) {
    if (places.empty()) return 0.0;
    double low = kLargestPlace, high = -kLargestPlace;
    for (const double place : places) {
        if (!(std::abs(place) <= kLargestPlace)) return Error{"place " + std::to_string(place) + " in a chart"};
        low = std::min(low, place);
        high = std::max(high, place);
    }
    const double shift = std::floor(low);
    if (!(high - shift < kWrapPlaceEnd)) {
        return Error{"polygon shows its chart " + std::to_string(high - low) +
                     " times: a packed coordinate holds 63.998, split the polygon"};
    }
    return shift;
}

Result<PackedCoordinate> encode_wrap_coordinate(const Rectangle& padded, uint32_t border, double u, double v) {
    const auto across = encode_wrap_axis(padded.x, padded.width, border, u);
    if (!across) return across.error();
    const auto up = encode_wrap_axis(padded.y, padded.height, border, v);
    if (!up) return up.error();
    return PackedCoordinate{*across, *up};
}

ChartFrame frame_of(PackedCoordinate packed, uint32_t border) {
    const WrapAxis u = decode_wrap_axis(packed.u, border), v = decode_wrap_axis(packed.v, border);
    return {static_cast<float>(u.origin), static_cast<float>(v.origin), static_cast<float>(u.size),
            static_cast<float>(v.size)};
}

}  // namespace citystream::codec::atlas
