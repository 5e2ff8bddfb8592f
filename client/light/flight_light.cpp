#include "client/light/flight_light.h"

#include <charconv>
#include <filesystem>
#include <sstream>

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

/// The option that only the analytic sky makes sense of; null: none was typed.
const char* option_of_sky(const LightArguments& arguments) {
    if (arguments.latitude_degrees) return "--latitude";
    if (arguments.day_of_year) return "--day";
    return arguments.turbidity ? "--turbidity" : nullptr;
}

/// The option that only lit frames make sense of; null: none was typed.
const char* option_of_light(const LightArguments& arguments) {
    if (!arguments.exposure.empty()) return "--exposure";
    if (!arguments.sun.empty()) return "--sun";
    if (arguments.light_tolerance) return "--light-tolerance";
    if (!arguments.matrix.empty()) return "--matrix";
    return arguments.matrix_error ? "--matrix-error" : nullptr;
}

}  // namespace

std::optional<codec::radiance::MatrixForm> matrix_form_named(std::string_view name) {
    using codec::radiance::MatrixForm;
    if (name == kMatrixFormNames[0]) return MatrixForm::kBiclusters;
    if (name == kMatrixFormNames[1]) return MatrixForm::kRows;
    return std::nullopt;
}

const char* matrix_form_name(codec::radiance::MatrixForm form) {
    return kMatrixFormNames[form == codec::radiance::MatrixForm::kRows ? 1 : 0];
}

TransferQuality transfer_quality(const LightArguments& arguments) {
    TransferQuality quality;
    quality.light_tolerance = arguments.light_tolerance.value_or(quality.light_tolerance);
    quality.matrix = matrix_form_named(arguments.matrix).value_or(quality.matrix);
    quality.matrix_error = arguments.matrix_error.value_or(quality.matrix_error);
    return quality;
}

Error needs_environment(const std::string& option) {
    return Error{option + " needs --environment or --environment-path"};
}

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
    const char* const of_sky = option_of_sky(arguments);
    if (of_sky != nullptr && arguments.environment != kAnalyticSky && arguments.environment_path.empty())
        return Error{std::string(of_sky) + " needs --environment sky, or --environment-path"};
    const char* const of_light = option_of_light(arguments);
    if (of_light != nullptr && !arguments.asked_for()) return needs_environment(of_light);
    const auto exposure = parse_exposure(arguments.exposure);
    if (!exposure) return exposure.error();
    return Done{};
}

std::string describe_light(const LightArguments& arguments) {
    const auto file_name = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
    std::ostringstream text;
    if (arguments.environment.empty()) {
        text << "the environments of " << file_name(arguments.environment_path);
    } else if (arguments.environment == kAnalyticSky) {
        const LightSettings usual;
        text << "the analytic sky at " << arguments.hour.value_or(kNoon) << " h, latitude "
             << arguments.latitude_degrees.value_or(usual.latitude_degrees) << ", day "
             << arguments.day_of_year.value_or(usual.day_of_year) << ", turbidity "
             << arguments.turbidity.value_or(usual.turbidity);
    } else {
        text << file_name(arguments.environment);
    }
    if (arguments.rotation_degrees) text << ", turned by " << *arguments.rotation_degrees << " degrees";
    if (arguments.sun == "map") text << ", its sun left in the map";
    if (!arguments.exposure.empty()) text << ", exposure " << arguments.exposure;
    return text.str();
}

Result<FlightLight> FlightLight::load(const LightArguments& arguments) {
    const auto exposure = parse_exposure(arguments.exposure);
    if (!exposure) return exposure.error();
    auto path = path_of(arguments);
    if (!path) return path.error();
    LightSettings settings;
    settings.latitude_degrees = arguments.latitude_degrees.value_or(settings.latitude_degrees);
    settings.day_of_year = arguments.day_of_year.value_or(settings.day_of_year);
    settings.turbidity = arguments.turbidity.value_or(settings.turbidity);
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
