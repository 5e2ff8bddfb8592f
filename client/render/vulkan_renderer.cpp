#include "client/render/vulkan_renderer.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "client/render/device_choice.h"
#include "client/render/frame_lighting.h"
#include "client/render/frame_passes.h"
#include "client/render/frame_recorder.h"
#include "client/render/frame_tiles.h"
#include "client/render/frame_timestamps.h"
#include "client/render/layer_refiner.h"
#include "client/render/light_constants.h"
#include "client/render/lighting_layout.h"
#include "client/render/relief_light.h"
#include "client/render/slot_pool.h"
#include "shaders/box_filter.comp.h"

namespace citystream::client {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

void split(VkDeviceAddress address, uint32_t out[2]) {
    out[0] = static_cast<uint32_t>(address);
    out[1] = static_cast<uint32_t>(address >> 32);
}

/// What of a tile casts shadows: its triangles, also those that stand in for facades.
TileDraw caster_of(const TileDraw& tile) {
    TileDraw caster;
    caster.origin = tile.origin;
    caster.mesh = tile.mesh;
    caster.mesh_ranges = tile.mesh_ranges;
    caster.drop_rule = tile.drop_rule;
    caster.mesh_least_dropped = tile.mesh_least_dropped;
    return caster;
}

class Renderer final : public VulkanRenderer {
  public:
    explicit Renderer(const RendererOptions& options) : options_(options) {}
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;
    ~Renderer() override;

    Status start();

    uint64_t slot_bytes() const override { return kSlotBytes; }
    uint64_t slot_count() const override { return pool_.slot_count; }
    uint64_t slots_used() const override;
    LayerId create() override { return create_layer(pool_); }
    Status append(LayerId layer, std::span<const uint32_t> words) override;
    Result<uint64_t> refine(LayerId layer, uint64_t begin, std::span<const uint32_t> planes,
                            uint32_t to_level) override;
    void destroy(LayerId layer) override {
        refiner_->forget(layer);
        strips_->forget(layer);
        mesh_draws_.forget(layer);
        if (relief_) relief_->forget(layer);
        if (lighting_) lighting_->forget(layer);
        coordinates_.forget(layer, pool_);
        destroy_layer(pool_, layer);
    }

    Result<FrameImage> draw(const Camera& camera, std::span<const TileDraw> tiles, FrameTimings* timings) override;
    Status set_light(const FrameLight* light) override;
    void set_casters(std::span<const TileDraw> casters) override;
    std::string device_name() const override { return device_.name; }
    FrameCounts counts() const override { return counts_; }
    uint64_t frame_buffer_bytes() const override;
    uint64_t gpu_bytes_allocated() const override { return allocated_bytes(pool_); }
    uint64_t validation_messages() const override { return instance_.messages ? instance_.messages->load() : 0; }
    bool has_facade_pipeline() const override { return passes_->has_facades(); }
    bool has_radiance_pipeline() const override { return lighting_.has_value(); }

  private:
    void make_room(uint64_t slots);
    FacadeTableHead facade_table_head() const;
    Result<Clock::duration> write_frame(const Camera& camera, std::span<const TileDraw> tiles, FrameKind kind);
    Status prepare_light(const Camera& camera, std::span<const TileDraw> tiles);
    Status draw_cascade(const Camera& camera, uint32_t cascade);
    void add_casters(std::span<const TileDraw> tiles);
    void record_frame(VkCommandBuffer commands);
    void record_sky(VkCommandBuffer commands);
    FrameImage read_frame() const;

    RendererOptions options_;
    Instance instance_;
    Device device_;
    SlotPool pool_;
    CoordinateLayers coordinates_;
    MeshDraws mesh_draws_;
    FrameTarget target_;
    Pass filter_;
    FrameCounts counts_;
    std::optional<LayerRefiner> refiner_;
    std::optional<StripRanges> strips_;
    std::optional<PrismIndices> prism_indices_;
    std::optional<DrawRecords> draw_records_;
    std::optional<FrameTiles> tiles_;
    std::optional<FramePasses> passes_;
    std::optional<FrameTimestamps> timestamps_;
    FrameRecorder::Sources recorded_;
    std::optional<FrameLight> light_;
    bool light_is_new_ = false;  ///< not yet in lighting_
    std::optional<FrameLighting> lighting_;
    std::optional<ReliefLight> relief_;
    std::vector<TileDraw> casters_;  ///< out of view; while a light is prepared with those that are drawn
    DrawnFrame frame_;
};

Renderer::~Renderer() {
    if (device_.handle != VK_NULL_HANDLE) {
        vkDeviceWaitIdle(device_.handle);
        relief_.reset();
        lighting_.reset();
        timestamps_.reset();
        passes_.reset();
        tiles_.reset();
        draw_records_.reset();
        prism_indices_.reset();
        strips_.reset();
        refiner_.reset();
        destroy_slot_pool(pool_);
        destroy_frame_target(device_, target_);
        destroy_pass(device_, filter_);
    }
    destroy_device(device_);
    destroy_instance(instance_);
}

Status Renderer::start() {
    recorded_.clear = {static_cast<float>(SKY_R), static_cast<float>(SKY_G), static_cast<float>(SKY_B), 1};
    if (options_.background[0] >= 0) {
        recorded_.clear = options_.background;
        recorded_.clear[3] = 1;
    }
    instance_ = create_instance(options_.validation);
    const std::vector<EglDevice> egl = options_.device.empty() ? enumerate_egl_devices() : std::vector<EglDevice>();
    const Result<VkPhysicalDevice> physical = choose_device(instance_, options_.device, egl);
    if (!physical) return physical.error();
    device_ = create_device(*physical);
    pool_ = create_slot_pool(device_, options_.gpu_budget_bytes);
    coordinates_ = CoordinateLayers(options_.chart_transport);
    target_ = create_frame_target(device_, options_.width, options_.height, options_.supersample);
    if (options_.supersample > 1) filter_ = create_compute_pass(device_, k_box_filter_comp, sizeof(FilterConstants));
    refiner_.emplace(device_, pool_);
    strips_.emplace(device_, options_.index_arena_bytes);
    prism_indices_.emplace(device_);
    draw_records_.emplace(device_);
    tiles_.emplace(FrameTiles::Sources{&device_, &pool_, &*strips_, &coordinates_}, options_.facade_renderer,
                   options_.facade_tint);
    // Software drivers test depth before a fragment shader only where that writes none.
    passes_.emplace(device_, target_,
                    device_.has_fragment_atomics64 && options_.keyed_facades.value_or(device_.is_cpu));
    if (options_.meso)
        relief_.emplace(device_, pool_, options_.facade_renderer, options_.btf_budget_bytes, options_.btf_texels,
                        options_.relief_rays);
    timestamps_.emplace(device_);
    recorded_.device = &device_;
    recorded_.target = &target_;
    recorded_.passes = &*passes_;
    recorded_.mesh_draws = &mesh_draws_;
    recorded_.strips = &*strips_;
    recorded_.prism_indices = &*prism_indices_;
    recorded_.draw_records = &*draw_records_;
    recorded_.filter = &filter_;
    passes_->ensure_mesh(
        {LayerReading::kDirect, {}, {}, false, {}, RESIDENT_KIND_PRISMS | MESH_FORM_NARROW | MESH_FORM_SHARED});
    return Done{};
}

uint64_t Renderer::frame_buffer_bytes() const {
    return memory_bytes(target_) + tiles_->bytes() + draw_records_->bytes() + passes_->bytes() +
           refiner_->buffer_bytes() + strips_->bytes_allocated() + prism_indices_->bytes() +
           (lighting_ ? lighting_->bytes() : 0) + (relief_ ? relief_->buffer_bytes() : 0);
}

uint64_t Renderer::slots_used() const {
    const uint64_t of_light = (lighting_ ? lighting_->local_slots() : 0) + (relief_ ? relief_->slots_used() : 0);
    return pool_.slots_used - refiner_->held_slots() - of_light;
}

Status Renderer::append(LayerId layer, std::span<const uint32_t> words) {
    try {
        const bool is_begin = is_live(pool_, layer) && pool_.layers[layer].words == 0;
        refiner_->settle(layer);
        make_room(slots_to_append(pool_, layer, words.size()));
        Status status = append_words(pool_, layer, words);
        if (is_begin && status.ok()) {
            tiles_->learn(layer, words);
            strips_->learn(layer, words);
        }
        if (is_begin && status.ok()) mesh_draws_.learn(layer, words);
        if (relief_ && status.ok()) is_begin ? relief_->learn(layer, words) : relief_->forget_light(layer);
        const auto all_words = [&] { return read_words(pool_, layer, pool_.layers[layer].words); };
        if (mesh_draws_.is_partial(layer)) mesh_draws_.learn(layer, all_words());
        if (relief_ && relief_->is_partial(layer)) relief_->learn(layer, all_words());
        if (relief_ && tiles_->is_partial(layer)) tiles_->learn(layer, all_words());
        return status;
    } catch (const VulkanError& error) {
        return Error{error.what()};
    }
}

Result<uint64_t> Renderer::refine(LayerId layer, uint64_t begin, std::span<const uint32_t> planes, uint32_t to_level) {
    try {
        const Result<LayerRefinement> refinement = refiner_->plan(layer, begin, planes.size(), to_level);
        if (!refinement) return refinement.error();
        make_room(refinement->slots());
        if (const Status status = refiner_->add(*refinement, planes); !status) return status.error();
        mesh_draws_.set_level(layer, to_level);
        return 4 * refinement->words;
    } catch (const VulkanError& error) {
        return Error{error.what()};
    }
}

void Renderer::make_room(uint64_t slots) {
    refiner_->make_room(slots);
    coordinates_.make_room(slots, pool_);
    if (relief_) relief_->make_room(slots);
    if (lighting_) lighting_->make_room(slots);
}

FacadeTableHead Renderer::facade_table_head() const {
    FacadeTableHead head{};
    head.width = target_.width * target_.scale;
    head.height = target_.height * target_.scale;
    head.samples = options_.facade_samples;
    split(passes_->keys().address, head.keys);
    return head;
}

// The frame's tables, and whatever pipelines it misses: returns the time that those took.
Result<Clock::duration> Renderer::write_frame(const Camera& camera, std::span<const TileDraw> tiles, FrameKind kind) {
    const auto write = [&]() -> Status {
        auto frame = tiles_->write(camera, tiles, kind, lighting_ ? &*lighting_ : nullptr,
                                   relief_ ? &*relief_ : nullptr, facade_table_head(), counts_);
        if (!frame) return frame.error();
        frame_ = std::move(*frame);
        return Done{};
    };
    if (const Status status = write(); !status) return status.error();
    const auto begin = Clock::now();
    const ShadowMaps* const maps = kind == FrameKind::kShadow ? &lighting_->shadow_maps() : nullptr;
    const bool is_stale = passes_->ensure(frame_, mesh_draws_, maps);
    const Clock::duration making = Clock::now() - begin;
    if (is_stale) {
        if (const Status status = write(); !status) return status.error();
    }
    return making;
}

// Draws what the sun sees of the casters, in a submission of its own: strip code of casters may need other rounds than
// that of the picture.
Status Renderer::draw_cascade(const Camera& camera, uint32_t cascade) {
    if (const auto making = write_frame(camera, casters_, FrameKind::kShadow); !making) return making.error();
    const ShadowMaps& maps = lighting_->shadow_maps();
    frame_.constants = shadow_frame(lighting_->cascades()[cascade], camera_cell(camera.position), maps.side());
    if (const Status status = strips_->plan(); !status) return status.error();
    submit_and_wait(device_, [&](VkCommandBuffer commands) {
        draw_records_->begin_frame(frame_.mesh_ranges(), false);
        refiner_->record(commands);
        const FrameRecorder recorder(recorded_, frame_, counts_.mesh_draws);
        for (uint32_t round = 0; round < strips_->round_count(); ++round) {
            strips_->record_round(commands, round);
            maps.begin_pass(commands, round == 0);
            recorder.record_meshes(commands, round);
            vkCmdEndRenderPass(commands);
        }
        maps.keep(commands, cascade);
    });
    refiner_->finish();
    strips_->finish_frame();
    return Done{};
}

// Everything that a frame with a light needs before its own tables.
Status Renderer::prepare_light(const Camera& camera, std::span<const TileDraw> tiles) {
    if (!lighting_) {
        const uint32_t side = shadow_side(target_.width * target_.scale, target_.height * target_.scale);
        lighting_.emplace(device_, pool_, target_.load_pass, options_.shadow_side.value_or(side));
    }
    if (light_is_new_) lighting_->set_light(*light_);
    light_is_new_ = false;
    if (const Status status = lighting_->plan(camera, tiles, options_.meso); !status) return status.error();
    if (relief_) {
        const Status status =
            relief_->plan(camera, tiles, tiles_->map_facts(), *lighting_, target_.height * target_.scale);
        if (!status) return status.error();
    }
    if (lighting_->cascades().empty()) return Done{};
    add_casters(tiles);
    for (uint32_t i = 0; i < SHADOW_CASCADES; ++i) {
        if (const Status status = draw_cascade(camera, i); !status) return status.error();
    }
    return Done{};
}

void Renderer::record_sky(VkCommandBuffer commands) {
    barrier_between_passes(commands);
    begin_pass(commands, target_, target_.load_pass, recorded_.clear.data());
    lighting_->record_sky(commands, frame_.constants, target_.height * target_.scale);
    vkCmdEndRenderPass(commands);
}

void Renderer::record_frame(VkCommandBuffer commands) {
    const FrameRecorder recorder(recorded_, frame_, counts_.mesh_draws);
    const bool facades = frame_.has_facades();
    const bool lit = frame_.kind == FrameKind::kLit;
    timestamps_->reset(commands);
    timestamps_->mark(commands, kBegin);
    draw_records_->begin_frame(frame_.mesh_ranges(), lit);
    refiner_->record(commands);
    if (lit) {
        timestamps_->mark(commands, kLightBegin);
        lighting_->record_light(commands);
        if (relief_) relief_->record(commands);
        timestamps_->mark(commands, kLightDone);
    }
    begin_target(commands, target_);
    for (uint32_t round = 0; round < strips_->round_count(); ++round) {
        if (round > 0) {
            vkCmdEndRenderPass(commands);
            barrier_between_passes(commands);
        }
        strips_->record_round(commands, round);
        begin_pass(commands, target_, round == 0 ? target_.clear_pass : target_.load_pass, recorded_.clear.data());
        recorder.record_meshes(commands, round);
    }
    timestamps_->mark(commands, kMeshDone);
    if (facades) recorder.record_occluders(commands);
    vkCmdEndRenderPass(commands);
    if (facades) recorder.record_facades(commands);
    if (lit) record_sky(commands);
    timestamps_->mark(commands, kFacadesDone);
    recorder.record_readback(commands);
    timestamps_->mark(commands, kEnd);
}

FrameImage Renderer::read_frame() const {
    FrameImage image{target_.width, target_.height, {}};
    const auto* bytes = static_cast<const uint8_t*>(target_.readback.mapped);
    image.rgba.assign(bytes, bytes + size_t{4} * image.width * image.height);
    return image;
}

Result<FrameImage> Renderer::draw(const Camera& camera, std::span<const TileDraw> tiles, FrameTimings* timings) {
    if (camera.width != options_.width || camera.height != options_.height) {
        return Error{"the camera's picture size is not the renderer's"};
    }
    FrameTimings measured;
    try {
        auto record_begin = Clock::now();
        // Coordinates are made from words of meshes.
        if (coordinates_.wanted() != ChartTransport::kTable) refiner_->run();
        const FrameKind kind = light_ ? FrameKind::kLit : FrameKind::kPicture;
        if (light_) {
            const Status status = prepare_light(camera, tiles);
            casters_.clear();
            measured.shadow_ms = milliseconds_since(record_begin);
            record_begin = Clock::now();
            if (!status) return status.error();
        }
        const auto making = write_frame(camera, tiles, kind);
        if (!making) return making.error();
        record_begin += *making;
        if (const Status status = strips_->plan(); !status) return status.error();
        counts_.strip_rounds = strips_->counts().rounds;
        counts_.decoded_strip_triangles = strips_->counts().decoded_triangles;
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            record_frame(commands);
            measured.cpu_record_ms = milliseconds_since(record_begin);
        });
        refiner_->finish();
        strips_->finish_frame();
        if (light_) {
            lighting_->finish();
            if (relief_) {
                relief_->finish();
                relief_->count(counts_);
                counts_.local_light_bytes = lighting_->local_slots() * kSlotBytes;
            }
            counts_.radiance_tiles = static_cast<uint32_t>(lighting_->counts().tiles);
            counts_.radiance_receivers = lighting_->counts().receivers;
        }
        timestamps_->read(kind == FrameKind::kLit, measured);
        const auto readback_begin = Clock::now();
        FrameImage image = read_frame();
        measured.readback_ms = milliseconds_since(readback_begin);
        if (timings != nullptr) *timings = measured;
        return image;
    } catch (const VulkanError& error) {
        return Error{error.what()};
    }
}

Status Renderer::set_light(const FrameLight* light) {
    if (light == nullptr) {
        light_.reset();
        lighting_.reset();
        return Done{};
    }
    // Of the same number all is the same but exposure and sun.
    const bool same = light_ && light_->number == light->number;
    if (const Status status = same ? check_sun_and_exposure(*light) : check_light(*light); !status)
        return status.error();
    if (!same) light_ = *light;
    light_->exposure = light->exposure;
    light_->sun = light->sun;
    light_is_new_ = true;
    return Done{};
}

void Renderer::add_casters(std::span<const TileDraw> tiles) {
    for (const TileDraw& tile : tiles) {
        if (tile.mesh != kNoLayer) casters_.push_back(caster_of(tile));
    }
}

void Renderer::set_casters(std::span<const TileDraw> casters) {
    casters_.clear();
    if (light_) add_casters(casters);
}

Status check_options(const RendererOptions& options) {
    if (std::find(kFacadeSampleCounts.begin(), kFacadeSampleCounts.end(), options.facade_samples) ==
        kFacadeSampleCounts.end()) {
        return Error{"facade pixels cast 1, 5 or 13 rays"};
    }
    if (options.width == 0 || options.height == 0 || options.supersample == 0 || options.supersample > 4) {
        return Error{"picture size and samples must be positive, samples at most 4 a side"};
    }
    if (uint64_t{options.width} * options.supersample > 16384 ||
        uint64_t{options.height} * options.supersample > 16384) {
        return Error{"pictures are at most 16384 samples wide and high"};
    }
    if (options.shadow_side && (*options.shadow_side < 64 || *options.shadow_side > 8192))
        return Error{"shadow maps have 64 to 8192 texels a side"};
    return Done{};
}

}  // namespace

Result<std::unique_ptr<VulkanRenderer>> VulkanRenderer::create(const RendererOptions& options) {
    if (const Status status = check_options(options); !status) return status.error();
    auto renderer = std::make_unique<Renderer>(options);
    try {
        if (const Status status = renderer->start(); !status) return status.error();
    } catch (const VulkanError& error) {
        return Error{error.what()};
    }
    return std::unique_ptr<VulkanRenderer>(std::move(renderer));
}

}  // namespace citystream::client
