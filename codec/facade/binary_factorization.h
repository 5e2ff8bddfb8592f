// The paper's binary factorization (section 5.2, equations 7 and 8) of a matrix of non-negative integers:
// D = sum over terms of sigma x y^T, x and y vectors of bits.
//
// Rank-one: sigma is the residual's maximum; of the bipartite graph of the entries equal to it, a clique is grown
// greedily: the row with most neighbours, then always the row with most neighbours among the columns left, which shrink
// to its neighbours; of the cliques on the way the largest is the term. Subtract, repeat, until nothing is left.
//
// Only entries equal to the residual's maximum are covered, so the residual there becomes 0 and all else stays: terms
// never overlap, and each value can be taken on its own, from the greatest down. On distinct rows and columns with
// multiplicities the same cliques come out as on texels (equal rows follow each other at once and do not shrink the
// columns). Among equals the first row, the first clique.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/facade/distinct_matrix.h"
#include "codec/result.h"

namespace citystream::codec::facade {

struct BinaryTerm {
    uint32_t value = 0;                   ///< of the entries that it covers: base + sigma
    std::vector<uint32_t> rows, columns;  ///< distinct rows and columns whose bit is set, rising
    uint64_t texels = 0;                  ///< that no term before covers
};

struct BinaryFactors {
    uint32_t base = 0;  ///< value of the entries that no term covers
    std::vector<BinaryTerm> terms;
};

/// Steps of innermost loops (a few seconds) after which a factorization gives up: facades need a thousandth.
inline constexpr uint64_t kMostFactorWork = uint64_t{1} << 32;

/// The paper's terms of the matrix less its least entry (the base), in the paper's order. Fails as soon as more than
/// `most_terms` or more than kMostFactorWork are needed. A term costs O(entries of its value + rows x cliques on the
/// way).
Result<BinaryFactors> factor_binary(const DistinctMatrix& matrix, uint64_t most_terms);

/// Terms of which the first that covers an entry counts: 1.5 to 4 times fewer. The base is the value of most texels;
/// the other values are taken from the rarest to the most frequent, and what is covered already (all entries of rarer
/// values, too) is a wild card: a clique may hold it, but only entries that get their value count for its size.
Result<BinaryFactors> factor_binary_first_match(const DistinctMatrix& matrix, uint64_t most_terms);

/// Puts disjoint terms in the order of the texels that they cover, most first, so that a search for the hit ends early.
void put_large_terms_first(BinaryFactors& factors);

/// Words of X and Y that a search for the hit reads, 32 terms each, mean over all texels.
double mean_words_searched(const DistinctMatrix& matrix, const BinaryFactors& factors);

}  // namespace citystream::codec::facade
