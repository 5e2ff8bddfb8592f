#include "tiles/layers/area_reduction.h"

#include <algorithm>
#include <cassert>

namespace citystream::tiles::layers {

using codec::atlas::linear_of_srgb;
using codec::atlas::srgb_of_linear;

AreaReduction::AreaReduction(uint32_t in_width, uint32_t in_height, uint32_t out_width, uint32_t out_height)
    : in_width_(in_width),
      in_height_(in_height),
      out_{out_width, out_height, false, false, 0, std::vector<uint8_t>(size_t{3} * out_width * out_height)},
      narrow_(size_t{3} * out_width),
      sum_(size_t{3} * out_width, 0) {
    assert(out_width >= 1 && out_height >= 1 && out_width <= in_width && out_height <= in_height);
}

uint64_t AreaReduction::bytes(uint32_t out_width, uint32_t out_height) {
    return uint64_t{3} * out_width * out_height + uint64_t{6} * sizeof(float) * out_width;
}

// Footprints are counted in units of 1 / (in * out) of the picture: input texel i covers [i * out, (i + 1) * out),
// output texel k covers [k * in, (k + 1) * in).
void AreaReduction::narrow_row(std::span<const uint8_t> rgb) {
    const uint64_t in = in_width_, out = out_.width;
    for (uint64_t k = 0; k < out; ++k) {
        const uint64_t begin = k * in, end = begin + in, first = begin / out, last = (end - 1) / out;
        const auto first_share = static_cast<float>(std::min((first + 1) * out, end) - begin) / static_cast<float>(in);
        const auto last_share = static_cast<float>(end - last * out) / static_cast<float>(in);
        const float share = static_cast<float>(out) / static_cast<float>(in);
        for (size_t c = 0; c < 3; ++c) {
            float between = 0;
            for (uint64_t i = first + 1; i < last; ++i) between += linear_of_srgb(rgb[3 * i + c]);
            narrow_[3 * k + c] = first_share * linear_of_srgb(rgb[3 * first + c]) + share * between +
                                 (last > first ? last_share * linear_of_srgb(rgb[3 * last + c]) : 0.0F);
        }
    }
}

void AreaReduction::add_row(std::span<const uint8_t> rgb) {
    narrow_row(rgb);
    const uint64_t in = in_height_, out = out_.height;
    uint64_t at = rows_in_ * out;
    const uint64_t row_end = ++rows_in_ * out;
    while (at < row_end) {
        const uint64_t end = std::min(row_end, (rows_out_ + 1) * in);
        const float share = static_cast<float>(end - at) / static_cast<float>(in);
        for (size_t i = 0; i < sum_.size(); ++i) sum_[i] += share * narrow_[i];
        at = end;
        if (end == (rows_out_ + 1) * in) finish_row();
    }
}

void AreaReduction::finish_row() {
    uint8_t* row = &out_.rgb[3 * size_t{out_.width} * (out_.height - 1 - rows_out_)];
    for (size_t i = 0; i < sum_.size(); ++i) row[i] = srgb_of_linear(sum_[i]);
    std::fill(sum_.begin(), sum_.end(), 0.0F);
    ++rows_out_;
}

}  // namespace citystream::tiles::layers
