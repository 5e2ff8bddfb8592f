#include "client/stream/city_streamer.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "client/cache/directory_cache.h"
#include "client/cache/layer_cache.h"
#include "client/select/selection.h"
#include "client/stream/arrivals.h"
#include "client/stream/chart_residency.h"
#include "client/stream/draw_list.h"
#include "client/stream/light_residency.h"
#include "client/stream/occlusion.h"
#include "client/stream/request_cost.h"
#include "client/stream/request_plan.h"
#include "client/stream/requests_under_way.h"
#include "client/stream/setbacks.h"
#include "client/stream/surplus.h"
#include "client/stream/tile_residency.h"
#include "client/stream/view_choice.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::client {

using tiles::tileset::Manifest;
using tiles::tileset::TileAddress;

namespace {

constexpr uint64_t kManifestLimit = 4u << 20;
constexpr int kMostRounds =
    256;  // of one waiting update; each learns something, so this is never the limit in practice
constexpr std::chrono::milliseconds kWaitSlice{100};
/// Under way in realtime mode. They are large, and one that was sent is not overtaken: the next view's tiles shall find
/// connections of the fetcher's idle.
constexpr size_t kMostLightRequests = 3;

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
    return {options.decode,
            options.wait_for_selection,
            options.light_threads,
            {options.matrix_form, options.matrix_error},
            options.stop};
}

/// Keeps the frame's rounds: choose, fetch, take in, choose again.
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
          lights_(directory_, knowledge_, cache_, host_, residency_, warnings_, counters_, light_options(options)),
          occlusion_(directory_, knowledge_, cache_, host_, residency_, selector_),
          setbacks_(directory_, knowledge_, cache_, warnings_),
          view_(directory_, knowledge_, cache_, store, host_, selector_, warnings_, options_),
          requests_(fetcher, directory_, knowledge_, cache_, host_),
          arrivals_(requests_, directory_, knowledge_, cache_, host_, maps_, charts_, residency_, view_, setbacks_),
          draw_list_(directory_, knowledge_, residency_, lights_, selector_, options_) {
        host_.budget = options.host_budget_bytes;
        host_.fixed = sizeof(*this);
    }

    Status add_subtree(std::span<const std::byte> bytes, TileAddress root) {
        return arrivals_.add_subtree(bytes, root);
    }

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
    std::vector<PlannedRequest> plan(const Camera& camera, bool directory_first);
    std::vector<PlannedRequest> plan_shadows(const Camera& camera);
    void trim() { trim_surplus(view_, directory_, knowledge_, cache_, host_); }
    void upload_all(const Camera& camera);
    bool admit(const PlannedRequest& request) {
        return requests_.admit(request, view_.selection().cost.largest_scratch);
    }
    void submit(const PlannedRequest& request);
    bool drain(const std::vector<PlannedRequest>& requests);
    const std::vector<TileDraw>& make_draws();
    void report(StreamerFrame& frame);

    uint64_t dictionary_changes() const { return knowledge_.dictionary.changes() + knowledge_.charts.changes(); }
    bool stopped() const { return options_.stop != nullptr && options_.stop->load(); }
    /// How far vertices may be off their places, in tolerances, which is raised with them.
    double most_tolerance_share() const {
        const double positions =
            options_.position_tolerance_pixels.value_or(kPositionShare * options_.tolerance_pixels);
        return std::max(1.0, positions / options_.tolerance_pixels);
    }

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
    ViewChoice view_;
    RequestsUnderWay requests_;
    Arrivals arrivals_;
    DrawList draw_list_;
    std::optional<std::array<double, 3>> to_sun_;
    const std::vector<TileDraw>* caster_draws_ = &draw_list_.make_casters({});
    StreamerFrame* frame_ = nullptr;
};

const std::vector<TileDraw>& Streamer::update(const Camera& camera, StreamerFrame& frame) {
    frame = {};
    frame_ = &frame;
    host_.forget_peaks();
    cache_.begin_update();
    view_.begin_update();
    occlusion_.begin_update();
    setbacks_.retry_due();
    if (options_.wait_for_selection) {
        advance_waiting(camera);
    } else {
        advance_realtime(camera);
    }
    view_.warn_of_budgets();
    const std::vector<TileDraw>& draws = make_draws();
    caster_draws_ = &draw_list_.make_casters(view_.casters());
    report(frame);
    return draws;
}

void Streamer::report(StreamerFrame& frame) {
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
    frame.light_bytes = cache_.light_bytes_in_store();
    frame.light_row_error = counters.light_row_error;
    frame.light_quarters_dropped = counters.light_quarters_dropped;
    frame.light_tolerance_used = view_.selection().light_tolerance;
    frame.facade_maps = cache_.maps_in_store();
    frame.shared_charts = cache_.charts_in_store();
    frame.gpu_bytes_used = store_.slots_used() * store_.slot_bytes();
    host_.note_peak();
    frame.host_bytes_used = host_.peak;
    frame.host_bytes_held = host_.peak_held;
    frame.host_bytes_reserved = host_.peak_in_flight;
    frame.warnings = warnings_.take();
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
            upload_all(camera);
            return;
        }
    } while (occlusion_.is_on() && view_.selection().tolerance > std::exchange(tolerance, view_.selection().tolerance));
    const bool drawable = std::all_of(view_.selection().tiles.begin(), view_.selection().tiles.end(),
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
        const uint64_t known = dictionary_changes(), lights_known = knowledge_.light_sizes_learnt;
        choose(camera);
        upload_all(camera);
        view_.count_hits(*frame_);
        if (dictionary_changes() != known) continue;
        if (view_.selection().light_left_out && knowledge_.light_sizes_learnt != lights_known) continue;
        std::vector<PlannedRequest> requests = plan(camera, true);
        if (requests.empty()) {
            if (occlusion_.look_farther(view_.selection())) continue;
            requests = plan_light(directory_, knowledge_, cache_, view_.needed(), camera);
            if (requests.empty()) requests = plan_shadows(camera);
            if (requests.empty() || !drain(requests)) return true;
        } else if (!drain(requests)) {
            return false;
        }
    }
    return false;
}

void Streamer::advance_realtime(const Camera& camera) {
    for (FetchResult& result : fetcher_.poll()) arrivals_.take(result, *frame_);
    choose(camera);
    std::vector<PlannedRequest> shadows = plan_shadows(camera);
    view_.count_hits(*frame_);
    requests_.cancel_unwanted(view_);
    upload_all(camera);
    const uint32_t most = options_.max_requests_in_flight;
    for (const PlannedRequest& request : plan(camera, false)) {
        if (requests_.size() >= most) break;
        if (is_light(request) && requests_.lights() >= kMostLightRequests) continue;
        if (admit(request)) submit(request);
    }
    if (!requests_.empty()) return;
    shadows.resize(std::min<size_t>(shadows.size(), (most + 3) / 4));
    for (const PlannedRequest& request : shadows) {
        if (admit(request)) submit(request);
    }
}

/// Chooses what is out of view and casts shadows into it, brings what is here of it to the store, and says what is
/// missing.
std::vector<PlannedRequest> Streamer::plan_shadows(const Camera& camera) {
    if (!to_sun_ || !((*to_sun_)[2] > 0) || directory_.nodes().empty()) return {};
    {
        const Stopwatch watch(frame_->select_ms);
        view_.choose_casters(camera, *to_sun_);
    }
    trim();
    upload_all(camera);
    for (const SelectedTile& tile : view_.casters().tiles) residency_.upload(tile);
    const std::vector<TileAddress> none;
    return plan_casters(directory_, knowledge_, cache_, view_.casters().tiles,
                        has_host_room(view_.selection(), host_) ? view_.casters().subtrees : none, camera);
}

void Streamer::choose(const Camera& camera) {
    const Stopwatch watch(frame_->select_ms);
    view_.choose(camera);
    trim();
}

void Streamer::upload_all(const Camera& camera) {
    for (const SelectedTile& tile : view_.needed()) residency_.upload(tile);
    if (knowledge_.dictionary.known()) maps_.upload(view_.needed());
    if (!view_.needed_charts().empty()) charts_.upload(view_.needed_charts());
    if (options_.light_tolerance) lights_.upload(view_.needed(), camera);
}

std::vector<PlannedRequest> Streamer::plan(const Camera& camera, bool directory_first) {
    const NodeIndex first = options_.wait_for_selection || directory_.nodes().empty() ? kNoNode : NodeIndex{0};
    std::vector<PlannedRequest> requests =
        plan_requests(directory_, knowledge_, cache_, view_.selection(), view_.needed(), first, camera,
                      {directory_first, !directory_first, requests_.has_facade_index(), requests_.has_chart_index(),
                       has_host_room(view_.selection(), host_), !directory_first});
    std::erase_if(requests, [&](const PlannedRequest& request) {
        return request.kind == RequestKind::kSubtree && requests_.has_subtree(request.subtree);
    });
    return requests;
}

void Streamer::submit(const PlannedRequest& request) {
    requests_.submit(request);
    ++frame_->requests;
}

/// Sends all and takes in what arrives. False when the rest fits no budget.
bool Streamer::drain(const std::vector<PlannedRequest>& requests) {
    size_t next = 0;
    while ((next < requests.size() || !requests_.empty()) && !stopped()) {
        while (next < requests.size() && requests_.size() < options_.max_requests_in_flight && admit(requests[next])) {
            submit(requests[next++]);
        }
        if (requests_.empty()) {
            warnings_.add("the host budget has no room for the next request; the view stays coarser");
            return false;
        }
        std::vector<FetchResult> results;
        {
            const Stopwatch watch(frame_->wait_ms);
            results = fetcher_.wait(kWaitSlice);
        }
        for (FetchResult& result : results) arrivals_.take(result, *frame_);
    }
    return true;
}

/// What is drawn of what was chosen.
const std::vector<TileDraw>& Streamer::make_draws() {
    const SelectionView view = {[this](NodeIndex node) { return view_.is_selected(node); },
                                [this](NodeIndex node) { return view_.is_refined(node); },
                                [this](NodeIndex node) { return view_.wanted_tile(node); }};
    return draw_list_.make(view_.selection(), view, *frame_);
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
