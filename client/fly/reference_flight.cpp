#include "client/fly/flight.h"
#include "client/fly/flown_path.h"
#include "client/reference/reference_renderer.h"

namespace citystream::client {

Status fly_reference(const FlyOptions& options, const CameraPath& path, const std::atomic<bool>& stop) {
    ReferenceOptions reference_options;
    reference_options.width = options.size.width;
    reference_options.height = options.size.height;
    reference_options.supersample = options.supersample;
    reference_options.facade_tint = options.tint;
    auto renderer = ReferenceRenderer::create(options.reference, reference_options);
    if (!renderer) return renderer.error();
    FlightStatistics statistics(describe_flight(options, (*renderer)->device_name()));
    const DrawFrame draw = [&](const Camera& camera, FlightFrame& frame) -> Result<std::optional<FlownFrame>> {
        auto image = (*renderer)->draw(camera);
        if (!image) return image.error();
        frame.timings.gpu_total_ms = (*renderer)->last_frame_ms();
        frame.stream.gpu_bytes_used = (*renderer)->gpu_bytes();
        return std::optional(FlownFrame{std::move(*image), "reference"});
    };
    if (Status flown = fly_path(options, path, false, stop, draw, statistics); !flown) return flown;
    FlightTotals totals;
    totals.stopped_early = stop;
    return conclude_flight(options, statistics, totals);
}

}  // namespace citystream::client
