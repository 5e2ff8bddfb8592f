// Parsed subtrees, shared: many streamers of one city hold one copy.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <span>

#include "codec/result.h"
#include "tiles/tileset/subtree.h"

namespace citystream::client {

/// Thread-safe. One pool serves one city (one manifest): entries are found by address and by the hash of the bytes.
class SubtreePool {
  public:
    using Shared = std::shared_ptr<const tiles::tileset::Subtree>;
    /// The subtree parsed from these bytes, now or before. Kept while anyone holds it.
    Result<Shared> parse(std::span<const std::byte> bytes, tiles::tileset::TileAddress root,
                         const tiles::tileset::Manifest& manifest);

  private:
    std::mutex mutex_;
    std::map<std::pair<tiles::tileset::TileAddress, uint64_t>, std::weak_ptr<const tiles::tileset::Subtree>> known_;
};

/// Host bytes that the records of a subtree take, for the budget.
uint64_t host_bytes_of(const tiles::tileset::Subtree& subtree);

}  // namespace citystream::client
