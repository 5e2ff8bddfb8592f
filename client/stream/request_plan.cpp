#include "client/stream/request_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/stream/chart_boxes.h"
#include "client/stream/dictionary_pieces.h"

namespace citystream::client {

using tiles::tileset::Layer;
using tiles::tileset::StepRecord;
using tiles::tileset::TileRecord;

namespace {

constexpr double kOpening = 1e200;  // factor on the gain of openings, below the directory's priority
constexpr double kFacadeIndexPriority = 1e150;
constexpr double kChartIndexPriority = 1e249;  // no tile that names shared charts is drawn without it
constexpr double kLeastGain = 1e-3;            // pixels: keeps an order among steps that promise nothing
constexpr double kLight = 1e-100;              // factor on the gain of light that comes below all else
constexpr double kPixelsOfLight = 8;           // and of other light: pixels of error that are as bad as no light
constexpr double kLightOfAll = 1e10;           // factor on that of the stand-in, which lights all tiles for a while
constexpr double kCasters = 1e-200;            // factor on the gain of casters, below light
constexpr double kErrorWithoutLight = 1;       // all of the light may be blocked

class Planner {
  public:
    Planner(const DirectoryCache& directory, const CityKnowledge& knowledge, LayerCache& cache, const Camera& camera,
            NodeIndex stand_in, bool coarse_first)
        : directory_(directory),
          knowledge_(knowledge),
          cache_(cache),
          camera_(camera),
          stand_in_(stand_in),
          coarse_first_(coarse_first) {}

    void add_subtrees(const std::vector<tiles::tileset::TileAddress>& subtrees) {
        for (const auto& address : subtrees) {
            PlannedRequest request;
            request.kind = RequestKind::kSubtree;
            request.subtree = address;
            request.priority = kDirectoryPriority / (1 + address.level);
            out.push_back(request);
        }
    }
    void add_facade_index() {
        add_index(RequestKind::kFacadeIndex, directory_.manifest().facade_index_bytes, kFacadeIndexPriority);
    }
    void add_chart_index() {
        add_index(RequestKind::kChartIndex, directory_.manifest().chart_index_bytes, kChartIndexPriority);
    }
    void add_layer(const SelectedTile& tile, Layer layer);
    void add_tile(const SelectedTile& tile);
    void add_light(const SelectedTile& tile);
    void add_openings(const std::vector<SelectedTile>& tiles, bool bridge_gaps);
    bool add_first_picture(const std::vector<SelectedTile>& tiles, bool choice_known, bool host_room);
    bool is_missing(const SelectedTile& tile) const;
    void add_maps(const std::vector<SelectedTile>& tiles, bool bridge_gaps);
    void add_charts(const std::vector<SelectedTile>& tiles, uint32_t most_levels, bool bridge_gaps);

    std::vector<PlannedRequest> out;

  private:
    struct WantedPiece {
        uint32_t piece;  ///< MapPiece or ChartPiece
        double gain;
    };
    void add_index(RequestKind kind, uint64_t bytes, double priority);
    bool has_begun(const SelectedTile& tile, Layer layer) const;
    bool charts_have_begun(const SelectedTile& tile) const;
    bool is_recognisable(const SelectedTile& tile) const;
    uint32_t opening_steps(const SelectedTile& tile, Layer layer) const;
    uint64_t opening_bytes(const SelectedTile& tile) const;
    double stand_in_error(const SelectedTile& tile) const;
    double error_before(const SelectedTile& tile, const CachedLayer& entry, Layer layer) const;
    std::vector<WantedPiece> missing_map_pieces(const std::vector<SelectedTile>& tiles) const;
    double map_gain(const SelectedTile& tile, MapPiece piece) const;
    std::vector<WantedPiece> missing_chart_pieces(const std::vector<SelectedTile>& tiles, uint32_t most_levels) const;
    double chart_gain(const SelectedTile& tile, const codec::atlas::SharedChartUse& use, uint32_t level) const;
    template <typename Pieces>
    bool is_missing_piece(const Pieces& pieces, uint32_t piece) const;
    template <typename Pieces>
    bool can_bridge(const Pieces& pieces, uint32_t from, uint32_t to) const;
    template <typename Pieces>
    void add_ranges(RequestKind kind, const Pieces& pieces, std::vector<WantedPiece> wanted, bool bridge_gaps);

    const DirectoryCache& directory_;
    const CityKnowledge& knowledge_;
    LayerCache& cache_;
    const Camera& camera_;
    NodeIndex stand_in_;
    bool coarse_first_;
};

/// Metres of error on the screen until the request is here: of the resident prefix, or of what stands in for the tile.
double Planner::error_before(const SelectedTile& tile, const CachedLayer& entry, Layer layer) const {
    const DirectoryNode& node = directory_.node(tile.node);
    if (layer == Layer::kFacade) return node.record->flat_facade_error;
    if (entry.store_steps > 0) return node.record->steps(layer)[entry.store_steps - 1].error;
    return stand_in_error(tile);
}

/// Metres of error of what is shown in the tile's place.
double Planner::stand_in_error(const SelectedTile& tile) const {
    for (NodeIndex up = directory_.node(tile.node).parent; up != kNoNode; up = directory_.node(up).parent) {
        const CachedLayer* mesh = cache_.find(layer_key(up, Layer::kMesh));
        if (mesh != nullptr && mesh->store_steps > 0) return directory_.node(up).record->geometric_error;
    }
    return directory_.manifest().root_geometric_error;
}

/// Something of the layer is here, or it is not wanted.
bool Planner::has_begun(const SelectedTile& tile, Layer layer) const {
    if (tile.steps_of(layer) == 0) return true;
    const CachedLayer* entry = cache_.find(layer_key(tile.node, layer));
    return entry != nullptr && (entry->wire_steps > 0 || entry->store_steps > 0);
}

/// Of each shared chart that it wants something is here. While its charts are not known its atlas is not here.
bool Planner::charts_have_begun(const SelectedTile& tile) const {
    const TileKnowledge& known = knowledge_.tiles[tile.node];
    if (known.charts.empty() || knowledge_.charts_broken) return true;
    return knowledge_.charts.known() && std::all_of(tile.charts.begin(), tile.charts.end(), [&](const auto& wanted) {
               return is_here(cache_.find(chart_key(wanted.chart)), 0);
           });
}

bool Planner::is_missing(const SelectedTile& tile) const {
    return !has_begun(tile, Layer::kMesh) || !has_begun(tile, Layer::kAtlas) || !charts_have_begun(tile);
}

/// Even the whole mesh of a stand-in can be too coarse for a near view.
bool Planner::is_recognisable(const SelectedTile& tile) const {
    const uint8_t wanted = tile.steps_of(Layer::kMesh);
    if (wanted == 0) return true;
    const double error = directory_.node(tile.node).record->steps(Layer::kMesh)[wanted - 1].error;
    return error * tile.pixels_per_metre <= kRecognisableShare * camera_.height;
}

/// Coarse textures are worth showing, coarse positions are not.
uint32_t Planner::opening_steps(const SelectedTile& tile, Layer layer) const {
    const uint8_t wanted = tile.steps_of(layer);
    if (layer != Layer::kMesh) return std::min<uint8_t>(1, wanted);
    return shortest_prefix(directory_.node(tile.node).record->steps(layer), wanted, tile.pixels_per_metre,
                           kRecognisableShare * camera_.height);
}

/// A tile shows when its mesh, its atlas and its shared charts have begun.
uint64_t Planner::opening_bytes(const SelectedTile& tile) const {
    uint64_t bytes = 0;
    for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
        if (has_begun(tile, layer)) continue;
        bytes += wire_prefix_bytes(directory_.node(tile.node).record->steps(layer), opening_steps(tile, layer));
    }
    for (const ChartPrefix& wanted : tile.charts) {
        if (!is_here(cache_.find(chart_key(wanted.chart)), 0)) {
            bytes += knowledge_.charts.wire_bytes(ChartPrefix{wanted.chart, 1});
        }
    }
    return bytes;
}

void Planner::add_layer(const SelectedTile& tile, Layer layer) {
    CachedLayer& entry = cache_.at(layer_key(tile.node, layer));
    const bool opens = coarse_first_ && layer != Layer::kFacade && !has_begun(tile, layer);
    const uint32_t wanted = opens ? opening_steps(tile, layer) : tile.steps_of(layer);
    if (wanted <= entry.wire_steps || wanted <= entry.store_steps || entry.requested != 0) return;
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
    // What opens a tile is weighed together, to arrive together.
    const uint64_t bytes = opens ? opening_bytes(tile) : request.length;
    request.priority = gain * screen_area(record.bounds, tile.pixels_per_metre, camera_) /
                       static_cast<double>(std::max<uint64_t>(1, bytes));
    if (opens && (tile.node != stand_in_ || is_recognisable(tile))) request.priority *= kOpening;
    out.push_back(request);
}

void Planner::add_tile(const SelectedTile& tile) {
    for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
        if (tile.steps_of(layer) > 0) add_layer(tile, layer);
    }
}

/// Where a coarse picture is to come soon the first step comes alone, and what follows it when that has been decoded:
/// decoding is slower than most networks.
void Planner::add_light(const SelectedTile& tile) {
    const uint32_t all = tile.steps_of(Layer::kRadiance);
    if (all == 0) return;
    const CachedLayer& entry = cache_.at(layer_key(tile.node, Layer::kRadiance));
    const bool opens = coarse_first_ && entry.wire_steps == 0 && entry.store_steps == 0;
    const uint32_t wanted = opens ? 1 : all;
    if (wanted <= entry.wire_steps || wanted <= entry.store_steps || entry.requested != 0) return;
    if (coarse_first_ && !opens && entry.store_steps == 0) return;
    const TileRecord& record = *directory_.node(tile.node).record;
    const std::vector<StepRecord>& steps = record.steps(Layer::kRadiance);
    PlannedRequest request;
    request.node = tile.node;
    request.layer = Layer::kRadiance;
    request.from = entry.wire_steps;
    request.to = wanted;
    request.offset = wire_prefix_bytes(steps, request.from);
    request.length = steps[wanted - 1].end - request.offset;
    const double before = entry.store_steps > 0 ? steps[entry.store_steps - 1].error : kErrorWithoutLight;
    const double gain = std::max(before - steps[wanted - 1].error, kLeastGain);
    request.priority = (coarse_first_ ? kPixelsOfLight : kLight) * gain *
                       screen_area(record.bounds, tile.pixels_per_metre, camera_) /
                       static_cast<double>(std::max<uint64_t>(1, request.length));
    if (tile.node == stand_in_) request.priority *= kLightOfAll;
    out.push_back(request);
}

void Planner::add_openings(const std::vector<SelectedTile>& tiles, bool bridge_gaps) {
    for (const SelectedTile& tile : tiles) {
        for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
            if (!has_begun(tile, layer)) add_layer(tile, layer);
        }
    }
    add_charts(tiles, 1, bridge_gaps);
}

/// While neither all tiles of the view nor their stand-in can be drawn: the requests for a first picture, which may be
/// under way all. Else false. Before the directory is here the tiles chosen are coarse and large, and soon others.
bool Planner::add_first_picture(const std::vector<SelectedTile>& tiles, bool choice_known, bool host_room) {
    const SelectedTile* fallback = nullptr;
    std::vector<SelectedTile> view;
    uint64_t bytes = 0;
    for (const SelectedTile& tile : tiles) {
        if (tile.node == stand_in_ && tiles.size() > 1) {
            fallback = &tile;
        } else {
            if (is_missing(tile)) view.push_back(tile);
            bytes += opening_bytes(tile);
        }
    }
    const bool covered = fallback != nullptr && !is_missing(*fallback) && is_recognisable(*fallback);
    if (view.empty() || covered) return false;
    if (fallback != nullptr && host_room && is_recognisable(*fallback) &&
        opening_bytes(*fallback) * kStandInWorth <= bytes) {
        add_openings({*fallback}, host_room);
        return true;
    }
    if (choice_known) add_openings(view, host_room);
    return true;
}

void Planner::add_index(RequestKind kind, uint64_t bytes, double priority) {
    PlannedRequest request;
    request.kind = kind;
    request.length = bytes;
    request.priority = priority;
    out.push_back(request);
}

/// Neither here nor under way.
template <typename Pieces>
bool Planner::is_missing_piece(const Pieces& pieces, uint32_t piece) const {
    const CachedLayer* entry = cache_.find(pieces.key(piece));
    return !is_here(entry, pieces.step(piece)) && !is_requested(entry, pieces.step(piece));
}

/// Whether the payloads of [from, to) may come along: few bytes that are neither here nor under way.
template <typename Pieces>
bool Planner::can_bridge(const Pieces& pieces, uint32_t from, uint32_t to) const {
    if (pieces.dictionary.begin(to) - pieces.dictionary.begin(from) > kBridgedGap) return false;
    for (uint32_t piece = from; piece != to; piece = pieces.dictionary.next(piece)) {
        if (!is_missing_piece(pieces, piece) || !pieces.dictionary.usable(piece)) return false;
    }
    return true;
}

/// Requests for pieces, neighbours in the entry as one range; of a piece that several tiles want, the greatest gain.
template <typename Pieces>
void Planner::add_ranges(RequestKind kind, const Pieces& pieces, std::vector<WantedPiece> wanted, bool bridge_gaps) {
    std::sort(wanted.begin(), wanted.end(), [](const WantedPiece& a, const WantedPiece& b) {
        return a.piece != b.piece ? a.piece < b.piece : a.gain > b.gain;
    });
    const auto same = [](const WantedPiece& a, const WantedPiece& b) { return a.piece == b.piece; };
    wanted.erase(std::unique(wanted.begin(), wanted.end(), same), wanted.end());
    const size_t first = out.size();
    for (const WantedPiece& next : wanted) {
        const bool joins = out.size() > first && (out.back().to == next.piece ||
                                                  (bridge_gaps && can_bridge(pieces, out.back().to, next.piece)));
        if (!joins) {
            PlannedRequest request;
            request.kind = kind;
            request.from = next.piece;
            request.offset = pieces.dictionary.begin(next.piece);
            out.push_back(request);
        }
        PlannedRequest& request = out.back();
        request.to = pieces.dictionary.next(next.piece);
        request.length = pieces.dictionary.end(next.piece) - request.offset;
        request.priority += next.gain;
    }
    for (size_t i = first; i < out.size(); ++i) {
        out[i].priority /= static_cast<double>(std::max<uint64_t>(1, out[i].length));
    }
}

/// Pixels of error that a level of a map takes away, times the tile's pixels. Before it is here a coarser level is
/// drawn, or the relief is flat.
double Planner::map_gain(const SelectedTile& tile, MapPiece piece) const {
    const TileRecord& record = *directory_.node(tile.node).record;
    const FacadeDictionary& dictionary = knowledge_.dictionary;
    double before = record.flat_facade_error;
    for (uint32_t level = 0; level < level_of(piece); ++level) {
        const MapPiece coarser = map_piece(map_of(piece), level);
        const CachedLayer* entry = cache_.find(map_key(coarser));
        if (entry != nullptr && entry->store_steps > 0) before = dictionary.texel_error(coarser);
    }
    const double pixels =
        std::min<double>((before - dictionary.texel_error(piece)) * tile.pixels_per_metre, camera_.height);
    return std::max(pixels, kLeastGain) * screen_area(record.bounds, tile.pixels_per_metre, camera_);
}

std::vector<Planner::WantedPiece> Planner::missing_map_pieces(const std::vector<SelectedTile>& tiles) const {
    const MapPieces pieces{knowledge_.dictionary};
    std::vector<WantedPiece> wanted;
    for (const SelectedTile& tile : tiles) {
        for (const MapPiece piece : tile.pieces) {
            if (is_missing_piece(pieces, piece)) wanted.push_back({piece, map_gain(tile, piece)});
        }
    }
    return wanted;
}

void Planner::add_maps(const std::vector<SelectedTile>& tiles, bool bridge_gaps) {
    add_ranges(RequestKind::kMaps, MapPieces{knowledge_.dictionary}, missing_map_pieces(tiles), bridge_gaps);
}

/// Pixels of error that a level of a chart takes away, times the tile's pixels. Without the first one the tile is not
/// drawn.
double Planner::chart_gain(const SelectedTile& tile, const codec::atlas::SharedChartUse& use, uint32_t level) const {
    const ChartDictionary& dictionary = knowledge_.charts;
    const double before = level == 0 ? stand_in_error(tile) : dictionary.texel_error(use, level);
    const double after = dictionary.texel_error(use, level + 1);
    const double pixels =
        std::min<double>(before * tile.pixels_per_metre, camera_.height) - after * tile.pixels_per_metre;
    const double area = screen_area(directory_.node(tile.node).record->bounds, tile.pixels_per_metre, camera_);
    return std::max(pixels, kLeastGain) * area * (coarse_first_ && level == 0 ? kOpening : 1);
}

std::vector<Planner::WantedPiece> Planner::missing_chart_pieces(const std::vector<SelectedTile>& tiles,
                                                                uint32_t most_levels) const {
    std::vector<WantedPiece> wanted;
    for (const SelectedTile& tile : tiles) {
        for (const auto& use : knowledge_.tiles[tile.node].charts) {
            const uint32_t levels = tile.chart_levels(use.number);
            const CachedLayer* entry = cache_.find(chart_key(use.number));
            if (entry != nullptr && entry->store_steps >= levels) continue;
            for (uint32_t level = 0; level < std::min(levels, most_levels); ++level) {
                // What the store holds is needed again to check what is appended to it.
                const bool here = entry != nullptr && (entry->wire_held >> level & 1) != 0;
                if (here || is_requested(entry, level)) continue;
                wanted.push_back({chart_piece(use.number, level), chart_gain(tile, use, level)});
            }
        }
    }
    return wanted;
}

void Planner::add_charts(const std::vector<SelectedTile>& tiles, uint32_t most_levels, bool bridge_gaps) {
    if (!knowledge_.charts.known()) return;
    add_ranges(RequestKind::kCharts, ChartPieces{knowledge_.charts}, missing_chart_pieces(tiles, most_levels),
               bridge_gaps);
}

/// Its mesh will say how near each of its shared charts is.
bool chart_boxes_awaited(const DirectoryCache& directory, const CityKnowledge& knowledge, const SelectedTile& tile) {
    const TileKnowledge& known = knowledge.tiles[tile.node];
    return learns_chart_boxes(directory, tile.node) && !known.chart_boxes_known && tile.steps_of(Layer::kMesh) > 0 &&
           (!known.charts_known || !known.charts.empty());
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
                                          const std::vector<SelectedTile>& tiles, NodeIndex stand_in,
                                          const Camera& camera, const PlanOptions& options) {
    Planner planner(directory, knowledge, cache, camera, stand_in, options.coarse_first);
    planner.add_subtrees(selection.subtrees);
    if (options.directory_first && !planner.out.empty()) return std::move(planner.out);

    bool names_charts = false;
    for (const SelectedTile& tile : tiles) {
        const TileKnowledge& known = knowledge.tiles[tile.node];
        names_charts =
            names_charts || (tile.steps_of(Layer::kAtlas) > 0 && (!known.charts_known || !known.charts.empty()));
    }
    const bool chart_index_missing = names_charts && directory.manifest().shared_chart_count > 0 &&
                                     !knowledge.charts.known() && !knowledge.charts_broken;
    if (chart_index_missing && !options.chart_index_requested) planner.add_chart_index();

    if (options.coarse_first && planner.add_first_picture(tiles, selection.subtrees.empty(), options.host_room)) {
        order(planner.out);
        return std::move(planner.out);
    }

    bool relief = false;
    for (const SelectedTile& tile : tiles) {
        const bool charts_awaited =
            directory.manifest().shared_chart_count > 0 && !knowledge.tiles[tile.node].charts_known;
        if (options.directory_first && charts_awaited) planner.add_layer(tile, Layer::kAtlas);
        if (options.directory_first && chart_boxes_awaited(directory, knowledge, tile))
            planner.add_layer(tile, Layer::kMesh);
        if (!tile.has_relief()) continue;
        relief = true;
        planner.add_layer(tile, Layer::kFacade);
    }
    const bool index_missing = relief && !knowledge.dictionary.known() && directory.manifest().facade_map_count > 0;
    if (index_missing && !options.facade_index_requested) planner.add_facade_index();
    order(planner.out);
    if (options.directory_first && !planner.out.empty()) return std::move(planner.out);

    for (const SelectedTile& tile : tiles) planner.add_tile(tile);
    if (knowledge.dictionary.known()) planner.add_maps(tiles, options.host_room);
    planner.add_charts(tiles, codec::atlas::kMostChartLevels, options.host_room);
    for (const SelectedTile& tile : tiles) {
        if (options.light && (tile.node == stand_in || !planner.is_missing(tile))) planner.add_light(tile);
    }
    order(planner.out);
    return std::move(planner.out);
}

std::vector<PlannedRequest> plan_light(const DirectoryCache& directory, const CityKnowledge& knowledge,
                                       LayerCache& cache, const std::vector<SelectedTile>& tiles,
                                       const Camera& camera) {
    Planner planner(directory, knowledge, cache, camera, kNoNode, false);
    for (const SelectedTile& tile : tiles) planner.add_light(tile);
    order(planner.out);
    return std::move(planner.out);
}

std::vector<PlannedRequest> plan_casters(const DirectoryCache& directory, const CityKnowledge& knowledge,
                                         LayerCache& cache, const std::vector<SelectedTile>& casters,
                                         const std::vector<tiles::tileset::TileAddress>& subtrees,
                                         const Camera& camera) {
    Planner planner(directory, knowledge, cache, camera, kNoNode, false);
    planner.add_subtrees(subtrees);
    if (planner.out.empty()) {
        for (const SelectedTile& tile : casters) planner.add_tile(tile);
    }
    for (PlannedRequest& request : planner.out) {
        request.priority = kCasters * (request.kind == RequestKind::kSubtree ? 1 : request.priority);
    }
    order(planner.out);
    return std::move(planner.out);
}

}  // namespace citystream::client
