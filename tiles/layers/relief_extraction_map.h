// The relief that was decided on as a facade map.
#pragma once

#include "codec/facade/run_grid.h"
#include "tiles/layers/relief_extraction_palette.h"

namespace citystream::tiles::layers::relief {

struct ReliefMap {
    codec::facade::RunGrid grid;
    double left = 0, right = 0, bottom = 0, top = 0;  ///< metres of the wall that it covers
};

/// Labels of the cells, with ledges for the materials of sides; open margins are cut off.
/// Programming error: no cell is closed.
ReliefMap make_relief_map(const CellGrid& cells, const FacadeParts& facade, const Decision& decision,
                          const SlotTable& slots, double tolerance);

}  // namespace citystream::tiles::layers::relief
