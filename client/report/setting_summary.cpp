#include "client/report/setting_summary.h"

#include <algorithm>

namespace citystream::client {

double finite_psnr(double psnr_db) {
    return std::min(psnr_db, 99.0);
}

SettingSummary summarise(const SettingResult& setting) {
    SettingSummary out;
    out.gpu_ms = median_of(setting.frames, [](const FrameRow& row) { return row.gpu_ms; });
    out.facade_ms = median_of(setting.frames, [](const FrameRow& row) { return row.facade_ms; });
    out.psnr_db = median_of(setting.frames, [](const FrameRow& row) { return finite_psnr(row.difference.psnr_db); });
    out.ssim = median_of(setting.frames, [](const FrameRow& row) { return row.difference.ssim; });
    out.flip = median_of(setting.frames, [](const FrameRow& row) { return row.difference.flip; });
    out.position_bits = median_of(setting.frames, [](const FrameRow& row) { return row.position_bits; });
    out.light_ms = median_of(setting.frames, [](const FrameRow& row) { return row.light_ms; });
    out.shadow_ms = median_of(setting.frames, [](const FrameRow& row) { return row.shadow_ms; });
    out.least_psnr_db = finite_psnr(1e9);
    for (const FrameRow& row : setting.frames) {
        out.least_psnr_db = std::min(out.least_psnr_db, finite_psnr(row.difference.psnr_db));
        out.achieved_error_pixels = std::max(out.achieved_error_pixels, row.achieved_error_pixels);
        out.position_error_pixels = std::max(out.position_error_pixels, row.position_error_pixels);
        out.light_decode_ms += row.light_decode_ms;
        out.receivers = std::max(out.receivers, row.receivers);
        out.row_error = std::max(out.row_error, row.row_error);
    }
    return out;
}

}  // namespace citystream::client
