// The plan of the generated city: street lines, blocks, zones, heights of the ground. All in integers on the global
// grid, relative to the city's origin.
//
// Streets are lines x = const and y = const of varying distance and width; every fourth is a main street. Four blocks
// between lines of even index make a quarter, in which neighbouring blocks may be merged (the street between them
// vanishes). Quarters are numbered along a square spiral from the centre, so a city of any size is the first so many
// quarters and stays about square.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/city/generator_random.h"

namespace citystream::tiles::city::procedural {

using Units = int64_t;  ///< 2^-10 m
inline constexpr Units kMetre = 1024;
constexpr Units units_of_cm(int cm) {
    return static_cast<Units>(cm) * kMetre / 100;
}

constexpr int64_t floor_div(int64_t a, int64_t b) {
    return a / b - (a % b != 0 && (a < 0) != (b < 0) ? 1 : 0);
}

enum class Axis : uint8_t { kX, kY };

struct StreetLine {
    Units axis = 0;           ///< the coordinate of its middle
    Units carriage_half = 0;  ///< middle to kerb
    Units outer_half = 0;     ///< middle to the block's edge
    bool main = false;
};

enum class Zone : uint8_t { kTowers, kPerimeter, kRows, kDetached, kIndustry, kPark, kMeadow };

struct Quarter {
    int64_t i = 0, j = 0;
};

struct Block {
    Units x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< inside the pavements
    Zone zone = Zone::kMeadow;
    uint64_t seed = 0;
    Units width() const { return x1 - x0; }
    Units height() const { return y1 - y0; }
};

/// Where a coordinate lies among the street lines of one axis.
struct StreetPlace {
    enum class Part : uint8_t { kCarriageway, kPavement, kBlock };
    Part part = Part::kBlock;
    int64_t line = 0;  ///< the street line, when not kBlock
    int64_t block =
        0;  ///< the block between lines `block` and `block` + 1; on a street the one whose lower line this is
};

/// The quarter with this number on the spiral, and back.
Quarter quarter_at(uint64_t number);
uint64_t number_of(Quarter quarter);

class CityPlan {
  public:
    CityPlan(uint64_t seed, uint32_t buildings);

    uint64_t seed() const { return seed_; }
    StreetLine line(Axis axis, int64_t index) const;
    StreetPlace place(Axis axis, Units at) const;
    /// Coordinates in (low, high) where the ground's surface may change along this axis, with `low` and `high`: sorted,
    /// each once.
    std::vector<Units> breaks(Axis axis, Units low, Units high) const;

    /// The blocks of a quarter, one to four.
    std::vector<Block> blocks(Quarter quarter) const;
    /// The zone of the block between these lines, as if its quarter were built.
    Zone zone_of(int64_t block_x, int64_t block_y) const;
    /// Whether the street of odd index `line` is closed beside block `along` of the other axis, by merged blocks.
    bool closed(Axis axis, int64_t line, int64_t along) const;

    /// The smooth height of the ground.
    Units terrain(Units x, Units y) const;
    /// The height of the triangulated ground: linear over the triangles that the terrain cells are made of.
    Units ground(Units x, Units y) const;

  private:
    enum class Merge : uint8_t { kNone, kAlongX0, kAlongX1, kAlongXBoth, kAlongY0, kAlongY1, kAlongYBoth };
    Merge merge(Quarter quarter) const;
    Zone raw_zone(int64_t block_x, int64_t block_y) const;
    Block block(int64_t x_first, int64_t x_last, int64_t y_first, int64_t y_last) const;

    uint64_t seed_;
    Units radius_;  ///< about half the city's side
};

}  // namespace citystream::tiles::city::procedural
