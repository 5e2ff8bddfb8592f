// Where the sun stands.
#pragma once

#include "client/light/environment_map.h"

namespace citystream::client {

/// Radians, positive in the northern summer, on a day of the year (1 = 1 January; parts of days count on). Within
/// 0.0006 of the truth: J. W. Spencer, Fourier series representation of the position of the sun, Search 2(5), 1971.
double sun_declination(double day_of_year);

/// Unit vector towards the sun (x east, y north, z up), below the horizon at night. `solar_hour` is true solar time:
/// the sun is in the meridian at 12; hours below 0 and above 24 are those of the days before and after. Refraction is
/// left out. From the declination d and the hour angle w: sin(height) = sin(lat) sin(d) + cos(lat) cos(d) cos(w) (M.
/// Iqbal, An Introduction to Solar Radiation, 1983, equation 1.5.3).
Direction sun_direction(double latitude_degrees, double day_of_year, double solar_hour);

}  // namespace citystream::client
