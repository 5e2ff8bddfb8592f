#include "client/stream/arrivals.h"

#include <utility>
#include <vector>

namespace citystream::client {

using tiles::tileset::TileAddress;

void Arrivals::take(const FetchResult& result, StreamerFrame& frame) {
    const std::optional<PlannedRequest> answered = requests_.take(result.id);
    if (!answered) return;
    const PlannedRequest& request = *answered;
    if (result.cancelled) return;
    if (!result.bytes) {
        setbacks_.fail(request, result.bytes.error().text());
        return;
    }
    const std::vector<std::byte>& bytes = *result.bytes;
    frame.wire_bytes += bytes.size();
    if (request.kind == RequestKind::kLayer) frame.layer_bytes[static_cast<size_t>(request.layer)] += bytes.size();
    if (request.kind == RequestKind::kFacadeIndex) frame.facade_index_bytes += bytes.size();
    if (request.kind == RequestKind::kMaps) frame.facade_map_bytes += bytes.size();
    if (request.kind == RequestKind::kChartIndex) frame.chart_index_bytes += bytes.size();
    if (request.kind == RequestKind::kCharts) frame.chart_level_bytes += bytes.size();
    if (request.length > 0 && bytes.size() != request.length) {
        setbacks_.fail(request, "the answer has another length than the directory says");
        return;
    }
    switch (request.kind) {
        case RequestKind::kSubtree:
            take_subtree(request, bytes);
            break;
        case RequestKind::kFacadeIndex:
            take_facade_index(request, bytes);
            break;
        case RequestKind::kChartIndex:
            take_chart_index(request, bytes);
            break;
        default:
            take_layers(request, bytes);
            break;
    }
}

void Arrivals::take_subtree(const PlannedRequest& request, std::span<const std::byte> bytes) {
    const Status added = add_subtree(bytes, request.subtree);
    if (!added) setbacks_.reject(request, added.error().text());
}

void Arrivals::take_facade_index(const PlannedRequest& request, std::span<const std::byte> bytes) {
    auto maps = directory_.pool().facade_maps(bytes, directory_.manifest());
    if (!maps) {
        setbacks_.reject(request, maps.error().text());
        return;
    }
    knowledge_.dictionary.learn(std::move(*maps));
    host_.fixed += knowledge_.dictionary.host_bytes();
    host_.note_peak();
}

void Arrivals::take_chart_index(const PlannedRequest& request, std::span<const std::byte> bytes) {
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
void Arrivals::take_layers(const PlannedRequest& request, std::span<const std::byte> bytes) {
    if (request.kind == RequestKind::kMaps) {
        maps_.accept(request.from, request.to, bytes);
    } else if (request.kind == RequestKind::kCharts) {
        charts_.accept(request.from, request.to, bytes);
    } else {
        tiles_.accept_layer(request.node, request.layer, request.from, request.to, bytes);
        if (const SelectedTile* tile = view_.wanted_tile(request.node)) tiles_.upload(*tile);
    }
}

Status Arrivals::add_subtree(std::span<const std::byte> bytes, TileAddress root) {
    const uint64_t before = directory_.host_bytes();
    const Status added = directory_.add_subtree(bytes, root);
    if (!added) return added.error();
    const uint64_t grown = directory_.host_bytes() - before;
    cache_.free_host(grown);
    host_.fixed += grown + view_.grow();
    tiles_.grow();
    return Done{};
}

}  // namespace citystream::client
