// How coarse the atlas of each tree level is, how many mips and how much border it keeps, and which level a view asks
// for; the same for terrain images.
//
// Source: "Space-Optimized Texture Atlases" 8.2.1 (level law, Table 2), 8.2.2 (Equation 5), 8.2.3 (terrain), as
// corrected in the notes: levels count from the leaf, 0; viewport side and field of view are of one axis (the paper
// takes the width and the vertical field of view); a view from within a box asks for the leaf; the vertical component
// that scales terrain is that of a unit vector.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::atlas {

enum class MipRule : uint8_t {
    kPaper,  ///< log2(factor) - 1 mips: the last halving before the next level is left to aliasing (pitfall 9)
    kFull,   ///< log2(factor) mips: every level can be minified as far as the next level's texels
};

/// Each level's texels are `factor` times as long as those of the level below it.
struct LevelLaw {
    double finest = 0.05;  ///< metres per texel of the leaves (level 0)
    double factor = 8;     ///< > 1
    uint32_t levels = 3;   ///< of the tree: the root is level levels - 1
    MipRule rule = MipRule::kPaper;

    /// lambda: factor^level * finest, metres per texel.
    double metres_per_texel(uint32_t level) const;
    /// M: mips besides the finest; 0 at the root, else by the rule, rounded down, at most kMostMips (chart_border.h).
    uint32_t mips(uint32_t level) const;
    /// Equation 3 for mips(level).
    uint32_t border(uint32_t level) const;
};

/// Refuses numbers that are not finite or out of range (finest > 0, 1 < factor <= 256, 1..16 levels).
Status check_law(const LevelLaw& law);

/// Table 2: 0.05, 0.4 and 3.2 metres per texel; mips 2, 2, 0; borders 2, 2, 0.
LevelLaw thesis_law();

/// Nodes of a full quadtree: sum of 4^i for i = 0..depth. Saturates.
uint64_t full_tree_nodes(uint32_t depth);

/// One axis of a viewport.
struct ViewAxis {
    double pixels = 0;         ///< its side
    double field_of_view = 0;  ///< along the same side, radians, 0..pi
};

/// The axis across that belongs to a vertical field of view: tan(fov_x / 2) = tan(fov_y / 2) * width / height.
ViewAxis horizontal_axis(double width, double height, double vertical_field_of_view);

/// Equation 5: pixels that `metres` seen square on at a distance cover, metres * pixels / (2 d tan(fov / 2)). Infinite
/// for d <= 0.
double screen_projection(double metres, const ViewAxis& axis, double distance);

/// The distance from which on a texel of this many metres covers at most `most_pixels`.
double switch_distance(double metres_per_texel, const ViewAxis& axis, double most_pixels);

/// The coarsest level whose texels cover at most most_pixels (t_res of the paper) at a distance; 0 where none does.
uint32_t level_at(const LevelLaw& law, const ViewAxis& axis, double distance, double most_pixels);

/// A cross-fade between levels, so that nothing pops: before a coarser level is chosen it already shows. Weight of the
/// level above `level`: 0 up to (1 - band) of the distance at which that level takes over (but no nearer than where
/// `level` itself took over), 1 where it does; smooth (first derivative continuous) and non-decreasing between. `level`
/// is that of level_at, so the picture is continuous over all distances. band in 0..1; 0: no fade.
struct LevelBlend {
    uint32_t level = 0;
    double coarser = 0;  ///< weight of level + 1; 0 at the root
};
LevelBlend level_blend(const LevelLaw& law, const ViewAxis& axis, double distance, double most_pixels, double band);

/// Sides of terrain images.
constexpr uint32_t kCoarsestTerrain = 32, kFinestTerrain = 512;

/// S_res = S_proj(1 m) * side * v_y, as the next power of two in kCoarsestTerrain..kFinestTerrain. `to_nearest`: from
/// the viewer to the nearest point of the tile, metres, z up, of any length; 0 asks for the finest.
uint32_t terrain_resolution(const ViewAxis& axis, double tile_side, const std::array<double, 3>& to_nearest);

}  // namespace citystream::codec::atlas
