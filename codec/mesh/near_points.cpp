#include "codec/mesh/near_points.h"

namespace citystream::codec::mesh {

namespace {
constexpr size_t kFirstSlots = 64;
}

NearPoints::NearPoints(uint32_t cell_bits) : cell_bits_(cell_bits), newest_(kFirstSlots, kNone) {}

void NearPoints::grow() {
    newest_.assign(2 * newest_.size(), kNone);
    for (uint32_t i = 0; i < points_.size(); ++i) {
        uint32_t& newest = newest_[slot_of(cube_of(points_[i].place))];
        points_[i].older = newest;
        newest = i;
    }
}

void NearPoints::add(const GridPoint& point) {
    if (points_.size() >= newest_.size()) grow();
    uint32_t& newest = newest_[slot_of(cube_of(point))];
    points_.push_back({point, newest});
    newest = static_cast<uint32_t>(points_.size() - 1);
}

uint32_t NearPoints::at(const GridPoint& place) const {
    uint32_t index = newest_[slot_of(cube_of(place))];
    for (uint32_t seen = 0; index != kNone && seen < kMostInCube; ++seen, index = points_[index].older) {
        const GridPoint& there = points_[index].place;
        if (there[0] == place[0] && there[1] == place[1] && there[2] == place[2]) return index;
    }
    return kNone;
}

}  // namespace citystream::codec::mesh
