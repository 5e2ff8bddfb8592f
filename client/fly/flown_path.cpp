#include "client/fly/flown_path.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "client/fly/frame_clock.h"
#include "client/fly/frame_output.h"
#include "client/select/selection.h"

namespace citystream::client {
namespace {

using Clock = std::chrono::steady_clock;

void show_progress(double done, const std::string& text) {
    static const bool terminal = ::isatty(STDERR_FILENO) != 0;
    if (!terminal) return;
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(done * kWidth);
    fmt::print(stderr, "\r[{:=<{}}{: <{}}] {:3.0f}% {}\x1b[K", "", filled, "", kWidth - filled, done * 100, text);
    if (done >= 1) fmt::print(stderr, "\n");
}

Status write_text(const std::string& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.close();
    if (!out) return Error{file + ": cannot write"};
    return Done{};
}

}  // namespace

void say(const std::string& line) {
    fmt::print(stderr, "citystream-fly: {}\n", line);
}

Status fly_path(const FlyOptions& options, const CameraPath& path, bool realtime, const std::atomic<bool>& stop,
                const DrawFrame& draw, FlightStatistics& statistics) {
    auto output = FrameOutput::open(options.frames_folder, options.video, options.size, options.fps);
    if (!output) return output.error();
    FrameClock clock(path, options.fps, realtime);
    for (uint64_t index = 0; !stop; ++index) {
        const std::optional<double> t = clock.next();
        if (!t || stop) break;
        FlightFrame frame;
        frame.index = index;
        frame.t = *t;
        const Clock::time_point begin = Clock::now();
        auto drawn = draw(Camera::from_sample(path.at(*t), options.size.width, options.size.height), frame);
        frame.total_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
        if (!drawn) return Error{fmt::format("frame {}: {}", index, drawn.error().text())};
        if (!*drawn) break;
        statistics.add(std::move(frame));
        Status added = (*output)->add(std::move((*drawn)->image));
        if (!added) return added;
        show_progress(clock.done(*t), (*drawn)->remark);
    }
    return (*output)->finish();
}

FlightDescription describe_flight(const FlyOptions& options, const std::string& device) {
    const ViewArguments& view = options.view;
    FlightDescription description;
    description.place = options.reference.empty() ? options.place : options.reference;
    description.path = options.path;
    description.mode = options.reference.empty() ? options.mode : "reference";
    description.device = device;
    description.network = options.network;
    description.width = options.size.width;
    description.height = options.size.height;
    description.tolerance_pixels = view.tolerance_pixels;
    description.relief_tolerance_pixels = view.relief_tolerance_pixels.value_or(view.tolerance_pixels);
    description.texel_tolerance_pixels = view.texel_tolerance_pixels.value_or(view.tolerance_pixels);
    description.position_tolerance_pixels =
        view.position_tolerance_pixels.value_or(kPositionShare * view.tolerance_pixels);
    description.map_level = view.map_level;
    description.facade_renderer = options.facade_renderer;
    description.facade_samples = options.facade_samples;
    description.chart_transport = options.chart_transport;
    description.facade_tint = options.facade_tint;
    if (options.light.asked_for()) {
        const TransferQuality quality = transfer_quality(options.light);
        description.environment = options.light.environment;
        description.environment_path = options.light.environment_path;
        description.light_tolerance = quality.light_tolerance;
        description.matrix = matrix_form_name(quality.matrix);
        description.matrix_error = quality.matrix_error;
        description.meso = options.has_meso();
    }
    description.occlusion = options.occlusion == "on" && options.mode == "offline";
    description.frames_per_second = options.fps;
    description.gpu_budget_bytes = options.gpu_bytes;
    description.host_budget_bytes = options.host_bytes;
    return description;
}

Status conclude_flight(const FlyOptions& options, const FlightStatistics& statistics, const FlightTotals& totals) {
    if (!options.stats.empty()) {
        if (Status written = write_text(options.stats, statistics.json(totals)); !written) return written;
    }
    if (options.json) fmt::print("{}", statistics.summary_json(totals));
    if (totals.stopped_early) say(fmt::format("stopped by a signal after {} frames", statistics.frames().size()));
    if (totals.validation_messages > 0) return Error{fmt::format("{} validation messages", totals.validation_messages)};
    return Done{};
}

}  // namespace citystream::client
