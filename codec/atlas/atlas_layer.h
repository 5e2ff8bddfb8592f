// Atlas layer of a tile: its charts (parts of images, wrapped or clamped) in BC1, each with its own mip chain, mips
// coarse to fine as steps. Every chart has its own mips down to 1 x 1 and is filtered inside its own bounds, so nothing
// bleeds and wrapping has no seam.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/layer_steps.h"
#include "codec/result.h"

namespace citystream::codec::atlas {

/// A chart's finest image: 8-bit RGB (sRGB-encoded), row 0 is the bottom (v = 0).
struct ChartImage {
    uint32_t width = 0, height = 0;  ///< 1..8192
    bool repeat_u = false, repeat_v = false;
    float metres_per_texel = 0;  ///< of mip 0, the coarser axis; only for the stated error
    std::vector<uint8_t> rgb;    ///< 3 * width * height
    /// width * height, not multiplied into the colours; empty: opaque. What is filtered to less than kAlphaTest is not
    /// there.
    std::vector<uint8_t> alpha = {};
};

inline constexpr int32_t kAlphaTest = 128;  ///< of 255: one half, as shaders and glTF's alphaCutoff have it

/// The next coarser mip (max(1, size >> 1)), 2 x 2 box filter (odd sizes: weighted three-tap box) in linear light,
/// rounded to the nearest value; integer, deterministic. With alpha: alpha_mask.h.
ChartImage downsample(const ChartImage& image);

struct AtlasOptions {
    /// Squared error that a bit on the wire is worth (bc1_rate.h, lambda): larger gives fewer bytes and coarser blocks.
    /// Images (mips) of one block always keep their best one. 0: all blocks are the best that the encoder finds.
    uint32_t rate_distortion = 0;
};

/// A chart of the tile that lies in the city's dictionary (shared_chart.h).
struct SharedChartUse {
    uint32_t chart_in_tile = 0;
    uint32_t number = 0;         ///< in the dictionary
    float metres_per_texel = 0;  ///< of its finest mip, in this tile; as FORMAT.md rounds it
    friend bool operator==(const SharedChartUse&, const SharedChartUse&) = default;
};

/// Encodes. No charts: one step of header words. Precondition (programming error): sizes in range, rgb of matching
/// size. Step 0 holds the mips whose parts sum to at most 4 KiB (at least the coarsest), each later step one finer mip.
/// A chart has mips down to 1 x 1; one whose mips end above the finest of step 0 repeats its 1 x 1 mip up to there, so
/// that every prefix shows every chart. Charts with alpha end at their last mip of kLeastAlphaTexels, or at the finest
/// one of step 0. A step's error: the largest metres_per_texel over the charts at that mip
/// (charts that already are at their finest count with their own).
/// `shared` charts, ascending by chart_in_tile, take those places in the chart table; `charts` take the others in their
/// order. They have no blocks here and no part in the errors: a layer without others has one step with error 0.
LayerSteps encode_atlas(std::span<const ChartImage> charts, const AtlasOptions& options = {},
                        std::span<const SharedChartUse> shared = {});

/// A checked view of a prefix; nothing can be read outside the words afterwards.
class AtlasLayerView {
  public:
    /// `dictionary_size`: charts in the city's dictionary; numbers beyond it are refused.
    static Result<AtlasLayerView> create(std::span<const uint32_t> words, std::span<const uint32_t> step_words,
                                         uint64_t dictionary_size = 0);
    uint32_t chart_count() const;  ///< local and shared ones
    /// Whether a chart lies in the dictionary. What follows (width to texel) is asked of local charts only.
    bool is_shared(uint32_t chart) const;
    std::vector<SharedChartUse> shared_charts() const;  ///< ascending by chart_in_tile
    uint32_t finest_mip()
        const;  ///< finest mip that this prefix holds; every chart has it or only coarser ones, at least one
    uint32_t width(uint32_t chart) const;
    uint32_t height(uint32_t chart) const;
    uint32_t flags(uint32_t chart) const;
    uint32_t mip_count(uint32_t chart)
        const;  ///< this chart's mips are finest_mip() .. mip_count(chart) - 1; sample at clamp(mip, these)
    bool has_alpha(uint32_t chart) const;  ///< false for shared ones: their own layer knows
    /// One texel of a mip that the prefix holds; x, y inside the mip's size.
    void texel(uint32_t chart, uint32_t mip, uint32_t x, uint32_t y, uint8_t rgb[3]) const;
    uint8_t alpha(uint32_t chart, uint32_t mip, uint32_t x, uint32_t y) const;  ///< of the same; 255 without alpha

  private:
    const uint32_t* block_of(uint32_t chart, uint32_t mip, uint32_t x, uint32_t y) const;

    std::span<const uint32_t> words_;
    uint32_t finest_mip_ = 0;
};

}  // namespace citystream::codec::atlas
