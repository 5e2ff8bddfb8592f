// The quotient map: distinct rows x distinct columns of the joint label matrix (quotient_parts.h), each texel row and
// column with the number of what it is. The form of fewest loads (3 a lookup, 4 where labels are in a table), and the
// one that no input makes larger than packed labels by more than a few per cent; words in quotient_layout.h and
// FORMAT.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/quotient_parts.h"
#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Exact, always succeeds, deterministic, O(cells). Cells hold the labels themselves where that costs hardly more than
/// indexes in a table of labels: at most 256 bytes or 1/64 of the map.
Result<std::vector<uint32_t>> encode_quotient_map(const RunGrid& grid);
std::vector<uint32_t> write_quotient_map(const QuotientParts& parts);

/// Whether every section lies inside, is what its neighbours say, and each index is in range: all that lookups and rays
/// rely on. O(words + distinct rows x columns).
Status check_quotient_map(std::span<const uint32_t> words);

/// Checks and reads. O(words).
Result<QuotientParts> read_quotient_map(std::span<const uint32_t> words);

/// Checks and decodes. Allocates 4 bytes a cell of the run grid, at most 256 MiB.
Result<RunGrid> decode_quotient_map(std::span<const uint32_t> words);

/// The label of a texel as the shader finds it; for checked words, x < width, y < height.
uint32_t quotient_label(std::span<const uint32_t> words, uint32_t x, uint32_t y);

}  // namespace citystream::codec::facade
