// How a build divides its memory limit among what it holds while it makes tiles.
#pragma once

#include <cstdint>

namespace citystream::tiles::layers {

struct MemoryPlan {
    uint64_t work = 0;     ///< bytes that threads hold while at a tile or a chart: of a MemoryGate
    uint64_t images = 0;   ///< of an ImageCache
    uint64_t facades = 0;  ///< of a FacadePainter
};

/// Divides what `limit` leaves beside the `resident` bytes that the process has taken already (its libraries, the index
/// of the city); at least a quarter of the limit. A fifth is left over for what no one counts: output buffers,
/// compressors, gaps between allocations.
MemoryPlan plan_memory(uint64_t limit, uint64_t resident);

/// Has the C library give large blocks back to the system when they are freed, of the whole program from here on. Else
/// it keeps them once it has seen a few, and gaps of tiles done add up.
void return_freed_memory();

/// Bytes of main memory that the process holds now; 0 where the system does not tell.
uint64_t resident_memory();

}  // namespace citystream::tiles::layers
