#include "codec/radiance/csr_wire.h"

#include <cassert>

namespace citystream::codec::radiance {

namespace {

/// `row(j)`: row j of the whole.
template <typename Row>
std::vector<std::byte> encode(MatrixShape shape, const Row& row) {
    bits::RangeEncoder encoder;
    [[maybe_unused]] const bool can_be =
        code_matrix_size(encoder, {kMostReceivers, ~uint64_t{0}}, shape.local_count, shape.receivers, shape.columns);
    assert(can_be);
    SparseRowCode row_code(shape.columns, shape.local_count);
    for (uint32_t j = 0; j < shape.rows(); ++j) {
        SparseRow entries = row(j);
        row_code.code(encoder, j % shape.local_count, ~uint64_t{0}, entries);
    }
    return encoder.finish();
}

}  // namespace

std::vector<std::byte> encode_rows(const Transfer& transfer, uint32_t local_count) {
    assert(local_count >= 1 && transfer.rows() % local_count == 0);
    return encode({local_count, transfer.rows() / local_count, transfer.columns},
                  [&](uint32_t j) { return row_of(transfer, j); });
}

std::vector<std::byte> encode_rows(const DistinctRows& distinct, uint32_t local_count) {
    assert(local_count >= 1 && distinct.row_of.size() % local_count == 0);
    return encode({local_count, static_cast<uint32_t>(distinct.row_of.size()) / local_count, distinct.rows.columns},
                  [&](uint32_t j) { return row_of(distinct.rows, distinct.row_of[j]); });
}

Result<MatrixShape> visit_rows(std::span<const std::byte> bytes, const RadianceLimits& limits, const RowVisit& visit) {
    bits::RangeDecoder decoder(bytes);
    MatrixShape shape{1, 0, 1};
    if (!code_matrix_size(decoder, limits, shape.local_count, shape.receivers, shape.columns))
        return Error{"rows of a matrix that cannot be", decoder.position()};
    SparseRowCode row_code(shape.columns, shape.local_count);
    SparseRow row;
    uint64_t left = limits.entries;
    for (uint32_t j = 0; j < shape.rows(); ++j) {
        if (!row_code.code(decoder, j % shape.local_count, left, row))
            return Error{"a row that cannot be", decoder.position()};
        if (!decoder.ok()) return Error{"range coded bytes end too early", decoder.position()};
        left -= row.columns.size();
        if (!visit(row)) return shape;
    }
    if (const Status status = decoder.finish(); !status) return status.error();
    return shape;
}

Result<Transfer> decode_rows(std::span<const std::byte> bytes, const RadianceLimits& limits) {
    Transfer transfer{1, {0}, {}, {}};
    const auto shape = visit_rows(bytes, limits, [&](const SparseRow& row) {
        append_row(transfer, row);
        return true;
    });
    if (!shape) return shape.error();
    transfer.columns = shape->columns;
    return transfer;
}

}  // namespace citystream::codec::radiance
