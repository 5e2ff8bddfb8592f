// How quotient and tiled maps travel: distinct rows x distinct columns (quotient_parts.h) as binary decisions with
// contexts for the adaptive range coder. The words follow from the parts. FORMAT.md has the order of the decisions.
#pragma once

#include <cstddef>
#include <cstdint>

#include "codec/bits/range_coder.h"
#include "codec/facade/quotient_parts.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// O(cells x rows tried as a model for each row, at most 64).
void put_quotient_wire(const QuotientParts& parts, bits::RangeEncoder& encoder);

/// What bounds a quotient whose words have been promised to take a number of bytes.
struct QuotientLimits {
    uint64_t class_cells = 0;  ///< distinct rows x columns
    uint64_t run_cells = 0;    ///< rows x columns of the run grid
};

/// The parts again. For untrusted bytes: valid parts within the limits, or an error; O(cells read). The caller checks
/// that the decoder has read all its bytes.
Result<QuotientParts> get_quotient_wire(bits::RangeDecoder& decoder, const QuotientLimits& limits);

}  // namespace citystream::codec::facade
