#include "client/stream/request_cost.h"

#include <algorithm>

#include "client/cache/directory_cache.h"

namespace citystream::client {

using tiles::tileset::ChartRecord;
using tiles::tileset::FacadeMapRecord;
using tiles::tileset::Manifest;
using tiles::tileset::StepRecord;
using tiles::tileset::TileAddress;
using tiles::tileset::TileRecord;

namespace {

// In a subtree file: the columns that every tile has (box, geometric error, base height), and those of a step.
constexpr uint64_t kTileFileBytes = 12 * 8 + 4 + 8;
constexpr uint64_t kStepFileBytes = 8 + 4 + 4 + 8;
constexpr uint64_t kMostChildSubtrees = 4;  // of one tile

/// Of a file of so many bytes: as tiles without steps or as steps, whichever becomes larger.
uint64_t parsed_subtree_bytes(uint64_t file, uint64_t bytes_per_tile) {
    const uint64_t tile =
        sizeof(TileRecord) + kMostChildSubtrees * sizeof(TileAddress) + sizeof(DirectoryNode) + bytes_per_tile;
    return sizeof(tiles::tileset::Subtree) +
           std::max(file * tile / kTileFileBytes, file * sizeof(StepRecord) / kStepFileBytes);
}

}  // namespace

uint64_t subtree_limit(const Manifest& manifest, uint64_t host_budget) {
    const uint64_t share = std::clamp<uint64_t>(host_budget / 16, 64u << 10, 16u << 20);
    return manifest.greatest_subtree_bytes > 0 ? std::min(manifest.greatest_subtree_bytes, share) : share;
}

uint64_t most_host_bytes(const PlannedRequest& request, const Manifest& manifest, uint64_t host_budget,
                         uint64_t bytes_per_tile) {
    if (request.kind == RequestKind::kSubtree) {
        const uint64_t file = subtree_limit(manifest, host_budget);
        // A share of the budget is a guess far above any file, with its records.
        return manifest.greatest_subtree_bytes > 0 ? file + parsed_subtree_bytes(file, bytes_per_tile) : file;
    }
    if (request.kind == RequestKind::kFacadeIndex) {
        return request.length + manifest.facade_index_decoded_bytes +
               manifest.facade_map_count * sizeof(FacadeMapRecord);
    }
    if (request.kind == RequestKind::kChartIndex) {
        return request.length + manifest.chart_index_decoded_bytes + manifest.shared_chart_count * sizeof(ChartRecord);
    }
    return request.length;
}

}  // namespace citystream::client
