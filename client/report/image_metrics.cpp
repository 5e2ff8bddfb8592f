#include "client/report/image_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "codec/atlas/image_metric_filter.h"
#include "codec/atlas/image_metric_flip.h"
#include "codec/atlas/image_metric_ssim.h"

namespace citystream::client {
namespace {

namespace atlas = codec::atlas;

atlas::Image linear_of(const FrameImage& frame) {
    std::vector<uint8_t> rgb(frame.rgba.size() / 4 * 3);
    for (size_t i = 0; i < rgb.size() / 3; ++i) std::copy_n(&frame.rgba[4 * i], 3, &rgb[3 * i]);
    return atlas::linear_image(frame.width, frame.height, 3, rgb);
}

/// Straight from the bytes, which are encoded already.
atlas::Image luma_of(const FrameImage& frame) {
    atlas::Image out(frame.width, frame.height, 1);
    for (size_t i = 0; i < out.texels.size(); ++i) {
        const uint8_t* texel = &frame.rgba[4 * i];
        out.texels[i] = (0.299f * texel[0] + 0.587f * texel[1] + 0.114f * texel[2]) / 255;
    }
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
    return atlas::FlipReference(linear_of(reference), pixels_per_degree).map(linear_of(test));
}

Result<ImageDifference> compare_images(const FrameImage& reference, const FrameImage& test,
                                       std::vector<float>* flip_per_pixel) {
    if (reference.width != test.width || reference.height != test.height || reference.width == 0 ||
        reference.height == 0)
        return Error{"pictures of different or zero size cannot be compared"};
    ImageDifference out;
    out.psnr_db = psnr(reference, test);
    const atlas::Image luma = luma_of(test);
    out.ssim = atlas::SsimReference(luma_of(reference)).mean(atlas::rows_of(luma));
    std::vector<float> map = flip_map(reference, test);
    out.flip = atlas::sum_of(map) / static_cast<double>(map.size());
    if (flip_per_pixel) *flip_per_pixel = std::move(map);
    return out;
}

}  // namespace citystream::client
