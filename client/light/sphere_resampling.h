// From one division of the sphere into texels to another, without losing light.
//
// Each texel of the result is the mean of lookups spread over its area, weighted by the solid angles that they stand
// for, so that a uniform map stays as it is. Lookups may hit or miss a small lamp: what is brighter than kHot times the
// mean is taken out before and added to the texels that its parts lie in, part by part. A last factor, near 1, makes
// the energy of the rest that of the source, so that the sum of radiance times solid angle is the same before and after
// (to rounding).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "client/light/environment_map.h"
#include "codec/radiance/source_directions.h"

namespace citystream::client {

/// Texels of an EnvironmentMap, row by row, turned by a yaw.
struct LatLongGrid {
    uint32_t width, height;
    double yaw = 0;

    size_t texels() const { return size_t{width} * height; }
    /// Radians from texel to texel, about.
    double spacing() const { return std::max(2 * std::numbers::pi / width, std::numbers::pi / height); }
    double solid_angle(size_t texel) const {
        return map_solid_angle(width, height, static_cast<uint32_t>(texel / width));
    }
    LightSum energy(std::span<const Rgb> radiance) const { return map_energy(radiance, width, height); }
    /// Calls visit(direction, weight) for parts x parts parts of a texel; weights are as their solid angles.
    template <typename Visit>
    void visit_parts(size_t texel, uint32_t parts, Visit&& visit) const {
        const auto column = static_cast<uint32_t>(texel % width), row = static_cast<uint32_t>(texel / width);
        const double turned = yaw / (2 * std::numbers::pi) * width;
        for (uint32_t j = 0; j < parts; ++j) {
            const double down = row + (j + 0.5) / parts;
            const double weight = std::sin(std::numbers::pi * down / height);
            for (uint32_t i = 0; i < parts; ++i)
                visit(map_direction(width, height, column + (i + 0.5) / parts + turned, down), weight);
        }
    }
    /// Column and row, 0..width and 0..height.
    std::array<double, 2> place_of(const Direction& d) const {
        const double turns = (std::atan2(d[0], d[1]) - yaw) / (2 * std::numbers::pi) + 0.5;
        const double down = std::atan2(std::sqrt(d[0] * d[0] + d[1] * d[1]), d[2]) / std::numbers::pi;
        return {(turns - std::floor(turns)) * width, down * height};
    }
    size_t texel_at(const Direction& d) const {
        const auto [column, row] = place_of(d);
        return size_t{std::min(static_cast<uint32_t>(row), height - 1)} * width +
               std::min(static_cast<uint32_t>(column), width - 1);
    }
};

/// Cells of codec/radiance/source_directions.h. A `picture` has y up, as cube maps in files do: its +z is north.
struct CubeGrid {
    uint32_t side;
    bool picture = false;

    size_t texels() const { return size_t{codec::radiance::kCubeFaces} * side * side; }
    /// Where texels are the widest, in the middle of a face.
    double spacing() const { return 2.0 / side; }
    double solid_angle(size_t texel) const {
        return codec::radiance::cell_solid_angle(side, static_cast<uint32_t>(texel));
    }
    LightSum energy(std::span<const Rgb> radiance) const {
        LightSum sum{};
        for (size_t i = 0; i < radiance.size(); ++i) {
            const double steradians = solid_angle(i);
            for (size_t c = 0; c < 3; ++c) sum[c] += steradians * radiance[i][c];
        }
        return sum;
    }
    template <typename Visit>
    void visit_parts(size_t texel, uint32_t parts, Visit&& visit) const {
        const auto column = static_cast<uint32_t>(texel % side), row = static_cast<uint32_t>(texel / side);
        const uint32_t fine = side * parts;
        for (uint32_t j = 0; j < parts; ++j) {
            for (uint32_t i = 0; i < parts; ++i) {
                const uint32_t cell = (row * parts + j) * fine + column * parts + i;
                const codec::radiance::GridDirection whole = codec::radiance::cell_direction(fine, cell);
                const Direction d = {static_cast<double>(whole[0]) / fine, static_cast<double>(whole[1]) / fine,
                                     static_cast<double>(whole[2]) / fine};
                const double squares = dot(d, d);
                visit(swapped(d), 1 / (squares * std::sqrt(squares)));
            }
        }
    }
    size_t texel_at(const Direction& d) const { return codec::radiance::cell_of(swapped(d), side); }

  private:
    Direction swapped(const Direction& d) const { return picture ? Direction{d[0], d[2], d[1]} : d; }
};

namespace resampling {

inline constexpr double kHot = 4;              ///< times the mean luminance
inline constexpr double kLookupsPerTexel = 2;  ///< across a texel of the source
inline constexpr double kPartsPerTexel = 8;    ///< of a hot texel, across a texel of the result
inline constexpr uint32_t kMostPartsAcross = 64;

/// How many parts of `spacing` are no wider than `goal`.
inline uint32_t parts_across(double spacing, double goal) {
    return static_cast<uint32_t>(std::clamp(std::ceil(spacing / goal), 1.0, double{kMostPartsAcross}));
}

/// Takes what is above `most` out of a map; returns it by texel.
inline std::vector<std::pair<size_t, Rgb>> take_hot(std::vector<Rgb>& radiance, double most) {
    std::vector<std::pair<size_t, Rgb>> hot;
    for (size_t i = 0; i < radiance.size(); ++i) {
        const double bright = luminance(radiance[i]);
        if (!(bright > most)) continue;
        Rgb excess = radiance[i];
        for (size_t c = 0; c < 3; ++c) {
            radiance[i][c] = static_cast<float>(radiance[i][c] * (most / bright));
            excess[c] -= radiance[i][c];
        }
        hot.emplace_back(i, excess);
    }
    return hot;
}

/// Calls visit(texel of `to`, weight, direction) for the lookups that fill it, texel by texel: half a texel of `from`
/// apart.
template <typename From, typename To, typename Visit>
void visit_lookups(const From& from, const To& to, Visit&& visit) {
    const uint32_t across = parts_across(to.spacing(), from.spacing() / kLookupsPerTexel);
    for (size_t i = 0; i < to.texels(); ++i)
        to.visit_parts(i, across, [&](const Direction& direction, double weight) { visit(i, weight, direction); });
}

/// Adds the light of texels of `from` to those of `to` that their parts lie in.
template <typename From, typename To>
void add_parts(const From& from, std::span<const std::pair<size_t, Rgb>> lights, const To& to,
               std::vector<LightSum>& sums) {
    const uint32_t across = parts_across(from.spacing(), to.spacing() / kPartsPerTexel);
    for (const auto& [texel, radiance] : lights) {
        double weights = 0;
        from.visit_parts(texel, across, [&](const Direction&, double weight) { weights += weight; });
        const double scale = from.solid_angle(texel) / weights;
        from.visit_parts(texel, across, [&, light = radiance](const Direction& direction, double weight) {
            LightSum& sum = sums[to.texel_at(direction)];
            for (size_t c = 0; c < 3; ++c) sum[c] += scale * weight * light[c];
        });
    }
}

}  // namespace resampling

/// radiance.size() == from.texels(). means(smooth) returns the mean radiance of each texel of `to` as visit_lookups
/// finds it in `smooth`, texels of `from`; for callers that remember what the lookups find where.
template <typename From, typename To, typename Means>
std::vector<Rgb> resample_sphere(const From& from, std::span<const Rgb> radiance, const To& to, Means&& means) {
    namespace r = resampling;
    std::vector<Rgb> smooth(radiance.begin(), radiance.end());
    const double mean = luminance(from.energy(radiance)) / (4 * std::numbers::pi);
    const auto hot = r::take_hot(smooth, r::kHot * mean);
    const LightSum goal = from.energy(smooth);

    std::vector<LightSum> sums = means(std::span<const Rgb>(smooth));
    LightSum gathered{};
    for (size_t i = 0; i < sums.size(); ++i) {
        const double solid_angle = to.solid_angle(i);
        for (size_t c = 0; c < 3; ++c) gathered[c] += sums[i][c] *= solid_angle;
    }
    for (LightSum& sum : sums) {
        for (size_t c = 0; c < 3; ++c) sum[c] *= gathered[c] > 0 ? goal[c] / gathered[c] : 1;
    }
    r::add_parts(from, hot, to, sums);
    std::vector<Rgb> result(sums.size());
    for (size_t i = 0; i < result.size(); ++i) {
        const double solid_angle = to.solid_angle(i);
        for (size_t c = 0; c < 3; ++c) result[i][c] = static_cast<float>(sums[i][c] / solid_angle);
    }
    return result;
}

/// O(lookups).
template <typename From, typename To>
std::vector<Rgb> resample_sphere(const From& from, std::span<const Rgb> radiance, const To& to) {
    return resample_sphere(from, radiance, to, [&](std::span<const Rgb> smooth) {
        std::vector<LightSum> means(to.texels());
        std::vector<double> weights(to.texels());
        resampling::visit_lookups(from, to, [&](size_t texel, double weight, const Direction& direction) {
            const Rgb& value = smooth[from.texel_at(direction)];
            weights[texel] += weight;
            for (size_t c = 0; c < 3; ++c) means[texel][c] += weight * value[c];
        });
        for (size_t i = 0; i < means.size(); ++i) {
            for (double& channel : means[i]) channel /= weights[i];
        }
        return means;
    });
}

}  // namespace citystream::client
