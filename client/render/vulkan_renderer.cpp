#include "client/render/vulkan_renderer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>

#include "client/render/coordinate_layers.h"
#include "client/render/device_choice.h"
#include "client/render/draw_layout.h"
#include "client/render/draw_records.h"
#include "client/render/facade_map_facts.h"
#include "client/render/facade_renderer_layout.h"
#include "client/render/frame_constants.h"
#include "client/render/frame_lighting.h"
#include "client/render/layer_refiner.h"
#include "client/render/light_constants.h"
#include "client/render/lighting_layout.h"
#include "client/render/mesh_draws.h"
#include "client/render/pipelines.h"
#include "client/render/prism_indices.h"
#include "client/render/slot_pool.h"
#include "client/render/strip_ranges.h"
#include "shaders/box_filter.comp.h"

namespace citystream::client {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

// Stages between two timestamps each.
enum Timestamp : uint32_t { kBegin, kMeshDone, kFacadesDone, kEnd, kLightBegin, kLightDone, kTimestampCount };
/// Of frames without a light.
constexpr uint32_t kPlainTimestamps = kLightBegin;

constexpr VkShaderStageFlags kDrawStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

void split(VkDeviceAddress address, uint32_t out[2]) {
    out[0] = static_cast<uint32_t>(address);
    out[1] = static_cast<uint32_t>(address >> 32);
}

VkDeviceAddress joined(const uint32_t words[2]) {
    return words[0] | VkDeviceAddress{words[1]} << 32;
}

// Distance from the camera to the tile's origin decides the order: exact enough for early depth tests, and the same in
// every run.
double origin_distance(const Camera& camera, const TileDraw& tile) {
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double d = tile.origin[i] - camera.position[i];
        sum += d * d;
    }
    return sum;
}

std::vector<size_t> front_to_back(const Camera& camera, std::span<const TileDraw> tiles) {
    std::vector<double> distance(tiles.size());
    for (size_t i = 0; i < tiles.size(); ++i) distance[i] = origin_distance(camera, tiles[i]);
    std::vector<size_t> order(tiles.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return distance[a] < distance[b]; });
    return order;
}

// Vertices of a draw on a software driver: llvmpipe shades 4,096 at a time and, when one of them is clipped, hands all
// to a slow path whose time grows with their square. Measured on a street flight: 1,536 take half the time of one draw
// a tile, 384 and 4,096 more.
constexpr uint32_t kSoftwarePiece = 1536;
static_assert(kSoftwarePiece % 3 == 0);
/// Indices of a draw of prisms.
constexpr uint32_t kPrismPiece = 12288;

bool has_facades(const TileDraw& tile) {
    return tile.facade != kNoLayer && !tile.map_of_placement.empty();
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

bool in_pages(const TileDraw& tile) {
    return tile.atlas != kNoLayer && tile.atlas_form == codec::atlas::AtlasForm::kPages;
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
    uint64_t slots_used() const override { return pool_.slots_used - refiner_->held_slots(); }
    LayerId create() override { return create_layer(pool_); }
    Status append(LayerId layer, std::span<const uint32_t> words) override;
    Result<uint64_t> refine(LayerId layer, uint64_t begin, std::span<const uint32_t> planes,
                            uint32_t to_level) override;
    void destroy(LayerId layer) override {
        refiner_->forget(layer);
        strips_->forget(layer);
        mesh_draws_.forget(layer);
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
    bool has_facade_pipeline() const override { return facade_indices_.handle != VK_NULL_HANDLE; }
    bool has_radiance_pipeline() const override { return lighting_.has_value(); }

  private:
    /// What the tables of a frame are for: a picture, lit by its light or not, or one of the sun's shadow maps.
    enum class Frame { kPicture, kLit, kShadow };
    struct DrawnTile {
        const TileDraw* tile;
        TileConstants constants;
        RadianceDraw radiance;  ///< in a lit frame
        uint32_t casters;       ///< one bit each: those that its placements' maps need
        PassVariant mesh;
        const std::vector<ChartRun>* runs;  ///< one draw each; null: one for all triangles
        size_t first_strip = 0;             ///< of strips_: its first range of strip code

        /// Of one of its ranges. Runs begin at any triangle: their prisms share no vertices.
        PassVariant mesh_of(const MeshDrawConstants& range) const {
            PassVariant variant = mesh;
            variant.mesh_form = range.form & ~(RESIDENT_FLAG_DRESSED << 8);
            if ((range.form & 255) == RESIDENT_KIND_PRISMS && runs == nullptr) variant.mesh_form |= MESH_FORM_SHARED;
            return variant;
        }
        PassVariant facade() const {
            PassVariant variant = mesh;
            variant.transport = {};
            variant.alpha_test = false;
            variant.mesh_form = MESH_FORM_ANY;
            return variant;
        }
        PassVariant occluder() const { return {mesh.reading, {}, {}, false, {}}; }
    };
    /// Made when the first tile needs them.
    using Passes = std::map<PassVariant, Pass>;

    static uint32_t placements_of(const DrawnTile& drawn) {
        return static_cast<uint32_t>(drawn.tile->map_of_placement.size());
    }
    void make_room(uint64_t slots);
    void ensure_tables(uint64_t words);
    bool ensure_mesh_pass(const PassVariant& variant);
    bool ensure_facade_passes(const DrawnTile& drawn);
    bool ensure_passes();
    uint32_t casters_of(const TileDraw& tile) const;
    FacadeTableHead facade_table_head() const;
    void warm_up(const Pass& pass, uint32_t vertices);
    Result<DrawnTile> add_to_tables(FrameTables& tables, const TileDraw& tile, const CameraCell& cell);
    Status write_tables(const Camera& camera, std::span<const TileDraw> tiles, Frame frame);
    Status prepare_light(const Camera& camera, std::span<const TileDraw> tiles);
    Status draw_cascade(const Camera& camera, uint32_t cascade);
    void add_casters(std::span<const TileDraw> tiles);
    uint64_t drawn_ranges() const;
    void record_frame(VkCommandBuffer commands);
    void record_meshes(VkCommandBuffer commands, uint32_t round);
    void record_tile(VkCommandBuffer commands, const DrawnTile& drawn, uint32_t round, VkPipeline& bound);
    const ChartRun* record_runs(VkCommandBuffer commands, const Pass& pass, uint32_t range, const ChartRun* run,
                                const ChartRun* end);
    void record_triangles(VkCommandBuffer commands, uint32_t first, uint32_t count);
    void record_occluders(VkCommandBuffer commands);
    void record_facades(VkCommandBuffer commands);
    void record_resolve(VkCommandBuffer commands);
    void record_sky(VkCommandBuffer commands);
    void record_readback(VkCommandBuffer commands);
    void push_constants(VkCommandBuffer commands, const Pass& pass, const TileConstants& tile) const;
    void bind_for(VkCommandBuffer commands, const Pass& pass, const TileConstants& tile, VkPipeline& bound) const;
    void mark(VkCommandBuffer commands, Timestamp stamp) const;
    void read_timestamps(FrameTimings& timings) const;
    FrameImage read_frame() const;

    RendererOptions options_;
    std::array<float, 4> clear_{};
    Instance instance_;
    Device device_;
    SlotPool pool_;
    std::optional<LayerRefiner> refiner_;
    std::optional<StripRanges> strips_;
    MeshDraws mesh_draws_;
    std::optional<PrismIndices> prism_indices_;
    std::optional<DrawRecords> draw_records_;
    FrameTarget target_;
    Pass resolve_, filter_;
    Passes mesh_, occluder_, shadow_;
    std::array<Passes, FACADE_RENDERER_COUNT> facades_;  ///< by caster
    CoordinateLayers coordinates_;
    FrameCounts counts_;
    Buffer facade_indices_;
    Buffer keys_;  ///< of the keyed facade pass
    bool keyed_facades_ = false;
    std::vector<FacadeMapFacts> map_facts_;  ///< by layer
    Buffer tables_;
    VkQueryPool timestamps_ = VK_NULL_HANDLE;
    FrameConstants frame_{};
    Frame kind_ = Frame::kPicture;  ///< of the tables
    std::optional<FrameLight> light_;
    bool light_is_new_ = false;  ///< not yet in lighting_
    std::optional<FrameLighting> lighting_;
    std::vector<TileDraw> casters_;  ///< out of view; while a light is prepared with those that are drawn
    std::vector<DrawnTile> drawn_;
};

Renderer::~Renderer() {
    if (device_.handle != VK_NULL_HANDLE) {
        vkDeviceWaitIdle(device_.handle);
        refiner_.reset();
        strips_.reset();
        prism_indices_.reset();
        draw_records_.reset();
        lighting_.reset();
        destroy_slot_pool(pool_);
        destroy_frame_target(device_, target_);
        const auto destroy = [&](Pass& pass) { destroy_pass(device_, pass); };
        destroy(resolve_);
        destroy(filter_);
        const auto destroy_all = [&](Passes& passes) {
            for (auto& [variant, pass] : passes) destroy(pass);
        };
        destroy_all(mesh_);
        destroy_all(occluder_);
        destroy_all(shadow_);
        std::ranges::for_each(facades_, destroy_all);
        destroy_buffer(device_, facade_indices_);
        destroy_buffer(device_, keys_);
        destroy_buffer(device_, tables_);
        vkDestroyQueryPool(device_.handle, timestamps_, nullptr);
    }
    destroy_device(device_);
    destroy_instance(instance_);
}

Status Renderer::start() {
    clear_ = {static_cast<float>(SKY_R), static_cast<float>(SKY_G), static_cast<float>(SKY_B), 1};
    if (options_.background[0] >= 0) {
        clear_ = options_.background;
        clear_[3] = 1;
    }
    instance_ = create_instance(options_.validation);
    const std::vector<EglDevice> egl = options_.device.empty() ? enumerate_egl_devices() : std::vector<EglDevice>();
    const Result<VkPhysicalDevice> physical = choose_device(instance_, options_.device, egl);
    if (!physical) return physical.error();
    device_ = create_device(*physical);
    // Software drivers test depth before a fragment shader only where that writes none.
    keyed_facades_ = device_.has_fragment_atomics64 && options_.keyed_facades.value_or(device_.is_cpu);
    pool_ = create_slot_pool(device_, options_.gpu_budget_bytes);
    refiner_.emplace(device_, pool_);
    strips_.emplace(device_, options_.index_arena_bytes);
    prism_indices_.emplace(device_);
    draw_records_.emplace(device_);
    coordinates_ = CoordinateLayers(options_.chart_transport);
    target_ = create_frame_target(device_, options_.width, options_.height, options_.supersample);
    if (options_.supersample > 1) filter_ = create_compute_pass(device_, k_box_filter_comp, sizeof(FilterConstants));
    auto queries = vk_struct<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = kTimestampCount;
    vk_check(vkCreateQueryPool(device_.handle, &queries, nullptr, &timestamps_), "vkCreateQueryPool");
    ensure_mesh_pass(
        {LayerReading::kDirect, {}, {}, false, {}, RESIDENT_KIND_PRISMS | MESH_FORM_NARROW | MESH_FORM_SHARED});
    return Done{};
}

uint64_t Renderer::frame_buffer_bytes() const {
    return memory_bytes(target_) + tables_.bytes + draw_records_->bytes() + facade_indices_.bytes + keys_.bytes +
           refiner_->buffer_bytes() + strips_->bytes_allocated() + prism_indices_->bytes() +
           (lighting_ ? lighting_->bytes() : 0);
}

Status Renderer::append(LayerId layer, std::span<const uint32_t> words) {
    try {
        const bool is_begin = is_live(pool_, layer) && pool_.layers[layer].words == 0;
        refiner_->settle(layer);
        make_room(slots_to_append(pool_, layer, words.size()));
        Status status = append_words(pool_, layer, words);
        if (is_begin && status.ok()) {
            map_facts_.resize(pool_.layers.size());
            map_facts_[layer] = facade_map_facts(words);
            strips_->learn(layer, words);
        }
        if (is_begin && status.ok()) mesh_draws_.learn(layer, words);
        if (mesh_draws_.is_partial(layer))
            mesh_draws_.learn(layer, read_words(pool_, layer, pool_.layers[layer].words));
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
}

void Renderer::ensure_tables(uint64_t words) {
    const uint64_t bytes = words * 4;
    if (tables_.bytes >= bytes) return;
    destroy_buffer(device_, tables_);
    tables_ = create_buffer(device_, std::max<uint64_t>(64 << 10, bytes + bytes / 2), BufferPlace::kUpload);
}

uint32_t Renderer::casters_of(const TileDraw& tile) const {
    uint32_t casters = 0;
    if (!has_facades(tile)) return 0;
    for (const FacadeMapBinding& map : tile.facade_maps) {
        if (map.layer >= map_facts_.size()) continue;
        const auto caster = caster_for(options_.facade_renderer, map_facts_[map.layer].form);
        if (caster) casters |= 1u << *caster;
    }
    return casters;
}

bool Renderer::ensure_mesh_pass(const PassVariant& variant) {
    if (kind_ == Frame::kShadow) {
        if (!shadow_.contains(variant))
            shadow_[variant] = create_mesh_shadow_pass(device_, lighting_->shadow_maps().render_pass(), variant);
        return false;
    }
    if (mesh_.contains(variant)) return false;
    const Pass pass = mesh_[variant] = create_mesh_pass(device_, target_.clear_pass, variant);
    warm_up(pass, 3);
    return true;
}

// What the facade pass needs is made when the first tile with relief is drawn, each caster with the first map in its
// form.
bool Renderer::ensure_facade_passes(const DrawnTile& drawn) {
    bool made = false;
    if (facade_indices_.handle == VK_NULL_HANDLE) {
        facade_indices_ = create_buffer(device_, facade_indices().size_bytes(), BufferPlace::kUpload);
        std::memcpy(facade_indices_.mapped, facade_indices().data(), facade_indices().size_bytes());
        if (keyed_facades_) {
            resolve_ = create_facade_resolve_pass(device_, target_.load_pass);
            keys_ = create_buffer(device_, uint64_t{8} * target_.width * target_.height * target_.scale * target_.scale,
                                  BufferPlace::kDevice);
        }
    }
    if (!occluder_.contains(drawn.occluder()))
        occluder_[drawn.occluder()] = create_facade_occluder_pass(device_, target_.clear_pass, drawn.occluder());
    for (uint32_t caster = 0; caster < FACADE_RENDERER_COUNT; ++caster) {
        if ((drawn.casters >> caster & 1) == 0 || facades_[caster].contains(drawn.facade())) continue;
        const Pass pass = facades_[caster][drawn.facade()] =
            create_facade_pass(device_, target_.load_pass, caster, keyed_facades_, drawn.facade());
        warm_up(pass, kFacadeIndices);
        made = true;
    }
    return made;
}

// Makes the passes that the drawn tiles miss. True: some were made, and warming them up took the tables.
bool Renderer::ensure_passes() {
    bool made = false;
    for (const DrawnTile& drawn : drawn_) {
        for (uint32_t range = 0; range < drawn.tile->mesh_ranges.size(); ++range)
            made |= ensure_mesh_pass(drawn.mesh_of(mesh_draws_.of(drawn.tile->mesh, range)));
        if (drawn.casters != 0) made |= ensure_facade_passes(drawn);
    }
    return made;
}

FacadeTableHead Renderer::facade_table_head() const {
    FacadeTableHead head{};
    head.width = target_.width * target_.scale;
    head.height = target_.height * target_.scale;
    head.samples = options_.facade_samples;
    split(keys_.address, head.keys);
    return head;
}

// Draws one invisible primitive, so that drivers which compile at the first draw do it now and not in a measured frame.
// All-zero words are a tile without vertices or atlas: every corner falls on one point.
void Renderer::warm_up(const Pass& pass, uint32_t vertices) {
    constexpr uint64_t kZeroWords = 1024;
    ensure_tables(kZeroWords);
    std::memset(tables_.mapped, 0, kZeroWords * 4);
    TileConstants tile{};
    for (uint32_t* reference : {tile.mesh, tile.atlas, tile.facade, tile.shared_charts})
        split(tables_.address | LAYER_REF_DIRECT, reference);
    // No corner is beyond the zeros.
    constexpr uint64_t kDraw = kZeroWords / 4 * 3 * 4;
    LitMeshDraw draw{};
    split(tables_.address, draw.draw.corners);
    split(tables_.address, draw.radiance.light);
    std::memcpy(static_cast<std::byte*>(tables_.mapped) + kDraw, &draw, sizeof draw);
    split(tables_.address + kDraw, tile.mesh_draw);
    // One placement, of which the tile has no map.
    constexpr uint64_t kTable = kZeroWords / 2 * 4;
    FacadeTableHead head{};
    split(tables_.address, head.map_of_placement);
    std::memcpy(static_cast<std::byte*>(tables_.mapped) + kTable, &head, sizeof head);
    split(tables_.address + kTable, tile.facade_maps);
    frame_ = {};
    submit_and_wait(device_, [&](VkCommandBuffer commands) {
        begin_target(commands, target_);
        begin_pass(commands, target_, target_.clear_pass, clear_.data());
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.handle);
        push_constants(commands, pass, tile);
        if (vertices == kFacadeIndices) {
            vkCmdBindIndexBuffer(commands, facade_indices_.handle, 0, VK_INDEX_TYPE_UINT16);
            vkCmdDrawIndexed(commands, vertices, 1, 0, 0, 0);
        } else {
            vkCmdDraw(commands, vertices, 1, 0, 0);
        }
        vkCmdEndRenderPass(commands);
    });
}

void Renderer::push_constants(VkCommandBuffer commands, const Pass& pass, const TileConstants& tile) const {
    const DrawConstants constants{frame_, tile};
    vkCmdPushConstants(commands, pass.layout, kDrawStages, 0, sizeof constants, &constants);
}

// Binds the pass unless it is `bound`.
void Renderer::bind_for(VkCommandBuffer commands, const Pass& pass, const TileConstants& tile,
                        VkPipeline& bound) const {
    if (bound != pass.handle) vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.handle);
    bound = pass.handle;
    push_constants(commands, pass, tile);
}

// A tile whose atlas is in pages takes the coordinates of its transport, too.
Result<Renderer::DrawnTile> Renderer::add_to_tables(FrameTables& tables, const TileDraw& tile, const CameraCell& cell) {
    const auto constants = tables.add_tile(tile, cell);
    if (!constants) return constants.error();
    DrawnTile drawn{&tile, *constants, {}, casters_of(tile), {}, nullptr};
    const auto first_strip = strips_->add(tile, joined(constants->mesh), !has_facades(tile));
    if (!first_strip) return first_strip.error();
    drawn.first_strip = *first_strip;
    if (in_pages(tile)) {
        const CoordinateLayers::Coordinates& coordinates = coordinates_.of(tile, pool_);
        const Status named = tables.add_coordinates(coordinates.layer, drawn.constants);
        if (!named) return named.error();
        drawn.mesh.form = codec::atlas::AtlasForm::kPages;
        drawn.mesh.transport = coordinates.transport;
        if (coordinates.transport == ChartTransport::kUniform) drawn.runs = &coordinates.runs;
        ++counts_.page_tiles;
        if (tile.mesh != kNoLayer && coordinates.transport != coordinates_.wanted()) ++counts_.fallback_tiles;
    }
    if (kind_ == Frame::kLit) {
        const auto radiance = tables.add_radiance(tile.radiance, lighting_->address(), drawn.constants);
        if (!radiance) return radiance.error();
        drawn.radiance = *radiance;
    }
    drawn.mesh.reading = tables.is_direct() ? LayerReading::kDirect : LayerReading::kPaged;
    drawn.mesh.alpha_test = tile.alpha_test;
    drawn.mesh.tint = options_.facade_tint;
    drawn.mesh.lit = kind_ == Frame::kLit;
    drawn.mesh.sun = drawn.mesh.lit && lighting_->has_sun();
    drawn.mesh.receivers = drawn.mesh.lit && tile.radiance != kNoLayer;
    return drawn;
}

Status Renderer::write_tables(const Camera& camera, std::span<const TileDraw> tiles, Frame frame) {
    kind_ = frame;
    counts_ = {};
    for (const TileDraw& tile : tiles) {
        if (in_pages(tile)) coordinates_.of(tile, pool_);
    }
    counts_.coordinate_bytes = coordinates_.slots_used() * kSlotBytes;
    ensure_tables(FrameTables::bound(pool_, tiles, frame == Frame::kLit));
    const CameraCell cell = camera_cell(camera.position);
    frame_ = make_frame_constants(camera, cell, options_.facade_tint);
    strips_->begin_frame();
    FrameTables tables(pool_, tables_.address, map_facts_, facade_table_head());
    drawn_.clear();
    for (const size_t i : front_to_back(camera, tiles)) {
        const Result<DrawnTile> drawn = add_to_tables(tables, tiles[i], cell);
        if (!drawn) return drawn.error();
        drawn_.push_back(*drawn);
    }
    if (!tables.words().empty()) std::memcpy(tables_.mapped, tables.words().data(), tables.words().size_bytes());
    return Done{};
}

void Renderer::mark(VkCommandBuffer commands, Timestamp stamp) const {
    if (device_.timestamp_nanoseconds == 0) return;
    const VkPipelineStageFlagBits stage =
        stamp == kBegin ? VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT : VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT;
    vkCmdWriteTimestamp(commands, stage, timestamps_, stamp);
}

void Renderer::record_triangles(VkCommandBuffer commands, uint32_t first, uint32_t count) {
    const uint32_t piece = device_.is_cpu ? kSoftwarePiece : 3 * count;
    for (uint32_t begin = 0; begin < 3 * count; begin += piece) {
        vkCmdDraw(commands, std::min(piece, 3 * count - begin), 1, 3 * first + begin, 0);
        ++counts_.mesh_draws;
    }
}

// One draw for each run of a range, its chart in the push constants. Returns the first run of a later range.
const ChartRun* Renderer::record_runs(VkCommandBuffer commands, const Pass& pass, uint32_t range, const ChartRun* run,
                                      const ChartRun* end) {
    constexpr uint32_t kChart = offsetof(DrawConstants, tile) + offsetof(TileConstants, shared_charts);
    for (; run != end && run->range == range; ++run) {
        vkCmdPushConstants(commands, pass.layout, kDrawStages, kChart, sizeof run->words, run->words.data());
        record_triangles(commands, run->first, run->triangles);
    }
    return run;
}

// The ranges that the round draws: all but strip code in the first, strip code when its corners are there.
void Renderer::record_tile(VkCommandBuffer commands, const DrawnTile& drawn, uint32_t round, VkPipeline& bound) {
    const auto& ranges = drawn.tile->mesh_ranges;
    const bool dressed = !has_facades(*drawn.tile);
    size_t strip = drawn.first_strip;
    const ChartRun* run = drawn.runs != nullptr ? drawn.runs->data() : nullptr;
    const ChartRun* runs_end = drawn.runs != nullptr ? run + drawn.runs->size() : nullptr;
    TileConstants constants = drawn.constants;
    for (uint32_t range = 0; range < ranges.size(); ++range) {
        if (ranges[range].dressed && !dressed) continue;
        const bool is_strips = ranges[range].kind == RESIDENT_KIND_STRIP_CODE;
        const StripPlace place = is_strips ? strips_->place(strip++) : StripPlace();
        if (place.round != round) continue;
        while (run != runs_end && run->range < range) ++run;
        const MeshDrawConstants draw = mesh_draws_.of(drawn.tile->mesh, range);
        const Pass& pass = (kind_ == Frame::kShadow ? shadow_ : mesh_).at(drawn.mesh_of(draw));
        split(draw_records_->add(draw, place.corners, drawn.radiance), constants.mesh_draw);
        bind_for(commands, pass, constants, bound);
        if (drawn.runs != nullptr) {
            run = record_runs(commands, pass, range, run, runs_end);
        } else if ((draw.form & 255) == RESIDENT_KIND_PRISMS) {
            counts_.mesh_draws += prism_indices_->record(commands, draw, ranges[range].triangles,
                                                         device_.is_cpu ? kSoftwarePiece : kPrismPiece);
        } else {
            record_triangles(commands, 0, ranges[range].triangles);
        }
    }
}

void Renderer::record_meshes(VkCommandBuffer commands, uint32_t round) {
    VkPipeline bound = VK_NULL_HANDLE;
    for (const DrawnTile& drawn : drawn_) {
        if (drawn.tile->mesh != kNoLayer) record_tile(commands, drawn, round, bound);
    }
}

// Behind the backs of opaque facades nothing is cast.
void Renderer::record_occluders(VkCommandBuffer commands) {
    VkPipeline bound = VK_NULL_HANDLE;
    vkCmdBindIndexBuffer(commands, facade_indices_.handle, 0, VK_INDEX_TYPE_UINT16);
    for (const DrawnTile& drawn : drawn_) {
        if (drawn.casters == 0) continue;
        bind_for(commands, occluder_.at(drawn.occluder()), drawn.constants, bound);
        vkCmdDrawIndexed(commands, kOccluderIndices, placements_of(drawn), 0, 0, 0);
    }
}

void Renderer::record_facades(VkCommandBuffer commands) {
    if (keyed_facades_) {
        vkCmdFillBuffer(commands, keys_.handle, 0, VK_WHOLE_SIZE, 0);
        memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
    }
    barrier_between_passes(commands);
    begin_pass(commands, target_, target_.load_pass, clear_.data());
    vkCmdBindIndexBuffer(commands, facade_indices_.handle, 0, VK_INDEX_TYPE_UINT16);
    for (uint32_t caster = 0; caster < FACADE_RENDERER_COUNT; ++caster) {
        VkPipeline bound = VK_NULL_HANDLE;
        for (const DrawnTile& drawn : drawn_) {
            if ((drawn.casters >> caster & 1) == 0) continue;
            bind_for(commands, facades_[caster].at(drawn.facade()), drawn.constants, bound);
            vkCmdDrawIndexed(commands, kFacadeIndices, placements_of(drawn), 0, 0, 0);
        }
    }
    vkCmdEndRenderPass(commands);
    if (keyed_facades_) record_resolve(commands);
}

void Renderer::record_resolve(VkCommandBuffer commands) {
    memory_barrier(commands, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
    barrier_between_passes(commands);
    begin_pass(commands, target_, target_.load_pass, clear_.data());
    const FacadeTableHead head = facade_table_head();
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, resolve_.handle);
    vkCmdPushConstants(commands, resolve_.layout, kDrawStages, 0, sizeof head, &head);
    vkCmdDraw(commands, 3, 1, 0, 0);
    vkCmdEndRenderPass(commands);
}

void Renderer::record_sky(VkCommandBuffer commands) {
    barrier_between_passes(commands);
    begin_pass(commands, target_, target_.load_pass, clear_.data());
    lighting_->record_sky(commands, frame_, target_.height * target_.scale);
    vkCmdEndRenderPass(commands);
}

void Renderer::record_readback(VkCommandBuffer commands) {
    copy_colour(commands, target_, target_.scale > 1 ? target_.samples : target_.readback);
    if (target_.scale > 1) {
        memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
        FilterConstants constants{{}, {}, target_.width, target_.height, target_.scale, 0};
        split(target_.samples.address, constants.source);
        split(target_.readback.address, constants.target);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, filter_.handle);
        vkCmdPushConstants(commands, filter_.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
        vkCmdDispatch(commands, (target_.width + 7) / 8, (target_.height + 7) / 8, 1);
    }
    memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                   VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                   VK_ACCESS_HOST_READ_BIT);
}

uint64_t Renderer::drawn_ranges() const {
    uint64_t ranges = 0;
    for (const DrawnTile& drawn : drawn_) ranges += drawn.tile->mesh_ranges.size();
    return ranges;
}

// Draws what the sun sees of the casters, in a submission of its own: strip code of casters may need other rounds than
// that of the picture.
Status Renderer::draw_cascade(const Camera& camera, uint32_t cascade) {
    if (const Status status = write_tables(camera, casters_, Frame::kShadow); !status) return status.error();
    ensure_passes();
    const ShadowMaps& maps = lighting_->shadow_maps();
    frame_ = shadow_frame(lighting_->cascades()[cascade], camera_cell(camera.position), maps.side());
    if (const Status status = strips_->plan(); !status) return status.error();
    submit_and_wait(device_, [&](VkCommandBuffer commands) {
        draw_records_->begin_frame(drawn_ranges(), false);
        refiner_->record(commands);
        for (uint32_t round = 0; round < strips_->round_count(); ++round) {
            strips_->record_round(commands, round);
            maps.begin_pass(commands, round == 0);
            record_meshes(commands, round);
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
    if (const Status status = lighting_->plan(camera, tiles); !status) return status.error();
    if (lighting_->cascades().empty()) return Done{};
    add_casters(tiles);
    for (uint32_t i = 0; i < SHADOW_CASCADES; ++i) {
        if (const Status status = draw_cascade(camera, i); !status) return status.error();
    }
    return Done{};
}

void Renderer::record_frame(VkCommandBuffer commands) {
    const bool facades = std::any_of(drawn_.begin(), drawn_.end(), [](const DrawnTile& d) { return d.casters != 0; });
    if (device_.timestamp_nanoseconds != 0) vkCmdResetQueryPool(commands, timestamps_, 0, kTimestampCount);
    mark(commands, kBegin);
    const bool lit = kind_ == Frame::kLit;
    draw_records_->begin_frame(drawn_ranges(), lit);
    refiner_->record(commands);
    if (lit) {
        mark(commands, kLightBegin);
        lighting_->record_light(commands);
        mark(commands, kLightDone);
    }
    begin_target(commands, target_);
    for (uint32_t round = 0; round < strips_->round_count(); ++round) {
        if (round > 0) {
            vkCmdEndRenderPass(commands);
            barrier_between_passes(commands);
        }
        strips_->record_round(commands, round);
        begin_pass(commands, target_, round == 0 ? target_.clear_pass : target_.load_pass, clear_.data());
        record_meshes(commands, round);
    }
    mark(commands, kMeshDone);
    if (facades) record_occluders(commands);
    vkCmdEndRenderPass(commands);
    if (facades) record_facades(commands);
    if (lit) record_sky(commands);
    mark(commands, kFacadesDone);
    record_readback(commands);
    mark(commands, kEnd);
}

void Renderer::read_timestamps(FrameTimings& timings) const {
    if (device_.timestamp_nanoseconds == 0) return;
    std::array<uint64_t, kTimestampCount> ticks{};
    const uint32_t count = kind_ == Frame::kLit ? kTimestampCount : kPlainTimestamps;
    vk_check(vkGetQueryPoolResults(device_.handle, timestamps_, 0, count, sizeof ticks, ticks.data(), sizeof ticks[0],
                                   VK_QUERY_RESULT_64_BIT),
             "vkGetQueryPoolResults");
    const auto between = [&](Timestamp from, Timestamp to) {
        return static_cast<double>(ticks[to] - ticks[from]) * device_.timestamp_nanoseconds * 1e-6;
    };
    timings.gpu_mesh_ms = between(kBegin, kMeshDone);
    timings.gpu_facade_ms = between(kMeshDone, kFacadesDone);
    timings.gpu_total_ms = between(kBegin, kEnd);
    timings.gpu_light_ms = between(kLightBegin, kLightDone);
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
        const Frame kind = light_ ? Frame::kLit : Frame::kPicture;
        if (light_) {
            const Status status = prepare_light(camera, tiles);
            casters_.clear();
            measured.shadow_ms = milliseconds_since(record_begin);
            record_begin = Clock::now();
            if (!status) return status.error();
        }
        if (const Status status = write_tables(camera, tiles, kind); !status) return status.error();
        if (ensure_passes()) {
            record_begin = Clock::now();
            if (const Status status = write_tables(camera, tiles, kind); !status) return status.error();
        }
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
            counts_.radiance_tiles = static_cast<uint32_t>(lighting_->counts().tiles);
            counts_.radiance_receivers = lighting_->counts().receivers;
        }
        read_timestamps(measured);
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
