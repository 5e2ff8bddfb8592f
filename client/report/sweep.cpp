#include "client/report/sweep.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

#include "client/reference/reference_renderer.h"
#include "client/render/frame_file.h"
#include "client/render/vulkan_renderer.h"
#include "client/report/lit_reference.h"
#include "client/select/relief_arguments.h"
#include "client/stream/city_streamer.h"

namespace citystream::client {
namespace {

std::vector<CameraSample> cameras_of(const SweepOptions& options) {
    std::vector<CameraSample> cameras;
    const double begin = options.path.samples.front().t, duration = options.path.duration();
    for (uint32_t i = 0; i < options.frames; ++i)
        cameras.push_back(options.path.at(
            begin + duration * (options.frames == 1 ? 0 : static_cast<double>(i) / (options.frames - 1))));
    return cameras;
}

FrameImage picture_of(const std::vector<float>& flip, uint32_t width, uint32_t height) {
    FrameImage out{width, height, std::vector<uint8_t>(size_t{4} * width * height, 255)};
    for (size_t i = 0; i < flip.size(); ++i) {
        // Black over red and yellow to white, so that small errors stay visible in print.
        const float v = std::clamp(flip[i], 0.0f, 1.0f) * 3;
        for (size_t c = 0; c < 3; ++c)
            out.rgba[4 * i + c] = static_cast<uint8_t>(255 * std::clamp(v - static_cast<float>(c), 0.0f, 1.0f));
    }
    return out;
}

class Sweep {
  public:
    explicit Sweep(const SweepOptions& options) : options_(options), cameras_(cameras_of(options)) {}

    Status draw_references(SweepResult& result);
    Status draw_lit_references(SweepResult& result);
    Result<SettingResult> fly(const Setting& setting, SweepResult& result);

  private:
    struct Flight {
        VulkanRenderer& renderer;
        CityStreamer& streamer;
        std::optional<FrameLight> light;  ///< of the last frame
        uint64_t light_changes = 0;
    };

    Status keep_reference(const FrameImage& image, SweepResult& result);
    Status prepare_light(const Setting& setting, const tiles::tileset::Manifest& manifest, SettingResult& out);
    void light_frame(uint32_t i, Flight& flight);
    Result<FrameImage> draw(const Camera& camera, const std::vector<TileDraw>& tiles, Flight& flight,
                            FrameTimings& timings);
    Result<FrameRow> fly_frame(uint32_t i, const std::string& prefix, Flight& flight, SettingResult& out);
    Status keep_pictures(const FrameImage& image, const std::vector<float>& flip, const FrameRow& row);
    std::string file(const std::string& name) const {
        return (std::filesystem::path(options_.picture_folder) / name).string();
    }
    void say(const std::string& line) const {
        if (options_.progress) options_.progress(line);
    }

    const SweepOptions& options_;
    std::vector<CameraSample> cameras_;
    std::vector<FrameImage> references_;
    std::vector<float> exposures_;  ///< of lit frames
};

Status Sweep::draw_references(SweepResult& result) {
    ReferenceOptions reference_options;
    reference_options.width = options_.width;
    reference_options.height = options_.height;
    reference_options.supersample = options_.supersample;
    auto reference = ReferenceRenderer::create(options_.reference, reference_options);
    if (!reference) return reference.error();
    result.reference_device = (*reference)->device_name();
    result.reference_gpu_bytes = (*reference)->gpu_bytes();
    for (uint32_t i = 0; i < cameras_.size(); ++i) {
        auto image = (*reference)->draw(Camera::from_sample(cameras_[i], options_.width, options_.height));
        if (!image) return image.error();
        result.reference_ms.push_back((*reference)->last_frame_ms());
        result.reference_triangles.push_back((*reference)->triangles_drawn());
        if (Status kept = keep_reference(*image, result); !kept) return kept;
    }
    return Done{};
}

Status Sweep::draw_lit_references(SweepResult& result) {
    using Clock = std::chrono::steady_clock;
    auto reference = LitReference::create(
        options_.reference, {options_.width, options_.height, options_.supersample, options_.reference_rays});
    if (!reference) return reference.error();
    result.rays_a_pixel = (*reference)->rays_a_pixel();
    result.reference_device = "the processor, by rays";
    for (const CameraSample& camera : cameras_) {
        FlightLighting facts;
        const FrameLight& light = options_.light->at(camera.t, facts);
        const Clock::time_point begin = Clock::now();
        const auto image = (*reference)->draw(camera, options_.light->moment(camera.t), light);
        if (!image) return image.error();
        result.reference_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
        result.reference_triangles.push_back((*reference)->triangles());
        exposures_.push_back(light.exposure);
        if (Status kept = keep_reference(*image, result); !kept) return kept;
    }
    return Done{};
}

Status Sweep::keep_reference(const FrameImage& image, SweepResult& result) {
    result.reference_pictures.push_back(fmt::format("reference_{:03}.png", references_.size()));
    if (Status written = write_png(file(result.reference_pictures.back()), image); !written) return written;
    references_.push_back(image);
    say(fmt::format("reference frame {} of {}: {} triangles", references_.size(), cameras_.size(),
                    result.reference_triangles.back()));
    return Done{};
}

/// Fits the light to the archive of a setting.
Status Sweep::prepare_light(const Setting& setting, const tiles::tileset::Manifest& manifest, SettingResult& out) {
    if (options_.light == nullptr) return Done{};
    auto cost = read_radiance_cost(setting.place.empty() ? options_.city : setting.place);
    if (!cost) return cost.error();
    out.radiance = std::move(*cost);
    if (out.radiance) {
        options_.light->set_texels_across(manifest.radiance_texels_across);
    } else {
        out.warnings.push_back(fmt::format("{} {}: {}", setting.knob, setting.label(), kNoRadianceLayer));
    }
    return Done{};
}

/// What a frame's light depends on besides the camera: the time, and the directions of the archive.
void Sweep::light_frame(uint32_t i, Flight& flight) {
    if (options_.light == nullptr) return;
    FlightLighting facts;
    flight.light = options_.light->at(cameras_[i].t, facts);
    flight.light->exposure = exposures_[i];
    flight.streamer.set_sun(flight.light->sun ? std::optional(flight.light->sun->direction) : std::nullopt);
}

/// Every lit drawing is of another light, so that its passes run for all tiles.
Result<FrameImage> Sweep::draw(const Camera& camera, const std::vector<TileDraw>& tiles, Flight& flight,
                               FrameTimings& timings) {
    if (flight.light) {
        flight.light->number = ++flight.light_changes;
        if (Status set = flight.renderer.set_light(&*flight.light); !set) return set.error();
        flight.renderer.set_casters(flight.streamer.casters());
    }
    return flight.renderer.draw(camera, tiles, &timings);
}

FrameRow row_of(const StreamerFrame& streamed, const FrameTimings& timings) {
    FrameRow row;
    row.gpu_ms = timings.gpu_total_ms - timings.gpu_light_ms;
    row.facade_ms = timings.gpu_facade_ms;
    row.light_ms = timings.gpu_light_ms;
    row.shadow_ms = timings.shadow_ms;
    row.select_ms = streamed.select_ms;
    row.decode_ms = streamed.decode_ms;
    row.light_decode_ms = streamed.light_decode_ms;
    row.wire_bytes = streamed.wire_bytes;
    row.dictionary_bytes = streamed.facade_index_bytes + streamed.facade_map_bytes;
    row.atlas_bytes = streamed.atlas_bytes();
    row.mesh_bytes = streamed.layer_bytes[static_cast<size_t>(tiles::tileset::Layer::kMesh)];
    row.radiance_bytes = streamed.layer_bytes[static_cast<size_t>(tiles::tileset::Layer::kRadiance)];
    row.radiance_gpu_bytes = streamed.light_bytes;
    row.row_error = streamed.light_row_error;
    row.tiles = streamed.tiles_drawn;
    row.relief_tiles = streamed.relief_tiles;
    row.tolerance_used = streamed.tolerance_used;
    row.achieved_error_pixels = streamed.achieved_error_pixels;
    row.position_error_pixels = streamed.position_error_pixels;
    row.position_bits = streamed.position_bits;
    return row;
}

void add_frame(const FrameRow& row, SettingResult& out) {
    out.total_wire_bytes += row.wire_bytes;
    out.total_dictionary_bytes += row.dictionary_bytes;
    out.total_atlas_bytes += row.atlas_bytes;
    out.total_mesh_bytes += row.mesh_bytes;
    out.total_radiance_bytes += row.radiance_bytes;
    out.largest_gpu_bytes = std::max(out.largest_gpu_bytes, row.gpu_bytes);
    out.largest_radiance_gpu_bytes = std::max(out.largest_radiance_gpu_bytes, row.radiance_gpu_bytes);
}

Result<FrameRow> Sweep::fly_frame(uint32_t i, const std::string& prefix, Flight& flight, SettingResult& out) {
    const Camera camera = Camera::from_sample(cameras_[i], options_.width, options_.height);
    light_frame(i, flight);
    StreamerFrame streamed;
    const std::vector<TileDraw>& tiles = flight.streamer.update(camera, streamed);
    FrameTimings timings;
    // The first drawing of a frame compiles and uploads; the second is what a running flight sees.
    if (auto warm = draw(camera, tiles, flight, timings); !warm) return warm.error();
    auto image = draw(camera, tiles, flight, timings);
    if (!image) return image.error();
    std::vector<float> flip_per_pixel;
    auto difference = compare_images(references_[i], *image, &flip_per_pixel);
    if (!difference) return difference.error();
    FrameRow row = row_of(streamed, timings);
    row.frame = i;
    row.t = cameras_[i].t;
    row.gpu_bytes = flight.renderer.slots_used() * flight.renderer.slot_bytes();
    row.receivers = flight.renderer.counts().radiance_receivers;
    row.difference = *difference;
    row.picture = fmt::format("{}_{:03}.png", prefix, i);
    row.flip_picture = fmt::format("{}_{:03}_flip.png", prefix, i);
    if (Status kept = keep_pictures(*image, flip_per_pixel, row); !kept) return kept.error();
    add_frame(row, out);
    out.warnings.insert(out.warnings.end(), streamed.warnings.begin(), streamed.warnings.end());
    return row;
}

Status Sweep::keep_pictures(const FrameImage& image, const std::vector<float>& flip, const FrameRow& row) {
    if (Status written = write_png(file(row.picture), image); !written) return written;
    return write_png(file(row.flip_picture), picture_of(flip, options_.width, options_.height));
}

/// Everything that a setting may change.
struct FlightOptions {
    std::string place;
    RendererOptions renderer;
    StreamerOptions streamer;
};

Result<FlightOptions> flight_options(const SweepOptions& options, const Setting& setting) {
    FlightOptions out;
    out.place = setting.place.empty() ? options.city : setting.place;
    out.renderer.width = options.width;
    out.renderer.height = options.height;
    out.renderer.supersample = options.supersample;
    out.renderer.gpu_budget_bytes = options.gpu_budget_bytes;
    out.renderer.device = options.device;
    out.renderer.facade_renderer = options.facade_renderer;
    out.renderer.facade_samples = options.facade_samples;
    out.streamer.tolerance_pixels = options.tolerance_pixels;
    out.streamer.texel_tolerance_pixels = options.texel_tolerance_pixels;
    out.streamer.position_tolerance_pixels = options.position_tolerance_pixels;
    out.streamer.host_budget_bytes = options.host_budget_bytes;
    out.streamer.relief = options.relief;
    if (options.light != nullptr) out.streamer.light_tolerance = options.light_tolerance;
    out.streamer.matrix_form = options.matrix;
    out.streamer.matrix_error = options.matrix_error;
    if (setting.knob == "tolerance") {
        out.streamer.tolerance_pixels = setting.value;
    } else if (setting.knob == "relief-tolerance") {
        out.streamer.relief.tolerance_pixels = setting.value;
    } else if (setting.knob == "texel-tolerance") {
        out.streamer.texel_tolerance_pixels = setting.value;
    } else if (setting.knob == "position-tolerance") {
        out.streamer.position_tolerance_pixels = setting.value;
    } else if (setting.knob == "gpu-budget") {
        out.renderer.gpu_budget_bytes = static_cast<uint64_t>(setting.value * (1 << 20));
    } else if (setting.knob == "map-level") {
        auto relief = parse_relief_options(setting.name, options.relief.tolerance_pixels);
        if (!relief) return relief.error();
        out.streamer.relief = *relief;
    } else if (setting.knob == "facade-renderer") {
        const auto renderer = facade_renderer_named(setting.name);
        if (!renderer) return Error{"there is no facade renderer " + setting.name};
        out.renderer.facade_renderer = *renderer;
    } else if (setting.knob == "facade-samples") {
        const auto samples = facade_samples_named(setting.name);
        if (!samples) return Error{"facade pixels do not cast " + setting.name + " rays"};
        out.renderer.facade_samples = *samples;
    } else if (setting.knob == "light-tolerance") {
        out.streamer.light_tolerance = setting.value;
    } else if (setting.knob == "matrix-error") {
        out.streamer.matrix_error = setting.value;
    } else if (setting.knob == "matrix") {
        const auto form = matrix_form_named(setting.name);
        if (!form) return Error{"matrices are not kept as " + setting.name};
        out.streamer.matrix_form = *form;
    } else if (setting.place.empty()) {
        return Error{"there is no knob " + setting.knob};
    }
    out.streamer.facade_form = form_for(out.renderer.facade_renderer);
    out.streamer.facade_boxes = steps_through_boxes(out.renderer.facade_renderer);
    return out;
}

Result<SettingResult> Sweep::fly(const Setting& setting, SweepResult& result) {
    const auto options = flight_options(options_, setting);
    if (!options) return options.error();
    auto renderer = VulkanRenderer::create(options->renderer);
    if (!renderer) return renderer.error();
    result.device = (*renderer)->device_name();
    auto fetcher = Fetcher::open(options->place, FetcherOptions{});
    if (!fetcher) return fetcher.error();
    auto streamer = CityStreamer::open(**fetcher, **renderer, options->streamer);
    if (!streamer) return streamer.error();

    SettingResult out;
    out.setting = setting;
    out.build_options = (*streamer)->manifest().build_options;
    if (Status prepared = prepare_light(setting, (*streamer)->manifest(), out); !prepared) return prepared.error();
    Flight flight{**renderer, **streamer, {}, 0};
    const std::string prefix = setting.file_prefix();
    for (uint32_t i = 0; i < cameras_.size(); ++i) {
        auto row = fly_frame(i, prefix, flight, out);
        if (!row) return row.error();
        say(fmt::format("{} {}, frame {} of {}: {:.2f} dB, {} bytes", setting.knob, setting.label(), i + 1,
                        cameras_.size(), row->difference.psnr_db, row->wire_bytes));
        out.frames.push_back(std::move(row).value());
    }
    return out;
}

}  // namespace

std::string Setting::label() const {
    if (is_named()) return name;
    if (knob == "gpu-budget") return fmt::format("{:g} MiB", value);
    if (knob == "lattice") return fmt::format("{:g} m", value);
    constexpr std::array<std::string_view, 6> kWithoutUnit = {"matrix-error",    "rate-distortion", "normal-bits",
                                                              "light-tolerance", "directions",      "local-directions"};
    const bool plain = std::find(kWithoutUnit.begin(), kWithoutUnit.end(), knob) != kWithoutUnit.end();
    return plain ? value_text() : fmt::format("{:g} px", value);
}

std::string Setting::value_text() const {
    return is_named() ? name : fmt::format("{:g}", value);
}

std::string Setting::file_prefix() const {
    std::string prefix = knob + "_" + value_text();
    std::replace_if(
        prefix.begin(), prefix.end(), [](char c) { return c == ' ' || c == ':'; }, '_');
    return prefix;
}

std::string Setting::series() const {
    if (knob != "saliency") return knob;
    return name == "none" ? std::string() : knob + " " + name.substr(0, name.find(':'));
}

bool is_of_light(const std::string& knob) {
    constexpr std::array<std::string_view, 7> kOfLight = {
        "matrix-error", "light-tolerance", "matrix", "lattice", "directions", "local-directions", "radiance-transport"};
    return std::find(kOfLight.begin(), kOfLight.end(), knob) != kOfLight.end();
}

Result<SweepResult> run_sweep(const SweepOptions& options, const std::vector<Setting>& settings) {
    Sweep sweep(options);
    SweepResult result;
    result.settings.reserve(settings.size());
    result.lit = options.light != nullptr;
    if (result.lit) {
        result.environment = options.environment;
        auto cost = read_radiance_cost(options.city);
        if (!cost) return cost.error();
        result.radiance = std::move(*cost);
    }
    if (Status drawn = result.lit ? sweep.draw_lit_references(result) : sweep.draw_references(result); !drawn)
        return drawn.error();
    for (const Setting& setting : settings) {
        auto flown = sweep.fly(setting, result);
        if (!flown) return flown.error();
        result.settings.push_back(std::move(flown).value());
    }
    return result;
}

double median_of(const std::vector<FrameRow>& frames, const std::function<double(const FrameRow&)>& column) {
    if (frames.empty()) return 0;
    std::vector<double> values;
    values.reserve(frames.size());
    for (const FrameRow& row : frames) values.push_back(column(row));
    std::sort(values.begin(), values.end());
    const size_t middle = values.size() / 2;
    return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

}  // namespace citystream::client
