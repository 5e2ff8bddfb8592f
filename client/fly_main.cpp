// citystream-fly: flies a camera path over a city and leaves frames, a film and statistics. No display is needed.
#include <fmt/format.h>

#include <atomic>
#include <csignal>

#include "client/fly/flight.h"
#include "client/fly/flown_path.h"
#include "client/fly/fly_options.h"

namespace citystream::client {
namespace {

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "the signal handler sets it");

extern "C" void request_stop(int) {
    stop_requested = true;
}

constexpr const char* kExamples = R"(Examples:
  citystream-fly http://localhost:8080 --path tour.csv --frames out/
  citystream-fly city.3tz --path tour.csv --video tour.mp4 --stats tour.json --tolerance 2
  citystream-fly city.3tz --path tour.csv --gpu-budget 64MiB --host-budget 128MiB --json
  citystream-fly http://localhost:8080/city --path tour.csv --mode realtime --network 5mbit,38ms
  citystream-fly city.3tz --path tour.csv --environment sky --hour 18.5 --frames evening/
  citystream-fly city.3tz --path tour.csv --environment-path day.csv --video day.mp4
  citystream-fly --reference city.glb --path tour.csv --frames reference/)";

int fail(const Error& error, int code = command_line::kFailed) {
    say(error.text());
    return code;
}

int run(int argc, char** argv) {
    CLI::App app{"Flies a camera path over a streamed city, without a display."};
    FlyArguments arguments;
    add_fly_options(app, arguments);
    app.set_version_flag("--version", std::string("citystream-fly ") + CITYSTREAM_VERSION);
    app.footer(kExamples);
    if (const auto ended = command_line::read_arguments(app, argc, argv)) return *ended;
    if (arguments.list_devices) {
        for (const std::string& line : list_devices()) fmt::print("{}\n", line);
        return 0;
    }
    const auto options = read_fly_options(arguments);
    if (!options) return fail(options.error(), command_line::kWrongUsage);
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    const auto path = read_camera_path(options->path);
    if (!path) return fail(path.error());
    const Status flown = options->reference.empty() ? fly_city(*options, *path, stop_requested)
                                                    : fly_reference(*options, *path, stop_requested);
    return flown ? 0 : fail(flown.error());
}

}  // namespace
}  // namespace citystream::client

int main(int argc, char** argv) {
    try {
        return citystream::client::run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "citystream-fly: {}\n", error.what());
        return 1;
    }
}
