// From a camera to the tiles to draw: reads the directory, selects prefixes by the one rule, requests what is missing,
// keeps what fits the budgets.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/cache/layer_store.h"
#include "client/render/frame.h"
#include "client/select/camera.h"
#include "client/stream/fetcher.h"
#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

class SubtreePool;

struct StreamerOptions {
    double tolerance_pixels = 1.0;
    uint64_t host_budget_bytes = 1ull << 30;  ///< wire bytes kept, decode buffers, directory: hard
    bool wait_for_selection =
        true;            ///< offline mode: update() returns when the frame has all it asked for (or it failed for good)
    bool decode = true;  ///< false (load client): bytes are counted and checked, not decoded
    uint32_t max_requests_in_flight = 64;  ///< the rest waits in the streamer, where each update orders it anew
    std::shared_ptr<SubtreePool>
        subtrees;  ///< share parsed directories among many streamers of one city; null: one of its own
    const std::atomic<bool>* stop = nullptr;  ///< set by a signal handler: an update that waits returns early
};

/// Counters of one update and running totals of the whole flight (see fly's --stats page in README for each field's
/// meaning).
struct StreamerFrame {
    uint64_t tiles_drawn = 0;   ///< tiles in the returned list
    uint64_t tiles_wanted = 0;  ///< tiles that the one rule chose
    uint64_t tiles_missing =
        0;  ///< chosen tiles that are not drawn as chosen: an ancestor, descendants or nothing stands in for them
    uint64_t requests = 0, wire_bytes = 0, decoded_bytes = 0;  ///< of this update
    uint64_t cache_hits = 0, cache_misses = 0;                 ///< layer prefixes found resident / not
    uint64_t gpu_bytes_used = 0;                               ///< slots in use, in bytes
    uint64_t host_bytes_used = 0;                              ///< highest value during this update
    double tolerance_used = 0;         ///< pixels: grows above the option when a budget does not hold the selection
    double achieved_error_pixels = 0;  ///< largest projected error of what is drawn
    double select_ms = 0, wait_ms = 0, decode_ms = 0;
    std::vector<std::string> warnings;  ///< damaged or missing tiles, new in this update
};

class CityStreamer {
  public:
    /// Reads tileset.json and the root subtree through the fetcher. Both outlive the streamer.
    static Result<std::unique_ptr<CityStreamer>> open(Fetcher& fetcher, LayerStore& store,
                                                      const StreamerOptions& options);
    virtual ~CityStreamer() = default;
    virtual const tiles::tileset::Manifest& manifest() const = 0;
    /// Advances to a camera; the result stays valid until the next call.
    virtual const std::vector<TileDraw>& update(const Camera& camera, StreamerFrame& frame) = 0;
    virtual void set_tolerance(double pixels) = 0;
};

}  // namespace citystream::client
