// What is on the GPU and which wire bytes are in host memory, layer by layer; least recently needed goes first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <span>
#include <unordered_map>
#include <vector>

#include "client/cache/directory_cache.h"
#include "client/cache/host_memory.h"
#include "client/cache/layer_store.h"
#include "client/select/chart_dictionary.h"
#include "client/select/facade_dictionary.h"

namespace citystream::client {

/// Names a layer of a tile, a level of a facade map or a chart of the dictionary.
using CacheKey = uint64_t;
constexpr CacheKey layer_key(NodeIndex node, tiles::tileset::Layer layer) {
    return static_cast<CacheKey>(node) << 3 | static_cast<CacheKey>(layer);
}
constexpr CacheKey map_key(MapPiece piece) {
    return static_cast<CacheKey>(piece) << 3 | 7;
}
constexpr CacheKey chart_key(uint32_t chart) {
    return static_cast<CacheKey>(chart) << 3 | 6;
}
static_assert(tiles::tileset::kLayerCount <= 6, "three bits of a key");
constexpr MapPiece piece_of(CacheKey map_key) {
    return static_cast<MapPiece>(map_key >> 3);
}

/// A layer's resident prefixes: `wire_steps` steps as received, `store_steps` steps decoded in the store. Either may be
/// ahead of the other. Steps that came before those in front of them are kept, too.
struct CachedLayer {
    CacheKey key = 0;
    uint32_t wire_steps = 0;
    uint32_t wire_held = 0;                    ///< steps whose bytes are here, a bit each
    std::vector<std::vector<std::byte>> wire;  ///< by step; left empty where bytes are only counted
    std::vector<uint64_t> wire_sizes;          ///< by step; 0 where it is not here
    uint64_t wire_bytes = 0;
    LayerId id = kNoLayer;
    uint32_t store_steps = 0;
    uint64_t store_bytes = 0;
    uint32_t requested = 0;                               ///< steps that requests under way bring, a bit each
    uint32_t damages = 0;                                 ///< times that bytes of it came damaged
    uint32_t failures = 0;                                ///< times that a request for it failed
    uint64_t needed_by = 0;                               ///< serial of the last selection that needs it
    uint64_t drawn_by = 0;                                ///< serial of the last update that drew it
    std::list<CachedLayer*>::iterator in_store, in_wire;  ///< places in the two orders, when resident there
};

/// Steps from..to - 1, a bit each. Preconditions: from <= to < 32.
constexpr uint32_t step_bits(uint32_t from, uint32_t to) {
    return (1u << to) - (1u << from);
}

/// Host bytes of an entry with its share of the tables; entries stay once made.
inline constexpr uint64_t kCachedLayerBytes = sizeof(CachedLayer) + 128;

/// One thread. Never evicts what the current selection needs; what the last update drew goes only when nothing else is
/// left.
class LayerCache {
  public:
    LayerCache(LayerStore& store, HostMemory& host) : store_(store), host_(host) {}
    ~LayerCache();
    LayerCache(const LayerCache&) = delete;
    LayerCache& operator=(const LayerCache&) = delete;

    CachedLayer& at(CacheKey key);
    CachedLayer* find(CacheKey key);

    void begin_selection() { ++selection_; }
    void begin_update() { ++update_; }
    /// Marks as needed by the current selection and most recently used.
    void need(CachedLayer& layer);
    bool is_needed(const CachedLayer& layer) const { return layer.needed_by == selection_; }
    void mark_drawn(CachedLayer& layer) { layer.drawn_by = update_; }

    /// Evicts until `slots` are free. False when what is needed leaves no room.
    bool free_slots(uint64_t slots);
    /// Drops wire bytes until `bytes` more fit in the host budget. False when they cannot.
    bool free_host(uint64_t bytes);

    /// Keeps the next step's wire bytes (or, with `keep` false, only their number).
    void add_wire(CachedLayer& layer, std::vector<std::byte> bytes, bool keep);
    /// The same for any step that is not here.
    void put_wire(CachedLayer& layer, uint32_t step, std::vector<std::byte> bytes, bool keep);
    void drop_wire_from(CachedLayer& layer, uint32_t step);
    void drop_wire_step(CachedLayer& layer, uint32_t step);
    /// Appends decoded words that bring the layer to `steps` steps. The caller has freed the slots.
    Status append(CachedLayer& layer, std::span<const uint32_t> words, uint32_t steps);
    /// The same for a client that does not decode: `bytes` zeros.
    Status append_zeros(CachedLayer& layer, uint64_t bytes, uint32_t steps);
    /// Takes the precision buffer at the end of the layer's words (LayerStore::refine) to a higher level, which brings
    /// the layer to `steps` steps and `total_bytes` bytes in all. The caller has freed slots_for(total_bytes) slots,
    /// for the old words stay until the new ones are written; where it cannot, it drops the layer and appends it anew.
    /// A refinement that fails changes nothing; a layer of other than total_bytes bytes after it is dropped.
    Status refine(CachedLayer& layer, uint64_t begin, std::span<const uint32_t> planes, uint32_t to_level,
                  uint64_t total_bytes, uint32_t steps);
    void drop_store(CachedLayer& layer);

    uint64_t slots_used() const { return slots_used_; }
    /// Facade maps in the store, by level.
    const std::array<uint64_t, codec::facade::kMostFacadeLevels>& maps_in_store() const { return maps_in_store_; }
    uint64_t charts_in_store() const { return charts_in_store_; }
    uint64_t lights_in_store() const { return lights_in_store_; }  ///< radiance layers
    uint64_t light_bytes_in_store() const { return light_bytes_in_store_; }
    uint64_t slot_count() const { return store_.slot_count(); }
    uint64_t slots_for(uint64_t bytes) const { return store_.slots_for(bytes); }

  private:
    Status append_piece(CachedLayer& layer, std::span<const uint32_t> words);
    void count_in_store(CacheKey key, bool comes);

    LayerStore& store_;
    HostMemory& host_;
    std::unordered_map<CacheKey, CachedLayer> layers_;
    std::list<CachedLayer*> store_order_, wire_order_;  ///< most recently needed first
    uint64_t slots_used_ = 0;
    std::array<uint64_t, codec::facade::kMostFacadeLevels> maps_in_store_{};
    uint64_t charts_in_store_ = 0, lights_in_store_ = 0, light_bytes_in_store_ = 0;
    uint64_t selection_ = 1, update_ = 1;
};

}  // namespace citystream::client
