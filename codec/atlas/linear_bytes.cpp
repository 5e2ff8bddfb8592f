#include "codec/atlas/linear_bytes.h"

#include "codec/atlas/image.h"

namespace citystream::codec::atlas {

const LinearBytes& LinearBytes::tables() {
    static const LinearBytes all;
    return all;
}

LinearBytes::LinearBytes() {
    for (uint32_t k = 0; k < 256; ++k)
        linear_[k] = static_cast<uint32_t>(linear_of_srgb(static_cast<uint8_t>(k)) * kWhite + 0.5f);
    constexpr uint32_t kMost = 4 * kWhite;
    for (uint32_t k = 1; k < 256; ++k) {
        uint32_t below = threshold_[k - 1], at = kMost;
        while (at - below > 1) {
            const uint32_t middle = below + (at - below) / 2;
            (srgb_of_linear(static_cast<float>(middle) / kMost) >= k ? at : below) = middle;
        }
        threshold_[k] = at;
    }
    threshold_[256] = kMost + 1;
    uint32_t value = 0;
    for (uint32_t cell = 0; cell <= kCells; ++cell) {
        while (threshold_[value + 1] <= cell << kCellBits) ++value;
        first_[cell] = static_cast<uint8_t>(value);
    }
}

}  // namespace citystream::codec::atlas
