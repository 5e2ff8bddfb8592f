// The flat upright wall regions of one object: triangles joined over shared edges as long as they stay in one plane,
// their outlines on the grid, and which parts of a wall another wall of the same object hides.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/grid.h"
#include "tiles/city/city_model.h"

namespace citystream::tiles::layers {

/// A point of a wall's outline: a place on the ground line (index in WallRegion::columns) and a height.
struct WallPoint {
    uint32_t column = 0;
    int64_t z = 0;
    friend auto operator<=>(const WallPoint&, const WallPoint&) = default;
};

struct WallEdge {
    WallPoint from, to;
    friend auto operator<=>(const WallEdge&, const WallEdge&) = default;
};

/// Part of a wall that nobody sees, metres along the wall and grid units of height.
struct HiddenPart {
    double left = 0, right = 0;
    int64_t bottom = 0, top = 0;
};

struct WallRegion {
    std::vector<uint32_t> triangles;  ///< indices in CityObject::triangles; the first is the largest
    std::vector<std::array<int64_t, 2>>
        columns;                    ///< x, y of the outline's points, from left to right as seen from outside
    std::vector<double> along;      ///< metres of each column from the first, never falling
    std::vector<WallEdge> outline;  ///< directed, the wall on the left seen from outside
    std::vector<HiddenPart> hidden;

    double width() const { return along.back(); }
    /// Unit vector to the right; the outward normal is (direction.y, -direction.x).
    city::Vec2 direction() const;
};

/// An object on the grid, as far as dressing needs it.
struct GridObject {
    std::vector<GridPoint> points;  ///< of CityObject::vertices
    int64_t bottom = 0, top = 0;
};

/// Fails (false) when a coordinate is no number or the object is wider than 60 km: nothing to dress.
bool put_on_grid(const city::CityObject& object, GridObject& out);

struct WallSearch {
    std::vector<WallRegion> walls;
    uint64_t tangled = 0;  ///< regions whose outline is none (doubled triangles)
};

/// Regions at most kFlatness off their plane, of triangles whose kind is wall or unknown. Hidden parts are left empty.
/// O(triangles log triangles).
WallSearch find_walls(const city::CityObject& object, const GridObject& grid);

/// How far, in grid units, a point may lie off the plane of its wall: 1 cm.
inline constexpr double kFlatness = 10;

/// The part of a wall between two neighbouring columns, one piece of it: from a lower edge to an upper edge.
struct WallSlice {
    std::array<double, 2> bottom{}, top{};              ///< grid units, at the left and right column
    std::array<bool, 2> bottom_corner{}, top_corner{};  ///< whether the outline has a point there
};

/// Slices column by column. False when the outline crosses itself. O(edges x columns); regions where that exceeds
/// kMostSliceWork are refused, too.
bool slice_wall(const WallRegion& wall, std::vector<std::vector<WallSlice>>& slices);

/// Adds a column at the place `metres` along, unless one is within 2 cm of it; returns its index. Points of the
/// outline keep theirs.
uint32_t add_column(WallRegion& wall, double metres);

/// Fills `hidden` of walls that lie on another wall of the object which looks the other way, within 5 cm.
/// Looks at no more than 400 pairs a wall.
void find_hidden_parts(std::span<WallRegion> walls);

/// Least angle of a wall's turn towards its neighbours left and right, radians; pi where it has none.
struct WallTurn {
    double left = 0, right = 0;
};
/// For all walls: how sharply the outline turns at their ends. O(walls log walls).
std::vector<WallTurn> wall_turns(std::span<const WallRegion> walls);

}  // namespace citystream::tiles::layers
