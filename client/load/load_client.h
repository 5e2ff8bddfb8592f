// One of many clients: the streamer that citystream-fly uses, fed by a recorded path, drawing nothing, watched while it
// fetches.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "client/cache/host_layer_store.h"
#include "client/load/city_index.h"
#include "client/load/drawn_prefixes.h"
#include "client/load/latency_histogram.h"
#include "client/load/measuring_fetcher.h"
#include "client/path/camera_path.h"
#include "client/stream/city_streamer.h"
#include "client/stream/fetcher.h"
#include "codec/result.h"

namespace citystream::client {

struct LoadClientOptions {
    std::string place;
    FetcherOptions fetcher;
    StreamerOptions streamer;
    uint64_t gpu_budget_bytes = 512ull << 20;  ///< of the layer store, which keeps no words
    uint32_t width = 1280, height = 720;
};

/// What clients measured; those of several threads are merged at the end.
struct LoadMeasurements {
    LatencyHistogram opening;  ///< until tileset.json and the root subtree were here
    LatencyHistogram request;  ///< from the scheduled time of the camera update that asked, to the answer's last byte
    LatencyHistogram service;  ///< from being sent to the last byte, as the fetcher saw it
    LatencyHistogram visible;  ///< from the scheduled time of the update that first asked for a tile, to the end of the
                               ///< update that drew it
    LatencyHistogram lateness;                   ///< how late updates began: the load client's own strain
    uint64_t updates = 0, updates_complete = 0;  ///< complete: all tiles drawn as chosen
    uint64_t answers = 0, failed = 0, cancelled = 0;
    uint64_t unanswered = 0;  ///< at the end; counted in `request` with the time they had waited
    uint64_t tiles_visible = 0;
    uint64_t tiles_abandoned = 0;   ///< no longer wanted before they came
    uint64_t tiles_unused = 0;      ///< came, and were not drawn by the next update: stand-ins, or no longer wanted
    uint64_t tiles_unfinished = 0;  ///< at the end; counted in `visible` with the time they had waited
    uint64_t directory_bytes = 0, layer_bytes = 0;  ///< bodies received
    uint64_t drawn_bytes = 0;                       ///< see DrawnPrefixes::bytes
    uint64_t most_host_bytes = 0, most_gpu_bytes = 0;
    double worst_tolerance = 0;      ///< pixels: above the option where a budget did not hold the selection
    FetcherStatistics fetcher;       ///< sum
    std::set<std::string> warnings;  ///< some
    std::string first_error;

    void merge(const LoadMeasurements& other);
    void note_warning(const std::string& text);
};

/// One thread at a time. Where it puts what it measures may change between calls, so that each driving thread fills one
/// of its own.
class LoadClient final : private FetchObserver {
  public:
    /// Connects and reads the directory's beginning; waits for it.
    static Result<std::unique_ptr<LoadClient>> open(const LoadClientOptions& options, CityIndex& index,
                                                    LoadMeasurements& measurements);
    ~LoadClient() override = default;
    LoadClient(const LoadClient&) = delete;
    LoadClient& operator=(const LoadClient&) = delete;

    void measure_into(LoadMeasurements& measurements) { measurements_ = &measurements; }
    /// One camera update that was due at `due`, with the camera of the path.
    void update(const CameraSample& sample, LoadClock::time_point due);
    /// Times what has arrived since. Cheap when nothing is under way.
    void collect() { fetcher_.collect(); }
    /// Adds what is still open, and the totals. Once, at the end.
    void finish(LoadClock::time_point now);

  private:
    LoadClient(const LoadClientOptions& options, CityIndex& index, LoadMeasurements& measurements,
               std::unique_ptr<Fetcher> fetcher);
    void on_submit(const FetchRequest& request, LoadClock::time_point intended) override;
    void on_result(const FetchRequest& request, LoadClock::time_point intended, const FetchResult& result,
                   LoadClock::time_point seen) override;
    void note_draws(const std::vector<TileDraw>& draws);
    void note_frame(const StreamerFrame& frame);

    LoadClientOptions options_;
    CityIndex& index_;
    LoadMeasurements* measurements_;
    std::unique_ptr<Fetcher> network_;
    MeasuringFetcher fetcher_;
    HostLayerStore store_;
    DrawnPrefixes drawn_;
    /// A tile that was asked for and is not drawn yet.
    struct Awaited {
        LoadClock::time_point since;
        uint32_t requests = 0;  ///< under way
        bool lost = false;      ///< one of them was cancelled or failed
    };
    std::map<tiles::tileset::TileAddress, Awaited> awaited_;
    std::unique_ptr<CityStreamer> streamer_;
};

}  // namespace citystream::client
