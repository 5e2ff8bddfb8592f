// How different two pictures are: PSNR, SSIM and FLIP, on sRGB-encoded 8-bit frames of equal size.
#pragma once

#include <vector>

#include "client/render/frame.h"
#include "codec/result.h"

namespace citystream::client {

struct ImageDifference {
    double psnr_db = 0;  ///< over the three colour channels, peak 255; infinite for equal pictures
    double ssim =
        1;  ///< mean structural similarity of luma (Wang et al. 2004: 11 x 11 Gaussian, sigma 1.5, K1 0.01, K2 0.03)
    double flip = 0;  ///< mean LDR FLIP in 0..1 (Andersson et al. 2020) at 67 pixels per degree
};

/// Error: sizes differ or are zero. Time O(pixels). `flip_per_pixel`, when given, receives flip_map at 67 pixels per
/// degree.
Result<ImageDifference> compare_images(const FrameImage& reference, const FrameImage& test,
                                       std::vector<float>* flip_per_pixel = nullptr);

/// FLIP per pixel, row-major, 0..1 (error maps).
std::vector<float> flip_map(const FrameImage& reference, const FrameImage& test, double pixels_per_degree = 67);

/// PSNR alone, in decibels; infinite for equal pictures. Same sizes.
double psnr(const FrameImage& reference, const FrameImage& test);

}  // namespace citystream::client
