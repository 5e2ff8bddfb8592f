// A transfer matrix row by row on the wire, as it is: what biclusters and bits are compared with. FORMAT.md, "Rows".
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "codec/radiance/sparse_row_code.h"
#include "codec/radiance/transfer.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// `local_count`: M (1..1024), of which the rows are a multiple; rows below 2^24. Deterministic. O(nonzeros).
std::vector<std::byte> encode_rows(const Transfer& transfer, uint32_t local_count);

/// The same of a whole of which distinct rows are known.
std::vector<std::byte> encode_rows(const DistinctRows& distinct, uint32_t local_count);

/// What encode_rows wrote, or an error: any bytes are safe. No more entries than limits.entries.
Result<Transfer> decode_rows(std::span<const std::byte> bytes, const RadianceLimits& limits);

/// The same row by row: `visit(row)` is called for each, in order, until it returns false or something is wrong with
/// the bytes. Holds one row.
using RowVisit = std::function<bool(const SparseRow& row)>;
Result<MatrixShape> visit_rows(std::span<const std::byte> bytes, const RadianceLimits& limits, const RowVisit& visit);

}  // namespace citystream::codec::radiance
