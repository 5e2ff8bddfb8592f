// The host budget as a ledger: what the streamer holds in main memory, by purpose.
#pragma once

#include <algorithm>
#include <cstdint>

namespace citystream::client {

struct HostMemory {
    uint64_t budget = 0;
    uint64_t fixed = 0;      ///< directory, facade index, what was learnt of tiles
    uint64_t wire = 0;       ///< wire bytes kept, with the entries that hold them
    uint64_t in_flight = 0;  ///< most that the requests under way can bring, with what is made of it
    uint64_t scratch = 0;    ///< decode buffers, while decoding

    uint64_t held() const { return fixed + wire + scratch; }
    uint64_t used() const { return held() + in_flight; }
    uint64_t free() const { return budget > used() ? budget - used() : 0; }

    /// Highest values since forget_peaks(), each at its own time.
    uint64_t peak = 0, peak_held = 0, peak_in_flight = 0;
    void note_peak() {
        peak = std::max(peak, used());
        peak_held = std::max(peak_held, held());
        peak_in_flight = std::max(peak_in_flight, in_flight);
    }
    void forget_peaks() {
        peak = peak_held = peak_in_flight = 0;
        note_peak();
    }
};

}  // namespace citystream::client
