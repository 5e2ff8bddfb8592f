// Rows of the transfer matrix by clustered principal components (Sloan, Hall, Hart and Snyder, Clustered Principal
// Components for Precomputed Radiance Transfer, 2003, section 4.2: iterative PCA), applied to rows of T as Sun et al.
// 2011, section 7, does with 32 clusters of 8 vectors.
#pragma once

#include "tests/bench/irradiance_model.h"

namespace citystream::bench {

/// A row is its cluster's mean and weights of the cluster's vectors, 16-bit floats. Rows that are equal are kept once.
/// Clusters begin with rows spread evenly; then rows go to the cluster that comes nearest and the clusters' means and
/// vectors are found anew (subspace iteration), a fixed number of times. Deterministic.
IrradianceModel clustered_components(const RadianceSample& sample, uint32_t local_side, uint32_t clusters,
                                     uint32_t vectors);

}  // namespace citystream::bench
