#include "client/select/facade_dictionary.h"

#include <algorithm>

namespace citystream::client {

using tiles::tileset::FacadeLevelRecord;
using tiles::tileset::FacadeMapRecord;

namespace {

uint32_t level_for(const FacadeMapRecord& record, const MapDemand& demand) {
    const uint32_t finest = record.level_count - 1;
    if (demand.level) return std::min(*demand.level, finest);
    for (uint32_t level = 0; level < finest; ++level) {
        if (record.level[level].texel_cm * 0.01 <= demand.texel_metres) return level;
    }
    return finest;
}

}  // namespace

void FacadeDictionary::learn(std::vector<FacadeMapRecord> maps) {
    learn(std::make_shared<const std::vector<FacadeMapRecord>>(std::move(maps)));
}

void FacadeDictionary::learn(SharedMaps maps) {
    maps_ = std::move(maps);
    broken_levels_.assign(size(), 0);
    opaque_levels_.assign(size(), 0);
    learnt_bytes_.clear();
    ++changes_;
}

uint64_t FacadeDictionary::begin(MapPiece piece) const {
    if (level_of(piece) > 0) return record_of(piece - 1).end;
    return map_of(piece) == 0 ? 0 : record(map_of(piece) - 1).levels().back().end;
}

MapPiece FacadeDictionary::next(MapPiece piece) const {
    return level_of(piece) + 1 < record(map_of(piece)).level_count ? piece + 1 : map_piece(map_of(piece) + 1, 0);
}

uint64_t FacadeDictionary::resident_bytes(MapPiece piece) const {
    return size_learnt(piece) ? learnt_bytes_[piece] : record_of(piece).resident_bytes;
}

void FacadeDictionary::learn_size(MapPiece piece, uint64_t bytes) {
    if (learnt_bytes_.empty()) learnt_bytes_.assign(map_piece(static_cast<uint32_t>(size()), 0), 0);
    if (learnt_bytes_[piece] == bytes) return;
    learnt_bytes_[piece] = bytes;
    ++changes_;
}

void FacadeDictionary::set_usable(MapPiece piece, bool usable) {
    uint8_t& broken = broken_levels_[map_of(piece)];
    const auto bit = static_cast<uint8_t>(1u << level_of(piece));
    broken = static_cast<uint8_t>(usable ? broken & ~bit : broken | bit);
    ++changes_;
}

void FacadeDictionary::learn_opaque(MapPiece piece) {
    uint8_t& opaque = opaque_levels_[map_of(piece)];
    opaque = static_cast<uint8_t>(opaque | 1u << level_of(piece));
}

bool FacadeDictionary::has_usable_level(uint32_t map) const {
    const uint32_t all = (1u << record(map).level_count) - 1;
    return (broken_levels_[map] & all) != all;
}

std::optional<MapPiece> FacadeDictionary::wanted(uint32_t map, const MapDemand& demand) const {
    if (map >= size()) return std::nullopt;
    const uint32_t best = level_for(record(map), demand);
    for (uint32_t below = 0; below <= best; ++below) {
        if (usable(map_piece(map, best - below))) return map_piece(map, best - below);
    }
    for (uint32_t level = best + 1; level < record(map).level_count; ++level) {
        if (usable(map_piece(map, level))) return map_piece(map, level);
    }
    return std::nullopt;
}

uint64_t FacadeDictionary::host_bytes() const {
    return size() * (sizeof(FacadeMapRecord) + sizeof(broken_levels_[0]) + sizeof(opaque_levels_[0])) +
           learnt_bytes_.size() * sizeof(learnt_bytes_[0]);
}

}  // namespace citystream::client
