// The light of a flight, from what people type to what each frame is lit with.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/light/frame_light_maker.h"
#include "client/stream/flight_statistics.h"

namespace citystream::client {

/// What is typed; empty where nothing is.
struct LightArguments {
    std::string environment;       ///< file, or `sky`
    std::string environment_path;  ///< CSV (environment_path.h)
    std::optional<double> rotation_degrees;
    std::optional<double> hour;
    std::string exposure;  ///< `auto`, or stops
    std::string sun;       ///< `apart`, or `map`: it stays in the map

    bool asked_for() const { return !environment.empty() || !environment_path.empty(); }
};

/// `auto`: nothing. Error: no number, or one beyond +-64.
Result<std::optional<double>> parse_exposure(const std::string& text);

/// Whether these go together. Error: one line that names the option; what only an environment makes sense of is an
/// error without one.
Status check_light_arguments(const LightArguments& arguments);

class FlightLight {
  public:
    /// Reads all environments. Preconditions: check_light_arguments, asked_for. Error: the first that cannot be read.
    static Result<FlightLight> load(const LightArguments& arguments);

    /// Defects of the files, one line each.
    const std::vector<std::string>& warnings() const { return light_.warnings(); }
    /// n of the city's radiance layers, before the first frame.
    void set_texels_across(uint32_t texels_across) { maker_.emplace(texels_across, exposure_stops_); }
    /// At a time of the path. Valid until the next call.
    const FrameLight& at(double time_s, FlightLighting& facts);

  private:
    FlightLight(EnvironmentPath path, EnvironmentLight light, std::optional<double> exposure_stops)
        : path_(std::move(path)), light_(std::move(light)), exposure_stops_(exposure_stops) {}

    EnvironmentPath path_;
    EnvironmentLight light_;
    std::optional<double> exposure_stops_;
    std::optional<FrameLightMaker> maker_;
};

}  // namespace citystream::client
