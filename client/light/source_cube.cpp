#include "client/light/source_cube.h"

#include <cassert>

#include "client/light/sphere_resampling.h"

namespace citystream::client {

SourceSampler::SourceSampler(uint32_t map_width, uint32_t map_height, uint32_t texels_across)
    : map_width_(map_width), map_height_(map_height), texels_across_(texels_across) {
    const LatLongGrid map{map_width, map_height};
    const CubeGrid cube{texels_across};
    std::vector<double> weights(cube.texels());
    resampling::visit_lookups(map, cube, [&](size_t texel, double weight, const Direction& direction) {
        const auto [column, row] = map.place_of(direction);
        const uint32_t whole_row = std::min(static_cast<uint32_t>(row), map_height - 1);
        lookups_.push_back({whole_row * map_width, static_cast<float>(column), static_cast<float>(weight)});
        weights[texel] += weight;
    });
    lookups_in_texel_ = static_cast<uint32_t>(lookups_.size() / weights.size());
    auto lookup = lookups_.begin();
    for (const double weight : weights) {
        for (uint32_t i = 0; i < lookups_in_texel_; ++i, ++lookup)
            lookup->weight = static_cast<float>(lookup->weight / weight);
    }
}

std::vector<Rgb> SourceSampler::radiance(const EnvironmentMap& map, double yaw) const {
    assert(map.width == map_width_ && map.height == map_height_);
    const LatLongGrid from{map_width_, map_height_, yaw};
    const CubeGrid to{texels_across_};
    const double turns = yaw / (2 * std::numbers::pi);
    const auto width = static_cast<float>(map_width_), shift = static_cast<float>((turns - std::floor(turns)) * width);
    return resample_sphere(from, map.texels, to, [&](std::span<const Rgb> smooth) {
        std::vector<LightSum> means(to.texels());
        for (size_t i = 0; i < means.size(); ++i) {
            Rgb sum{};
            for (const Lookup& lookup : std::span(lookups_).subspan(i * lookups_in_texel_, lookups_in_texel_)) {
                const float column = lookup.column - shift + (lookup.column < shift ? width : 0.0F);
                const Rgb& value = smooth[lookup.row_begin + std::min(static_cast<uint32_t>(column), map_width_ - 1)];
                for (size_t c = 0; c < 3; ++c) sum[c] += lookup.weight * value[c];
            }
            for (size_t c = 0; c < 3; ++c) means[i][c] = sum[c];
        }
        return means;
    });
}

std::vector<Rgb> source_radiance(const EnvironmentMap& map, uint32_t texels_across, double yaw) {
    const EnvironmentMap less = reduced(map, kMapColumns * texels_across);
    return SourceSampler(less.width, less.height, texels_across).radiance(less, yaw);
}

LightSum source_energy(std::span<const Rgb> radiance, uint32_t texels_across) {
    const CubeGrid cube{texels_across};
    assert(radiance.size() == cube.texels());
    return cube.energy(radiance);
}

}  // namespace citystream::client
