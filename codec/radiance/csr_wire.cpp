#include "codec/radiance/csr_wire.h"

#include <cassert>

namespace citystream::codec::radiance {

namespace {

template <typename Coder>
const char* code_rows(Coder& coder, const RadianceLimits& limits, Transfer& transfer, uint32_t local_count) {
    uint32_t receivers = Coder::kDecodes ? 0 : transfer.rows() / local_count;
    if (!code_matrix_size(coder, limits, local_count, receivers, transfer.columns))
        return "rows of a matrix that cannot be";
    SparseRowCode row_code(transfer.columns, local_count);
    SparseRow row;
    for (uint32_t j = 0; j < receivers * local_count; ++j) {
        if constexpr (!Coder::kDecodes) row = row_of(transfer, j);
        if (!row_code.code(coder, j % local_count, limits.entries - (Coder::kDecodes ? transfer.nonzeros() : 0), row))
            return "a row that cannot be";
        if constexpr (Coder::kDecodes) {
            if (!coder.ok()) return "range coded bytes end too early";
            append_row(transfer, row);
        }
    }
    return nullptr;
}

}  // namespace

std::vector<std::byte> encode_rows(const Transfer& transfer, uint32_t local_count) {
    assert(local_count >= 1 && transfer.rows() % local_count == 0);
    Transfer copy = transfer;
    bits::RangeEncoder encoder;
    [[maybe_unused]] const char* wrong = code_rows(encoder, {kMostReceivers, ~uint64_t{0}}, copy, local_count);
    assert(wrong == nullptr);
    return encoder.finish();
}

Result<Transfer> decode_rows(std::span<const std::byte> bytes, const RadianceLimits& limits) {
    bits::RangeDecoder decoder(bytes);
    Transfer transfer{1, {0}, {}, {}};
    if (const char* wrong = code_rows(decoder, limits, transfer, 1); wrong != nullptr)
        return Error{wrong, decoder.position()};
    if (const Status status = decoder.finish(); !status) return status.error();
    return transfer;
}

}  // namespace citystream::codec::radiance
