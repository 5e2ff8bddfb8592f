#include "codec/atlas/image_metric_hvse.h"

#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/codec/atlas/sample_pictures.h"

namespace citystream::codec::atlas {
namespace {

/// The public predictor, written down pixel by pixel in double from the formulas of notes F6, without any of the
/// shortcuts of the one under test.
class PlainPredictor {
  public:
    PlainPredictor(const Image& a, const Image& b, const HvseSettings& settings) : settings_(settings) {
        for (const Image* image : {&a, &b}) pyramids_.push_back(pyramid(*image));
        lab_a_ = lab_of(a);
        lab_b_ = lab_of(b);
        width_ = a.width;
        height_ = a.height;
    }

    double failing() const {
        size_t failed = 0;
        for (size_t i = 0; i < size_t{width_} * height_; ++i) failed += fails(i) ? 1 : 0;
        return static_cast<double>(failed) / (static_cast<double>(width_) * height_);
    }

  private:
    using Plane = std::vector<double>;

    std::array<double, 3> xyz(const Image& image, size_t i) const {
        static const double adobe[3][3] = {
            {0.5767, 0.185556, 0.188212}, {0.297361, 0.627355, 0.0752847}, {0.0270328, 0.0706879, 0.991248}};
        std::array<double, 3> out{};
        for (uint32_t k = 0; k < 3; ++k)
            for (uint32_t c = 0; c < 3; ++c) out[k] += adobe[k][c] * static_cast<double>(image.plane(c)[i]);
        return out;
    }

    std::vector<Plane> pyramid(const Image& image) const {
        const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
        const auto mirrored = [](int i, int side) {
            if (side == 1) return 0;
            while (i < 0 || i >= side) i = i < 0 ? -i : 2 * (side - 1) - i;
            return i;
        };
        static const double kernel[5] = {0.05, 0.25, 0.4, 0.25, 0.05};
        std::vector<Plane> levels(1);
        for (size_t i = 0; i < image.area(); ++i) levels[0].push_back(xyz(image, i)[1] * settings_.luminance);
        while (levels.size() < 8) {
            Plane next;
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    double sum = 0;
                    for (int j = -2; j <= 2; ++j) {
                        for (int i = -2; i <= 2; ++i) {
                            const int at = mirrored(y + j, height) * width + mirrored(x + i, width);
                            sum += kernel[i + 2] * kernel[j + 2] * levels.back()[static_cast<size_t>(at)];
                        }
                    }
                    next.push_back(sum);
                }
            }
            levels.push_back(next);
        }
        return levels;
    }

    std::array<Plane, 2> lab_of(const Image& image) const {
        const double white[3] = {0.5767 + 0.185556 + 0.188212, 0.297361 + 0.627355 + 0.0752847,
                                 0.0270328 + 0.0706879 + 0.991248};
        std::array<Plane, 2> out;
        for (size_t i = 0; i < image.area(); ++i) {
            const auto c = xyz(image, i);
            double f[3];
            for (size_t k = 0; k < 3; ++k) {
                const double t = c[k] / white[k];
                f[k] = t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
            }
            out[0].push_back(500 * (f[0] - f[1]));
            out[1].push_back(200 * (f[1] - f[2]));
        }
        return out;
    }

    bool fails(size_t i) const {
        const auto& a = pyramids_[0];
        const auto& b = pyramids_[1];
        size_t level = 0;
        while (level < 7 && std::pow(2, level) <= settings_.adaptation_pixels) ++level;
        const double adaptation = std::max(1e-5, (a[level][i] + b[level][i]) / 2);
        double sum = 0, elevated = 0;
        for (size_t k = 0; k < 6; ++k) {
            const double cycles = settings_.pixels_per_degree / 2 / std::pow(2, k);
            const double band = std::max(std::abs(a[k][i] - a[k + 1][i]), std::abs(b[k][i] - b[k + 1][i]));
            const double contrast = band / std::max({a[k + 2][i], b[k + 2][i], 1e-5});
            sum += contrast;
            elevated += contrast * contrast_sensitivity(3.248, 100) / contrast_sensitivity(cycles, 100) *
                        contrast_masking(contrast * contrast_sensitivity(cycles, adaptation));
        }
        const double elevation = std::clamp(elevated / std::max(sum, 1e-5), 1.0, 10.0);
        if (std::abs(a[0][i] - b[0][i]) > elevation * threshold_of_visibility(adaptation)) return true;
        const double da = lab_a_[0][i] - lab_b_[0][i], db = lab_a_[1][i] - lab_b_[1][i];
        return adaptation >= 10 && da * da + db * db > elevation;
    }

    HvseSettings settings_;
    std::vector<std::vector<Plane>> pyramids_;
    std::array<Plane, 2> lab_a_, lab_b_;
    uint32_t width_ = 0, height_ = 0;
};

/// As the public implementations set it, for pictures of this width.
HvseSettings public_settings(uint32_t width) {
    HvseSettings settings;
    settings.pixels_per_degree = pixels_per_degree(width, 45);
    settings.adaptation_pixels = 360 / std::numbers::pi * std::tan(std::numbers::pi / 8);
    settings.test_masks = settings.adobe_primaries = true;
    return settings;
}

TEST(Hvse, SensitivityMaskingAndVisibilityMatchTheirTables) {
    EXPECT_NEAR(contrast_sensitivity(3.248, 100), 525.154, 1e-3);
    for (double cycles = 0.5; cycles < 60; cycles *= 1.3) {
        for (double light = 1e-4; light < 1e4; light *= 7) {
            const double a = 440 * std::pow(1 + 0.7 / light, -0.2), b = 0.3 * std::pow(1 + 100 / light, 0.15);
            const double printed = a * cycles * std::exp(-b * cycles) * std::sqrt(1 + 0.06 * std::exp(b * cycles));
            ASSERT_NEAR(contrast_sensitivity(cycles, light) / printed, 1, 1e-5);
        }
    }
    EXPECT_EQ(contrast_sensitivity(0, 100), 0);
    EXPECT_TRUE(std::isfinite(contrast_sensitivity(1e6, 0)));
    EXPECT_EQ(contrast_masking(0), 1);
    EXPECT_NEAR(contrast_masking(1), std::pow(1 + std::pow(0.0153 * std::pow(392.498, 0.7), 4), 0.25), 1e-5);
    const std::array<std::array<double, 2>, 5> table = {{{1e-4, std::pow(10, -2.86)},
                                                         {1e-2, std::pow(10, std::pow(0.79, 2.18) - 2.86)},
                                                         {0.1, std::pow(10, -1.395)},
                                                         {10, std::pow(10, std::pow(0.899, 2.7) - 0.72)},
                                                         {1000, std::pow(10, 3 - 1.255)}}};
    for (const auto& [light, step] : table) EXPECT_NEAR(threshold_of_visibility(light) / step, 1, 1e-5) << light;
    EXPECT_NEAR(threshold_of_visibility(0), std::pow(10, -2.86), 1e-9);
}

TEST(Hvse, VisibilityJumpsByLessThanThreePercentAtItsJoints) {
    for (const double joint : {-3.94, -1.44, -0.0184, 1.9}) {
        const double below = threshold_of_visibility(std::pow(10, joint - 1e-9));
        const double above = threshold_of_visibility(std::pow(10, joint + 1e-9));
        EXPECT_LT(std::abs(above / below - 1), 0.03) << joint;
    }
}

TEST(Hvse, PixelsPerDegreeAreThoseOfTheNotes) {
    EXPECT_NEAR(pixels_per_degree(512, 45), 10.787, 1e-3);
    EXPECT_NEAR(pixels_per_degree(1920, 60), 29.021, 1e-3);
}

TEST(Hvse, AgreesWithAPlainPredictorInDouble) {
    for (const uint32_t amplitude : {6u, 15u, 40u}) {
        for (const Image& a : {sample::blotches(60, 45, amplitude, 70), sample::facade(60, 45, 15)}) {
            const Image b = sample::with_noise(a, amplitude, 3);
            const HvseSettings settings = public_settings(60);
            EXPECT_NEAR(HvseReference(a, settings).failing(rows_of(b)), PlainPredictor(a, b, settings).failing(),
                        0.002);
        }
    }
}

TEST(Hvse, TheReferenceAloneHidesNearlyWhatBothHide) {
    const Image a = sample::blotches(64, 64, 2, 80), b = sample::with_noise(a, 25, 3);
    HvseSettings settings = public_settings(64);
    const double both = HvseReference(a, settings).failing(rows_of(b));
    settings.test_masks = false;
    EXPECT_NEAR(HvseReference(a, settings).failing(rows_of(b)), both, 0.1);
}

TEST(Hvse, DoesNotDependOnTheWidthOfTheChart) {
    // Pitfall 13: pixels per degree are those of the screen.
    const Image tile = sample::facade(32, 32, 16);
    const auto tiled = [](const Image& image) {
        Image out(4 * image.width, image.height, 3);
        for (uint32_t c = 0; c < 3; ++c)
            for (uint32_t y = 0; y < out.height; ++y)
                for (uint32_t x = 0; x < out.width; ++x) out.at(x, y, c) = image.at(x % image.width, y, c);
        return out;
    };
    Image changed = tile;
    for (size_t i = 0; i < changed.texels.size(); i += 7) changed.texels[i] *= 0.6f;
    HvseSettings settings;
    settings.pixels_per_degree = pixels_per_degree(1440, 45);
    const double one = HvseReference(tile, settings).failing(rows_of(changed));
    const Image wide = tiled(tile), wide_changed = tiled(changed);
    EXPECT_GT(one, 0.02);
    EXPECT_NEAR(HvseReference(wide, settings).failing(rows_of(wide_changed)), one, 0.02);
}

TEST(Hvse, ColourIsNotComparedInTheDark) {
    HvseSettings settings;
    settings.pixels_per_degree = 30;
    const auto failing = [&](float scale) {
        Image grey = sample::flat(20, 20, 255, 255, 255), tinted = grey;
        for (float& value : grey.texels) value *= scale;
        tinted = grey;
        for (float& value : tinted.plane(0)) value *= 1 + 0.04f;  // equal luminance, nearly
        for (float& value : tinted.plane(1)) value *= 1 - 0.04f * 0.2126729f / 0.7151522f;
        return HvseReference(grey, settings).failing(rows_of(tinted));
    };
    EXPECT_EQ(failing(0.5f), 1);
    EXPECT_EQ(failing(0.05f), 0);
}

OIIO::ImageBuf buffer_of(const Image& image) {
    OIIO::ImageBuf buffer(
        OIIO::ImageSpec(static_cast<int>(image.width), static_cast<int>(image.height), 3, OIIO::TypeDesc::FLOAT));
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const std::array<float, 3> texel = {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
            buffer.setpixel(static_cast<int>(x), static_cast<int>(y), texel.data());
        }
    }
    return buffer;
}

double failing_by_openimageio(const Image& a, const Image& b) {
    OIIO::ImageBufAlgo::CompareResults unused;
    const int failed = OIIO::ImageBufAlgo::compare_Yee(buffer_of(a), buffer_of(b), unused, 100, 45);
    return failed / static_cast<double>(a.area());
}

TEST(Hvse, ColourTestAgreesWithOpenImageIO) {
    // Equal luminance everywhere, so that only colour can fail, and only its threshold decides.
    Image a = sample::flat(64, 64, 188, 188, 188), b = a;
    for (uint32_t y = 0; y < 64; ++y) {
        for (uint32_t x = 0; x < 64; ++x) {
            const float change = static_cast<float>(x * 64 + y) / 4096 * 0.3f;
            b.at(x, y, 0) += change;
            b.at(x, y, 1) -= change * 0.297361f / 0.627355f;
        }
    }
    HvseSettings settings = public_settings(64);
    // OpenImageIO 2.4 takes every picture for dark (see the next test), where it weighs colour by a hundredth.
    const bool knows_luminance =
        failing_by_openimageio(sample::flat(16, 16, 0, 0, 0), sample::flat(16, 16, 255, 255, 255)) > 0;
    settings.colour_factor = knows_luminance ? 1 : 0.01;
    const double theirs = failing_by_openimageio(a, b);
    EXPECT_GT(theirs, 0.1);
    EXPECT_LT(theirs, 0.9);
    EXPECT_NEAR(HvseReference(a, settings).failing(rows_of(b)), theirs, 0.002);
}

TEST(Hvse, LuminanceTestAgreesWithOpenImageIO) {
    if (failing_by_openimageio(sample::flat(16, 16, 0, 0, 0), sample::flat(16, 16, 255, 255, 255)) == 0)
        GTEST_SKIP() << "this OpenImageIO's compare_Yee finds no difference between black and white";
    for (const uint32_t amplitude : {6u, 15u, 40u}) {
        const Image a = sample::blotches(128, 96, amplitude, 70), b = sample::with_noise(a, amplitude, 3);
        EXPECT_NEAR(HvseReference(a, public_settings(128)).failing(rows_of(b)), failing_by_openimageio(a, b), 0.05);
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
