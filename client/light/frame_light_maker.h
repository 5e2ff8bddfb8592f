// From the light of a moment to what the renderer takes (client/render/frame_light.h).
//
// Automatic exposure: what an eye that has got used to the light makes of level ground. E is the luminance of the light
// on a level surface, sky and sun. From kFullAdaptation on, exposure is pi / E: white diffuse ground gives 1, that of
// albedo 0.5 gives 0.5. Below, adaptation is not whole: exposure is that times (E / kFullAdaptation)^kLoss, so that
// dusk and night get darker, but slowly (E = 1e-6, a moonless night, lands at an eighth of day). Below kLeastIrradiance
// it stays what it is there, so that no light at all is black. In the analytic sky's klx kFullAdaptation is a dark
// overcast day; maps have units of their own, most of them of an order of 1 by day.
//
// Below the horizon of environments that show nothing there the picture behind the city shows a plain of even albedo
// kPlainAlbedo in the same light (LightMoment::plain of it). It lights nothing.
#pragma once

#include <cstdint>
#include <optional>

#include "client/light/environment_light.h"
#include "client/light/source_cube.h"
#include "client/render/frame_light.h"

namespace citystream::client {

inline constexpr double kPlainAlbedo = 0.2;
inline constexpr double kFullAdaptation = 1, kLoss = 0.15, kLeastIrradiance = 1e-7;

/// `irradiance`: luminance on a level surface, any value. Finite and above 0.
double automatic_exposure(double irradiance);

/// Of the sky on a level surface with nothing around it. radiance.size() == codec::radiance::texel_count(n).
LightSum level_irradiance(std::span<const Rgb> radiance, uint32_t texels_across);

/// What is seen of a map turned by `yaw`, as a map that is not turned: columns move, those between two are their
/// mixture. The energy stays.
EnvironmentMap turned_map(const EnvironmentMap& map, double yaw);

/// One thread at a time. What has not changed since the moment before is not made again: a sky that stays costs a
/// comparison, one that turns neither its harmonics nor its resampling's plan.
class FrameLightMaker {
  public:
    /// `texels_across`: n of the city's radiance layers, 1..codec::radiance::kMostCubeSide. `exposure_stops`: exposure
    /// is 2 to the power of it; empty: automatic.
    FrameLightMaker(uint32_t texels_across, std::optional<double> exposure_stops)
        : texels_across_(texels_across), exposure_stops_(exposure_stops) {}

    /// Valid until the next call. Its number is above 0 and goes up by one when the sky as it stands in the world is
    /// another than that of the call before; sun (but for that of a plain) and exposure may change under one number.
    const FrameLight& light(LightMoment moment);

  private:
    void set_map(EnvironmentMap map);
    void set_sky();
    void add_plain();
    LightSum level_light() const;
    float exposure() const;

    uint32_t texels_across_;
    std::optional<double> exposure_stops_;
    EnvironmentMap map_, reduced_;  ///< of the last moment, as it came and with what the source cube needs of it
    double plain_ = 0, yaw_ = 0;
    HarmonicLight harmonics_;  ///< of the map without its yaw
    std::optional<SourceSampler> sampler_;
    LightSum level_irradiance_{};  ///< of the sky
    FrameLight light_;
};

}  // namespace citystream::client
