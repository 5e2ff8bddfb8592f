// citystream-report: error against run time and against bytes, knob by knob.

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>

#include "client/report/report_files.h"
#include "client/report/report_options.h"
#include "client/report/sweep.h"
#include "client/report/variants.h"

namespace {

using namespace citystream;
using namespace citystream::client;

int complain(const std::string& line, int code = command_line::kFailed) {
    fmt::print(stderr, "citystream-report: {}\n", line);
    return code;
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

/// Flies all settings and writes the page. Error: one line.
Status report(const ReportArguments& arguments, ReportPlan& plan) {
    SweepOptions& sweep = plan.sweep;
    auto path = read_camera_path(arguments.path_file);
    if (!path) return path.error();
    sweep.path = std::move(path).value();
    if (sweep.reference.empty())
        return Error{
            "no reference beside the city: build it with citystream-build ... --reference CITY.glb and name it with "
            "--reference"};
    auto light = load_light(arguments.light);
    if (!light) return light.error();
    if (*light) sweep.light = &**light;
    const std::filesystem::path folder(arguments.folder);
    std::error_code failed;
    sweep.picture_folder = (folder / "pictures").string();
    std::filesystem::create_directories(sweep.picture_folder, failed);
    if (failed) return Error{fmt::format("{}: {}", sweep.picture_folder, failed.message())};
    if (isatty(STDERR_FILENO)) sweep.progress = [](const std::string& line) { fmt::print(stderr, "\r\033[K{}", line); };

    const VariantOptions variants{find_builder(), arguments.build, (folder / "archives").string(), sweep.progress};
    if (Status built = build_variants(variants, plan.settings); !built) return built;
    auto result = run_sweep(sweep, plan.settings);
    if (sweep.progress) fmt::print(stderr, "\r\033[K");
    if (!result) return result.error();
    if (Status written = write_report(arguments.folder, sweep, *result); !written) return written;
    if (arguments.json)
        fmt::print("{}", report_json(sweep, *result));
    else
        fmt::print("{}\n", (folder / "index.html").string());
    return Done{};
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
    "--rate-distortions, --lattices, --directions, --local-directions, --radiance-transports and the knobs of meshes.";

}  // namespace

int main(int argc, char** argv) {
    ReportArguments arguments;
    CLI::App app{kAbout};
    app.set_version_flag("--version", CITYSTREAM_VERSION);
    app.footer(kBehindTheMark);
    add_report_options(app, arguments);
    const int own = take_build(argc, argv, arguments.build);
    if (const auto ended = command_line::read_arguments(app, own, argv)) return *ended;
    auto plan = read_report_options(arguments);
    if (!plan) return complain(plan.error().text(), command_line::kWrongUsage);
    const Status done = report(arguments, *plan);
    return done ? 0 : complain(done.error().text());
}
