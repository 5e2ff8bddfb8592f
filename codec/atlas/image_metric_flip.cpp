#include "codec/atlas/image_metric_flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "codec/atlas/image_metric_filter.h"
#include "codec/atlas/image_metric_lab.h"
#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kBandRows = 96;  ///< compared at a time, so that the planes stay in the cache

struct Colour {
    float r, g, b;  // or x, y, z, or three opponent channels
};

constexpr Colour kWhite = {0.950428545f, 1.0f, 1.088900371f};  // D65 XYZ of linear sRGB white

inline CITYSTREAM_INLINED Colour xyz_of(Colour c) {
    return {0.4124564f * c.r + 0.3575761f * c.g + 0.1804375f * c.b,
            0.2126729f * c.r + 0.7151522f * c.g + 0.0721750f * c.b,
            0.0193339f * c.r + 0.1191920f * c.g + 0.9503041f * c.b};
}

inline CITYSTREAM_INLINED Colour linear_of_xyz(Colour c) {
    return {3.2404542f * c.r - 1.5371385f * c.g - 0.4985314f * c.b,
            -0.9692660f * c.r + 1.8760108f * c.g + 0.0415560f * c.b,
            0.0556434f * c.r - 0.2040259f * c.g + 1.0572252f * c.b};
}

// Linearised L*a*b* (section 4.1.1).
inline CITYSTREAM_INLINED Colour opponent_of(Colour xyz) {
    const float x = xyz.r / kWhite.r, y = xyz.g, z = xyz.b / kWhite.b;
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

inline CITYSTREAM_INLINED Colour xyz_of_opponent(Colour c) {
    const float y = (c.r + 16) * (1.0f / 116), x = y + c.g * (1.0f / 500), z = y - c.b * (1.0f / 200);
    return {x * kWhite.r, y, z * kWhite.b};
}

// CIE L*a*b* with the Hunt adjustment of the chroma (section 4.1.2).
inline CITYSTREAM_INLINED Colour hunt_lab_of(Colour linear) {
    const Colour xyz = xyz_of(linear);
    const float fx = lab_root(xyz.r / kWhite.r), fy = lab_root(xyz.g), fz = lab_root(xyz.b / kWhite.b);
    const float lightness = 116 * fy - 16;
    return {lightness, 0.01f * lightness * 500 * (fx - fy), 0.01f * lightness * 200 * (fy - fz)};
}

inline CITYSTREAM_INLINED float hyab(Colour a, Colour b) {
    const float da = a.g - b.g, db = a.b - b.b;
    return std::abs(a.r - b.r) + std::sqrt(da * da + db * db);
}

inline CITYSTREAM_INLINED float unit(float value) {
    const float low = value > 0 ? value : 0;
    return low < 1 ? low : 1;
}

using Planes = std::array<float*, 3>;

Planes planes_of(Image& image) {
    return {image.plane(0).data(), image.plane(1).data(), image.plane(2).data()};
}

/// From row `y` on.
std::array<const float*, 3> planes_of(const Image& image, uint32_t y) {
    return {image.row(0, y).data(), image.row(1, y).data(), image.row(2, y).data()};
}

Image opponent_image(const Image& linear) {
    Image out(linear.width, linear.height, 3);
    run_wide([from = planes_of(linear, 0), to = planes_of(out), area = out.area()]() CITYSTREAM_INLINED {
        const auto [first, second, third] = to;
        CITYSTREAM_INDEPENDENT
        for (size_t i = 0; i < area; ++i) {
            const Colour c = opponent_of(xyz_of({from[0][i], from[1][i], from[2][i]}));
            first[i] = c.r;
            second[i] = c.g;
            third[i] = c.b;
        }
    });
    return out;
}

Image plane_of(const Image& image, uint32_t channel) {
    Image out(image.width, image.height, 1);
    std::copy_n(image.plane(channel).data(), image.area(), out.texels.begin());
    return out;
}

/// One Gaussian of a contrast sensitivity filter in the frequency domain: a sqrt(pi / b) exp(-pi^2 r^2 / b), r in
/// degrees (table 1).
struct Term {
    double a, b;
};

/// Of all terms alike: three sigma of the widest.
uint32_t support_of(double pixels_per_degree) {
    constexpr double kPi = std::numbers::pi;
    return static_cast<uint32_t>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * pixels_per_degree));
}

/// Sum of the terms, as filters in space that add up to one.
Image contrast_filtered(const Image& plane, const std::vector<Term>& terms, double pixels_per_degree) {
    constexpr double kPi = std::numbers::pi, kReach = 5.5;  // beyond, a Gaussian is below 3e-7
    const double support = support_of(pixels_per_degree);
    std::vector<double> shares;
    std::vector<Image> parts;
    for (const Term& term : terms) {
        const double sigma = std::sqrt(term.b / (2 * kPi * kPi)) * pixels_per_degree;
        double line = 0;
        for (double i = -support; i <= support; ++i) line += std::exp(-i * i / (2 * sigma * sigma));
        shares.push_back(term.a * std::sqrt(kPi / term.b) * line * line);
        const auto radius = static_cast<uint32_t>(std::min(support, std::ceil(kReach * sigma)));
        parts.push_back(filter_both(plane, gaussian_kernel(sigma, radius), Beyond::kEdge));
    }
    if (parts.size() == 1) return std::move(parts[0]);
    double total = 0;
    for (const double share : shares) total += share;
    Image out(plane.width, plane.height, 1);
    std::vector<const float*> rows;
    std::vector<float> weights;
    for (size_t i = 0; i < parts.size(); ++i) {
        rows.push_back(parts[i].texels.data());
        weights.push_back(static_cast<float>(shares[i] / total));
    }
    weighted_sum(rows.data(), weights.data(), rows.size(), out.texels.data(), out.area());
    return out;
}

/// Hunt-adjusted L*a*b* of what is left of the opponent channels.
Image filtered_lab(const Image& luminance, const Image& red_green, const Image& blue_yellow) {
    Image out(luminance.width, luminance.height, 3);
    const float *y = luminance.texels.data(), *rg = red_green.texels.data(), *by = blue_yellow.texels.data();
    run_wide([=, to = planes_of(out), area = out.area()]() CITYSTREAM_INLINED {
        const auto [first, second, third] = to;
        CITYSTREAM_INDEPENDENT
        for (size_t i = 0; i < area; ++i) {
            const Colour linear = linear_of_xyz(xyz_of_opponent({y[i], rg[i], by[i]}));
            const Colour lab = hunt_lab_of({unit(linear.r), unit(linear.g), unit(linear.b)});
            first[i] = lab.r;
            second[i] = lab.g;
            third[i] = lab.b;
        }
    });
    return out;
}

double feature_sigma(double pixels_per_degree) {
    return 0.5 * 0.082 * pixels_per_degree;
}

uint32_t feature_radius(double pixels_per_degree) {
    return static_cast<uint32_t>(std::ceil(3 * feature_sigma(pixels_per_degree)));
}

/// Derivatives of a Gaussian along one axis, positive and negative weights each summing to one in size (section 4.2).
Kernel feature_kernel(double sigma, int radius, bool second) {
    std::vector<double> weights;
    for (int i = -radius; i <= radius; ++i) {
        const double g = std::exp(-i * i / (2 * sigma * sigma));
        weights.push_back(second ? (i * i / (sigma * sigma) - 1) * g : -i * g);
    }
    double positive = 0, negative = 0;
    for (const double weight : weights) (weight > 0 ? positive : negative) += std::abs(weight);
    Kernel kernel;
    for (const double weight : weights)
        kernel.push_back(static_cast<float>(weight == 0 ? 0 : weight / (weight > 0 ? positive : negative)));
    return kernel;
}

Image length_of(const Image& across, const Image& up) {
    Image out(across.width, across.height, 1);
    run_wide([x = across.texels.data(), y = up.texels.data(), to = out.texels.data(), area = out.area()]()
                 CITYSTREAM_INLINED {
                     for (size_t i = 0; i < area; ++i) to[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
                 });
    return out;
}

}  // namespace

FlipReference::Features FlipReference::features_of(const Image& linear) const {
    const double ppd = pixels_per_degree_;
    const Image opponent = opponent_image(linear), luminance = plane_of(opponent, 0);
    Features out;
    out.lab = filtered_lab(contrast_filtered(luminance, {{1, 0.0047}}, ppd),
                           contrast_filtered(plane_of(opponent, 1), {{1, 0.0053}}, ppd),
                           contrast_filtered(plane_of(opponent, 2), {{34.1, 0.04}, {13.5, 0.025}}, ppd));
    Image y = luminance;
    run_wide([values = y.texels.data(), count = y.area()]() CITYSTREAM_INLINED {
        for (size_t i = 0; i < count; ++i) values[i] = (values[i] + 16) * (1.0f / 116);
    });
    const double sigma = feature_sigma(ppd);
    const uint32_t radius = feature_radius(ppd);
    const Kernel smooth = gaussian_kernel(sigma, radius),
                 first = feature_kernel(sigma, static_cast<int>(radius), false),
                 second = feature_kernel(sigma, static_cast<int>(radius), true);
    const Image smooth_rows = filter_rows(y, smooth, Beyond::kEdge);
    out.edge = length_of(filter_columns(filter_rows(y, first, Beyond::kEdge), smooth, Beyond::kEdge),
                         filter_columns(smooth_rows, first, Beyond::kEdge));
    out.point = length_of(filter_columns(filter_rows(y, second, Beyond::kEdge), smooth, Beyond::kEdge),
                          filter_columns(smooth_rows, second, Beyond::kEdge));
    return out;
}

FlipReference::FlipReference(const Image& linear, double pixels_per_degree)
    : pixels_per_degree_(pixels_per_degree), reference_(features_of(linear)) {
    assert(linear.channels == 3 && !linear.empty() && pixels_per_degree > 0);
}

/// Differences of `rows` rows, from row `in_a` of one picture's features and row `in_b` of the other's.
void FlipReference::compare(const Features& test, uint32_t in_a, uint32_t in_b, uint32_t rows, float* out) const {
    constexpr float kColourExponent = 0.7f, kKnee = 0.4f, kKneeValue = 0.95f;
    const float largest = fast_pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), kColourExponent);
    const float knee = kKnee * largest;
    const float *edge_a = reference_.edge.row(0, in_a).data(), *edge_b = test.edge.row(0, in_b).data(),
                *point_a = reference_.point.row(0, in_a).data(), *point_b = test.point.row(0, in_b).data();
    run_wide([=, lab_a = planes_of(reference_.lab, in_a), lab_b = planes_of(test.lab, in_b),
              area = size_t{rows} * test.edge.width]() CITYSTREAM_INLINED {
        CITYSTREAM_INDEPENDENT
        for (size_t i = 0; i < area; ++i) {
            const float distance =
                hyab({lab_a[0][i], lab_a[1][i], lab_a[2][i]}, {lab_b[0][i], lab_b[1][i], lab_b[2][i]});
            const float raw = fast_pow(distance, kColourExponent);
            const float below = raw * (kKneeValue / knee);
            const float above = kKneeValue + (raw - knee) / (largest - knee) * (1 - kKneeValue);
            const float colour = unit(raw < knee ? below : above);
            const float edge = std::abs(edge_a[i] - edge_b[i]), point = std::abs(point_a[i] - point_b[i]);
            const float feature = std::sqrt((edge > point ? edge : point) * (1 / std::numbers::sqrt2_v<float>));
            const float flip = fast_pow(colour, 1 - unit(feature));
            out[i] = distance > 0 ? flip : 0.0f;
        }
    });
}

template <typename Visit>
void FlipReference::visit_bands(const Image& linear, const Visit& visit) const {
    assert(linear.width == reference_.lab.width && linear.height == reference_.lab.height && linear.channels == 3);
    const uint32_t halo = std::max(support_of(pixels_per_degree_), feature_radius(pixels_per_degree_));
    std::vector<float> differences(size_t{kBandRows} * linear.width);
    for (uint32_t y = 0; y < linear.height; y += kBandRows) {
        const uint32_t rows = std::min(kBandRows, linear.height - y), below = std::min(halo, y);
        const uint32_t above = std::min(halo, linear.height - y - rows);
        Image band(linear.width, below + rows + above, 3);
        for (uint32_t c = 0; c < 3; ++c)
            std::copy_n(linear.row(c, y - below).data(), band.area(), band.plane(c).data());
        compare(features_of(band), y, below, rows, differences.data());
        if (!visit(y, std::span<const float>(differences.data(), size_t{rows} * linear.width))) return;
    }
}

std::vector<float> FlipReference::map(const Image& linear) const {
    std::vector<float> out(linear.area());
    visit_bands(linear, [&](uint32_t y, std::span<const float> differences) {
        std::copy(differences.begin(), differences.end(), &out[size_t{y} * linear.width]);
        return true;
    });
    return out;
}

double FlipReference::mean(const Image& linear, double limit) const {
    const auto area = static_cast<double>(linear.area());
    double sum = 0;
    visit_bands(linear, [&](uint32_t, std::span<const float> differences) {
        sum += sum_of(differences);
        return sum <= limit * area;
    });
    return sum / area;
}

}  // namespace citystream::codec::atlas
