#include "client/light/environment_light.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "client/light/environment_file.h"
#include "client/light/sky_model.h"
#include "client/light/sphere_resampling.h"
#include "client/light/sun_position.h"
#include "client/light/sun_split.h"

namespace citystream::client {
namespace {

/// The analytic sky is smooth: this is enough where no picture fades into it.
constexpr uint32_t kSkyWidth = 256;

/// A map in another size, smooth, with the energy it has.
EnvironmentMap enlarged(const EnvironmentMap& map, uint32_t width, uint32_t height) {
    if (map.width == width && map.height == height) return map;
    EnvironmentMap result{width, height, {}};
    result.texels.reserve(size_t{width} * height);
    for (uint32_t row = 0; row < height; ++row) {
        for (uint32_t column = 0; column < width; ++column)
            result.texels.push_back(map.radiance(map_direction(width, height, column + 0.5, row + 0.5)));
    }
    const LightSum wanted = map_energy(map), got = map_energy(result);
    for (Rgb& texel : result.texels) {
        for (size_t c = 0; c < 3; ++c) texel[c] *= got[c] > 0 ? static_cast<float>(wanted[c] / got[c]) : 1.0F;
    }
    return result;
}

/// Puts parallel light into the texel that it comes from.
void add_sun(EnvironmentMap& map, const Sun& sun, double weight) {
    const LatLongGrid grid{map.width, map.height};
    const size_t texel = grid.texel_at(sun.direction);
    const double solid_angle = grid.solid_angle(texel);
    for (size_t c = 0; c < 3; ++c) map.texels[texel][c] += static_cast<float>(weight * sun.irradiance[c] / solid_angle);
}

bool is_black_below_horizon(const EnvironmentMap& map) {
    return std::all_of(map.texels.begin() + static_cast<ptrdiff_t>(texels_above_horizon(map)), map.texels.end(),
                       [](const Rgb& texel) { return texel == Rgb{}; });
}

double brightness(const std::optional<Sun>& sun) {
    return sun ? luminance(sun->irradiance) : 0;
}

}  // namespace

Result<EnvironmentLight> EnvironmentLight::load(EnvironmentPath path, const LightSettings& settings) {
    EnvironmentLight light(std::move(path), settings);
    for (const std::string& name : light.path_.environments) {
        Environment& environment = light.environments_.emplace_back();
        environment.analytic = name == kAnalyticSky;
        if (environment.analytic) continue;
        Result<EnvironmentFile> file = read_environment(name);
        if (!file) return file.error();
        if (file->defects.all() > 0) light.warnings_.push_back(name + ": " + file->defects.text());
        if (settings.take_suns) environment.sun = take_sun(file->map);
        environment.plain = is_black_below_horizon(file->map);
        environment.map = reduced(file->map, settings.map_width);
    }
    return light;
}

EnvironmentLight::Environment EnvironmentLight::seen(const EnvironmentPath::Part& part, uint32_t sky_width) const {
    const Environment& environment = environments_[part.environment];
    if (!environment.analytic) return environment;
    const ClearSky sky(sun_direction(settings_.latitude_degrees, settings_.day_of_year, part.hour),
                       settings_.turbidity);
    Environment result{true, sky_map(sky, sky_width), sky.sun(), true};
    if (!settings_.take_suns && result.sun) {
        add_sun(result.map, *result.sun, 1);
        result.sun.reset();
    }
    return result;
}

LightMoment EnvironmentLight::faded(const EnvironmentPath::Moment& moment) const {
    const auto width_of = [&](size_t i) { return environments_[moment.parts[i].environment].map.width; };
    const uint32_t width = std::max({width_of(0), width_of(1), std::min(kSkyWidth, settings_.map_width)});
    std::array<Environment, 2> parts = {seen(moment.parts[0], width), seen(moment.parts[1], width)};
    const uint32_t height = std::max(parts[0].map.height, parts[1].map.height);
    std::array<EnvironmentMap, 2> maps;
    for (size_t i = 0; i < 2; ++i) {
        maps[i] = enlarged(parts[i].map, width, height);
        for (Rgb& texel : maps[i].texels) {
            for (float& v : texel) v *= static_cast<float>(moment.parts[i].weight);
        }
        if (!parts[i].sun) continue;
        for (double& v : parts[i].sun->irradiance) v *= moment.parts[i].weight;
    }
    const size_t main = brightness(parts[1].sun) > brightness(parts[0].sun) ? 1 : 0;
    LightMoment result{std::move(maps[0]), 0, parts[main].sun};
    for (size_t i = 0; i < 2; ++i) result.plain += parts[i].plain ? moment.parts[i].weight : 0;
    for (size_t i = 0; i < result.map.texels.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) result.map.texels[i][c] += maps[1].texels[i][c];
    }
    if (parts[1 - main].sun) add_sun(result.map, *parts[1 - main].sun, 1);
    return result;
}

LightMoment EnvironmentLight::at(double time_s) const {
    const EnvironmentPath::Moment moment = path_.at(time_s);
    LightMoment result;
    if (moment.parts[1].weight > 0) {
        result = faded(moment);
    } else {
        Environment alone = seen(moment.parts[0], std::min(kSkyWidth, settings_.map_width));
        result.map = std::move(alone.map);
        result.sun = alone.sun;
        result.plain = alone.plain ? 1 : 0;
    }
    result.yaw = moment.rotation_degrees * std::numbers::pi / 180;
    if (result.sun) result.sun->direction = turned_clockwise(result.sun->direction, result.yaw);
    return result;
}

}  // namespace citystream::client
