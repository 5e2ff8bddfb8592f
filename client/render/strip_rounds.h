// A model of many meshes drawn from strip streams with little memory for decoded corners (Meyer 2012, section 5.7; the
// notes' T11): rounds of meshes are decoded, drawn and forgotten. Two rounds are in memory at a time, so that the
// device may decode the next one while it draws one.
#pragma once

#include <functional>

#include "client/render/strip_decoder.h"

namespace citystream::client {

/// Consecutive streams that are decoded together.
struct StripRound {
    size_t first = 0, count = 0;  ///< streams
    StripPlan plan;               ///< plan.corners_at[i] is of stream first + i
    uint64_t records_offset = 0;  ///< bytes, in the buffer of all rounds' records
};

struct StripRounds {
    std::vector<StripRound> rounds;
    uint64_t half_bytes = 0;     ///< of each of the two rounds in memory
    uint64_t records_bytes = 0;  ///< of all
};

/// Fills rounds of `memory_bytes` / 2, in the order of the streams. Fails where a mesh alone does not fit one.
Result<StripRounds> plan_strip_rounds(const StripDecoder& decoder, std::span<const StripStream> streams,
                                      uint64_t memory_bytes);

/// Copies all records to mapped memory of records_bytes bytes.
void write_records(const StripRounds& rounds, void* to);

/// Draws one round whose corners, three 32-bit indices a triangle, begin at `corners`: with render passes of its own,
/// and all reads of the corners as indices.
using DrawStripRound = std::function<void(VkCommandBuffer, const StripRound&, const BufferRange& corners)>;

/// `memory`: of 2 * half_bytes bytes; `records`: what write_records wrote. What used the memory before must be done;
/// before it is used again, the last two rounds' draws must be.
void record_strip_rounds(VkCommandBuffer commands, const StripDecoder& decoder, const StripRounds& rounds,
                         const Buffer& memory, const Buffer& records, const DrawStripRound& draw);

}  // namespace citystream::client
