// Which distinct row each row of a matrix is, by the range coder: the part that row_wire.h and bicluster_wire.h share.
// Written once for both directions (codec/bits/range_coder.h).
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "codec/bits/range_coder.h"

namespace citystream::codec::radiance {

/// Which distinct row each row is: that of the receiver before, a new one, or any of those known.
class RowNumberCode {
  public:
    explicit RowNumberCode(uint32_t local_count) : last_(local_count, 0), last_kind_(local_count, 0) {}

    /// Codes the next row's number, 0..known: `known` is that of a new one. What is read may be more: none that can be.
    template <typename Coder>
    uint32_t code(Coder& coder, uint32_t local, uint32_t known, uint32_t told) {
        uint8_t& kind = last_kind_[local];
        const uint32_t neighbour = local == 0 ? 0u : last_kind_[local - 1];
        if (coder.bit(same_[kind][neighbour], told == last_[local] ? 1 : 0) != 0) {
            kind = 0;
        } else if (coder.bit(new_[kind][neighbour], told == known ? 1 : 0) != 0) {
            kind = 1;
            last_[local] = known;
        } else {
            kind = 2;
            last_[local] = coder.plain_bits(static_cast<uint32_t>(std::bit_width(known)), told);
        }
        return last_[local];
    }

  private:
    static constexpr uint32_t kKinds = 3;
    std::vector<uint32_t> last_;  ///< of each local direction
    std::vector<uint8_t> last_kind_;
    bits::BitModel same_[kKinds][kKinds], new_[kKinds][kKinds];
};

}  // namespace citystream::codec::radiance
