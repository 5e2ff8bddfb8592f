#include "client/stream/requests_under_way.h"

#include <algorithm>
#include <utility>

#include "client/stream/dictionary_pieces.h"
#include "client/stream/request_cost.h"
#include "client/stream/tile_residency.h"

namespace citystream::client {

using tiles::tileset::Layer;

namespace {

constexpr uint32_t kUnwantedUpdates =
    2;  // before a request is cancelled: a view that wavers at a threshold wastes no bytes

}  // namespace

RequestsUnderWay::~RequestsUnderWay() {
    for (const auto& [id, under_way] : in_flight_) fetcher_.cancel(id);
}

bool RequestsUnderWay::has_subtree(tiles::tileset::TileAddress root) const {
    return std::any_of(in_flight_.begin(), in_flight_.end(), [&](const auto& entry) {
        return entry.second.request.kind == RequestKind::kSubtree && entry.second.request.subtree == root;
    });
}

uint64_t RequestsUnderWay::most_bytes(const PlannedRequest& request) const {
    return most_host_bytes(request, directory_.manifest(), host_.budget,
                           ViewChoice::bytes_per_tile() + TileResidency::bytes_per_tile());
}

bool RequestsUnderWay::admit(const PlannedRequest& request, uint64_t scratch) {
    return cache_.free_host(most_bytes(request) + scratch);
}

void RequestsUnderWay::submit(const PlannedRequest& request) {
    FetchRequest fetch;
    fetch.id = next_id_++;
    fetch.offset = request.offset;
    fetch.length = request.length;
    fetch.priority = request.priority;
    const uint64_t reserved = most_bytes(request);
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
    fetcher_.submit(std::move(fetch));
}

bool RequestsUnderWay::is_wanted(const PlannedRequest& request, const ViewChoice& view) const {
    switch (request.kind) {
        case RequestKind::kSubtree:
        case RequestKind::kFacadeIndex:
        case RequestKind::kChartIndex:
            return true;
        case RequestKind::kLayer: {
            const SelectedTile* tile = view.wanted_tile(request.node);
            if (request.layer == Layer::kMesh && view.is_caster(request.node)) return true;
            return tile != nullptr && tile->steps_of(request.layer) > request.from;
        }
        case RequestKind::kMaps:
            for (MapPiece piece = request.from; piece != request.to; piece = knowledge_.dictionary.next(piece)) {
                if (cache_.is_needed(cache_.at(map_key(piece)))) return true;
            }
            return false;
        case RequestKind::kCharts:
            for (ChartPiece piece = request.from; piece != request.to; piece = knowledge_.charts.next(piece)) {
                if (view.levels_needed(chart_of(piece)) > chart_level_of(piece)) return true;
            }
            return false;
    }
    return false;
}

std::optional<PlannedRequest> RequestsUnderWay::take(uint64_t id) {
    const auto found = in_flight_.find(id);
    if (found == in_flight_.end()) return {};
    const PlannedRequest request = found->second.request;
    host_.in_flight -= found->second.reserved;
    in_flight_.erase(found);
    mark_requested(request, false);
    return request;
}

void RequestsUnderWay::cancel_unwanted(const ViewChoice& view) {
    for (auto& [id, under_way] : in_flight_) {
        if (under_way.cancelled) continue;
        under_way.unwanted = is_wanted(under_way.request, view) ? 0 : under_way.unwanted + 1;
        if (under_way.unwanted < kUnwantedUpdates) continue;
        under_way.cancelled = true;
        fetcher_.cancel(id);
    }
}

void RequestsUnderWay::mark_requested(const PlannedRequest& request, bool requested) {
    if (is_light(request)) lights_ += requested ? 1 : ~size_t{0};
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

}  // namespace citystream::client
