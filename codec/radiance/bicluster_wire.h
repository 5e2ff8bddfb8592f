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

}  // namespace citystream::codec::radiance
