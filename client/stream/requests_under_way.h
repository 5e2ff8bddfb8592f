// Requests that were sent and not answered: room in host memory for their answers, and nothing asked for twice.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "client/cache/layer_cache.h"
#include "client/select/city_knowledge.h"
#include "client/stream/fetcher.h"
#include "client/stream/request_plan.h"
#include "client/stream/view_choice.h"

namespace citystream::client {

/// One thread.
class RequestsUnderWay {
  public:
    /// All must outlive it.
    RequestsUnderWay(Fetcher& fetcher, const DirectoryCache& directory, const CityKnowledge& knowledge,
                     LayerCache& cache, HostMemory& host)
        : fetcher_(fetcher), directory_(directory), knowledge_(knowledge), cache_(cache), host_(host) {}
    /// The fetcher outlives the streamer and may serve another one: nothing of ours stays in it.
    ~RequestsUnderWay();
    RequestsUnderWay(const RequestsUnderWay&) = delete;
    RequestsUnderWay& operator=(const RequestsUnderWay&) = delete;

    bool empty() const { return in_flight_.empty(); }
    size_t size() const { return in_flight_.size(); }
    size_t lights() const { return lights_; }  ///< of them: for light
    bool has_subtree(tiles::tileset::TileAddress root) const;
    bool has_facade_index() const { return facade_index_requested_; }
    bool has_chart_index() const { return chart_index_requested_; }

    /// Makes room for the answer, and beside it for `scratch` bytes: for decoding the largest layer. False: there is
    /// none.
    bool admit(const PlannedRequest& request, uint64_t scratch);
    /// Sends what was admitted.
    void submit(const PlannedRequest& request);
    /// Gives back an answer's room. Nothing: it was not asked for.
    std::optional<PlannedRequest> take(uint64_t id);
    /// Cancels what the view has had no use for in several updates.
    void cancel_unwanted(const ViewChoice& view);

  private:
    struct InFlight {
        PlannedRequest request;
        uint64_t reserved = 0;
        bool cancelled = false;
        uint32_t unwanted = 0;  ///< updates in a row that had no use for it
    };
    uint64_t most_bytes(const PlannedRequest& request) const;
    bool is_wanted(const PlannedRequest& request, const ViewChoice& view) const;
    void mark_requested(const PlannedRequest& request, bool requested);

    Fetcher& fetcher_;
    const DirectoryCache& directory_;
    const CityKnowledge& knowledge_;
    LayerCache& cache_;
    HostMemory& host_;
    std::map<uint64_t, InFlight> in_flight_;
    uint64_t next_id_ = 1;
    size_t lights_ = 0;
    bool facade_index_requested_ = false, chart_index_requested_ = false;
};

}  // namespace citystream::client
