// A transfer matrix on the wire with equal rows told once. FORMAT.md, "Distinct rows".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/sparse_row_code.h"
#include "codec/radiance/transfer.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// `local_count`: M (1..1024), of which the rows of the whole are a multiple; below 2^24. `distinct` is what
/// distinct_rows() makes: rows in the order of first use. Deterministic. O(nonzeros + rows).
std::vector<std::byte> encode_distinct_rows(const DistinctRows& distinct, uint32_t local_count);

/// What encode_distinct_rows wrote, or an error: any bytes are safe. No more entries than limits.entries.
Result<DistinctRows> decode_distinct_rows(std::span<const std::byte> bytes, const RadianceLimits& limits);

}  // namespace citystream::codec::radiance
