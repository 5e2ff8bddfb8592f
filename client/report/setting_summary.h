// What a setting of a knob amounts to over the frames of its flight, for tables and plots.
#pragma once

#include "client/report/sweep.h"

namespace citystream::client {

/// Medians over the frames where nothing else is said.
struct SettingSummary {
    double gpu_ms = 0, facade_ms = 0, psnr_db = 0, least_psnr_db = 0, ssim = 0, flip = 0;
    double achieved_error_pixels = 0, position_error_pixels = 0;  ///< greatest
    double position_bits = 0;
    double light_ms = 0, shadow_ms = 0;
    double light_decode_ms = 0;  ///< of the whole flight, all cores together
    uint64_t receivers = 0;      ///< of the tiles of one frame, greatest
    double row_error = 0;        ///< greatest
};

/// Equal pictures have no finite PSNR; 99 dB stands for them where a number is needed.
double finite_psnr(double psnr_db);

SettingSummary summarise(const SettingResult& setting);

}  // namespace citystream::client
