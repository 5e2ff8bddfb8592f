// Claim: drawing from packed meshes costs little against what a renderer without codecs draws, and takes a fraction of
// its memory.
#include <malloc.h>
#include <time.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "client/render/vulkan_renderer.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_triangles.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/sample_city.h"
#include "tests/bench/unpacked_viewer.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;
using codec::mesh::MeshTopology;

constexpr const char* kClaim =
    "Frames of all finest tiles of a city from above, without images, as vertex attributes (unpacked) and from our\n"
    "layers with each topology; \"prisms\", \"surface\": of the layers with indices these ranges alone. A frame's "
    "time\n"
    "is processor time on a software device, the GPU's time of the mesh pass else. time_ratio: over unpacked, pairs "
    "of\n"
    "the same repetition. strip-code-cached: decoded corners stay; strip-code-rounds: memory for a tenth of them,\n"
    "or for the largest range if that is more, so that most are decoded in every frame. resident_bytes: layers, or "
    "vertices and indices; arena_bytes: "
    "decoded\n"
    "corners beside them; make_ms: processor time of making the words when tiles arrive. differing: share of the "
    "picture's bytes that differ by more than 2 from unpacked.\n"
    "FILEs are cities or .3tz archives.";
constexpr const char* kBaseline = "unpacked";

double process_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

// Freed memory stays in the process: a software driver allocates for every frame, and what it gives back it asks for
// anew, or not, by where the heap happens to end: a third of a frame's time for one case and not for another.
bool keep_freed_memory() {
    return mallopt(M_ARENA_MAX, 1) == 1 && mallopt(M_TRIM_THRESHOLD, 1 << 30) == 1 &&
           mallopt(M_MMAP_THRESHOLD, 32 << 20) == 1;
}

/// The finest tiles of a city.
struct CityMeshes {
    std::vector<std::array<double, 3>> origins;
    std::vector<codec::mesh::MeshContent> contents;
    std::array<double, 3> low{}, high{};
};

Result<CityMeshes> read_meshes(const SampleCity& city) {
    CityMeshes meshes;
    const auto& extent = city.manifest.extent;
    for (size_t c = 0; c < 3; ++c) {
        const double origin = c == 0   ? to_metres(city.manifest.origin.x)
                              : c == 1 ? to_metres(city.manifest.origin.y)
                                       : 0;
        meshes.low[c] = extent.min[c] + origin;
        meshes.high[c] = extent.max[c] + origin;
    }
    for (const tiles::tileset::TileRecord* tile : city.leaves()) {
        const auto bytes = city.layer_bytes(*tile, tiles::tileset::Layer::kMesh);
        std::vector<std::span<const std::byte>> wire;
        uint64_t begin = 0, decoded = 0;
        for (const auto& step : tile->steps(tiles::tileset::Layer::kMesh)) {
            wire.push_back(bytes.subspan(begin, step.end - begin));
            begin = step.end;
            decoded += step.decoded_bytes;
        }
        if (wire.empty()) continue;
        auto content = codec::mesh::decode_mesh_content(wire, decoded, codec::mesh::kAnyMeshChart);
        if (!content) return content.error();
        const GridPoint origin = city.manifest.tile_origin(*tile);
        meshes.origins.push_back({to_metres(origin.x), to_metres(origin.y), to_metres(origin.z)});
        meshes.contents.push_back(std::move(*content));
    }
    return meshes;
}

Camera overview(const CityMeshes& city, uint32_t width, uint32_t height) {
    const double reach = std::max(city.high[0] - city.low[0], city.high[1] - city.low[1]);
    CameraSample sample;
    sample.x = (city.low[0] + city.high[0]) / 2;
    sample.y = (city.low[1] + city.high[1]) / 2 - reach * 0.55;
    sample.z = city.low[2] + reach * 1.1;
    sample.pitch = -std::atan2(1.1, 0.55) * 180 / std::numbers::pi;
    return Camera::from_sample(sample, width, height);
}

enum class Shown { kAll, kPrisms, kSurface };

/// Our renderer with all tiles in it.
struct PackedCity {
    std::unique_ptr<VulkanRenderer> renderer;
    std::vector<TileDraw> tiles;
    uint64_t resident_bytes = 0, triangles = 0, strip_triangles = 0, largest_strips = 0;
    double make_seconds = 0;  ///< of words from contents, once
};

void leave_out(TileDraw& tile, Shown shown) {
    for (codec::mesh::MeshRange& range : tile.mesh_ranges) {
        const bool is_prisms = range.kind == RESIDENT_KIND_PRISMS;
        if (shown != Shown::kAll && is_prisms != (shown == Shown::kPrisms)) range.triangles = 0;
    }
}

Result<PackedCity> pack(const CityMeshes& city, const Camera& camera, MeshTopology topology, Shown shown,
                        uint64_t arena_bytes) {
    RendererOptions options;
    options.width = camera.width;
    options.height = camera.height;
    options.gpu_budget_bytes = uint64_t{1} << 30;
    options.index_arena_bytes = arena_bytes;
    auto renderer = VulkanRenderer::create(options);
    if (!renderer) return renderer.error();
    PackedCity packed{std::move(*renderer), {}, 0, 0, 0, 0, 0};
    for (size_t i = 0; i < city.contents.size(); ++i) {
        codec::mesh::MeshContent content = city.contents[i];
        content.topology = topology;
        const double before = process_seconds();
        const codec::mesh::ResidentMesh resident = codec::mesh::make_resident(content);
        packed.make_seconds += process_seconds() - before;
        const auto steps = static_cast<uint32_t>(content.dropped.size());
        const std::vector<uint32_t> words = resident.with_steps(steps);
        TileDraw tile;
        tile.origin = city.origins[i];
        tile.mesh = packed.renderer->create();
        tile.mesh_steps = steps;
        tile.mesh_ranges = resident.ranges;
        leave_out(tile, shown);
        if (const Status status = packed.renderer->append(tile.mesh, words); !status) return status.error();
        packed.resident_bytes += 4 * words.size();
        for (const auto& range : tile.mesh_ranges) {
            packed.triangles += range.triangles;
            if (range.kind != RESIDENT_KIND_STRIP_CODE) continue;
            packed.strip_triangles += range.triangles;
            packed.largest_strips = std::max<uint64_t>(packed.largest_strips, range.triangles);
        }
        packed.tiles.push_back(std::move(tile));
    }
    return packed;
}

class FrameBench {
  public:
    FrameBench(const CityMeshes& city, const Camera& camera, BenchProgram& program)
        : city_(city), camera_(camera), program_(program) {}

    /// False: the program has failed.
    bool add_cases() {
        if (!add_unpacked()) return false;
        add_packed("indices", MeshTopology::kIndices, Shown::kAll, kWholeArena);
        add_packed("local-strips", MeshTopology::kLocalStrips, Shown::kAll, kWholeArena);
        const uint64_t strips = add_packed("strip-code-cached", MeshTopology::kStripCode, Shown::kAll, kWholeArena);
        const uint64_t tenth = std::max(strips / 10, largest_strips_) * 12 / 3 * 4;  // a quarter is for decoding
        if (strips > 0) add_packed("strip-code-rounds", MeshTopology::kStripCode, Shown::kAll, tenth);
        add_packed("prisms", MeshTopology::kIndices, Shown::kPrisms, kWholeArena);
        add_packed("surface", MeshTopology::kIndices, Shown::kSurface, kWholeArena);
        return program_.exit_code() == 0;
    }

    void measure(const std::string& name, int repetitions) {
        for (Case& one : cases_) one.draw(one.frame);
        if (program_.exit_code() != 0) return;
        for (int repetition = 0; repetition < repetitions; ++repetition) {
            for (Case& one : cases_) {
                const double before = process_seconds();
                const double gpu_ms = one.draw(one.frame);
                one.seconds.push_back(on_processor_ ? process_seconds() - before : gpu_ms / 1000);
            }
        }
        for (const Case& one : cases_) print(name, one);
    }

  private:
    static constexpr uint64_t kWholeArena = uint64_t{64} << 20;

    struct Case {
        std::string name;
        std::function<double(FrameImage&)> draw;  ///< milliseconds of the GPU
        std::function<uint64_t()> arena_bytes;
        uint64_t resident_bytes = 0, triangles = 0;
        bool is_whole = true;
        FrameImage frame;
        std::vector<double> seconds;
        std::function<FrameCounts()> counts = [] { return FrameCounts{}; };
        double make_seconds = 0;
    };

    double check_frame(const std::string& name, Result<FrameImage> drawn, FrameImage& frame, const FrameTimings& time) {
        if (program_.check(drawn.ok(), name + ": " + (drawn.ok() ? "" : drawn.error().text())))
            frame = std::move(*drawn);
        return time.gpu_mesh_ms;
    }

    bool add_unpacked() {
        std::vector<UnpackedTile> tiles;
        uint64_t triangles = 0;
        for (size_t i = 0; i < city_.contents.size(); ++i) {
            tiles.push_back(unpack(codec::mesh::to_tile(city_.contents[i]), city_.origins[i]));
            triangles += tiles.back().indices.size() / 3;
        }
        auto made = UnpackedViewer::create(tiles, camera_.width, camera_.height);
        if (!program_.check(made.ok(), made.ok() ? "" : made.error().text())) return false;
        const std::shared_ptr<UnpackedViewer> viewer = std::move(*made);
        on_processor_ = viewer->on_processor();
        const auto draw = [this, viewer](FrameImage& frame) {
            FrameTimings time;
            return check_frame(kBaseline, viewer->draw(camera_, time), frame, time);
        };
        cases_.push_back(
            {kBaseline, draw, [] { return uint64_t{0}; }, viewer->geometry_bytes(), triangles, true, {}, {}});
        return true;
    }

    /// How many triangles are strip code.
    uint64_t add_packed(const std::string& name, MeshTopology topology, Shown shown, uint64_t arena_bytes) {
        auto made = pack(city_, camera_, topology, shown, arena_bytes);
        if (!program_.check(made.ok(), name + ": " + (made.ok() ? "" : made.error().text()))) return 0;
        const auto city = std::make_shared<PackedCity>(std::move(*made));
        const auto draw = [this, name, city](FrameImage& frame) {
            FrameTimings time;
            return check_frame(name, city->renderer->draw(camera_, city->tiles, &time), frame, time);
        };
        if (city->triangles == 0) return 0;
        const uint64_t without = city->renderer->frame_buffer_bytes();
        const auto arena = [city, without] {
            return city->renderer->counts().strip_rounds > 0 ? city->renderer->frame_buffer_bytes() - without : 0;
        };
        cases_.push_back(
            {name, draw, arena, city->resident_bytes, city->triangles, shown == Shown::kAll, {}, {}, [city] {
                 return city->renderer->counts();
             }});
        cases_.back().make_seconds = city->make_seconds;
        largest_strips_ = std::max(largest_strips_, city->largest_strips);
        return city->strip_triangles;
    }

    /// Rounding of floats moves edges by a pixel here and there.
    static double differing(const FrameImage& a, const FrameImage& b) {
        uint64_t count = 0;
        for (size_t i = 0; i < a.rgba.size(); ++i) count += std::abs(a.rgba[i] - b.rgba[i]) > 2 ? 1 : 0;
        return static_cast<double>(count) / static_cast<double>(a.rgba.size());
    }

    void print(const std::string& name, const Case& one) {
        const double median = spread_of(one.seconds).median;
        Json line = {
            {"city", name},
            {"case", one.name},
            {"viewport", {camera_.width, camera_.height}},
            {"clock", on_processor_ ? "processor" : "gpu"},
            {"triangles", one.triangles},
            {"frame_ms", rounded(median * 1000)},
            {"time_ratio", to_json(ratio_of(one.seconds, cases_[0].seconds))},
            {"ns_per_triangle", rounded(median * 1e9 / static_cast<double>(std::max<uint64_t>(one.triangles, 1)))},
            {"resident_bytes", one.resident_bytes},
            {"bytes_ratio",
             rounded(static_cast<double>(one.resident_bytes) / static_cast<double>(cases_[0].resident_bytes))},
            {"make_ms", rounded(one.make_seconds * 1000)},
            {"arena_bytes", one.arena_bytes()},
            {"rounds", one.counts().strip_rounds},
            {"decoded_triangles", one.counts().decoded_strip_triangles}};
        if (one.is_whole) {
            const double share = differing(one.frame, cases_[0].frame);
            line["differing"] = rounded(share);
            program_.check(share < 0.01, one.name + ": the picture is that of unpacked meshes");
        }
        program_.print(line);
    }

    const CityMeshes& city_;
    const Camera camera_;
    BenchProgram& program_;
    bool on_processor_ = false;
    uint64_t largest_strips_ = 0;  ///< triangles of a range
    std::vector<Case> cases_;
};

void measure_city(const std::string& name, const Result<SampleCity>& city, int repetitions, BenchProgram& program) {
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return;
    const Result<CityMeshes> meshes = read_meshes(*city);
    if (!program.check(meshes.ok(), meshes.ok() ? "" : meshes.error().text())) return;
    constexpr std::array<std::array<uint32_t, 2>, 2> kViewports = {{{1280, 720}, {1, 1}}};
    for (const auto& [width, height] : kViewports) {
        FrameBench bench(*meshes, overview(*meshes, width, height), program);
        if (bench.add_cases()) bench.measure(name, repetitions);
    }
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_mesh_frame", kClaim, "city.3tz"});
    BenchOptions options;
    options.buildings = 3000;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    program.check(keep_freed_memory(), "the allocator keeps freed memory");
    const TemporaryFolder folder;
    constexpr LayerSet kMeshes = {true, true, false, false};
    if (options.files.empty()) {
        const std::string archive = folder / "generated.3tz";
        const Status built = build_generated(options.buildings, options.seed, kMeshes, archive);
        if (program.check(built.ok(), built.ok() ? "" : built.error().text()))
            measure_city("generated:" + std::to_string(options.buildings), open_city(archive), options.repetitions,
                         program);
    }
    for (const auto& file : options.files)
        measure_city(std::filesystem::path(file).filename().string(), city_of_file(file, kMeshes, folder),
                     options.repetitions, program);
    return program.exit_code();
}
