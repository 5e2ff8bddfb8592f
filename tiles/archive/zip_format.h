// The ZIP records of a 3TZ archive, byte for byte as the writer emits them; the verifier regenerates them from the same
// functions. Only what 3TZ 1.3 allows: stored entries below 4 GiB with sizes and CRC-32 in the local header, no
// comments, no data descriptors. ZIP64 appears where an offset, the entry count or the central directory outgrows the
// old fields.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace citystream::tiles::archive {

static_assert(std::endian::native == std::endian::little, "ZIP fields are copied as they lie in memory");

inline constexpr std::string_view kIndexName = "@3dtilesIndex1@";
inline constexpr uint64_t kMaxEntryBytes = 0xFFFFFFFE;  ///< 0xFFFFFFFF would announce a ZIP64 size, which 3TZ forbids
inline constexpr uint32_t kMax32 = 0xFFFFFFFF;
inline constexpr uint16_t kMax16 = 0xFFFF;
inline constexpr size_t kMaxNameBytes = 255;

inline constexpr uint32_t kLocalSignature = 0x04034b50;
inline constexpr uint32_t kCentralSignature = 0x02014b50;
inline constexpr uint32_t kEndSignature = 0x06054b50;
inline constexpr uint32_t kEnd64Signature = 0x06064b50;
inline constexpr uint32_t kLocator64Signature = 0x07064b50;
inline constexpr size_t kLocalHeaderBytes = 30;    ///< without the name
inline constexpr size_t kCentralHeaderBytes = 46;  ///< without name and extra field
inline constexpr size_t kEndBytes = 22;
inline constexpr size_t kEnd64Bytes = 56;
inline constexpr size_t kLocator64Bytes = 20;

/// What the headers of one entry say.
struct ZipRecord {
    std::string name;
    uint64_t header_offset = 0;  ///< of the local header in the file
    uint64_t size = 0;           ///< stored = uncompressed, at most kMaxEntryBytes
    uint32_t crc32 = 0;
};

/// Why a name cannot be an entry of an archive, or nothing when it is good: 1..255 printable ASCII characters,
/// relative, '/'-separated, no empty, "." or ".." component, no backslash or colon, no ".3tz" (3TZ 1.3).
std::optional<std::string> name_defect(std::string_view name);

void append_local_header(std::vector<std::byte>& out, const ZipRecord& record);
void append_central_header(std::vector<std::byte>& out, const ZipRecord& record);
/// End of central directory, preceded by the ZIP64 records where they are needed.
void append_end_records(std::vector<std::byte>& out, uint64_t entry_count, uint64_t central_offset,
                        uint64_t central_size);

}  // namespace citystream::tiles::archive
