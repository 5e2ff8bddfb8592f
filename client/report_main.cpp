// citystream-report: error against run time and against bytes, knob by knob.

#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <filesystem>

#include "client/report/report_files.h"
#include "client/report/sweep.h"

namespace {

using namespace citystream;
using namespace citystream::client;

struct Arguments {
    SweepOptions sweep;
    std::string path_file, folder, size = "1280x720";
    std::vector<double> tolerances = {0.5, 1, 2, 4, 8, 16};
    std::vector<double> gpu_budgets_mib;
    bool json = false;
};

int complain(const std::string& line) {
    fmt::print(stderr, "citystream-report: {}\n", line);
    return 1;
}

std::string reference_beside(const std::string& city) {
    std::filesystem::path glb(city);
    glb.replace_extension(".glb");
    return std::filesystem::exists(glb) ? glb.string() : "";
}

int run(Arguments& arguments) {
    SweepOptions& sweep = arguments.sweep;
    if (std::sscanf(arguments.size.c_str(), "%ux%u", &sweep.width, &sweep.height) != 2 || sweep.width - 1 >= 8192 ||
        sweep.height - 1 >= 8192)
        return complain(fmt::format("--size {}: give WIDTHxHEIGHT, each 1 to 8192", arguments.size));
    auto path = read_camera_path(arguments.path_file);
    if (!path) return complain(path.error().text());
    sweep.path = std::move(path).value();
    if (sweep.reference.empty()) sweep.reference = reference_beside(sweep.city);
    if (sweep.reference.empty())
        return complain(
            "no reference beside the city: build it with citystream-build ... --reference CITY.glb and name it with "
            "--reference");
    std::error_code failed;
    sweep.picture_folder = (std::filesystem::path(arguments.folder) / "pictures").string();
    std::filesystem::create_directories(sweep.picture_folder, failed);
    if (failed) return complain(fmt::format("{}: {}", sweep.picture_folder, failed.message()));
    if (isatty(STDERR_FILENO)) sweep.progress = [](const std::string& line) { fmt::print(stderr, "\r\033[K{}", line); };

    std::vector<Setting> settings;
    for (const double tolerance : arguments.tolerances) settings.push_back({"tolerance", tolerance});
    for (const double budget : arguments.gpu_budgets_mib) settings.push_back({"gpu-budget", budget});
    auto result = run_sweep(sweep, settings);
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

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app{
        "Draws error against run time and bytes: flies PATH once per setting and compares each frame with the "
        "reference renderer.\n"
        "Example: citystream-report city.3tz --path tour.csv --tolerances 0.5,1,2,4 -o report"};
    app.set_version_flag("--version", CITYSTREAM_VERSION);
    app.add_option("city", arguments.sweep.city, "A .3tz file, an unpacked folder or a URL")->required();
    app.add_option("--path", arguments.path_file, "Camera path (CSV: t,x,y,z,yaw,pitch,fov)")->required();
    app.add_option("-o,--output", arguments.folder, "Folder for the report")->required();
    app.add_option("--reference", arguments.sweep.reference,
                   "The same city as .glb (default: beside the city, same name)");
    app.add_option("--size", arguments.size, "Frame size")->capture_default_str();
    app.add_option("--frames", arguments.sweep.frames, "Cameras along the path")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--tolerances", arguments.tolerances, "Screen-space tolerances in pixels")
        ->delimiter(',')
        ->check(CLI::Range(0.01, 1000.0))
        ->capture_default_str();
    app.add_option("--gpu-budgets", arguments.gpu_budgets_mib, "GPU budgets in MiB, flown at --tolerance")
        ->delimiter(',')
        ->check(CLI::Range(1.0, 1e6));
    app.add_option("--tolerance", arguments.sweep.tolerance_pixels, "Tolerance of the other knobs' settings")
        ->check(CLI::Range(0.01, 1000.0))
        ->capture_default_str();
    app.add_option("--supersample", arguments.sweep.supersample, "Samples a pixel in x and in y")
        ->check(CLI::Range(1, 2))
        ->capture_default_str();
    app.add_option("--device", arguments.sweep.device, "Vulkan device (index or part of its name)");
    app.add_flag("--json", arguments.json, "Print report.json instead of the page's name");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    return run(arguments);
}
