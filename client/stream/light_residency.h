// The radiance layers of tiles: decoded on all cores and brought to the store. A tile is drawn without its own as well:
// lit by that of an ancestor, or as if nothing stood around it.
//
// Decoding takes seconds a tile. Who waits for it decodes each wanted prefix once. Who does not first makes an
// *opening* of each tile, its first step with the rows of the matrix as they are: a quarter of the work, and all but
// the last percent of the light. The wanted prefix in the wanted form takes its place when openings leave threads idle.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <list>
#include <optional>
#include <span>
#include <unordered_map>
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
    /// upload() returns when all that it can decode is in the store; else threads go on behind its back, openings come
    /// first, and what they have finished is taken in by later calls.
    bool wait = true;
    /// 0: one a core, without waiting one less. As many again for openings while all are busy with whole prefixes.
    uint32_t threads = 0;
    codec::radiance::MatrixOptions matrix;
    const std::atomic<bool>* stop = nullptr;  ///< set by a signal handler: no more are begun
};

/// One thread calls it. With waiting, results enter the store in the order in which their tiles were begun, so that
/// what the store holds does not depend on the number of threads; else as they are finished. What a prefix takes there
/// is noted in the knowledge. What threads work on is counted in host memory's scratch until it is taken in.
class LightResidency {
  public:
    LightResidency(const DirectoryCache& directory, CityKnowledge& knowledge, LayerCache& cache, HostMemory& host,
                   TileResidency& tiles, Warnings& warnings, ResidencyCounters& counters, const LightOptions& options);
    /// Gives up what its threads are at, and waits for them: nothing of it is stored, counted or warned of.
    ~LightResidency();
    LightResidency(const LightResidency&) = delete;
    LightResidency& operator=(const LightResidency&) = delete;

    /// Brings what is received of the tiles' wanted prefixes to the store: nearest first, or without waiting first what
    /// covers the most of the camera's picture for the work it makes. A longer prefix takes the place of a shorter one
    /// when its words are ready.
    void upload(std::span<const SelectedTile> tiles, const Camera& camera);

    /// Whose light a tile is drawn with, marked as drawn: its own; without waiting, where that is not in the store,
    /// that of its nearest ancestor that has some there. Nothing: neither, or `chosen` (null: draws whatever there is)
    /// wants none.
    struct Source {
        NodeIndex node = kNoNode;
        LayerId layer = kNoLayer;
    };
    std::optional<Source> to_draw(NodeIndex node, const SelectedTile* chosen);

  private:
    struct Decoded {
        bool good = false;
        DecodedLight light;
        DecodeFailure failure;
        double ms = 0;
    };
    /// What is to be decoded of a tile.
    struct Work {
        NodeIndex node = kNoNode;
        uint32_t steps = 0;
        codec::radiance::MatrixForm form{};
        bool opens = false;
    };
    struct UnderWay {
        UnderWay(const Work& what, HostMemory& host, uint64_t bytes) : work(what), scratch(host, bytes) {}
        Work work;
        Scratch scratch;
        std::future<Decoded> result;
        bool is_finished() const { return result.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
    };

    struct Candidate {
        const SelectedTile* tile = nullptr;
        double worth = 0;
    };

    double worth(const SelectedTile& tile, const Camera& camera) const;
    void upload_waiting(std::span<const Candidate> candidates);
    void begin_some(std::span<const Candidate> candidates);
    std::optional<Work> work_for(const SelectedTile& tile);
    std::optional<Work> next_work(const SelectedTile& tile, const CachedLayer& entry);
    bool is_opening(NodeIndex node, const CachedLayer& entry) const;
    bool has_room(const CachedLayer& entry, uint64_t bytes);
    bool start(const Work& work);
    void take_first();
    void take_finished();
    void take(UnderWay& under_way);
    void learn(NodeIndex node, uint32_t steps, uint64_t bytes);
    bool store(CachedLayer& entry, NodeIndex node, uint32_t steps, std::span<const uint32_t> words);
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
    std::atomic<bool> abandoned_ = false;            ///< told to the threads
    std::list<UnderWay> under_way_;                  ///< in the order in which they were begun
    std::unordered_map<NodeIndex, LayerId> opened_;  ///< with words of another form than the one asked for
};

}  // namespace citystream::client
