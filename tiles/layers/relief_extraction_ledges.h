// Colours of the relief's sides. A side of a map looks as the front above it; where the model's sides have other
// materials, ledges of one texel on the edge of the front show these: each as high as the part of the side that it
// stands for, the deepest nearest to the edge. Sides of less than 8 cm of depth have none: from the front the ledges
// would be seen more than the sides.
#pragma once

#include "codec/facade/run_grid.h"
#include "tiles/layers/relief_extraction_palette.h"

namespace citystream::tiles::layers::relief {

/// The map with ledges. `left` and `bottom`: metres of the wall where the map begins; steps lower than `tolerance` are
/// not followed. O(parts log parts + ledges * cells of a row).
codec::facade::RunGrid add_ledges(const codec::facade::RunGrid& grid, const CellGrid& cells, double left, double bottom,
                                  const FacadeParts& facade, const Decision& decision, const SlotTable& slots,
                                  double tolerance);

}  // namespace citystream::tiles::layers::relief
