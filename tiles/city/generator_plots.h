// From blocks to plots: which buildings and trees stand where in a block. Decides everything about a building but its
// geometry.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tiles/city/generator_layout.h"
#include "tiles/city/grammar_facades.h"

namespace citystream::tiles::city::procedural {

struct Point2 {
    Units x = 0, y = 0;
};

/// A local frame on the grid: x along a building's front, y into its depth. Rotations are Pythagorean (cos = c / h, sin
/// = s / h).
struct Frame {
    Point2 corner;
    int64_t c = 1, s = 0, h = 1;
    /// The grid point nearest to a local one. Frames that were turned round to the same local point, so corners stay
    /// welded.
    Point2 at(Units x, Units y) const;
    /// The frame of the same rectangle (`width` along x) seen from its right side.
    Frame turned(Units width) const;

    Point2 offset;          ///< set by turned()
    int quarter_turns = 0;  ///< set by turned()
};

enum class WallRole : uint8_t { kFront, kRear, kSide, kParty };
enum class RoofShape : uint8_t { kGable, kCrossGable, kHip, kFlat, kSawtooth };

/// Sides are numbered front, right, rear, left.
struct BuildingPlan {
    FacadeUse use = FacadeUse::kHouse;
    Frame frame;
    Units width = 0, depth = 0;  ///< multiples of 25 cm
    std::array<WallRole, 4> walls{};
    int floors = 1;  ///< of towers: storeys over all sections
    int variant = 0;
    bool shop = false;
    RoofShape roof = RoofShape::kGable;
    int garage_side = 0;  ///< -1 left, 1 right, 0 none
    uint64_t seed = 0;    ///< for what the mesh decides: palette, chimney, dormers
};

struct TreePlan {
    Point2 at;
    uint64_t seed = 0;
};

struct BlockPlan {
    std::vector<BuildingPlan> buildings;
    std::vector<TreePlan> trees;
};

BlockPlan plan_block(const Block& block);

inline constexpr Units kGarageWidth = 350 * kMetre / 100, kGarageDepth = 6 * kMetre, kGarageSetback = kMetre;

}  // namespace citystream::tiles::city::procedural
