#include "tiles/layers/area_reduction.h"

#include <algorithm>
#include <cassert>

#include "codec/atlas/alpha_mask.h"

namespace citystream::tiles::layers {

using codec::atlas::linear_of_srgb;
using codec::atlas::srgb_of_linear;

AreaReduction::AreaReduction(uint32_t in_width, uint32_t in_height, uint32_t out_width, uint32_t out_height, bool alpha)
    : in_width_(in_width),
      in_height_(in_height),
      channels_(alpha ? 4 : 3),
      out_{out_width, out_height, false, false, 0, std::vector<uint8_t>(size_t{3} * out_width * out_height)},
      narrow_(channels_ * out_width),
      sum_(channels_ * out_width, 0) {
    if (alpha) out_.alpha.resize(size_t{out_width} * out_height);
    assert(out_width >= 1 && out_height >= 1 && out_width <= in_width && out_height <= in_height);
}

uint64_t AreaReduction::bytes(uint32_t out_width, uint32_t out_height, bool alpha) {
    const uint64_t channels = alpha ? 4 : 3;
    return channels * out_width * out_height + 2 * channels * sizeof(float) * out_width;
}

// Footprints are counted in units of 1 / (in * out) of the picture: input texel i covers [i * out, (i + 1) * out),
// output texel k covers [k * in, (k + 1) * in).
template <typename Value>
void AreaReduction::narrow_row(Value value) {
    const uint64_t in = in_width_, out = out_.width;
    for (uint64_t k = 0; k < out; ++k) {
        const uint64_t begin = k * in, end = begin + in, first = begin / out, last = (end - 1) / out;
        const auto first_share = static_cast<float>(std::min((first + 1) * out, end) - begin) / static_cast<float>(in);
        const auto last_share = static_cast<float>(end - last * out) / static_cast<float>(in);
        const float share = static_cast<float>(out) / static_cast<float>(in);
        for (size_t c = 0; c < channels_; ++c) {
            float between = 0;
            for (uint64_t i = first + 1; i < last; ++i) between += value(i, c);
            narrow_[channels_ * k + c] =
                first_share * value(first, c) + share * between + (last > first ? last_share * value(last, c) : 0.0F);
        }
    }
}

void AreaReduction::add_row(std::span<const uint8_t> rgb, std::span<const uint8_t> alpha) {
    if (channels_ == 3) {
        narrow_row([rgb](uint64_t i, size_t c) { return linear_of_srgb(rgb[3 * i + c]); });
    } else {
        for (const uint8_t value : alpha) there_ += value >= codec::atlas::kAlphaTest ? 1 : 0;
        narrow_row([rgb, alpha](uint64_t i, size_t c) {
            const float own = static_cast<float>(alpha[i]) / 255;
            return c < 3 ? own * linear_of_srgb(rgb[3 * i + c]) : own;
        });
    }
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
    const size_t first = size_t{out_.width} * (out_.height - 1 - rows_out_);
    if (channels_ == 3) {
        for (size_t i = 0; i < sum_.size(); ++i) out_.rgb[3 * first + i] = srgb_of_linear(sum_[i]);
    } else {
        for (size_t k = 0; k < out_.width; ++k) {
            const float alpha = sum_[4 * k + 3];
            for (size_t c = 0; c < 3; ++c)
                out_.rgb[3 * (first + k) + c] = alpha > 0 ? srgb_of_linear(sum_[4 * k + c] / alpha) : uint8_t{0};
            out_.alpha[first + k] = static_cast<uint8_t>(std::min(alpha, 1.0F) * 255 + 0.5F);
        }
    }
    std::fill(sum_.begin(), sum_.end(), 0.0F);
    ++rows_out_;
}

codec::atlas::ChartImage AreaReduction::take() {
    codec::atlas::keep_share(out_, {there_, uint64_t{in_width_} * in_height_});
    return std::move(out_);
}

}  // namespace citystream::tiles::layers
