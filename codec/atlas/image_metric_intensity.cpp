#include "codec/atlas/image_metric_intensity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "codec/atlas/image_metric_filter.h"
#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

constexpr size_t kPiece = 1024;        // values encoded at a time
constexpr double kFlat = 1e-9;         // deviation per value below which a picture counts as constant
constexpr double kSameWithin = 1e-12;  // 1 - correlation that is rounding

/// Sum of a[i] * b[i] in double, in an order that does not depend on how wide the processor is.
double product_sum(const float* a, const float* b, size_t count, double mean_a, double mean_b) {
    std::array<double, 8> parts{};
    const size_t whole = count / parts.size() * parts.size();
    run_wide([=, sums = parts.data()]() CITYSTREAM_INLINED {
        for (size_t i = 0; i < whole; i += 8) {
            for (size_t k = 0; k < 8; ++k)
                sums[k] += (static_cast<double>(a[i + k]) - mean_a) * (static_cast<double>(b[i + k]) - mean_b);
        }
    });
    double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
    for (size_t i = whole; i < count; ++i)
        sum += (static_cast<double>(a[i]) - mean_a) * (static_cast<double>(b[i]) - mean_b);
    return sum;
}

double deviation_of(const std::vector<float>& values, double mean) {
    return std::sqrt(product_sum(values.data(), values.data(), values.size(), mean, mean));
}

/// Sum of the squared differences of an encoded picture and one that is yet to be encoded.
double squared_difference(const float* encoded, std::span<const float> linear) {
    std::array<float, kPiece> squares;
    double sum = 0;
    for (size_t start = 0; start < linear.size(); start += kPiece) {
        const size_t count = std::min(kPiece, linear.size() - start);
        encode_srgb(linear.subspan(start, count), {squares.data(), count});
        run_wide([reference = encoded + start, values = squares.data(), count]() CITYSTREAM_INLINED {
            for (size_t i = 0; i < count; ++i) {
                const float difference = values[i] - reference[i];
                values[i] = difference * difference;
            }
        });
        sum += sum_of({squares.data(), count});
    }
    return sum;
}

}  // namespace

IntensityReference::IntensityReference(const Image& linear) : area_(linear.area()), encoded_(linear.texels.size()) {
    assert(!linear.empty());
    encode_srgb(linear.texels, encoded_);
    mean_ = sum_of(encoded_) / static_cast<double>(encoded_.size());
    deviation_ = deviation_of(encoded_, mean_);
}

double IntensityReference::rmse(const ImageRows& linear, double limit) const {
    assert(size_t{linear.width} * linear.height == area_ && area_ * linear.channels == encoded_.size());
    const auto values = static_cast<double>(encoded_.size());
    double sum = 0;
    visit_strips(linear, [&](uint32_t y, const Image& strip) {
        for (uint32_t c = 0; c < strip.channels; ++c)
            sum += squared_difference(&encoded_[c * area_ + size_t{y} * strip.width], strip.plane(c));
        return sum <= limit * limit * values;
    });
    return std::sqrt(sum / values);
}

double IntensityReference::template_match(const Image& linear) const {
    assert(linear.texels.size() == encoded_.size());
    std::vector<float> test(encoded_.size());
    encode_srgb(linear.texels, test);
    const double mean = sum_of(test) / static_cast<double>(test.size()), deviation = deviation_of(test, mean);
    const double flat = kFlat * std::sqrt(static_cast<double>(test.size()));
    if (deviation < flat || deviation_ < flat) return deviation < flat && deviation_ < flat ? 0 : 1;
    const double correlation =
        product_sum(encoded_.data(), test.data(), test.size(), mean_, mean) / (deviation_ * deviation);
    return 1 - correlation < kSameWithin ? 0 : std::min(1 - correlation, 2.0);
}

double IntensityReference::normalised_rmse(const Image& linear) const {
    return std::sqrt(template_match(linear) / 2);
}

}  // namespace citystream::codec::atlas
