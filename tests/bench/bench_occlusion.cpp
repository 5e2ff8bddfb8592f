// Claim: leaving out what near surfaces hide moves and draws far less in streets, costs little elsewhere, and changes
// no picture.
#include <array>
#include <memory>

#include "client/render/vulkan_renderer.h"
#include "client/stream/city_streamer.h"
#include "client/stream/fetcher.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/camera_tours.h"
#include "tests/bench/sample_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;

constexpr const char* kClaim =
    "Flights through a city (street, roof, high) with and without occlusion, 1280 x 720, 1 pixel, each from an empty "
    "cache: bytes received\n"
    "(first frame, whole flight), tiles and triangles drawn in a frame, GPU memory, milliseconds of choosing and of "
    "drawing in a frame (medians,\n"
    "a software device draws on all cores). *_ratio: without over with. differing_pixels: of all frames (any channel "
    "at all).\n"
    "FILEs are cities or .3tz archives.";
constexpr uint32_t kWidth = 1280, kHeight = 720;

struct Flight {
    uint64_t first_bytes = 0, bytes = 0, gpu_bytes = 0, requests = 0;
    std::vector<double> tiles, triangles, select_ms, draw_ms;
    std::vector<FrameImage> frames;
    std::string failure;
};

uint64_t triangles_of(const std::vector<TileDraw>& tiles) {
    uint64_t sum = 0;
    for (const TileDraw& tile : tiles) {
        for (const auto& range : tile.mesh_ranges)
            sum += tile.facade == kNoLayer || !range.dressed ? range.triangles : 0;
    }
    return sum;
}

Flight fly(const SampleCity& city, const Tour& tour, bool occlusion) {
    Flight flight;
    RendererOptions rendering;
    rendering.width = kWidth;
    rendering.height = kHeight;
    rendering.gpu_budget_bytes = uint64_t{1} << 30;
    auto renderer = VulkanRenderer::create(rendering);
    auto fetcher = Fetcher::open(city.path, {});
    flight.failure = !renderer ? renderer.error().text() : !fetcher ? fetcher.error().text() : "";
    if (!flight.failure.empty()) return flight;
    StreamerOptions streaming;
    streaming.occlusion = occlusion;
    auto streamer = CityStreamer::open(**fetcher, **renderer, streaming);
    if (!streamer) {
        flight.failure = streamer.error().text();
        return flight;
    }
    for (const CameraSample& sample : tour.path.samples) {
        const Camera camera = Camera::from_sample(sample, kWidth, kHeight);
        StreamerFrame frame;
        const std::vector<TileDraw>& tiles = (*streamer)->update(camera, frame);
        FrameTimings timings;
        auto image = (*renderer)->draw(camera, tiles, &timings);
        if (!image) {
            flight.failure = image.error().text();
            return flight;
        }
        if (flight.frames.empty()) flight.first_bytes = frame.wire_bytes;
        flight.bytes += frame.wire_bytes;
        flight.requests += frame.requests;
        flight.gpu_bytes = std::max(flight.gpu_bytes, frame.gpu_bytes_used);
        flight.tiles.push_back(static_cast<double>(tiles.size()));
        flight.triangles.push_back(static_cast<double>(triangles_of(tiles)));
        flight.select_ms.push_back(frame.select_ms);
        flight.draw_ms.push_back(timings.gpu_total_ms);
        flight.frames.push_back(std::move(*image));
    }
    return flight;
}

double differing_pixels(const Flight& a, const Flight& b) {
    uint64_t differing = 0, all = 0;
    for (size_t i = 0; i < a.frames.size(); ++i) {
        const auto& one = a.frames[i].rgba;
        const auto& other = b.frames[i].rgba;
        for (size_t p = 0; p < one.size(); p += 4) differing += std::equal(&one[p], &one[p] + 3, &other[p]) ? 0 : 1;
        all += one.size() / 4;
    }
    return static_cast<double>(differing) / static_cast<double>(std::max<uint64_t>(all, 1));
}

double ratio(double without, double with) {
    return with > 0 ? rounded(without / with) : 0;
}

void measure_tour(const std::string& name, const SampleCity& city, const Tour& tour, BenchProgram& program) {
    const Flight with = fly(city, tour, true), without = fly(city, tour, false);
    for (const Flight* flight : {&with, &without}) {
        if (!program.check(flight->failure.empty(), name + ", " + tour.name + ": " + flight->failure)) return;
    }
    const auto median = [](const std::vector<double>& values) { return spread_of(values).median; };
    program.print(
        {{"city", name},
         {"tour", tour.name},
         {"cameras", tour.path.samples.size()},
         {"first_frame_bytes", with.first_bytes},
         {"first_frame_bytes_ratio",
          ratio(static_cast<double>(without.first_bytes), static_cast<double>(with.first_bytes))},
         {"received_bytes", with.bytes},
         {"received_bytes_ratio", ratio(static_cast<double>(without.bytes), static_cast<double>(with.bytes))},
         {"requests", with.requests},
         {"gpu_bytes", with.gpu_bytes},
         {"gpu_bytes_ratio", ratio(static_cast<double>(without.gpu_bytes), static_cast<double>(with.gpu_bytes))},
         {"tiles", to_json(spread_of(with.tiles))},
         {"tiles_ratio", ratio(median(without.tiles), median(with.tiles))},
         {"triangles", to_json(spread_of(with.triangles))},
         {"triangles_ratio", ratio(median(without.triangles), median(with.triangles))},
         {"select_ms", rounded(median(with.select_ms))},
         {"select_ms_without", rounded(median(without.select_ms))},
         {"draw_ms", rounded(median(with.draw_ms))},
         {"draw_ms_ratio", ratio(median(without.draw_ms), median(with.draw_ms))},
         {"differing_pixels", differing_pixels(with, without)}});
    program.check(differing_pixels(with, without) < 1e-5, tour.name + ": the pictures are the same");
}

void measure_city(const std::string& name, const Result<SampleCity>& city, BenchProgram& program) {
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return;
    for (const Tour& tour : tours_of(*city)) measure_tour(name, *city, tour, program);
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_occlusion", kClaim, "city.3tz"});
    BenchOptions options;
    options.buildings = 3000;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const TemporaryFolder folder;
    if (options.files.empty()) {
        const std::string archive = folder / "generated.3tz";
        const Status built = build_generated(options.buildings, options.seed, kAllLayers, archive);
        if (program.check(built.ok(), built.ok() ? "" : built.error().text()))
            measure_city("generated:" + std::to_string(options.buildings), open_city(archive), program);
    }
    for (const auto& file : options.files)
        measure_city(std::filesystem::path(file).filename().string(), city_of_file(file, kAllLayers, folder), program);
    return program.exit_code();
}
