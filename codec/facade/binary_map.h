// The binary factor form of a facade map (binary_layout.h): the paper's binary factorization of D, M and A
// (sections 5.2 and 6, listing 1) by binary_factorization.h, with the listing's faults corrected (any number of terms,
// bit 31, the index of the bit).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/free_boxes.h"
#include "codec/facade/run_grid.h"
#include "codec/facade/singular_value_map.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Cells x words of X (D and M together): seconds to decode. Decoders refuse more, too.
inline constexpr uint64_t kMostBinaryWork = uint64_t{1} << 32;

enum class BinaryVariant {
    kPaper,   ///< a row of bits for every texel row and column, disjoint terms
    kShared,  ///< equal rows of bits once, a search ends at the first hit; terms in the order, disjoint or overlapping,
              ///< in which it ends sooner
};

/// Exact. Refuses what would not be smaller than the raw form, as soon as that is certain, and maps whose cells x words
/// of bits exceed kMostBinaryWork.
/// `most_times_raw`: how many raw maps it may be as large as (for comparisons of sizes).
Result<std::vector<uint32_t>> encode_binary_map(const RunGrid& grid, BinaryVariant variant = BinaryVariant::kPaper,
                                                uint32_t most_times_raw = 1);

/// What lookups rely on: sections inside the words, row indices and sigma in range, no bits of absent terms, boxes
/// inside the map. O(words).
Status check_binary_map(std::span<const uint32_t> words);

/// Checks and decodes; fails also where terms overlap that must not, and where values are out of range. O(distinct rows
/// x distinct columns x words of a row + words).
Result<RunGrid> decode_binary_map(std::span<const uint32_t> words);

/// Lookups as the shader does them, for checked words.
uint32_t binary_label(std::span<const uint32_t> words, uint32_t x, uint32_t y);
FreeBox binary_box(std::span<const uint32_t> words, uint32_t x, uint32_t y);

/// Terms of D, M and A.
FactorTerms binary_terms(std::span<const uint32_t> words);

}  // namespace citystream::codec::facade
