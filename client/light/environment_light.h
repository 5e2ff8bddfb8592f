// The light along a flight: environments loaded once, their suns taken out, and at each moment one map, its turn and at
// most one sun.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/light/environment_map.h"
#include "client/light/environment_path.h"
#include "client/light/sun.h"
#include "codec/result.h"

namespace citystream::client {

struct LightSettings {
    double latitude_degrees = 48;  ///< these three are of the analytic sky
    double day_of_year = 172;      ///< 21 June
    double turbidity = 3;          ///< 2..10
    bool take_suns = true;         ///< else suns stay in the maps
    uint32_t map_width = 1024;     ///< greatest width of the maps that are kept, at least 2
};

struct LightMoment {
    EnvironmentMap map;      ///< without the sun
    double yaw = 0;          ///< of the map
    std::optional<Sun> sun;  ///< as it stands in the world, turned with the map
    /// 0..1: how much of what is seen are environments that are black below the horizon, as the analytic sky is; there
    /// a plain is shown (frame_light_maker.h).
    double plain = 0;
};

/// Takes 12 bytes a texel of each environment: 6 MB at the default width. Const calls may come from several threads.
class EnvironmentLight {
  public:
    /// Reads all environments of a path. Error: the first that cannot be read.
    static Result<EnvironmentLight> load(EnvironmentPath path, const LightSettings& settings);

    /// One line a file of which texels had to be mended.
    const std::vector<std::string>& warnings() const { return warnings_; }

    /// Between different environments both maps fade, in the size of the larger; of two suns the one that gives more
    /// light at the moment is the sun, the light of the other goes into the map where it stands. No light is lost.
    LightMoment at(double time_s) const;

  private:
    struct Environment {
        bool analytic = false;
        EnvironmentMap map;
        std::optional<Sun> sun;
        bool plain = false;  ///< nothing is seen below the horizon
    };

    EnvironmentLight(EnvironmentPath path, const LightSettings& settings)
        : path_(std::move(path)), settings_(settings) {}
    Environment seen(const EnvironmentPath::Part& part, uint32_t sky_width) const;
    LightMoment faded(const EnvironmentPath::Moment& moment) const;

    EnvironmentPath path_;
    LightSettings settings_;
    std::vector<Environment> environments_;
    std::vector<std::string> warnings_;
};

}  // namespace citystream::client
