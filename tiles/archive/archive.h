// 3TZ archives: ZIP files of stored entries whose last entry is the hash index "@3dtilesIndex1@" (3TZ 1.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/result.h"

namespace citystream::tiles::archive {

/// Writes an archive under a temporary name beside `path` (removed on destruction and on failure), then syncs and
/// renames. Bytes depend only on the entries and their order (fixed timestamps). ZIP64 records are used only where
/// offsets or the number of entries need them. After a failure every call returns the same error. FORMAT.md has the
/// bytes.
class ArchiveWriter {
  public:
    static Result<std::unique_ptr<ArchiveWriter>> create(const std::string& path);
    virtual ~ArchiveWriter() = default;
    /// Appends one entry. Names are relative, '/'-separated, unique, without "..". An entry has 1 byte to 4 GiB - 2:
    /// 3TZ readers refuse empty ones, so what is empty is left out.
    virtual Status add(const std::string& name, std::span<const std::byte> bytes) = 0;
    /// Begins an entry written in pieces (sizes and checksum are patched in at the end): append to it until end_entry.
    virtual Status begin_entry(const std::string& name) = 0;
    virtual Status append(std::span<const std::byte> bytes) = 0;
    virtual Status end_entry() = 0;
    /// Index, central directory, sync, rename.
    virtual Status finish() = 0;
};

struct ArchiveEntry {
    std::string name;
    uint64_t data_offset = 0;
    uint64_t size = 0;
    uint32_t crc32 = 0;
};

/// A memory-mapped archive. Opening checks structure (end records, central directory, index), not contents. Thread-safe
/// for reading.
class ArchiveReader {
  public:
    static Result<std::shared_ptr<ArchiveReader>> open(const std::string& path);
    virtual ~ArchiveReader() = default;
    /// Contents of an entry straight from the mapping, or nothing (data() == nullptr) when there is no such entry.
    /// O(log n): by the names, which opening has sorted; the hash index, an MD5 a look-up, is for readers that do not
    /// read the whole central directory.
    virtual std::span<const std::byte> find(std::string_view name) const = 0;
    virtual const std::vector<ArchiveEntry>& entries() const = 0;  ///< in file order, without the index
    virtual uint64_t file_size() const = 0;
    /// Checks every byte of the file: CRC of each entry, headers against directory, index, no gaps and nothing after
    /// the end. One error per bad place, naming the entry.
    virtual std::vector<Error> verify() const = 0;
};

/// The same structure checks on bytes in memory (fuzzing, tests); `bytes` must outlive the reader.
Result<std::shared_ptr<ArchiveReader>> open_archive_bytes(std::span<const std::byte> bytes);

}  // namespace citystream::tiles::archive
