#include "codec/radiance/row_wire.h"

#include <cassert>

#include "codec/radiance/row_number_code.h"

namespace citystream::codec::radiance {

namespace {

template <typename Coder>
const char* code_rows(Coder& coder, const RadianceLimits& limits, DistinctRows& distinct, uint32_t local_count) {
    Transfer& rows = distinct.rows;
    uint32_t receivers = static_cast<uint32_t>(distinct.row_of.size()) / local_count;
    if (!code_matrix_size(coder, limits, local_count, receivers, rows.columns))
        return "rows of a matrix that cannot be";
    SparseRowCode row_code(rows.columns, local_count);
    RowNumberCode numbers(local_count);
    SparseRow row;
    uint32_t known = 0;
    uint64_t left = limits.entries;
    for (uint32_t j = 0; j < receivers * local_count; ++j) {
        if constexpr (Coder::kDecodes) {
            if (!coder.ok()) return "range coded bytes end too early";
            distinct.row_of.push_back(0);
        }
        uint32_t& number = distinct.row_of[j];
        number = numbers.code(coder, j % local_count, known, number);
        if (number > known) return "a row that is not there";
        if (number < known) continue;
        if constexpr (!Coder::kDecodes) row = row_of(rows, number);
        if (!row_code.code(coder, j % local_count, left, row)) return "a row that cannot be";
        left -= row.columns.size();
        if constexpr (Coder::kDecodes) append_row(rows, row);
        ++known;
    }
    return nullptr;
}

}  // namespace

std::vector<std::byte> encode_distinct_rows(const DistinctRows& distinct, uint32_t local_count) {
    assert(local_count >= 1 && distinct.row_of.size() % local_count == 0);
    DistinctRows copy = distinct;
    bits::RangeEncoder encoder;
    [[maybe_unused]] const char* wrong = code_rows(encoder, {kMostReceivers, ~uint64_t{0}}, copy, local_count);
    assert(wrong == nullptr);
    return encoder.finish();
}

Result<DistinctRows> decode_distinct_rows(std::span<const std::byte> bytes, const RadianceLimits& limits) {
    bits::RangeDecoder decoder(bytes);
    DistinctRows distinct{{1, {0}, {}, {}}, {}};
    if (const char* wrong = code_rows(decoder, limits, distinct, 1); wrong != nullptr)
        return Error{wrong, decoder.position()};
    if (const Status status = decoder.finish(); !status) return status.error();
    return distinct;
}

}  // namespace citystream::codec::radiance
