#include "codec/atlas/resample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kMostSide = 65535;

/// For every output texel the input texels it is a weighted sum of: `taps` in a row from first[i], which may lie
/// outside the image.
struct Weights {
    uint32_t taps = 0;
    std::vector<int64_t> first;
    std::vector<float> weight;  ///< taps per output texel, summing to 1
};

double sinc(double x) {
    if (x == 0) return 1;
    return std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

/// Weight of the input texel from `lower` to `lower` + 1 for an output texel of this centre and width, in input texels.
double weight_of(Shrink filter, double lower, double centre, double width) {
    const double distance = std::abs(lower + 0.5 - centre);
    switch (filter) {
        case Shrink::kArea:
            return std::max(0.0, std::min(lower + 1, centre + width / 2) - std::max(lower, centre - width / 2));
        case Shrink::kLanczos: {
            const double x = distance / width;
            return x < 3 ? sinc(x) * sinc(x / 3) : 0;
        }
        case Shrink::kBilinear:
            break;
    }
    return std::max(0.0, 1 - distance);
}

/// First input texel that can count, and how many.
struct Span {
    double lowest;
    uint32_t taps;
};

Span span_of(Shrink filter, double centre, double width) {
    constexpr double kRounding = 1e-9;  // a bound that is a whole number up to rounding is that number
    if (filter == Shrink::kBilinear) return {std::floor(centre - 0.5 + kRounding), 2};
    const double radius = filter == Shrink::kArea ? width / 2 : 3 * width + 0.5;
    return {std::floor(centre - radius + kRounding), static_cast<uint32_t>(std::ceil(2 * radius - kRounding)) + 1};
}

Weights make_weights(uint32_t in, uint32_t out, Shrink filter) {
    if (out > in) filter = Shrink::kBilinear;
    const double width = static_cast<double>(in) / out;
    Weights all;
    all.taps = span_of(filter, 0, width).taps;
    all.first.resize(out);
    all.weight.resize(size_t{out} * all.taps);
    std::vector<double> weights(all.taps);
    for (uint32_t i = 0; i < out; ++i) {
        const double centre = (i + 0.5) * width, lowest = span_of(filter, centre, width).lowest;
        double sum = 0;
        for (uint32_t k = 0; k < all.taps; ++k) sum += weights[k] = weight_of(filter, lowest + k, centre, width);
        all.first[i] = static_cast<int64_t>(lowest);
        for (uint32_t k = 0; k < all.taps; ++k)
            all.weight[size_t{i} * all.taps + k] = static_cast<float>(weights[k] / sum);
    }
    return all;
}

/// The input texel that stands at `i`.
uint32_t source_of(int64_t i, uint32_t side, bool repeat) {
    if (i >= 0 && i < side) return static_cast<uint32_t>(i);
    if (!repeat) return i < 0 ? 0 : side - 1;
    const int64_t rest = i % side;
    return static_cast<uint32_t>(rest < 0 ? rest + side : rest);
}

/// Rows of floats, one after the other.
struct Rows {
    const float* first;
    uint32_t count;
    size_t length;
};

/// Output rows begin .. end - 1, each a weighted sum of input rows.
void sum_rows(const Weights& weights, uint32_t begin, uint32_t end, const Rows& in, bool repeat, float* out) {
    std::vector<const float*> rows(weights.taps);
    for (uint32_t i = begin; i < end; ++i, out += in.length) {
        for (uint32_t k = 0; k < weights.taps; ++k)
            rows[k] = in.first + source_of(weights.first[i] + k, in.count, repeat) * in.length;
        weighted_sum(rows.data(), &weights.weight[size_t{i} * weights.taps], weights.taps, out, in.length);
    }
}

/// Resamples rows, kStripRows at a time as columns.
class WidthPass {
  public:
    WidthPass(uint32_t in, uint32_t out, Shrink filter, bool repeat)
        : weights_(make_weights(in, out, filter)),
          in_(in),
          out_(out),
          repeat_(repeat),
          before_(size_t{in} * kStripRows),
          after_(size_t{out} * kStripRows) {}

    void resample(const float* rows, uint32_t count, float* out) {
        transpose(rows, in_, in_, count, before_.data(), kStripRows);
        sum_rows(weights_, 0, out_, {before_.data(), in_, kStripRows}, repeat_, after_.data());
        transpose(after_.data(), kStripRows, count, out_, out, out_);
    }

  private:
    Weights weights_;
    uint32_t in_, out_;
    bool repeat_;
    std::vector<float> before_, after_;
};

void clamp_unit(Image& image) {
    run_wide([values = image.texels.data(), count = image.texels.size()]() CITYSTREAM_INLINED {
        for (size_t i = 0; i < count; ++i) {
            const float low = values[i] > 0 ? values[i] : 0;
            values[i] = low < 1 ? low : 1;
        }
    });
}

}  // namespace

Image resample_width(const Image& image, uint32_t width, Shrink filter, bool repeat) {
    assert(!image.empty() && width >= 1 && width <= kMostSide);
    if (width == image.width) return image;
    Image out(width, image.height, image.channels);
    WidthPass pass(image.width, width, filter, repeat);
    const uint32_t all_rows = image.height * image.channels;
    for (uint32_t y = 0; y < all_rows; y += kStripRows) {
        const uint32_t count = std::min(kStripRows, all_rows - y);
        pass.resample(&image.texels[size_t{y} * image.width], count, &out.texels[size_t{y} * width]);
    }
    if (filter == Shrink::kLanczos && width < image.width) clamp_unit(out);
    return out;
}

Image resample_height(const Image& image, uint32_t height, Shrink filter, bool repeat) {
    assert(!image.empty() && height >= 1 && height <= kMostSide);
    if (height == image.height) return image;
    const Weights weights = make_weights(image.height, height, filter);
    Image out(image.width, height, image.channels);
    for (uint32_t c = 0; c < image.channels; ++c)
        sum_rows(weights, 0, height, {image.plane(c).data(), image.height, image.width}, repeat, out.plane(c).data());
    if (filter == Shrink::kLanczos && height < image.height) clamp_unit(out);
    return out;
}

Image resample(const Image& image, uint32_t width, uint32_t height, Shrink filter, Edges edges) {
    // The pass along the rows is the dearer one: it comes where there are fewer rows.
    if (height >= image.height)
        return resample_height(resample_width(image, width, filter, edges.repeat_u), height, filter, edges.repeat_v);
    return resample_width(resample_height(image, height, filter, edges.repeat_v), width, filter, edges.repeat_u);
}

Image resample(const ChartImage& image, uint32_t width, uint32_t height, Shrink filter, Edges edges) {
    assert(image.width >= 1 && image.height >= 1 && image.rgb.size() == 3 * size_t{image.width} * image.height);
    if (width >= image.width) return resample(linear_image(image), width, height, filter, edges);
    Image narrow(width, image.height, image.alpha.empty() ? 3 : 4);
    WidthPass pass(image.width, width, filter, edges.repeat_u);
    for (uint32_t y = 0; y < image.height; y += kStripRows) {
        const uint32_t count = std::min(kStripRows, image.height - y);
        const Image strip = linear_rows(image, y, count);
        for (uint32_t c = 0; c < narrow.channels; ++c)
            pass.resample(strip.plane(c).data(), count, narrow.row(c, y).data());
    }
    if (filter == Shrink::kLanczos) clamp_unit(narrow);
    return resample_height(narrow, height, filter, edges.repeat_v);
}

ImageRows enlarged_rows(const Image& small, uint32_t width, uint32_t height, Edges edges) {
    assert(!small.empty() && width >= small.width && height >= small.height && std::max(width, height) <= kMostSide);
    ImageRows out{width, height, small.channels, {}};
    if (height == small.height && width == small.width) return rows_of(small);
    if (height == small.height) {
        const auto pass = std::make_shared<WidthPass>(small.width, width, Shrink::kBilinear, edges.repeat_u);
        out.read = [&small, pass](uint32_t y, Image& strip) {
            for (uint32_t c = 0; c < strip.channels; ++c)
                pass->resample(small.row(c, y).data(), strip.height, strip.plane(c).data());
        };
        return out;
    }
    // Few rows are widened, then mixed.
    const auto wide = std::make_shared<const Image>(resample_width(small, width, Shrink::kBilinear, edges.repeat_u));
    const auto weights = std::make_shared<const Weights>(make_weights(small.height, height, Shrink::kBilinear));
    out.read = [wide, weights, repeat = edges.repeat_v](uint32_t y, Image& strip) {
        for (uint32_t c = 0; c < strip.channels; ++c) {
            const Rows in = {wide->plane(c).data(), wide->height, wide->width};
            sum_rows(*weights, y, y + strip.height, in, repeat, strip.plane(c).data());
        }
    };
    return out;
}

std::string_view name_of(Shrink filter) {
    static constexpr std::array<std::string_view, 3> kNames = {"area", "lanczos", "bilinear"};
    return kNames[static_cast<size_t>(filter)];
}

std::optional<Shrink> parse_shrink(std::string_view text) {
    for (const Shrink filter : {Shrink::kArea, Shrink::kLanczos, Shrink::kBilinear}) {
        if (text == name_of(filter)) return filter;
    }
    return std::nullopt;
}

}  // namespace citystream::codec::atlas
