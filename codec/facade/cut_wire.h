// How most patch maps travel: as their distinct rows x distinct columns (quotient_wire.h) and the cuts that make bands
// and stripes of them, a decision for each break. All else follows: within a stripe the patch has the breaks that it
// needs. Smaller than the pools (patch_wire.h) because what is equal in the whole facade is said once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/facade/patch_structure.h"
#include "codec/facade/quotient_parts.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Where a patch map cuts its facade: texels across the bands, and for each band texels along it; 0 but not the end.
struct PatchCuts {
    bool transposed = false;
    std::vector<uint32_t> bands;
    std::vector<std::vector<uint32_t>> stripes;
};

struct CutMap {
    QuotientParts parts;
    PatchCuts cuts;
};

/// What checked patch words are made of, when making them of that again gives the same words.
std::optional<CutMap> cut_map_of(std::span<const uint32_t> words);

void put_cut_wire(const CutMap& map, bits::RangeEncoder& encoder);

/// The words again, of all the decoder's bytes. For untrusted bytes: an error, also when some are left over, or words
/// of some structure (but check_patch_map before use). Takes run grids of at most most_cut_cells(resident_bytes) cells,
/// and 20 bytes of memory for each that the bytes really hold.
Result<std::vector<uint32_t>> get_cut_wire(bits::RangeDecoder& decoder, size_t resident_bytes);

/// Grids with more cells travel as pools.
constexpr uint64_t most_cut_cells(size_t resident_bytes) {
    return (uint64_t{1} << 14) + 256 * uint64_t{resident_bytes};
}

}  // namespace citystream::codec::facade
