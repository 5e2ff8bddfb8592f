// How a tile's transfer matrix travels when not as visibility bits: as biclusters that were searched for before, or as
// rows. What comes out is the matrix that bits would give. FORMAT.md, "The matrix, instead of visibility".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "codec/radiance/bicluster_wire.h"
#include "codec/radiance/transfer.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// How a layer travels (radiance_layer.h). Each says by its first step which one it is.
enum class RadianceTransport : uint8_t {
    kVisibility,    ///< visibility_wire.h: three steps
    kBiclusters,    ///< bicluster_wire.h, of distinct rows; one step, as the others: decoded without a search
    kDistinctRows,  ///< row_wire.h
    kRows           ///< csr_wire.h
};
inline constexpr std::array<std::string_view, 4> kRadianceTransportNames = {"visibility", "biclusters", "distinct-rows",
                                                                            "rows"};
constexpr std::string_view name_of(RadianceTransport transport) {
    return kRadianceTransportNames[static_cast<size_t>(transport)];
}

/// What a reader knows of a matrix before it reads it.
struct MatrixBounds {
    uint32_t receivers = 0, local_count = 0;  ///< exactly
    uint64_t words = 0;  ///< that it may take in GPU memory (radiance_resident.h), whatever its form
};

/// Entries of distinct rows of so many columns that have room in the words: an entry takes more bits than its column's.
uint64_t most_entries(uint64_t words, uint32_t columns);

/// As any transport but kVisibility. Rows of the whole: fewer than 2^24, a multiple of `local_count` (1..1024).
/// Deterministic. Clusters are those of matrix_words.h; rows by themselves where a reader would take too long to add
/// them up (decode_matrix_rows), which no search is known to lead to.
std::vector<std::byte> encode_matrix(RadianceTransport transport, const DistinctRows& distinct, uint32_t local_count);

/// The distinct rows of a matrix that travelled as `transport`, any but kVisibility; of clusters their sum. Error:
/// bytes that are none; another shape than `bounds` has, or columns that are no cube's; more entries than have room;
/// entries that no receiver can have. Any bytes are safe. O(rows + nonzeros); of clusters 16 times as much at most.
/// Holds, besides what comes out, a row, or clusters that fit into the words.
Result<DistinctRows> decode_matrix_rows(RadianceTransport transport, std::span<const std::byte> bytes,
                                        const MatrixBounds& bounds);

/// The clusters of kBiclusters as they were sent. Nothing is known of what they add up to: with any bytes it may be
/// what no matrix has.
Result<ClusteredRows> decode_matrix_clusters(std::span<const std::byte> bytes, const MatrixBounds& bounds);

}  // namespace citystream::codec::radiance
