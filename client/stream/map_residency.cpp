#include "client/stream/map_residency.h"

#include <algorithm>
#include <thread>
#include <unordered_set>

#include "tiles/tileset/directory.h"

namespace citystream::client {

using tiles::tileset::checksum_of;

namespace {

/// Levels that are prepared together: enough to occupy the cores, few enough for little scratch memory.
constexpr size_t kExpandedPerThread = 16, kConvertedPerThread = 2;
/// Single levels that warnings name; a city whose maps are all bad shall not flood the terminal.
constexpr uint32_t kMostNamed = 20;

std::string name_of(MapPiece piece) {
    return "facades/maps: map " + std::to_string(map_of(piece)) + ", level " + std::to_string(level_of(piece));
}

}  // namespace

/// Leaves a level alone from now on.
void MapResidency::give_up(MapPiece piece, const std::string& why) {
    FacadeDictionary& dictionary = knowledge_.dictionary;
    dictionary.set_usable(piece, false);
    if (++given_up_ > kMostNamed) {
        warnings_.add("facades/maps: more levels cannot be drawn");
        return;
    }
    const bool flat = !dictionary.has_usable_level(map_of(piece));
    warnings_.add(name_of(piece) + why +
                  (flat ? "; its facades are drawn flat" : "; another level is drawn in its place"));
}

void MapResidency::damaged(MapPiece piece, const std::string& why) {
    CachedLayer& entry = cache_.at(map_key(piece));
    cache_.drop_wire_from(entry, 0);
    if (++entry.damages < 2) return;
    give_up(piece, " is damaged (" + why + ", also on the second try)");
}

void MapResidency::accept(MapPiece from, MapPiece to, std::span<const std::byte> bytes) {
    const FacadeDictionary& dictionary = knowledge_.dictionary;
    uint64_t at = 0;
    for (MapPiece piece = from; piece != to; piece = dictionary.next(piece)) {
        CachedLayer& entry = cache_.at(map_key(piece));
        const auto part = bytes.subspan(at, dictionary.wire_bytes(piece));
        at += part.size();
        if (entry.wire_steps > 0) continue;
        if (static_cast<uint32_t>(checksum_of(part.data(), part.size())) != dictionary.record_of(piece).checksum) {
            damaged(piece, "checksum differs");
        } else {
            cache_.add_wire(entry, {part.begin(), part.end()}, options_.decode);
        }
    }
}

/// Wanted levels with wire bytes that are not in the store, each once, in the order of the tiles.
std::vector<MapPiece> MapResidency::received_pieces(std::span<const SelectedTile> tiles) {
    std::vector<MapPiece> pieces;
    std::unordered_set<MapPiece> seen;
    for (const SelectedTile& tile : tiles) {
        for (const MapPiece piece : tile.pieces) {
            const CachedLayer* entry = cache_.find(map_key(piece));
            if (entry == nullptr || entry->wire_steps == 0 || entry->store_steps > 0) continue;
            if (seen.insert(piece).second) pieces.push_back(piece);
        }
    }
    return pieces;
}

void MapResidency::upload(std::span<const SelectedTile> tiles) {
    const std::vector<MapPiece> pieces = received_pieces(tiles);
    std::span<const MapPiece> left = pieces;
    if (!options_.decode) {
        for (const MapPiece piece : pieces) append_zeros(piece);
        return;
    }
    const Stopwatch watch(counters_.decode_ms);
    const uint32_t threads =
        options_.threads > 0 ? options_.threads : std::max(1u, std::thread::hardware_concurrency());
    size_t allowed = options_.target && options_.most_conversions > 0 ? options_.most_conversions : pieces.size();
    const size_t per_thread = options_.target ? kConvertedPerThread : kExpandedPerThread;
    while (!left.empty() && allowed > 0) {
        Batch batch;
        left = left.subspan(fill(batch, left, std::min(allowed, threads * per_thread)));
        allowed -= batch.pieces.size();
        run(batch);
    }
}

/// Takes pieces in while their slots and the memory to prepare them can be had; returns how many it has dealt with.
size_t MapResidency::fill(Batch& batch, std::span<const MapPiece> pieces, size_t most) {
    const FacadeDictionary& dictionary = knowledge_.dictionary;
    size_t taken = 0;
    for (; taken < pieces.size() && batch.pieces.size() < most; ++taken) {
        const MapPiece piece = pieces[taken];
        const uint64_t slots = cache_.slots_for(dictionary.resident_bytes(piece));
        if (!cache_.free_slots(batch.slots + slots)) continue;
        const auto& map = dictionary.record(map_of(piece));
        const uint32_t shipped = dictionary.record_of(piece).resident_bytes;
        const uint64_t scratch = preparing_bytes(shipped, map.width, map.height, options_.target);
        if (!cache_.free_host(batch.scratch + scratch)) {
            if (!batch.pieces.empty()) break;  // the next batch begins with it
            if (options_.target) {
                give_up(piece, " is too large to convert within the host budget");
                continue;
            }
        }
        batch.pieces.push_back(piece);
        batch.jobs.push_back({cache_.at(map_key(piece)).wire[0], shipped});
        batch.scratch += scratch;
        batch.slots += slots;
    }
    return taken;
}

void MapResidency::run(const Batch& batch) {
    const Scratch scratch(host_, batch.scratch);
    const std::vector<PreparedMap> prepared = prepare_maps(batch.jobs, options_.target, options_.threads);
    for (size_t i = 0; i < batch.pieces.size(); ++i) store(batch.pieces[i], prepared[i]);
}

void MapResidency::store(MapPiece piece, const PreparedMap& prepared) {
    counters_.conversions += prepared.converted ? 1 : 0;
    counters_.conversions_refused += prepared.refused ? 1 : 0;
    counters_.conversion_ms += prepared.convert_ms;
    if (prepared.words.empty()) {
        damaged(piece, prepared.failure);
        return;
    }
    FacadeDictionary& dictionary = knowledge_.dictionary;
    const uint64_t bytes = uint64_t{4} * prepared.words.size();
    if (options_.target) {
        const uint64_t before = dictionary.host_bytes();
        dictionary.learn_size(piece, bytes);
        host_.fixed += dictionary.host_bytes() - before;
    }
    if (cache_.slots_for(bytes) > cache_.slot_count()) {
        give_up(piece, " is too large for the GPU budget in the form that the renderer needs");
        return;
    }
    if (!cache_.free_slots(cache_.slots_for(bytes))) {
        warnings_.add(
            "the GPU budget has no room for all facade maps in the form that the renderer needs; relief is drawn flat "
            "or "
            "coarser");
        return;
    }
    if (prepared.opaque) knowledge_.dictionary.learn_opaque(piece);
    const Status appended = cache_.append(cache_.at(map_key(piece)), prepared.words, 1);
    if (appended) {
        counters_.decoded_bytes += bytes;
    } else {
        warnings_.add(name_of(piece) + ": " + appended.error().text());
    }
}

/// Of a client that does not decode.
void MapResidency::append_zeros(MapPiece piece) {
    const uint64_t bytes = knowledge_.dictionary.resident_bytes(piece);
    if (!cache_.free_slots(cache_.slots_for(bytes))) return;
    if (cache_.append_zeros(cache_.at(map_key(piece)), bytes, 1)) counters_.decoded_bytes += bytes;
}

CachedLayer* MapResidency::in_store(MapPiece piece) {
    CachedLayer* entry = cache_.find(map_key(piece));
    return entry != nullptr && entry->store_steps > 0 ? entry : nullptr;
}

CachedLayer* MapResidency::to_draw(MapPiece wanted) {
    const uint32_t map = map_of(wanted);
    const uint32_t levels = knowledge_.dictionary.record(map).level_count;
    for (uint32_t level = level_of(wanted); level < levels; ++level) {
        if (CachedLayer* held = in_store(map_piece(map, level))) return held;
    }
    for (uint32_t level = level_of(wanted); level-- > 0;) {
        if (CachedLayer* held = in_store(map_piece(map, level))) return held;
    }
    return nullptr;
}

}  // namespace citystream::client
