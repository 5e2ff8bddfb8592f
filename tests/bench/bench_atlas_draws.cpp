// Claim: one draw a tile from atlases is ten times faster than a draw for each texture where draws and vertices bound
// the time, and of the ways to bring charts' coordinates to the shader none costs much.
#include <malloc.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>

#include "client/render/vulkan_renderer.h"
#include "codec/atlas/page_layer.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/texture_viewer.h"
#include "tests/bench/textured_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;

constexpr const char* kClaim =
    "Frames of a whole generated city with many textures, everything resident, nothing culled: without an atlas "
    "(no-atlas: a BC1 texture with\nmips for each picture, the hardware's sampler, vertex buffers, a bind and a draw "
    "for each run of triangles of a building with one picture;\nno-atlas-sorted: the same with the whole city's "
    "triangles sorted by picture beforehand, a draw a picture), with atlases in pages by each\ntransport of the "
    "charts' coordinates, and in charts form. The thesis's Table 15: 44.0, 436.7, 527.4 million vertices/s for "
    "uniform,\nattribute, packed; its Table 16: 12.34 frames/s without an atlas, 24.63, 174.55, 206.89 with one. "
    "frame_ms: recording, submission, drawing\nand reading back (median); faster: no-atlas / this, faster_than_sorted: "
    "no-atlas-sorted / this, within one repetition. vertices_per_s:\ncorners of triangles. cpu_...: the same in the "
    "process's CPU time, which on a software device is the work and does "
    "not depend on what else the\nmachine does. page_faults: of a frame (median); some 40,000 of them, where the "
    "allocator gives a software "
    "driver's memory back in every frame,\ncost as much as all else of no-atlas. The row \"law\" (1x1, CPU time) takes "
    "no-atlas for draws x us_per_draw +\ntriangles x ns_per_triangle (from both orders), and says how many times "
    "faster packed "
    "coordinates are so at other counts of\ntriangles a run: at_triangles_per_run. psnr: against no-atlas, at "
    "the larger viewport. Viewports: 1x1, then --viewport.";

struct Request {
    TexturedCityOptions city;
    uint32_t width = 1280, height = 720;
};

bool read_number(const std::string& text, uint32_t& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && value > 0;
}

bool read_viewport(const std::string& text, Request& request) {
    const size_t cross = text.find('x');
    return cross != std::string::npos && read_number(text.substr(0, cross), request.width) &&
           read_number(text.substr(cross + 1), request.height);
}

/// Of all threads.
double process_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

/// Of all threads, since the program began.
double page_faults() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_minflt);
}

/// One way of drawing the city.
struct Case {
    std::string name;
    std::function<Result<FrameImage>()> draw;
    std::function<uint32_t()> draws;
    uint64_t texture_bytes = 0, geometry_bytes = 0;
    std::function<FrameCounts()> counts = [] { return FrameCounts(); };
};

/// The words of each tile's layers, encoded once for all renderers.
struct TileLayers {
    codec::mesh::MeshLayer mesh;
    LayerSteps pages, charts;
};

codec::mesh::MeshLayer mesh_layer_of(const codec::mesh::MeshTile& tile) {
    const auto steps = codec::mesh::encode_mesh_layer(tile, {});
    std::vector<std::span<const std::byte>> wire;
    std::vector<uint32_t> decoded_bytes;
    for (const auto& step : steps) {
        wire.emplace_back(step.wire);
        decoded_bytes.push_back(step.decoded_bytes);
    }
    return *codec::mesh::decode_mesh_layer(wire, decoded_bytes, codec::mesh::kAnyMeshChart);
}

std::vector<TileLayers> encode_tiles(const TexturedCity& city) {
    std::vector<TileLayers> layers;
    for (const CityTile& tile : city.tiles) {
        std::vector<codec::atlas::ChartImage> pictures;
        for (const uint32_t picture : tile.pictures) pictures.push_back(city.pictures[picture]);
        layers.push_back(
            {mesh_layer_of(tile.mesh), *codec::atlas::encode_pages(pictures), codec::atlas::encode_atlas(pictures)});
    }
    return layers;
}

// Bytes; 0: no room.
uint64_t upload(VulkanRenderer& renderer, const std::vector<uint32_t>& words, LayerId& layer) {
    layer = renderer.create();
    return renderer.append(layer, words) ? words.size() * 4 : 0;
}

// All steps at once, as the streamer does with what it asked for at once: the layer lies in one piece.
uint64_t upload(VulkanRenderer& renderer, const LayerSteps& steps, LayerId& layer) {
    std::vector<uint32_t> words;
    for (const auto& step : steps) words.insert(words.end(), step.words.begin(), step.words.end());
    return upload(renderer, words, layer);
}

/// A renderer with the whole city in it.
struct AtlasViewer {
    std::unique_ptr<VulkanRenderer> renderer;
    std::vector<TileDraw> tiles;
    uint64_t texture_bytes = 0, geometry_bytes = 0;
};

Result<AtlasViewer> make_viewer(const TexturedCity& city, std::span<const TileLayers> layers, const Camera& camera,
                                codec::atlas::AtlasForm form, ChartTransport transport) {
    RendererOptions options;
    options.width = camera.width;
    options.height = camera.height;
    options.gpu_budget_bytes = uint64_t{1} << 30;
    options.chart_transport = transport;
    auto renderer = VulkanRenderer::create(options);
    if (!renderer) return renderer.error();
    AtlasViewer viewer{std::move(*renderer), {}, 0, 0};
    for (size_t i = 0; i < layers.size(); ++i) {
        TileDraw tile;
        tile.origin = city.tiles[i].origin;
        tile.mesh_steps = layers[i].mesh.steps;
        tile.mesh_ranges = layers[i].mesh.resident.ranges;
        viewer.geometry_bytes += upload(*viewer.renderer, layers[i].mesh.words(), tile.mesh);
        tile.atlas_form = form;
        viewer.texture_bytes += upload(
            *viewer.renderer, form == codec::atlas::AtlasForm::kPages ? layers[i].pages : layers[i].charts, tile.atlas);
        viewer.tiles.push_back(tile);
    }
    return viewer;
}

double psnr(const FrameImage& a, const FrameImage& b) {
    double sum = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i) sum += (a.rgba[i] - b.rgba[i]) * (a.rgba[i] - b.rgba[i]);
    return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.rgba.size()) * 0.75 / std::max(sum, 1.0));
}

class DrawBench {
  public:
    DrawBench(const TexturedCity& city, std::span<const TileLayers> layers, int repetitions, BenchProgram& program)
        : city_(city), layers_(layers), repetitions_(repetitions), program_(program) {}

    void measure(uint32_t width, uint32_t height) {
        camera_ = city_.overview(width, height);
        cases_.clear();
        add_plain("no-atlas", TextureOrder::kByBuilding);
        add_plain("no-atlas-sorted", TextureOrder::kByPicture);
        for (const ChartTransport transport : kChartTransports)
            add_atlas("pages-" + std::string(chart_transport_name(transport)), codec::atlas::AtlasForm::kPages,
                      transport);
        add_atlas("charts", codec::atlas::AtlasForm::kCharts, ChartTransport::kTable);
        if (program_.exit_code() != 0) return;
        std::vector<FrameImage> frames;
        for (const Case& one : cases_) {
            const auto frame = one.draw();
            if (!program_.check(frame.ok(), one.name + ": " + (frame.ok() ? "" : frame.error().text()))) return;
            frames.push_back(std::move(*frame));
        }
        time_cases();
        for (size_t i = 0; i < cases_.size(); ++i) print(i, frames);
        if (width == 1) print_law();
        for (size_t i = kFirstPages + 1; i <= kPackedPages; ++i) {
            program_.check(frames[i].rgba == frames[kFirstPages].rgba,
                           cases_[i].name + ": the frame is that of the table");
            program_.check(cases_[i].counts().fallback_tiles == 0, cases_[i].name + ": every tile takes it");
        }
    }

  private:
    void add_plain(const std::string& name, TextureOrder order) {
        auto made = TextureViewer::create(city_, order, camera_.width, camera_.height);
        if (!program_.check(made.ok(), name + ": " + (made.ok() ? "" : made.error().text()))) return;
        std::shared_ptr<TextureViewer> viewer = std::move(*made);
        cases_.push_back({name, [viewer, this] { return viewer->draw(camera_); }, [viewer] { return viewer->draws(); },
                          viewer->texture_bytes(), viewer->geometry_bytes()});
    }
    void add_atlas(const std::string& name, codec::atlas::AtlasForm form, ChartTransport transport) {
        auto made = make_viewer(city_, layers_, camera_, form, transport);
        if (!program_.check(made.ok(), name + ": " + (made.ok() ? "" : made.error().text()))) return;
        const auto viewer = std::make_shared<AtlasViewer>(std::move(*made));
        cases_.push_back({name, [viewer, this] { return viewer->renderer->draw(camera_, viewer->tiles, nullptr); },
                          [viewer] { return viewer->renderer->counts().mesh_draws; }, viewer->texture_bytes,
                          viewer->geometry_bytes, [viewer] { return viewer->renderer->counts(); }});
    }
    // In turn, so that what disturbs the machine disturbs all.
    void time_cases() {
        wall_.assign(cases_.size(), {});
        cpu_.assign(cases_.size(), {});
        faults_.assign(cases_.size(), {});
        for (int repetition = 0; repetition < repetitions_; ++repetition) {
            for (size_t i = 0; i < cases_.size(); ++i) {
                const double before = process_seconds(), faults_before = page_faults();
                wall_[i].push_back(seconds_of([&] { (void)cases_[i].draw(); }));
                cpu_[i].push_back(process_seconds() - before);
                faults_[i].push_back(page_faults() - faults_before);
            }
        }
    }
    void print(size_t i, const std::vector<FrameImage>& frames) const {
        const Case& one = cases_[i];
        const double median = spread_of(wall_[i]).median;
        Json line = {{"case", one.name},
                     {"viewport", {camera_.width, camera_.height}},
                     {"draws", one.draws()},
                     {"triangles", city_.triangles()},
                     {"frame_ms", rounded(median * 1000)},
                     {"faster", to_json(ratio_of(wall_[0], wall_[i]))},
                     {"faster_than_sorted", rounded(ratio_of(wall_[1], wall_[i]).median)},
                     {"vertices_per_s", rounded(3 * static_cast<double>(city_.triangles()) / median)},
                     {"cpu_ms", rounded(spread_of(cpu_[i]).median * 1000)},
                     {"cpu_faster", to_json(ratio_of(cpu_[0], cpu_[i]))},
                     {"cpu_faster_than_sorted", rounded(ratio_of(cpu_[1], cpu_[i]).median)},
                     {"page_faults", rounded(spread_of(faults_[i]).median)},
                     {"texture_bytes", one.texture_bytes},
                     {"geometry_bytes", one.geometry_bytes},
                     {"coordinate_bytes", one.counts().coordinate_bytes}};
        if (camera_.width > 1) line["psnr"] = i == 0 ? Json() : Json(rounded(psnr(frames[i], frames[0])));
        program_.print(line);
    }

    // What a draw and a triangle cost without an atlas, from the same triangles in two orders.
    void print_law() const {
        const double by_building = spread_of(cpu_[kNoAtlas]).median, sorted = spread_of(cpu_[kSorted]).median;
        const double packed = spread_of(cpu_[kPackedPages]).median, triangles = static_cast<double>(city_.triangles());
        const double draws = cases_[kNoAtlas].draws(), sorted_draws = cases_[kSorted].draws();
        const double draw = std::max(by_building - sorted, 0.0) / (draws - sorted_draws);
        const double triangle = std::max(by_building - draws * draw, 0.0) / triangles;
        Json at;
        for (const double in_run : {2, 4, 8, 16, 32, 64})
            at.push_back({in_run, rounded((draw / in_run + triangle) / (packed / triangles))});
        program_.print({{"case", "law"},
                        {"us_per_draw", rounded(draw * 1e6)},
                        {"ns_per_triangle", rounded(triangle * 1e9)},
                        {"packed_ns_per_triangle", rounded(packed / triangles * 1e9)},
                        {"at_triangles_per_run", at}});
    }

    /// Places in cases_.
    enum : size_t { kNoAtlas, kSorted, kFirstPages, kPackedPages = kFirstPages + kChartTransports.size() - 1 };

    const TexturedCity& city_;
    std::span<const TileLayers> layers_;
    int repetitions_;
    BenchProgram& program_;
    Camera camera_;
    std::vector<Case> cases_;
    std::vector<std::vector<double>> wall_, cpu_;  // seconds, by case
    std::vector<std::vector<double>> faults_;
};

// Keeps freed memory in the process: a driver that allocates for every recorded command, as lavapipe does, else gives
// it back and asks for it anew in every frame of many draws, which is up to half of their time. One arena: the others
// unmap what is free whatever the threshold.
bool choose_allocator(const std::string& name) {
    if (name != "keep") return name == "default";
    return mallopt(M_ARENA_MAX, 1) == 1 && mallopt(M_TRIM_THRESHOLD, 1 << 30) == 1 &&
           mallopt(M_MMAP_THRESHOLD, 32 << 20) == 1;
}

}  // namespace

int main(int argc, char** argv) {
    Request request;
    const auto number = [](uint32_t& value) {
        return [&value](const std::string& text) { return read_number(text, value); };
    };
    BenchDescription description{"bench_atlas_draws", kClaim, ""};
    description.options = {
        {"--textures", "distinct textures of the generated city (3000)", number(request.city.textures)},
        {"--allocator", "default, or keep: freed memory stays in the process (default)", choose_allocator},
        {"--side", "longest side of a picture, texels (60)", number(request.city.longest_side)},
        {"--viewport", "WIDTHxHEIGHT of the larger viewport (1280x720)",
         [&](const std::string& text) { return read_viewport(text, request); }}};
    BenchProgram program(description);
    BenchOptions options;
    options.buildings = 3000;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    request.city.buildings = options.buildings;
    request.city.seed = options.seed;
    const TexturedCity city = make_textured_city(request.city);
    const std::vector<TileLayers> layers = encode_tiles(city);
    program.print({{"buildings", city.buildings},
                   {"pictures", city.pictures.size()},
                   {"tiles", city.tiles.size()},
                   {"triangles", city.triangles()},
                   {"vertices", city.vertices.size()},
                   {"triangles_per_run",
                    rounded(static_cast<double>(city.triangles()) / static_cast<double>(city.runs.size()))}});
    DrawBench bench(city, layers, options.repetitions, program);
    bench.measure(1, 1);
    bench.measure(request.width, request.height);
    return program.exit_code();
}
