#include "client/stream/city_streamer.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "client/cache/directory_cache.h"
#include "client/cache/layer_cache.h"
#include "client/render/shadow_cascades.h"
#include "client/select/caster_selection.h"
#include "client/select/selection.h"
#include "client/stream/chart_residency.h"
#include "client/stream/dictionary_pieces.h"
#include "client/stream/draw_list.h"
#include "client/stream/light_residency.h"
#include "client/stream/occlusion.h"
#include "client/stream/request_cost.h"
#include "client/stream/request_plan.h"
#include "client/stream/setbacks.h"
#include "client/stream/tile_residency.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::client {

using tiles::tileset::kLayerCount;
using tiles::tileset::Layer;
using tiles::tileset::Manifest;
using tiles::tileset::TileAddress;

namespace {

using Clock = std::chrono::steady_clock;

constexpr uint64_t kManifestLimit = 4u << 20;
constexpr int kMostRounds =
    256;  // of one waiting update; each learns something, so this is never the limit in practice
constexpr std::chrono::milliseconds kWaitSlice{100};
constexpr uint32_t kUnwantedUpdates =
    2;  // before a request is cancelled: a view that wavers at a threshold wastes no bytes

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Of the root when it stands in for a view: the whole mesh, for its first step alone looks like nothing.
uint8_t stand_in_steps(const tiles::tileset::TileRecord& root, Layer layer) {
    const size_t steps = root.steps(layer).size();
    return static_cast<uint8_t>(layer == Layer::kMesh ? steps : std::min<size_t>(1, steps));
}

MapOptions map_options(const StreamerOptions& options) {
    MapOptions maps;
    maps.decode = options.decode;
    if (options.facade_form) maps.target = MapTarget{*options.facade_form, options.facade_boxes};
    maps.threads = options.map_threads;
    // A conversion may take seconds: a frame that does not wait starts few.
    if (!options.wait_for_selection) maps.most_conversions = std::max(1u, std::thread::hardware_concurrency());
    return maps;
}

LightOptions light_options(const StreamerOptions& options) {
    return {options.decode, options.wait_for_selection, options.light_threads, options.matrix_form, options.stop};
}

class Streamer final : public CityStreamer {
  public:
    Streamer(Fetcher& fetcher, LayerStore& store, const StreamerOptions& options, Manifest manifest)
        : fetcher_(fetcher),
          store_(store),
          options_(options),
          directory_(std::move(manifest), options.directory_pool),
          cache_(store, host_),
          selector_(directory_, knowledge_, options.relief, options.texel_tolerance_pixels,
                    options.position_tolerance_pixels, options.light_tolerance),
          maps_(knowledge_, cache_, host_, warnings_, counters_, map_options(options)),
          charts_(knowledge_, cache_, host_, warnings_, counters_, options.decode),
          residency_(directory_, knowledge_, cache_, host_, maps_, charts_, warnings_, counters_, options.decode),
          lights_(directory_, cache_, host_, residency_, warnings_, counters_, light_options(options)),
          occlusion_(directory_, knowledge_, cache_, host_, residency_, selector_),
          setbacks_(directory_, knowledge_, cache_, warnings_),
          draw_list_(directory_, knowledge_, residency_, lights_, selector_, options_) {
        host_.budget = options.host_budget_bytes;
        host_.fixed = sizeof(*this);
    }
    ~Streamer() override { abandon_requests(); }
    Streamer(const Streamer&) = delete;
    Streamer& operator=(const Streamer&) = delete;

    Status add_subtree(std::span<const std::byte> bytes, TileAddress root);

    const Manifest& manifest() const override { return directory_.manifest(); }
    const std::vector<TileDraw>& update(const Camera& camera, StreamerFrame& frame) override;
    void set_tolerance(double pixels) override { options_.tolerance_pixels = pixels; }
    void set_sun(std::optional<std::array<double, 3>> to_sun) override { to_sun_ = to_sun; }
    const std::vector<TileDraw>& casters() const override { return *caster_draws_; }

  private:
    void advance_waiting(const Camera& camera);
    void advance_realtime(const Camera& camera);
    bool fetch_all_in_sight(const Camera& camera);
    void choose(const Camera& camera);
    SelectionBudget selection_budget() const;
    std::vector<PlannedRequest> plan_shadows(const Camera& camera);
    void choose_shadows(const Camera& camera);
    void pin_root();
    SelectedTile stand_in() const;
    void mark_needed();
    template <typename Visit>
    void visit_needed_layers(const Visit& visit);
    void trim_to_budget();
    uint64_t needed_slots();
    void upload_all();
    void count_hits();
    std::vector<PlannedRequest> plan(const Camera& camera, bool directory_first);
    bool has_host_room() const;

    uint64_t most_host_bytes_of(const PlannedRequest& request) const {
        return most_host_bytes(request, directory_.manifest(), host_.budget,
                               sizeof(Mark) + TileResidency::bytes_per_tile());
    }
    bool admit(const PlannedRequest& request);
    void submit(const PlannedRequest& request);
    bool drain(const std::vector<PlannedRequest>& requests);
    uint32_t levels_needed(uint32_t chart) const { return levels_in(needed_charts_, chart); }
    void cancel_unwanted();
    bool still_wanted(const PlannedRequest& request);
    void mark_requested(const PlannedRequest& request, bool requested);
    void receive(FetchResult& result);
    void receive_subtree(const PlannedRequest& request, std::span<const std::byte> bytes);
    void receive_facade_index(const PlannedRequest& request, std::span<const std::byte> bytes);
    void receive_chart_index(const PlannedRequest& request, std::span<const std::byte> bytes);
    void receive_layers(const PlannedRequest& request, std::span<const std::byte> bytes);
    void abandon_requests();
    uint64_t dictionary_changes() const { return knowledge_.dictionary.changes() + knowledge_.charts.changes(); }
    bool stopped() const { return options_.stop != nullptr && options_.stop->load(); }
    /// How far vertices may be off their places, in tolerances, which is raised with them.
    double most_tolerance_share() const {
        const double positions =
            options_.position_tolerance_pixels.value_or(kPositionShare * options_.tolerance_pixels);
        return std::max(1.0, positions / options_.tolerance_pixels);
    }

    const std::vector<TileDraw>& make_draws();
    bool is_caster(NodeIndex node) const {
        return std::any_of(casters_.tiles.begin(), casters_.tiles.end(),
                           [&](const SelectedTile& tile) { return tile.node == node; });
    }
    bool is_selected(NodeIndex node) const { return node < marks_.size() && marks_[node].selected == serial_; }
    bool is_refined(NodeIndex node) const { return node < marks_.size() && marks_[node].refined == serial_; }
    const SelectedTile* wanted_tile(NodeIndex node) const {
        return node < marks_.size() && marks_[node].needed == serial_ ? &needed_[marks_[node].position] : nullptr;
    }

    struct InFlight {
        PlannedRequest request;
        uint64_t reserved = 0;
        bool cancelled = false;
        uint32_t unwanted = 0;  ///< updates in a row that had no use for it
    };
    /// By node: serial of the selection for which each holds.
    struct Mark {
        uint64_t selected = 0, refined = 0, needed = 0;
        uint64_t counted = 0;   ///< update for which its prefixes were counted as here or not
        uint32_t position = 0;  ///< in needed_
    };

    Fetcher& fetcher_;
    LayerStore& store_;
    StreamerOptions options_;
    HostMemory host_;
    CityKnowledge knowledge_;
    DirectoryCache directory_;
    LayerCache cache_;
    Selector selector_;
    Warnings warnings_;
    ResidencyCounters counters_;
    MapResidency maps_;
    ChartResidency charts_;
    TileResidency residency_;
    LightResidency lights_;
    Occlusion occlusion_;
    Setbacks setbacks_;
    Selection selection_;
    std::vector<SelectedTile> needed_;        ///< the selection, and in realtime mode the root
    std::vector<ChartPrefix> needed_charts_;  ///< of them all
    CasterChoice casters_;                    ///< beside them
    std::optional<std::array<double, 3>> to_sun_;
    std::vector<Mark> marks_;
    uint64_t serial_ = 0, update_ = 0;
    std::map<uint64_t, InFlight> in_flight_;
    uint64_t next_id_ = 1;
    bool facade_index_requested_ = false, chart_index_requested_ = false;
    DrawList draw_list_;
    const std::vector<TileDraw>* caster_draws_ = &draw_list_.make_casters({});
    StreamerFrame* frame_ = nullptr;
};

Status Streamer::add_subtree(std::span<const std::byte> bytes, TileAddress root) {
    const uint64_t before = directory_.host_bytes();
    const Status added = directory_.add_subtree(bytes, root);
    if (!added) return added.error();
    const uint64_t grown = directory_.host_bytes() - before;
    cache_.free_host(grown);
    host_.fixed += grown + directory_.nodes().size() * sizeof(Mark) - marks_.size() * sizeof(Mark);
    marks_.resize(directory_.nodes().size());
    residency_.grow();
    return Done{};
}

const std::vector<TileDraw>& Streamer::update(const Camera& camera, StreamerFrame& frame) {
    frame = {};
    frame_ = &frame;
    host_.forget_peaks();
    cache_.begin_update();
    ++update_;
    occlusion_.begin_update();
    setbacks_.retry_due();
    if (options_.wait_for_selection) {
        advance_waiting(camera);
    } else {
        advance_realtime(camera);
    }
    const std::vector<TileDraw>& draws = make_draws();
    caster_draws_ = &draw_list_.make_casters(casters_);
    frame.caster_tiles = caster_draws_->size();
    const ResidencyCounters counters = std::exchange(counters_, {});
    frame.decoded_bytes = counters.decoded_bytes;
    frame.decode_ms = counters.decode_ms;
    frame.map_conversions = counters.conversions;
    frame.map_conversions_refused = counters.conversions_refused;
    frame.map_conversion_ms = counters.conversion_ms;
    frame.light_decodes = counters.light_decodes;
    frame.light_decode_ms = counters.light_decode_ms;
    frame.light_layers = cache_.lights_in_store();
    frame.light_tolerance_used = selection_.light_tolerance;
    frame.facade_maps = cache_.maps_in_store();
    frame.shared_charts = cache_.charts_in_store();
    frame.gpu_bytes_used = store_.slots_used() * store_.slot_bytes();
    host_.note_peak();
    frame.host_bytes_used = host_.peak;
    frame.host_bytes_held = host_.peak_held;
    frame.host_bytes_reserved = host_.peak_in_flight;
    frame.warnings = warnings_.take();
    return draws;
}

/// A choice may turn out to be larger than the budgets once all of the view is known; then it is coarser, and what
/// hides what is asked again.
void Streamer::advance_waiting(const Camera& camera) {
    double tolerance = options_.tolerance_pixels;
    do {
        if (options_.occlusion && options_.decode) occlusion_.begin(camera, tolerance * most_tolerance_share());
        if (!fetch_all_in_sight(camera)) {
            occlusion_.look_everywhere();
            choose(camera);
            upload_all();
            return;
        }
    } while (occlusion_.is_on() && selection_.tolerance > std::exchange(tolerance, selection_.tolerance));
    const bool drawable = std::all_of(selection_.tiles.begin(), selection_.tiles.end(),
                                      [&](const SelectedTile& tile) { return residency_.drawable(tile.node); });
    if (drawable || !occlusion_.is_on()) return;
    occlusion_.look_everywhere();
    (void)fetch_all_in_sight(camera);
}

/// Rounds of choosing and fetching until the choice is here, up to a horizon that recedes. What a choice turns out to
/// depend on (subtrees, placements, damage, sizes of converted maps) makes another round. False: there is no room for
/// it. Light comes when all else is here: nothing is fetched and decoded for tiles that turn out to be hidden. Then
/// come tiles out of view that cast shadows into it: which they are depends on what is drawn.
bool Streamer::fetch_all_in_sight(const Camera& camera) {
    for (int round = 0; round < kMostRounds && !stopped(); ++round) {
        const uint64_t known = dictionary_changes();
        choose(camera);
        upload_all();
        count_hits();
        if (dictionary_changes() != known) continue;
        std::vector<PlannedRequest> requests = plan(camera, true);
        if (requests.empty()) {
            if (occlusion_.look_farther(selection_)) continue;
            requests = plan_light(directory_, knowledge_, cache_, needed_, camera);
            if (requests.empty()) requests = plan_shadows(camera);
            if (requests.empty() || !drain(requests)) return true;
        } else if (!drain(requests)) {
            return false;
        }
    }
    return false;
}

void Streamer::advance_realtime(const Camera& camera) {
    for (FetchResult& result : fetcher_.poll()) receive(result);
    choose(camera);
    std::vector<PlannedRequest> shadows = plan_shadows(camera);
    count_hits();
    cancel_unwanted();
    upload_all();
    const uint32_t most = options_.max_requests_in_flight;
    for (const PlannedRequest& request : plan(camera, false)) {
        // The next view's tiles shall not have to wait for the light of this one.
        if (in_flight_.size() >= (is_light(request) ? (most + 1) / 2 : most)) break;
        if (admit(request)) submit(request);
    }
    if (!in_flight_.empty()) return;
    shadows.resize(std::min<size_t>(shadows.size(), (most + 3) / 4));
    for (const PlannedRequest& request : shadows) {
        if (admit(request)) submit(request);
    }
}

/// Chooses what is out of view and casts shadows into it, brings what is here of it to the store, and says what is
/// missing.
std::vector<PlannedRequest> Streamer::plan_shadows(const Camera& camera) {
    if (!to_sun_ || !((*to_sun_)[2] > 0) || directory_.nodes().empty()) return {};
    choose_shadows(camera);
    trim_to_budget();
    upload_all();
    for (const SelectedTile& tile : casters_.tiles) residency_.upload(tile);
    const std::vector<TileAddress> none;
    return plan_casters(directory_, knowledge_, cache_, casters_.tiles, has_host_room() ? casters_.subtrees : none,
                        camera);
}

void Streamer::choose_shadows(const Camera& camera) {
    const Clock::time_point begin = Clock::now();
    const auto& city = directory_.node(0).record->bounds;
    CasterQuestion question;
    question.camera = camera;
    question.limits = {*to_sun_, kCascadeEnds.back(), kCasterReach, city.min[2], city.max[2]};
    question.tolerance = selection_.tolerance;
    question.position_tolerance = selection_.position_tolerance;
    question.drawn = [this](NodeIndex node) { return is_selected(node); };
    question.refined = [this](NodeIndex node) { return is_refined(node); };
    casters_ = choose_casters(directory_, knowledge_, question, selection_budget(), selection_.cost);
    // The root that stands in for a view is here with more steps.
    std::erase_if(casters_.tiles, [&](const SelectedTile& tile) { return wanted_tile(tile.node) != nullptr; });
    for (const SelectedTile& tile : casters_.tiles) cache_.need(cache_.at(layer_key(tile.node, Layer::kMesh)));
    if (casters_.left_out) {
        warnings_.add("the budgets do not hold all that casts shadows from out of this view; some shadows are missing");
    }
    frame_->select_ms += milliseconds_since(begin);
}

/// In realtime mode without the root's room.
SelectionBudget Streamer::selection_budget() const {
    SelectionBudget budget;
    budget.slot_bytes = store_.slot_bytes();
    budget.slots = store_.slot_count();
    budget.host_bytes = host_.budget > host_.fixed ? host_.budget - host_.fixed : 0;
    budget.host_bytes_per_layer = kCachedLayerBytes;
    if (!options_.wait_for_selection && !directory_.nodes().empty()) {
        const auto& root = *directory_.node(0).record;
        const SelectedTile tile = stand_in();
        uint64_t reserve = 0;
        for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
            reserve += store_.slots_for(decoded_prefix_bytes(root.steps(layer), tile.steps_of(layer)));
        }
        for (const ChartPrefix& chart : tile.charts) {
            reserve += store_.slots_for(knowledge_.charts.decoded_bytes(chart));
        }
        budget.slots -= std::min(budget.slots, reserve);
    }
    return budget;
}

void Streamer::choose(const Camera& camera) {
    const Clock::time_point begin = Clock::now();
    casters_ = {};
    selection_ = selector_.select_within(camera, options_.tolerance_pixels, selection_budget());
    needed_ = selection_.tiles;
    ++serial_;
    for (const SelectedTile& tile : selection_.tiles) marks_[tile.node].selected = serial_;
    for (const NodeIndex node : selection_.refined) marks_[node].refined = serial_;
    if (!options_.wait_for_selection) pin_root();
    needed_charts_.clear();
    for (const SelectedTile& tile : needed_) {
        needed_charts_.insert(needed_charts_.end(), tile.charts.begin(), tile.charts.end());
    }
    merge_prefixes(needed_charts_);
    for (uint32_t i = 0; i < needed_.size(); ++i) {
        marks_[needed_[i].node].needed = serial_;
        marks_[needed_[i].node].position = i;
    }
    mark_needed();
    trim_to_budget();
    if (selection_.relief_left_out) {
        warnings_.add("the budgets do not hold all relief of this view; that of far tiles is drawn flat");
    }
    if (selection_.light_left_out) {
        warnings_.add(
            "the budgets do not hold all light of this view; that of far tiles is coarser, or the sky's without "
            "shadows");
    }
    if (!selection_.fits) {
        warnings_.add("the budgets do not hold even the coarsest tiles of this view; far tiles are left out");
    }
    frame_->select_ms += milliseconds_since(begin);
}

/// In realtime mode the root stays resident with its coarsest textures, so that there is always something to fall back
/// to.
void Streamer::pin_root() {
    if (directory_.nodes().empty() || is_selected(0) || !can_be_drawn(directory_, knowledge_, 0)) return;
    needed_.push_back(stand_in());
    needed_.back().pixels_per_metre = selector_.visible(0) ? selector_.pixels_per_metre(0) : 0;
}

/// The root with as much of it as it takes to fall back to.
SelectedTile Streamer::stand_in() const {
    SelectedTile root;
    root.node = 0;
    for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
        root.steps[static_cast<size_t>(layer)] = std::min(stand_in_steps(*directory_.node(0).record, layer),
                                                          knowledge_.tiles[0].usable_steps[static_cast<size_t>(layer)]);
    }
    if (!knowledge_.charts.known()) return root;
    for (const auto& use : knowledge_.tiles[0].charts) {
        if (knowledge_.charts.usable_levels(use.number) > 0) root.charts.push_back({use.number, 1});
    }
    merge_prefixes(root.charts);
    return root;
}

void Streamer::mark_needed() {
    cache_.begin_selection();
    for (const SelectedTile& tile : needed_) {
        for (size_t layer = 0; layer < kLayerCount; ++layer) {
            if (tile.steps[layer] > 0) cache_.need(cache_.at(layer_key(tile.node, static_cast<Layer>(layer))));
        }
        for (const MapPiece piece : tile.pieces) cache_.need(cache_.at(map_key(piece)));
    }
    for (const ChartPrefix& chart : needed_charts_) cache_.need(cache_.at(chart_key(chart.chart)));
}

/// Calls visit(entry, steps, decoded bytes, wire bytes) for every layer in steps and its wanted prefix.
template <typename Visit>
void Streamer::visit_needed_layers(const Visit& visit) {
    const auto visit_tile = [&](const SelectedTile& tile) {
        const auto& record = *directory_.node(tile.node).record;
        for (size_t layer = 0; layer < kLayerCount; ++layer) {
            const uint32_t steps = tile.steps[layer];
            if (steps == 0) continue;
            visit(cache_.at(layer_key(tile.node, static_cast<Layer>(layer))), steps,
                  decoded_prefix_bytes(record.layers[layer], steps), wire_prefix_bytes(record.layers[layer], steps));
        }
    };
    for (const SelectedTile& tile : needed_) visit_tile(tile);
    for (const SelectedTile& tile : casters_.tiles) visit_tile(tile);
    for (const ChartPrefix& chart : needed_charts_) {
        visit(cache_.at(chart_key(chart.chart)), chart.levels, knowledge_.charts.decoded_bytes(chart),
              knowledge_.charts.wire_bytes(chart));
    }
}

/// Slots of all that is needed when it is complete, with what is resident beyond the wanted prefixes.
uint64_t Streamer::needed_slots() {
    uint64_t slots = 0;
    visit_needed_layers([&](const CachedLayer& entry, uint32_t, uint64_t decoded, uint64_t) {
        slots += store_.slots_for(std::max(decoded, entry.store_bytes));
    });
    std::vector<MapPiece> pieces;
    for (const SelectedTile& tile : needed_) pieces.insert(pieces.end(), tile.pieces.begin(), tile.pieces.end());
    std::sort(pieces.begin(), pieces.end());
    pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
    for (const MapPiece piece : pieces) slots += store_.slots_for(knowledge_.dictionary.resident_bytes(piece));
    return slots;
}

/// Prefixes that are resident beyond what is wanted now are cut back when the budgets need their room; the shorter
/// prefix comes back from the wire bytes, not from the network.
void Streamer::trim_to_budget() {
    uint64_t slots = needed_slots();
    uint64_t wire_surplus = 0;
    visit_needed_layers([&](CachedLayer& entry, uint32_t, uint64_t decoded, uint64_t wire) {
        if (slots > store_.slot_count() && entry.store_bytes > decoded) {
            slots -= store_.slots_for(entry.store_bytes) - store_.slots_for(decoded);
            cache_.drop_store(entry);
        }
        if (entry.wire_bytes > wire) wire_surplus += entry.wire_bytes - wire;
    });
    const uint64_t need = selection_.cost.wire_bytes + wire_surplus + selection_.cost.largest_scratch;
    if (host_.fixed + host_.in_flight + need <= host_.budget) return;
    visit_needed_layers(
        [&](CachedLayer& entry, uint32_t steps, uint64_t, uint64_t) { cache_.drop_wire_from(entry, steps); });
}

void Streamer::upload_all() {
    for (const SelectedTile& tile : needed_) residency_.upload(tile);
    if (knowledge_.dictionary.known()) maps_.upload(needed_);
    if (!needed_charts_.empty()) charts_.upload(needed_charts_);
    if (options_.light_tolerance) lights_.upload(needed_);
}

/// Each prefix when it is chosen for the first time in this update, before anything is fetched for it.
void Streamer::count_hits() {
    for (const SelectedTile& tile : needed_) {
        if (std::exchange(marks_[tile.node].counted, update_) == update_) continue;
        for (size_t layer = 0; layer < kLayerCount; ++layer) {
            if (tile.steps[layer] == 0) continue;
            const CachedLayer& entry = cache_.at(layer_key(tile.node, static_cast<Layer>(layer)));
            const bool here = std::max(entry.store_steps, entry.wire_steps) >= tile.steps[layer];
            ++(here ? frame_->cache_hits : frame_->cache_misses);
        }
    }
}

/// For bytes that only save requests.
bool Streamer::has_host_room() const {
    constexpr uint64_t kRoom = 1 << 20;
    const uint64_t needed = host_.fixed + selection_.cost.wire_bytes + selection_.cost.largest_scratch;
    return needed + kRoom <= host_.budget;
}

std::vector<PlannedRequest> Streamer::plan(const Camera& camera, bool directory_first) {
    const NodeIndex first = options_.wait_for_selection || directory_.nodes().empty() ? kNoNode : NodeIndex{0};
    std::vector<PlannedRequest> requests =
        plan_requests(directory_, knowledge_, cache_, selection_, needed_, first, camera,
                      {directory_first, !directory_first, facade_index_requested_, chart_index_requested_,
                       has_host_room(), !directory_first});
    std::erase_if(requests, [&](const PlannedRequest& request) {
        return request.kind == RequestKind::kSubtree &&
               std::any_of(in_flight_.begin(), in_flight_.end(), [&](const auto& entry) {
                   return entry.second.request.kind == RequestKind::kSubtree &&
                          entry.second.request.subtree == request.subtree;
               });
    });
    return requests;
}

/// Room for the answer, and beside it for decoding the largest layer, is made before the request is sent.
bool Streamer::admit(const PlannedRequest& request) {
    return cache_.free_host(most_host_bytes_of(request) + selection_.cost.largest_scratch);
}

void Streamer::submit(const PlannedRequest& request) {
    FetchRequest fetch;
    fetch.id = next_id_++;
    fetch.offset = request.offset;
    fetch.length = request.length;
    fetch.priority = request.priority;
    const uint64_t reserved = most_host_bytes_of(request);
    switch (request.kind) {
        case RequestKind::kSubtree:
            fetch.path = subtree_path(request.subtree);
            fetch.limit = subtree_limit(directory_.manifest(), host_.budget);
            break;
        case RequestKind::kFacadeIndex:
            fetch.path = tiles::tileset::kFacadeIndexPath;
            break;
        case RequestKind::kLayer:
            fetch.path = layer_path(request.layer, directory_.node(request.node).record->address);
            break;
        case RequestKind::kMaps:
            fetch.path = tiles::tileset::kFacadeMapsPath;
            break;
        case RequestKind::kChartIndex:
            fetch.path = tiles::tileset::kChartIndexPath;
            break;
        case RequestKind::kCharts:
            fetch.path = tiles::tileset::kChartLevelsPath;
            break;
    }
    host_.in_flight += reserved;
    host_.note_peak();
    mark_requested(request, true);
    in_flight_.emplace(fetch.id, InFlight{request, reserved, false, 0});
    ++frame_->requests;
    fetcher_.submit(std::move(fetch));
}

/// Sends all and takes in what arrives. False when the rest fits no budget.
bool Streamer::drain(const std::vector<PlannedRequest>& requests) {
    size_t next = 0;
    while ((next < requests.size() || !in_flight_.empty()) && !stopped()) {
        while (next < requests.size() && in_flight_.size() < options_.max_requests_in_flight && admit(requests[next])) {
            submit(requests[next++]);
        }
        if (in_flight_.empty()) {
            warnings_.add("the host budget has no room for the next request; the view stays coarser");
            return false;
        }
        const Clock::time_point begin = Clock::now();
        std::vector<FetchResult> results = fetcher_.wait(kWaitSlice);
        frame_->wait_ms += milliseconds_since(begin);
        for (FetchResult& result : results) receive(result);
    }
    return true;
}

bool Streamer::still_wanted(const PlannedRequest& request) {
    switch (request.kind) {
        case RequestKind::kSubtree:
        case RequestKind::kFacadeIndex:
        case RequestKind::kChartIndex:
            return true;
        case RequestKind::kLayer: {
            const SelectedTile* tile = wanted_tile(request.node);
            if (request.layer == Layer::kMesh && is_caster(request.node)) return true;
            return tile != nullptr && tile->steps_of(request.layer) > request.from;
        }
        case RequestKind::kMaps:
            for (MapPiece piece = request.from; piece != request.to; piece = knowledge_.dictionary.next(piece)) {
                if (cache_.is_needed(cache_.at(map_key(piece)))) return true;
            }
            return false;
        case RequestKind::kCharts:
            for (ChartPiece piece = request.from; piece != request.to; piece = knowledge_.charts.next(piece)) {
                if (levels_needed(chart_of(piece)) > chart_level_of(piece)) return true;
            }
            return false;
    }
    return false;
}

void Streamer::cancel_unwanted() {
    for (auto& [id, under_way] : in_flight_) {
        if (under_way.cancelled) continue;
        under_way.unwanted = still_wanted(under_way.request) ? 0 : under_way.unwanted + 1;
        if (under_way.unwanted < kUnwantedUpdates) continue;
        under_way.cancelled = true;
        fetcher_.cancel(id);
    }
}

void Streamer::mark_requested(const PlannedRequest& request, bool requested) {
    const auto mark_pieces = [&](const auto& pieces) {
        for (uint32_t piece = request.from; piece != request.to; piece = pieces.dictionary.next(piece)) {
            const uint32_t step = pieces.step(piece);
            set_requested(cache_.at(pieces.key(piece)), step_bits(step, step + 1), requested);
        }
    };
    switch (request.kind) {
        case RequestKind::kSubtree:
            break;
        case RequestKind::kFacadeIndex:
            facade_index_requested_ = requested;
            break;
        case RequestKind::kChartIndex:
            chart_index_requested_ = requested;
            break;
        case RequestKind::kLayer:
            set_requested(cache_.at(layer_key(request.node, request.layer)), step_bits(request.from, request.to),
                          requested);
            break;
        case RequestKind::kMaps:
            mark_pieces(MapPieces{knowledge_.dictionary});
            break;
        case RequestKind::kCharts:
            mark_pieces(ChartPieces{knowledge_.charts});
            break;
    }
}

void Streamer::receive(FetchResult& result) {
    const auto found = in_flight_.find(result.id);
    if (found == in_flight_.end()) return;
    const PlannedRequest request = found->second.request;
    host_.in_flight -= found->second.reserved;
    in_flight_.erase(found);
    mark_requested(request, false);
    if (result.cancelled) return;
    if (!result.bytes) {
        setbacks_.fail(request, result.bytes.error().text());
        return;
    }
    const std::vector<std::byte>& bytes = *result.bytes;
    frame_->wire_bytes += bytes.size();
    if (request.kind == RequestKind::kLayer) frame_->layer_bytes[static_cast<size_t>(request.layer)] += bytes.size();
    if (request.kind == RequestKind::kFacadeIndex) frame_->facade_index_bytes += bytes.size();
    if (request.kind == RequestKind::kMaps) frame_->facade_map_bytes += bytes.size();
    if (request.kind == RequestKind::kChartIndex) frame_->chart_index_bytes += bytes.size();
    if (request.kind == RequestKind::kCharts) frame_->chart_level_bytes += bytes.size();
    if (request.length > 0 && bytes.size() != request.length) {
        setbacks_.fail(request, "the answer has another length than the directory says");
        return;
    }
    switch (request.kind) {
        case RequestKind::kSubtree:
            receive_subtree(request, bytes);
            break;
        case RequestKind::kFacadeIndex:
            receive_facade_index(request, bytes);
            break;
        case RequestKind::kChartIndex:
            receive_chart_index(request, bytes);
            break;
        default:
            receive_layers(request, bytes);
            break;
    }
}

void Streamer::receive_subtree(const PlannedRequest& request, std::span<const std::byte> bytes) {
    const Status added = add_subtree(bytes, request.subtree);
    if (!added) setbacks_.reject(request, added.error().text());
}

void Streamer::receive_facade_index(const PlannedRequest& request, std::span<const std::byte> bytes) {
    auto maps = directory_.pool().facade_maps(bytes, directory_.manifest());
    if (!maps) {
        setbacks_.reject(request, maps.error().text());
        return;
    }
    knowledge_.dictionary.learn(std::move(*maps));
    host_.fixed += knowledge_.dictionary.host_bytes();
    host_.note_peak();
}

void Streamer::receive_chart_index(const PlannedRequest& request, std::span<const std::byte> bytes) {
    auto charts = directory_.pool().shared_charts(bytes, directory_.manifest());
    if (!charts) {
        setbacks_.reject(request, charts.error().text());
        return;
    }
    knowledge_.charts.learn(std::move(*charts));
    host_.fixed += knowledge_.charts.host_bytes();
    host_.note_peak();
}

/// Levels of dictionaries are brought to the store with the tiles that use them.
void Streamer::receive_layers(const PlannedRequest& request, std::span<const std::byte> bytes) {
    if (request.kind == RequestKind::kMaps) {
        maps_.accept(request.from, request.to, bytes);
    } else if (request.kind == RequestKind::kCharts) {
        charts_.accept(request.from, request.to, bytes);
    } else {
        residency_.accept_layer(request.node, request.layer, request.from, request.to, bytes);
        if (const SelectedTile* tile = wanted_tile(request.node)) residency_.upload(*tile);
    }
}

/// The fetcher outlives the streamer and may serve another one: nothing of ours stays in it.
void Streamer::abandon_requests() {
    for (const auto& [id, under_way] : in_flight_) fetcher_.cancel(id);
}

/// What is drawn of what was chosen.
const std::vector<TileDraw>& Streamer::make_draws() {
    const SelectionView view = {[this](NodeIndex node) { return is_selected(node); },
                                [this](NodeIndex node) { return is_refined(node); },
                                [this](NodeIndex node) { return wanted_tile(node); }};
    return draw_list_.make(selection_, view, *frame_);
}

}  // namespace

Result<std::unique_ptr<CityStreamer>> CityStreamer::open(Fetcher& fetcher, LayerStore& store,
                                                         const StreamerOptions& options) {
    const auto json = fetch_now(fetcher, tiles::tileset::kTilesetPath, kManifestLimit);
    if (!json) return json.error();
    auto manifest = tiles::tileset::parse_tileset_json(*json);
    if (!manifest) return Error{about("tileset.json", manifest.error().text())};
    const bool empty_city = manifest->tiles == 0;
    const uint64_t root_limit = subtree_limit(*manifest, options.host_budget_bytes);
    auto streamer = std::make_unique<Streamer>(fetcher, store, options, std::move(*manifest));
    if (!empty_city) {
        const std::string path = tiles::tileset::subtree_path({});
        const auto bytes = fetch_now(fetcher, path, root_limit);
        if (!bytes) return bytes.error();
        const Status added = streamer->add_subtree(*bytes, {});
        if (!added) return Error{about(path, added.error().text())};
    }
    return std::unique_ptr<CityStreamer>(std::move(streamer));
}

}  // namespace citystream::client
