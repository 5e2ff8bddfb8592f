// Parsed pieces of the directory, shared: many streamers of one city hold one copy.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "codec/result.h"
#include "tiles/tileset/subtree.h"

namespace citystream::client {

/// Thread-safe. One pool serves one city (one manifest): entries are found by address and by the hash of the bytes, and
/// kept while anyone holds them.
class DirectoryPool {
  public:
    using SharedSubtree = std::shared_ptr<const tiles::tileset::Subtree>;
    using SharedMaps = std::shared_ptr<const std::vector<tiles::tileset::FacadeMapRecord>>;
    using SharedCharts = std::shared_ptr<const std::vector<tiles::tileset::ChartRecord>>;
    /// The subtree parsed from these bytes, now or before.
    Result<SharedSubtree> subtree(std::span<const std::byte> bytes, tiles::tileset::TileAddress root,
                                  const tiles::tileset::Manifest& manifest);
    /// The records of the facade index, parsed now or before.
    Result<SharedMaps> facade_maps(std::span<const std::byte> index, const tiles::tileset::Manifest& manifest);
    /// The records of the chart index, parsed now or before.
    Result<SharedCharts> shared_charts(std::span<const std::byte> index, const tiles::tileset::Manifest& manifest);

  private:
    std::mutex mutex_;
    std::map<std::pair<tiles::tileset::TileAddress, uint64_t>, std::weak_ptr<const tiles::tileset::Subtree>> subtrees_;
    std::map<uint64_t, std::weak_ptr<const std::vector<tiles::tileset::FacadeMapRecord>>> maps_;
    std::map<uint64_t, std::weak_ptr<const std::vector<tiles::tileset::ChartRecord>>> charts_;
};

/// Host bytes that the records of a subtree take, for the budget.
uint64_t host_bytes_of(const tiles::tileset::Subtree& subtree);

}  // namespace citystream::client
