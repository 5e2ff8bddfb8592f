// citystream-load: many clients replay a recorded camera path against a server.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>

#include "client/load/load_arguments.h"
#include "client/load/load_report.h"
#include "client/load/load_run.h"
#include "client/select/view_options.h"
#include "client/stream/byte_count.h"
#include "command_line/command_line.h"

namespace {

using namespace citystream;

constexpr const char* kExamples = R"(Examples:
  citystream-load http://127.0.0.1:8080/demo --path tour.csv --clients 200
  citystream-load http://127.0.0.1:8080 --path tour.csv --clients 500 --duration 60s --network 5mbit,38ms --stats load.json
Every client flies the path from a place of its own, at the pace of the recording, whether answers come or not (open loop).
Latencies count from the time at which a camera update was due. Ctrl-C ends early with the figures so far.)";

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "the signal handler sets it");

struct Arguments {
    std::string place, path, duration = "30s", ramp = "2s", network, host_budget = "1GiB", gpu_budget = "512MiB", stats;
    client::ViewArguments view;
    client::LoadOptions options;
    bool json = false;
};

int fail(const std::string& message, int code) {
    fmt::print(stderr, "citystream-load: {}\n", message);
    return code;
}

/// Fills options from the texts; the error names the option.
Result<uint64_t> read_budget(const char* option, const std::string& text) {
    const auto bytes = client::parse_byte_count(text);
    if (!bytes) return Error{std::string(option) + ": " + bytes.error().text()};
    if (*bytes == 0) return Error{std::string(option) + ": at least a byte is needed"};
    return *bytes;
}

Status interpret(Arguments& arguments) {
    client::LoadOptions& options = arguments.options;
    const auto duration = client::parse_load_duration(arguments.duration);
    if (!duration) return Error{"--duration: " + duration.error().text()};
    options.duration_seconds = *duration;
    if (arguments.ramp == "0" || arguments.ramp == "0s") {
        options.ramp_seconds = 0;
    } else {
        const auto ramp = client::parse_load_duration(arguments.ramp);
        if (!ramp) return Error{"--ramp: " + ramp.error().text()};
        options.ramp_seconds = *ramp;
    }
    const auto size = client::read_size(arguments.view);
    if (!size) return size.error();
    options.client.width = size->width;
    options.client.height = size->height;
    const auto host = read_budget("--host-budget", arguments.host_budget);
    if (!host) return host.error();
    options.client.streamer.host_budget_bytes = *host;
    const auto gpu = read_budget("--gpu-budget", arguments.gpu_budget);
    if (!gpu) return gpu.error();
    options.client.gpu_budget_bytes = *gpu;
    if (!arguments.network.empty()) {
        const auto shape = client::NetworkShape::parse(arguments.network);
        if (!shape) return Error{"--network: " + shape.error().text()};
        options.client.fetcher.shape = *shape;
    }
    const auto relief = client::read_relief(arguments.view);
    if (!relief) return relief.error();
    options.client.streamer.relief = *relief;
    options.client.streamer.tolerance_pixels = arguments.view.tolerance_pixels;
    options.client.place = arguments.place;
    return Done{};
}

/// Redrawn in place on a terminal, silent elsewhere.
void show_progress(double seconds, uint64_t answers, double duration) {
    constexpr int kWidth = 30;
    const int filled = std::min(kWidth, static_cast<int>(seconds / duration * kWidth));
    fmt::print(stderr, "\r[{:#<{}}{:.<{}}] {:5.1f} s, {} answers ", "", filled, "", kWidth - filled, seconds, answers);
    std::fflush(stderr);
}

bool write_file(const std::string& name, const std::string& text) {
    std::ofstream file(name, std::ios::binary | std::ios::trunc);
    file << text;
    file.close();
    return file.good();
}

int load(Arguments& arguments) {
    if (const Status good = interpret(arguments); !good) return fail(good.error().text(), command_line::kWrongUsage);
    const auto path = client::read_camera_path(arguments.path);
    if (!path) return fail(path.error().text(), 1);

    std::signal(SIGINT, [](int) { stop_requested = true; });
    std::signal(SIGTERM, [](int) { stop_requested = true; });
    arguments.options.client.streamer.stop = &stop_requested;
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const auto outcome =
        client::run_load(arguments.options, *path, stop_requested, [&](double seconds, uint64_t answers) {
            if (terminal) show_progress(seconds, answers, arguments.options.duration_seconds);
        });
    if (terminal) fmt::print(stderr, "\n");

    if (!outcome.fetched_anything()) {
        const std::string why =
            outcome.measured.first_error.empty() ? "stopped before the first answer" : outcome.measured.first_error;
        return fail(fmt::format("nothing could be fetched from {}: {}", arguments.place, why), 1);
    }
    const std::string json = client::load_json(outcome, arguments.options);
    if (!arguments.stats.empty() && !write_file(arguments.stats, json))
        return fail("cannot write " + arguments.stats, 1);
    std::fputs(arguments.json ? json.c_str() : client::load_text(outcome, arguments.options).c_str(), stdout);
    if (!outcome.measured.first_error.empty()) {
        fmt::print(stderr, "citystream-load: some requests failed, the first: {}\n", outcome.measured.first_error);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    client::LoadOptions& options = arguments.options;
    CLI::App app{"Replays a recorded camera path as many independent clients and measures the server.",
                 "citystream-load"};
    app.footer(kExamples);
    app.set_version_flag("--version", std::string("citystream-load " CITYSTREAM_VERSION));
    app.add_option("URL", arguments.place,
                   "http://host:port[/city] (or a .3tz file or folder, to try without a server)")
        ->required();
    app.add_option("--path", arguments.path, "Camera path, CSV: t,x,y,z,yaw,pitch,fov")->required();
    app.add_option("--clients", options.clients, "Number of clients")
        ->required()
        ->check(command_line::number_from(1, 100'000));
    app.add_option("--duration", arguments.duration, "How long to fly")->capture_default_str();
    app.add_option("--ramp", arguments.ramp, "Clients begin spread over this time")->capture_default_str();
    app.add_option("--rate", options.updates_per_second, "Camera updates a second of each client")
        ->check(command_line::number_from(0.1, 240.0))
        ->capture_default_str();
    client::add_view_options(app, arguments.view);
    app.add_option("--light-tolerance", options.client.streamer.light_tolerance,
                   "Fetch radiance layers, too, up to this relative error of their light (default: none of them)")
        ->check(command_line::number_from(0.0, 1.0));
    app.add_option("--network", arguments.network, "Shape each client's link, as 5mbit,38ms");
    app.add_option("--connections", options.client.fetcher.connections, "Connections of each client")
        ->check(command_line::number_from(1, 64))
        ->capture_default_str();
    app.add_option("--seed", options.seed, "Decides where and when each client begins")->capture_default_str();
    app.add_option("--host-budget", arguments.host_budget, "Of each client")->capture_default_str();
    app.add_option("--gpu-budget", arguments.gpu_budget, "Of each client")->capture_default_str();
    app.add_option("--threads", options.threads, "Threads that drive clients; 0 is one per processor")
        ->check(command_line::number_from(0, 1024));
    app.add_option("--stats", arguments.stats, "Write the figures to this JSON file");
    app.add_flag("--json", arguments.json, "Print JSON instead of text");
    if (const auto ended = command_line::read_arguments(app, argc, argv)) return *ended;
    return load(arguments);
}
