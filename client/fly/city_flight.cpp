#include <fmt/format.h>

#include "client/fly/flight.h"
#include "client/fly/flown_path.h"
#include "client/render/vulkan_renderer.h"
#include "client/stream/city_streamer.h"
#include "client/stream/fetcher.h"

namespace citystream::client {
namespace {

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

/// The light that a flight asks for, if any.
Result<std::optional<FlightLight>> load_light(const FlyOptions& options) {
    if (!options.light.asked_for()) return std::optional<FlightLight>();
    auto light = FlightLight::load(options.light);
    if (!light) return light.error();
    for (const std::string& warning : light->warnings()) say("warning: " + warning);
    return std::optional(std::move(*light));
}

/// Fits it to the city.
void prepare_light(const tiles::tileset::Manifest& manifest, FlightLight& light) {
    if (manifest.has_layer[static_cast<size_t>(tiles::tileset::Layer::kRadiance)]) {
        light.set_texels_across(manifest.radiance_texels_across);
    } else {
        say("warning: " + std::string(kNoRadianceLayer));
    }
}

/// One frame of the streamed city, within its budgets.
Result<std::optional<FlownFrame>> draw_city(const FlyOptions& options, CityStreamer& streamer, VulkanRenderer& renderer,
                                            std::optional<FlightLight>& light, const std::atomic<bool>& stop,
                                            const Camera& camera, FlightFrame& frame) {
    if (light) {
        const FrameLight& lit = light->at(frame.t, frame.lighting);
        const Status set = renderer.set_light(&lit);
        if (!set) return set.error();
        streamer.set_sun(lit.sun ? std::optional(lit.sun->direction) : std::nullopt);
    }
    const std::vector<TileDraw>& draws = streamer.update(camera, frame.stream);
    if (stop) return std::optional<FlownFrame>();
    renderer.set_casters(streamer.casters());
    auto image = renderer.draw(camera, draws, &frame.timings);
    if (!image) return image.error();
    frame.counts = renderer.counts();
    for (const std::string& warning : frame.stream.warnings) say("warning: " + warning);
    const Status budgets = check_budgets(options, frame.stream, renderer.gpu_bytes_allocated());
    if (!budgets) return budgets.error();
    return std::optional(FlownFrame{
        std::move(*image), fmt::format("{} tiles, {:.2f} px", frame.stream.tiles_drawn, frame.stream.tolerance_used)});
}

FlightTotals totals_of(const Fetcher& fetcher, const VulkanRenderer& renderer, bool stopped) {
    FlightTotals totals;
    totals.fetcher = fetcher.statistics();
    totals.frame_buffer_bytes = renderer.frame_buffer_bytes();
    totals.gpu_bytes_allocated = renderer.gpu_bytes_allocated();
    totals.validation_messages = renderer.validation_messages();
    totals.facade_pipeline = renderer.has_facade_pipeline();
    totals.radiance_pipeline = renderer.has_radiance_pipeline();
    totals.stopped_early = stopped;
    return totals;
}

}  // namespace

Status fly_city(const FlyOptions& options, const CameraPath& path, const std::atomic<bool>& stop) {
    auto light = load_light(options);
    if (!light) return light.error();
    FetcherOptions fetcher_options;
    fetcher_options.shape = options.shape;
    auto fetcher = Fetcher::open(options.place, fetcher_options);
    if (!fetcher) return fetcher.error();
    auto renderer = VulkanRenderer::create(renderer_options(options));
    if (!renderer) return renderer.error();
    StreamerOptions streaming = streamer_options(options);
    streaming.stop = &stop;
    auto streamer = CityStreamer::open(**fetcher, **renderer, streaming);
    if (!streamer) return streamer.error();
    if (*light) prepare_light((*streamer)->manifest(), **light);

    FlightStatistics statistics(describe_flight(options, (*renderer)->device_name()));
    const DrawFrame draw = [&](const Camera& camera, FlightFrame& frame) {
        return draw_city(options, **streamer, **renderer, *light, stop, camera, frame);
    };
    if (Status flown = fly_path(options, path, options.mode == "realtime", stop, draw, statistics); !flown)
        return flown;
    return conclude_flight(options, statistics, totals_of(**fetcher, **renderer, stop));
}

}  // namespace citystream::client
