// The host budget as a ledger: what the streamer holds in main memory, by purpose.
#pragma once

#include <algorithm>
#include <cstdint>

namespace citystream::client {

struct HostMemory {
    uint64_t budget = 0;
    uint64_t fixed = 0;      ///< directory, facade index, what was learnt of tiles
    uint64_t wire = 0;       ///< wire bytes kept, with the entries that hold them
    uint64_t in_flight = 0;  ///< lengths of the requests under way
    uint64_t scratch = 0;    ///< decode buffers, while decoding
    uint64_t peak = 0;       ///< of used(), since the owner reset it

    uint64_t used() const { return fixed + wire + in_flight + scratch; }
    uint64_t free() const { return budget > used() ? budget - used() : 0; }
    void note_peak() { peak = std::max(peak, used()); }
};

}  // namespace citystream::client
