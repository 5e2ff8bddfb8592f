#include "tiles/tileset/facade_index.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "codec/bits/zstd_frame.h"
#include "codec/facade/run_grid.h"
#include "tiles/tileset/index_columns.h"

namespace citystream::tiles::tileset {
namespace {

constexpr int kLevel = 19;
constexpr size_t kMapBytes = 9, kLevelBytes = 16;  // FORMAT.md has the columns
// Checksums do not compress, so an honest index is at most a few times larger than its frame.
constexpr uint64_t kMaxRatio = 64;
constexpr uint64_t kFreeBytes = uint64_t{1} << 20;
constexpr float kMetresPerMm = 0.001F;

long millimetres(float metres) {
    return std::lround(std::min(metres, 1000.0F) / kMetresPerMm);
}

Error defect(std::string_view what) {
    return {fmt::format("{}: {}", kFacadeIndexPath, what)};
}

Status check_levels(const FacadeMapRecord& map, size_t at, uint64_t& end) {
    uint32_t texel = std::numeric_limits<uint32_t>::max();
    float error = std::numeric_limits<float>::infinity();
    for (size_t i = 0; i < map.level_count; ++i) {
        const FacadeLevelRecord& level = map.level[i];
        const auto wrong = [&](const char* what) { return defect(fmt::format("level {} of map {} {}", i, at, what)); };
        if (level.end <= end) return wrong("does not end after the one before");
        if (level.end >= UINT32_MAX) return wrong("lies beyond 4 GiB");
        if (level.resident_bytes == 0 || level.resident_bytes % 4 != 0 ||
            level.resident_bytes > kMaxFacadeResidentBytes)
            return wrong("does not expand to a plausible number of whole words");
        if (level.texel_cm == 0 || level.texel_cm >= texel) return wrong("is not finer than the one before");
        if (!(level.displacement_error >= 0) || level.displacement_error > error)
            return wrong("has an error that grows or is none");
        if (static_cast<float>(millimetres(level.displacement_error)) * kMetresPerMm != level.displacement_error)
            return wrong("has an error of broken millimetres");
        end = level.end;
        texel = level.texel_cm;
        error = level.displacement_error;
    }
    if (texel != 1 || error != 0) return defect(fmt::format("map {} does not end with its exact level", at));
    return Done{};
}

Status check_map(const FacadeMapRecord& map, size_t at, uint64_t& end) {
    const auto side_fits = [](uint32_t side) { return side >= 1 && side <= codec::facade::kMaxFacadeSide; };
    if (!side_fits(map.width) || !side_fits(map.height))
        return defect(fmt::format("map {} has {} x {} texels", at, map.width, map.height));
    if (map.depth_min_mm > map.depth_max_mm)
        return defect(fmt::format("map {} has its depths the wrong way round", at));
    if (map.level_count < 1 || map.level_count > codec::facade::kMostFacadeLevels)
        return defect(fmt::format("map {} has {} levels", at, map.level_count));
    return check_levels(map, at, end);
}

/// All levels of all maps, in the order of the columns.
template <typename Map>
auto levels_of(std::span<Map> maps) {
    std::vector<decltype(&maps[0].level[0])> levels;
    for (Map& map : maps) {
        for (uint32_t i = 0; i < map.level_count; ++i) levels.push_back(&map.level[i]);
    }
    return levels;
}

std::vector<std::byte> write_columns(std::span<const FacadeMapRecord> maps) {
    ColumnWriter columns;
    const size_t count = maps.size();
    columns.add(count, 1, [&](size_t i) { return maps[i].level_count; });
    columns.add(count, 2, [&](size_t i) { return maps[i].width; });
    columns.add(count, 2, [&](size_t i) { return maps[i].height; });
    columns.add(count, 2, [&](size_t i) { return static_cast<uint16_t>(maps[i].depth_min_mm); });
    columns.add(count, 2, [&](size_t i) { return static_cast<uint16_t>(maps[i].depth_max_mm); });
    const auto levels = levels_of(maps);
    uint64_t end = 0;
    columns.add(levels.size(), 4, [&](size_t i) {
        const auto size = static_cast<uint32_t>(levels[i]->end - end);
        end = levels[i]->end;
        return size;
    });
    columns.add(levels.size(), 4, [&](size_t i) { return levels[i]->resident_bytes / 4; });
    columns.add(levels.size(), 2, [&](size_t i) { return levels[i]->texel_cm; });
    columns.add(levels.size(), 2,
                [&](size_t i) { return static_cast<uint32_t>(millimetres(levels[i]->displacement_error)); });
    columns.add(levels.size(), 4, [&](size_t i) { return levels[i]->checksum; });
    return columns.take();
}

/// Fails where the level counts do not add up to the levels that the bytes hold.
Result<std::vector<FacadeMapRecord>> read_columns(std::span<const std::byte> raw, size_t count) {
    std::vector<FacadeMapRecord> maps(count);
    ColumnReader columns(raw);
    uint64_t sum = 0;
    bool counts_fit = true;
    columns.read(count, 1, [&](size_t i, uint32_t value) {
        maps[i].level_count = value;
        sum += value;
        counts_fit = counts_fit && value <= codec::facade::kMostFacadeLevels;
    });
    if (!counts_fit || sum != (raw.size() - count * kMapBytes) / kLevelBytes)
        return defect("the levels of its maps do not add up to those that follow");
    columns.read(count, 2, [&](size_t i, uint32_t value) { maps[i].width = static_cast<uint16_t>(value); });
    columns.read(count, 2, [&](size_t i, uint32_t value) { maps[i].height = static_cast<uint16_t>(value); });
    columns.read(count, 2, [&](size_t i, uint32_t value) { maps[i].depth_min_mm = static_cast<int16_t>(value); });
    columns.read(count, 2, [&](size_t i, uint32_t value) { maps[i].depth_max_mm = static_cast<int16_t>(value); });
    const auto levels = levels_of(std::span(maps));
    uint64_t end = 0;
    columns.read(levels.size(), 4, [&](size_t i, uint32_t value) { levels[i]->end = end += value; });
    columns.read(levels.size(), 4, [&](size_t i, uint32_t value) {
        levels[i]->resident_bytes = value <= kMaxFacadeResidentBytes / 4 ? value * 4 : 0;
    });
    columns.read(levels.size(), 2,
                 [&](size_t i, uint32_t value) { levels[i]->texel_cm = static_cast<uint16_t>(value); });
    columns.read(levels.size(), 2, [&](size_t i, uint32_t value) {
        levels[i]->displacement_error = static_cast<float>(value) * kMetresPerMm;
    });
    columns.read(levels.size(), 4, [&](size_t i, uint32_t value) { levels[i]->checksum = value; });
    return maps;
}

}  // namespace

Status check_facade_maps(std::span<const FacadeMapRecord> maps) {
    if (maps.size() > kMaxFacadeMaps) return defect(fmt::format("{} maps are too many", maps.size()));
    uint64_t end = 0;
    for (size_t i = 0; i < maps.size(); ++i) {
        if (Status status = check_map(maps[i], i, end); !status) return status;
    }
    return Done{};
}

std::vector<std::byte> write_facade_index(std::span<const FacadeMapRecord> maps, Manifest& manifest) {
    const std::vector<std::byte> raw = write_columns(maps);
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
    const uint64_t count = manifest.facade_map_count, decoded = manifest.facade_index_decoded_bytes;
    if (count > kMaxFacadeMaps || decoded < count * kMapBytes || (decoded - count * kMapBytes) % kLevelBytes != 0 ||
        decoded > kFreeBytes + kMaxRatio * frame.size()) {
        return defect(fmt::format("cannot list {} maps in {} bytes", count, decoded));
    }
    if (checksum_of(frame.data(), frame.size()) != manifest.facade_index_checksum)
        return defect("its checksum is wrong");
    const auto raw = codec::bits::decompress_frame(frame, decoded);
    if (!raw) return defect(raw.error().text());
    auto maps = read_columns(*raw, count);
    if (!maps) return maps.error();
    if (Status status = check_facade_maps(*maps); !status) return status.error();
    return maps;
}

}  // namespace citystream::tiles::tileset
