// The full check of an archive: every byte of the file is accounted for.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "codec/result.h"
#include "tiles/archive/archive_layout.h"

namespace citystream::tiles::archive {

/// Checks each entry's CRC-32, regenerates local headers, central directory, hash index and end records and compares
/// them with the file, and reports bytes that belong to nothing. One error per bad place, beginning with the entry's
/// name. Reads the whole file once.
std::vector<Error> verify_archive(std::span<const std::byte> file, const ArchiveLayout& layout);

}  // namespace citystream::tiles::archive
