// The payloads of both dictionaries as one kind of thing: pieces that lie one behind the other in an entry, each of
// them a step of some cached layer.
#pragma once

#include "client/cache/layer_cache.h"
#include "client/select/chart_dictionary.h"
#include "client/select/facade_dictionary.h"

namespace citystream::client {

/// Levels of facade maps: each is a layer of one step.
struct MapPieces {
    const FacadeDictionary& dictionary;
    static CacheKey key(MapPiece piece) { return map_key(piece); }
    static uint32_t step(MapPiece) { return 0; }
};

/// Levels of charts: steps of the chart's layer.
struct ChartPieces {
    const ChartDictionary& dictionary;
    static CacheKey key(ChartPiece piece) { return chart_key(chart_of(piece)); }
    static uint32_t step(ChartPiece piece) { return chart_level_of(piece); }
};

/// Whether a step has been received, now or before it was brought to the store.
inline bool is_here(const CachedLayer* layer, uint32_t step) {
    return layer != nullptr && ((layer->wire_held >> step & 1) != 0 || layer->store_steps > step);
}

inline bool is_requested(const CachedLayer* layer, uint32_t step) {
    return layer != nullptr && (layer->requested >> step & 1) != 0;
}

inline void set_requested(CachedLayer& layer, uint32_t step_mask, bool requested) {
    layer.requested = requested ? layer.requested | step_mask : layer.requested & ~step_mask;
}

}  // namespace citystream::client
