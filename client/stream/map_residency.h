// Which levels of which facade maps are here: takes received payloads in (checked), expands and converts them, brings
// them to the store, says which level a tile draws.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/cache/layer_cache.h"
#include "client/select/city_knowledge.h"
#include "client/select/selection.h"
#include "client/stream/map_preparer.h"
#include "client/stream/residency_counters.h"
#include "client/stream/warnings.h"

namespace citystream::client {

struct MapOptions {
    bool decode = true;               ///< false: bytes are counted and checked, not decoded
    std::optional<MapTarget> target;  ///< what the renderer reads; empty: maps as they arrive
    uint32_t threads = 0;             ///< that expand and convert; 0: one a core
    uint32_t most_conversions = 0;    ///< in one upload, so that a frame waits a bounded time; 0: all
};

/// One thread. A level's bytes that fail their checksum or the codec's checks are dropped: the first time they are
/// asked for again, the second time another level stands in for good (FacadeDictionary::wanted).
class MapResidency {
  public:
    MapResidency(CityKnowledge& knowledge, LayerCache& cache, HostMemory& host, Warnings& warnings,
                 ResidencyCounters& counters, const MapOptions& options)
        : knowledge_(knowledge),
          cache_(cache),
          host_(host),
          warnings_(warnings),
          counters_(counters),
          options_(options) {}

    /// Takes the payloads of [from, to).
    void accept(MapPiece from, MapPiece to, std::span<const std::byte> bytes);
    /// Brings what is received of the levels that the tiles want to the store. Levels that find no room stay away.
    void upload(std::span<const SelectedTile> tiles);
    /// The level of a map to draw: the wanted one, else the next finer one in the store, else the next coarser one;
    /// null when none is there.
    CachedLayer* to_draw(MapPiece wanted);

  private:
    struct Batch {
        std::vector<MapPiece> pieces;
        std::vector<MapJob> jobs;
        uint64_t scratch = 0, slots = 0;
    };
    std::vector<MapPiece> received_pieces(std::span<const SelectedTile> tiles);
    size_t fill(Batch& batch, std::span<const MapPiece> pieces, size_t most);
    void run(const Batch& batch);
    void store(MapPiece piece, const PreparedMap& prepared);
    void append_zeros(MapPiece piece);
    void damaged(MapPiece piece, const std::string& why);
    void give_up(MapPiece piece, const std::string& why);
    CachedLayer* in_store(MapPiece piece);

    CityKnowledge& knowledge_;
    LayerCache& cache_;
    HostMemory& host_;
    Warnings& warnings_;
    ResidencyCounters& counters_;
    MapOptions options_;
    uint32_t given_up_ = 0;  ///< levels
};

}  // namespace citystream::client
