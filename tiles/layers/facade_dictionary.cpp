#include "tiles/layers/facade_dictionary.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/facade/facade_levels.h"
#include "codec/facade/facade_wire.h"
#include "tiles/layers/build_stage.h"
#include "tiles/tileset/facade_index.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::FacadeLevel;
using tileset::FacadeLevelRecord;
using tileset::FacadeMapRecord;

constexpr size_t kCopiedBytes = size_t{4} << 20;

/// One map, coded: ends of the levels count from its own begin.
struct CodedMap {
    FacadeMapRecord record;
    std::vector<std::byte> bytes;
};

struct CodedLevel {
    const FacadeLevel* level;
    codec::facade::ShippedMap shipped;
};

/// From the exact level to coarser ones, without those that save too little.
std::vector<CodedLevel> worthwhile_levels(const std::vector<FacadeLevel>& levels) {
    std::vector<CodedLevel> kept;
    for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
        CodedLevel coded{&*level, codec::facade::encode_shipped_map(level->grid)};
        if (!kept.empty() && static_cast<double>(coded.shipped.wire.size()) >
                                 kMostLevelShare * static_cast<double>(kept.back().shipped.wire.size()))
            continue;
        kept.push_back(std::move(coded));
    }
    return kept;
}

CodedMap code_map(const codec::facade::RunGrid& grid, double texel_metres) {
    CodedMap map;
    map.record.width = static_cast<uint16_t>(grid.width());
    map.record.height = static_cast<uint16_t>(grid.height());
    const codec::facade::DepthRange depths = grid.depths();
    map.record.depth_min_mm = static_cast<int16_t>(depths.min_mm);
    map.record.depth_max_mm = static_cast<int16_t>(depths.max_mm);
    const std::vector<FacadeLevel> levels = codec::facade::make_levels(grid, texel_metres);
    std::vector<CodedLevel> coded = worthwhile_levels(levels);
    std::reverse(coded.begin(), coded.end());
    for (const CodedLevel& level : coded) {
        const std::vector<std::byte>& wire = level.shipped.wire;
        map.bytes.insert(map.bytes.end(), wire.begin(), wire.end());
        FacadeLevelRecord& record = map.record.level[map.record.level_count++];
        record.end = map.bytes.size();
        record.resident_bytes = static_cast<uint32_t>(4 * level.shipped.words.size());
        record.checksum = static_cast<uint32_t>(tileset::checksum_of(wire.data(), wire.size()));
        record.texel_cm = static_cast<uint16_t>(level.level->texel_cm);
        record.displacement_error = level.level->displacement_error;
    }
    return map;
}

/// Ends of maps, each counted from its own begin, to ends in the entry.
void add_up(std::vector<FacadeMapRecord>& records) {
    uint64_t begin = 0;
    for (FacadeMapRecord& map : records) {
        for (uint32_t i = 0; i < map.level_count; ++i) map.level[i].end += begin;
        begin = map.level[map.level_count - 1].end;
    }
}

}  // namespace

Result<EncodedFacades> EncodedFacades::encode(const FacadeNumbers& numbers, const city::FacadeCatalog& catalog,
                                              const BuildOptions& options, quadtree::SpoolFile& spool) {
    EncodedFacades facades;
    const size_t count = numbers.maps.size();
    facades.records_.resize(count);
    facades.offsets_.resize(count);
    // What is first ready is first in the spool.
    Status status = BuildStage(options, "facades", count).run(count, [&](size_t i) -> Status {
        const uint32_t stored = numbers.maps[i];
        const CodedMap map = code_map(catalog.map(stored), catalog.texel_metres(stored));
        facades.records_[i] = map.record;
        const auto range = spool.append(map.bytes);
        if (!range) return range.error();
        facades.offsets_[i] = range->offset;
        return Done{};
    });
    if (!status) return status.error();
    add_up(facades.records_);
    if (status = tileset::check_facade_maps(facades.records_); !status)
        return Error{"the facade dictionary cannot be listed: " + status.error().text()};
    return facades;
}

Status EncodedFacades::write_entry(archive::ArchiveWriter& writer, quadtree::SpoolFile& spool) const {
    if (records_.empty()) return Done{};
    if (Status status = writer.begin_entry(tileset::kFacadeMapsPath); !status) return status;
    std::vector<std::byte> bytes;
    uint64_t begin = 0;
    for (size_t i = 0; i < records_.size(); ++i) {
        const uint64_t end = records_[i].levels().back().end;
        if (Status status = spool.read({offsets_[i], end - begin}, bytes); !status) return status;
        begin = end;
        if (bytes.size() < kCopiedBytes && i + 1 < records_.size()) continue;
        if (Status status = writer.append(bytes); !status) return status;
        bytes.clear();
    }
    return writer.end_entry();
}

}  // namespace citystream::tiles::layers
