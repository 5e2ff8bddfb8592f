// A tile's matrix as words in GPU memory (radiance_resident.h), made of its distinct rows: exactly, or within an error.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "codec/radiance/biclusters.h"
#include "codec/radiance/transfer.h"

namespace citystream::codec::radiance {

/// How the matrix is kept in GPU memory.
enum class MatrixForm : uint8_t {
    kBiclusters,  ///< of distinct rows; where they take more words than the rows, the rows
    kRows,        ///< distinct rows, each a cluster of its own
};

/// What a matrix may be.
struct MatrixOptions {
    MatrixOptions(MatrixForm of = MatrixForm::kBiclusters, double error = 0,
                  const std::atomic<bool>* stopped_by = nullptr)
        : form(of), row_error(error), stop(stopped_by) {}
    MatrixForm form;
    /// Relative radiance, 0..1: the part of what a local direction gets from an even sky, nothing standing around it,
    /// by which each row may be too low under a sky nowhere brighter (near_rows.h has the bound for any light). Rows
    /// are never too high. The greater, the fewer words; 0: exact.
    double row_error;
    /// Once it is set (codec/stop.h) no words are made. Looked at between clusters of the search.
    const std::atomic<bool>* stop;
};
/// What it has left out.
struct MatrixLoss {
    double row_error = 0;   ///< of the worst row: at most what the options allow
    uint64_t quarters = 0;  ///< of distinct rows
};

/// No words: there are more rows than words can hold, or the options' `stop` is set. `loss`: filled where there is one.
/// Deterministic. Biclusters take a search (bicluster.h), rows none.
std::vector<uint32_t> make_matrix_words(DistinctRows distinct, uint32_t local_count, const MatrixOptions& options,
                                        MatrixLoss* loss = nullptr);

/// The exact clusters that make_matrix_words holds of kBiclusters: those of the search, or each row by itself where
/// that takes fewer words. So a reader that gets them need not compare.
Biclusters clusters_of_words(const DistinctRows& distinct, uint32_t local_count);

}  // namespace citystream::codec::radiance
