#include "client/report/report_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "client/light/light_options.h"
#include "client/report/lit_reference.h"
#include "client/report/variants.h"
#include "codec/atlas/image_metric.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/source_directions.h"

namespace citystream::client {
namespace {

constexpr uint32_t kGreatestSide = 8192;
constexpr double kUsualTolerances[] = {0.5, 1, 2, 4, 8, 16};

std::string reference_beside(const std::string& city) {
    std::filesystem::path glb(city);
    glb.replace_extension(".glb");
    return std::filesystem::exists(glb) ? glb.string() : "";
}

/// "NAME=PLACE"; names go into tables, plots and file names.
Result<Setting> parse_archive(const std::string& text) {
    const size_t sign = text.find('=');
    const std::string name = text.substr(0, sign);
    const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == ' ' || c == '.' || c == '_' || c == '-';
    });
    if (sign == std::string::npos || !plain || sign + 1 == text.size())
        return Error{"--also " + text + ": give NAME=CITY, the name of letters, digits, spaces and .-_"};
    return Setting{"archive", 0, name, text.substr(sign + 1)};
}

/// In the order of the page: every knob that was asked for, and with other archives the city itself beside them.
Result<std::vector<Setting>> settings_of(const ReportArguments& arguments) {
    std::vector<Setting> settings;
    const auto add_numbers = [&](const char* knob, const std::vector<double>& values) {
        for (const double value : values) settings.push_back({knob, value, {}, {}});
    };
    const auto add_names = [&](const char* knob, const std::vector<std::string>& names) {
        for (const std::string& name : names) settings.push_back({knob, 0, name, {}});
    };
    add_numbers("tolerance", arguments.tolerances);
    add_numbers("gpu-budget", arguments.gpu_budgets_mib);
    add_numbers("relief-tolerance", arguments.relief_tolerances);
    add_numbers("texel-tolerance", arguments.texel_tolerances);
    add_numbers("position-tolerance", arguments.position_tolerances);
    add_names("map-level", arguments.map_levels);
    add_names("facade-renderer", arguments.facade_renderers);
    add_names("facade-samples", arguments.facade_samples);
    add_names("saliency", arguments.saliencies);
    add_numbers("rate-distortion", {arguments.rate_distortions.begin(), arguments.rate_distortions.end()});
    add_names("mesh-transport", arguments.mesh_transports);
    add_numbers("normal-bits", {arguments.normal_bits.begin(), arguments.normal_bits.end()});
    add_names("mesh-topology", arguments.mesh_topologies);
    add_names("precision", arguments.precisions);
    add_names("mesh-steps", arguments.mesh_steps);
    add_numbers("lattice", {arguments.lattices.begin(), arguments.lattices.end()});
    add_numbers("directions", {arguments.directions.begin(), arguments.directions.end()});
    add_numbers("local-directions", {arguments.local_directions.begin(), arguments.local_directions.end()});
    add_names("radiance-transport", arguments.radiance_transports);
    add_numbers("light-tolerance", arguments.light_tolerances);
    add_names("matrix", arguments.matrices);
    add_numbers("matrix-error", arguments.matrix_errors);
    if (!arguments.also.empty()) settings.push_back({"archive", 0, "as given", arguments.city});
    for (const std::string& text : arguments.also) {
        auto archive = parse_archive(text);
        if (!archive) return archive.error();
        const bool taken = std::any_of(settings.begin(), settings.end(), [&](const Setting& setting) {
            return setting.knob == "archive" && setting.name == archive->name;
        });
        if (taken) return Error{"--also " + text + ": the name is taken"};
        settings.push_back(std::move(*archive));
    }
    if (settings.empty()) add_numbers("tolerance", {std::begin(kUsualTolerances), std::end(kUsualTolerances)});
    return settings;
}

/// Settings that are built need to know how, and to be ones that the builder takes.
Status check_build(const ReportArguments& arguments, const std::vector<Setting>& settings) {
    for (const std::string& text : arguments.saliencies) {
        if (const auto metric = codec::atlas::parse_metric(text); !metric)
            return Error{"--saliencies " + text + ": " + metric.error().text()};
    }
    const bool builds =
        std::any_of(settings.begin(), settings.end(), [](const Setting& setting) { return is_built(setting.knob); });
    if (!builds || !arguments.build.empty()) return Done{};
    return Error{
        "--saliencies, --rate-distortions, --lattices, --directions, --local-directions, --radiance-transports and the "
        "knobs of meshes build the city: say how behind --, as citystream-build is called but without -o"};
}

/// An option that was given and makes sense of lit frames alone, beside those of LightArguments; null: none was.
const char* option_of_light(const ReportArguments& arguments) {
    if (!arguments.lattices.empty()) return "--lattices";
    if (!arguments.directions.empty()) return "--directions";
    if (!arguments.local_directions.empty()) return "--local-directions";
    if (!arguments.radiance_transports.empty()) return "--radiance-transports";
    if (!arguments.light_tolerances.empty()) return "--light-tolerances";
    if (!arguments.matrices.empty()) return "--matrices";
    if (!arguments.matrix_errors.empty()) return "--matrix-errors";
    return arguments.reference_rays ? "--reference-rays" : nullptr;
}

/// Fills the sweep's values of light but for the light itself.
Status read_light(const ReportArguments& arguments, SweepOptions& sweep) {
    if (Status good = check_light_arguments(arguments.light); !good) return good;
    if (!arguments.light.asked_for()) {
        const char* const option = option_of_light(arguments);
        return option == nullptr ? Status(Done{}) : needs_environment(option);
    }
    if (!lit_references_can_be_drawn())
        return Error{
            "--environment: this citystream-report was made without Embree, which draws what lit frames are compared "
            "with"};
    const TransferQuality quality = transfer_quality(arguments.light);
    sweep.light_tolerance = quality.light_tolerance;
    sweep.matrix = quality.matrix;
    sweep.matrix_error = quality.matrix_error;
    sweep.reference_rays = arguments.reference_rays.value_or(sweep.reference_rays);
    sweep.environment = describe_light(arguments.light);
    return Done{};
}

/// What is flown, and how it is drawn.
void add_flight_options(CLI::App& app, ReportArguments& arguments) {
    app.add_option("city", arguments.city, "A .3tz file, an unpacked folder or a URL")->required();
    app.add_option("--path", arguments.path_file, "Camera path (CSV: t,x,y,z,yaw,pitch,fov)")->required();
    app.add_option("-o,--output", arguments.folder, "Folder for the report")->required();
    app.add_option("--reference", arguments.reference, "The same city as .glb (default: beside the city, same name)");
    app.add_option("--frames", arguments.frames, "Cameras along the path")
        ->check(command_line::number_from(1, 1000))
        ->capture_default_str();
    app.add_option("--supersample", arguments.supersample, "Samples a pixel in x and in y")
        ->check(command_line::number_from(1, 2))
        ->capture_default_str();
    app.add_option("--device", arguments.device, "Vulkan device (index or part of its name)");
    app.add_flag("--json", arguments.json, "Print report.json instead of the page's name");
}

/// The city is built for each; citystream-build says which of their values it does not take.
void add_mesh_knobs(CLI::App& app, ReportArguments& arguments) {
    app.add_option("--mesh-transports", arguments.mesh_transports,
                   "How meshes travel, as --mesh-transport of citystream-build: default,draco")
        ->delimiter(',')
        ->check(CLI::IsMember({"default", "draco"}));
    app.add_option("--normal-bits", arguments.normal_bits, "Bits of normals, as --normal-bits of citystream-build")
        ->delimiter(',')
        ->check(command_line::number_from(8, 32));
    app.add_option("--mesh-topologies", arguments.mesh_topologies,
                   "How triangles lie in GPU memory, as --mesh-topology of citystream-build: "
                   "indices,local-strips,strip-code")
        ->delimiter(',')
        ->check(CLI::IsMember({"indices", "local-strips", "strip-code"}));
    app.add_option("--precisions", arguments.precisions,
                   "Bits of positions, as --precision of citystream-build: ap,cap")
        ->delimiter(',')
        ->check(CLI::IsMember({"ap", "cap"}));
    app.add_option("--mesh-steps", arguments.mesh_steps,
                   "Steps of positions, as --mesh-steps of citystream-build: auto,1,2,3,4")
        ->delimiter(',')
        ->check(command_line::word_or("auto", command_line::number_from(1, 4)));
}

/// For lit frames. The city is built for the first four.
void add_light_knobs(CLI::App& app, ReportArguments& arguments) {
    app.add_option("--lattices", arguments.lattices,
                   "Metres between the places where light is gathered, as --lattice of citystream-build: 8,4,2")
        ->delimiter(',')
        ->check(CLI::IsMember({1U, 2U, 4U, 8U, 16U}));
    app.add_option(
           "--directions", arguments.directions,
           "Directions that light comes from, on a side of a cube, as --directions of citystream-build: 12,16,32")
        ->delimiter(',')
        ->check(command_line::number_from(1U, codec::radiance::kMostCubeSide));
    app.add_option("--local-directions", arguments.local_directions,
                   "Directions of a place's own hemisphere, on a side, as --local-directions of citystream-build: 4,8")
        ->delimiter(',')
        ->check(command_line::number_from(1U, codec::radiance::kMostLocalSide));
    app.add_option("--radiance-transports", arguments.radiance_transports,
                   "How light travels, as --radiance-transport of citystream-build: "
                   "visibility,biclusters,distinct-rows,rows")
        ->delimiter(',')
        ->check(CLI::IsMember(std::vector<std::string>(codec::radiance::kRadianceTransportNames.begin(),
                                                       codec::radiance::kRadianceTransportNames.end())));
    app.add_option("--light-tolerances", arguments.light_tolerances,
                   "Parts of an even sky's light that a place may get wrong: how much of radiance layers is fetched")
        ->delimiter(',')
        ->check(command_line::number_from(0.0, 1.0));
    app.add_option("--matrices", arguments.matrices, "How matrices are kept in GPU memory: biclusters,rows")
        ->delimiter(',')
        ->check(matrix_forms());
    app.add_option("--matrix-errors", arguments.matrix_errors,
                   "Parts of an even sky's light that rows of matrices may leave out: smaller and faster")
        ->delimiter(',')
        ->check(command_line::number_from(0.0, 1.0));
}

/// Knobs: every value of a list is a setting.
void add_knobs(CLI::App& app, ReportArguments& arguments) {
    app.add_option("--tolerances", arguments.tolerances,
                   "Screen-space tolerances in pixels; without any list of settings 0.5,1,2,4,8,16")
        ->delimiter(',')
        ->check(command_line::number_from(0.01, 1000.0));
    app.add_option("--gpu-budgets", arguments.gpu_budgets_mib, "GPU budgets in MiB, flown at --tolerance")
        ->delimiter(',')
        ->check(command_line::number_from(1.0, 1e6));
    app.add_option("--relief-tolerances", arguments.relief_tolerances, "Pixels below which relief is drawn flat")
        ->delimiter(',')
        ->check(command_line::number_from(0.01, 1000.0));
    app.add_option("--texel-tolerances", arguments.texel_tolerances, "Largest sizes of texels in pixels")
        ->delimiter(',')
        ->check(command_line::number_from(0.01, 1000.0));
    app.add_option("--position-tolerances", arguments.position_tolerances,
                   "Pixels that a vertex may be off its place, for want of low bits of its position")
        ->delimiter(',')
        ->check(command_line::number_from(0.01, 1000.0));
    app.add_option("--saliencies", arguments.saliencies,
                   "How much images may lose to become smaller, as --saliency of citystream-build: none,ssim:0.99; the "
                   "city is built for each")
        ->delimiter(',');
    app.add_option("--rate-distortions", arguments.rate_distortions,
                   "Squared errors that a bit of pictures is worth, as --rate-distortion of citystream-build; the city "
                   "is built for each")
        ->delimiter(',')
        ->check(command_line::number_from(0, 1 << 20));
    add_mesh_knobs(app, arguments);
    add_light_knobs(app, arguments);
    app.add_option("--map-levels", arguments.map_levels, "Levels of all facade maps: auto, 0 (the coarsest) to 3")
        ->delimiter(',')
        ->check(CLI::IsMember(map_level_names()));
    app.add_option("--facade-renderers", arguments.facade_renderers, "Ways to ray cast relief")
        ->delimiter(',')
        ->check(CLI::IsMember(facade_renderer_names()));
    app.add_option("--facade-samples", arguments.facade_samples,
                   "Rays of pixels that cover more than the finest parts of their facade")
        ->delimiter(',')
        ->check(CLI::IsMember(facade_sample_names()));
    app.add_option("--also", arguments.also,
                   "NAME=CITY: the same city built otherwise, for example with another --merge-tolerance; repeat it")
        ->allow_extra_args(false);
}

/// Where the knobs that are not turned stand.
void add_resting_values(CLI::App& app, ReportArguments& arguments) {
    app.option_defaults()->group("What all settings have, but for the one whose knob is turned");
    add_view_options(app, arguments.view);
    add_drawn_view_options(app, arguments.view);
    app.add_option("--facade-renderer", arguments.facade_renderer, "how relief is ray cast")
        ->check(CLI::IsMember(facade_renderer_names()))
        ->capture_default_str();
    add_environment_options(app, arguments.light);
    add_transfer_options(app, arguments.light);
    app.add_option("--reference-rays", arguments.reference_rays,
                   fmt::format("rays of a pixel, at least, of what lit frames are compared with ({})",
                               SweepOptions().reference_rays))
        ->check(command_line::number_from(1U, 1U << 16));
}

}  // namespace

void add_report_options(CLI::App& app, ReportArguments& arguments) {
    add_flight_options(app, arguments);
    add_knobs(app, arguments);
    add_resting_values(app, arguments);
}

Result<ReportPlan> read_report_options(const ReportArguments& arguments) {
    ReportPlan plan;
    SweepOptions& sweep = plan.sweep;
    auto settings = settings_of(arguments);
    if (!settings) return settings.error();
    plan.settings = std::move(*settings);
    if (Status good = read_light(arguments, sweep); !good) return good.error();
    if (Status good = check_build(arguments, plan.settings); !good) return good.error();
    const auto relief = read_relief(arguments.view);
    if (!relief) return relief.error();
    const auto size = read_size(arguments.view, kGreatestSide);
    if (!size) return size.error();
    sweep.city = arguments.city;
    sweep.reference = arguments.reference.empty() ? reference_beside(arguments.city) : arguments.reference;
    sweep.frames = arguments.frames;
    sweep.width = size->width;
    sweep.height = size->height;
    sweep.supersample = arguments.supersample;
    sweep.device = arguments.device;
    sweep.relief = *relief;
    sweep.tolerance_pixels = arguments.view.tolerance_pixels;
    sweep.texel_tolerance_pixels = arguments.view.texel_tolerance_pixels;
    sweep.position_tolerance_pixels = arguments.view.position_tolerance_pixels;
    sweep.facade_renderer = facade_renderer_named(arguments.facade_renderer).value_or(sweep.facade_renderer);
    return plan;
}

}  // namespace citystream::client
