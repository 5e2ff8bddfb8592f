#include "codec/mesh/precision.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <functional>

namespace citystream::codec::mesh {
namespace {

uint32_t low_bits(uint32_t count) {
    return (1u << count) - 1;
}

/// What kThirds adds to all coordinates before they are cut.
int64_t grid_shift(Reconstruction reading, uint32_t common_dropped) {
    return reading == Reconstruction::kThirds ? PRECISION_THIRDS_PATTERN & low_bits(common_dropped) : 0;
}

/// From the camera, anywhere in its unit cell at 0, to the integers low..high.
uint32_t gap_to(int32_t low, int32_t high) {
    if (low > 0) return static_cast<uint32_t>(low) - 1;
    return high < 0 ? static_cast<uint32_t>(-high) : 0;
}

uint32_t box_distance(uint32_t common_dropped, const std::array<int32_t, 3>& from_camera,
                      const std::array<uint32_t, 3>& low, const std::array<uint32_t, 3>& high) {
    const uint32_t inside = low_bits(common_dropped);
    std::array<uint32_t, 3> gaps{};
    for (size_t c = 0; c < 3; ++c) {
        gaps[c] = gap_to(from_camera[c] + static_cast<int32_t>(low[c] & ~inside),
                         from_camera[c] + static_cast<int32_t>(high[c] | inside));
    }
    return distance_bound(gaps);
}

}  // namespace

uint32_t dropped_for(double movement, uint32_t most) {
    if (!(movement >= 1)) return 0;
    if (std::isinf(movement)) return most;
    return std::min(static_cast<uint32_t>(std::ilogb(movement)), most);
}

uint32_t level_at(const ScreenError& error, double distance, double step, uint32_t full_bits) {
    if (!(distance > 0)) return full_bits;
    return full_bits - dropped_for(error.movement_at(distance) / step, full_bits - 1);
}

uint32_t DropRule::dropped_at(uint32_t distance) const {
    if (distance < distance_per_unit) return 0;
    return std::min(common_dropped, static_cast<uint32_t>(std::bit_width(distance / distance_per_unit)) - 1);
}

double greatest_error(Reconstruction reading) {
    switch (reading) {
        case Reconstruction::kMiddle:
            return 1.0 / 2;
        case Reconstruction::kThirds:
            return 2.0 / 3;
        default:
            return 1;
    }
}

DropRule drop_rule(const ScreenError& error, double off_axis_cosine, uint32_t common_dropped, Reconstruction reading) {
    const double units =
        std::ceil(greatest_error(reading) / (error.movement_at(1) * off_axis_cosine * off_axis_cosine));
    // No allowed error at all (or none that is a number): nothing is dropped at any distance.
    const bool finite = units >= 1 && units < 0x1p31;
    return {finite ? static_cast<uint32_t>(units) : units < 1 ? 1u : 0xffffffffu, common_dropped};
}

uint32_t distance_bound(const std::array<uint32_t, 3>& gaps) {
    std::array<uint32_t, 3> sorted = gaps;
    for (uint32_t& gap : sorted) gap >>= PRECISION_GAP_SHIFT;
    std::sort(sorted.begin(), sorted.end(), std::greater<>());
    const auto [a, b, c] = sorted;
    return std::max({PRECISION_WEIGHT_AXIS * a, PRECISION_WEIGHT_EDGE * (a + b), PRECISION_WEIGHT_CORNER * (a + b + c),
                     PRECISION_WEIGHT_NEAR_AXIS_1 * a + PRECISION_WEIGHT_NEAR_AXIS_2 * b,
                     PRECISION_WEIGHT_NEAR_CORNER_1 * a + PRECISION_WEIGHT_NEAR_CORNER_2 * (b + c)});
}

uint32_t reading_offset(Reconstruction reading, uint32_t dropped) {
    switch (reading) {
        case Reconstruction::kMiddle:
            return (1u << dropped) >> 1;
        case Reconstruction::kThirds:
            return PRECISION_THIRDS_PATTERN & low_bits(dropped);
        default:
            return 0;
    }
}

uint32_t PrecisionGrid::full_bits() const {
    return *std::max_element(bits.begin(), bits.end());
}

std::array<uint32_t, 3> PrecisionGrid::words_of(const GridPoint& point) const {
    std::array<uint32_t, 3> words{};
    for (size_t c = 0; c < 3; ++c) {
        words[c] = static_cast<uint32_t>(point[c]) - static_cast<uint32_t>(origin[c]);
        assert(words[c] <= low_bits(bits[c]));
    }
    return words;
}

GridPoint PrecisionGrid::point_of(const std::array<uint32_t, 3>& words, uint32_t dropped) const {
    const uint32_t offset = reading_offset(reading, dropped);
    GridPoint point{};
    for (size_t c = 0; c < 3; ++c) {
        point[c] = static_cast<int32_t>(static_cast<uint32_t>(origin[c]) + (words[c] >> dropped << dropped) + offset);
    }
    return point;
}

PrecisionGrid grid_of(std::span<const GridPoint> points, uint32_t common_dropped, Reconstruction reading) {
    assert(common_dropped < 30);
    PrecisionGrid grid;
    grid.common_dropped = common_dropped;
    grid.reading = reading;
    const int64_t shift = grid_shift(reading, common_dropped);
    for (size_t c = 0; c < 3; ++c) {
        int64_t low = points.empty() ? 0 : points[0][c], high = low;
        for (const GridPoint& point : points) {
            low = std::min<int64_t>(low, point[c]);
            high = std::max<int64_t>(high, point[c]);
        }
        const int64_t aligned = ((low + shift) >> common_dropped) * (int64_t{1} << common_dropped);
        const auto span = static_cast<uint64_t>(high + shift - aligned);
        grid.origin[c] = static_cast<int32_t>(aligned - shift);
        grid.bits[c] = std::max(static_cast<uint32_t>(std::bit_width(span)), common_dropped + 1);
    }
    return grid;
}

uint32_t dropped_in_box(const DropRule& rule, const std::array<int32_t, 3>& from_camera,
                        const std::array<uint32_t, 3>& low, const std::array<uint32_t, 3>& high) {
    return rule.dropped_at(box_distance(rule.common_dropped, from_camera, low, high));
}

uint32_t settled_dropped(const DropRule& rule, uint32_t resident, const std::array<int32_t, 3>& from_camera,
                         const std::array<uint32_t, 3>& low, const std::array<uint32_t, 3>& high) {
    const uint32_t distance = box_distance(rule.common_dropped, from_camera, low, high);
    const uint32_t wanted = rule.dropped_at(distance);
    return wanted <= resident ? wanted : std::max(resident, rule.dropped_at(distance - distance / 8));
}

}  // namespace citystream::codec::mesh
