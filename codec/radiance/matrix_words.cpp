#include "codec/radiance/matrix_words.h"

#include <algorithm>
#include <span>

#include "codec/radiance/bicluster.h"
#include "codec/radiance/near_rows.h"
#include "codec/radiance/radiance_resident.h"
#include "codec/stop.h"

namespace citystream::codec::radiance {

namespace {

/// Clusters that grow from entries take the fewest sums and the shortest search, measured on city tiles.
constexpr BiclusterOptions kLayerSearch{.seeding = Seeding::kEntry};

/// Rows of which groups are one, and what each may still lose.
struct LossyRows {
    RowBound bound;
    NearRows near;
    std::vector<uint32_t> budgets;
};

LossyRows lossy_rows(const DistinctRows& distinct, uint32_t local_count, double row_error) {
    LossyRows rows;
    rows.bound = row_bound(texels_across_of(distinct.rows.columns), local_count, row_error);
    rows.near = merge_near_rows(distinct, local_count, rows.bound);
    for (const uint32_t missed : rows.near.missed) rows.budgets.push_back(rows.bound.most - missed);
    return rows;
}

/// `held`: none where rows are held as they are.
MatrixLoss loss_of(const LossyRows& rows, const Biclusters& held) {
    const Transfer& transfer = rows.near.distinct.rows;
    std::vector<uint32_t> units = rows.near.missed;
    uint64_t quarters = rows.near.quarters;
    if (held.count() > 0) {
        const std::vector<uint32_t> more = row_errors(transfer, held, rows.bound.weights);
        for (size_t j = 0; j < units.size(); ++j) units[j] += more[j];
        for (const uint32_t q : row_errors(transfer, held)) quarters += q;
    }
    return {units.empty() ? 0 : *std::max_element(units.begin(), units.end()) * rows.bound.unit, quarters};
}

std::vector<uint32_t> row_words(const DistinctRows& distinct, uint32_t local_count) {
    return make_resident_radiance(rows_as_clusters(distinct.rows), distinct.row_of, local_count);
}

/// The shorter of the forms that are allowed; `held` are its clusters, none of rows. No words: there are more rows than
/// words can hold, or the search was stopped. Rows are made again where they turn out to be shorter, rather than kept
/// during the search.
std::vector<uint32_t> matrix_words(const DistinctRows& distinct, uint32_t local_count, MatrixForm form,
                                   const BiclusterOptions& search, Biclusters& held) {
    const size_t most = form == MatrixForm::kRows ? 0 : row_words(distinct, local_count).size();
    if (most == 0) return row_words(distinct, local_count);
    held = find_biclusters(distinct.rows, search);
    if (is_stopped(search.stop)) return {};
    std::vector<uint32_t> words = make_resident_radiance(held, distinct.row_of, local_count);
    if (!words.empty() && words.size() < most) return words;
    held = {};
    return row_words(distinct, local_count);
}

}  // namespace

std::vector<uint32_t> make_matrix_words(DistinctRows distinct, uint32_t local_count, const MatrixOptions& options,
                                        MatrixLoss* loss) {
    BiclusterOptions search = kLayerSearch;
    search.stop = options.stop;
    Biclusters held;
    MatrixLoss lost;
    std::vector<uint32_t> words;
    if (options.row_error > 0) {
        const LossyRows rows = lossy_rows(distinct, local_count, options.row_error);
        distinct = {};
        search.column_weights = rows.bound.weights;
        search.row_budgets = rows.budgets;
        words = matrix_words(rows.near.distinct, local_count, options.form, search, held);
        lost = loss_of(rows, held);
    } else {
        words = matrix_words(distinct, local_count, options.form, search, held);
    }
    if (loss != nullptr) *loss = lost;
    return words;
}

Biclusters clusters_of_words(const DistinctRows& distinct, uint32_t local_count) {
    Biclusters held;
    matrix_words(distinct, local_count, MatrixForm::kBiclusters, kLayerSearch, held);
    return held.count() > 0 ? held : rows_as_clusters(distinct.rows);
}

}  // namespace citystream::codec::radiance
