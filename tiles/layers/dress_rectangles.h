// The level rectangles of a wall: where facades fit. Gables, slopes and steps leave the rest to the mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/layers/dress_walls.h"

namespace citystream::tiles::layers {

/// Between two columns of a wall, from z to z in grid units; corners are columns of the wall.
struct LevelRectangle {
    uint32_t left = 0, right = 0;
    int64_t bottom = 0, top = 0;
};

struct RectangleLimits {
    double least_width = 1.5, least_height = 2.2;  ///< metres
};

/// Non-overlapping rectangles inside the wall and outside its hidden parts, largest first, none smaller than the
/// limits. Adds columns where hidden parts end. Empty and false when the outline crosses itself or has too many
/// corners. A corner either is a point of the outline, lies on a level or upright edge of it, or keeps 1 cm off it.
/// O(columns^2) a rectangle; walls with more than 96 columns are refused.
bool level_rectangles(WallRegion& wall, const RectangleLimits& limits, std::vector<LevelRectangle>& rectangles);

}  // namespace citystream::tiles::layers
