#include "codec/atlas/image_metric_ssim.h"

#include <algorithm>
#include <array>

#include "codec/atlas/image_metric_filter.h"
#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kRadius = 5;
constexpr float kC1 = 0.01f * 0.01f, kC2 = 0.03f * 0.03f;

const Kernel& window() {
    static const Kernel kernel = gaussian_kernel(1.5, kRadius);
    return kernel;
}

Image window_mean(const Image& plane) {
    return filter_both(plane, window(), Beyond::kEdge);
}

Image product(const Image& a, const Image& b) {
    Image out(a.width, a.height, 1);
    run_wide([x = a.texels.data(), y = b.texels.data(), to = out.texels.data(), count = a.area()]() CITYSTREAM_INLINED {
        for (size_t i = 0; i < count; ++i) to[i] = x[i] * y[i];
    });
    return out;
}

/// The window's sums of the last rows of a picture and its reference.
class WindowRows {
  public:
    explicit WindowRows(uint32_t width)
        : width_(width),
          a_(width + 2 * kRadius),
          b_(a_.size()),
          product_(a_.size()),
          ring_(3 * kRing * width),
          moments_(3 * width) {}

    /// The next row from the bottom.
    void push(std::span<const float> reference, std::span<const float> test) {
        pad(reference, a_);
        pad(test, b_);
        filter(b_, 0);
        multiply(b_, b_);
        filter(product_, 1);
        multiply(a_, b_);
        filter(product_, 2);
        ++pushed_;
    }

    struct Moments {
        const float *mean, *square, *product;
    };

    /// Around row `y`, of a picture of `height` rows; the rows within the window's radius have been pushed.
    Moments moments(uint32_t y, uint32_t height) {
        std::array<const float*, 2 * kRadius + 1> rows;
        for (uint32_t kind = 0; kind < 3; ++kind) {
            for (uint32_t k = 0; k < rows.size(); ++k) {
                const uint32_t source = std::clamp(y + k, kRadius, height - 1 + kRadius) - kRadius;
                rows[k] = ring_row(kind, source);
            }
            weighted_sum(rows.data(), window().data(), rows.size(), &moments_[kind * width_], width_);
        }
        return {&moments_[0], &moments_[width_], &moments_[2 * width_]};
    }

  private:
    static constexpr uint32_t kRing = 2 * kRadius + 1;

    float* ring_row(uint32_t kind, uint32_t y) { return &ring_[(size_t{kind} * kRing + y % kRing) * width_]; }

    void pad(std::span<const float> row, std::vector<float>& padded) const {
        std::fill_n(padded.begin(), kRadius, row.front());
        std::copy(row.begin(), row.end(), &padded[kRadius]);
        std::fill_n(&padded[kRadius + width_], kRadius, row.back());
    }

    void multiply(const std::vector<float>& a, const std::vector<float>& b) {
        run_wide([x = a.data(), y = b.data(), out = product_.data(), count = a.size()]() CITYSTREAM_INLINED {
            CITYSTREAM_INDEPENDENT
            for (size_t i = 0; i < count; ++i) out[i] = x[i] * y[i];
        });
    }

    void filter(const std::vector<float>& padded, uint32_t kind) {
        std::array<const float*, 2 * kRadius + 1> shifted;
        for (size_t k = 0; k < shifted.size(); ++k) shifted[k] = &padded[k];
        weighted_sum(shifted.data(), window().data(), shifted.size(), ring_row(kind, pushed_), width_);
    }

    uint32_t width_, pushed_ = 0;
    std::vector<float> a_, b_, product_;  // padded rows
    std::vector<float> ring_;             // test, test^2, reference * test: rows filtered along x
    std::vector<float> moments_;
};

}  // namespace

Image encoded_luma(const Image& linear) {
    assert(linear.channels == 1 || linear.channels == 3);
    Image encoded(linear.width, linear.height, linear.channels);
    encode_srgb(linear.texels, encoded.texels);
    if (linear.channels == 1) return encoded;
    Image out(linear.width, linear.height, 1);
    const float* rows[3] = {encoded.plane(0).data(), encoded.plane(1).data(), encoded.plane(2).data()};
    const float weights[3] = {0.299f, 0.587f, 0.114f};
    weighted_sum(rows, weights, 3, out.texels.data(), out.area());
    return out;
}

SsimReference::SsimReference(Image luma) : luma_(std::move(luma)), mean_(window_mean(luma_)) {
    assert(luma_.channels == 1 && !luma_.empty());
    variance_ = window_mean(product(luma_, luma_));
    for (size_t i = 0; i < variance_.texels.size(); ++i) variance_.texels[i] -= mean_.texels[i] * mean_.texels[i];
}

double SsimReference::mean(const ImageRows& luma, double least) const {
    assert(luma.width == luma_.width && luma.height == luma_.height && luma.channels == 1);
    const uint32_t width = luma_.width, height = luma_.height;
    const double area = static_cast<double>(luma_.area()), most_lost = (1 - least) * area;
    WindowRows window(width);
    std::vector<float> similarity(width);
    double lost = 0;  // of similarity, below 1 a texel
    uint32_t done = 0;
    const auto finish_row = [&] {
        const WindowRows::Moments m = window.moments(done, height);
        const float *mean_a = mean_.row(0, done).data(), *var_a = variance_.row(0, done).data(), *mb = m.mean,
                    *bb = m.square, *ab = m.product;
        run_wide([=, out = similarity.data()]() CITYSTREAM_INLINED {
            CITYSTREAM_INDEPENDENT
            for (size_t i = 0; i < width; ++i) {
                const float means = mean_a[i] * mb[i], squares = mean_a[i] * mean_a[i] + mb[i] * mb[i];
                const float covariance = ab[i] - means, var_b = bb[i] - mb[i] * mb[i];
                const float quotient =
                    ((2 * means + kC1) * (2 * covariance + kC2)) / ((squares + kC1) * (var_a[i] + var_b + kC2));
                out[i] = 1 - quotient;
            }
        });
        lost += sum_of(similarity);
        ++done;
    };
    visit_strips(luma, [&](uint32_t y, const Image& strip) {
        for (uint32_t i = 0; i < strip.height; ++i) {
            window.push(luma_.row(0, y + i), strip.row(0, i));
            if (y + i >= kRadius) finish_row();
        }
        return lost <= most_lost;
    });
    while (lost <= most_lost && done < height) finish_row();
    return 1 - lost / area;
}

}  // namespace citystream::codec::atlas
