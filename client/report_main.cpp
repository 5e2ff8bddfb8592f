// citystream-report: error against run time and against bytes, knob by knob.

#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <string_view>

#include "client/light/light_options.h"
#include "client/path/frame_size.h"
#include "client/report/lit_reference.h"
#include "client/report/report_files.h"
#include "client/report/sweep.h"
#include "client/report/variants.h"
#include "client/select/relief_arguments.h"
#include "codec/atlas/image_metric.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/source_directions.h"
#include "command_line/command_line.h"

namespace {

using namespace citystream;
using namespace citystream::client;

constexpr uint32_t kGreatestSide = 8192;
constexpr double kUsualTolerances[] = {0.5, 1, 2, 4, 8, 16};

struct Arguments {
    SweepOptions sweep;
    std::string path_file, folder, size = "1280x720";
    std::vector<double> tolerances;  ///< kUsualTolerances when no knob is given
    std::vector<double> gpu_budgets_mib, relief_tolerances, texel_tolerances, position_tolerances;
    std::vector<uint32_t> rate_distortions, normal_bits;
    std::vector<std::string> saliencies, mesh_transports, mesh_topologies, precisions, mesh_steps, build;
    std::vector<std::string> map_levels, facade_renderers, facade_samples, also;
    std::string map_level = "auto", facade_renderer{facade_renderer_name(FacadeRenderer::kPatch)};
    std::optional<double> relief_tolerance;
    LightArguments light;
    std::vector<uint32_t> lattices, directions, local_directions;
    std::vector<double> light_tolerances, matrix_errors;
    std::vector<std::string> matrices;
    std::optional<double> light_tolerance, matrix_error;
    std::optional<uint32_t> reference_rays;
    std::string matrix;
    bool json = false;
};

int complain(const std::string& line, int code = command_line::kFailed) {
    fmt::print(stderr, "citystream-report: {}\n", line);
    return code;
}

std::string reference_beside(const std::string& city) {
    std::filesystem::path glb(city);
    glb.replace_extension(".glb");
    return std::filesystem::exists(glb) ? glb.string() : "";
}

std::vector<std::string> renderer_names() {
    std::vector<std::string> names;
    names.reserve(kFacadeRenderers.size());
    for (const FacadeRenderer renderer : kFacadeRenderers) names.emplace_back(facade_renderer_name(renderer));
    return names;
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
Result<std::vector<Setting>> settings_of(const Arguments& arguments) {
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
    add_numbers("light-tolerance", arguments.light_tolerances);
    add_names("matrix", arguments.matrices);
    add_numbers("matrix-error", arguments.matrix_errors);
    if (!arguments.also.empty()) settings.push_back({"archive", 0, "as given", arguments.sweep.city});
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
Status check_build(const Arguments& arguments, const std::vector<Setting>& settings) {
    for (const std::string& text : arguments.saliencies) {
        if (const auto metric = codec::atlas::parse_metric(text); !metric)
            return Error{"--saliencies " + text + ": " + metric.error().text()};
    }
    const bool builds =
        std::any_of(settings.begin(), settings.end(), [](const Setting& setting) { return is_built(setting.knob); });
    if (!builds || !arguments.build.empty()) return Done{};
    return Error{
        "--saliencies, --rate-distortions, --lattices, --directions, --local-directions and the knobs of meshes build "
        "the city: say how behind --, as citystream-build is called but without -o"};
}

/// An option that was given and makes sense of lit frames alone; empty: none was.
std::string option_of_light(const Arguments& arguments) {
    if (!arguments.lattices.empty()) return "--lattices";
    if (!arguments.directions.empty()) return "--directions";
    if (!arguments.local_directions.empty()) return "--local-directions";
    if (!arguments.light_tolerances.empty()) return "--light-tolerances";
    if (!arguments.matrices.empty()) return "--matrices";
    if (!arguments.matrix_errors.empty()) return "--matrix-errors";
    if (arguments.light_tolerance) return "--light-tolerance";
    if (!arguments.matrix.empty()) return "--matrix";
    if (arguments.matrix_error) return "--matrix-error";
    return arguments.reference_rays ? "--reference-rays" : "";
}

/// Fills the sweep's values of light but for the light itself.
Status interpret_light(Arguments& arguments) {
    if (Status good = check_light_arguments(arguments.light); !good) return good;
    if (!arguments.light.asked_for()) {
        const std::string option = option_of_light(arguments);
        if (!option.empty()) return Error{option + " needs --environment or --environment-path"};
        return Done{};
    }
    if (!lit_references_can_be_drawn())
        return Error{
            "--environment: this citystream-report was made without Embree, which draws what lit frames are compared "
            "with"};
    SweepOptions& sweep = arguments.sweep;
    sweep.light_tolerance = arguments.light_tolerance.value_or(sweep.light_tolerance);
    sweep.matrix_error = arguments.matrix_error.value_or(sweep.matrix_error);
    sweep.reference_rays = arguments.reference_rays.value_or(sweep.reference_rays);
    if (!arguments.matrix.empty()) sweep.matrix = matrix_form_named(arguments.matrix).value_or(sweep.matrix);
    sweep.environment = describe_light(arguments.light);
    return Done{};
}

/// Fills the sweep's values that are texts on the command line. Error: wrong usage, one line.
Result<std::vector<Setting>> interpret(Arguments& arguments) {
    SweepOptions& sweep = arguments.sweep;
    auto settings = settings_of(arguments);
    if (!settings) return settings;
    if (Status good = interpret_light(arguments); !good) return good.error();
    if (Status good = check_build(arguments, *settings); !good) return good.error();
    const auto relief = parse_relief_options(arguments.map_level, arguments.relief_tolerance);
    if (!relief) return relief.error();
    sweep.relief = *relief;
    sweep.facade_renderer = facade_renderer_named(arguments.facade_renderer).value_or(FacadeRenderer::kPatch);
    const auto size = parse_frame_size(arguments.size, kGreatestSide);
    if (!size) return Error{"--size: " + size.error().text()};
    sweep.width = size->width;
    sweep.height = size->height;
    return settings;
}

/// The light that is asked for, if any; what is wrong with its files is said.
Result<std::optional<FlightLight>> load_light(const LightArguments& arguments) {
    if (!arguments.asked_for()) return std::optional<FlightLight>();
    auto light = FlightLight::load(arguments);
    if (!light) return light.error();
    for (const std::string& warning : light->warnings())
        fmt::print(stderr, "citystream-report: warning: {}\n", warning);
    return std::optional(std::move(*light));
}

int run(Arguments& arguments) {
    SweepOptions& sweep = arguments.sweep;
    auto settings = interpret(arguments);
    if (!settings) return complain(settings.error().text(), command_line::kWrongUsage);
    auto path = read_camera_path(arguments.path_file);
    if (!path) return complain(path.error().text());
    sweep.path = std::move(path).value();
    if (sweep.reference.empty()) sweep.reference = reference_beside(sweep.city);
    if (sweep.reference.empty())
        return complain(
            "no reference beside the city: build it with citystream-build ... --reference CITY.glb and name it with "
            "--reference");
    auto light = load_light(arguments.light);
    if (!light) return complain(light.error().text());
    if (*light) sweep.light = &**light;
    std::error_code failed;
    sweep.picture_folder = (std::filesystem::path(arguments.folder) / "pictures").string();
    std::filesystem::create_directories(sweep.picture_folder, failed);
    if (failed) return complain(fmt::format("{}: {}", sweep.picture_folder, failed.message()));
    if (isatty(STDERR_FILENO)) sweep.progress = [](const std::string& line) { fmt::print(stderr, "\r\033[K{}", line); };

    VariantOptions variants{find_builder(), arguments.build,
                            (std::filesystem::path(arguments.folder) / "archives").string(), sweep.progress};
    if (Status built = build_variants(variants, *settings); !built) return complain(built.error().text());
    auto result = run_sweep(sweep, *settings);
    if (sweep.progress) fmt::print(stderr, "\r\033[K");
    if (!result) return complain(result.error().text());
    if (Status written = write_report(arguments.folder, sweep, *result); !written)
        return complain(written.error().text());
    if (arguments.json)
        fmt::print("{}", report_json(sweep, *result));
    else
        fmt::print("{}\n", (std::filesystem::path(arguments.folder) / "index.html").string());
    return 0;
}

/// What is flown, and how it is drawn.
void add_flight_options(CLI::App& app, Arguments& arguments) {
    app.add_option("city", arguments.sweep.city, "A .3tz file, an unpacked folder or a URL")->required();
    app.add_option("--path", arguments.path_file, "Camera path (CSV: t,x,y,z,yaw,pitch,fov)")->required();
    app.add_option("-o,--output", arguments.folder, "Folder for the report")->required();
    app.add_option("--reference", arguments.sweep.reference,
                   "The same city as .glb (default: beside the city, same name)");
    app.add_option("--size", arguments.size, "Frame size")->capture_default_str();
    app.add_option("--frames", arguments.sweep.frames, "Cameras along the path")
        ->check(command_line::number_from(1, 1000))
        ->capture_default_str();
    app.add_option("--supersample", arguments.sweep.supersample, "Samples a pixel in x and in y")
        ->check(command_line::number_from(1, 2))
        ->capture_default_str();
    app.add_option("--device", arguments.sweep.device, "Vulkan device (index or part of its name)");
    app.add_flag("--json", arguments.json, "Print report.json instead of the page's name");
}

CLI::Validator matrix_forms() {
    return CLI::IsMember(std::vector<std::string>(kMatrixFormNames.begin(), kMatrixFormNames.end()));
}

/// The city is built for each; citystream-build says which of their values it does not take.
void add_mesh_knobs(CLI::App& app, Arguments& arguments) {
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

/// For lit frames. The city is built for the first three.
void add_light_knobs(CLI::App& app, Arguments& arguments) {
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

/// What lights all settings, and where the knobs of light that are not turned stand.
void add_light_options(CLI::App& app, Arguments& arguments) {
    add_environment_options(app, arguments.light);
    app.add_option("--light-tolerance", arguments.light_tolerance,
                   fmt::format("Light tolerance of the other knobs' settings ({:g})", kUsualLightTolerance))
        ->check(command_line::number_from(0.0, 1.0));
    app.add_option("--matrix", arguments.matrix,
                   fmt::format("Form of matrices of the other knobs' settings ({})", kMatrixFormNames[0]))
        ->check(matrix_forms());
    app.add_option("--matrix-error", arguments.matrix_error, "Matrix error of the other knobs' settings (0)")
        ->check(command_line::number_from(0.0, 1.0));
    app.add_option("--reference-rays", arguments.reference_rays,
                   fmt::format("Rays of a pixel, at least, of what lit frames are compared with ({})",
                               SweepOptions().reference_rays))
        ->check(command_line::number_from(1U, 1U << 16));
}

/// Knobs: every value of a list is a setting.
void add_knobs(CLI::App& app, Arguments& arguments) {
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
        ->check(CLI::IsMember(renderer_names()));
    app.add_option("--facade-samples", arguments.facade_samples,
                   "Rays of pixels that cover more than the finest parts of their facade")
        ->delimiter(',')
        ->check(CLI::IsMember(facade_sample_names()));
    app.add_option("--also", arguments.also,
                   "NAME=CITY: the same city built otherwise, for example with another --merge-tolerance; repeat it")
        ->allow_extra_args(false);
}

/// Where the knobs that are not turned stand.
void add_resting_values(CLI::App& app, Arguments& arguments) {
    app.add_option("--tolerance", arguments.sweep.tolerance_pixels, "Tolerance of the other knobs' settings")
        ->check(command_line::number_from(0.01, 1000.0))
        ->capture_default_str();
    app.add_option("--relief-tolerance", arguments.relief_tolerance,
                   "Relief tolerance of the other knobs' settings (default: their tolerance)")
        ->check(command_line::number_from(0.01, 1000.0));
    app.add_option("--texel-tolerance", arguments.sweep.texel_tolerance_pixels,
                   "Texel tolerance of the other knobs' settings (default: their tolerance)")
        ->check(command_line::number_from(0.01, 1000.0));
    app.add_option("--position-tolerance", arguments.sweep.position_tolerance_pixels,
                   "Position tolerance of the other knobs' settings (default: a thirty-second of their tolerance)")
        ->check(command_line::number_from(0.01, 1000.0));
    app.add_option("--map-level", arguments.map_level, "Map level of the other knobs' settings")
        ->check(CLI::IsMember(map_level_names()))
        ->capture_default_str();
    app.add_option("--facade-renderer", arguments.facade_renderer, "Facade renderer of the other knobs' settings")
        ->check(CLI::IsMember(renderer_names()))
        ->capture_default_str();
}

/// Copies what is behind "--", which belongs to citystream-build, and returns how many arguments come before: CLI11
/// would look for its own options there, too.
int take_build(int argc, char** argv, std::vector<std::string>& build) {
    char** const mark =
        std::find_if(argv, argv + argc, [](const char* word) { return std::string_view(word) == "--"; });
    if (mark != argv + argc) build.assign(mark + 1, argv + argc);
    return static_cast<int>(mark - argv);
}

constexpr const char* kAbout =
    "Draws error against run time and bytes: flies PATH once per setting and compares each frame with the "
    "reference renderer.\n"
    "Examples: citystream-report city.3tz --path tour.csv --tolerances 0.5,1,2,4 -o report\n"
    "          citystream-report city.3tz --path tour.csv --map-levels auto,0,1,2,3 --facade-renderers patch,fdm "
    "--also merged-2mm=merged.3tz -o report\n"
    "          citystream-report city.3tz --path tour.csv --saliencies none,ssim:0.99,flip:0.05 --rate-distortions "
    "0,4,16 "
    "-o report -- generate --buildings 1000 --textures 100\n"
    "          citystream-report city.3tz --path tour.csv --environment sky --hour 18 --lattices 8,4,2 "
    "--light-tolerances 0,0.05,0.2 -o report -- generate --buildings 40 --layers mesh,facade,atlas,radiance";
constexpr const char* kBehindTheMark =
    "Behind --: what citystream-build makes the city of (inputs and options without -o), for --saliencies, "
    "--rate-distortions, --lattices, --directions, --local-directions and the knobs of meshes.";

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app{kAbout};
    app.set_version_flag("--version", CITYSTREAM_VERSION);
    app.footer(kBehindTheMark);
    add_flight_options(app, arguments);
    add_knobs(app, arguments);
    add_resting_values(app, arguments);
    add_light_options(app, arguments);
    const int own = take_build(argc, argv, arguments.build);
    if (const auto ended = command_line::read_arguments(app, own, argv)) return *ended;
    return run(arguments);
}
