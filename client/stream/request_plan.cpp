#include "client/stream/request_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace citystream::client {

using tiles::tileset::Layer;
using tiles::tileset::StepRecord;
using tiles::tileset::TileRecord;

namespace {

constexpr double kFirstTilePriority = 1e290;  // before the directory: it is the first picture
constexpr double kLeastGain = 1e-3;           // pixels: keeps an order among steps that promise nothing

class Planner {
  public:
    Planner(const DirectoryCache& directory, const CityKnowledge& knowledge, LayerCache& cache, const Camera& camera,
            bool coarse_first)
        : directory_(directory), knowledge_(knowledge), cache_(cache), camera_(camera), coarse_first_(coarse_first) {}

    void add_subtrees(const Selection& selection) {
        for (const auto& address : selection.subtrees) {
            PlannedRequest request;
            request.kind = RequestKind::kSubtree;
            request.subtree = address;
            request.priority = kDirectoryPriority / (1 + address.level);
            out.push_back(request);
        }
    }
    void add_facade_index() {
        PlannedRequest request;
        request.kind = RequestKind::kFacadeIndex;
        request.length = directory_.manifest().facade_index_bytes;
        request.priority = kDirectoryPriority / 100;
        out.push_back(request);
    }
    void add_layer(const SelectedTile& tile, Layer layer, bool first);
    void add_maps(const std::vector<SelectedTile>& tiles);

    std::vector<PlannedRequest> out;

  private:
    double error_before(const SelectedTile& tile, const CachedLayer& entry, Layer layer) const;
    uint64_t bytes_to_weigh(const PlannedRequest& request) const;

    const DirectoryCache& directory_;
    const CityKnowledge& knowledge_;
    LayerCache& cache_;
    const Camera& camera_;
    bool coarse_first_;
};

/// Metres of error on the screen until the request is here: of the resident prefix, or of what stands in for the tile.
double Planner::error_before(const SelectedTile& tile, const CachedLayer& entry, Layer layer) const {
    const DirectoryNode& node = directory_.node(tile.node);
    if (layer == Layer::kFacade) return node.record->flat_facade_error;
    if (entry.store_steps > 0) return node.record->steps(layer)[entry.store_steps - 1].error;
    for (NodeIndex up = node.parent; up != kNoNode; up = directory_.node(up).parent) {
        const CachedLayer* mesh = cache_.find(layer_key(up, Layer::kMesh));
        if (mesh != nullptr && mesh->store_steps > 0) return directory_.node(up).record->geometric_error;
    }
    return directory_.manifest().root_geometric_error;
}

/// A tile shows when both its mesh and its atlas have begun, so their first requests are weighed together and arrive
/// together.
uint64_t Planner::bytes_to_weigh(const PlannedRequest& request) const {
    if (request.from > 0 || request.layer == Layer::kFacade) return std::max<uint64_t>(1, request.length);
    const TileRecord& record = *directory_.node(request.node).record;
    uint64_t bytes = 0;
    for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
        const CachedLayer* entry = cache_.find(layer_key(request.node, layer));
        const bool begun = entry != nullptr && (entry->wire_steps > 0 || entry->store_steps > 0);
        if (layer == request.layer) {
            bytes += request.length;
        } else if (!begun && !record.steps(layer).empty()) {
            bytes += record.steps(layer).front().end;
        }
    }
    return std::max<uint64_t>(1, bytes);
}

void Planner::add_layer(const SelectedTile& tile, Layer layer, bool first) {
    CachedLayer& entry = cache_.at(layer_key(tile.node, layer));
    const bool begin = coarse_first_ && entry.wire_steps == 0 && entry.store_steps == 0;
    const uint32_t wanted = begin ? 1 : tile.steps_of(layer);
    if (wanted <= entry.wire_steps || wanted <= entry.store_steps || entry.requested) return;
    const TileRecord& record = *directory_.node(tile.node).record;
    const std::vector<StepRecord>& steps = record.steps(layer);
    PlannedRequest request;
    request.node = tile.node;
    request.layer = layer;
    request.from = entry.wire_steps;
    request.to = wanted;
    request.offset = wire_prefix_bytes(steps, request.from);
    request.length = steps[wanted - 1].end - request.offset;
    const double before = std::min<double>(error_before(tile, entry, layer) * tile.pixels_per_metre, camera_.height);
    const double gain = std::max(before - steps[wanted - 1].error * tile.pixels_per_metre, kLeastGain);
    request.priority = gain * screen_area(record.bounds, tile.pixels_per_metre, camera_) /
                       static_cast<double>(bytes_to_weigh(request));
    if (first) request.priority += kFirstTilePriority;
    out.push_back(request);
}

/// Missing maps of all tiles, neighbours in the entry as one range.
void Planner::add_maps(const std::vector<SelectedTile>& tiles) {
    struct Wanted {
        uint32_t map;
        double gain;
    };
    std::vector<Wanted> wanted;
    for (const SelectedTile& tile : tiles) {
        if (tile.steps_of(Layer::kFacade) == 0) continue;
        const TileRecord& record = *directory_.node(tile.node).record;
        const double relief = std::min<double>(record.flat_facade_error * tile.pixels_per_metre, camera_.height);
        const double gain = relief * screen_area(record.bounds, tile.pixels_per_metre, camera_);
        for (const uint32_t map : knowledge_.tiles[tile.node].facade_maps) {
            if (map >= knowledge_.maps.size()) continue;
            const CachedLayer& entry = cache_.at(map_key(map));
            if (entry.wire_steps == 0 && entry.store_steps == 0 && !entry.requested) wanted.push_back({map, gain});
        }
    }
    std::sort(wanted.begin(), wanted.end(),
              [](const Wanted& a, const Wanted& b) { return a.map != b.map ? a.map < b.map : a.gain > b.gain; });
    for (size_t i = 0; i < wanted.size(); ++i) {
        if (i > 0 && wanted[i].map == wanted[i - 1].map) continue;
        const bool adjacent = !out.empty() && out.back().kind == RequestKind::kMaps && out.back().to == wanted[i].map;
        if (!adjacent) {
            PlannedRequest request;
            request.kind = RequestKind::kMaps;
            request.from = wanted[i].map;
            request.offset = knowledge_.map_begin(wanted[i].map);
            out.push_back(request);
        }
        PlannedRequest& request = out.back();
        request.to = wanted[i].map + 1;
        request.length += knowledge_.map_wire_bytes(wanted[i].map);
        request.priority += wanted[i].gain;
    }
    for (PlannedRequest& request : out) {
        if (request.kind == RequestKind::kMaps)
            request.priority /= static_cast<double>(std::max<uint64_t>(1, request.length));
    }
}

void order(std::vector<PlannedRequest>& requests) {
    std::stable_sort(requests.begin(), requests.end(),
                     [](const PlannedRequest& a, const PlannedRequest& b) { return a.priority > b.priority; });
}

}  // namespace

double screen_area(const tiles::tileset::Bounds& bounds, double pixels_per_metre, const Camera& camera) {
    double squared = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double half = 0.5 * (bounds.max[i] - bounds.min[i]);
        squared += half * half;
    }
    const double whole = static_cast<double>(camera.width) * camera.height;
    return std::min(whole, std::numbers::pi * squared * pixels_per_metre * pixels_per_metre);
}

std::vector<PlannedRequest> plan_requests(const DirectoryCache& directory, const CityKnowledge& knowledge,
                                          LayerCache& cache, const Selection& selection,
                                          const std::vector<SelectedTile>& tiles, NodeIndex first_tile,
                                          const Camera& camera, const PlanOptions& options) {
    Planner planner(directory, knowledge, cache, camera, options.coarse_first);
    planner.add_subtrees(selection);
    if (options.directory_first && !planner.out.empty()) return std::move(planner.out);

    bool relief = false;
    for (const SelectedTile& tile : tiles) {
        if (tile.steps_of(Layer::kFacade) == 0) continue;
        relief = true;
        planner.add_layer(tile, Layer::kFacade, false);
    }
    const bool index_missing = relief && knowledge.maps.empty() && directory.manifest().facade_map_count > 0;
    if (index_missing && !options.facade_index_requested) planner.add_facade_index();
    order(planner.out);
    if (options.directory_first && !planner.out.empty()) return std::move(planner.out);

    for (const SelectedTile& tile : tiles) {
        const bool first = tile.node == first_tile;
        if (tile.steps_of(Layer::kMesh) > 0) planner.add_layer(tile, Layer::kMesh, first);
        if (tile.steps_of(Layer::kAtlas) > 0) planner.add_layer(tile, Layer::kAtlas, first);
    }
    if (!knowledge.maps.empty()) planner.add_maps(tiles);
    order(planner.out);
    return std::move(planner.out);
}

}  // namespace citystream::client
