#include "codec/atlas/image_metric_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

/// The index that stands at `i`.
uint32_t source_of(int64_t i, uint32_t side, Beyond beyond) {
    const int64_t last = side - 1;
    if (i >= 0 && i <= last) return static_cast<uint32_t>(i);
    if (beyond == Beyond::kEdge || last == 0) return static_cast<uint32_t>(i < 0 ? 0 : last);
    const int64_t period = 2 * last, rest = ((i % period) + period) % period;
    return static_cast<uint32_t>(std::min(rest, period - rest));
}

}  // namespace

Kernel gaussian_kernel(double sigma, uint32_t radius) {
    std::vector<double> weights(2 * radius + 1);
    for (uint32_t i = 0; i < weights.size(); ++i) {
        const double x = static_cast<double>(i) - radius;
        weights[i] = std::exp(-x * x / (2 * sigma * sigma));
    }
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    Kernel kernel(weights.size());
    std::transform(weights.begin(), weights.end(), kernel.begin(),
                   [sum](double weight) { return static_cast<float>(weight / sum); });
    return kernel;
}

Image filter_rows(const Image& image, const Kernel& kernel, Beyond beyond) {
    assert(kernel.size() % 2 == 1);
    const uint32_t width = image.width, rows_in_all = image.height * image.channels;
    const size_t radius = kernel.size() / 2;
    Image out(width, image.height, image.channels);
    std::vector<float> padded(width + 2 * radius);
    std::vector<const float*> shifted(kernel.size());
    for (size_t k = 0; k < kernel.size(); ++k) shifted[k] = &padded[k];
    for (uint32_t y = 0; y < rows_in_all; ++y) {
        const float* row = &image.texels[size_t{y} * width];
        std::copy_n(row, width, &padded[radius]);
        for (size_t i = 0; i < radius; ++i) {
            padded[i] = row[source_of(static_cast<int64_t>(i) - static_cast<int64_t>(radius), width, beyond)];
            padded[radius + width + i] = row[source_of(static_cast<int64_t>(width + i), width, beyond)];
        }
        weighted_sum(shifted.data(), kernel.data(), kernel.size(), &out.texels[size_t{y} * width], width);
    }
    return out;
}

Image filter_columns(const Image& image, const Kernel& kernel, Beyond beyond) {
    assert(kernel.size() % 2 == 1);
    const auto radius = static_cast<int64_t>(kernel.size() / 2);
    Image out(image.width, image.height, image.channels);
    std::vector<const float*> rows(kernel.size());
    for (uint32_t c = 0; c < image.channels; ++c) {
        for (uint32_t y = 0; y < image.height; ++y) {
            for (size_t k = 0; k < kernel.size(); ++k) {
                const int64_t source = static_cast<int64_t>(y + k) - radius;
                rows[k] = image.row(c, source_of(source, image.height, beyond)).data();
            }
            weighted_sum(rows.data(), kernel.data(), kernel.size(), out.row(c, y).data(), image.width);
        }
    }
    return out;
}

Image filter_both(const Image& image, const Kernel& kernel, Beyond beyond) {
    return filter_columns(filter_rows(image, kernel, beyond), kernel, beyond);
}

double sum_of(std::span<const float> values) {
    // Eight partial sums, as many as the widest loop has lanes.
    std::array<double, 8> parts{};
    const float* from = values.data();
    const size_t whole = values.size() / parts.size() * parts.size();
    run_wide([from, whole, sums = parts.data()]() CITYSTREAM_INLINED {
        for (size_t i = 0; i < whole; i += 8) {
            for (size_t k = 0; k < 8; ++k) sums[k] += static_cast<double>(from[i + k]);
        }
    });
    double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
    for (size_t i = whole; i < values.size(); ++i) sum += static_cast<double>(values[i]);
    return sum;
}

}  // namespace citystream::codec::atlas
