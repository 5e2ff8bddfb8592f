// What bringing bytes to the layer store cost: counted by all residencies, reported by frame.
#pragma once

#include <chrono>
#include <cstdint>

#include "client/cache/host_memory.h"

namespace citystream::client {

struct ResidencyCounters {
    uint64_t decoded_bytes = 0;
    double decode_ms = 0;
    uint64_t conversions = 0, conversions_refused = 0;  ///< facade maps brought to another form, or refused by it
    double conversion_ms = 0;                           ///< of all cores together
    uint64_t light_decodes = 0;                         ///< prefixes of radiance layers
    double light_decode_ms = 0;                         ///< of all cores together
    double light_row_error = 0;                         ///< of the worst row of them (MatrixLoss)
    uint64_t light_quarters_dropped = 0;                ///< from their matrices
};

/// Adds the time of its life to a counter.
class Stopwatch {
  public:
    explicit Stopwatch(double& milliseconds) : milliseconds_(milliseconds) {}
    ~Stopwatch() {
        milliseconds_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin_).count();
    }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

  private:
    double& milliseconds_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Decode buffers, counted while they live.
class Scratch {
  public:
    Scratch(HostMemory& host, uint64_t bytes) : host_(host), bytes_(bytes) {
        host_.scratch += bytes_;
        host_.note_peak();
    }
    ~Scratch() { host_.scratch -= bytes_; }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

  private:
    HostMemory& host_;
    uint64_t bytes_;
};

}  // namespace citystream::client
