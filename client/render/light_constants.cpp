#include "client/render/light_constants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace citystream::client {
namespace {

constexpr double kPi = std::numbers::pi;
/// Factors of the harmonics 1; y, z, x; xy, yz, (3zz - 1), zx, (xx - yy), and of a cosine lobe in bands 0, 1, 2
/// (client/light/spherical_harmonics.h).
constexpr double kBand0 = 0.28209479177387814, kBand1 = 0.4886025119029199, kBand2 = 1.0925484305920792;
constexpr double kLobe0 = kPi, kLobe1 = 2 * kPi / 3, kLobe2 = kPi / 4;
/// 1, x, y, z, xy, yz, zx, zz, xx - yy
using Terms = std::array<double, AMBIENT_TERMS>;

Terms terms_of(const std::array<LightSum, kHarmonics>& c, size_t channel) {
    const auto at = [&](size_t i) { return c[i][channel]; };
    const double level = kLobe2 * kBand2 * at(6) / (2 * std::numbers::sqrt3);
    return {kLobe0 * kBand0 * at(0) - level, kLobe1 * kBand1 * at(3), kLobe1 * kBand1 * at(1), kLobe1 * kBand1 * at(2),
            kLobe2 * kBand2 * at(4),         kLobe2 * kBand2 * at(5), kLobe2 * kBand2 * at(7), 3 * level,
            kLobe2 * kBand2 / 2 * at(8)};
}

bool is_light(double value) {
    return std::isfinite(value) && value >= 0;
}

Status check_sun(const Sun& sun) {
    double length = 0;
    for (const double x : sun.direction) length += x * x;
    if (!(std::abs(length - 1) < 1e-3)) return Error{"the sun's direction is no unit vector"};
    if (!std::ranges::all_of(sun.irradiance, is_light)) return Error{"the sun's light is negative or not finite"};
    if (!(sun.angular_radius > 0 && sun.angular_radius < kPi / 2)) return Error{"the sun's radius is out of range"};
    return Done{};
}

}  // namespace

Status check_light(const FrameLight& light) {
    const uint64_t texels = uint64_t{6} * light.texels_across * light.texels_across;
    if (light.sky.values.size() != texels) return Error{"a light's sky has not the texels that it says"};
    if (!std::ranges::all_of(light.sky.unit, is_light)) return Error{"a light's unit is negative or not finite"};
    const EnvironmentMap& map = light.background;
    if (map.width == 0 || map.height == 0 || map.texels.size() != uint64_t{map.width} * map.height)
        return Error{"a light's background has not the texels that it says"};
    for (const Rgb& texel : map.texels) {
        if (!std::ranges::all_of(texel, is_light)) return Error{"a light's background is negative or not finite"};
    }
    for (const LightSum& sum : light.ambient.coefficients) {
        if (!std::ranges::all_of(sum, [](double x) { return std::isfinite(x); }))
            return Error{"a light's harmonics are not finite"};
    }
    return check_sun_and_exposure(light);
}

Status check_sun_and_exposure(const FrameLight& light) {
    if (!is_light(light.exposure)) return Error{"a light's exposure is negative or not finite"};
    return light.sun ? check_sun(*light.sun) : Status(Done{});
}

bool lights_surfaces(const Sun& sun) {
    return sun.direction[2] > 0 && luminance(sun.irradiance) > 0;
}

LightConstants light_constants(const FrameLight& light, const std::array<float, 3>& irradiance_unit, float map_scale) {
    const double exposure = light.exposure, white = exposure / kPi;
    LightConstants constants{};
    for (size_t channel = 0; channel < 3; ++channel) {
        const Terms terms = terms_of(light.ambient.coefficients, channel);
        for (size_t i = 0; i < terms.size(); ++i)
            constants.ambient[3 * i + channel] = static_cast<float>(white * terms[i]);
        constants.sky[channel] = static_cast<float>(white * static_cast<double>(irradiance_unit[channel]));
    }
    constants.map_width = light.background.width;
    constants.map_height = light.background.height;
    constants.map_scale = static_cast<float>(exposure * map_scale);
    if (!light.sun) return constants;
    const bool lit = lights_surfaces(*light.sun);
    const double radius = light.sun->angular_radius, solid_angle = 2 * kPi * (1 - std::cos(radius));
    for (size_t i = 0; i < 3; ++i) {
        constants.sun[i] = lit ? static_cast<float>(white * light.sun->irradiance[i]) : 0.0F;
        constants.to_sun[i] = static_cast<float>(light.sun->direction[i]);
        constants.disc[i] = static_cast<float>(exposure * light.sun->irradiance[i] / solid_angle);
    }
    constants.disc_radius = static_cast<float>(2 * std::sin(radius / 2));
    return constants;
}

std::array<double, 3> open_sky_light(const LightConstants& constants, const std::array<double, 3>& n) {
    const Terms basis = {
        1, n[0], n[1], n[2], n[0] * n[1], n[1] * n[2], n[2] * n[0], n[2] * n[2], n[0] * n[0] - n[1] * n[1]};
    std::array<double, 3> sum{};
    for (size_t i = 0; i < basis.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) sum[c] += constants.ambient[3 * i + c] * basis[i];
    }
    return {std::max(sum[0], 0.0), std::max(sum[1], 0.0), std::max(sum[2], 0.0)};
}

}  // namespace citystream::client
