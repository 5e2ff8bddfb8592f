// Claim: a city of dressed facades is far smaller and far faster ray cast than as triangles (the paper's Table 3 beside
// ours).
#include <array>
#include <cmath>
#include <memory>

#include "client/reference/reference_renderer.h"
#include "client/render/vulkan_renderer.h"
#include "client/stream/city_streamer.h"
#include "codec/facade/facade_layer.h"
#include "codec/step_wire.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/sample_city.h"
#include "tiles/layers/build_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;
using namespace citystream::tiles;

constexpr const char* kClaim =
    "A city of detached boxes of six kinds, four or more facades each, dressed by the facade grammar, seen from "
    "above one of its corners. Drawn by our client\n"
    "(facade renderers patch and bcfdm, tolerance 1 pixel, the whole city streamed) and by the reference renderer (the "
    "same relief as instanced triangles).\n"
    "fps_to_triangles: ratio of frame times. memory_to_triangles: bytes of the reference's buffers and textures over "
    "ours; unshared_triangle_bytes: what they would\n"
    "be without instancing (36 bytes a vertex), as the paper counts. raw_map_bytes: D and M at 1 byte and A at 4 bytes "
    "a texel for every facade, as in the paper;\n"
    "compression: raw_map_bytes over the facade layers of all leaves and the dictionary, resident; our texels are 1 cm "
    "and the paper's "
    "facades 1.15 MB, which\n"
    "compression_at_paper_texels takes instead.";
constexpr std::array<std::array<uint32_t, 2>, 3> kSizes = {{{800, 600}, {1200, 900}, {1600, 1200}}};
constexpr double kPaperRawBytes = 1.15e6;  ///< a facade of the paper's city: 138 GB of 120,000
constexpr double kSpacing = 36;            ///< metres between the middles of neighbouring buildings

struct BoxKind {
    double width, depth, height;
};
constexpr std::array<BoxKind, 6> kKinds = {
    {{12, 10, 9.5}, {16, 12, 13}, {18, 14, 16.5}, {22, 14, 20}, {14, 14, 26}, {24, 18, 33}}};

city::CityObject box_building(uint32_t index, uint32_t columns) {
    const BoxKind& kind = kKinds[(index * 7 + index / columns * 3) % kKinds.size()];
    const double x = index % columns * kSpacing, y = index / columns * kSpacing;
    city::CityObject object;
    object.id = "box-" + std::to_string(index);
    object.kind = city::ObjectKind::kBuilding;
    for (const double z : {0.0, kind.height}) {
        for (const auto& [u, v] :
             {std::array{0.0, 0.0}, {kind.width, 0.0}, {kind.width, kind.depth}, {0.0, kind.depth}})
            object.vertices.push_back({x + u, y + v, z});
    }
    const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d, city::SurfaceKind surface) {
        for (const auto& corners : {std::array{a, b, c}, {a, c, d}})
            object.triangles.push_back({{corners[0], corners[1], corners[2]}, {}, 0, surface});
    };
    for (uint32_t i = 0; i < 4; ++i) quad(i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4, city::SurfaceKind::kWall);
    quad(4, 5, 6, 7, city::SurfaceKind::kRoof);
    return object;
}

layers::CitySource boxes(uint32_t count) {
    return [count](city::CityHeader& header, city::CityCatalog& catalog, city::CityReport& report,
                   const city::CitySink& sink) -> Status {
        header.title = "boxes";
        catalog.add_material({});
        const auto columns = static_cast<uint32_t>(std::ceil(std::sqrt(count)));
        for (uint32_t i = 0; i < count; ++i) {
            ++report.features_read;
            ++report.objects_emitted;
            ++report.buildings_emitted;
            if (!sink(box_building(i, columns))) break;
        }
        return Done{};
    };
}

/// From above the south-west corner over the whole city.
Camera camera_over(const SampleCity& city, uint32_t width, uint32_t height) {
    const auto& extent = city.manifest.extent;
    CameraSample sample{};
    sample.x = static_cast<double>(city.manifest.origin.x) / 1024 + extent.min[0] - 40;
    sample.y = static_cast<double>(city.manifest.origin.y) / 1024 + extent.min[1] - 40;
    sample.z = extent.max[2] + 60;
    sample.yaw = 45;
    sample.pitch = -12;
    sample.fov = 60;
    return Camera::from_sample(sample, width, height);
}

struct OurFrame {
    double milliseconds = 0;
    uint64_t gpu_bytes = 0, wire_bytes = 0, tiles = 0, relief_tiles = 0;
    std::string device;
};

Result<OurFrame> fly(const SampleCity& city, FacadeRenderer kind, const Camera& camera, int repetitions) {
    RendererOptions options;
    options.width = camera.width;
    options.height = camera.height;
    options.facade_renderer = kind;
    options.facade_samples = 1;  // as the triangles have
    options.gpu_budget_bytes = uint64_t{2} << 30;
    auto renderer = VulkanRenderer::create(options);
    if (!renderer) return renderer.error();
    auto fetcher = Fetcher::open(city.path, {});
    if (!fetcher) return fetcher.error();
    StreamerOptions streaming;
    streaming.facade_form = form_for(kind);
    streaming.facade_boxes = steps_through_boxes(kind);
    auto streamer = CityStreamer::open(**fetcher, **renderer, streaming);
    if (!streamer) return streamer.error();
    StreamerFrame frame;
    const std::vector<TileDraw>& tiles = (*streamer)->update(camera, frame);
    OurFrame result{
        0, frame.gpu_bytes_used, frame.wire_bytes, frame.tiles_drawn, frame.relief_tiles, (*renderer)->device_name()};
    std::vector<double> times;
    for (int i = -1; i < repetitions; ++i) {
        FrameTimings timings;
        const auto image = (*renderer)->draw(camera, tiles, &timings);
        if (!image) return image.error();
        if (i >= 0) times.push_back(timings.gpu_total_ms);
    }
    result.milliseconds = spread_of(times).median;
    return result;
}

struct TriangleFrame {
    double milliseconds = 0;
    uint64_t gpu_bytes = 0, triangles = 0;
};

Result<TriangleFrame> draw_triangles(const std::string& glb, const Camera& camera, int repetitions) {
    ReferenceOptions options;
    options.width = camera.width;
    options.height = camera.height;
    auto renderer = ReferenceRenderer::create(glb, options);
    if (!renderer) return renderer.error();
    std::vector<double> times;
    for (int i = 0; i < repetitions; ++i) {
        if (const auto image = (*renderer)->draw(camera); !image) return image.error();
        times.push_back((*renderer)->last_frame_ms());
    }
    return TriangleFrame{spread_of(times).median, (*renderer)->gpu_bytes(), (*renderer)->triangles_drawn()};
}

/// What the facades of all leaves are: the city as the paper counts it.
struct FacadeSums {
    uint64_t placements = 0, raw_bytes = 0, layer_bytes = 0, layer_wire = 0, dictionary_bytes = 0, dictionary_wire = 0;
};

/// Adds a leaf's placements, each with the uncompressed bytes of its map.
Status add_leaf(const SampleCity& city, const tileset::TileRecord& leaf, FacadeSums& sums) {
    const auto& steps = leaf.steps(tileset::Layer::kFacade);
    if (steps.empty()) return Done{};
    const auto bytes = city.layer_bytes(leaf, tileset::Layer::kFacade);
    const auto words = codec::decode_step(bytes, steps[0].decoded_bytes);
    if (!words) return words.error();
    const auto tile = codec::facade::decode_facades(*words, static_cast<uint32_t>(city.maps.size()), UINT32_MAX);
    if (!tile) return tile.error();
    for (const auto& placement : tile->placements) {
        const auto& map = city.maps[placement.map];
        sums.raw_bytes += uint64_t{6} * map.width * map.height;
    }
    sums.placements += tile->placements.size();
    sums.layer_bytes += words->size() * sizeof(uint32_t);
    sums.layer_wire += bytes.size();
    return Done{};
}

Result<FacadeSums> sum_facades(const SampleCity& city) {
    FacadeSums sums;
    for (const auto* leaf : city.leaves()) {
        if (Status status = add_leaf(city, *leaf, sums); !status) return status.error();
    }
    for (const auto& map : city.maps) {
        for (const auto& level : map.levels()) sums.dictionary_bytes += level.resident_bytes;
        sums.dictionary_wire = map.levels().back().end;
    }
    return sums;
}

double ratio(double a, double b) {
    return b > 0 ? rounded(a / b) : 0;
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_facade_city", kClaim, "", true});
    BenchOptions options;
    options.buildings = 3000;
    options.repetitions = 2;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const TemporaryFolder folder;
    layers::BuildOptions build;
    build.output = folder / "boxes.3tz";
    build.reference = folder / "boxes.glb";
    build.dress_seed = options.seed;
    city::CityReport report;
    const auto built = layers::build_city(build, boxes(options.buildings), report);
    if (!program.check(built.ok(), built.ok() ? "" : built.error().text())) return program.exit_code();
    const auto city = open_city(build.output);
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return program.exit_code();
    const auto summed = sum_facades(*city);
    if (!program.check(summed.ok(), summed.ok() ? "" : summed.error().text())) return program.exit_code();
    const FacadeSums& sums = *summed;
    program.print(
        {{"buildings", options.buildings},
         {"facades", sums.placements},
         {"facades_per_building", rounded(static_cast<double>(sums.placements) / options.buildings)},
         {"maps", city->maps.size()},
         {"raw_map_bytes", sums.raw_bytes},
         {"facade_resident_bytes", sums.layer_bytes + sums.dictionary_bytes},
         {"compression",
          ratio(static_cast<double>(sums.raw_bytes), static_cast<double>(sums.layer_bytes + sums.dictionary_bytes))},
         {"compression_at_paper_texels", ratio(kPaperRawBytes * static_cast<double>(sums.placements),
                                               static_cast<double>(sums.layer_bytes + sums.dictionary_bytes))},
         {"paper_compression", 85},
         {"archive_bytes_per_building", ratio(static_cast<double>(built->archive_bytes), options.buildings)},
         {"facade_wire_bytes_per_building",
          ratio(static_cast<double>(sums.layer_wire + sums.dictionary_wire), options.buildings)}});
    for (const auto& size : kSizes) {
        const Camera camera = camera_over(*city, size[0], size[1]);
        const auto triangles = draw_triangles(build.reference, camera, 1);
        if (!program.check(triangles.ok(), triangles.ok() ? "" : triangles.error().text())) return program.exit_code();
        for (const FacadeRenderer kind : {FacadeRenderer::kPatch, FacadeRenderer::kBcfdm}) {
            const auto ours = fly(*city, kind, camera, options.repetitions);
            if (!program.check(ours.ok(), ours.ok() ? "" : ours.error().text())) continue;
            const auto unshared = static_cast<double>(triangles->triangles) * 3 * 36;
            program.print({{"size", {size[0], size[1]}},
                           {"renderer", facade_renderer_name(kind)},
                           {"device", ours->device},
                           {"frame_ms", rounded(ours->milliseconds)},
                           {"triangles_ms", rounded(triangles->milliseconds)},
                           {"triangles", triangles->triangles},
                           {"fps_to_triangles", ratio(triangles->milliseconds, ours->milliseconds)},
                           {"gpu_bytes", ours->gpu_bytes},
                           {"triangles_gpu_bytes", triangles->gpu_bytes},
                           {"unshared_triangle_bytes", rounded(unshared)},
                           {"memory_to_triangles",
                            ratio(static_cast<double>(triangles->gpu_bytes), static_cast<double>(ours->gpu_bytes))},
                           {"memory_to_unshared", ratio(unshared, static_cast<double>(ours->gpu_bytes))},
                           {"wire_bytes", ours->wire_bytes},
                           {"wire_bytes_per_building", ratio(static_cast<double>(ours->wire_bytes), options.buildings)},
                           {"tiles", ours->tiles},
                           {"relief_tiles", ours->relief_tiles}});
        }
    }
    return program.exit_code();
}
