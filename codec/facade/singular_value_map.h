// The singular value form of a facade map (svd_layout.h): the paper's floating-point factorization of D, M and A
// (section 5.1, equations 4-6), X holding the singular values too.
//
// How many are kept: the least p for which the entry that the shader computes in float32 (adding up in order of the
// singular values, rounding at the end) differs by less than kMostRoundingError from the integer that it stands for, at
// every entry, both with and without fused multiply-add: so that what order and rounding of one device differ from
// another's cannot reach the 0.5 that would change an entry.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/free_boxes.h"
#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Exact. Refuses what would not be smaller than the raw form, and what has so many distinct rows and columns that its
/// singular values would take minutes.
Result<std::vector<uint32_t>> encode_singular_value_map(const RunGrid& grid);
/// The same as large as `most_times_raw` raw maps (for comparisons of sizes).
Result<std::vector<uint32_t>> encode_singular_value_map(const RunGrid& grid, uint32_t most_times_raw);

/// What a lossy map costs: displacement decoded against given, over all texels.
struct DisplacementError {
    double greatest_mm = 0, root_mean_square_mm = 0;
};
struct LossySingularValueMap {
    std::vector<uint32_t> words;
    DisplacementError error;
};
/// D by its `rank` first singular values, rounded to millimetres; M and A exact, A of the D given (so that boxes are
/// free up to the error). Fails on open cells (their depth is no length), where the exact encoder fails for M or A, and
/// on rank 0.
Result<LossySingularValueMap> encode_lossy_singular_value_map(const RunGrid& grid, uint32_t rank);

/// What lookups rely on: sections inside the words, floats in range, boxes inside the map. O(words).
Status check_singular_value_map(std::span<const uint32_t> words);

/// Checks and decodes; fails also where displacements or materials are out of range. O(texels x terms) on the distinct
/// rows and columns.
Result<RunGrid> decode_singular_value_map(std::span<const uint32_t> words);

/// Lookups as the shader does them, for checked words.
uint32_t singular_value_label(std::span<const uint32_t> words, uint32_t x, uint32_t y);
FreeBox singular_value_box(std::span<const uint32_t> words, uint32_t x, uint32_t y);

/// Cells x terms (D and M together) that the decoder takes on: seconds. Encoders refuse more, too.
inline constexpr uint64_t kMostSingularValueWork = uint64_t{1} << 32;

/// Singular values kept for D, M and A.
struct FactorTerms {
    uint32_t displacement = 0, material = 0, box_index = 0;
};
FactorTerms singular_value_terms(std::span<const uint32_t> words);

}  // namespace citystream::codec::facade
