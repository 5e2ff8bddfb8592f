// The light that a tile's transfer takes (codec/radiance/source_directions.h), from an environment map.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/light/environment_map.h"

namespace citystream::client {

/// Columns of a map to a source texel's side that are enough: 5 lie in a texel in the middle of a face.
inline constexpr uint32_t kMapColumns = 16;

/// Resamples maps of one size to 6 x n x n source texels, turned by any yaw: a light that turns, or many tiles with
/// yaws of their own. What each lookup finds where is remembered (12 bytes a lookup; with kMapColumns * n columns 121
/// of them a texel). Const calls may come from several threads.
class SourceSampler {
  public:
    SourceSampler(uint32_t map_width, uint32_t map_height, uint32_t texels_across);

    /// Mean radiance of each source texel under the map turned by `yaw`. The energy is the map's within 1e-4; a uniform
    /// map gives a uniform source. For light with the solid angles in it: codec::radiance::weighted_light of the
    /// result.
    std::vector<Rgb> radiance(const EnvironmentMap& map, double yaw = 0) const;

  private:
    struct Lookup {
        uint32_t row_begin;  ///< index of its row's first texel
        float column;        ///< without a yaw
        float weight;        ///< those of a source texel add up to 1
    };

    uint32_t map_width_, map_height_, texels_across_;
    uint32_t lookups_in_texel_ = 0;
    std::vector<Lookup> lookups_;
};

/// The same for one map and yaw. The map is reduced to kMapColumns * n columns first.
std::vector<Rgb> source_radiance(const EnvironmentMap& map, uint32_t texels_across, double yaw = 0);

/// Sum of radiance times solid angle. radiance.size() == codec::radiance::texel_count(texels_across).
LightSum source_energy(std::span<const Rgb> radiance, uint32_t texels_across);

}  // namespace citystream::client
