#include "client/light/flight_light.h"

#include <charconv>

#include "client/light/environment_path.h"

namespace citystream::client {
namespace {

constexpr double kMostStops = 64;
constexpr double kNoon = 12;
constexpr uint32_t kTexelsWithoutLayers = 16;  ///< of the source cube in a city without radiance layers

Result<EnvironmentPath> path_of(const LightArguments& arguments) {
    if (!arguments.environment_path.empty()) return read_environment_path(arguments.environment_path);
    return steady_environment(arguments.environment, arguments.rotation_degrees.value_or(0),
                              arguments.hour.value_or(kNoon));
}

}  // namespace

Result<std::optional<double>> parse_exposure(const std::string& text) {
    if (text.empty() || text == "auto") return std::optional<double>();
    double stops = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), stops);
    const bool whole = failure == std::errc() && end == text.data() + text.size();
    if (!whole || !(stops >= -kMostStops && stops <= kMostStops))
        return Error{"--exposure " + text + ": expected auto, or stops from -64 to 64"};
    return std::optional(stops);
}

Status check_light_arguments(const LightArguments& arguments) {
    const bool steady = !arguments.environment.empty();
    if (steady && !arguments.environment_path.empty())
        return Error{"--environment and --environment-path exclude each other"};
    if (arguments.rotation_degrees && !steady) return Error{"--environment-rotation needs --environment"};
    if (arguments.hour && arguments.environment != kAnalyticSky) return Error{"--hour needs --environment sky"};
    if (!arguments.exposure.empty() && !arguments.asked_for())
        return Error{"--exposure needs --environment or --environment-path"};
    if (!arguments.sun.empty() && !arguments.asked_for())
        return Error{"--sun needs --environment or --environment-path"};
    const auto exposure = parse_exposure(arguments.exposure);
    if (!exposure) return exposure.error();
    return Done{};
}

Result<FlightLight> FlightLight::load(const LightArguments& arguments) {
    const auto exposure = parse_exposure(arguments.exposure);
    if (!exposure) return exposure.error();
    auto path = path_of(arguments);
    if (!path) return path.error();
    LightSettings settings;
    settings.take_suns = arguments.sun != "map";
    auto light = EnvironmentLight::load(*path, settings);
    if (!light) return light.error();
    return FlightLight(std::move(*path), std::move(*light), *exposure);
}

const FrameLight& FlightLight::at(double time_s, FlightLighting& facts) {
    if (!maker_) set_texels_across(kTexelsWithoutLayers);
    const FrameLight& light = maker_->light(light_.at(time_s));
    const EnvironmentPath::Moment moment = path_.at(time_s);
    const EnvironmentPath::Part& main = moment.parts[moment.parts[1].weight > moment.parts[0].weight ? 1 : 0];
    facts.environment = path_.environments[main.environment];
    facts.share = main.weight;
    facts.rotation_degrees = moment.rotation_degrees;
    if (facts.environment == kAnalyticSky) facts.hour = main.hour;
    facts.exposure = light.exposure;
    facts.number = light.number;
    return light;
}

}  // namespace citystream::client
