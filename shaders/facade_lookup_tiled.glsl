// Lookups in the tiled form of a facade map (codec/facade/tiled_layout.h): run of the column, run of the row, tile, cell of its pattern (where
// it has one), label of its palette. Twin of tiled_label.
#ifndef CITYSTREAM_FACADE_LOOKUP_TILED_GLSL
#define CITYSTREAM_FACADE_LOOKUP_TILED_GLSL

#include "codec/facade/tiled_layout.h"
#include "shaders/facade_runs.glsl"

// The label of a cell of the run grid.
uint tiled_run_label(FacadeMap map, uint column, uint row) {
    const uint kSideLog2 = uint(TILE_SIDE_LOG2);
    const uint kCellBitsBits = uint(TILE_CELL_BITS_BITS);
    uint widths = map.head.w;
    uint pattern_bits = widths >> 11 & 31u;
    uint palette_bits = widths >> 16 & 31u;
    uint tile = (row >> kSideLog2) * (widths & 2047u) + (column >> kSideLog2);
    uint record = section_field(map.layer, map.own.x, tile, kCellBitsBits + pattern_bits + palette_bits);
    uint cell_bits = low_bits(record, kCellBitsBits);
    uint pattern = low_bits(record >> kCellBitsBits, pattern_bits);
    uint entry = pattern_bits + kCellBitsBits == 32u ? 0u : record >> (pattern_bits + kCellBitsBits);
    if (cell_bits != 0u) {
        uint cell = low_bits(row, kSideLog2) << kSideLog2 | low_bits(column, kSideLog2);
        entry += dense_field(map.layer, map.own.y, (pattern << uint(TILE_PATTERN_UNIT_LOG2)) + cell * cell_bits, cell_bits);
    }
    uint number = section_field(map.layer, map.own.z, entry, widths >> 21 & 63u);
    return numbered_label(map, number, widths >> 27, map.own.w);
}

uint lookup_tiled(FacadeMap map, uint x, uint y) {
    uint column = facade_run(map, uint(RUN_BREAKS_GROUP), x).index;
    return tiled_run_label(map, column, facade_run(map, run_row_breaks(map), y).index);
}

#endif
