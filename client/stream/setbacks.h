// What could not be fetched: left alone, for good or for a while, so that something else is drawn in its place.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "client/cache/layer_cache.h"
#include "client/select/city_knowledge.h"
#include "client/stream/request_plan.h"
#include "client/stream/warnings.h"

namespace citystream::client {

/// "path: why", unless the reason names the path itself (an address does).
std::string about(const std::string& path, const std::string& why);

/// One thread. What fails is marked in the directory, the knowledge and the cache; the pause before it is asked for
/// again doubles with each failure.
class Setbacks {
  public:
    using Clock = std::chrono::steady_clock;
    Setbacks(DirectoryCache& directory, CityKnowledge& knowledge, LayerCache& cache, Warnings& warnings)
        : directory_(directory), knowledge_(knowledge), cache_(cache), warnings_(warnings) {}

    /// A request failed, for a while: it may succeed later.
    void fail(const PlannedRequest& request, const std::string& why);
    /// The answer to a request for a piece of the directory (subtree or index) is bad. The first time it is asked for
    /// again, the second time it is given up for good.
    void reject(const PlannedRequest& request, const std::string& why);
    /// Allows again what has been left alone for long enough.
    void retry_due();

  private:
    struct Setback {
        Clock::time_point until;
        PlannedRequest request;
        uint8_t usable_before = TileKnowledge::kAllSteps;
    };
    uint32_t& piece_failures(const PlannedRequest& request);
    uint32_t mark_layer(Setback& setback, const std::string& why);
    uint32_t mark_maps(const PlannedRequest& request, const std::string& why);
    uint32_t mark_charts(const PlannedRequest& request, const std::string& why);
    void mark_directory(const PlannedRequest& request, const std::string& why);
    void allow(const Setback& setback);

    DirectoryCache& directory_;
    CityKnowledge& knowledge_;
    LayerCache& cache_;
    Warnings& warnings_;
    uint32_t facade_index_failures_ = 0, chart_index_failures_ = 0;
    std::map<tiles::tileset::TileAddress, uint32_t> subtree_failures_;
    std::vector<Setback> setbacks_;
};

}  // namespace citystream::client
