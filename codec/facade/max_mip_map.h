// The maximum mip form of a facade map (max_mip_layout.h): D and M uncompressed and, over D, a pyramid of maxima of 2^k
// x 2^k texels, so that a ray passes whole blocks below it in one step. What uncompressed ray casting does without
// boxes; the measure of the other renderers. Sizes need not be powers of two: the last block of a row or column is cut
// off.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// 3.7 or 4.7 bytes a texel (more for maps that are one texel wide). Always succeeds. O(texels).
Result<std::vector<uint32_t>> encode_max_mip_map(const RunGrid& grid);

/// Everything the layout promises, maxima and depth range included. O(texels).
Status check_max_mip_map(std::span<const uint32_t> words);

/// Checks and decodes. O(texels).
Result<RunGrid> decode_max_mip_map(std::span<const uint32_t> words);

/// Lookups as the shader does them, for checked words: label of a texel; entry of a level (in entries of that level).
uint32_t max_mip_label(std::span<const uint32_t> words, uint32_t x, uint32_t y);
int32_t max_mip_maximum(std::span<const uint32_t> words, uint32_t level, uint32_t x, uint32_t y);

}  // namespace citystream::codec::facade
