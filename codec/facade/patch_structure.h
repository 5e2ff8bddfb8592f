// The parts of a patch map in memory, and their words. A facade is floors of bays of patches: bands (runs of rows) hold
// lists of stripes (runs of columns); a stripe is one label or a patch: inner row breaks x inner column breaks x label
// grid x palette. Lists, patches and their parts are pooled: what occurs twice is stored once. In a transposed map
// bands are runs of columns and stripes runs of rows.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "codec/facade/patch_layout.h"
#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

using PatchBreaks = std::vector<uint16_t>;   ///< rising, from the patch's corner, without 0 and the end
using PatchPalette = std::vector<uint32_t>;  ///< label indexes in the order in which the grid uses them

struct PatchGrid {
    uint32_t columns = 1;
    uint32_t cell_bits = 1;
    std::vector<uint16_t> cells;  ///< indexes in the palette, row by row, numbered by first use
    auto operator<=>(const PatchGrid&) const = default;
};

struct PatchRecord {
    uint32_t rows = 0, columns = 0;  ///< break lists
    uint32_t grid = 0, palette = 0;
    auto operator<=>(const PatchRecord&) const = default;
};

struct PatchStripe {
    uint32_t x0 = 0;
    bool is_patch = false;
    uint32_t content = 0;  ///< a patch or a label
    auto operator<=>(const PatchStripe&) const = default;
};

struct PatchBand {
    uint32_t y0 = 0;
    uint32_t list = 0;
};

/// A grid as its part has it: equal rows and columns once, where that is smaller.
struct FoldedGrid {
    uint32_t row_bits = 0, column_bits = 0;      ///< of indexes; 0: none, all are different
    std::vector<uint16_t> rows, columns, cells;  ///< index of each row and column; cells of the different ones
    uint32_t different_columns = 1;
    uint32_t bits(uint32_t cell_bits) const;
};
/// Bits of a folded grid of `rows` x `columns` cells.
uint32_t folded_bits(uint32_t rows, uint32_t columns, uint32_t different_rows, uint32_t different_columns,
                     uint32_t cell_bits);
FoldedGrid fold_grid(const PatchGrid& grid);

/// Whether a break list fits in 16 bytes.
bool fits_break_list(std::span<const uint16_t> breaks);
uint32_t break_width(uint32_t last_break);

struct PatchStructure {
    uint32_t length = 1;   ///< of a band, texels: the width, or the height of a transposed map
    uint32_t breadth = 1;  ///< across the bands
    bool transposed = false;
    DepthRange depths;
    std::vector<uint32_t> labels;
    std::vector<PatchBreaks> break_lists;
    std::vector<PatchGrid> grids;
    std::vector<PatchPalette> palettes;
    std::vector<PatchRecord> patches;
    std::vector<std::vector<PatchStripe>> lists;
    std::vector<PatchBand> bands;
};

/// Builds a structure whose pools hold everything once, in the order of first use: the one order that words have.
class PatchBuilder {
  public:
    explicit PatchBuilder(PatchStructure head) : structure_(std::move(head)) {}
    uint32_t label(uint32_t word);
    /// `labels`: of the cells, row by row, as words. Precondition: at least two different ones, lists that fit.
    uint32_t patch(const PatchBreaks& rows, const PatchBreaks& columns, std::span<const uint32_t> labels);
    uint32_t list(const std::vector<PatchStripe>& stripes);
    void band(uint32_t y0, uint32_t list) { structure_.bands.push_back({y0, list}); }
    PatchStructure take() { return std::move(structure_); }

  private:
    PatchStructure structure_;
    std::map<uint32_t, uint32_t> labels_;
    std::map<PatchBreaks, uint32_t> break_lists_;
    std::map<PatchGrid, uint32_t> grids_;
    std::map<PatchPalette, uint32_t> palettes_;
    std::map<PatchRecord, uint32_t> patches_;
    std::map<std::vector<PatchStripe>, uint32_t> lists_;
};

/// The one way to write a structure made by PatchBuilder. Fails where a field has too few bits (more than about 100 KB
/// of parts or 100,000 stripes). O(size).
Result<std::vector<uint32_t>> write_patch_words(const PatchStructure& structure);

/// Of the labels that are not open; 0, 0 when all are.
DepthRange depth_range(std::span<const uint32_t> labels);

/// Whether every patch is smaller than the stripe and the bands that it stands in.
Status check_extents(const PatchStructure& structure);

/// Reads words that write_patch_words could have written; anything else is an error. For untrusted bytes. O(words), at
/// most about 1,000 cells a word.
Result<PatchStructure> read_patch_words(std::span<const uint32_t> words);

}  // namespace citystream::codec::facade
