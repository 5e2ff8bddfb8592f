// The common form of a facade's relief between all codecs: displacement D and material index M on the grid of their
// runs. Columns and rows of texels are cut where a neighbour differs, so a cell holds one label and a facade of a
// million texels has a few thousand cells.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::facade {

inline constexpr uint32_t kMaxFacadeSide = 8192;  ///< texels

/// Displacement of a texel without surface (air beside a gable, an open gateway): a ray that goes down there meets
/// nothing and leaves through the back.
inline constexpr int32_t kOpenDisplacement = -32768;

/// A label is what one texel holds: displacement as int16 millimetres (low half, outwards positive) and material index
/// (high half).
constexpr uint32_t make_label(int32_t displacement_mm, uint32_t material) {
    return (static_cast<uint32_t>(displacement_mm) & 0xffffU) | material << 16;
}
constexpr int32_t displacement_of(uint32_t label) {
    return static_cast<int16_t>(label & 0xffffU);
}
constexpr uint32_t material_of(uint32_t label) {
    return label >> 16;
}

/// The matrices as they come from images: row 0 is the bottom of the wall, texel = row * width + column, 1 cm a texel.
struct FacadeMatrices {
    uint32_t width = 0, height = 0;        ///< texels, 1..kMaxFacadeSide
    std::vector<int16_t> displacement_mm;  ///< outwards positive; kOpenDisplacement: no surface
    std::vector<uint16_t> material;
    friend bool operator==(const FacadeMatrices&, const FacadeMatrices&) = default;
};

struct DepthRange {
    int32_t min_mm = 0, max_mm = 0;
    friend bool operator==(const DepthRange&, const DepthRange&) = default;
};

struct RunGrid {
    std::vector<uint32_t> x_breaks,
        y_breaks;                  ///< texels: columns() + 1 and rows() + 1 rising numbers from 0 to the size
    std::vector<uint32_t> labels;  ///< of the cells, row by row from the bottom
    friend bool operator==(const RunGrid&, const RunGrid&) = default;

    uint32_t columns() const { return static_cast<uint32_t>(x_breaks.size()) - 1; }
    uint32_t rows() const { return static_cast<uint32_t>(y_breaks.size()) - 1; }
    uint32_t width() const { return x_breaks.back(); }
    uint32_t height() const { return y_breaks.back(); }
    uint32_t label(uint32_t column, uint32_t row) const { return labels[size_t{row} * columns() + column]; }
    /// Least and greatest displacement of the cells that are not open; 0, 0 when all are.
    DepthRange depths() const;
    bool has_open_cells() const;
};

/// The coarsest grid of the matrices (no two neighbouring columns or rows are equal). Fails on sizes out of range and
/// matrices of another size. O(texels).
Result<RunGrid> make_run_grid(const FacadeMatrices& matrices);

/// The same relief on its coarsest grid: equal neighbouring columns and rows merged. O(cells).
RunGrid merge_equal_runs(const RunGrid& grid);

/// Whether breaks and labels are as the comments above say: what every encoder requires (programming error else).
bool is_valid(const RunGrid& grid);

/// Both matrices back: 4 bytes a texel.
FacadeMatrices expand(const RunGrid& grid);

}  // namespace citystream::codec::facade
