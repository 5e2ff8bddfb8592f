#include "tests/bench/position_pictures.h"

#include <algorithm>

#include "client/render/vulkan_renderer.h"
#include "client/report/image_metrics.h"
#include "client/stream/city_streamer.h"
#include "client/stream/fetcher.h"
#include "tests/bench/measure.h"

namespace citystream::bench {

using namespace client;

namespace {

constexpr uint32_t kWidth = 1280, kHeight = 720, kSamplesASide = 2;
constexpr double kEqual = 99;  // decibels

}  // namespace

Result<PositionFlight> fly_with_positions(const std::string& archive, const Tour& tour, double tolerance,
                                          double position_tolerance) {
    RendererOptions rendering;
    rendering.width = kWidth;
    rendering.height = kHeight;
    rendering.supersample = kSamplesASide;
    auto renderer = VulkanRenderer::create(rendering);
    if (!renderer) return renderer.error();
    auto fetcher = Fetcher::open(archive, {});
    if (!fetcher) return fetcher.error();
    StreamerOptions streaming;
    streaming.tolerance_pixels = tolerance;
    streaming.position_tolerance_pixels = position_tolerance;
    auto streamer = CityStreamer::open(**fetcher, **renderer, streaming);
    if (!streamer) return streamer.error();
    PositionFlight flight;
    for (const CameraSample& sample : tour.path.samples) {
        const Camera camera = Camera::from_sample(sample, kWidth, kHeight);
        StreamerFrame frame;
        const std::vector<TileDraw>& tiles = (*streamer)->update(camera, frame);
        auto image = (*renderer)->draw(camera, tiles, nullptr);
        if (!image) return image.error();
        flight.wire_bytes += frame.wire_bytes;
        flight.frames.push_back(std::move(*image));
    }
    return flight;
}

PictureDifference difference_of(const PositionFlight& flight, const PositionFlight& reference) {
    std::vector<double> decibels;
    for (size_t i = 0; i < reference.frames.size(); ++i)
        decibels.push_back(std::min(psnr(reference.frames[i], flight.frames[i]), kEqual));
    const Spread spread = spread_of(decibels);
    return {spread.min, spread.median};
}

}  // namespace citystream::bench
