#include "tests/bench/clustered_components.h"

#include <algorithm>
#include <cmath>

#include "codec/radiance/source_light.h"
#include "codec/radiance/transfer_product.h"
#include "tests/bench/coded_halves.h"

namespace citystream::bench {

namespace {

using namespace codec::radiance;

constexpr uint32_t kMeanRounds = 3;    ///< with means alone
constexpr uint32_t kVectorRounds = 4;  ///< with vectors, too
constexpr uint32_t kSubspaceRounds = 4;

/// Means and vectors of all clusters: of column k, for cluster c at [c * (vectors + 1)] the mean, then the vectors.
class Clusters {
  public:
    Clusters(const DistinctRows& distinct, uint32_t clusters, uint32_t vectors)
        : rows_(distinct.rows),
          clusters_(clusters),
          vectors_(vectors),
          cluster_of_(rows_.rows()),
          count_of_(rows_.rows()),
          basis_(size_t{rows_.columns} * width()) {
        for (const uint32_t row : distinct.row_of) ++count_of_[row];
        for (uint32_t j = 0; j < rows_.rows(); ++j)
            cluster_of_[j] = static_cast<uint32_t>(uint64_t{j} * clusters_ / std::max(1U, rows_.rows()));
        seed_means();
        for (uint32_t i = 0; i < kMeanRounds; ++i) {
            assign(0);
            find_means();
        }
        for (uint32_t i = 0; i < kVectorRounds; ++i) {
            find_vectors();
            assign(vectors_);
            find_means();
        }
        find_vectors();
        for (float& value : basis_) value = rounded_to_half(value);
    }

    uint32_t width() const { return clusters_ * (vectors_ + 1); }
    uint32_t cluster_of(uint32_t row) const { return cluster_of_[row]; }
    std::span<const float> basis() const { return basis_; }
    /// Of a row: products with all means and vectors.
    void project(uint32_t row, std::vector<float>& products) const {
        products.assign(width(), 0.0F);
        for (uint32_t i = rows_.row_begin[row]; i < rows_.row_begin[row + 1]; ++i) {
            const float value = kQuarter * rows_.quarters[i];
            const float* const line = &basis_[size_t{rows_.column[i]} * width()];
            for (uint32_t b = 0; b < width(); ++b) products[b] += value * line[b];
        }
    }
    /// Of two entries of a cluster's: products over all columns.
    std::vector<double> products_with_means() const {
        std::vector<double> products(width());
        for (uint32_t k = 0; k < rows_.columns; ++k) {
            const float* const line = &basis_[size_t{k} * width()];
            for (uint32_t b = 0; b < width(); ++b)
                products[b] += double{line[b]} * line[b / (vectors_ + 1) * (vectors_ + 1)];
        }
        return products;
    }

  private:
    void seed_means() {
        for (uint32_t c = 0; c < clusters_ && rows_.rows() > 0; ++c) {
            const auto j = static_cast<uint32_t>((2 * uint64_t{c} + 1) * rows_.rows() / (2 * clusters_));
            for (uint32_t i = rows_.row_begin[j]; i < rows_.row_begin[j + 1]; ++i)
                at(rows_.column[i], c, 0) = kQuarter * rows_.quarters[i];
        }
    }
    float& at(uint32_t column, uint32_t cluster, uint32_t vector) {
        return basis_[size_t{column} * width() + cluster * (vectors_ + 1) + vector];
    }

    /// Each row to the cluster whose mean and first `vectors` vectors come nearest; of equals the first.
    void assign(uint32_t vectors) {
        const std::vector<double> mean = products_with_means();
        std::vector<float> products;
        for (uint32_t j = 0; j < rows_.rows(); ++j) {
            project(j, products);
            double least = HUGE_VAL;
            for (uint32_t c = 0; c < clusters_; ++c) {
                const uint32_t first = c * (vectors_ + 1);
                double error = mean[first] - 2 * products[first];  // but for the row's own square
                for (uint32_t b = first + 1; b <= first + vectors; ++b)
                    error -= (products[b] - mean[b]) * (products[b] - mean[b]);
                if (error >= least) continue;
                least = error;
                cluster_of_[j] = c;
            }
        }
    }

    void find_means() {
        std::vector<double> counts(clusters_);
        for (uint32_t j = 0; j < rows_.rows(); ++j) counts[cluster_of_[j]] += count_of_[j];
        for (uint32_t k = 0; k < rows_.columns; ++k) {
            for (uint32_t c = 0; c < clusters_; ++c) {
                if (counts[c] > 0) at(k, c, 0) = 0;
            }
        }
        for (uint32_t j = 0; j < rows_.rows(); ++j) {
            const uint32_t c = cluster_of_[j];
            const auto share = static_cast<float>(count_of_[j] / counts[c]);
            for (uint32_t i = rows_.row_begin[j]; i < rows_.row_begin[j + 1]; ++i)
                at(rows_.column[i], c, 0) += share * kQuarter * rows_.quarters[i];
        }
    }

    /// Power iteration on all vectors of each cluster at once, made orthonormal after each round.
    void find_vectors() {
        if (vectors_ == 0) return;
        seed_vectors();
        std::vector<float> products;
        for (uint32_t round = 0; round < kSubspaceRounds; ++round) {
            const std::vector<double> mean = products_with_means();
            std::vector<float> next(basis_.size());
            std::vector<double> mean_shares(width());
            for (uint32_t j = 0; j < rows_.rows(); ++j) {
                project(j, products);
                const uint32_t first = cluster_of_[j] * (vectors_ + 1);
                for (uint32_t b = first + 1; b <= first + vectors_; ++b) {
                    products[b] = static_cast<float>(count_of_[j] * (products[b] - mean[b]));
                    mean_shares[b] += products[b];
                }
                for (uint32_t i = rows_.row_begin[j]; i < rows_.row_begin[j + 1]; ++i) {
                    const float value = kQuarter * rows_.quarters[i];
                    float* const line = &next[size_t{rows_.column[i]} * width()];
                    for (uint32_t b = first + 1; b <= first + vectors_; ++b) line[b] += value * products[b];
                }
            }
            for (uint32_t k = 0; k < rows_.columns; ++k) {
                for (uint32_t b = 0; b < width(); ++b) {
                    const uint32_t first = b / (vectors_ + 1) * (vectors_ + 1);
                    if (b == first) continue;
                    const size_t place = size_t{k} * width();
                    basis_[place + b] = next[place + b] - static_cast<float>(mean_shares[b]) * basis_[place + first];
                }
            }
            make_orthonormal();
        }
    }

    /// Waves of the columns' numbers: they have something in common with any row.
    void seed_vectors() {
        for (uint32_t k = 0; k < rows_.columns; ++k) {
            for (uint32_t c = 0; c < clusters_; ++c) {
                for (uint32_t v = 1; v <= vectors_; ++v)
                    at(k, c, v) = static_cast<float>(std::sin(0.37 * v * (k + 1) + 1.3 * v + 0.011 * k * c));
            }
        }
        make_orthonormal();
    }

    void make_orthonormal() {
        for (uint32_t c = 0; c < clusters_; ++c) {
            for (uint32_t v = 1; v <= vectors_; ++v) {
                for (uint32_t other = 1; other < v; ++other) {
                    double product = 0;
                    for (uint32_t k = 0; k < rows_.columns; ++k) product += double{at(k, c, v)} * at(k, c, other);
                    for (uint32_t k = 0; k < rows_.columns; ++k)
                        at(k, c, v) -= static_cast<float>(product) * at(k, c, other);
                }
                double square = 0;
                for (uint32_t k = 0; k < rows_.columns; ++k) square += double{at(k, c, v)} * at(k, c, v);
                // What is left of a vector that depends on the others is rounding: it goes.
                const auto scale = static_cast<float>(square > 1e-12 ? 1 / std::sqrt(square) : 0);
                for (uint32_t k = 0; k < rows_.columns; ++k) at(k, c, v) *= scale;
            }
        }
    }

    const Transfer& rows_;
    uint32_t clusters_, vectors_;
    std::vector<uint32_t> cluster_of_;
    std::vector<uint32_t> count_of_;
    std::vector<float> basis_;
};

}  // namespace

IrradianceModel clustered_components(const RadianceSample& sample, uint32_t local_side, uint32_t clusters,
                                     uint32_t vectors) {
    const uint32_t side = sample.visibility.side;
    const LocalDirections local(local_side);
    const DistinctRows distinct = distinct_rows(make_transfer(sample.visibility, local));
    const Clusters found(distinct, clusters, vectors);

    const std::vector<double> mean = found.products_with_means();
    std::vector<uint16_t> numbers, weights(size_t{distinct.rows.rows()} * vectors), basis;
    std::vector<float> products;
    for (uint32_t j = 0; j < distinct.rows.rows(); ++j) {
        found.project(j, products);
        numbers.push_back(static_cast<uint16_t>(found.cluster_of(j)));
        const uint32_t first = found.cluster_of(j) * (vectors + 1);
        for (uint32_t v = 0; v < vectors; ++v) {
            const double weight = products[first + 1 + v] - mean[first + 1 + v];
            weights[size_t{v} * distinct.rows.rows() + j] = to_half(static_cast<float>(weight));
        }
    }
    for (const float value : found.basis()) basis.push_back(to_half(value));
    const uint64_t bytes =
        coded_bytes(numbers) + coded_bytes(weights) + coded_bytes(basis) + coded_bytes(distinct.row_of);

    const RowProduct product = [vectors, numbers, weights, basis, width = found.width(),
                                row_of = distinct.row_of](std::span<const std::array<double, 3>> texels) {
        std::vector<std::array<double, 3>> light(width);
        for (size_t k = 0; k < texels.size(); ++k) {
            for (uint32_t b = 0; b < width; ++b) {
                const double value = from_half(basis[k * width + b]);
                for (size_t c = 0; c < 3; ++c) light[b][c] += value * texels[k][c];
            }
        }
        std::vector<std::array<double, 3>> rows(numbers.size());
        for (size_t j = 0; j < rows.size(); ++j) {
            const size_t first = size_t{numbers[j]} * (vectors + 1);
            rows[j] = light[first];
            for (uint32_t v = 0; v < vectors; ++v) {
                const double weight = from_half(weights[v * rows.size() + j]);
                for (size_t c = 0; c < 3; ++c) rows[j][c] += weight * light[first + 1 + v][c];
            }
        }
        return spread_rows<double>(row_of, rows);
    };
    return {"cpca-" + std::to_string(clusters) + "x" + std::to_string(vectors), bytes,
            [side, product, normals = receiver_normals(sample.visibility)](std::span<const Rgb> radiance) {
                return irradiance_by_vectors(normals, radiance, side, product);
            }};
}

}  // namespace citystream::bench
