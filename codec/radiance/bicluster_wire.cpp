#include "codec/radiance/bicluster_wire.h"

#include <cassert>

namespace citystream::codec::radiance {

namespace {

/// The rows of a cluster as receivers and local directions: most go on with the same direction at the next receiver.
class RowListCode {
  public:
    explicit RowListCode(uint32_t local_count) : local_count_(local_count), local_(local_count) {}

    /// Codes the first row after that of the cluster before.
    template <typename Coder>
    uint64_t first(Coder& coder, uint64_t before, uint64_t row) {
        const auto told = static_cast<uint32_t>(row / local_count_ - before / local_count_);
        const uint64_t receiver = before / local_count_ + first_.code(coder, told);
        return receiver * local_count_ + local_.code(coder, static_cast<uint32_t>(row % local_count_));
    }

    /// Codes a further row.
    template <typename Coder>
    uint64_t next(Coder& coder, uint64_t before, uint64_t row) {
        const auto told = static_cast<uint32_t>(row / local_count_ - before / local_count_);
        const uint32_t step = step_[last_step_].code(coder, told);
        last_step_ = step < kSteps ? step : kSteps - 1;
        const uint64_t receiver = before / local_count_ + step;
        if (step == 0) return before + 1 + within_.code(coder, static_cast<uint32_t>(row - before - 1));
        const uint32_t last = static_cast<uint32_t>(before % local_count_),
                       local = static_cast<uint32_t>(row % local_count_);
        last_same_ = coder.bit(same_[last_same_], local == last ? 1 : 0);
        return receiver * local_count_ + (last_same_ != 0 ? last : local_.code(coder, local));
    }

  private:
    static constexpr uint32_t kSteps = 4;
    uint32_t local_count_, last_step_ = 1, last_same_ = 1;
    bits::NumberModel first_, within_, step_[kSteps];
    bits::BitModel same_[2];
    bits::BitTree local_;
};

struct Message {
    Biclusters clusters;
    uint32_t local_count = 0;
};

/// Null where all is well.
template <typename Coder>
const char* code_message(Coder& coder, const RadianceLimits& limits, Message& message) {
    Biclusters& c = message.clusters;
    uint32_t receivers = Coder::kDecodes ? 0 : c.rows / message.local_count;
    if (!code_matrix_size(coder, limits, message.local_count, receivers, c.columns))
        return "biclusters of a matrix that cannot be";
    c.rows = receivers * message.local_count;
    bits::NumberModel number, row_count;
    const uint32_t count = number.code(coder, c.count());
    if (count > limits.entries / 2) return "more biclusters than there may be";
    uint64_t left = limits.entries;
    RowListCode row_list(message.local_count);
    SparseRowCode row_code(c.columns, message.local_count);
    uint64_t first = 0;
    std::vector<uint32_t> rows;
    SparseRow entries;
    for (uint32_t i = 0; i < count; ++i) {
        if constexpr (!Coder::kDecodes) {
            rows.assign(c.rows_of(i).begin(), c.rows_of(i).end());
            entries.columns.assign(c.columns_of(i).begin(), c.columns_of(i).end());
            entries.values.assign(c.values_of(i).begin(), c.values_of(i).end());
        }
        const uint64_t r = uint64_t{row_count.code(coder, static_cast<uint32_t>(rows.size()) - 1)} + 1;
        if (r > left || r > c.rows) return "a bicluster with more rows than there may be";
        if constexpr (Coder::kDecodes) rows.resize(r);
        left -= r;
        for (size_t m = 0; m < r; ++m) {
            const uint64_t row =
                m == 0 ? row_list.first(coder, first, rows[0]) : row_list.next(coder, rows[m - 1], rows[m]);
            if (row >= c.rows) return "a bicluster with a row that is not there";
            rows[m] = static_cast<uint32_t>(row);
        }
        first = rows[0];
        if (!row_code.code(coder, rows[0] % message.local_count, left, entries) || entries.columns.empty())
            return "a bicluster with columns that are not there";
        left -= entries.columns.size();
        if constexpr (Coder::kDecodes) {
            if (!coder.ok()) return "range coded bytes end too early";
            c.add(rows, entries.columns, entries.values);
        }
    }
    return nullptr;
}

}  // namespace

std::vector<std::byte> encode_biclusters(const Biclusters& clusters, uint32_t local_count) {
    assert(local_count >= 1 && clusters.rows % local_count == 0 && clusters.columns >= 1);
    Message message{clusters, local_count};
    bits::RangeEncoder encoder;
    [[maybe_unused]] const char* wrong = code_message(encoder, {kMostReceivers, ~uint64_t{0}}, message);
    assert(wrong == nullptr);
    return encoder.finish();
}

Result<DecodedBiclusters> decode_biclusters(std::span<const std::byte> bytes, const RadianceLimits& limits) {
    bits::RangeDecoder decoder(bytes);
    Message message;
    if (const char* wrong = code_message(decoder, limits, message); wrong != nullptr)
        return Error{wrong, decoder.position()};
    if (const Status status = decoder.finish(); !status) return status.error();
    return DecodedBiclusters{std::move(message.clusters), message.local_count};
}

}  // namespace citystream::codec::radiance
