// Biclusters on the wire: one message of the range coder. FORMAT.md, "Biclusters".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/biclusters.h"
#include "codec/radiance/sparse_row_code.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// `local_count`: M (1..1024), of which the matrix's rows are a multiple; rows below 2^24, at most 2^16 columns.
/// Clusters are in the order of their first rows (sort_by_first_row). Deterministic. O(rows and columns of clusters).
std::vector<std::byte> encode_biclusters(const Biclusters& clusters, uint32_t local_count);

struct DecodedBiclusters {
    Biclusters clusters;
    uint32_t local_count = 0;
};

/// What encode_biclusters wrote, or an error: any bytes are safe. Rows and columns come out rising and in range, values
/// not 0, no cluster empty. Holds no more than limits.entries rows and columns of clusters.
Result<DecodedBiclusters> decode_biclusters(std::span<const std::byte> bytes, const RadianceLimits& limits);

/// A matrix as clusters of its distinct rows.
struct ClusteredRows {
    Biclusters clusters;           ///< of distinct rows, which are in the order of first use
    std::vector<uint32_t> row_of;  ///< of each row of the whole
};

/// `local_count`: M (1..1024), of which the rows of the whole are a multiple; below 2^24. Every distinct row is some
/// row of the whole. Deterministic. O(rows + rows and columns of clusters).
std::vector<std::byte> encode_clustered_rows(const ClusteredRows& rows, uint32_t local_count);

/// What encode_clustered_rows wrote, or an error: any bytes are safe; as decode_biclusters. `most_bits`: that rows and
/// columns of clusters may take in GPU memory (radiance_resident.h), a row at least one.
Result<ClusteredRows> decode_clustered_rows(std::span<const std::byte> bytes, uint32_t most_receivers,
                                            uint64_t most_bits);

}  // namespace citystream::codec::radiance
