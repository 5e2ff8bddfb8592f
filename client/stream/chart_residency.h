// Which levels of which shared charts are here: takes received payloads in (checked), brings prefixes to the store,
// says what a tile draws.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "client/cache/layer_cache.h"
#include "client/render/frame.h"
#include "client/select/city_knowledge.h"
#include "client/stream/residency_counters.h"
#include "client/stream/warnings.h"

namespace citystream::client {

/// One thread. A payload that fails its checksum or the codec's checks is dropped: the first time it is asked for
/// again, the second time the levels before it are all there are, and without any the chart is drawn in its mean
/// colour.
class ChartResidency {
  public:
    ChartResidency(CityKnowledge& knowledge, LayerCache& cache, HostMemory& host, Warnings& warnings,
                   ResidencyCounters& counters, bool decode)
        : knowledge_(knowledge),
          cache_(cache),
          host_(host),
          warnings_(warnings),
          counters_(counters),
          decode_(decode) {}

    /// Takes the payloads of [from, to), in whatever order levels come.
    void accept(ChartPiece from, ChartPiece to, std::span<const std::byte> bytes);
    /// Brings what is received of these prefixes to the store. What finds no room stays away.
    void upload(std::span<const ChartPrefix> wanted);
    /// Something of the chart can be shown, if only its colour for good.
    bool can_show(const codec::atlas::SharedChartUse& use);
    /// At most `levels` of the chart. Marks it as drawn.
    SharedChartBinding to_draw(const codec::atlas::SharedChartUse& use, uint32_t levels);

  private:
    void upload_prefix(const ChartPrefix& prefix, CachedLayer& entry);
    bool decode_to_store(const ChartPrefix& prefix, CachedLayer& entry);
    uint32_t first_bad_level(const ChartPrefix& prefix, std::span<const uint32_t> words) const;
    void damaged(ChartPiece piece, const std::string& why);

    CityKnowledge& knowledge_;
    LayerCache& cache_;
    HostMemory& host_;
    Warnings& warnings_;
    ResidencyCounters& counters_;
    bool decode_;
    uint32_t given_up_ = 0;  ///< levels
};

}  // namespace citystream::client
