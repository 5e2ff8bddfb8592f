// Singular value decomposition of a matrix of integers into float32 factors from which a shader gets its entries back
// by rounding: paper, section 5.1, equations 4-6.
//
// The decomposition is that of the whole matrix of texels, computed on its distinct rows and columns weighted by their
// multiplicities: B = sqrt(row weights) D sqrt(column weights) has the same singular values. They come from the
// eigenvalues of the smaller of B B^T and B^T B (in double: what that squaring costs in precision is far below the
// rounding of the entries).
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "codec/facade/distinct_matrix.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Entry (i, j) = least + round(sum over k < terms of x[i * terms + k] * y[j * terms + k]); x holds the singular
/// values.
struct SingularValueFactors {
    uint32_t least = 0;
    uint32_t terms = 0;
    std::vector<float> x, y;  ///< of the distinct rows, of the distinct columns
};

/// More distinct rows and columns than this (of the fewer of the two) would take minutes.
inline constexpr uint32_t kMostSingularValues = 1536;

/// How far from its integer an entry may come out before it is rounded.
inline constexpr float kMostRoundingError = 0.4F;

/// With the least number of terms for which the sum in float32 in order of the terms, multiplied and added separately
/// or fused, is less than kMostRoundingError from every entry and rounds to it. Fails, saying why, when that takes more
/// than `most_terms` (told by the singular values alone where they already rule it out) or too long. `what` is for the
/// error. O(n^2 (m + n) + m n terms) for m x n distinct rows and columns, n the fewer.
Result<SingularValueFactors> factor_singular_values(const DistinctMatrix& matrix, uint64_t most_terms,
                                                    std::string_view what);

/// With the `rank` greatest singular values (or all), whatever the error.
Result<SingularValueFactors> factor_rank(const DistinctMatrix& matrix, uint64_t rank, std::string_view what);

/// The entry that a sum stands for, as the shader computes it.
int32_t rounded_entry(int32_t least, float sum);

}  // namespace citystream::codec::facade
