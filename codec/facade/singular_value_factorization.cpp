#include "codec/facade/singular_value_factorization.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "codec/facade/svd_layout.h"

namespace citystream::codec::facade {

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

Vector roots(const std::vector<uint32_t>& weights) {
    Vector root(static_cast<Eigen::Index>(weights.size()));
    for (size_t i = 0; i < weights.size(); ++i) root[static_cast<Eigen::Index>(i)] = std::sqrt(double{1} * weights[i]);
    return root;
}

/// The eigenvalue problem of the smaller Gram matrix of B, solved in steps so that eigenvectors are only computed where
/// the eigenvalues leave hope.
class SingularValues {
  public:
    SingularValues(const DistinctMatrix& matrix, uint32_t least)
        : row_root_(roots(matrix.row_weight)), column_root_(roots(matrix.column_weight)) {
        weighted_.resize(row_root_.size(), column_root_.size());
        size_t i = 0;
        for (Eigen::Index r = 0; r < weighted_.rows(); ++r) {
            for (Eigen::Index c = 0; c < weighted_.cols(); ++c, ++i)
                weighted_(r, c) = row_root_[r] * column_root_[c] * (double{1} * (matrix.entries[i] - least));
        }
        by_rows_ = weighted_.rows() < weighted_.cols();
        Matrix gram = by_rows_ ? Matrix(weighted_ * weighted_.transpose()) : Matrix(weighted_.transpose() * weighted_);
        if (gram.rows() > 1) tridiagonal_.compute(gram);
        single_ = gram(0, 0);
        size_ = gram.rows();
        solve(Eigen::EigenvaluesOnly);
    }

    Eigen::Index count() const { return size_; }

    /// Sum of the squared errors over all texels of the best approximation with `terms` singular values.
    double squared_error(uint64_t terms) const {
        const auto dropped = size_ - std::min(size_, static_cast<Eigen::Index>(terms));
        return values_.head(dropped).cwiseMax(0).sum();  // values rise
    }

    /// The first `terms` factors.
    SingularValueFactors factors(uint64_t most_terms) {
        const auto terms = std::min(size_, static_cast<Eigen::Index>(most_terms));
        solve(Eigen::ComputeEigenvectors);
        const Matrix basis = vectors_.rightCols(terms).rowwise().reverse();  // greatest first
        Matrix x = by_rows_ ? basis : Matrix(weighted_ * basis);
        Matrix y = by_rows_ ? Matrix(weighted_.transpose() * basis) : basis;
        // The singular values go to the rows.
        if (by_rows_) {
            const Vector lengths = y.colwise().norm().transpose().cwiseMax(1e-300);
            x = x * lengths.asDiagonal();
            y = y * lengths.cwiseInverse().asDiagonal();
        }
        x = row_root_.cwiseInverse().asDiagonal() * x;
        y = column_root_.cwiseInverse().asDiagonal() * y;
        SingularValueFactors factors;
        factors.terms = static_cast<uint32_t>(terms);
        for (const double value : x.reshaped<Eigen::RowMajor>()) factors.x.push_back(static_cast<float>(value));
        for (const double value : y.reshaped<Eigen::RowMajor>()) factors.y.push_back(static_cast<float>(value));
        return factors;
    }

  private:
    void solve(int what) {
        if (size_ == 1) {
            values_ = Vector::Constant(1, single_);
            vectors_ = Matrix::Identity(1, 1);
            return;
        }
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
        solver.computeFromTridiagonal(tridiagonal_.diagonal(), tridiagonal_.subDiagonal(), what);
        values_ = solver.eigenvalues();
        if (what == Eigen::ComputeEigenvectors) vectors_ = tridiagonal_.matrixQ() * solver.eigenvectors();
    }

    Vector row_root_, column_root_;
    Matrix weighted_;
    bool by_rows_ = false;
    Eigen::Index size_ = 0;
    double single_ = 0;
    Eigen::Tridiagonalization<Eigen::MatrixXd> tridiagonal_;
    Vector values_;
    Eigen::MatrixXd vectors_;
};

/// Keeps only the first terms.
void drop_terms(SingularValueFactors& factors, uint32_t kept) {
    if (kept == factors.terms) return;
    for (std::vector<float>* side : {&factors.x, &factors.y}) {
        const size_t lines = side->size() / factors.terms;
        for (size_t line = 0; line < lines; ++line) {
            for (size_t k = 0; k < kept; ++k) (*side)[line * kept + k] = (*side)[line * factors.terms + k];
        }
        side->resize(lines * kept);
    }
    factors.terms = kept;
}

/// Adds terms one by one in the shader's arithmetic until every entry is right.
class TermCounter {
  public:
    TermCounter(const DistinctMatrix& matrix, uint32_t least) : rows_(matrix.rows()), columns_(matrix.columns()) {
        for (const uint32_t entry : matrix.entries) target_.push_back(static_cast<float>(entry - least));
        plain_.assign(target_.size(), 0);
        fused_.assign(target_.size(), 0);
    }

    /// The least number of terms that is enough; none when all are not.
    std::optional<uint32_t> needed(const SingularValueFactors& factors) {
        for (uint32_t kept = 0;; ++kept) {
            if (is_right()) return kept;
            if (kept == factors.terms) return std::nullopt;
            add_term(factors, kept);
        }
    }

  private:
    void add_term(const SingularValueFactors& factors, uint32_t k) {
        std::vector<float> y(columns_);
        for (size_t c = 0; c < columns_; ++c) y[c] = factors.y[c * factors.terms + k];
        for (size_t r = 0; r < rows_; ++r) {
            const float x = factors.x[r * factors.terms + k];
            float *plain = &plain_[r * columns_], *fused = &fused_[r * columns_];
            for (size_t c = 0; c < columns_; ++c) {
                plain[c] = plain[c] + x * y[c];
                fused[c] = static_cast<float>(double{x} * y[c] + fused[c]);
            }
        }
    }

    bool is_right() const {
        for (size_t i = 0; i < target_.size(); ++i) {
            for (const float sum : {plain_[i], fused_[i]}) {
                if (!(std::abs(sum - target_[i]) < kMostRoundingError)) return false;
                if (static_cast<float>(rounded_entry(0, sum)) != target_[i]) return false;
            }
        }
        return true;
    }

    size_t rows_, columns_;
    std::vector<float> target_, plain_, fused_;
};

uint64_t texels(const DistinctMatrix& matrix) {
    uint64_t rows = 0, columns = 0;
    for (const uint32_t weight : matrix.row_weight) rows += weight;
    for (const uint32_t weight : matrix.column_weight) columns += weight;
    return rows * columns;
}

/// Least entry, and whether the decomposition is to be tried at all.
Result<uint32_t> least_entry(const DistinctMatrix& matrix, std::string_view what) {
    const auto [least, greatest] = std::minmax_element(matrix.entries.begin(), matrix.entries.end());
    if (static_cast<double>(*greatest - *least) > FACADE_SVD_GREATEST)
        return Error{"singular values of the " + std::string(what) + ": entries too great for float32"};
    if (std::min(matrix.rows(), matrix.columns()) > kMostSingularValues) {
        return Error{"singular values of the " + std::string(what) + ": " + std::to_string(matrix.rows()) + " x " +
                     std::to_string(matrix.columns()) + " distinct rows and columns would take too long"};
    }
    return *least;
}

bool are_in_range(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(),
                       [](float value) { return std::abs(value) <= static_cast<float>(FACADE_SVD_GREATEST); });
}

Error too_many_terms(std::string_view what, uint64_t most_terms) {
    return Error{"singular value factors of the " + std::string(what) + " do not pay: they need more than " +
                 std::to_string(most_terms) + " terms"};
}

}  // namespace

Result<SingularValueFactors> factor_singular_values(const DistinctMatrix& matrix, uint64_t most_terms,
                                                    std::string_view what) {
    const auto least = least_entry(matrix, what);
    if (!least) return least.error();
    SingularValues values(matrix, *least);
    // Entries that round right are less than half a unit off.
    if (values.squared_error(most_terms) > 0.25 * static_cast<double>(texels(matrix)))
        return too_many_terms(what, most_terms);
    SingularValueFactors factors = values.factors(most_terms);
    const auto needed = TermCounter(matrix, *least).needed(factors);
    if (!needed) {
        if (most_terms < static_cast<uint64_t>(values.count())) return too_many_terms(what, most_terms);
        return Error{"the " + std::string(what) + " cannot be rounded from float32 factors"};
    }
    drop_terms(factors, *needed);
    if (!are_in_range(factors.x) || !are_in_range(factors.y))
        return Error{"singular values of the " + std::string(what) + " out of range"};
    factors.least = *least;
    return factors;
}

Result<SingularValueFactors> factor_rank(const DistinctMatrix& matrix, uint64_t rank, std::string_view what) {
    const auto least = least_entry(matrix, what);
    if (!least) return least.error();
    SingularValueFactors factors = SingularValues(matrix, *least).factors(rank);
    factors.least = *least;
    return factors;
}

int32_t rounded_entry(int32_t least, float sum) {
    const float clamped = std::clamp(sum, 0.0F, static_cast<float>(FACADE_SVD_GREATEST));
    return least + static_cast<int32_t>(std::floor(clamped + 0.5F));
}

}  // namespace citystream::codec::facade
