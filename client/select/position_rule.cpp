#include "client/select/position_rule.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "codec/mesh/mesh_resident_layout.h"
#include "codec/mesh/position_error.h"

namespace citystream::client {
namespace {

using codec::mesh::kMeshBias;

/// No farther than this (500 km) along an axis: what a shader's 32-bit sums hold.
constexpr int64_t kFarthest = int64_t{1} << 29;

int64_t cell_of(int64_t coordinate) {
    return (coordinate + kMeshBias) >> RESIDENT_CELL_BITS << RESIDENT_CELL_BITS;
}

double squared_tangent_of_corner(const Camera& camera) {
    const double high = std::tan(camera.fov_y / 2);
    const double wide = high * camera.width / std::max(1u, camera.height);
    return high * high + wide * wide;
}

}  // namespace

double PositionRule::error_pixels(uint32_t dropped, double distance) const {
    return codec::mesh::position_error(dropped) * pixels_at_a_metre / distance;
}

PositionRule position_rule(const Camera& camera, double pixels) {
    PositionRule rule;
    const double squared_cosine = 1 / (1 + squared_tangent_of_corner(camera));
    codec::mesh::ScreenError error;
    error.pixels = pixels / std::numbers::sqrt3;  // the rule bounds each coordinate
    error.view_pixels = camera.height;
    error.near_length = 2 * std::tan(camera.fov_y / 2);
    error.near_distance = 1;
    rule.drop = codec::mesh::drop_rule(error, std::sqrt(squared_cosine), RESIDENT_CELL_BITS,
                                       codec::mesh::Reconstruction::kThirds);
    rule.camera = camera_cell(camera.position).cell;
    rule.pixels_at_a_metre = camera.pixels_per_metre(1) / squared_cosine;
    return rule;
}

uint32_t granted_in(const PositionRule& rule, const tiles::tileset::Bounds& bounds, const GridPoint& origin) {
    const std::array<int64_t, 3> corner = {origin.x, origin.y, 0};
    std::array<int32_t, 3> from_camera{};
    std::array<uint32_t, 3> low{}, high{};
    for (size_t c = 0; c < 3; ++c) {
        const auto from_cell_at = [&](double grid_units) {
            const int64_t cell = cell_of(corner[c] + static_cast<int64_t>(grid_units));
            return std::clamp(cell - kMeshBias - rule.camera[c], -kFarthest, kFarthest);
        };
        const int64_t first = from_cell_at(std::floor(bounds.min[c] * kGridUnitsPerMetre));
        const int64_t last = from_cell_at(std::ceil(bounds.max[c] * kGridUnitsPerMetre));
        from_camera[c] = static_cast<int32_t>(first);
        high[c] = static_cast<uint32_t>(std::max(first, last) - first);
    }
    return codec::mesh::dropped_in_box(rule.drop, from_camera, low, high);
}

std::array<uint32_t, codec::mesh::kMostMeshSteps> dropped_bits(const std::vector<tiles::tileset::StepRecord>& steps) {
    std::array<float, codec::mesh::kMostMeshSteps> errors{};
    const size_t count = std::min(steps.size(), errors.size());
    for (size_t i = 0; i < count; ++i) errors[i] = steps[i].error;
    return codec::mesh::dropped_of_steps(std::span(errors).first(count));
}

uint8_t mesh_prefix(const std::vector<tiles::tileset::StepRecord>& steps, uint32_t usable, uint32_t granted) {
    const auto dropped = dropped_bits(steps);
    for (uint32_t i = 0; i + 1 < std::min<uint32_t>(usable, codec::mesh::kMostMeshSteps); ++i) {
        if (dropped[i] <= granted) return static_cast<uint8_t>(i + 1);
    }
    return static_cast<uint8_t>(usable);
}

double greatest_position_error(const PositionRule& rule, uint32_t least_dropped, double nearest, double farthest) {
    const auto units = [](double metres) {
        return static_cast<uint32_t>(std::clamp(metres * kGridUnitsPerMetre, 0.0, 0x1p31));
    };
    const uint32_t first = std::max(least_dropped, rule.drop.dropped_at(units(nearest)));
    const double error = rule.error_pixels(first, nearest);
    const uint32_t last = rule.drop.dropped_at(units(farthest));
    if (last <= first) return error;
    // Between thresholds errors shrink with the distance; at each they are the same but for the last unit.
    const double threshold = std::ldexp(static_cast<double>(rule.drop.distance_per_unit), static_cast<int>(last));
    return std::max(error, rule.error_pixels(last, threshold * kMetresPerGridUnit));
}

}  // namespace citystream::client
