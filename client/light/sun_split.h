// Takes the sun out of an environment map.
//
// A sun is the brightest compact spot of a map: its brightest texel is kContrast times as bright as half of the sky 5
// to 15 degrees around it; the texels connected to it that are above a part of its brightness stay within 5 degrees;
// and the spot lights a surface that faces it at least kShare as much as a sky of the rest's mean radiance would. A
// lamp that is all this is a sun, too; of several, only the brightest texel's is looked at. It stands above the
// horizon: light from below reaches nothing of a city, so that a sun's mirror image in water stays in the map.
#pragma once

#include <optional>

#include "client/light/sun.h"

namespace citystream::client {

inline constexpr double kSunContrast = 32;
inline constexpr double kSunShare = 0.02;

/// Finds the sun, removes it from the map and returns it; none: the map stays as it is. The spot and one texel around
/// it are cut down to the mean of the sky next to them, channel by channel; what was cut off is the sun's irradiance,
/// its centre of light the sun's direction, and its spread (that of a disc) its angular radius, which is never below
/// the real sun's. The energy of the map before is that of the map after plus the irradiance. O(texels).
std::optional<Sun> take_sun(EnvironmentMap& map);

}  // namespace citystream::client
