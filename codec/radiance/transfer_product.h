// Local light from far light, L* = T L (Sun et al. 2011, equation 2), in the four ways that a tile's matrix is kept in:
// by biclusters (algorithm 2: a sum for each cluster, then a gather for each row), by entries, by the full matrix, and
// by visibility bits. A row gives the light that reaches one local direction of one receiver.
//
// A value is an array of three channels of float, double or uint32_t. Sums go in a fixed order (columns rising;
// clusters in their order), so floats are the same in every run. With uint32_t (source_light.h, WholeLight) all four
// give the same numbers, exactly: sums modulo 2^32 do not care for order, and what cancels does so without a rest.
//
// Results are in quarters: times kQuarter, and times the unit of whole light, they are radiance times solid angle.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/biclusters.h"
#include "codec/radiance/transfer.h"

namespace citystream::codec::radiance {

template <typename Number>
using Channels = std::array<Number, 3>;

/// sum += quarters * light.
template <typename Number>
void add_scaled(Channels<Number>& sum, int quarters, const Channels<Number>& light) {
    for (size_t c = 0; c < sum.size(); ++c) sum[c] += static_cast<Number>(quarters) * light[c];
}

/// By entries. light.size() == columns. O(nonzeros).
template <typename Number>
std::vector<Channels<Number>> product_by_entries(const Transfer& transfer, std::span<const Channels<Number>> light) {
    assert(light.size() == transfer.columns);
    std::vector<Channels<Number>> local(transfer.rows());
    for (uint32_t j = 0; j < transfer.rows(); ++j) {
        for (uint32_t i = transfer.row_begin[j]; i < transfer.row_begin[j + 1]; ++i)
            add_scaled(local[j], transfer.quarters[i], light[transfer.column[i]]);
    }
    return local;
}

/// First pass of algorithm 2: what the columns of each cluster give. O(columns of clusters).
template <typename Number>
std::vector<Channels<Number>> cluster_sums(const Biclusters& clusters, std::span<const Channels<Number>> light) {
    assert(light.size() == clusters.columns);
    std::vector<Channels<Number>> sums(clusters.count());
    for (uint32_t i = 0; i < clusters.count(); ++i) {
        for (uint32_t m = clusters.column_begin[i]; m < clusters.column_begin[i + 1]; ++m)
            add_scaled(sums[i], clusters.value[m], light[clusters.column[m]]);
    }
    return sums;
}

/// By clusters. O(rows and columns of clusters).
template <typename Number>
std::vector<Channels<Number>> product_by_clusters(const Biclusters& clusters, std::span<const Channels<Number>> light) {
    const std::vector<Channels<Number>> sums = cluster_sums(clusters, light);
    std::vector<Channels<Number>> local(clusters.rows);
    for (uint32_t i = 0; i < clusters.count(); ++i) {
        for (const uint32_t j : clusters.rows_of(i)) add_scaled(local[j], 1, sums[i]);
    }
    return local;
}

/// Rows kept once: the product of the distinct rows, then as many copies as there are rows.
template <typename Number>
std::vector<Channels<Number>> spread_rows(const std::vector<uint32_t>& row_of,
                                          const std::vector<Channels<Number>>& distinct) {
    std::vector<Channels<Number>> local;
    local.reserve(row_of.size());
    for (const uint32_t row : row_of) local.push_back(distinct[row]);
    return local;
}

/// Every entry of the matrix, zeros too, row by row: what compression is measured against.
std::vector<int8_t> dense_quarters(const Transfer& transfer);
template <typename Number>
std::vector<Channels<Number>> product_by_dense(std::span<const int8_t> quarters,
                                               std::span<const Channels<Number>> light) {
    std::vector<Channels<Number>> local(light.empty() ? 0 : quarters.size() / light.size());
    for (size_t j = 0; j < local.size(); ++j) {
        for (size_t k = 0; k < light.size(); ++k) add_scaled(local[j], quarters[j * light.size() + k], light[k]);
    }
    return local;
}

/// By bits, without a matrix: every sample that is seen adds its texel's light to its nearest local direction.
/// `tables`: local_of_samples() of each frame of the tile; bits below planes are cleared. O(samples that are seen).
template <typename Number>
std::vector<Channels<Number>> product_by_bits(const VisibilityTile& tile, uint32_t local_count,
                                              std::span<const std::vector<uint16_t>> tables,
                                              std::span<const Channels<Number>> light) {
    assert(light.size() == texel_count(tile.side) && tables.size() == tile.frames.size());
    std::vector<uint32_t> texel(sample_count(tile.side));
    for (uint32_t s = 0; s < texel.size(); ++s) texel[s] = texel_of_sample(tile.side, s);
    std::vector<Channels<Number>> local(size_t{tile.receivers()} * local_count);
    for (uint32_t r = 0; r < tile.receivers(); ++r) {
        const auto& table = tables[tile.frame_of[r]];
        const std::span rows(&local[size_t{r} * local_count], local_count);
        const auto words = tile.of(r);
        for (uint32_t w = 0; w < words.size(); ++w) {
            for (uint32_t bits = words[w]; bits != 0; bits &= bits - 1) {
                const uint32_t s = 32 * w + static_cast<uint32_t>(std::countr_zero(bits));
                add_scaled(rows[table[s]], 1, light[texel[s]]);
            }
        }
    }
    return local;
}

/// What reaches a surface that reflects light by the cosine: sum over local directions of averaged cosine times L*.
/// `cosines`: cell_averages().cosine; `local`: M rows of a receiver.
template <typename Number>
Channels<double> irradiance(std::span<const double> cosines, std::span<const Channels<Number>> local) {
    Channels<double> sum{};
    for (size_t j = 0; j < cosines.size(); ++j) {
        for (size_t c = 0; c < sum.size(); ++c) sum[c] += kQuarter * cosines[j] * static_cast<double>(local[j][c]);
    }
    return sum;
}

}  // namespace citystream::codec::radiance
