#include "client/stream/light_residency.h"

#include <algorithm>
#include <limits>
#include <thread>

#include "client/cache/decode_scratch.h"
#include "client/stream/request_plan.h"

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
    abandoned_ = true;
    for (UnderWay& under_way : under_way_) under_way.result.wait();
}

bool LightResidency::is_under_way(NodeIndex node) const {
    return std::any_of(under_way_.begin(), under_way_.end(),
                       [&](const UnderWay& under_way) { return under_way.work.node == node; });
}

void LightResidency::upload(std::span<const SelectedTile> tiles, const Camera& camera) {
    const Stopwatch watch(counters_.decode_ms);
    take_finished();
    std::vector<Candidate> candidates;
    for (const SelectedTile& tile : tiles) {
        if (tile.steps_of(Layer::kRadiance) > 0) candidates.push_back({&tile, worth(tile, camera)});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.worth > b.worth; });
    if (options_.wait) {
        upload_waiting(candidates);
    } else {
        begin_some(candidates);
    }
}

/// Where all is waited for, how near the tile is; else pixels that it covers for what decoding it takes, but first of
/// all the root, which lights all tiles until they have their own.
double LightResidency::worth(const SelectedTile& tile, const Camera& camera) const {
    if (options_.wait) return tile.pixels_per_metre;
    if (tile.node == 0) return std::numeric_limits<double>::infinity();
    const tiles::tileset::TileRecord& record = *directory_.node(tile.node).record;
    const uint32_t bytes = record.steps(Layer::kRadiance)[0].decoded_bytes;
    return screen_area(record.bounds, tile.pixels_per_metre, camera) / std::max(1U, bytes);
}

void LightResidency::upload_waiting(std::span<const Candidate> candidates) {
    for (const auto& [tile, worth] : candidates) {
        if (stopped()) break;
        if (under_way_.size() >= options_.threads) take_first();
        const auto work = work_for(*tile);
        while (work && !start(*work) && !under_way_.empty()) take_first();
    }
    while (!under_way_.empty()) take_first();
}

/// As much as there are idle threads for. Whole prefixes take long: while threads are busy with them, openings have
/// some of their own.
void LightResidency::begin_some(std::span<const Candidate> candidates) {
    if (stopped()) return;
    for (const bool opens : {true, false}) {
        size_t busy = 0;
        for (const UnderWay& under_way : under_way_) busy += !opens || under_way.work.opens ? 1 : 0;
        for (const auto& [tile, worth] : candidates) {
            if (busy >= options_.threads) break;
            const auto work = work_for(*tile);
            if (!work || work->opens != opens) continue;
            if (start(*work)) {
                ++busy;
            } else if (!under_way_.empty()) {
                return;
            }
        }
    }
}

/// What of a tile's light is received and not in the store.
std::optional<LightResidency::Work> LightResidency::work_for(const SelectedTile& tile) {
    CachedLayer* entry = cache_.find(layer_key(tile.node, Layer::kRadiance));
    if (entry == nullptr || is_under_way(tile.node)) return std::nullopt;
    const uint32_t received = std::min<uint32_t>(tile.steps_of(Layer::kRadiance), entry->wire_steps);
    if (!options_.decode) {
        const auto& steps = directory_.node(tile.node).record->steps(Layer::kRadiance);
        if (received > entry->store_steps) count_only(*entry, decoded_prefix_bytes(steps, received), received);
        return std::nullopt;
    }
    if (!options_.wait) return received > 0 ? next_work(tile, *entry) : std::nullopt;
    if (received <= entry->store_steps) return std::nullopt;
    return Work{tile.node, received, options_.matrix.form, false};
}

/// Without waiting: an opening, then all that is wanted.
std::optional<LightResidency::Work> LightResidency::next_work(const SelectedTile& tile, const CachedLayer& entry) {
    const DirectoryNode& node = directory_.node(tile.node);
    const uint32_t wanted = tile.steps_of(Layer::kRadiance);
    const bool opens = entry.store_steps == 0 && has_room(entry, node.record->steps(Layer::kRadiance)[0].decoded_bytes);
    if (opens) return Work{tile.node, 1, codec::radiance::MatrixForm::kRows, true};
    if (entry.wire_steps < wanted || (entry.store_steps >= wanted && !is_opening(tile.node, entry)))
        return std::nullopt;
    if (!has_room(entry, store_bytes(node, knowledge_.tiles[tile.node], Layer::kRadiance, wanted))) return std::nullopt;
    return Work{tile.node, wanted, options_.matrix.form, false};
}

bool LightResidency::is_opening(NodeIndex node, const CachedLayer& entry) const {
    const auto opened = opened_.find(node);
    return opened != opened_.end() && opened->second == entry.id;
}

/// For so many bytes in place of what is in the store. Else decoding would be for nothing, time and again.
bool LightResidency::has_room(const CachedLayer& entry, uint64_t bytes) {
    const uint64_t wanted = cache_.slots_for(bytes), held = cache_.slots_for(entry.store_bytes);
    return cache_.free_slots(wanted > held ? wanted - held : 0);
}

/// False: host memory has no room for it.
bool LightResidency::start(const Work& work) {
    const auto wanted = std::span(directory_.node(work.node).record->steps(Layer::kRadiance)).first(work.steps);
    uint64_t decoded = 0;
    for (const StepRecord& step : wanted) decoded += step.decoded_bytes;
    const uint64_t scratch =
        light_scratch_bytes(directory_.manifest().radiance_texels_across, decoded, wanted.back().end);
    if (!cache_.free_host(scratch)) return false;
    const CachedLayer& entry = cache_.at(layer_key(work.node, Layer::kRadiance));
    // The bytes may be dropped while a thread reads them.
    std::vector<std::vector<std::byte>> wire(entry.wire.begin(), entry.wire.begin() + work.steps);
    const codec::radiance::MatrixOptions matrix(work.form, options_.matrix.row_error, &abandoned_);
    auto decode = [wire = std::move(wire), wanted, matrix] {
        Decoded result;
        const Stopwatch watch(result.ms);
        result.good = decode_light(wire, wanted, matrix, result.light, result.failure);
        return result;
    };
    under_way_.emplace_back(work, host_, scratch).result = std::async(std::launch::async, std::move(decode));
    return true;
}

void LightResidency::take_finished() {
    for (auto at = under_way_.begin(); at != under_way_.end();) {
        if (at->is_finished()) {
            take(*at);
            at = under_way_.erase(at);
        } else if (options_.wait) {
            return;
        } else {
            ++at;
        }
    }
}

void LightResidency::take_first() {
    take(under_way_.front());
    under_way_.pop_front();
}

void LightResidency::take(UnderWay& under_way) {
    const auto& [node, steps, form, opens] = under_way.work;
    const Decoded decoded = under_way.result.get();
    ++counters_.light_decodes;
    counters_.light_decode_ms += decoded.ms;
    counters_.light_row_error = std::max(counters_.light_row_error, decoded.light.loss.row_error);
    counters_.light_quarters_dropped += decoded.light.loss.quarters;
    CachedLayer& entry = cache_.at(layer_key(node, Layer::kRadiance));
    if (!decoded.good) {
        tiles_.damaged(entry, node, Layer::kRadiance, decoded.failure.step, decoded.failure.message);
        return;
    }
    const bool is_asked_for = form == options_.matrix.form;
    if (steps < entry.store_steps || (steps == entry.store_steps && !is_opening(node, entry))) return;
    if (is_asked_for) learn(node, steps, decoded.light.words.size() * sizeof(uint32_t));
    if (!store(entry, node, steps, decoded.light.words)) return;
    if (is_asked_for) {
        opened_.erase(node);
    } else {
        opened_[node] = entry.id;
    }
}

/// So that what the directory had to allow for beyond it is free for other tiles.
void LightResidency::learn(NodeIndex node, uint32_t steps, uint64_t bytes) {
    uint32_t& known = knowledge_.tiles[node].light_bytes[steps - 1];
    if (known == bytes) return;
    known = static_cast<uint32_t>(bytes);
    ++knowledge_.light_sizes_learnt;
}

bool LightResidency::store(CachedLayer& entry, NodeIndex node, uint32_t steps, std::span<const uint32_t> words) {
    if (!cache_.is_needed(entry)) cache_.drop_store(entry);  // else making room might drop it later
    if (!has_room(entry, words.size_bytes())) return false;
    cache_.drop_store(entry);
    const Status appended = cache_.append(entry, words, steps);
    if (appended) {
        counters_.decoded_bytes += words.size_bytes();
    } else {
        warnings_.add(layer_path(Layer::kRadiance, directory_.node(node).record->address) + ": " +
                      appended.error().text());
    }
    return appended.ok();
}

/// Of a client that does not decode.
void LightResidency::count_only(CachedLayer& entry, uint64_t bytes, uint32_t steps) {
    const uint64_t before = entry.store_bytes;
    if (!cache_.free_slots(cache_.slots_for(bytes) - cache_.slots_for(before))) return;
    if (cache_.append_zeros(entry, bytes - before, steps)) counters_.decoded_bytes += bytes - before;
}

std::optional<LightResidency::Source> LightResidency::to_draw(NodeIndex node, const SelectedTile* chosen) {
    if (chosen != nullptr && chosen->steps_of(Layer::kRadiance) == 0) return std::nullopt;
    for (NodeIndex up = node; up != kNoNode; up = options_.wait ? kNoNode : directory_.node(up).parent) {
        CachedLayer* entry = cache_.find(layer_key(up, Layer::kRadiance));
        if (entry == nullptr || entry->store_steps == 0) continue;
        cache_.mark_drawn(*entry);
        return Source{up, entry->id};
    }
    return std::nullopt;
}

}  // namespace citystream::client
