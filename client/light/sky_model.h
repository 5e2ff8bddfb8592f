// An analytic clear sky by day, dusk and night, for when there is no picture of one.
//
// How bright: P. M. Janiczek and J. A. DeYoung, Computer Programs for Sun and Moon Illuminance, US Naval Observatory
// circular 171, 1987, give the illuminance of level ground under a clear sky for every height of the sun, also below
// the horizon. The sky has of it what the sun leaves, and a tenth at least. How it is spread: A. J. Preetham, P.
// Shirley, B. Smits, A Practical Analytic Model for Daylight, SIGGRAPH 1999: relative luminance and chromaticity of
// every direction from the sun's height and the turbidity (appendix A.2), made linear Rec. 709. Its own luminance is
// not taken: with a low sun it is too high. With the sun below the horizon it is the shape of sunset, which becomes
// even between the end of the civil dusk (sun 6 degrees down) and night (18 degrees): from there on an even, moonless
// sky that stays as it is. Sun: what the air leaves of the light outside of it (appendix A.1: Rayleigh, aerosol by
// Angstrom, ozone) at the dominant wavelengths of the three primaries, 611, 549 and 464 nm; air mass by F. Kasten and
// A. T. Young, Revised optical air mass tables and approximation formula, Applied Optics 28(22), 1989.
//
// Units: radiance in kcd/m^2, irradiance in klx, as luminance() of linear Rec. 709.
#pragma once

#include <array>
#include <optional>

#include "client/light/sun.h"

namespace citystream::client {

/// Horizontal illuminance in klx under a clear sky, sun included, without moon; of the sun's height in degrees above
/// the horizon. Constant below -18.
double clear_illuminance(double sun_height_degrees);

/// Relative length of the light's way through the air; of the sun's height in degrees, at least 0. 1 in the zenith.
double air_mass(double sun_height_degrees);

class ClearSky {
  public:
    /// `to_sun`: unit vector, also from below the horizon. `turbidity`: 2 (very clear) to 10 (haze); taken as the
    /// nearer of the two outside.
    ClearSky(const Direction& to_sun, double turbidity);

    /// From a unit vector, without the sun's disc; 0 from below the horizon. Never negative.
    LightSum radiance(const Direction& from) const;
    /// None once its disc is below the horizon; the part of it that is above counts.
    std::optional<Sun> sun() const;

  private:
    /// Perez' five coefficients A..E and the value in the zenith.
    struct Perez {
        std::array<double, 5> coefficients;
        double zenith;
        double at(double cos_theta, double gamma) const;
        double relative_to_zenith(double sun_theta) const;
    };

    LightSum shape(const Direction& from) const;
    double shape_illuminance() const;

    LightSum sun_irradiance() const;

    Direction to_sun_, shape_sun_;  ///< the second is not below the horizon
    double turbidity_;
    std::array<Perez, 3> perez_{};  ///< Y, x, y
    double scale_ = 1;              ///< of the shape
    double even_ = 0;               ///< luminance of the even sky beside it
};

/// The sky without its sun as a map of `width` x `width` / 2 texels, radiance at their centres.
EnvironmentMap sky_map(const ClearSky& sky, uint32_t width);

}  // namespace citystream::client
