// The radiance layers of tiles: decoded on all cores and brought to the store. A tile is drawn without its own as well,
// lit as if nothing stood around it.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <future>
#include <span>
#include <string>
#include <vector>

#include "client/cache/layer_cache.h"
#include "client/select/selection.h"
#include "client/stream/layer_decoder.h"
#include "client/stream/residency_counters.h"
#include "client/stream/tile_residency.h"
#include "client/stream/warnings.h"

namespace citystream::client {

struct LightOptions {
    bool decode = true;  ///< false: words are only counted
    /// upload() returns when all that it can decode is in the store; else threads go on behind its back and what they
    /// have finished is taken in by later calls.
    bool wait = true;
    uint32_t threads = 0;  ///< 0: one a core, without waiting one less
    codec::radiance::MatrixOptions matrix;
    const std::atomic<bool>* stop = nullptr;  ///< set by a signal handler: no more are begun
};

/// One thread calls it. Results enter the store in the order in which their tiles were begun, so that with waiting what
/// the store holds does not depend on the number of threads. What a prefix takes there is noted in the knowledge. What
/// threads work on is counted in host memory's scratch until it is taken in.
class LightResidency {
  public:
    LightResidency(const DirectoryCache& directory, CityKnowledge& knowledge, LayerCache& cache, HostMemory& host,
                   TileResidency& tiles, Warnings& warnings, ResidencyCounters& counters, const LightOptions& options);
    /// Waits for its threads.
    ~LightResidency();
    LightResidency(const LightResidency&) = delete;
    LightResidency& operator=(const LightResidency&) = delete;

    /// Brings what is received of the tiles' wanted prefixes to the store, nearest first. A longer prefix takes the
    /// place of a shorter one when its words are ready.
    void upload(std::span<const SelectedTile> tiles);

    /// What is in the store of a tile, marked as drawn; kNoLayer: nothing, or `chosen` (null: draws whatever there is)
    /// wants none.
    LayerId to_draw(NodeIndex node, const SelectedTile* chosen);

  private:
    struct Decoded {
        bool good = false;
        DecodedLight light;
        DecodeFailure failure;
        double ms = 0;
    };
    struct UnderWay {
        UnderWay(NodeIndex of, uint32_t wanted, HostMemory& host, uint64_t bytes)
            : node(of), steps(wanted), scratch(host, bytes) {}
        NodeIndex node;
        uint32_t steps;
        Scratch scratch;
        std::future<Decoded> result;
    };
    enum class Start : uint8_t { kDone, kNothingToDo, kNoRoom };

    Start start(const SelectedTile& tile);
    void take_first();
    void take_finished();
    void learn(NodeIndex node, uint32_t steps, uint64_t bytes);
    void store(CachedLayer& entry, NodeIndex node, uint32_t steps, std::span<const uint32_t> words);
    void count_only(CachedLayer& entry, uint64_t bytes, uint32_t steps);
    bool is_under_way(NodeIndex node) const;
    bool stopped() const { return options_.stop != nullptr && options_.stop->load(); }

    const DirectoryCache& directory_;
    CityKnowledge& knowledge_;
    LayerCache& cache_;
    HostMemory& host_;
    TileResidency& tiles_;
    Warnings& warnings_;
    ResidencyCounters& counters_;
    LightOptions options_;
    std::deque<UnderWay> under_way_;
};

}  // namespace citystream::client
