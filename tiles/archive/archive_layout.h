// Where everything in an archive lies, read from its end records and central directory and checked against the file's
// bounds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/result.h"
#include "tiles/archive/zip_format.h"

namespace citystream::tiles::archive {

/// One entry and the places of its parts in the file.
struct PlacedRecord {
    ZipRecord record;
    uint64_t data_offset = 0;
    uint64_t central_offset = 0;  ///< of its central directory record
    uint64_t central_bytes = 0;
};

struct ArchiveLayout {
    std::vector<PlacedRecord> entries;  ///< in file order, without the index
    std::vector<size_t> by_name;        ///< positions in `entries`, sorted by the entries' names
    PlacedRecord index;
    uint64_t central_offset = 0;
    uint64_t central_bytes = 0;
};

/// Reads the structure of `file`. Entries are stored, named safely and uniquely, lie in the file before the central
/// directory and do not overlap; the hash index is the last entry, sorted, and points to every entry once. O(n log n)
/// in the number of entries; contents are not touched, and local headers only where the packing leaves open how long
/// they are.
Result<ArchiveLayout> read_layout(std::span<const std::byte> file);

}  // namespace citystream::tiles::archive
