#include "tiles/tileset/facade_index.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "codec/bits/zstd_frame.h"

namespace citystream::tiles::tileset {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in memory");

constexpr size_t kRecordBytes = 24;  // end, checksum, decoded bytes, depths
constexpr int kLevel = 19;
constexpr uint64_t kMaxFacadeMaps = uint64_t{1} << 24;
// Checksums do not compress, so an honest index is at most a few times larger than its frame.
constexpr uint64_t kMaxRatio = 64;
constexpr uint64_t kFreeBytes = uint64_t{1} << 20;

void put_record(const FacadeMapRecord& map, std::byte* out) {
    std::memcpy(out, &map.end, 8);
    std::memcpy(out + 8, &map.checksum, 8);
    std::memcpy(out + 16, &map.decoded_bytes, 4);
    std::memcpy(out + 20, &map.depth_min_mm, 2);
    std::memcpy(out + 22, &map.depth_max_mm, 2);
}

FacadeMapRecord get_record(const std::byte* in) {
    FacadeMapRecord map;
    std::memcpy(&map.end, in, 8);
    std::memcpy(&map.checksum, in + 8, 8);
    std::memcpy(&map.decoded_bytes, in + 16, 4);
    std::memcpy(&map.depth_min_mm, in + 20, 2);
    std::memcpy(&map.depth_max_mm, in + 22, 2);
    return map;
}

Error defect(std::string_view what) {
    return {fmt::format("{}: {}", kFacadeIndexPath, what)};
}

}  // namespace

std::vector<std::byte> write_facade_index(std::span<const FacadeMapRecord> maps, Manifest& manifest) {
    std::vector<std::byte> raw(maps.size() * kRecordBytes);
    for (size_t i = 0; i < maps.size(); ++i) put_record(maps[i], raw.data() + i * kRecordBytes);
    std::vector<std::byte> frame = codec::bits::compress_frame(raw, kLevel);
    manifest.facade_map_count = maps.size();
    manifest.facade_index_bytes = frame.size();
    manifest.facade_index_decoded_bytes = raw.size();
    manifest.facade_index_checksum = checksum_of(frame.data(), frame.size());
    return frame;
}

Result<std::vector<FacadeMapRecord>> parse_facade_index(std::span<const std::byte> frame, const Manifest& manifest) {
    if (frame.size() != manifest.facade_index_bytes) {
        return defect(fmt::format("has {} bytes, tileset.json says {}", frame.size(), manifest.facade_index_bytes));
    }
    const uint64_t count = manifest.facade_map_count;
    if (count > kMaxFacadeMaps || manifest.facade_index_decoded_bytes != count * kRecordBytes ||
        manifest.facade_index_decoded_bytes > kFreeBytes + kMaxRatio * frame.size()) {
        return defect(fmt::format("cannot list {} maps in {} bytes", count, manifest.facade_index_decoded_bytes));
    }
    if (checksum_of(frame.data(), frame.size()) != manifest.facade_index_checksum)
        return defect("its checksum is wrong");
    const auto raw = codec::bits::decompress_frame(frame, manifest.facade_index_decoded_bytes);
    if (!raw) return defect(raw.error().text());
    std::vector<FacadeMapRecord> maps;
    maps.reserve(count);
    uint64_t end = 0;
    for (size_t i = 0; i < count; ++i) {
        maps.push_back(get_record(raw->data() + i * kRecordBytes));
        const FacadeMapRecord& map = maps.back();
        if (map.end <= end || map.end > UINT32_MAX)
            return defect(fmt::format("map {} does not end after the one before", i));
        if (map.decoded_bytes % 4 != 0) return defect(fmt::format("map {} does not decode to whole words", i));
        if (map.depth_min_mm > map.depth_max_mm)
            return defect(fmt::format("map {} has its depths the wrong way round", i));
        end = map.end;
    }
    return maps;
}

}  // namespace citystream::tiles::tileset
