#include "client/light/sky_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace citystream::client {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegrees = 180 / kPi;
constexpr double kLeastCosine = 0.01;            // of directions at the horizon, where the model has a pole
constexpr double kCivilDusk = -6, kNight = -18;  // degrees
constexpr double kLeastSkyShare = 0.1;           // of the illuminance

/// Illuminance outside of the atmosphere (S. Darula, R. Kittler, C. A. Gueymard, Reference luminous solar constant and
/// solar luminance for illuminance calculations, Solar Energy 79, 2005), klx, in the colour of a black body of 5777 K.
constexpr double kSolarIlluminance = 133.334;
constexpr LightSum kSolarColour = {1.1126, 0.9754, 0.9123};
constexpr std::array<double, 3> kMicrometres = {0.611, 0.549, 0.464};
constexpr std::array<double, 3> kOzonePerCentimetre = {0.120, 0.085, 0.007};
constexpr double kOzone = 0.35;  // centimetres

/// Janiczek and DeYoung: log10 of lux is a polynomial of height / 90 degrees in each range.
struct IlluminanceRange {
    double least_height;
    std::array<double, 4> polynomial;
};
constexpr std::array<IlluminanceRange, 6> kIlluminance = {{{20, {3.74, 3.97, -4.07, 1.47}},
                                                           {5, {3.05, 13.28, -45.98, 64.33}},
                                                           {-0.8, {2.88, 22.26, -207.64, 1034.30}},
                                                           {-5, {2.88, 21.81, -258.11, -858.36}},
                                                           {-12, {2.70, 12.17, -431.69, -1899.83}},
                                                           {kNight, {13.84, 262.72, 1447.42, 2797.93}}}};

double height_of(const Direction& direction) {
    return std::atan2(direction[2], std::hypot(direction[0], direction[1])) * kDegrees;
}

/// Appendix A.2: value = first * turbidity + second for A..E of Y, x and y.
constexpr std::array<std::array<std::array<double, 2>, 5>, 3> kPerez = {{
    {{{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}}},
    {{{-0.0193, -0.2592}, {-0.0665, 0.0008}, {-0.0004, 0.2125}, {-0.0641, -0.8989}, {-0.0033, 0.0452}}},
    {{{-0.0167, -0.2608}, {-0.0950, 0.0092}, {-0.0079, 0.2102}, {-0.0441, -1.6537}, {-0.0109, 0.0529}}},
}};

/// Appendix A.2: zenith chromaticity = (T^2, T, 1) M (theta^3, theta^2, theta, 1).
using ZenithMatrix = std::array<std::array<double, 4>, 3>;
constexpr ZenithMatrix kZenithX = {
    {{0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}}};
constexpr ZenithMatrix kZenithY = {
    {{0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}}};

double zenith_chromaticity(const ZenithMatrix& m, double turbidity, double theta) {
    const auto row = [&](size_t i) { return ((m[i][0] * theta + m[i][1]) * theta + m[i][2]) * theta + m[i][3]; };
    return (row(0) * turbidity + row(1)) * turbidity + row(2);
}

double zenith_luminance(double turbidity, double theta) {
    const double chi = (4.0 / 9 - turbidity / 120) * (kPi - 2 * theta);
    return (4.0453 * turbidity - 4.9710) * std::tan(chi) - 0.2155 * turbidity + 2.4192;
}

/// Linear Rec. 709 of a luminance and chromaticity; what is outside of its gamut is cut off, the luminance kept.
LightSum colour_of(double luminance_wanted, double x, double y) {
    const double big_x = x / y, big_z = (1 - x - y) / y;
    LightSum colour = {3.2406 * big_x - 1.5372 - 0.4986 * big_z, -0.9689 * big_x + 1.8758 + 0.0415 * big_z,
                       0.0557 * big_x - 0.2040 + 1.0570 * big_z};
    for (double& channel : colour) channel = std::max(channel, 0.0);
    const double scale = luminance_wanted / luminance(colour);
    for (double& channel : colour) channel *= scale;
    return colour;
}

/// 1 at the end of the civil dusk, 0 at night, smooth in between.
double dusk_share(double height) {
    const double s = std::clamp((height - kNight) / (kCivilDusk - kNight), 0.0, 1.0);
    return s * s * (3 - 2 * s);
}

}  // namespace

double clear_illuminance(double sun_height_degrees) {
    const double height = std::clamp(sun_height_degrees, kNight, 90.0);
    const auto range = std::find_if(kIlluminance.begin(), kIlluminance.end() - 1,
                                    [height](const IlluminanceRange& r) { return height >= r.least_height; });
    const double x = height / 90;
    const auto& p = range->polynomial;
    return std::pow(10, ((p[3] * x + p[2]) * x + p[1]) * x + p[0]) / 1000;
}

double air_mass(double sun_height_degrees) {
    const double height = std::clamp(sun_height_degrees, 0.0, 90.0);
    return 1 / (std::sin(height / kDegrees) + 0.50572 * std::pow(height + 6.07995, -1.6364));
}

double ClearSky::Perez::at(double cos_theta, double gamma) const {
    const auto& [a, b, c, d, e] = coefficients;
    const double cos_gamma = std::cos(gamma);
    return (1 + a * std::exp(b / cos_theta)) * (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
}

double ClearSky::Perez::relative_to_zenith(double sun_theta) const {
    return zenith / at(1, sun_theta);
}

ClearSky::ClearSky(const Direction& to_sun, double turbidity)
    : to_sun_(to_sun), shape_sun_(to_sun), turbidity_(std::clamp(turbidity, 2.0, 10.0)) {
    const double height = height_of(to_sun);
    if (shape_sun_[2] < 0) {
        const double level = std::hypot(to_sun[0], to_sun[1]);
        shape_sun_ = level > 0 ? Direction{to_sun[0] / level, to_sun[1] / level, 0} : Direction{0, 1, 0};
    }
    const double theta = std::acos(std::clamp(shape_sun_[2], 0.0, 1.0));
    const std::array<double, 3> zenith = {zenith_luminance(turbidity_, theta),
                                          zenith_chromaticity(kZenithX, turbidity_, theta),
                                          zenith_chromaticity(kZenithY, turbidity_, theta)};
    for (size_t i = 0; i < 3; ++i) {
        for (size_t k = 0; k < 5; ++k) perez_[i].coefficients[k] = kPerez[i][k][0] * turbidity_ + kPerez[i][k][1];
        perez_[i].zenith = zenith[i];
        perez_[i].zenith = perez_[i].relative_to_zenith(theta);
    }
    const double all = clear_illuminance(height);
    const double wanted = std::max(all - luminance(sun_irradiance()) * shape_sun_[2], kLeastSkyShare * all);
    const double share = dusk_share(height);
    scale_ = share > 0 ? share * wanted / shape_illuminance() : 0;
    even_ = (1 - share) * wanted / kPi;
}

LightSum ClearSky::shape(const Direction& from) const {
    const double cos_theta = std::max(from[2], kLeastCosine), gamma = angle_between(from, shape_sun_);
    std::array<double, 3> value{};
    for (size_t i = 0; i < 3; ++i) value[i] = perez_[i].zenith * perez_[i].at(cos_theta, gamma);
    return colour_of(std::max(value[0], 0.0), value[1], value[2]);
}

double ClearSky::shape_illuminance() const {
    constexpr uint32_t kWidth = 64, kHeight = kWidth / 2;
    double sum = 0;
    for (uint32_t row = 0; row < kHeight / 2; ++row) {
        for (uint32_t column = 0; column < kWidth; ++column) {
            const Direction from = map_direction(kWidth, kHeight, column + 0.5, row + 0.5);
            sum += map_solid_angle(kWidth, kHeight, row) * from[2] * luminance(shape(from));
        }
    }
    return sum;
}

LightSum ClearSky::radiance(const Direction& from) const {
    if (from[2] < 0) return {};
    LightSum light{};
    if (scale_ > 0) light = shape(from);
    for (double& channel : light) channel = channel * scale_ + even_;
    return light;
}

LightSum ClearSky::sun_irradiance() const {
    const double height = height_of(to_sun_);
    const double above = std::clamp(0.5 + height / (2 * kSunRadius * kDegrees), 0.0, 1.0);
    const double mass = air_mass(height), aerosol = 0.04608 * turbidity_ - 0.04586;
    LightSum light{};
    for (size_t c = 0; c < 3; ++c) {
        const double depth = 0.008735 * std::pow(kMicrometres[c], -4.08) + aerosol * std::pow(kMicrometres[c], -1.3) +
                             kOzonePerCentimetre[c] * kOzone;
        light[c] = above * kSolarIlluminance * kSolarColour[c] * std::exp(-depth * mass);
    }
    return light;
}

std::optional<Sun> ClearSky::sun() const {
    Sun sun;
    sun.direction = to_sun_;
    sun.irradiance = sun_irradiance();
    if (!(luminance(sun.irradiance) > 0)) return std::nullopt;
    return sun;
}

EnvironmentMap sky_map(const ClearSky& sky, uint32_t width) {
    EnvironmentMap map;
    map.width = std::max(width, 2U);
    map.height = map.width / 2;
    map.texels.reserve(size_t{map.width} * map.height);
    for (uint32_t row = 0; row < map.height; ++row) {
        for (uint32_t column = 0; column < map.width; ++column) {
            const LightSum light = sky.radiance(map_direction(map.width, map.height, column + 0.5, row + 0.5));
            map.texels.push_back(
                {static_cast<float>(light[0]), static_cast<float>(light[1]), static_cast<float>(light[2])});
        }
    }
    return map;
}

}  // namespace citystream::client
