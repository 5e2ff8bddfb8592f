#include "client/light/sun_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace citystream::client {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRingInner = 5 * kPi / 180, kRingOuter = 15 * kPi / 180;
constexpr double kGreatestSpot = kRingInner;
/// A spot ends where it is this many times as bright as the ring, and below one of these parts of its peak: the first
/// that makes it compact. Glare around a sun is above the lower ones.
constexpr double kOverRing = 8;
constexpr std::array<double, 3> kPartsOfPeak = {0.02, 0.1, 0.3};

/// The texels of a map as a graph: 8 neighbours, across the seam and the poles.
class Texels {
  public:
    explicit Texels(const EnvironmentMap& map) : map_(map) {}

    double bright(size_t texel) const { return luminance(map_.texels[texel]); }
    double solid_angle(size_t texel) const { return map_solid_angle(map_.width, map_.height, row_of(texel)); }
    Direction direction(size_t texel) const {
        return map_direction(map_.width, map_.height, static_cast<double>(texel % map_.width) + 0.5,
                             row_of(texel) + 0.5);
    }
    template <typename Visit>
    void visit_neighbours(size_t texel, Visit&& visit) const {
        const int64_t width = map_.width, height = map_.height;
        const auto column = static_cast<int64_t>(texel % map_.width), row = static_cast<int64_t>(texel / map_.width);
        for (int64_t j = row - 1; j <= row + 1; ++j) {
            const bool over_pole = j < 0 || j >= height;
            for (int64_t i = column - 1; i <= column + 1; ++i) {
                const int64_t there = (i + width + (over_pole ? width / 2 : 0)) % width;
                visit(static_cast<size_t>((over_pole ? row : j) * width + there));
            }
        }
    }

  private:
    uint32_t row_of(size_t texel) const { return static_cast<uint32_t>(texel / map_.width); }
    const EnvironmentMap& map_;
};

size_t brightest_texel_above_horizon(const EnvironmentMap& map) {
    const auto end = map.texels.begin() + static_cast<ptrdiff_t>(texels_above_horizon(map));
    const auto brightest = std::max_element(map.texels.begin(), end,
                                            [](const Rgb& a, const Rgb& b) { return luminance(a) < luminance(b); });
    return static_cast<size_t>(brightest - map.texels.begin());
}

/// Median brightness between two angles around a texel; each texel counts once.
double ring_brightness(const EnvironmentMap& map, size_t peak) {
    const Texels texels(map);
    const Direction centre = texels.direction(peak);
    const double inner = std::cos(kRingInner), outer = std::cos(kRingOuter);
    const double peak_theta = std::acos(std::clamp(centre[2], -1.0, 1.0));
    std::vector<double> ring;
    for (uint32_t row = 0; row < map.height; ++row) {
        if (std::abs((row + 0.5) * kPi / map.height - peak_theta) > kRingOuter) continue;
        for (uint32_t column = 0; column < map.width; ++column) {
            const size_t texel = size_t{row} * map.width + column;
            const double cosine = dot(texels.direction(texel), centre);
            if (cosine <= inner && cosine >= outer) ring.push_back(texels.bright(texel));
        }
    }
    if (ring.empty()) return 0;
    const auto middle = ring.begin() + static_cast<ptrdiff_t>(ring.size() / 2);
    std::nth_element(ring.begin(), middle, ring.end());
    return *middle;
}

/// Texels connected to the peak that are at least so bright; empty if they reach further than a spot may.
std::vector<size_t> spot_above(const EnvironmentMap& map, size_t peak, double least) {
    const Texels texels(map);
    const Direction centre = texels.direction(peak);
    std::vector<size_t> spot = {peak};
    std::vector<bool> seen(map.texels.size());
    seen[peak] = true;
    bool compact = true;
    for (size_t next = 0; compact && next < spot.size(); ++next) {
        texels.visit_neighbours(spot[next], [&](size_t texel) {
            if (seen[texel] || texels.bright(texel) < least) return;
            seen[texel] = true;
            spot.push_back(texel);
            compact &= angle_between(texels.direction(texel), centre) <= kGreatestSpot;
        });
    }
    if (!compact) spot.clear();
    return spot;
}

/// The neighbours of the texels that are not among them.
std::vector<size_t> rim_of(const EnvironmentMap& map, const std::vector<size_t>& spot) {
    std::vector<bool> seen(map.texels.size());
    for (const size_t texel : spot) seen[texel] = true;
    std::vector<size_t> rim;
    for (const size_t texel : spot) {
        Texels(map).visit_neighbours(texel, [&](size_t there) {
            if (!seen[there]) rim.push_back(there);
            seen[there] = true;
        });
    }
    return rim;
}

/// Mean radiance of some texels.
Rgb mean_of(const EnvironmentMap& map, const std::vector<size_t>& some) {
    LightSum sum{};
    double weights = 0;
    for (const size_t texel : some) {
        const double solid_angle = Texels(map).solid_angle(texel);
        weights += solid_angle;
        for (size_t c = 0; c < 3; ++c) sum[c] += solid_angle * map.texels[texel][c];
    }
    Rgb mean{};
    for (size_t c = 0; c < 3; ++c) mean[c] = static_cast<float>(sum[c] / weights);
    return mean;
}

/// A texel of the spot and the light that is above the sky's.
struct Share {
    size_t texel;
    Rgb excess;
};

std::vector<Share> shares_of(const EnvironmentMap& map, const std::vector<size_t>& spot, const Rgb& sky) {
    std::vector<Share> shares;
    for (const size_t texel : spot) {
        Share share{texel, {}};
        for (size_t c = 0; c < 3; ++c) share.excess[c] = std::max(map.texels[texel][c] - sky[c], 0.0F);
        shares.push_back(share);
    }
    return shares;
}

/// The radius of an even disc whose light is spread as this is: its mean square is half of its radius' square. What the
/// texels themselves spread it by is taken off.
double disc_radius(const EnvironmentMap& map, const std::vector<Share>& shares, const Direction& centre) {
    const Texels texels(map);
    double squares = 0, weights = 0;
    for (const Share& share : shares) {
        const double weight = luminance(share.excess) * texels.solid_angle(share.texel);
        const double angle = angle_between(texels.direction(share.texel), centre);
        weights += weight;
        squares += weight * angle * angle;
    }
    const double high = kPi / map.height, wide = 2 * kPi / map.width * std::hypot(centre[0], centre[1]);
    const double spread = squares / weights - (high * high + wide * wide) / 12;
    return std::clamp(std::sqrt(2 * std::max(spread, 0.0)), kSunRadius, kGreatestSpot);
}

Sun sun_of(const EnvironmentMap& map, const std::vector<Share>& shares) {
    const Texels texels(map);
    Sun sun;
    Direction centre{};
    for (const Share& share : shares) {
        const double solid_angle = texels.solid_angle(share.texel);
        const Direction direction = texels.direction(share.texel);
        for (size_t c = 0; c < 3; ++c) {
            sun.irradiance[c] += solid_angle * share.excess[c];
            centre[c] += solid_angle * luminance(share.excess) * direction[c];
        }
    }
    const double length = std::sqrt(dot(centre, centre));
    for (size_t c = 0; c < 3; ++c) sun.direction[c] = centre[c] / length;
    sun.angular_radius = disc_radius(map, shares, sun.direction);
    return sun;
}

}  // namespace

std::optional<Sun> take_sun(EnvironmentMap& map) {
    const size_t peak = brightest_texel_above_horizon(map);
    const double brightest = luminance(map.texels[peak]), ring = ring_brightness(map, peak);
    if (!(brightest > kSunContrast * ring)) return std::nullopt;
    std::vector<size_t> spot;
    for (const double part : kPartsOfPeak) {
        spot = spot_above(map, peak, std::max(kOverRing * ring, part * brightest));
        if (!spot.empty()) break;
    }
    if (spot.empty()) return std::nullopt;
    const std::vector<size_t> rim = rim_of(map, spot);
    spot.insert(spot.end(), rim.begin(), rim.end());
    const std::vector<size_t> around = rim_of(map, spot);
    if (around.empty()) return std::nullopt;

    const std::vector<Share> shares = shares_of(map, spot, mean_of(map, around));
    const Sun sun = sun_of(map, shares);
    const double rest = luminance(map_energy(map)) - luminance(sun.irradiance);
    if (!(sun.direction[2] > 0) || luminance(sun.irradiance) < kSunShare * rest / 4) return std::nullopt;
    for (const Share& share : shares) {
        for (size_t c = 0; c < 3; ++c) map.texels[share.texel][c] -= share.excess[c];
    }
    return sun;
}

}  // namespace citystream::client
