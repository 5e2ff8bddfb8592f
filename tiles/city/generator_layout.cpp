#include "tiles/city/generator_layout.h"

#include <algorithm>
#include <array>

namespace citystream::tiles::city::procedural {
namespace {

constexpr Units kPitch[2] = {88 * kMetre, 72 * kMetre};
constexpr int kJitterSteps[2] = {4, 2};  // of 2 m, either way
constexpr int64_t kLeastRadius = 70;     // metres; a hamlet has no centre
constexpr Units kGroundStep = 32 * kMetre;

constexpr uint64_t kStreetSalt = 0x51, kMergeSalt = 0x52, kZoneSalt = 0x53, kBlockSalt = 0x54, kHillSalt = 0x55;

int index(Axis axis) {
    return axis == Axis::kX ? 0 : 1;
}

/// Value noise on a lattice of 2^shift units, -2^15..2^15, smooth across the lattice.
int64_t value_noise(uint64_t seed, Units x, Units y, int shift) {
    const int64_t cx = x >> shift, cy = y >> shift;
    const auto weight = [shift](Units offset) {  // 0..2^15
        const int64_t t = offset >> (shift - 15);
        return (t * t >> 15) * (3 * 32768 - 2 * t) >> 15;
    };
    const Units mask = (Units{1} << shift) - 1;
    const int64_t tx = weight(x & mask), ty = weight(y & mask);
    const auto lattice = [seed](int64_t i, int64_t j) {
        return static_cast<int64_t>(hash(seed, i, j) & 0xFFFF) - 32768;
    };
    const int64_t low = lattice(cx, cy) * (32768 - tx) + lattice(cx + 1, cy) * tx;
    const int64_t high = lattice(cx, cy + 1) * (32768 - tx) + lattice(cx + 1, cy + 1) * tx;
    return ((low >> 15) * (32768 - ty) + (high >> 15) * ty) >> 15;
}

Units integer_root(int64_t square) {
    int64_t root = 0;
    for (int64_t bit = int64_t{1} << 31; bit > 0; bit >>= 1)
        if ((root + bit) * (root + bit) <= square) root += bit;
    return root;
}

}  // namespace

Quarter quarter_at(uint64_t number) {
    if (number == 0) return {0, 0};
    const auto n = static_cast<int64_t>(number);
    const int64_t ring = (integer_root(n) + 1) / 2;
    const int64_t at = n - (2 * ring - 1) * (2 * ring - 1);
    const int64_t along = at % (2 * ring);
    switch (at / (2 * ring)) {
        case 0:
            return {ring, -ring + 1 + along};
        case 1:
            return {ring - 1 - along, ring};
        case 2:
            return {-ring, ring - 1 - along};
        default:
            return {-ring + 1 + along, -ring};
    }
}

uint64_t number_of(Quarter quarter) {
    const int64_t i = quarter.i, j = quarter.j;
    const int64_t ring = std::max(std::max(i, -i), std::max(j, -j));
    if (ring == 0) return 0;
    const int64_t first = (2 * ring - 1) * (2 * ring - 1);
    if (i == ring && j > -ring) return static_cast<uint64_t>(first + j + ring - 1);
    if (j == ring) return static_cast<uint64_t>(first + 2 * ring + ring - 1 - i);
    if (i == -ring) return static_cast<uint64_t>(first + 4 * ring + ring - 1 - j);
    return static_cast<uint64_t>(first + 6 * ring + i + ring - 1);
}

CityPlan::CityPlan(uint64_t seed, uint32_t buildings) : seed_(seed) {
    // About 1,900 buildings a square kilometre: 526 m2 each.
    const int64_t side = integer_root(int64_t{526} * buildings);
    radius_ = std::max<int64_t>(kLeastRadius, side / 2) * kMetre;
}

StreetLine CityPlan::line(Axis axis, int64_t line) const {
    const int a = index(axis);
    Random random(hash(seed_ ^ kStreetSalt, a, line));
    StreetLine street;
    street.main = line % 4 == 0;
    street.axis = line * kPitch[a] + random.between(-kJitterSteps[a], kJitterSteps[a]) * 2 * kMetre;
    street.carriage_half = street.main ? units_of_cm(750) : units_of_cm(350);
    street.outer_half = (street.main ? 12 : 6) * kMetre;
    return street;
}

StreetPlace CityPlan::place(Axis axis, Units at) const {
    int64_t block = floor_div(at, kPitch[index(axis)]);
    if (line(axis, block).axis > at) --block;
    if (line(axis, block + 1).axis <= at) ++block;
    for (int64_t candidate : {block, block + 1}) {
        const StreetLine street = line(axis, candidate);
        const Units off = at < street.axis ? street.axis - at : at - street.axis;
        if (off < street.carriage_half) return {StreetPlace::Part::kCarriageway, candidate, candidate};
        if (off < street.outer_half) return {StreetPlace::Part::kPavement, candidate, candidate};
    }
    return {StreetPlace::Part::kBlock, 0, block};
}

std::vector<Units> CityPlan::breaks(Axis axis, Units low, Units high) const {
    std::vector<Units> found = {low, high};
    for (Units at = floor_div(low, kGroundStep) * kGroundStep + kGroundStep; at < high; at += kGroundStep)
        found.push_back(at);
    const Units pitch = kPitch[index(axis)];
    for (int64_t i = floor_div(low, pitch) - 1; i <= floor_div(high, pitch) + 2; ++i) {
        const StreetLine street = line(axis, i);
        for (Units edge : {street.axis - street.outer_half, street.axis - street.carriage_half,
                           street.axis + street.carriage_half, street.axis + street.outer_half})
            if (edge > low && edge < high) found.push_back(edge);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

CityPlan::Merge CityPlan::merge(Quarter quarter) const {
    Random random(hash(seed_ ^ kMergeSalt, quarter.i, quarter.j));
    if (random.chance(50)) return Merge::kNone;
    const auto merged = static_cast<Merge>(1 + random.below(6));
    if (merged < Merge::kAlongY0) return merged;
    // Blocks of two rows of houses must not become twice as deep.
    for (int64_t x : {2 * quarter.i, 2 * quarter.i + 1}) {
        const Zone zone = raw_zone(x, 2 * quarter.j);
        if (zone == Zone::kRows || zone == Zone::kDetached) return Merge::kNone;
    }
    return merged;
}

bool CityPlan::closed(Axis axis, int64_t line, int64_t along) const {
    if (line % 2 == 0) return false;
    const bool second = floor_div(along, 2) * 2 != along;
    const Quarter quarter = axis == Axis::kX ? Quarter{floor_div(line, 2), floor_div(along, 2)}
                                             : Quarter{floor_div(along, 2), floor_div(line, 2)};
    const Merge merged = merge(quarter);
    if (axis == Axis::kX) return merged == Merge::kAlongXBoth || merged == (second ? Merge::kAlongX1 : Merge::kAlongX0);
    return merged == Merge::kAlongYBoth || merged == (second ? Merge::kAlongY1 : Merge::kAlongY0);
}

Block CityPlan::block(int64_t x_first, int64_t x_last, int64_t y_first, int64_t y_last) const {
    const StreetLine west = line(Axis::kX, x_first), east = line(Axis::kX, x_last + 1);
    const StreetLine south = line(Axis::kY, y_first), north = line(Axis::kY, y_last + 1);
    Block block;
    block.x0 = west.axis + west.outer_half;
    block.x1 = east.axis - east.outer_half;
    block.y0 = south.axis + south.outer_half;
    block.y1 = north.axis - north.outer_half;
    block.zone = raw_zone(x_first, y_first);
    block.seed = hash(seed_ ^ kBlockSalt, x_first, y_first);
    return block;
}

std::vector<Block> CityPlan::blocks(Quarter quarter) const {
    const int64_t x = 2 * quarter.i, y = 2 * quarter.j;
    std::vector<Block> found;
    for (int64_t by = y; by < y + 2; ++by) {
        for (int64_t bx = x; bx < x + 2; ++bx) {
            const bool wide = closed(Axis::kX, x + 1, by), deep = closed(Axis::kY, y + 1, bx);
            if ((wide && bx > x) || (deep && by > y)) continue;
            found.push_back(block(bx, wide ? x + 1 : bx, by, deep ? y + 1 : by));
        }
    }
    return found;
}

Zone CityPlan::zone_of(int64_t block_x, int64_t block_y) const {
    const int64_t x = floor_div(block_x, 2) * 2, y = floor_div(block_y, 2) * 2;
    return raw_zone(closed(Axis::kX, x + 1, block_y) ? x : block_x, closed(Axis::kY, y + 1, block_x) ? y : block_y);
}

Zone CityPlan::raw_zone(int64_t block_x, int64_t block_y) const {
    Random random(hash(seed_ ^ kZoneSalt, block_x, block_y));
    // Distance from the middle of the quarter in the centre, in thousandths of the radius, frayed.
    const Units dx = (2 * block_x - 1) * kPitch[0] / 2, dy = (2 * block_y - 1) * kPitch[1] / 2;
    const int64_t far = integer_root(dx * dx + dy * dy);
    const int64_t t = far * 1000 / radius_ + random.between(-90, 90);
    if (random.chance(5) && radius_ > 2 * kLeastRadius * kMetre) return Zone::kPark;
    if (radius_ == kLeastRadius * kMetre) return Zone::kDetached;
    // Industry keeps to one side of the city, downwind of the rest.
    const auto side = hash(seed_ ^ kZoneSalt, 1, 2, 3) & 3;
    const Units out = side == 0 ? dx : side == 1 ? dy : side == 2 ? -dx : -dy;
    const Units across = (side & 1) == 0 ? dy : dx;
    if (out * 100 > radius_ * 58 && across * across < radius_ * radius_ / 3 && random.chance(70))
        return Zone::kIndustry;
    if (far < 600 * kMetre && t < 260) return Zone::kTowers;
    if (t < 640) return random.chance(4) ? Zone::kTowers : Zone::kPerimeter;
    if (t < 840) return random.chance(25) ? Zone::kPerimeter : Zone::kRows;
    return random.chance(25) ? Zone::kRows : Zone::kDetached;
}

Units CityPlan::terrain(Units x, Units y) const {
    const int64_t hills = value_noise(seed_ ^ kHillSalt, x, y, 19);        // 512 m
    const int64_t rolls = value_noise(seed_ ^ (kHillSalt + 1), x, y, 17);  // 128 m
    return (hills * 9 * kMetre + rolls * kMetre) >> 15;
}

Units CityPlan::ground(Units x, Units y) const {
    const auto enclosing = [this](Axis axis, Units at) {
        const Units low = floor_div(at, kGroundStep) * kGroundStep;
        const std::vector<Units> cuts = breaks(axis, low, low + kGroundStep);
        const auto above = std::upper_bound(cuts.begin(), cuts.end() - 1, at);
        return std::array<Units, 2>{*(above - 1), *above};
    };
    const auto [x0, x1] = enclosing(Axis::kX, x);
    const auto [y0, y1] = enclosing(Axis::kY, y);
    const Units z00 = terrain(x0, y0), z10 = terrain(x1, y0), z01 = terrain(x0, y1), z11 = terrain(x1, y1);
    const Units u = x - x0, v = y - y0, w = x1 - x0, h = y1 - y0;
    // The quad is cut from its lower left to its upper right corner.
    if (u * h >= v * w) return z00 + floor_div((z10 - z00) * u, w) + floor_div((z11 - z10) * v, h);
    return z00 + floor_div((z01 - z00) * v, h) + floor_div((z11 - z01) * u, w);
}

}  // namespace citystream::tiles::city::procedural
