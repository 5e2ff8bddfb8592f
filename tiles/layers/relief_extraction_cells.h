// What lies over each cell of a wall, front to back: the wall's rectangle cut where fronts begin and end, and every
// triangle drawn into it along the normal.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tiles/layers/relief_extraction_parts.h"

namespace citystream::tiles::layers::relief {

/// One axis: cuts on whole texels.
struct Axis {
    double length = 0;  ///< metres
    uint32_t texels = 1;
    std::vector<uint32_t> cut;       ///< texels, rising from 0 to `texels`
    std::vector<double> at, centre;  ///< metres: of the cuts, of the cells between them

    uint32_t cells() const { return static_cast<uint32_t>(centre.size()); }
    double texel() const { return length / texels; }
    /// The cell of a coordinate; the nearest one outside.
    uint32_t cell_of(double coordinate) const;
};

struct CellGrid {
    Axis u, v;
    double stair = 0;  ///< metres: greatest step by which slanting outlines are followed
    size_t cells() const { return size_t{u.cells()} * v.cells(); }
};

/// Cuts at all corners of flat parts, and along their slanting outlines at most `stair` metres apart (more where
/// `most_cells` would be exceeded; then corners fall together too).
CellGrid make_cell_grid(const WallFrame& frame, const FacadeParts& facade, double texel, double stair,
                        size_t most_cells);

struct Layer {
    double w = 0;
    uint32_t part = 0;
};

/// Front-most first. Sides are not in it.
class LayerStack {
  public:
    LayerStack(const CellGrid& grid, const FacadeParts& facade, double deepest);
    std::span<const Layer> at(size_t cell) const {
        return std::span(layers_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
    }

  private:
    std::vector<uint32_t> begin_;
    std::vector<Layer> layers_;
};

}  // namespace citystream::tiles::layers::relief
