// The lower bits of prisms that have travelled without them (encode_prisms with dropped > 0).
//
// All coordinates of the prisms get `bits` more bits below those known. What an edge is off its building's directions
// is expected from the points already refined (footprint_frame.h), and the last point of a ring where it meets the
// start at a right angle; the length of an edge has to be told bit by bit. Heights that were equal mostly stay equal.
// So a plane costs about half of its bits. One step without planes is smaller: it need not tell less likely things
// first, and it knows of the lattice that coordinates come from (hidden_lattice.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/mesh/hidden_lattice.h"
#include "codec/mesh/prisms.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

/// `told` is what encode_prisms returned: all bits; `lattices` those of its tree. Writes of each coordinate the `bits`
/// bits above the lowest `dropped`; the ones above these are known. bits 1..30.
void encode_prism_planes(bits::RangeEncoder& encoder, std::span<const Prism> told,
                         std::span<const HiddenLattice> lattices, uint32_t bits, uint32_t dropped);

/// Gives `prisms`, which lack the bits, these bits. Error: a coordinate would leave the grid, or the bytes have run
/// out; the prisms are then of no use. Untrusted bytes give any coordinates; base <= top holds as it did.
Status decode_prism_planes(bits::RangeDecoder& decoder, std::vector<Prism>& prisms, uint32_t bits);

}  // namespace citystream::codec::mesh
