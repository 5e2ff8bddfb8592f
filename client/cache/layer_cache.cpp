#include "client/cache/layer_cache.h"

#include <bit>

namespace citystream::client {

namespace {

bool is_map(CacheKey key) {
    return (key & 7) == 7;
}

bool is_chart(CacheKey key) {
    return (key & 7) == 6;
}

bool is_light(CacheKey key) {
    return (key & 7) == static_cast<CacheKey>(tiles::tileset::Layer::kRadiance);
}

}  // namespace

LayerCache::~LayerCache() {
    for (CachedLayer* layer : store_order_) store_.destroy(layer->id);
}

CachedLayer& LayerCache::at(CacheKey key) {
    const auto [found, added] = layers_.try_emplace(key);
    if (added) {
        found->second.key = key;
        host_.fixed += kCachedLayerBytes;
        host_.note_peak();
    }
    return found->second;
}

CachedLayer* LayerCache::find(CacheKey key) {
    const auto found = layers_.find(key);
    return found == layers_.end() ? nullptr : &found->second;
}

void LayerCache::need(CachedLayer& layer) {
    layer.needed_by = selection_;
    if (layer.id != kNoLayer) store_order_.splice(store_order_.begin(), store_order_, layer.in_store);
    if (layer.wire_held != 0) wire_order_.splice(wire_order_.begin(), wire_order_, layer.in_wire);
}

bool LayerCache::free_slots(uint64_t slots) {
    const uint64_t count = store_.slot_count();
    const auto enough = [&] { return slots_used_ + slots <= count; };
    for (const bool spare_drawn : {true, false}) {
        for (auto at = store_order_.end(); at != store_order_.begin() && !enough();) {
            CachedLayer& layer = **std::prev(at);
            if (is_needed(layer) || (spare_drawn && layer.drawn_by + 1 >= update_)) {
                --at;
            } else {
                drop_store(layer);  // erases the element before `at`, which stays valid
            }
        }
        if (enough()) return true;
    }
    return false;
}

bool LayerCache::free_host(uint64_t bytes) {
    for (auto at = wire_order_.end(); at != wire_order_.begin() && host_.free() < bytes;) {
        CachedLayer& layer = **std::prev(at);
        if (is_needed(layer)) {
            --at;
        } else {
            drop_wire_from(layer, 0);
        }
    }
    return host_.free() >= bytes;
}

void LayerCache::add_wire(CachedLayer& layer, std::vector<std::byte> bytes, bool keep) {
    put_wire(layer, layer.wire_steps, std::move(bytes), keep);
}

void LayerCache::put_wire(CachedLayer& layer, uint32_t step, std::vector<std::byte> bytes, bool keep) {
    if (layer.wire_held == 0) layer.in_wire = wire_order_.insert(wire_order_.begin(), &layer);
    if (layer.wire_sizes.size() <= step) layer.wire_sizes.resize(step + 1);
    layer.wire_sizes[step] = bytes.size();
    layer.wire_bytes += bytes.size();
    host_.wire += bytes.size();
    layer.wire_held |= 1u << step;
    layer.wire_steps = static_cast<uint32_t>(std::countr_one(layer.wire_held));
    bytes.shrink_to_fit();
    if (keep) {
        if (layer.wire.size() <= step) layer.wire.resize(step + 1);
        layer.wire[step] = std::move(bytes);
    }
    host_.note_peak();
}

void LayerCache::drop_wire_step(CachedLayer& layer, uint32_t step) {
    if ((layer.wire_held >> step & 1) == 0) return;
    layer.wire_bytes -= layer.wire_sizes[step];
    host_.wire -= layer.wire_sizes[step];
    layer.wire_sizes[step] = 0;
    if (step < layer.wire.size()) layer.wire[step] = {};
    layer.wire_held &= ~(1u << step);
    layer.wire_steps = static_cast<uint32_t>(std::countr_one(layer.wire_held));
    if (layer.wire_held == 0) wire_order_.erase(layer.in_wire);
}

void LayerCache::drop_wire_from(CachedLayer& layer, uint32_t step) {
    for (auto at = static_cast<uint32_t>(std::bit_width(layer.wire_held)); at-- > step;) drop_wire_step(layer, at);
}

void LayerCache::count_in_store(CacheKey key, bool comes) {
    const uint64_t change = comes ? 1 : ~uint64_t{0};
    if (is_map(key)) maps_in_store_[level_of(piece_of(key))] += change;
    if (is_chart(key)) charts_in_store_ += change;
    if (is_light(key)) lights_in_store_ += change;
}

Status LayerCache::append_piece(CachedLayer& layer, std::span<const uint32_t> words) {
    if (layer.id == kNoLayer) {
        layer.id = store_.create();
        layer.in_store = store_order_.insert(store_order_.begin(), &layer);
        count_in_store(layer.key, true);
    }
    const Status appended = store_.append(layer.id, words);
    if (!appended) {
        drop_store(layer);
        return appended.error();
    }
    slots_used_ += store_.slots_for(layer.store_bytes + words.size_bytes()) - store_.slots_for(layer.store_bytes);
    layer.store_bytes += words.size_bytes();
    if (is_light(layer.key)) light_bytes_in_store_ += words.size_bytes();
    return Done{};
}

Status LayerCache::append(CachedLayer& layer, std::span<const uint32_t> words, uint32_t steps) {
    Status appended = append_piece(layer, words);
    if (appended) layer.store_steps = steps;
    return appended;
}

Status LayerCache::append_zeros(CachedLayer& layer, uint64_t bytes, uint32_t steps) {
    static constexpr std::array<uint32_t, 4096> kZeros{};
    for (uint64_t words = bytes / 4; words > 0;) {
        const uint64_t piece = std::min<uint64_t>(words, kZeros.size());
        Status appended = append_piece(layer, std::span(kZeros).first(piece));
        if (!appended) return appended;
        words -= piece;
    }
    layer.store_steps = steps;
    return Done{};
}

Status LayerCache::refine(CachedLayer& layer, uint64_t begin, std::span<const uint32_t> planes, uint32_t to_level,
                          uint64_t total_bytes, uint32_t steps) {
    if (layer.id == kNoLayer) return Error{"a layer that is not in the store cannot be refined"};
    const Result<uint64_t> bytes = store_.refine(layer.id, begin, planes, to_level);
    if (!bytes) return bytes.error();
    slots_used_ += store_.slots_for(*bytes) - store_.slots_for(layer.store_bytes);
    layer.store_bytes = *bytes;
    layer.store_steps = steps;
    if (*bytes == total_bytes) return Done{};
    drop_store(layer);
    return Error{"a refined layer is not as large as was said"};
}

void LayerCache::drop_store(CachedLayer& layer) {
    if (layer.id == kNoLayer) return;
    store_.destroy(layer.id);
    store_order_.erase(layer.in_store);
    count_in_store(layer.key, false);
    if (is_light(layer.key)) light_bytes_in_store_ -= layer.store_bytes;
    slots_used_ -= store_.slots_for(layer.store_bytes);
    layer.id = kNoLayer;
    layer.store_steps = 0;
    layer.store_bytes = 0;
}

}  // namespace citystream::client
