// Dresses a city without facades: puts facades of the procedural grammar on the plain vertical walls of buildings, so
// that LoD1 and LoD2 models can be flown through at street level. Everything it adds is made up. The outline of the
// building stays the input's, but that walls which bend by less than a centimetre become straight.
//
// For each building: its style (use and variant) follows from the use and storeys that the input says, else from
// height, footprint and elongation, and from a hash of the seed and the building's id (its colours also from the 512 m
// square it stands in); its upright walls are found by joining coplanar triangles (dress_walls.h); the level rectangles
// that fit in each (dress_rectangles.h) get facades (dress_plan.h, dress_maps.h), and what remains of the wall is
// triangulated again (dress_cut.h). Facades and mesh share their corners on the 2^-10 m grid, so no crack opens. Walls
// in the default colour take that of the facades beside them.
//
// The dictionary stays bounded: floors and widths are quantised (a width is a few bays; the map is stretched by at
// most kMostStretch), and styles are few, so distinct maps grow like the variety of walls and not like the city.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "tiles/city/city_model.h"

namespace citystream::tiles::layers {

/// What was dressed, and why walls were not. Walls are counted as regions: coplanar triangles joined.
struct DressReport {
    uint64_t buildings = 0;             ///< objects looked at that are buildings
    uint64_t dressed_buildings = 0;     ///< of these, with a facade added
    uint64_t facades = 0;               ///< added
    std::array<uint64_t, 6> by_use{};   ///< dressed buildings: house, row house, apartment, tower, hall, garage
    uint64_t walls = 0;                 ///< vertical wall regions found
    uint64_t walls_small = 0;           ///< left: narrower or lower than a facade may be
    uint64_t walls_curved = 0;          ///< left: short facet of a curved or finely cut wall
    uint64_t walls_shared = 0;          ///< left: another wall of the same object lies on it
    uint64_t walls_degenerate = 0;      ///< left: the outline crosses itself or has too many corners
    uint64_t hidden_by_neighbours = 0;  ///< facades made plain again because other buildings stand against them
    uint64_t pictures_covered = 0;      ///< dressed although they carried a picture of the real wall
    uint64_t maps = 0;                  ///< distinct specifications in the dictionary
    double facade_area = 0;             ///< square metres of the facades added
    double wall_area = 0;               ///< square metres of the wall regions found
};

/// Call from one thread at a time; the result does not depend on the order of objects but for the numbers of maps in
/// the catalog.
class Dresser {
  public:
    /// Adds nothing to the catalog before the first facade: then the grammar's materials and palettes, once.
    /// `catalog` must outlive the dresser.
    Dresser(uint64_t seed, city::CityCatalog& catalog);
    ~Dresser();
    Dresser(const Dresser&) = delete;
    Dresser& operator=(const Dresser&) = delete;

    /// Replaces walls of a building by facades; leaves other objects as they are, and buildings that carry facades or
    /// have windows and doors of their own.
    /// Never fails: a wall that cannot be understood stays as it is. O(triangles log triangles).
    void dress(city::CityObject& object);

    DressReport report() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace citystream::tiles::layers
