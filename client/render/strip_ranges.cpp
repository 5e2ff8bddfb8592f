#include "client/render/strip_ranges.h"

#include "codec/mesh/mesh_resident_layout.h"

namespace citystream::client {

void StripRanges::learn(LayerId layer, std::span<const uint32_t> words) {
    if (words.size() < RESIDENT_HEADER_WORDS || words[RESIDENT_WORD_MAGIC] != RESIDENT_MAGIC) return;
    for (uint64_t range = 0; range < words[RESIDENT_WORD_RANGES]; ++range) {
        const uint64_t at = RESIDENT_HEADER_WORDS + range * RESIDENT_RANGE_WORDS;
        if (at + RESIDENT_RANGE_WORDS > words.size()) return;
        if ((words[at + RESIDENT_RANGE_KIND] & 255u) != RESIDENT_KIND_STRIP_CODE) continue;
        const uint32_t begin = words[at + RESIDENT_RANGE_TOPOLOGY], count = words[at + RESIDENT_RANGE_TOPOLOGY_WORDS];
        if (uint64_t{begin} + count > words.size()) continue;
        const auto header = codec::mesh::read_strip_header(words.subspan(begin, count));
        if (header) headers_.insert_or_assign({layer, begin}, *header);
    }
}

void StripRanges::forget(LayerId layer) {
    arena_.forget(layer);
    headers_.erase(headers_.lower_bound({layer, 0}), headers_.lower_bound({layer + 1, 0}));
}

Result<size_t> StripRanges::add(const TileDraw& tile, VkDeviceAddress mesh, bool draws_dressed) {
    const size_t first = ranges_.size();
    for (const codec::mesh::MeshRange& range : tile.mesh_ranges) {
        if (range.kind != RESIDENT_KIND_STRIP_CODE || (range.dressed && !draws_dressed)) continue;
        const auto header = headers_.find({tile.mesh, range.topology_begin});
        if (header == headers_.end()) return Error{"a range of strip code where its layer has none"};
        ranges_.push_back({tile.mesh, {mesh, range.topology_begin, header->second}});
    }
    return first;
}

Status StripRanges::plan() {
    const auto places = arena_.plan_frame(ranges_);
    if (!places) return places.error();
    places_.clear();
    for (const ArenaPlace& place : *places)
        places_.push_back({place.round, arena_.corners().address + uint64_t{4} * place.first_corner});
    return Done{};
}

}  // namespace citystream::client
