// Facade relief as triangles: what the ray caster of the facade layer draws, for the reference and for tests.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::tiles::layers {

/// Facade space in metres: x along the wall, y up, z outwards; texture coordinates are (x, -y) in metres (glTF: v
/// downwards).
struct ReliefPart {
    std::vector<std::array<float, 3>> positions, normals;
    std::vector<std::array<float, 2>> texcoords;
    std::vector<uint32_t> indices;  ///< counter-clockwise from outside
};

/// Parts by material slot: one rectangle for each largest run of equal cells (greedy), and side faces between depths
/// (label of the higher cell). At the map's border and beside open cells side faces reach down to its least
/// displacement; open cells have no front. Triangles may meet in T-junctions.
std::map<uint32_t, ReliefPart> make_relief(const codec::facade::RunGrid& map);

}  // namespace citystream::tiles::layers
