// Claim: ray casting from compressed facade maps is as fast as from uncompressed ones (the paper's Table 2 beside
// ours).
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <map>
#include <numbers>
#include <optional>

#include "client/render/vulkan_renderer.h"
#include "codec/atlas/atlas_layer.h"
#include "codec/facade/facade_form.h"
#include "codec/facade/facade_layer.h"
#include "codec/facade/facade_wire.h"
#include "codec/facade/max_mip_map.h"
#include "codec/facade/raw_map.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/facade_sets.h"
#include "tests/shaders/facade_on_cpu.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;
using codec::facade::RunGrid;

constexpr const char* kClaim =
    "One facade in view from 0, 30, 60, 75 and 85 degrees, drawn by the eight facade renderers in turn. fps_to_rm, "
    "fps_to_crm, time_to_max_mip: of the facade\n"
    "pass, all views together, each in the least disturbed repetition; nanoseconds_per_pixel: of pixels that the "
    "facade "
    "covers. clock: time stamps of the GPU, or, of a device\n"
    "in software, the processor time that the frame takes more than an empty one. loads and steps: of the same rays, "
    "counted in the same shaders on the CPU.\n"
    "differing_pixels: share of covered pixels that are not as max-mip draws them (more than 8 of 255 in a channel): "
    "relief mapping misses thin relief.\n"
    "form: what the map had to be kept as. paper_fps: Table 2, of the paper's own facades F1..F4.\n"
    "FILEs are pairs D.png M.png; without them the four regular facades of the paper's sizes.";
constexpr uint32_t kWidth = 480, kHeight = 360;
constexpr std::array<double, 5> kDegrees = {0, 30, 60, 75, 85};
constexpr double kFov = 40 * std::numbers::pi / 180;
constexpr uint32_t kRayStride = 7;  ///< pixels between the rays that are counted on the CPU

/// Frames per second of Table 2.
const std::map<std::string, std::array<int, 4>> kPaperFps = {
    {"rm", {443, 94, 360, 209}},  {"fdm", {730, 387, 712, 369}}, {"crm", {30, 28, 34, 35}},
    {"bcrm", {110, 67, 111, 43}}, {"cfdm", {219, 82, 137, 116}}, {"bcfdm", {213, 124, 230, 104}}};

/// The map in the form that a renderer reads, as the client does it at arrival.
std::vector<uint32_t> words_for(FacadeRenderer renderer, const RunGrid& grid) {
    const auto form = form_for(renderer);
    if (!form) return codec::facade::encode_shipped_map(grid).words;
    if (*form == codec::facade::FacadeForm::kRaw)
        return *codec::facade::encode_raw_map(grid, steps_through_boxes(renderer));
    Result<std::vector<uint32_t>> words = codec::facade::encode_form(*form, grid);
    return words ? std::move(words).value() : *codec::facade::encode_raw_map(grid, steps_through_boxes(renderer));
}

std::string form_of(const std::vector<uint32_t>& words) {
    return std::string(codec::facade::form_name(codec::facade::read_form_head(words)->form));
}

/// A wall in the plane y = 0 that looks south, one texel a centimetre.
std::vector<uint32_t> placement_words(const RunGrid& grid) {
    codec::facade::FacadeTile tile;
    tile.palettes.resize(1);
    for (uint32_t slot = 0; slot < FACADE_PALETTE_SLOTS; ++slot) tile.palettes[0].slots[slot] = {slot, 1.0F};
    codec::facade::Placement placement{};
    placement.along[0] = static_cast<int32_t>(std::lround(grid.width() * 10.24));
    placement.height = static_cast<uint32_t>(std::lround(grid.height() * 10.24));
    tile.placements.push_back(placement);
    return codec::facade::encode_facades(tile)[0].words;
}

/// One flat chart a material slot, each of another colour.
std::vector<uint32_t> atlas_words() {
    std::vector<codec::atlas::ChartImage> charts(FACADE_PALETTE_SLOTS);
    for (uint32_t slot = 0; slot < charts.size(); ++slot) {
        charts[slot] = {4, 4, true, true, 0.25F, {}};
        for (uint32_t texel = 0; texel < 16; ++texel) {
            charts[slot].rgb.push_back(static_cast<uint8_t>(40 + 200 * (slot & 3) / 3));
            charts[slot].rgb.push_back(static_cast<uint8_t>(40 + 200 * (slot >> 2) / 3));
            charts[slot].rgb.push_back(static_cast<uint8_t>(40 + 13 * slot));
        }
    }
    std::vector<uint32_t> words;
    for (const LayerStep& step : codec::atlas::encode_atlas(charts))
        words.insert(words.end(), step.words.begin(), step.words.end());
    return words;
}

/// The camera that sees the whole wall from `degrees` beside its normal.
Camera camera_at(const RunGrid& grid, double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const double width = grid.width() * 0.01, height = grid.height() * 0.01;
    const double across = width * std::cos(angle) * kHeight / kWidth;
    const double away = 1.1 * std::max(across, height) / (2 * std::tan(kFov / 2)) + 0.5 * width * std::sin(angle);
    CameraSample sample{};
    sample.x = width / 2 + away * std::sin(angle);
    sample.y = -away * std::cos(angle);
    sample.z = height / 2;
    sample.yaw = -degrees;
    sample.fov = kFov * 180 / std::numbers::pi;
    return Camera::from_sample(sample, kWidth, kHeight);
}

/// What one renderer has on the device for one facade.
struct Candidate {
    FacadeRenderer kind;
    std::vector<uint32_t> words;
    std::unique_ptr<VulkanRenderer> renderer;
    TileDraw tile;
    bool is_software = false;  ///< the device is the processor
    std::array<FrameImage, kDegrees.size()> frames;
    std::array<std::vector<double>, kDegrees.size()> milliseconds;  ///< of each view, one a repetition

    /// Of all views together, each in its least disturbed repetition.
    double least_milliseconds() const {
        double sum = 0;
        for (const std::vector<double>& view : milliseconds) sum += spread_of(view).min;
        return sum;
    }
};

Result<Candidate> candidate_of(FacadeRenderer kind, const RunGrid& grid) {
    Candidate candidate{kind, words_for(kind, grid), nullptr, {}, false, {}, {}};
    RendererOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.facade_renderer = kind;
    options.facade_samples = 1;
    options.background = {1, 0, 1, 1};
    options.keyed_facades = false;  // one facade hides nothing: keys would only add their own time to every renderer
    auto renderer = VulkanRenderer::create(options);
    if (!renderer) return renderer.error();
    candidate.renderer = std::move(renderer).value();
    candidate.is_software = candidate.renderer->device_name().find("llvmpipe") != std::string::npos;
    const auto upload = [&](const std::vector<uint32_t>& words) -> Result<LayerId> {
        const LayerId layer = candidate.renderer->create();
        if (Status status = candidate.renderer->append(layer, words); !status) return status.error();
        return layer;
    };
    const auto facade = upload(placement_words(grid)), atlas = upload(atlas_words()), map = upload(candidate.words);
    for (const auto* layer : {&facade, &atlas, &map}) {
        if (!*layer) return layer->error();
    }
    candidate.tile.facade = *facade;
    candidate.tile.map_of_placement = {0};
    candidate.tile.facade_maps = {{0, *map}};
    candidate.tile.atlas = *atlas;
    return candidate;
}

/// Processor time of all threads.
double process_milliseconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

/// Milliseconds of the facade pass: by the device's time stamps; of a device in software, the processor time that the
/// frame takes more than an empty one, which other programs on the machine do not lengthen.
Status draw_views(Candidate& candidate, const RunGrid& grid) {
    for (size_t i = 0; i < kDegrees.size(); ++i) {
        const Camera camera = camera_at(grid, kDegrees[i]);
        FrameTimings timings;
        const double begin = process_milliseconds();
        auto frame = candidate.renderer->draw(camera, {&candidate.tile, 1}, &timings);
        const double with_facade = process_milliseconds();
        if (!frame) return frame.error();
        candidate.frames[i] = std::move(frame).value();
        if (!candidate.is_software) {
            candidate.milliseconds[i].push_back(timings.gpu_facade_ms);
            continue;
        }
        auto empty = candidate.renderer->draw(camera, {}, &timings);
        if (!empty) return empty.error();
        candidate.milliseconds[i].push_back(with_facade - begin - (process_milliseconds() - with_facade));
    }
    return Done{};
}

bool covered(const FrameImage& frame, size_t pixel) {
    return frame.rgba[4 * pixel] != 255 || frame.rgba[4 * pixel + 1] != 0 || frame.rgba[4 * pixel + 2] != 255;
}

uint64_t covered_pixels(const Candidate& candidate, size_t view) {
    uint64_t count = 0;
    for (size_t pixel = 0; pixel < size_t{kWidth} * kHeight; ++pixel)
        count += covered(candidate.frames[view], pixel) ? 1 : 0;
    return count;
}

double differing_share(const Candidate& candidate, const Candidate& truth, size_t view) {
    uint64_t differing = 0, all = 0;
    for (size_t pixel = 0; pixel < size_t{kWidth} * kHeight; ++pixel) {
        if (!covered(truth.frames[view], pixel) && !covered(candidate.frames[view], pixel)) continue;
        ++all;
        int most = 0;
        for (size_t channel = 0; channel < 3; ++channel) {
            most = std::max(most, std::abs(int{truth.frames[view].rgba[4 * pixel + channel]} -
                                           int{candidate.frames[view].rgba[4 * pixel + channel]}));
        }
        differing += most > 8 ? 1 : 0;
    }
    return all == 0 ? 0 : static_cast<double>(differing) / static_cast<double>(all);
}

/// Loads and steps of the rays of one view that hit, counted in the shader on the CPU.
struct ViewCost {
    uint64_t rays = 0;
    shaders_test::ShaderCost cost;
};
ViewCost count_rays(const Candidate& candidate, const RunGrid& grid, double degrees) {
    const Camera camera = camera_at(grid, degrees);
    const double half = std::tan(camera.fov_y / 2);
    const float origin[3] = {static_cast<float>(camera.position[0] * 100), static_cast<float>(camera.position[2] * 100),
                             static_cast<float>(-camera.position[1] * 1000)};
    ViewCost count;
    for (uint32_t y = 0; y < kHeight; y += kRayStride) {
        for (uint32_t x = 0; x < kWidth; x += kRayStride) {
            const double right = (2 * (x + 0.5) / kWidth - 1) * half * kWidth / kHeight;
            const double up = (1 - 2 * (y + 0.5) / kHeight) * half;
            double ray[3];
            for (size_t i = 0; i < 3; ++i) ray[i] = camera.forward[i] + right * camera.right[i] + up * camera.up[i];
            const float direction[3] = {static_cast<float>(ray[0] * 100), static_cast<float>(ray[2] * 100),
                                        static_cast<float>(-ray[1] * 1000)};
            shaders_test::ShaderCost cost;
            if (!shaders_test::cast_on_cpu(candidate.kind, candidate.words, origin, direction, 0, 0, &cost).hit)
                continue;
            ++count.rays;
            count.cost.loads += cost.loads;
            count.cost.steps += cost.steps;
        }
    }
    return count;
}

double per_ray(uint64_t sum, uint64_t rays) {
    return rounded(static_cast<double>(sum) / static_cast<double>(std::max<uint64_t>(rays, 1)));
}

void print_candidate(const std::string& facade, int paper_column, const Candidate& candidate, const RunGrid& grid,
                     const std::vector<Candidate>& all, BenchProgram& program) {
    const auto of = [&](FacadeRenderer kind) -> const Candidate& {
        return *std::find_if(all.begin(), all.end(), [&](const Candidate& c) { return c.kind == kind; });
    };
    const std::string name(facade_renderer_name(candidate.kind));
    uint64_t pixels = 0;
    ViewCost sum;
    Json by_angle = Json::array();
    for (size_t view = 0; view < kDegrees.size(); ++view) {
        pixels += covered_pixels(candidate, view);
        const ViewCost count = count_rays(candidate, grid, kDegrees[view]);
        sum.rays += count.rays;
        sum.cost.loads += count.cost.loads;
        sum.cost.steps += count.cost.steps;
        by_angle.push_back(
            {{"degrees", kDegrees[view]},
             {"loads", per_ray(count.cost.loads, count.rays)},
             {"steps", per_ray(count.cost.steps, count.rays)},
             {"differing_pixels", rounded(differing_share(candidate, of(FacadeRenderer::kMaxMip), view))}});
    }
    const double time = candidate.least_milliseconds();
    const auto ratio = [&](FacadeRenderer other) { return rounded(of(other).least_milliseconds() / time); };
    Json line = {{"facade", facade},
                 {"renderer", name},
                 {"form", form_of(candidate.words)},
                 {"resident_bytes", candidate.words.size() * 4},
                 {"fps_to_rm", ratio(FacadeRenderer::kRm)},
                 {"fps_to_crm", ratio(FacadeRenderer::kCrm)},
                 {"time_to_max_mip", rounded(time / of(FacadeRenderer::kMaxMip).least_milliseconds())},
                 {"nanoseconds_per_pixel", rounded(time * 1e6 / static_cast<double>(std::max<uint64_t>(pixels, 1)))},
                 {"loads", per_ray(sum.cost.loads, sum.rays)},
                 {"steps", per_ray(sum.cost.steps, sum.rays)},
                 {"views", by_angle}};
    const auto paper = kPaperFps.find(name);
    if (paper_column >= 0 && paper != kPaperFps.end()) {
        line["paper_fps"] = paper->second[static_cast<size_t>(paper_column)];
        line["paper_fps_to_rm"] = rounded(static_cast<double>(paper->second[static_cast<size_t>(paper_column)]) /
                                          kPaperFps.at("rm")[static_cast<size_t>(paper_column)]);
    }
    program.print(line);
}

void measure(const BenchFacade& facade, int paper_column, int repetitions, BenchProgram& program) {
    std::vector<Candidate> candidates;
    for (const FacadeRenderer kind : kFacadeRenderers) {
        Result<Candidate> candidate = candidate_of(kind, facade.grid);
        if (!candidate) return program.print_skipped(candidate.error().text());
        candidates.push_back(std::move(candidate).value());
    }
    // The first drawing of a renderer compiles its pipeline and is not measured.
    for (int repetition = -1; repetition < repetitions; ++repetition) {
        for (Candidate& candidate : candidates) {
            const Status drawn = draw_views(candidate, facade.grid);
            if (!program.check(drawn.ok(), drawn.ok() ? "" : drawn.error().text())) return;
            if (repetition < 0) candidate.milliseconds = {};
        }
    }
    program.print({{"facade", facade.name},
                   {"device", candidates[0].renderer->device_name()},
                   {"clock", candidates[0].is_software ? "processor" : "gpu"},
                   {"texels", {facade.grid.width(), facade.grid.height()}}});
    for (const Candidate& candidate : candidates)
        print_candidate(facade.name, paper_column, candidate, facade.grid, candidates, program);
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_facade_renderers", kClaim, "D.png M.png", false});
    BenchOptions options;
    options.files = {};
    options.repetitions = 7;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    if (!program.check(options.files.size() % 2 == 0, "files come in pairs D.png M.png")) return program.exit_code();
    if (options.files.empty()) {
        const std::vector<BenchFacade> facades = paper_facades(FacadeStyle::kRegular);
        for (size_t i = 0; i < facades.size(); ++i)
            measure(facades[i], static_cast<int>(i), options.repetitions, program);
    }
    for (size_t i = 0; i + 1 < options.files.size(); i += 2) {
        const Result<BenchFacade> facade = read_facade(options.files[i], options.files[i + 1]);
        if (program.check(facade.ok(), facade.ok() ? "" : facade.error().text()))
            measure(*facade, -1, options.repetitions, program);
    }
    return program.exit_code();
}
