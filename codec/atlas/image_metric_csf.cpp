#include "codec/atlas/image_metric_csf.h"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/FFT>

#include "codec/atlas/image_metric_filter.h"

namespace citystream::codec::atlas {

namespace {

using Complex = std::complex<double>;

/// Cycles per pixel of coefficient `i` of `n`.
double frequency_of(uint32_t i, uint32_t n) {
    return static_cast<double>(std::min(i, n - i)) / n;
}

/// Mean 0, deviation 1; zeros of a constant picture.
std::vector<Complex> normalised(const Image& luma) {
    const double mean = sum_of(luma.texels) / static_cast<double>(luma.area());
    double squares = 0;
    for (const float value : luma.texels) squares += (value - mean) * (value - mean);
    const double deviation = std::sqrt(squares / static_cast<double>(luma.area()));
    std::vector<Complex> out(luma.area());
    if (deviation < 1e-9) return out;
    for (size_t i = 0; i < out.size(); ++i) out[i] = (luma.texels[i] - mean) / deviation;
    return out;
}

void transform(Eigen::FFT<double>& fft, const std::vector<Complex>& line, std::vector<Complex>& out) {
    if (line.size() == 1) {  // which Eigen's does not take
        out = line;
    } else {
        fft.fwd(out, line);
    }
}

}  // namespace

double mannos_sakrison_filter(double r) {
    return 2.6 * (0.0192 + 0.114 * r) * std::exp(-std::pow(0.114 * r, 1.1));
}

double daly_filter(double r) {
    if (r <= 0) return 0;
    return std::pow(0.008 / (r * r * r) + 1, -0.2) * 1.42 * r *
           std::exp(-0.3 * r * std::sqrt(1 + 0.06 * std::exp(0.3 * r)));
}

double ahumada_filter(double r) {
    return std::exp(-std::pow(r / 97.32, 2)) - 0.685 * std::exp(-std::pow(r / 12.16, 2));
}

SpectrumReference::SpectrumReference(const Image& luma, SensitivityFilter filter, double pixels_per_degree)
    : weight_(luma.area()) {
    assert(luma.channels == 1 && !luma.empty() && pixels_per_degree > 0);
    for (uint32_t y = 0; y < luma.height; ++y) {
        for (uint32_t x = 0; x < luma.width; ++x) {
            const double cycles = std::hypot(frequency_of(x, luma.width), frequency_of(y, luma.height));
            weight_[size_t{y} * luma.width + x] = filter(cycles * pixels_per_degree);
        }
    }
    spectrum_ = filtered_spectrum(luma);
}

SpectrumReference::Spectrum SpectrumReference::filtered_spectrum(const Image& luma) const {
    Spectrum values = normalised(luma), line, transformed;
    Eigen::FFT<double> fft;
    const size_t width = luma.width, height = luma.height;
    for (size_t y = 0; y < height; ++y) {
        line.assign(&values[y * width], &values[y * width] + width);
        transform(fft, line, transformed);
        std::copy(transformed.begin(), transformed.end(), &values[y * width]);
    }
    line.resize(height);
    for (size_t x = 0; x < width; ++x) {
        for (size_t y = 0; y < height; ++y) line[y] = values[y * width + x];
        transform(fft, line, transformed);
        for (size_t y = 0; y < height; ++y) values[y * width + x] = transformed[y] * weight_[y * width + x];
    }
    return values;
}

double SpectrumReference::error(const Image& luma) const {
    assert(luma.area() == spectrum_.size());
    const Spectrum test = filtered_spectrum(luma);
    double difference = 0, total = 0;
    for (size_t i = 0; i < test.size(); ++i) {
        difference += std::norm(test[i] - spectrum_[i]);
        total += std::norm(test[i]) + std::norm(spectrum_[i]);
    }
    return total > 0 ? std::sqrt(difference / (2 * total)) : 0;
}

}  // namespace citystream::codec::atlas
