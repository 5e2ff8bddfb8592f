#include "client/light/frame_light_maker.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace citystream::client {
namespace {

/// More than 25 harmonics can tell from a finer map.
constexpr uint32_t kHarmonicColumns = 256;

/// Of a texel's side, to average its cosine.
constexpr uint32_t kPartsAcross = 4;

/// 0 to a full turn, without it.
double within_a_turn(double yaw) {
    const double turns = yaw / (2 * std::numbers::pi);
    return 2 * std::numbers::pi * (turns - std::floor(turns));
}

bool same_map(const EnvironmentMap& a, const EnvironmentMap& b) {
    return a.width == b.width && a.height == b.height && a.texels == b.texels;
}

bool same_sun(const std::optional<Sun>& a, const std::optional<Sun>& b) {
    if (!a || !b) return !a && !b;
    return a->direction == b->direction && a->irradiance == b->irradiance;
}

}  // namespace

double automatic_exposure(double irradiance) {
    const double light = std::isfinite(irradiance) ? std::max(irradiance, kLeastIrradiance) : kLeastIrradiance;
    return std::numbers::pi / light * std::pow(std::min(1.0, light / kFullAdaptation), kLoss);
}

LightSum level_irradiance(std::span<const Rgb> radiance, uint32_t texels_across) {
    const uint32_t fine = kPartsAcross * texels_across;
    LightSum sum{};
    for (uint32_t cell = 0; cell < codec::radiance::cube_cells(fine); ++cell) {
        const codec::radiance::GridDirection d = codec::radiance::cell_direction(fine, cell);
        if (d[2] <= 0) continue;
        const double length = std::hypot(double(d[0]), double(d[1]), double(d[2]));
        const double weight = d[2] / length * codec::radiance::cell_solid_angle(fine, cell);
        const uint32_t column = cell % fine / kPartsAcross, row = cell / fine / kPartsAcross;
        for (size_t c = 0; c < 3; ++c) sum[c] += weight * radiance[row * texels_across + column][c];
    }
    return sum;
}

EnvironmentMap turned_map(const EnvironmentMap& map, double yaw) {
    const double columns = within_a_turn(yaw) / (2 * std::numbers::pi) * map.width;
    const auto whole = static_cast<uint32_t>(columns);
    const auto part = static_cast<float>(columns - whole);
    EnvironmentMap turned{map.width, map.height, std::vector<Rgb>(map.texels.size())};
    for (uint32_t row = 0; row < map.height; ++row) {
        const size_t begin = size_t{row} * map.width;
        for (uint32_t column = 0; column < map.width; ++column) {
            // What stood at `from` stands here, and what stood to the left of it comes in.
            const uint32_t from = (column + 2 * map.width - whole % map.width) % map.width;
            const Rgb& here = map.texels[begin + from];
            const Rgb& left = map.texels[begin + (from + map.width - 1) % map.width];
            for (size_t c = 0; c < 3; ++c)
                turned.texels[begin + column][c] = part > 0 ? here[c] + part * (left[c] - here[c]) : here[c];
        }
    }
    return turned;
}

void FrameLightMaker::set_map(EnvironmentMap map) {
    if (!sampler_ || map.width != map_.width || map.height != map_.height) {
        const EnvironmentMap smaller = reduced(map, kMapColumns * texels_across_);
        sampler_.emplace(smaller.width, smaller.height, texels_across_);
    }
    map_ = std::move(map);
    reduced_ = reduced(map_, kMapColumns * texels_across_);
    harmonics_ = harmonic_light(reduced(reduced_, kHarmonicColumns));
}

/// Of the map as it is turned.
void FrameLightMaker::set_sky() {
    const std::vector<Rgb> radiance = sampler_->radiance(reduced_, yaw_);
    level_irradiance_ = level_irradiance(radiance, texels_across_);
    light_.sky = codec::radiance::whole_light(codec::radiance::weighted_light(radiance, texels_across_));
    light_.texels_across = texels_across_;
    light_.ambient = harmonics_.turned(yaw_);
    light_.background = turned_map(map_, yaw_);
    if (plain_ > 0) add_plain();
    ++light_.number;
}

void FrameLightMaker::add_plain() {
    Rgb plain{};
    const LightSum light = level_light();
    for (size_t c = 0; c < 3; ++c) plain[c] = static_cast<float>(plain_ * kPlainAlbedo / std::numbers::pi * light[c]);
    EnvironmentMap& map = light_.background;
    for (Rgb& texel : std::span(map.texels).subspan(texels_above_horizon(map))) {
        for (size_t c = 0; c < 3; ++c) texel[c] += plain[c];
    }
}

/// On a level surface, of sky and sun.
LightSum FrameLightMaker::level_light() const {
    LightSum level = level_irradiance_;
    if (light_.sun) {
        for (size_t c = 0; c < 3; ++c) level[c] += light_.sun->irradiance[c] * std::max(0.0, light_.sun->direction[2]);
    }
    return level;
}

float FrameLightMaker::exposure() const {
    if (exposure_stops_) return static_cast<float>(std::exp2(*exposure_stops_));
    return static_cast<float>(automatic_exposure(luminance(level_light())));
}

const FrameLight& FrameLightMaker::light(LightMoment moment) {
    const double yaw = within_a_turn(moment.yaw);
    const bool same = light_.number > 0 && same_map(moment.map, map_);
    if (!same) set_map(std::move(moment.map));
    const bool other_plain = moment.plain != plain_ || (plain_ > 0 && !same_sun(light_.sun, moment.sun));
    plain_ = moment.plain;
    light_.sun = moment.sun;
    if (!same || yaw != yaw_ || other_plain) {
        yaw_ = yaw;
        set_sky();
    }
    light_.exposure = exposure();
    return light_;
}

}  // namespace citystream::client
