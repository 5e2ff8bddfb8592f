// citystream-fly: flies a camera path over a city and leaves frames, a film and statistics. No display is needed.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <thread>

#include "client/light/light_options.h"
#include "client/path/camera_path.h"
#include "client/path/frame_size.h"
#include "client/reference/reference_renderer.h"
#include "client/render/facade_renderer.h"
#include "client/render/frame_file.h"
#include "client/render/video_writer.h"
#include "client/render/vulkan_renderer.h"
#include "client/select/relief_arguments.h"
#include "client/select/selection.h"
#include "client/stream/byte_count.h"
#include "client/stream/city_streamer.h"
#include "client/stream/fetcher.h"
#include "client/stream/flight_statistics.h"
#include "command_line/command_line.h"

namespace citystream::client {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<bool> stop_requested = false;

extern "C" void request_stop(int) {
    stop_requested = true;
}

constexpr uint64_t kBtfBytes = 64ull << 20;

struct FlyOptions {
    std::string place, path, frames_folder, video, stats,
        size = "1280x720", gpu_budget = "512MiB", index_arena = "64MiB", host_budget = "1GiB", mode = "offline",
        network, device, reference, facade_renderer{facade_renderer_name(FacadeRenderer::kPatch)}, map_level = "auto",
        occlusion = "on", chart_transport{chart_transport_name(ChartTransport::kTable)};
    double tolerance = 1, fps = 10;
    std::optional<double> relief_tolerance, texel_tolerance, position_tolerance;
    LightArguments light;
    std::optional<double> light_tolerance, matrix_error;
    std::string matrix, meso, btf_budget;
    std::string facade_tint = "0";
    uint32_t supersample = 1, facade_samples = kFacadeSamples;
    bool list_devices = false, validation = false, json = false;
    // Parsed:
    uint32_t width = 0, height = 0;
    uint64_t gpu_bytes = 0, index_arena_bytes = 0, host_bytes = 0, btf_bytes = kBtfBytes;
    std::optional<NetworkShape> shape;
    FacadeRenderer renderer = FacadeRenderer::kPatch;
    ChartTransport transport = ChartTransport::kTable;
    ReliefOptions relief;
    codec::atlas::FacadeTint tint;
};

constexpr double kLightTolerance = 0.05;
constexpr const char* kBiclusters = "biclusters";

bool has_meso(const FlyOptions& options) {
    return options.light.asked_for() && options.meso == "on";
}

std::vector<std::string> facade_renderer_names() {
    std::vector<std::string> names;
    names.reserve(kFacadeRenderers.size());
    for (const FacadeRenderer renderer : kFacadeRenderers) names.emplace_back(facade_renderer_name(renderer));
    return names;
}

int fail(const std::string& what, int code = command_line::kFailed) {
    fmt::print(stderr, "citystream-fly: {}\n", what);
    return code;
}

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

Status check_light_options(const FlyOptions& options) {
    const Status light = check_light_arguments(options.light);
    if (!light) return light.error();
    if (!options.light.asked_for()) {
        const char* without = options.light_tolerance       ? "--light-tolerance"
                              : !options.matrix.empty()     ? "--matrix"
                              : options.matrix_error        ? "--matrix-error"
                              : !options.meso.empty()       ? "--meso"
                              : !options.btf_budget.empty() ? "--btf-budget"
                                                            : nullptr;
        if (without != nullptr) return Error{fmt::format("{} needs --environment or --environment-path", without)};
    } else if (!options.reference.empty()) {
        return Error{"--reference draws without the light of an environment: leave one of the two out"};
    }
    return Done{};
}

Status parse_values(FlyOptions& options) {
    const auto size = parse_frame_size(options.size);
    if (!size) return Error{"--size: " + size.error().text()};
    options.width = size->width;
    options.height = size->height;
    const auto gpu = parse_byte_count(options.gpu_budget);
    if (!gpu) return Error{"--gpu-budget: " + gpu.error().text()};
    const auto arena = parse_byte_count(options.index_arena);
    if (!arena) return Error{"--index-arena: " + arena.error().text()};
    options.index_arena_bytes = *arena;
    const auto host = parse_byte_count(options.host_budget);
    if (!host) return Error{"--host-budget: " + host.error().text()};
    if (!options.btf_budget.empty()) {
        const auto btf = parse_byte_count(options.btf_budget);
        if (!btf) return Error{"--btf-budget: " + btf.error().text()};
        options.btf_bytes = *btf;
    }
    options.gpu_bytes = *gpu;
    options.host_bytes = *host;
    if (!options.network.empty()) {
        const auto shape = NetworkShape::parse(options.network);
        if (!shape) return shape.error();
        options.shape = *shape;
    }
    const auto renderer = facade_renderer_named(options.facade_renderer);
    if (!renderer) return Error{"--facade-renderer: there is no " + options.facade_renderer};
    options.renderer = *renderer;
    const auto tint = codec::atlas::parse_facade_tint(options.facade_tint);
    if (!tint) return Error{"--facade-tint: " + tint.error().text()};
    options.tint = *tint;
    const auto transport = chart_transport_named(options.chart_transport);
    if (!transport) return Error{"--chart-transport: there is no " + options.chart_transport};
    options.transport = *transport;
    const auto relief = parse_relief_options(options.map_level, options.relief_tolerance);
    if (!relief) return relief.error();
    options.relief = *relief;
    if (options.path.empty()) return Error{"--path PATH.csv is required"};
    const Status light = check_light_options(options);
    if (!light) return light.error();
    if (options.place.empty() && options.reference.empty()) return Error{"a URL, a .3tz file or a folder is required"};
    return Done{};
}

/// Files of finished frames, written on a thread of its own. Takes at most kMostWaiting frames ahead: memory stays
/// bounded.
class FrameOutput {
  public:
    FrameOutput(std::string folder, std::unique_ptr<VideoWriter> video)
        : folder_(std::move(folder)), video_(std::move(video)), thread_([this] { work(); }) {}
    ~FrameOutput() { (void)finish(); }
    FrameOutput(const FrameOutput&) = delete;
    FrameOutput& operator=(const FrameOutput&) = delete;

    Status add(FrameImage image) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return waiting_.size() < kMostWaiting || failed_; });
        if (failed_) return *failed_;
        waiting_.push_back(std::move(image));
        changed_.notify_all();
        return Done{};
    }
    Status finish() {
        if (thread_.joinable()) {
            {
                const std::lock_guard lock(mutex_);
                done_ = true;
            }
            changed_.notify_all();
            thread_.join();
            if (video_ && !failed_) {
                const Status finished = video_->finish();
                if (!finished) failed_ = finished.error();
            }
        }
        if (failed_) return *failed_;
        return Done{};
    }

  private:
    static constexpr size_t kMostWaiting = 3;

    void work() {
        for (uint64_t index = 0;; ++index) {
            FrameImage image;
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [&] { return !waiting_.empty() || done_; });
                if (waiting_.empty()) return;
                image = std::move(waiting_.front());
                waiting_.pop_front();
            }
            changed_.notify_all();
            const Status written = write(image, index);
            if (written) continue;
            const std::lock_guard lock(mutex_);
            failed_ = written.error();
            changed_.notify_all();
            return;
        }
    }
    Status write(const FrameImage& image, uint64_t index) {
        if (!folder_.empty()) {
            Status png = write_png(fmt::format("{}/frame_{:05}.png", folder_, index), image);
            if (!png) return png;
        }
        return video_ ? video_->add(image) : Status(Done{});
    }

    std::string folder_;
    std::unique_ptr<VideoWriter> video_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<FrameImage> waiting_;
    std::optional<Error> failed_;
    bool done_ = false;
    std::thread thread_;
};

Result<std::unique_ptr<FrameOutput>> open_output(const FlyOptions& options) {
    if (!options.frames_folder.empty()) {
        std::error_code failure;
        std::filesystem::create_directories(options.frames_folder, failure);
        if (failure) return Error{options.frames_folder + ": cannot make the folder: " + failure.message()};
    }
    std::unique_ptr<VideoWriter> video;
    if (!options.video.empty()) {
        const auto rate = static_cast<uint32_t>(std::max(1.0, std::round(options.fps)));
        auto created =
            VideoWriter::create(options.video, {options.width, options.height, rate, VideoOptions{}.quality});
        if (!created) return created.error();
        video = std::move(*created);
    }
    return std::make_unique<FrameOutput>(options.frames_folder, std::move(video));
}

/// Gives the time of each frame: a fixed step offline, the wall clock in realtime mode.
class FrameClock {
  public:
    FrameClock(const CameraPath& path, double fps, bool realtime)
        : begin_(path.samples.front().t), duration_(path.duration()), fps_(fps), realtime_(realtime) {}

    /// Waits for the next frame's moment in realtime mode. Nothing when the path is over.
    std::optional<double> next() {
        double t = static_cast<double>(index_) / fps_;
        if (realtime_) {
            if (index_ == 0) start_ = Clock::now();
            // A frame that took too long drops the moments it missed.
            const double now = std::chrono::duration<double>(Clock::now() - start_).count();
            index_ = std::max(index_, static_cast<uint64_t>(std::ceil(now * fps_ - 1e-9)));
            t = static_cast<double>(index_) / fps_;
            std::this_thread::sleep_until(
                start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(t)));
        }
        if (t > duration_ + 1e-9) return std::nullopt;
        ++index_;
        return begin_ + t;
    }
    double done(double t) const { return duration_ > 0 ? std::clamp((t - begin_) / duration_, 0.0, 1.0) : 1.0; }

  private:
    double begin_, duration_, fps_;
    bool realtime_;
    uint64_t index_ = 0;
    Clock::time_point start_;
};

void show_progress(double done, const std::string& text) {
    static const bool terminal = ::isatty(STDERR_FILENO) != 0;
    if (!terminal) return;
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(done * kWidth);
    fmt::print(stderr, "\r[{:=<{}}{: <{}}] {:3.0f}% {}\x1b[K", "", filled, "", kWidth - filled, done * 100, text);
    if (done >= 1) fmt::print(stderr, "\n");
}

/// The hard promise of every frame.
Status check_budgets(const FlyOptions& options, const StreamerFrame& frame, uint64_t gpu_allocated) {
    if (frame.gpu_bytes_used > options.gpu_bytes || gpu_allocated > options.gpu_bytes) {
        return Error{fmt::format("{} bytes of GPU memory used, over --gpu-budget {}",
                                 std::max(frame.gpu_bytes_used, gpu_allocated), options.gpu_budget)};
    }
    if (frame.host_bytes_used > options.host_bytes) {
        return Error{fmt::format("{} bytes of host memory used, over --host-budget {}", frame.host_bytes_used,
                                 options.host_budget)};
    }
    return Done{};
}

Status write_text(const std::string& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.close();
    if (!out) return Error{file + ": cannot write"};
    return Done{};
}

FlightDescription describe(const FlyOptions& options, const std::string& device) {
    FlightDescription description;
    description.place = options.reference.empty() ? options.place : options.reference;
    description.path = options.path;
    description.mode = options.reference.empty() ? options.mode : "reference";
    description.device = device;
    description.network = options.network;
    description.width = options.width;
    description.height = options.height;
    description.tolerance_pixels = options.tolerance;
    description.relief_tolerance_pixels = options.relief_tolerance.value_or(options.tolerance);
    description.texel_tolerance_pixels = options.texel_tolerance.value_or(options.tolerance);
    description.position_tolerance_pixels = options.position_tolerance.value_or(kPositionShare * options.tolerance);
    description.map_level = options.map_level;
    description.facade_renderer = options.facade_renderer;
    description.facade_samples = options.facade_samples;
    description.chart_transport = options.chart_transport;
    description.facade_tint = options.facade_tint;
    if (options.light.asked_for()) {
        description.environment = options.light.environment;
        description.environment_path = options.light.environment_path;
        description.light_tolerance = options.light_tolerance.value_or(kLightTolerance);
        description.matrix = options.matrix.empty() ? kBiclusters : options.matrix;
        description.matrix_error = options.matrix_error.value_or(0);
        description.meso = has_meso(options);
    }
    description.occlusion = options.occlusion == "on" && options.mode == "offline";
    description.frames_per_second = options.fps;
    description.gpu_budget_bytes = options.gpu_bytes;
    description.host_budget_bytes = options.host_bytes;
    return description;
}

/// What is left to do when a path was flown; the exit code.
int conclude(const FlyOptions& options, const FlightStatistics& statistics, const FlightTotals& totals) {
    if (!options.stats.empty()) {
        const Status written = write_text(options.stats, statistics.json(totals));
        if (!written) return fail(written.error().text());
    }
    if (options.json) fmt::print("{}", statistics.summary_json(totals));
    if (totals.stopped_early) {
        fmt::print(stderr, "citystream-fly: stopped by a signal after {} frames\n", statistics.frames().size());
    }
    if (totals.validation_messages > 0) return fail(fmt::format("{} validation messages", totals.validation_messages));
    return 0;
}

/// A frame, and what is worth saying of it.
struct DrawnFrame {
    FrameImage image;
    std::string remark;
};
/// Draws what a camera sees and fills what it took. Nothing when the flight was stopped meanwhile.
using DrawFrame = std::function<Result<std::optional<DrawnFrame>>(const Camera& camera, FlightFrame& frame)>;

/// Draws the path frame by frame and puts the frames out.
Status fly_path(const FlyOptions& options, const CameraPath& path, bool realtime, const DrawFrame& draw,
                FlightStatistics& statistics) {
    auto output = open_output(options);
    if (!output) return output.error();
    FrameClock clock(path, options.fps, realtime);
    for (uint64_t index = 0; !stop_requested; ++index) {
        const std::optional<double> t = clock.next();
        if (!t || stop_requested) break;
        FlightFrame frame;
        frame.index = index;
        frame.t = *t;
        const Clock::time_point begin = Clock::now();
        auto drawn = draw(Camera::from_sample(path.at(*t), options.width, options.height), frame);
        frame.total_ms = milliseconds_since(begin);
        if (!drawn) return Error{fmt::format("frame {}: {}", index, drawn.error().text())};
        if (!*drawn) break;
        statistics.add(std::move(frame));
        Status added = (*output)->add(std::move((*drawn)->image));
        if (!added) return added;
        show_progress(clock.done(*t), (*drawn)->remark);
    }
    return (*output)->finish();
}

RendererOptions renderer_options(const FlyOptions& options) {
    RendererOptions renderer;
    renderer.width = options.width;
    renderer.height = options.height;
    renderer.gpu_budget_bytes = options.gpu_bytes;
    renderer.index_arena_bytes = options.index_arena_bytes;
    renderer.device = options.device;
    renderer.supersample = options.supersample;
    renderer.validation = options.validation;
    renderer.facade_renderer = options.renderer;
    renderer.facade_samples = options.facade_samples;
    renderer.chart_transport = options.transport;
    renderer.facade_tint = options.tint;
    renderer.meso = has_meso(options);
    renderer.btf_budget_bytes = options.btf_bytes;
    return renderer;
}

StreamerOptions streamer_options(const FlyOptions& options) {
    StreamerOptions streamer;
    streamer.tolerance_pixels = options.tolerance;
    streamer.texel_tolerance_pixels = options.texel_tolerance;
    streamer.position_tolerance_pixels = options.position_tolerance;
    streamer.host_budget_bytes = options.host_bytes;
    streamer.wait_for_selection = options.mode == "offline";
    streamer.relief = options.relief;
    streamer.occlusion = options.occlusion == "on";
    streamer.facade_form = form_for(options.renderer);
    streamer.facade_boxes = steps_through_boxes(options.renderer);
    streamer.stop = &stop_requested;
    if (options.light.asked_for()) streamer.light_tolerance = options.light_tolerance.value_or(kLightTolerance);
    if (options.matrix == "rows") streamer.matrix_form = codec::radiance::MatrixForm::kRows;
    streamer.matrix_error = options.matrix_error.value_or(0);
    return streamer;
}

/// The light that a flight asks for, if any.
Result<std::optional<FlightLight>> load_light(const FlyOptions& options) {
    if (!options.light.asked_for()) return std::optional<FlightLight>();
    auto light = FlightLight::load(options.light);
    if (!light) return light.error();
    for (const std::string& warning : light->warnings()) fmt::print(stderr, "citystream-fly: warning: {}\n", warning);
    return std::optional(std::move(*light));
}

/// Fits it to the city.
void prepare_light(const tiles::tileset::Manifest& manifest, FlightLight& light) {
    if (manifest.has_layer[static_cast<size_t>(tiles::tileset::Layer::kRadiance)]) {
        light.set_texels_across(manifest.radiance_texels_across);
    } else {
        fmt::print(stderr,
                   "citystream-fly: warning: this city has no radiance layer (citystream-build --layers ...,radiance): "
                   "the sky lights it without shadows\n");
    }
}

/// One frame of the streamed city, within its budgets.
Result<std::optional<DrawnFrame>> draw_city(const FlyOptions& options, CityStreamer& streamer, VulkanRenderer& renderer,
                                            std::optional<FlightLight>& light, const Camera& camera,
                                            FlightFrame& frame) {
    if (light) {
        const FrameLight& lit = light->at(frame.t, frame.lighting);
        const Status set = renderer.set_light(&lit);
        if (!set) return set.error();
        streamer.set_sun(lit.sun ? std::optional(lit.sun->direction) : std::nullopt);
    }
    const std::vector<TileDraw>& draws = streamer.update(camera, frame.stream);
    if (stop_requested) return std::optional<DrawnFrame>();
    renderer.set_casters(streamer.casters());
    auto image = renderer.draw(camera, draws, &frame.timings);
    if (!image) return image.error();
    frame.counts = renderer.counts();
    for (const std::string& warning : frame.stream.warnings) {
        fmt::print(stderr, "citystream-fly: warning: {}\n", warning);
    }
    const Status budgets = check_budgets(options, frame.stream, renderer.gpu_bytes_allocated());
    if (!budgets) return budgets.error();
    return std::optional(DrawnFrame{
        std::move(*image), fmt::format("{} tiles, {:.2f} px", frame.stream.tiles_drawn, frame.stream.tolerance_used)});
}

/// The city through the streamer and the Vulkan renderer.
int fly_city(const FlyOptions& options, const CameraPath& path) {
    auto light = load_light(options);
    if (!light) return fail(light.error().text());
    FetcherOptions fetcher_options;
    fetcher_options.shape = options.shape;
    auto fetcher = Fetcher::open(options.place, fetcher_options);
    if (!fetcher) return fail(fetcher.error().text());
    auto renderer = VulkanRenderer::create(renderer_options(options));
    if (!renderer) return fail(renderer.error().text());
    auto streamer = CityStreamer::open(**fetcher, **renderer, streamer_options(options));
    if (!streamer) return fail(streamer.error().text());
    if (*light) prepare_light((*streamer)->manifest(), **light);

    FlightStatistics statistics(describe(options, (*renderer)->device_name()));
    const DrawFrame draw = [&](const Camera& camera, FlightFrame& frame) {
        return draw_city(options, **streamer, **renderer, *light, camera, frame);
    };
    const Status flown = fly_path(options, path, options.mode == "realtime", draw, statistics);
    if (!flown) return fail(flown.error().text());
    FlightTotals totals;
    totals.fetcher = (*fetcher)->statistics();
    totals.frame_buffer_bytes = (*renderer)->frame_buffer_bytes();
    totals.gpu_bytes_allocated = (*renderer)->gpu_bytes_allocated();
    totals.validation_messages = (*renderer)->validation_messages();
    totals.facade_pipeline = (*renderer)->has_facade_pipeline();
    totals.radiance_pipeline = (*renderer)->has_radiance_pipeline();
    totals.stopped_early = stop_requested;
    return conclude(options, statistics, totals);
}

/// The uncompressed city through the reference renderer.
int fly_reference(const FlyOptions& options, const CameraPath& path) {
    ReferenceOptions reference_options;
    reference_options.width = options.width;
    reference_options.height = options.height;
    reference_options.supersample = options.supersample;
    reference_options.facade_tint = options.tint;
    auto renderer = ReferenceRenderer::create(options.reference, reference_options);
    if (!renderer) return fail(renderer.error().text());
    FlightStatistics statistics(describe(options, (*renderer)->device_name()));
    const DrawFrame draw = [&](const Camera& camera, FlightFrame& frame) -> Result<std::optional<DrawnFrame>> {
        auto image = (*renderer)->draw(camera);
        if (!image) return image.error();
        frame.timings.gpu_total_ms = (*renderer)->last_frame_ms();
        frame.stream.gpu_bytes_used = (*renderer)->gpu_bytes();
        return std::optional(DrawnFrame{std::move(*image), "reference"});
    };
    const Status flown = fly_path(options, path, false, draw, statistics);
    if (!flown) return fail(flown.error().text());
    FlightTotals totals;
    totals.stopped_early = stop_requested;
    return conclude(options, statistics, totals);
}

constexpr const char* kExamples = R"(Examples:
  citystream-fly http://localhost:8080 --path tour.csv --frames out/
  citystream-fly city.3tz --path tour.csv --video tour.mp4 --stats tour.json --tolerance 2
  citystream-fly city.3tz --path tour.csv --gpu-budget 64MiB --host-budget 128MiB --json
  citystream-fly http://localhost:8080/city --path tour.csv --mode realtime --network 5mbit,38ms
  citystream-fly city.3tz --path tour.csv --environment sky --hour 18.5 --frames evening/
  citystream-fly city.3tz --path tour.csv --environment-path day.csv --video day.mp4
  citystream-fly --reference city.glb --path tour.csv --frames reference/)";

/// What is flown and what comes of it.
void add_flight_options(CLI::App& app, FlyOptions& options) {
    app.add_option("place", options.place, "http://host:port[/city], a .3tz archive, or an unpacked folder");
    app.add_option("--path", options.path, "camera path: CSV with the columns t,x,y,z,yaw,pitch,fov");
    app.add_option("--reference", options.reference,
                   "draw this uncompressed city (.glb) with the reference renderer instead");
    app.add_option("--mode", options.mode,
                   "offline: each frame waits for all it asked for; realtime: draws what is there")
        ->capture_default_str()
        ->check(CLI::IsMember({"offline", "realtime"}));
    app.add_option("--fps", options.fps, "frames per second of the path")
        ->capture_default_str()
        ->check(command_line::number_from(0.001, 1000.0));
    app.add_option("--network", options.network, "shape the network: RATE,ROUNDTRIP, for example 5mbit,38ms");
    app.add_option("--frames", options.frames_folder, "folder for the frames (PNG)");
    app.add_option("--video", options.video, "film of the frames (MP4)");
    app.add_option("--stats", options.stats, "statistics of every frame (JSON)");
    app.add_option("--size", options.size, "frame size in pixels")->capture_default_str();
    app.add_flag("--json", options.json, "print the summary as JSON");
}

/// How exactly the city is shown.
void add_quality_options(CLI::App& app, FlyOptions& options) {
    app.add_option("--tolerance", options.tolerance, "largest error in pixels")
        ->capture_default_str()
        ->check(command_line::number_from(0.01, 1e6));
    app.add_option("--relief-tolerance", options.relief_tolerance,
                   "facade relief that projects to fewer pixels is drawn flat (default: --tolerance)")
        ->check(command_line::number_from(0.01, 1e6));
    app.add_option("--texel-tolerance", options.texel_tolerance,
                   "largest size of a texel in pixels, of pictures that are not shown as fine as they are (default: "
                   "--tolerance)")
        ->check(command_line::number_from(0.01, 1e6));
    app.add_option("--position-tolerance", options.position_tolerance,
                   "pixels that a vertex may be off its place, for want of low bits of its position (default: a "
                   "thirty-second of --tolerance)")
        ->check(command_line::number_from(0.01, 1000.0));
    app.add_option("--occlusion", options.occlusion,
                   "on: what near surfaces hide is neither fetched nor drawn (offline mode)")
        ->capture_default_str()
        ->check(CLI::IsMember({"on", "off"}));
    app.add_option("--supersample", options.supersample, "samples per pixel and axis")
        ->capture_default_str()
        ->check(command_line::number_from(1, 2));
}

/// How facades and pictures are drawn.
void add_drawing_options(CLI::App& app, FlyOptions& options) {
    app.add_option("--map-level", options.map_level,
                   "level of every facade map, 0 the coarsest; auto: as coarse as --tolerance lets it be")
        ->capture_default_str()
        ->check(CLI::IsMember(map_level_names()));
    app.add_option("--facade-renderer", options.facade_renderer, "how relief is ray cast")
        ->capture_default_str()
        ->check(CLI::IsMember(facade_renderer_names()));
    app.add_option("--facade-samples", options.facade_samples,
                   "rays of a pixel that covers more than the finest parts of its facade: 5 and 13 keep far windows "
                   "from shimmering")
        ->capture_default_str()
        ->check(CLI::IsMember(facade_sample_names()));
    app.add_option("--facade-tint", options.facade_tint,
                   "STRENGTH[,METRES]: multiplies walls by a colour that changes over the city, 0 to 1, the next one "
                   "every METRES (40); the reference renderer does the same")
        ->capture_default_str();
    app.add_option("--chart-transport", options.chart_transport,
                   "how a triangle's chart in a page comes to the vertex shader (archives of --atlas-form pages): same "
                   "frames, other memory and time")
        ->capture_default_str()
        ->check(CLI::IsMember(chart_transport_names()));
}

/// What lights it (archives of --layers ...,radiance).
void add_light_options(CLI::App& app, FlyOptions& options) {
    add_environment_options(app, options.light);
    app.add_option("--light-tolerance", options.light_tolerance,
                   "part of an even sky's light that a place may get wrong (0.05)")
        ->check(command_line::number_from(0.0, 1.0));
    app.add_option("--matrix", options.matrix,
                   "how what is seen from where is kept in GPU memory: biclusters or rows; same frames, other memory "
                   "and time (biclusters)")
        ->check(CLI::IsMember({kBiclusters, "rows"}));
    app.add_option("--matrix-error", options.matrix_error,
                   "part of an even sky's light by which each row of it may be too low, for less memory and time (0)")
        ->check(command_line::number_from(0.0, 1.0));
    app.add_option("--meso", options.meso,
                   "on: relief of facades shades itself, near by masks, further away by BTFs, where walls have 8 x 8 "
                   "local directions (seconds a map on software drivers); off: it stands free (off)")
        ->check(CLI::IsMember({"on", "off"}));
    app.add_option("--btf-budget", options.btf_budget, "memory for BTFs, taken when the first is made (64MiB)");
}

/// What the machine has for it.
void add_machine_options(CLI::App& app, FlyOptions& options) {
    app.add_option("--gpu-budget", options.gpu_budget, "most GPU memory for tiles")->capture_default_str();
    app.add_option(
           "--index-arena", options.index_arena,
           "GPU memory beside the budget for decoded strip code (archives of --mesh-topology strip-code); a frame "
           "that needs more is drawn in rounds")
        ->capture_default_str();
    app.add_option("--host-budget", options.host_budget, "most host memory for tiles")->capture_default_str();
    app.add_option("--device", options.device, "part of a device's name, or its index");
    app.add_flag("--list-devices", options.list_devices, "list the devices and exit");
    app.add_flag("--validation", options.validation, "run with the Vulkan validation layer; messages fail the flight");
}

int run(int argc, char** argv) {
    CLI::App app{"Flies a camera path over a streamed city, without a display."};
    FlyOptions options;
    add_flight_options(app, options);
    add_quality_options(app, options);
    add_drawing_options(app, options);
    add_light_options(app, options);
    add_machine_options(app, options);
    app.set_version_flag("--version", std::string("citystream-fly ") + CITYSTREAM_VERSION);
    app.footer(kExamples);
    if (const auto ended = command_line::read_arguments(app, argc, argv)) return *ended;
    if (options.list_devices) {
        for (const std::string& line : list_devices()) fmt::print("{}\n", line);
        return 0;
    }
    const Status parsed = parse_values(options);
    if (!parsed) return fail(parsed.error().text(), command_line::kWrongUsage);
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    const auto path = read_camera_path(options.path);
    if (!path) return fail(path.error().text());
    return options.reference.empty() ? fly_city(options, *path) : fly_reference(options, *path);
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
