#include "client/light/environment_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace citystream::client {
namespace {

constexpr double kPi = std::numbers::pi;

/// Cosine of the angle from the zenith at a row's upper edge; the ends are exact.
double edge_cosine(uint32_t height, double row) {
    return std::cos(kPi * row / height);
}

Rgb mixed(const Rgb& a, const Rgb& b, float s) {
    Rgb result;
    for (size_t c = 0; c < 3; ++c) result[c] = a[c] + (b[c] - a[c]) * s;
    return result;
}

/// Texel of a row and column that may lie one step beyond the edges: a step over a pole goes to the other side of it.
const Rgb& texel_around(const EnvironmentMap& map, int64_t column, int64_t row) {
    const int64_t width = map.width, height = map.height;
    if (row < 0 || row >= height) {
        row = row < 0 ? 0 : height - 1;
        column += width / 2;
    }
    column = (column % width + width) % width;
    return map.texels[static_cast<size_t>(row * width + column)];
}

}  // namespace

double angle_between(const Direction& a, const Direction& b) {
    const Direction across = codec::cross(a, b);
    return std::atan2(std::sqrt(dot(across, across)), dot(a, b));
}

Direction turned_clockwise(const Direction& direction, double yaw) {
    const double c = std::cos(yaw), s = std::sin(yaw);
    return {c * direction[0] + s * direction[1], c * direction[1] - s * direction[0], direction[2]};
}

Direction map_direction(uint32_t width, uint32_t height, double column, double row) {
    const double azimuth = 2 * kPi * (column / width - 0.5), theta = kPi * row / height;
    const double level = std::sin(theta);
    return {level * std::sin(azimuth), level * std::cos(azimuth), std::cos(theta)};
}

double map_solid_angle(uint32_t width, uint32_t height, uint32_t row) {
    return 2 * kPi / width * (edge_cosine(height, row) - edge_cosine(height, row + 1.0));
}

Rgb EnvironmentMap::radiance(const Direction& from, double yaw) const {
    const double azimuth = std::atan2(from[0], from[1]) - yaw;
    const double theta = std::atan2(std::hypot(from[0], from[1]), from[2]);
    const double turns = azimuth / (2 * kPi) + 0.5;
    const double x = (turns - std::floor(turns)) * width - 0.5, y = theta / kPi * height - 0.5;
    const double column = std::floor(x), row = std::floor(y);
    const auto i = static_cast<int64_t>(column), j = static_cast<int64_t>(row);
    const auto s = static_cast<float>(x - column), t = static_cast<float>(y - row);
    return mixed(mixed(texel_around(*this, i, j), texel_around(*this, i + 1, j), s),
                 mixed(texel_around(*this, i, j + 1), texel_around(*this, i + 1, j + 1), s), t);
}

LightSum map_energy(std::span<const Rgb> texels, uint32_t width, uint32_t height) {
    assert(texels.size() == size_t{width} * height);
    LightSum energy{};
    for (uint32_t row = 0; row < height; ++row) {
        LightSum sum{};
        for (const Rgb& texel : texels.subspan(size_t{row} * width, width)) {
            for (size_t c = 0; c < 3; ++c) sum[c] += texel[c];
        }
        const double solid_angle = map_solid_angle(width, height, row);
        for (size_t c = 0; c < 3; ++c) energy[c] += sum[c] * solid_angle;
    }
    return energy;
}

LightSum map_energy(const EnvironmentMap& map) {
    return map_energy(map.texels, map.width, map.height);
}

MapReduction::MapReduction(uint32_t width, uint32_t height, uint32_t to_width, uint32_t to_height)
    : width_(width), height_(height), row_means_(std::min(width, to_width)) {
    assert(width > 0 && height > 0 && to_width > 0 && to_height > 0);
    map_.width = std::min(width, to_width);
    map_.height = std::min(height, to_height);
    sums_.resize(size_t{map_.width} * map_.height);
}

void MapReduction::add_row(std::span<const Rgb> row) {
    assert(row.size() == width_ && row_ < height_);
    std::fill(row_means_.begin(), row_means_.end(), LightSum{});
    // Columns i of the source and j of the result overlap in units of 1 / (width * width of the result).
    const uint64_t wide = width_, narrow = map_.width;
    for (uint64_t i = 0, j = 0; i < wide;) {
        const uint64_t begin = std::max(i * narrow, j * wide), end = std::min((i + 1) * narrow, (j + 1) * wide);
        const double share = static_cast<double>(end - begin) / static_cast<double>(wide);
        for (size_t c = 0; c < 3; ++c) row_means_[j][c] += share * row[i][c];
        if (end == (i + 1) * narrow) ++i;
        if (end == (j + 1) * wide) ++j;
    }
    const uint64_t tall = height_, low = map_.height;
    for (uint64_t j = row_ * low / tall; j < low && j * tall < (row_ + 1) * low; ++j) {
        const double top = std::max(static_cast<double>(row_) / height_, static_cast<double>(j) / map_.height);
        const double bottom =
            std::min((row_ + 1.0) / height_, (static_cast<double>(j) + 1) / static_cast<double>(map_.height));
        const double solid_angle = 2 * kPi / map_.width * (edge_cosine(1, top) - edge_cosine(1, bottom));
        LightSum* const sums = &sums_[j * map_.width];
        for (uint32_t i = 0; i < map_.width; ++i) {
            for (size_t c = 0; c < 3; ++c) sums[i][c] += solid_angle * row_means_[i][c];
        }
    }
    ++row_;
}

EnvironmentMap MapReduction::take() {
    assert(row_ == height_);
    map_.texels.resize(sums_.size());
    for (uint32_t row = 0; row < map_.height; ++row) {
        const double solid_angle = map_solid_angle(map_.width, map_.height, row);
        for (uint32_t column = 0; column < map_.width; ++column) {
            const size_t i = size_t{row} * map_.width + column;
            for (size_t c = 0; c < 3; ++c) map_.texels[i][c] = static_cast<float>(sums_[i][c] / solid_angle);
        }
    }
    return std::move(map_);
}

EnvironmentMap reduced(const EnvironmentMap& map, uint32_t greatest_width) {
    const uint32_t greatest_height = std::max(greatest_width / 2, 1U);
    if (map.width <= greatest_width && map.height <= greatest_height) return map;
    MapReduction reduction(map.width, map.height, greatest_width, greatest_height);
    for (uint32_t row = 0; row < map.height; ++row)
        reduction.add_row({map.texels.data() + size_t{row} * map.width, map.width});
    return reduction.take();
}

}  // namespace citystream::client
