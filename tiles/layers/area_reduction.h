// Makes a picture smaller while its rows pass by: each new texel is the mean over its footprint in linear light,
// colours weighted by alpha. Holds the small picture and two rows, whatever the size of the source.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "codec/atlas/image.h"

namespace citystream::tiles::layers {

class AreaReduction {
  public:
    /// Precondition (programming error): 1 <= out <= in on both axes.
    AreaReduction(uint32_t in_width, uint32_t in_height, uint32_t out_width, uint32_t out_height, bool alpha = false);

    /// The next row from the top: 3 * in_width sRGB bytes, and in_width of alpha where the picture has it.
    void add_row(std::span<const uint8_t> rgb, std::span<const uint8_t> alpha = {});
    /// After in_height rows: row 0 is the bottom. Alpha is such that as many texels of the source, by their share of
    /// the area, pass its test (alpha_mask.h).
    codec::atlas::ChartImage take();

    /// What an object of this class holds.
    static uint64_t bytes(uint32_t out_width, uint32_t out_height, bool alpha = false);

  private:
    /// value(i, c): channel c of texel i of the row, linear, multiplied by alpha.
    template <typename Value>
    void narrow_row(Value value);
    void finish_row();

    uint32_t in_width_, in_height_;
    size_t channels_;
    uint64_t there_ = 0;  ///< texels of the source that pass the test
    codec::atlas::ChartImage out_;
    std::vector<float> narrow_, sum_;  // one row of the small picture: of this source row, of the rows so far
    uint64_t rows_in_ = 0, rows_out_ = 0;
};

}  // namespace citystream::tiles::layers
