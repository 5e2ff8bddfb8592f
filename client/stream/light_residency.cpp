#include "client/stream/light_residency.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "client/cache/decode_scratch.h"

namespace citystream::client {

using tiles::tileset::Layer;
using tiles::tileset::StepRecord;

namespace {

uint32_t threads_of(const LightOptions& options) {
    if (options.threads > 0) return options.threads;
    const uint32_t cores = std::max(1u, std::thread::hardware_concurrency());
    return options.wait ? cores : std::max(1u, cores - 1);  // one draws
}

}  // namespace

LightResidency::LightResidency(const DirectoryCache& directory, CityKnowledge& knowledge, LayerCache& cache,
                               HostMemory& host, TileResidency& tiles, Warnings& warnings, ResidencyCounters& counters,
                               const LightOptions& options)
    : directory_(directory),
      knowledge_(knowledge),
      cache_(cache),
      host_(host),
      tiles_(tiles),
      warnings_(warnings),
      counters_(counters),
      options_(options) {
    options_.threads = threads_of(options);
}

LightResidency::~LightResidency() {
    for (UnderWay& work : under_way_) work.result.wait();
}

bool LightResidency::is_under_way(NodeIndex node) const {
    return std::any_of(under_way_.begin(), under_way_.end(), [&](const UnderWay& work) { return work.node == node; });
}

void LightResidency::upload(std::span<const SelectedTile> tiles) {
    const Stopwatch watch(counters_.decode_ms);
    take_finished();
    std::vector<const SelectedTile*> order;
    for (const SelectedTile& tile : tiles) {
        if (tile.steps_of(Layer::kRadiance) > 0) order.push_back(&tile);
    }
    std::stable_sort(order.begin(), order.end(), [](const SelectedTile* a, const SelectedTile* b) {
        return a->pixels_per_metre > b->pixels_per_metre;
    });
    for (const SelectedTile* tile : order) {
        if (stopped()) break;
        if (under_way_.size() >= options_.threads) {
            if (!options_.wait) return;
            take_first();
        }
        while (start(*tile) == Start::kNoRoom && !under_way_.empty()) {
            if (!options_.wait) return;
            take_first();
        }
    }
    while (options_.wait && !under_way_.empty()) take_first();
}

/// Begins with what of a tile's light is received and not in the store.
LightResidency::Start LightResidency::start(const SelectedTile& tile) {
    CachedLayer* entry = cache_.find(layer_key(tile.node, Layer::kRadiance));
    if (entry == nullptr || is_under_way(tile.node)) return Start::kNothingToDo;
    const uint32_t steps = std::min<uint32_t>(tile.steps_of(Layer::kRadiance), entry->wire_steps);
    if (steps <= entry->store_steps) return Start::kNothingToDo;
    const auto wanted = std::span(directory_.node(tile.node).record->steps(Layer::kRadiance)).first(steps);
    uint64_t decoded = 0;
    for (const StepRecord& step : wanted) decoded += step.decoded_bytes;
    if (!options_.decode) {
        count_only(*entry, decoded, steps);
        return Start::kDone;
    }
    const uint64_t scratch =
        light_scratch_bytes(directory_.manifest().radiance_texels_across, decoded, wanted.back().end);
    if (!cache_.free_host(scratch)) return Start::kNoRoom;
    // The bytes may be dropped while a thread reads them.
    std::vector<std::vector<std::byte>> wire(entry->wire.begin(), entry->wire.begin() + steps);
    auto work = [wire = std::move(wire), wanted, matrix = options_.matrix] {
        Decoded result;
        const Stopwatch watch(result.ms);
        result.good = decode_light(wire, wanted, matrix, result.light, result.failure);
        return result;
    };
    under_way_.emplace_back(tile.node, steps, host_, scratch).result = std::async(std::launch::async, std::move(work));
    return Start::kDone;
}

void LightResidency::take_finished() {
    while (!under_way_.empty() &&
           under_way_.front().result.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
        take_first();
    }
}

void LightResidency::take_first() {
    const NodeIndex node = under_way_.front().node;
    const uint32_t steps = under_way_.front().steps;
    const Decoded decoded = under_way_.front().result.get();
    ++counters_.light_decodes;
    counters_.light_decode_ms += decoded.ms;
    counters_.light_row_error = std::max(counters_.light_row_error, decoded.light.loss.row_error);
    counters_.light_quarters_dropped += decoded.light.loss.quarters;
    CachedLayer& entry = cache_.at(layer_key(node, Layer::kRadiance));
    if (!decoded.good) {
        tiles_.damaged(entry, node, Layer::kRadiance, decoded.failure.step, decoded.failure.message);
    } else if (steps > entry.store_steps) {
        learn(node, steps, decoded.light.words.size() * sizeof(uint32_t));
        store(entry, node, steps, decoded.light.words);
    }
    under_way_.pop_front();
}

/// So that what the directory had to allow for beyond it is free for other tiles.
void LightResidency::learn(NodeIndex node, uint32_t steps, uint64_t bytes) {
    uint32_t& known = knowledge_.tiles[node].light_bytes[steps - 1];
    if (known == bytes) return;
    known = static_cast<uint32_t>(bytes);
    ++knowledge_.light_sizes_learnt;
}

void LightResidency::store(CachedLayer& entry, NodeIndex node, uint32_t steps, std::span<const uint32_t> words) {
    if (!cache_.is_needed(entry)) cache_.drop_store(entry);  // else making room might drop it later
    const uint64_t wanted = cache_.slots_for(words.size_bytes()), held = cache_.slots_for(entry.store_bytes);
    if (!cache_.free_slots(wanted > held ? wanted - held : 0)) return;
    cache_.drop_store(entry);
    const Status appended = cache_.append(entry, words, steps);
    if (appended) {
        counters_.decoded_bytes += words.size_bytes();
    } else {
        warnings_.add(layer_path(Layer::kRadiance, directory_.node(node).record->address) + ": " +
                      appended.error().text());
    }
}

/// Of a client that does not decode.
void LightResidency::count_only(CachedLayer& entry, uint64_t bytes, uint32_t steps) {
    const uint64_t before = entry.store_bytes;
    if (!cache_.free_slots(cache_.slots_for(bytes) - cache_.slots_for(before))) return;
    if (cache_.append_zeros(entry, bytes - before, steps)) counters_.decoded_bytes += bytes - before;
}

LayerId LightResidency::to_draw(NodeIndex node, const SelectedTile* chosen) {
    if (chosen != nullptr && chosen->steps_of(Layer::kRadiance) == 0) return kNoLayer;
    CachedLayer* entry = cache_.find(layer_key(node, Layer::kRadiance));
    if (entry == nullptr || entry->store_steps == 0) return kNoLayer;
    cache_.mark_drawn(*entry);
    return entry->id;
}

}  // namespace citystream::client
