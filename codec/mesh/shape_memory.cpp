#include "codec/mesh/shape_memory.h"

namespace citystream::codec::mesh {

namespace {

uint64_t shape_key(const GatePlaces& g, uint32_t tolerance) {
    uint64_t key = 0;
    for (size_t k = 0; k < 3; ++k) {
        for (const int64_t side : {int64_t{g.b[k]} - g.a[k], int64_t{g.c[k]} - g.a[k]}) {
            const int64_t rounded = (side + (int64_t{1} << tolerance >> 1)) >> tolerance;
            key = (key ^ static_cast<uint64_t>(rounded)) * 0x9e3779b97f4a7c15;
            key ^= key >> 29;
        }
    }
    return key;
}

}  // namespace

std::optional<ShapeMemory::Recalled> ShapeMemory::recall(const GatePlaces& g) {
    for (size_t k = 0; k < 3; ++k) centre_[k] = (double{1} * g.a[k] + g.b[k] + g.c[k]) / 3;
    keys_ = {shape_key(g, kFine), shape_key(g, kCoarse)};
    for (size_t i = 0; i < keys_.size(); ++i) {
        const auto known = memories_[i].find(keys_[i]);
        if (known == memories_[i].end()) continue;
        Recalled recalled{centre_, i == 0};
        for (size_t k = 0; k < 3; ++k) recalled.place[k] += known->second[k];
        return recalled;
    }
    return std::nullopt;
}

void ShapeMemory::remember(const GridPoint& apex) {
    Vector from_centre{};
    for (size_t k = 0; k < 3; ++k) from_centre[k] = apex[k] - centre_[k];
    for (size_t i = 0; i < keys_.size(); ++i) memories_[i][keys_[i]] = from_centre;
}

}  // namespace citystream::codec::mesh
