#include "client/report/image_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace citystream::client {
namespace {

/// One channel of a picture.
struct Plane {
    size_t width = 0, height = 0;
    std::vector<float> values;
    Plane(size_t w, size_t h) : width(w), height(h), values(w * h) {}
};

using Kernel = std::vector<double>;  // odd length, centred

Kernel gaussian(double sigma, int radius) {
    Kernel kernel;
    for (int i = -radius; i <= radius; ++i) kernel.push_back(std::exp(-i * i / (2 * sigma * sigma)));
    const double sum = std::accumulate(kernel.begin(), kernel.end(), 0.0);
    for (double& weight : kernel) weight /= sum;
    return kernel;
}

// Rows by `along_x`, then columns by `along_y`; edges are repeated. The inner loops run along memory, so that they
// vectorise.
Plane convolve(const Plane& in, const Kernel& along_x, const Kernel& along_y) {
    const size_t width = in.width, height = in.height, radius_x = along_x.size() / 2, radius_y = along_y.size() / 2;
    Plane rows(width, height), out(width, height);
    std::vector<float> padded(width + 2 * radius_x);
    for (size_t y = 0; y < height; ++y) {
        const float* source = &in.values[y * width];
        std::fill_n(padded.begin(), radius_x, source[0]);
        std::copy_n(source, width, padded.begin() + static_cast<long>(radius_x));
        std::fill_n(padded.end() - static_cast<long>(radius_x), radius_x, source[width - 1]);
        for (size_t i = 0; i < along_x.size(); ++i) {
            const auto weight = static_cast<float>(along_x[i]);
            for (size_t x = 0; x < width; ++x) rows.values[y * width + x] += weight * padded[x + i];
        }
    }
    for (size_t y = 0; y < height; ++y) {
        for (size_t i = 0; i < along_y.size(); ++i) {
            const size_t source = std::clamp(y + i, radius_y, height - 1 + radius_y) - radius_y;
            const auto weight = static_cast<float>(along_y[i]);
            for (size_t x = 0; x < width; ++x) out.values[y * width + x] += weight * rows.values[source * width + x];
        }
    }
    return out;
}

Plane luma_of(const FrameImage& image) {
    Plane out(image.width, image.height);
    for (size_t i = 0; i < out.values.size(); ++i)
        out.values[i] = 0.299f * image.rgba[4 * i] + 0.587f * image.rgba[4 * i + 1] + 0.114f * image.rgba[4 * i + 2];
    return out;
}

Plane product(const Plane& a, const Plane& b) {
    Plane out(a.width, a.height);
    for (size_t i = 0; i < out.values.size(); ++i) out.values[i] = a.values[i] * b.values[i];
    return out;
}

double mean_ssim(const FrameImage& reference, const FrameImage& test) {
    const Kernel window = gaussian(1.5, 5);
    const Plane a = luma_of(reference), b = luma_of(test);
    const Plane mean_a = convolve(a, window, window), mean_b = convolve(b, window, window);
    const Plane aa = convolve(product(a, a), window, window), bb = convolve(product(b, b), window, window);
    const Plane ab = convolve(product(a, b), window, window);
    const double c1 = std::pow(0.01 * 255, 2), c2 = std::pow(0.03 * 255, 2);
    double sum = 0;
    for (size_t i = 0; i < a.values.size(); ++i) {
        const double ma = mean_a.values[i], mb = mean_b.values[i];
        const double va = aa.values[i] - ma * ma, vb = bb.values[i] - mb * mb, cov = ab.values[i] - ma * mb;
        sum += ((2 * ma * mb + c1) * (2 * cov + c2)) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
    }
    return sum / static_cast<double>(a.values.size());
}

using Colour = std::array<double, 3>;

constexpr Colour kWhite = {0.950428545, 1.0, 1.088900371};  // D65 XYZ of linear sRGB white

double linear_of(double srgb) {
    return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

Colour xyz_of(const Colour& c) {
    return {0.4124564 * c[0] + 0.3575761 * c[1] + 0.1804375 * c[2],
            0.2126729 * c[0] + 0.7151522 * c[1] + 0.0721750 * c[2],
            0.0193339 * c[0] + 0.1191920 * c[1] + 0.9503041 * c[2]};
}

Colour linear_of_xyz(const Colour& c) {
    return {3.2404542 * c[0] - 1.5371385 * c[1] - 0.4985314 * c[2],
            -0.9692660 * c[0] + 1.8760108 * c[1] + 0.0415560 * c[2],
            0.0556434 * c[0] - 0.2040259 * c[1] + 1.0572252 * c[2]};
}

// Linearised L*a*b* (Andersson et al. 2020, section 4.1.1).
Colour opponent_of(const Colour& xyz) {
    const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Colour xyz_of_opponent(const Colour& c) {
    const double y = (c[0] + 16) / 116, x = y + c[1] / 500, z = y - c[2] / 200;
    return {x * kWhite[0], y * kWhite[1], z * kWhite[2]};
}

// CIE L*a*b* with the Hunt adjustment of the chroma (section 4.1.2).
Colour hunt_lab_of(const Colour& linear) {
    const Colour xyz = xyz_of(linear);
    const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : t * (841.0 / 108) + 4.0 / 29; };
    const double fx = f(xyz[0] / kWhite[0]), fy = f(xyz[1] / kWhite[1]), fz = f(xyz[2] / kWhite[2]);
    const double lightness = 116 * fy - 16;
    return {lightness, 0.01 * lightness * 500 * (fx - fy), 0.01 * lightness * 200 * (fy - fz)};
}

double hyab(const Colour& a, const Colour& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

std::array<Plane, 3> opponent_planes(const FrameImage& image) {
    std::array<Plane, 3> out = {Plane(image.width, image.height), Plane(image.width, image.height),
                                Plane(image.width, image.height)};
    std::array<double, 256> linear{};
    for (size_t i = 0; i < 256; ++i) linear[i] = linear_of(static_cast<double>(i) / 255);
    for (size_t i = 0; i < out[0].values.size(); ++i) {
        const Colour c = opponent_of(
            xyz_of({linear[image.rgba[4 * i]], linear[image.rgba[4 * i + 1]], linear[image.rgba[4 * i + 2]]}));
        for (size_t k = 0; k < 3; ++k) out[k].values[i] = static_cast<float>(c[k]);
    }
    return out;
}

// Contrast sensitivity filters: sums of Gaussians a * sqrt(pi / b) * exp(-pi^2 r^2 / b), r in degrees (table 1).
std::array<Plane, 3> contrast_filtered(const std::array<Plane, 3>& planes, double pixels_per_degree) {
    struct Term {
        double a, b;
    };
    const std::array<std::vector<Term>, 3> filters = {{{{1, 0.0047}}, {{1, 0.0053}}, {{34.1, 0.04}, {13.5, 0.025}}}};
    const double pi = std::numbers::pi;
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    std::array<Plane, 3> out = planes;
    for (size_t k = 0; k < 3; ++k) {
        std::vector<double> shares;
        std::vector<Kernel> kernels;
        for (const Term& term : filters[k]) {
            const double sigma = std::sqrt(term.b / (2 * pi * pi)) * pixels_per_degree;
            kernels.push_back(gaussian(sigma, radius));
            double line = 0;
            for (int i = -radius; i <= radius; ++i) line += std::exp(-i * i / (2 * sigma * sigma));
            shares.push_back(term.a * std::sqrt(pi / term.b) * line * line);
        }
        const double total = std::accumulate(shares.begin(), shares.end(), 0.0);
        std::fill(out[k].values.begin(), out[k].values.end(), 0.0f);
        for (size_t t = 0; t < kernels.size(); ++t) {
            const Plane part = convolve(planes[k], kernels[t], kernels[t]);
            for (size_t i = 0; i < part.values.size(); ++i)
                out[k].values[i] += static_cast<float>(shares[t] / total) * part.values[i];
        }
    }
    return out;
}

Colour filtered_hunt_lab(const std::array<Plane, 3>& planes, size_t i) {
    Colour linear = linear_of_xyz(xyz_of_opponent({planes[0].values[i], planes[1].values[i], planes[2].values[i]}));
    for (double& channel : linear) channel = std::clamp(channel, 0.0, 1.0);
    return hunt_lab_of(linear);
}

/// Derivatives of a Gaussian along one axis, positive and negative weights each summing to one in size (section 4.2).
Kernel feature_kernel(double sigma, int radius, bool second) {
    Kernel kernel;
    for (int i = -radius; i <= radius; ++i) {
        const double g = std::exp(-i * i / (2 * sigma * sigma));
        kernel.push_back(second ? (i * i / (sigma * sigma) - 1) * g : -i * g);
    }
    double positive = 0, negative = 0;
    for (const double weight : kernel) (weight > 0 ? positive : negative) += std::abs(weight);
    for (double& weight : kernel) weight /= weight > 0 ? positive : negative;
    return kernel;
}

Plane feature_strength(const Plane& opponent_y, double pixels_per_degree, bool second) {
    Plane y = opponent_y;
    for (float& value : y.values) value = (value + 16) / 116;
    const double sigma = 0.5 * 0.082 * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    const Kernel derivative = feature_kernel(sigma, radius, second), smooth = gaussian(sigma, radius);
    Plane out = convolve(y, derivative, smooth);
    const Plane across = convolve(y, smooth, derivative);
    for (size_t i = 0; i < out.values.size(); ++i) out.values[i] = std::hypot(out.values[i], across.values[i]);
    return out;
}

}  // namespace

double psnr(const FrameImage& reference, const FrameImage& test) {
    uint64_t sum = 0;
    const size_t pixels = size_t{reference.width} * reference.height;
    for (size_t i = 0; i < pixels; ++i) {
        for (size_t c = 0; c < 3; ++c) {
            const int difference = int{reference.rgba[4 * i + c]} - int{test.rgba[4 * i + c]};
            sum += static_cast<uint64_t>(difference * difference);
        }
    }
    if (sum == 0) return std::numeric_limits<double>::infinity();
    return 10 * std::log10(255.0 * 255.0 * static_cast<double>(3 * pixels) / static_cast<double>(sum));
}

std::vector<float> flip_map(const FrameImage& reference, const FrameImage& test, double pixels_per_degree) {
    constexpr double kColourExponent = 0.7, kFeatureExponent = 0.5, kKnee = 0.4, kKneeValue = 0.95;
    const auto planes_a = opponent_planes(reference), planes_b = opponent_planes(test);
    const auto filtered_a = contrast_filtered(planes_a, pixels_per_degree),
               filtered_b = contrast_filtered(planes_b, pixels_per_degree);
    const Plane edge_a = feature_strength(planes_a[0], pixels_per_degree, false),
                edge_b = feature_strength(planes_b[0], pixels_per_degree, false);
    const Plane point_a = feature_strength(planes_a[0], pixels_per_degree, true),
                point_b = feature_strength(planes_b[0], pixels_per_degree, true);
    const double largest = std::pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), kColourExponent);
    std::vector<float> out(edge_a.values.size());
    for (size_t i = 0; i < out.size(); ++i) {
        const double raw =
            std::pow(hyab(filtered_hunt_lab(filtered_a, i), filtered_hunt_lab(filtered_b, i)), kColourExponent);
        const double knee = kKnee * largest;
        const double colour =
            raw < knee ? raw * kKneeValue / knee : kKneeValue + (raw - knee) / (largest - knee) * (1 - kKneeValue);
        const double feature =
            std::max(std::abs(edge_a.values[i] - edge_b.values[i]), std::abs(point_a.values[i] - point_b.values[i]));
        const double feature_difference = std::pow(feature / std::numbers::sqrt2, kFeatureExponent);
        out[i] = static_cast<float>(std::pow(std::clamp(colour, 0.0, 1.0), 1 - std::min(feature_difference, 1.0)));
    }
    return out;
}

Result<ImageDifference> compare_images(const FrameImage& reference, const FrameImage& test,
                                       std::vector<float>* flip_per_pixel) {
    if (reference.width != test.width || reference.height != test.height || reference.width == 0 ||
        reference.height == 0)
        return Error{"pictures of different or zero size cannot be compared"};
    ImageDifference out;
    out.psnr_db = psnr(reference, test);
    out.ssim = mean_ssim(reference, test);
    std::vector<float> map = flip_map(reference, test);
    out.flip = std::accumulate(map.begin(), map.end(), 0.0) / static_cast<double>(map.size());
    if (flip_per_pixel) *flip_per_pixel = std::move(map);
    return out;
}

}  // namespace citystream::client
