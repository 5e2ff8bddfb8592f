// The raw form of a facade map (raw_layout.h): every texel's displacement and material and, if wanted, its free box,
// uncompressed. What the paper's uncompressed renderers read: relief mapping D and M, facade displacement mapping also
// the boxes. Paper: section 4.2 and row NOCOMP of table 1.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/free_boxes.h"
#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// 3 or 4 bytes a texel, with boxes 5 to 8 more. Always succeeds. O(texels).
Result<std::vector<uint32_t>> encode_raw_map(const RunGrid& grid, bool with_boxes = true);

/// Bytes of the raw form with boxes: what compressed forms must undercut.
uint64_t raw_map_bytes(const RunGrid& grid, uint64_t box_count);

/// Everything the layout promises, entry by entry (depth range, boxes around their texels), but that boxes are free.
/// O(texels).
Status check_raw_map(std::span<const uint32_t> words);

/// Checks and decodes. O(texels).
Result<RunGrid> decode_raw_map(std::span<const uint32_t> words);

/// Lookups as the shader does them. For checked words, x < width, y < height; raw_box for maps with boxes.
uint32_t raw_label(std::span<const uint32_t> words, uint32_t x, uint32_t y);
uint32_t raw_box_count(std::span<const uint32_t> words);
FreeBox raw_box(std::span<const uint32_t> words, uint32_t x, uint32_t y);

}  // namespace citystream::codec::facade
