#include "codec/atlas/image_metric_hvse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "codec/atlas/image_metric_filter.h"
#include "codec/atlas/image_metric_lab.h"
#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

constexpr float kDarkest = 1e-5f;             // cd/m^2; keeps logarithms and quotients finite
constexpr float kPeakSensitivity = 525.154f;  // csf(3.248, 100)
constexpr float kMostElevation = 10;
constexpr float kMesopic = 10;       // cd/m^2 of adaptation below which colour is not compared
constexpr float kNeverSeen = 1e30f;  // no colour differs by so much
constexpr float kLog10Of2 = 0.301029996f;

using Matrix = std::array<std::array<float, 3>, 3>;
constexpr Matrix kSrgb = {
    {{0.4124564f, 0.3575761f, 0.1804375f}, {0.2126729f, 0.7151522f, 0.0721750f}, {0.0193339f, 0.1191920f, 0.9503041f}}};
constexpr Matrix kAdobe = {
    {{0.5767f, 0.185556f, 0.188212f}, {0.297361f, 0.627355f, 0.0752847f}, {0.0270328f, 0.0706879f, 0.991248f}}};

/// contrast_sensitivity / A, of e^(-Bc): sqrt(e^(-2Bc) + .06 e^(-Bc)) is the printed e^(-Bc) sqrt(1 + .06 e^(Bc))
/// without its overflow.
inline CITYSTREAM_INLINED float fast_sensitivity(float cycles, float luminance) {
    const float a = 440 * fast_pow(1 + 0.7f / luminance, -0.2f);
    const float b = 0.3f * fast_pow(1 + 100 / luminance, 0.15f);
    const float decay = fast_exp2(-b * cycles * std::numbers::log2e_v<float>);
    return a * cycles * std::sqrt(decay * decay + 0.06f * decay);
}

inline CITYSTREAM_INLINED float fast_masking(float contrast) {
    const float k = 0.0153f * fast_pow(392.498f * contrast, 0.7f), k2 = k * k;
    return std::sqrt(std::sqrt(1 + k2 * k2));
}

inline CITYSTREAM_INLINED float at_least(float value, float least) {
    return value > least ? value : least;
}

inline CITYSTREAM_INLINED float fast_visibility(float adaptation) {
    const float x = fast_log2(adaptation) * kLog10Of2;
    const float scotopic = fast_pow(at_least(0.405f * x + 1.6f, 0), 2.18f) - 2.86f;
    const float mesopic = fast_pow(at_least(0.249f * x + 0.65f, 0), 2.7f) - 0.72f;
    float r = x < 1.9f ? mesopic : x - 1.255f;
    r = x < -0.0184f ? x - 0.395f : r;
    r = x < -1.44f ? scotopic : r;
    r = x < -3.94f ? -2.86f : r;
    return fast_exp2(r * (1 / kLog10Of2));
}

std::array<const float*, 3> first_rows(const Image& image, uint32_t y) {
    return {image.row(0, y).data(), image.row(1, y).data(), image.row(2, y).data()};
}

uint32_t adaptation_level_of(double pixels, uint32_t levels) {
    uint32_t level = 0;
    while (level + 1 < levels && std::ldexp(1.0, static_cast<int>(level)) <= pixels) ++level;
    return level;
}

}  // namespace

double contrast_sensitivity(double cycles_per_degree, double luminance) {
    const double light = std::max<double>(luminance, kDarkest);
    const double a = 440 * std::pow(1 + 0.7 / light, -0.2), b = 0.3 * std::pow(1 + 100 / light, 0.15);
    const double decay = std::exp(-b * cycles_per_degree);
    return a * cycles_per_degree * std::sqrt(decay * decay + 0.06 * decay);
}

double contrast_masking(double contrast) {
    return std::pow(1 + std::pow(0.0153 * std::pow(392.498 * contrast, 0.7), 4), 0.25);
}

double threshold_of_visibility(double adaptation) {
    const double x = std::log10(std::max<double>(adaptation, kDarkest));
    double r = x - 1.255;
    if (x < -3.94) {
        r = -2.86;
    } else if (x < -1.44) {
        r = std::pow(0.405 * x + 1.6, 2.18) - 2.86;
    } else if (x < -0.0184) {
        r = x - 0.395;
    } else if (x < 1.9) {
        r = std::pow(0.249 * x + 0.65, 2.7) - 0.72;
    }
    return std::pow(10, r);
}

double pixels_per_degree(double width, double fov_degrees) {
    return width * std::numbers::pi / (360 * std::tan(fov_degrees * std::numbers::pi / 360));
}

Image HvseReference::appearance_of(const Image& linear) const {
    assert(linear.channels == 3 && !linear.empty());
    const Matrix& m = settings_.adobe_primaries ? kAdobe : kSrgb;
    Matrix scaled = m;  // rows divided by white
    for (auto& row : scaled) {
        const float white = row[0] + row[1] + row[2];
        for (float& value : row) value /= white;
    }
    const float luminance = static_cast<float>(settings_.luminance) * (m[1][0] + m[1][1] + m[1][2]);
    Image out(linear.width, linear.height, 3);
    const float *r = linear.plane(0).data(), *g = linear.plane(1).data(), *b = linear.plane(2).data();
    float *light = out.plane(0).data(), *red_green = out.plane(1).data(), *yellow_blue = out.plane(2).data();
    run_wide([=, area = out.area()]() CITYSTREAM_INLINED {
        CITYSTREAM_INDEPENDENT
        for (size_t i = 0; i < area; ++i) {
            const float x = scaled[0][0] * r[i] + scaled[0][1] * g[i] + scaled[0][2] * b[i];
            const float y = scaled[1][0] * r[i] + scaled[1][1] * g[i] + scaled[1][2] * b[i];
            const float z = scaled[2][0] * r[i] + scaled[2][1] * g[i] + scaled[2][2] * b[i];
            const float fx = lab_root(x), fy = lab_root(y), fz = lab_root(z);
            light[i] = luminance * y;
            red_green[i] = 500 * (fx - fy);
            yellow_blue[i] = 200 * (fy - fz);
        }
    });
    return out;
}

std::vector<Image> HvseReference::pyramid_of(const Image& appearance) const {
    static const Kernel kernel = {0.05f, 0.25f, 0.4f, 0.25f, 0.05f};
    std::vector<Image> levels(1, Image(appearance.width, appearance.height, 1));
    std::copy_n(appearance.texels.begin(), appearance.area(), levels[0].texels.begin());
    while (levels.size() < kLevels) levels.push_back(filter_both(levels.back(), kernel, Beyond::kMirror));
    return levels;
}

Image HvseReference::limits_of(const std::vector<Image>& a, const std::vector<Image>& b) const {
    // Planes: sum of the contrasts, then of their elevations; at the end the two limits.
    Image out(a[0].width, a[0].height, 2);
    const float *adapted_a = a[adaptation_level_].texels.data(), *adapted_b = b[adaptation_level_].texels.data();
    float *first = out.plane(0).data(), *second = out.plane(1).data();
    for (uint32_t band = 0; band < kBands; ++band) {
        const auto cycles = static_cast<float>(settings_.pixels_per_degree / std::ldexp(2.0, static_cast<int>(band)));
        const float weight = kPeakSensitivity / std::max(1e-6f, static_cast<float>(contrast_sensitivity(cycles, 100)));
        const float *a0 = a[band].texels.data(), *a1 = a[band + 1].texels.data(), *a2 = a[band + 2].texels.data(),
                    *b0 = b[band].texels.data(), *b1 = b[band + 1].texels.data(), *b2 = b[band + 2].texels.data();
        run_wide([=, area = out.area()]() CITYSTREAM_INLINED {
            CITYSTREAM_INDEPENDENT
            for (size_t i = 0; i < area; ++i) {
                const float adaptation = at_least((adapted_a[i] + adapted_b[i]) / 2, kDarkest);
                const float base = at_least(at_least(a2[i], b2[i]), kDarkest);
                const float contrast = at_least(std::abs(a0[i] - a1[i]), std::abs(b0[i] - b1[i])) / base;
                first[i] += contrast;
                second[i] += contrast * weight * fast_masking(contrast * fast_sensitivity(cycles, adaptation));
            }
        });
    }
    run_wide([=, area = out.area()]() CITYSTREAM_INLINED {
        CITYSTREAM_INDEPENDENT
        for (size_t i = 0; i < area; ++i) {
            const float adaptation = at_least((adapted_a[i] + adapted_b[i]) / 2, kDarkest);
            const float ratio = at_least(second[i] / at_least(first[i], kDarkest), 1);
            const float elevation = ratio < kMostElevation ? ratio : kMostElevation;
            first[i] = elevation * fast_visibility(adaptation);
            second[i] = adaptation < kMesopic ? kNeverSeen : elevation;
        }
    });
    return out;
}

HvseReference::HvseReference(const Image& linear, const HvseSettings& settings) : settings_(settings) {
    assert(settings.pixels_per_degree > 0 && settings.luminance > 0);
    const double pixels = settings.adaptation_pixels > 0 ? settings.adaptation_pixels : settings.pixels_per_degree;
    adaptation_level_ = adaptation_level_of(pixels, kLevels);
    appearance_ = appearance_of(linear);
    std::vector<Image> pyramid = pyramid_of(appearance_);
    if (settings.test_masks) {
        pyramid_ = std::move(pyramid);
    } else {
        limits_ = limits_of(pyramid, pyramid);
    }
}

double HvseReference::failing(const ImageRows& linear, double limit) const {
    assert(linear.width == appearance_.width && linear.height == appearance_.height);
    if (settings_.test_masks) {
        const Image test = whole_image(linear);
        return failing_within(limits_of(pyramid_, pyramid_of(appearance_of(test))), rows_of(test), limit);
    }
    return failing_within(limits_, linear, limit);
}

double HvseReference::failing_within(const Image& limits, const ImageRows& linear, double limit) const {
    const auto factor = static_cast<float>(settings_.colour_factor);
    const auto area = static_cast<double>(limits.area());
    uint64_t failed = 0;
    visit_strips(linear, [&](uint32_t y, const Image& strip) {
        const Image test = appearance_of(strip);
        const auto a = first_rows(appearance_, y), b = first_rows(test, 0);
        const float *luminance = limits.row(0, y).data(), *colour = limits.row(1, y).data();
        uint32_t in_strip = 0;
        run_wide([=, &in_strip, count = strip.area()]() CITYSTREAM_INLINED {
            uint32_t sum = 0;
            for (size_t i = 0; i < count; ++i) {
                const float light = std::abs(a[0][i] - b[0][i]);
                const float red_green = a[1][i] - b[1][i], yellow_blue = a[2][i] - b[2][i];
                const float squares = factor * (red_green * red_green + yellow_blue * yellow_blue);
                sum += static_cast<uint32_t>(light > luminance[i]) | static_cast<uint32_t>(squares > colour[i]);
            }
            in_strip = sum;
        });
        failed += in_strip;
        return static_cast<double>(failed) <= limit * area;
    });
    return static_cast<double>(failed) / area;
}

}  // namespace citystream::codec::atlas
