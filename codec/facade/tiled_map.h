// The tiled map: the run grid in tiles of 8 x 8 cells, each a pattern (which of a few labels a cell has) and a palette
// (which labels these are), both pooled, so that equal tiles, and tiles that differ only in labels, share. For maps
// whose rows and columns are nearly all different; 4 or 5 loads a lookup. Words in tiled_layout.h and FORMAT.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Exact, deterministic, O(cells). Fails where a tile record does not fit in 32 bits: on maps of millions of cells with
/// hardly two tiles alike (the quotient is smaller then).
Result<std::vector<uint32_t>> encode_tiled_map(const RunGrid& grid);

/// Whether the words are exactly those that encode_tiled_map writes for what they show. For untrusted bytes. O(cells):
/// at most 683 a word (64 for the 3 bits of a record) and 64 Mi in all.
Status check_tiled_map(std::span<const uint32_t> words);

/// Checks and decodes. Allocates 4 bytes a cell of the run grid.
Result<RunGrid> decode_tiled_map(std::span<const uint32_t> words);

/// The label of a texel as the shader finds it; for checked words, x < width, y < height.
uint32_t tiled_label(std::span<const uint32_t> words, uint32_t x, uint32_t y);

}  // namespace citystream::codec::facade
