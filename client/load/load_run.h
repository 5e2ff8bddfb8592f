// A load test: many clients replay one path on a fixed schedule.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "client/load/load_client.h"
#include "client/path/camera_path.h"

namespace citystream::client {

struct LoadOptions {
    LoadClientOptions client;
    uint32_t clients = 1;
    double duration_seconds = 30;
    double updates_per_second = 20;  ///< camera updates of each client
    double ramp_seconds = 2;         ///< clients begin spread over this time
    uint64_t seed = 1;               ///< where on the path each client begins, and when
    uint32_t threads = 0;            ///< that drive clients; 0: one per processor
};

struct LoadOutcome {
    LoadMeasurements measured;
    uint32_t clients_opened = 0, clients_failed = 0;
    double elapsed_seconds = 0;  ///< of the replay, without opening
    bool interrupted = false;
    /// Something of the city was received.
    bool fetched_anything() const { return measured.answers > 0; }
};

/// Where client `index` begins: seconds along the path, and seconds after the start of the replay. A function of its
/// arguments only.
struct ClientStart {
    double path_seconds = 0, delay_seconds = 0;
};
ClientStart start_of_client(uint32_t index, const LoadOptions& options, double path_duration);

/// Opens all clients, then replays: client updates happen at start + k / rate, whether earlier answers have come or
/// not, and a driving thread that falls behind catches up without leaving updates out, so no wait goes unmeasured. The
/// path is flown again from its beginning when it ends. `stop` ends the run early with what was measured.
/// `progress(seconds, measured requests)` is called a few times a second from the calling thread.
LoadOutcome run_load(const LoadOptions& options, const CameraPath& path, const std::atomic<bool>& stop,
                     const std::function<void(double, uint64_t)>& progress);

}  // namespace citystream::client
