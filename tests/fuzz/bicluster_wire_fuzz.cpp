// Any bytes as a transfer matrix on the wire, in the form that the first byte names: a matrix that encodes to itself
// again and can be made resident, or an error, in bounded time and memory.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/radiance/bicluster_wire.h"
#include "codec/radiance/csr_wire.h"
#include "codec/radiance/radiance_resident.h"
#include "codec/radiance/row_wire.h"

namespace {

using namespace citystream::codec::radiance;

constexpr RadianceLimits kLimits{64, 1 << 14};

void require(bool holds) {
    if (!holds) std::abort();
}

void check_rows(const Transfer& transfer) {
    for (uint32_t j = 0; j < transfer.rows(); ++j) {
        for (uint32_t i = transfer.row_begin[j]; i < transfer.row_begin[j + 1]; ++i) {
            require(transfer.column[i] < transfer.columns && transfer.quarters[i] != 0);
            require(i == transfer.row_begin[j] || transfer.column[i - 1] < transfer.column[i]);
        }
    }
}

void check_clusters(const DecodedBiclusters& decoded) {
    Biclusters clusters = decoded.clusters;
    for (uint32_t i = 0; i < clusters.count(); ++i) {
        const auto rows = clusters.rows_of(i);
        const auto columns = clusters.columns_of(i);
        require(!rows.empty() && !columns.empty() && rows.back() < clusters.rows && columns.back() < clusters.columns);
        for (size_t m = 1; m < rows.size(); ++m) require(rows[m - 1] < rows[m]);
        for (size_t m = 1; m < columns.size(); ++m) require(columns[m - 1] < columns[m]);
    }
    const auto bytes = encode_biclusters(clusters, decoded.local_count);
    const auto again = decode_biclusters(bytes, kLimits);
    require(again.ok() && again->clusters == clusters);
    std::vector<uint32_t> row_of(clusters.rows);
    for (uint32_t j = 0; j < clusters.rows; ++j) row_of[j] = j;
    const auto words = make_resident_radiance(clusters, row_of, decoded.local_count);
    require(ResidentRadianceView::create(words).ok());
}

void check_clustered_rows(const ClusteredRows& clustered) {
    for (const uint32_t row : clustered.clusters.row) require(row < clustered.clusters.rows);
    for (const uint32_t row : clustered.row_of) require(row < clustered.clusters.rows);
    const auto again = decode_clustered_rows(encode_clustered_rows(clustered, 1), 1 << 16, kLimits.entries);
    require(again.ok() && again->clusters == clustered.clusters && again->row_of == clustered.row_of);
    require(ResidentRadianceView::create(make_resident_radiance(clustered.clusters, clustered.row_of, 1)).ok());
    const auto sum = checked_sum_of(clustered.clusters, kLimits.entries, 4);
    if (sum) check_rows(*sum);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size == 0) return 0;
    const auto bytes = std::as_bytes(std::span(data, size).subspan(1));
    if (data[0] % 4 == 0) {
        const auto decoded = decode_biclusters(bytes, kLimits);
        if (decoded) check_clusters(*decoded);
    } else if (data[0] % 4 == 1) {
        const auto rows = decode_rows(bytes, kLimits);
        if (!rows) return 0;
        check_rows(*rows);
        const auto again = decode_rows(encode_rows(*rows, 1), {1 << 20, kLimits.entries});
        require(again.ok() && *again == *rows);
    } else if (data[0] % 4 == 3) {
        const auto clustered = decode_clustered_rows(bytes, kLimits.receivers, kLimits.entries);
        if (clustered) check_clustered_rows(*clustered);
    } else {
        const auto distinct = decode_distinct_rows(bytes, kLimits);
        if (!distinct) return 0;
        check_rows(distinct->rows);
        for (const uint32_t row : distinct->row_of) require(row < distinct->rows.rows());
        require(all_rows(*distinct).rows() == distinct->row_of.size());
    }
    return 0;
}
