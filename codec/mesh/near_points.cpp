#include "codec/mesh/near_points.h"

namespace citystream::codec::mesh {

namespace {
constexpr size_t kFirstSlots = 64;
}

NearPoints::NearPoints(uint32_t cell_bits) : cell_bits_(cell_bits), newest_(kFirstSlots, kNone) {}

// Cubes have a side of at least 2, so that the neighbours of any cube can be numbered.
NearPoints::Cube NearPoints::cube_of(const GridPoint& point) const {
    return {point[0] >> cell_bits_, point[1] >> cell_bits_, point[2] >> cell_bits_};
}

size_t NearPoints::slot_of(const Cube& cube) const {
    uint64_t hash = static_cast<uint32_t>(cube.x) * uint64_t{0x9e3779b97f4a7c15};
    hash = (hash ^ static_cast<uint32_t>(cube.y)) * uint64_t{0xbf58476d1ce4e5b9};
    hash = (hash ^ static_cast<uint32_t>(cube.z)) * uint64_t{0x94d049bb133111eb};
    return (hash >> 32) & (newest_.size() - 1);
}

void NearPoints::grow() {
    newest_.assign(2 * newest_.size(), kNone);
    for (uint32_t i = 0; i < points_.size(); ++i) {
        uint32_t& newest = newest_[slot_of(cube_of(points_[i]))];
        older_[i] = newest;
        newest = i;
    }
}

void NearPoints::add(const GridPoint& point) {
    if (points_.size() >= newest_.size()) grow();
    uint32_t& newest = newest_[slot_of(cube_of(point))];
    points_.push_back(point);
    older_.push_back(newest);
    newest = static_cast<uint32_t>(points_.size() - 1);
}

uint32_t NearPoints::at(const GridPoint& place) const {
    uint32_t index = newest_[slot_of(cube_of(place))];
    for (uint32_t seen = 0; index != kNone && seen < kMostInCube; ++seen, index = older_[index]) {
        if (points_[index] == place) return index;
    }
    return kNone;
}

}  // namespace citystream::codec::mesh
