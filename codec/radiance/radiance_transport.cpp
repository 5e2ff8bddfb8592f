#include "codec/radiance/radiance_transport.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <string>
#include <utility>

#include "codec/radiance/csr_wire.h"
#include "codec/radiance/distinct_row_set.h"
#include "codec/radiance/matrix_words.h"
#include "codec/radiance/row_wire.h"

namespace citystream::codec::radiance {

namespace {

/// What rows times columns of clusters may be of the entries that the sum may have.
constexpr uint64_t kMostOverlap = 16;
constexpr int kMostQuarters = kSamplesInTexel;

/// Before anything is made room for: all wires begin alike.
Result<MatrixShape> read_shape(std::span<const std::byte> bytes, const MatrixBounds& bounds) {
    bits::RangeDecoder decoder(bytes);
    MatrixShape shape{1, 0, 1};
    const RadianceLimits limits{bounds.receivers, 0};
    if (!code_matrix_size(decoder, limits, shape.local_count, shape.receivers, shape.columns) || !decoder.ok())
        return Error{"a radiance layer's matrix is of a size that cannot be", 0};
    if (shape.receivers != bounds.receivers || shape.local_count != bounds.local_count)
        return Error{"a radiance layer's matrix of " + std::to_string(shape.receivers) + " receivers with " +
                         std::to_string(shape.local_count) + " local directions is not that of its places",
                     0};
    const uint32_t side = texels_across_of(shape.columns);
    if (side < 1 || side > kMostCubeSide || texel_count(side) != shape.columns)
        return Error{"a radiance layer's matrix of " + std::to_string(shape.columns) + " source texels", 0};
    return shape;
}

bool can_be_seen(std::span<const int8_t> quarters) {
    return std::all_of(quarters.begin(), quarters.end(), [](int8_t q) { return q >= 1 && q <= kMostQuarters; });
}

Error no_receivers_rows() {
    return Error{"a radiance layer's rows are not those of receivers"};
}

/// A receiver's rows have no more entries than it has samples: rows that are equal take room once, but time each.
Result<DistinctRows> decode_all_rows(std::span<const std::byte> bytes, const MatrixBounds& bounds,
                                     const MatrixShape& shape) {
    const uint64_t most_of_receiver = uint64_t{kSamplesInTexel} * shape.columns;
    const uint64_t most = most_entries(bounds.words, shape.columns);
    DistinctRowSet rows(shape.columns);
    uint64_t row = 0, of_receiver = 0;
    bool fits = true, can_be = true;
    const auto visited = visit_rows(bytes, {bounds.receivers, ~uint64_t{0}}, [&](const SparseRow& entries) {
        if (row++ % shape.local_count == 0) of_receiver = 0;
        of_receiver += entries.columns.size();
        can_be = of_receiver <= most_of_receiver && can_be_seen(entries.values);
        if (can_be) rows.add(entries.columns, entries.values);
        fits = rows.nonzeros() <= most;
        return fits && can_be;
    });
    if (!visited) return visited.error();
    if (!can_be) return no_receivers_rows();
    if (!fits) return Error{"a radiance layer's rows take more than its decoded bytes"};
    return rows.take();
}

/// Whether a sum of so many entries would take too long: rows times columns, added up over clusters.
bool overlap_too_much(const Biclusters& clusters, uint64_t entries) {
    uint64_t covered = 0;
    for (uint32_t i = 0; i < clusters.count(); ++i)
        covered += uint64_t{clusters.rows_of(i).size()} * clusters.columns_of(i).size();
    return covered > kMostOverlap * entries;
}

Result<DistinctRows> add_up(ClusteredRows clustered, const MatrixBounds& bounds) {
    const uint64_t most = most_entries(bounds.words, clustered.clusters.columns);
    if (overlap_too_much(clustered.clusters, most))
        return Error{"a radiance layer's biclusters take too long to add up"};
    auto rows = checked_sum_of(clustered.clusters, most, kMostQuarters);
    if (!rows) return rows.error();
    return DistinctRows{std::move(*rows), std::move(clustered.row_of)};
}

}  // namespace

uint64_t most_entries(uint64_t words, uint32_t columns) {
    return 32 * words / static_cast<uint32_t>(std::bit_width((columns - 1) | 1));
}

std::vector<std::byte> encode_matrix(RadianceTransport transport, const DistinctRows& distinct, uint32_t local_count) {
    assert(transport != RadianceTransport::kVisibility);
    if (transport == RadianceTransport::kRows) return encode_rows(distinct, local_count);
    if (transport == RadianceTransport::kDistinctRows) return encode_distinct_rows(distinct, local_count);
    Biclusters clusters = clusters_of_words(distinct, local_count);
    if (overlap_too_much(clusters, distinct.rows.nonzeros())) clusters = rows_as_clusters(distinct.rows);
    return encode_clustered_rows({std::move(clusters), distinct.row_of}, local_count);
}

Result<DistinctRows> decode_matrix_rows(RadianceTransport transport, std::span<const std::byte> bytes,
                                        const MatrixBounds& bounds) {
    assert(transport != RadianceTransport::kVisibility);
    const auto shape = read_shape(bytes, bounds);
    if (!shape) return shape.error();
    if (transport == RadianceTransport::kRows) return decode_all_rows(bytes, bounds, *shape);
    if (transport == RadianceTransport::kDistinctRows) {
        auto distinct = decode_distinct_rows(bytes, {bounds.receivers, most_entries(bounds.words, shape->columns)});
        if (distinct && !can_be_seen(distinct->rows.quarters)) return no_receivers_rows();
        return distinct;
    }
    auto clustered = decode_matrix_clusters(bytes, bounds);
    if (!clustered) return clustered.error();
    return add_up(std::move(*clustered), bounds);
}

Result<ClusteredRows> decode_matrix_clusters(std::span<const std::byte> bytes, const MatrixBounds& bounds) {
    const auto shape = read_shape(bytes, bounds);
    if (!shape) return shape.error();
    return decode_clustered_rows(bytes, bounds.receivers, 32 * bounds.words);
}

}  // namespace citystream::codec::radiance
