// What a tile's transfer takes in each of its forms: the honest table of storage and work.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "codec/radiance/bicluster.h"
#include "codec/radiance/visibility_bits.h"

namespace citystream::codec::radiance {

struct RepresentationSize {
    std::string_view name;
    uint64_t memory_bytes = 0;  ///< as it is multiplied at run time
    uint64_t wire_bytes = 0;    ///< 0: it does not travel
    uint64_t flops = 0;         ///< of one channel and one change of light
};

/// In this order:
///   dense        every entry, a byte each (what the paper calls raw); 2 FLOPs an entry
///   csr          3 bytes an entry (16-bit column, 8-bit value), 4 a row; csr_wire.h
///   rowdedupe    the same of distinct rows, and 4 bytes a row; row_wire.h
///   paper        biclusters of all rows, 4 (r + 2l) bytes each as the paper's sizes imply; bicluster_wire.h
///   bicluster    biclusters of distinct rows as radiance_resident.h keeps them; does not travel by itself
///   bits         visibility bits and a 16-bit local direction for each sample of each frame; an addition a sample that
///                is seen; visibility_wire.h and the frames' codes
/// Takes as long as two to four searches (bicluster.h).
std::vector<RepresentationSize> representation_sizes(const VisibilityTile& tile, const LocalDirections& local,
                                                     BiclusterGoal goal, uint64_t random_seed = 1);

}  // namespace citystream::codec::radiance
