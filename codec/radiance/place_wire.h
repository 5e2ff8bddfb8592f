// Where a tile's receivers are, on the wire: one message of the range coder. FORMAT.md, "Places".
//
// Rows of a class are told by the row before them: walls stand upright and ground goes on, so most of a row's receivers
// are those of the row before, moved along their planes. Depths are kept as the receiver table keeps them, in 64ths of
// the spacing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/receiver_table.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// Depths of places are within this, grid units.
inline constexpr int32_t kMostDepth = 1 << 30;

/// Depth in 64ths of the spacing as grid units, nearest, of equals the greater. |depth| <= kMostDepth. `spacing_log2`:
/// RECEIVER_LEAST_SPACING..RECEIVER_MOST_SPACING, as in all that follows.
int32_t rounded_depth(int32_t depth, uint32_t spacing_log2);

/// Places that write_receiver_table takes, with depths within kMostDepth, which are rounded. Deterministic. O(places).
std::vector<std::byte> encode_places(std::span<const ReceiverPlace> places, uint32_t spacing_log2);

/// What encode_places wrote, or an error: any bytes are safe. Places come out sorted, at most `most` of them, with
/// classes and columns in range.
Result<std::vector<ReceiverPlace>> decode_places(std::span<const std::byte> bytes, uint32_t spacing_log2,
                                                 uint32_t most);

}  // namespace citystream::codec::radiance
