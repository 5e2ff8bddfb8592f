// Light by direction in the first 9 or 25 spherical harmonics: what ambient light looks like without any shadows, the
// fall-back and the baseline of the radiance layer.
//
// Real orthonormal harmonics, number l (l + 1) + m of band l and order m: K P_l^|m|(z) times sqrt(2) cos(m a) for m > 0
// and sqrt(2) sin(|m| a) for m < 0, where a is the angle from x (east) towards y (north), P without the Condon-Shortley
// sign. Irradiance by Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment Maps, 2001: band
// l is multiplied by A = pi, 2 pi / 3, pi / 4, 0, -pi / 24 (equations 8 and 9).
#pragma once

#include <array>
#include <cstdint>

#include "client/light/environment_map.h"

namespace citystream::client {

inline constexpr uint32_t kMostBands = 5;
inline constexpr uint32_t kHarmonics = kMostBands * kMostBands;

/// All 25 at a unit vector.
std::array<double, kHarmonics> harmonics_at(const Direction& direction);

struct HarmonicLight {
    std::array<LightSum, kHarmonics> coefficients{};

    /// Of the first bands (3: SH-9, 5: SH-25). May be negative where light is sharp.
    LightSum radiance(const Direction& from, uint32_t bands) const;
    /// On a surface with this unit normal and nothing in its way.
    LightSum irradiance(const Direction& normal, uint32_t bands) const;
    /// Turned clockwise seen from above, as a map by its yaw.
    HarmonicLight turned(double yaw) const;
};

/// Integral of the map's radiance times each harmonic. O(25 texels).
HarmonicLight harmonic_light(const EnvironmentMap& map);
/// Adds a sun's light, as far as 25 harmonics hold it.
void add_parallel_light(HarmonicLight& light, const Direction& direction, const LightSum& irradiance);

}  // namespace citystream::client
