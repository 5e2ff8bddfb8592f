// A chart that many tiles show, stored once: an atlas layer with one chart, whose steps are its levels, and how tiles
// name it. Sizes of levels follow from the chart's, so that no index has to hold them. FORMAT.md, "Shared charts".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/atlas_layout.h"
#include "codec/layer_steps.h"
#include "codec/result.h"

namespace citystream::codec::atlas {

inline constexpr uint32_t kMostChartLevels = 8;   ///< of 8192 x 8192 texels; with alpha some have more: none is shared
inline constexpr size_t kChartChecksumBytes = 4;  ///< in front of a level's frame

/// Flags of a chart table that a shared chart may have; `flags` below.
inline constexpr uint32_t kSharedChartFlags = ATLAS_CHART_REPEAT_U | ATLAS_CHART_REPEAT_V | ATLAS_CHART_ALPHA;

/// Steps of encode_atlas for one chart of width x height texels (1..8192 each): 1..kMostChartLevels, one more with
/// alpha.
uint32_t atlas_step_count(uint32_t width, uint32_t height, uint32_t flags);
/// The finest mip that a prefix holds whose last step is `step`; the last one's is 0. Precondition: step <
/// atlas_step_count.
uint32_t atlas_step_finest_mip(uint32_t width, uint32_t height, uint32_t flags, uint32_t step);
/// Words of the decoded step alone. Precondition: step < atlas_step_count.
uint32_t atlas_step_words(uint32_t width, uint32_t height, uint32_t flags, uint32_t step);

/// For blocks: 14 walls (2.7 Mtexel) take 661,439 bytes at level 15, 660,958 at 16 and 660,751 at 19, in 0.13, 0.16 and
/// 0.30 s.
inline constexpr int kBlockZstdLevel = 16;

/// The levels of a layer of one chart as they travel: low half of the XXH3-64 of the rest, then a zstd frame of the
/// level's blocks in planes (block_planes.h). All other words follow from the chart's size and flags.
std::vector<std::vector<std::byte>> encode_chart_levels(const LayerSteps& steps, int zstd_level = kBlockZstdLevel);

/// Whether a payload is long enough and its checksum right. O(bytes).
bool chart_level_is_whole(std::span<const std::byte> payload);

/// The words of level `step` of a chart of that size and with those flags: exactly atlas_step_words.
/// Levels 0 to n one behind the other are a layer that AtlasLayerView takes, whatever the blocks. Fails on damaged
/// payloads.
Result<std::vector<uint32_t>> decode_chart_level(std::span<const std::byte> payload, uint32_t width, uint32_t height,
                                                 uint32_t flags, uint32_t step);

/// The checked view of the levels 0 .. level_count - 1 of a chart, one behind the other: a layer of one chart, of that
/// size and with those flags. Precondition: level_count 1..atlas_step_count.
Result<AtlasLayerView> shared_chart_view(std::span<const uint32_t> words, uint32_t width, uint32_t height,
                                         uint32_t flags, uint32_t level_count);

/// Upper half of a float's 32 bits, to nearest: how a chart table holds metres. Precondition: finite, >= 0.
uint32_t coarse_float_bits(float value);
float from_coarse_float_bits(uint32_t bits);

}  // namespace citystream::codec::atlas
