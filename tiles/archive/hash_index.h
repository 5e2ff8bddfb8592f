// The entry "@3dtilesIndex1@": per entry 16 bytes MD5 of its name and 8 bytes offset of its local header
// (little-endian), sorted by the hash read as two little-endian 64-bit integers, as 3TZ 1.3 prescribes.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "tiles/archive/zip_format.h"

namespace citystream::tiles::archive {

inline constexpr size_t kIndexEntryBytes = 24;

/// An MD5 in the order in which the index is sorted: `first` are bytes 0..7, `second` bytes 8..15, both little-endian.
struct NameHash {
    uint64_t first = 0, second = 0;
    friend auto operator<=>(const NameHash&, const NameHash&) = default;
};
static_assert(sizeof(NameHash) == 16);

/// The index's bytes for these entries (the index itself is not among them). O(n log n).
std::vector<std::byte> build_index(std::span<const ZipRecord> records);

/// One index entry; `i` must be below index.size() / kIndexEntryBytes.
struct IndexEntry {
    NameHash hash;
    uint64_t header_offset = 0;
};
IndexEntry index_entry(std::span<const std::byte> index, size_t i);

}  // namespace citystream::tiles::archive
