// The light of a flight, from what people type to what each frame is lit with.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/light/frame_light_maker.h"
#include "client/stream/flight_statistics.h"
#include "codec/radiance/radiance_layer.h"

namespace citystream::client {

/// Of a flight that asks for light: StreamerOptions::light_tolerance where none is typed.
inline constexpr double kUsualLightTolerance = 0.05;

/// What is worth a warning where light is asked for.
inline constexpr std::string_view kNoRadianceLayer =
    "this city has no radiance layer (citystream-build --layers ...,radiance): the sky lights it without shadows";

/// What is typed; empty where nothing is.
struct LightArguments {
    std::string environment;       ///< file, or `sky`
    std::string environment_path;  ///< CSV (environment_path.h)
    std::optional<double> rotation_degrees;
    std::optional<double> hour;
    std::optional<double> latitude_degrees, day_of_year, turbidity;  ///< of the analytic sky (LightSettings)
    std::string exposure;                                            ///< `auto`, or stops
    std::string sun;                                                 ///< `apart`, or `map`: it stays in the map
    std::optional<double> light_tolerance, matrix_error;             ///< TransferQuality
    std::string matrix;                                              ///< one of kMatrixFormNames

    bool asked_for() const { return !environment.empty() || !environment_path.empty(); }
};

/// How the radiance layer's matrix is kept in GPU memory, by name.
inline constexpr std::array<const char*, 2> kMatrixFormNames = {"biclusters", "rows"};
std::optional<codec::radiance::MatrixForm> matrix_form_named(std::string_view name);
const char* matrix_form_name(codec::radiance::MatrixForm form);

/// How exactly radiance layers are fetched and kept: the values of StreamerOptions.
struct TransferQuality {
    double light_tolerance = kUsualLightTolerance;
    codec::radiance::MatrixForm matrix = codec::radiance::MatrixForm::kBiclusters;
    double matrix_error = 0;
};
/// Of what is typed, where it is; a name of no form counts as none.
TransferQuality transfer_quality(const LightArguments& arguments);

/// `auto`: nothing. Error: no number, or one beyond +-64.
Result<std::optional<double>> parse_exposure(const std::string& text);

/// What is said of an option that only lit frames make sense of where none are asked for.
Error needs_environment(const std::string& option);
/// Whether these go together. Error: one line that names the option; what only an environment makes sense of is an
/// error without one.
Status check_light_arguments(const LightArguments& arguments);

/// For people, in a few words: "dawn.hdr, turned by 90 degrees". Precondition: asked_for.
std::string describe_light(const LightArguments& arguments);

class FlightLight {
  public:
    /// Reads all environments. Preconditions: check_light_arguments, asked_for. Error: the first that cannot be read.
    static Result<FlightLight> load(const LightArguments& arguments);

    /// Defects of the files, one line each.
    const std::vector<std::string>& warnings() const { return light_.warnings(); }
    /// n of the city's radiance layers, before the first frame.
    void set_texels_across(uint32_t texels_across) { maker_.emplace(texels_across, exposure_stops_); }
    /// What at() makes its light of: the map before it is resampled, with its turn.
    LightMoment moment(double time_s) const { return light_.at(time_s); }
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
