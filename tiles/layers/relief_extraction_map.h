// The relief that was decided on as a facade map.
#pragma once

#include "codec/facade/run_grid.h"
#include "tiles/layers/relief_extraction_palette.h"

namespace citystream::tiles::layers::relief {

struct ReliefMap {
    codec::facade::RunGrid grid;
    double left = 0, right = 0, bottom = 0, top = 0;  ///< metres of the wall that it covers
};

/// Labels of the cells; open margins are cut off. Where a side of the model has another material than the front above
/// it, a rim of one texel of the front shows that material, because a side of the relief looks as the front above it.
/// Programming error: no cell is closed.
ReliefMap make_relief_map(const CellGrid& cells, const FacadeParts& facade, const Decision& decision,
                          const SlotTable& slots, double tolerance);

}  // namespace citystream::tiles::layers::relief
