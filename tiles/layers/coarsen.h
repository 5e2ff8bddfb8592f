// The content of an inner tile from the contents of its children, within an error of its level.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/layers/tile_encoder.h"

namespace citystream::tiles::layers {

struct CoarsenSpec {
    GridPoint corner;             ///< absolute minimum corner of the tile
    int64_t side = 0;             ///< grid units
    double error_metres = 0;      ///< wanted: what each object gathers stays at or below it
    uint64_t triangle_limit = 0;  ///< above it the wanted error is raised until the tile fits
};

struct CoarseContent {
    TileContent content;
    float error = 0;           ///< metres, reached: the greatest gathered error of an object
    double allowed_error = 0;  ///< metres: the wanted error after it was raised
};

/// Makes flat walls of facades whose relief times kReliefWeight is below the error, plain colours of those that are not
/// much larger than it, outline blocks of buildings that show no other facade, boxes of crowds of small things, fewer
/// and larger faces of what is cut out by alpha, coarser ground. The error is raised (and told) only when the tile
/// would have more triangles than the limit. Deterministic.
CoarseContent coarsen(TileContent children, const CoarsenSpec& spec, const TileWorkshop& workshop);

}  // namespace citystream::tiles::layers
