// How a patch map travels: the pools of its structure (patch_structure.h) as binary decisions with contexts for the
// adaptive range coder. Positions are coded by the cuts known from below, contents by what stands below and beside,
// window columns and cells by mirroring; first probabilities come from measured facades (patch_wire_model.h) and are
// part of the format. FORMAT.md has the order of the decisions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Precondition: words that check_patch_map accepts. Linear.
void put_patch_wire(std::span<const uint32_t> words, bits::RangeEncoder& encoder);

/// The words again. For untrusted bytes: the words are those of some structure (but check_patch_map before use), or an
/// error; the work and memory are bounded by a small multiple of `resident_bytes`. The caller checks that the decoder
/// has read all its bytes.
Result<std::vector<uint32_t>> get_patch_wire(bits::RangeDecoder& decoder, size_t resident_bytes);

}  // namespace citystream::codec::facade
