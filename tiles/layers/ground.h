// Coarse ground: terrain, land use, roads and water of an inner tile, within an error, its border kept.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/layers/tile_encoder.h"

namespace citystream::tiles::layers {

struct GroundSpec {
    GridPoint corner;
    int64_t side = 0;             ///< grid units
    double error_metres = 0;      ///< of this level: what each object may gather
    uint64_t triangle_limit = 0;  ///< beyond it the ground becomes a height grid with a picture of itself
};

/// Replaces the ground objects by coarser ones. `pictures`: of the children, that paints of kind kGroundPicture show;
/// replaced by those of the result.
void coarsen_ground(std::vector<quadtree::BuildObject>& ground, std::vector<ChartImage>& pictures,
                    const GroundSpec& spec, ImageCache& images);

}  // namespace citystream::tiles::layers
