#include "codec/radiance/radiance_sizes.h"

#include <bit>

#include "codec/radiance/bicluster_wire.h"
#include "codec/radiance/csr_wire.h"
#include "codec/radiance/radiance_resident.h"
#include "codec/radiance/row_wire.h"
#include "codec/radiance/visibility_wire.h"

namespace citystream::codec::radiance {

namespace {

uint64_t csr_bytes(const Transfer& transfer) {
    return 3 * transfer.nonzeros() + 4 * (uint64_t{transfer.rows()} + 1);
}

RepresentationSize size_of_bits(const VisibilityTile& tile) {
    const uint64_t tables = uint64_t{2} * tile.frames.size() * sample_count(tile.side);
    RepresentationSize size{"bits", 4 * tile.words.size() + tables, 4 * tile.frames.size(), 0};
    for (const auto& step : encode_visibility(tile)) size.wire_bytes += step.bytes.size();
    for (const uint32_t word : tile.words) size.flops += static_cast<uint64_t>(std::popcount(word));
    return size;
}

}  // namespace

std::vector<RepresentationSize> representation_sizes(const VisibilityTile& tile, const LocalDirections& local,
                                                     BiclusterGoal goal, uint64_t random_seed) {
    const uint32_t local_count = local.count();
    const Transfer transfer = make_transfer(tile, local);
    const DistinctRows distinct = distinct_rows(transfer);
    const Biclusters all = best_biclusters(transfer, goal, local_count, random_seed);
    const Biclusters few = best_biclusters(distinct.rows, BiclusterGoal::kFlops, 1, random_seed);
    const uint64_t dense = uint64_t{transfer.rows()} * transfer.columns;
    const uint64_t row_numbers = 4 * uint64_t{transfer.rows()};
    return {{"dense", dense, 0, 2 * dense},
            {"csr", csr_bytes(transfer), encode_rows(transfer, local_count).size(), transfer.flops()},
            {"rowdedupe", csr_bytes(distinct.rows) + row_numbers, encode_distinct_rows(distinct, local_count).size(),
             distinct.rows.flops()},
            {"paper", 4 * (all.row.size() + 2 * all.column.size()), encode_biclusters(all, local_count).size(),
             all.flops()},
            {"bicluster", 4 * make_resident_radiance(few, distinct.row_of, local_count).size(), 0, few.flops()},
            size_of_bits(tile)};
}

}  // namespace citystream::codec::radiance
