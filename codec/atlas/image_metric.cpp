#include "codec/atlas/image_metric.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace citystream::codec::atlas {

namespace {

constexpr std::array<std::string_view, 10> kNames = {"none", "rmse",    "nrmse", "tm",   "mannos",
                                                     "daly", "ahumada", "hvse",  "ssim", "flip"};

bool sees_planes(MetricKind kind) {
    return kind == MetricKind::kRmse || kind == MetricKind::kNormalisedRmse || kind == MetricKind::kTemplateMatch;
}

/// Three channels: grey repeated, colours with alpha laid over an even background.
void lay_over(const Image& image, float background, Image& out) {
    const size_t area = image.area();
    for (uint32_t c = 0; c < 3; ++c) {
        const float* from = image.plane(image.channels == 1 ? 0 : c).data();
        float* to = out.plane(c).data();
        std::copy_n(from, area, to);
        if (image.channels < 4) continue;
        const float* alpha = image.plane(3).data();
        for (size_t i = 0; i < area; ++i) to[i] += (1 - alpha[i]) * background;
    }
}

ImageRows rows_over(const ImageRows& rows, float background) {
    if (rows.channels == 3) return rows;
    return {rows.width, rows.height, 3, [rows, background](uint32_t y, Image& strip) {
                Image part(strip.width, strip.height, rows.channels);
                rows.read(y, part);
                lay_over(part, background, strip);
            }};
}

/// Encoded luma of three channels.
ImageRows luma_rows(const ImageRows& rows) {
    return {rows.width, rows.height, 1, [rows](uint32_t y, Image& strip) {
                Image part(strip.width, strip.height, rows.channels);
                rows.read(y, part);
                strip = encoded_luma(part);
            }};
}

SensitivityFilter filter_of(MetricKind kind) {
    if (kind == MetricKind::kMannosSakrison) return mannos_sakrison_filter;
    return kind == MetricKind::kDaly ? daly_filter : ahumada_filter;
}

}  // namespace

std::string_view name_of(MetricKind kind) {
    return kNames[static_cast<size_t>(kind)];
}

Result<Metric> parse_metric(std::string_view text) {
    const Error error{
        "a metric is none, or one of rmse, nrmse, tm, mannos, daly, ahumada, hvse, ssim, flip with a "
        "tolerance from 0 to 1, as in hvse:0.3; got \"" +
        std::string(text.substr(0, 40)) + '"'};
    if (text == kNames[0]) return Metric{};
    const size_t colon = text.find(':');
    if (colon == std::string_view::npos) return error;
    const auto name = std::find(kNames.begin() + 1, kNames.end(), text.substr(0, colon));
    if (name == kNames.end()) return error;
    Metric metric{static_cast<MetricKind>(name - kNames.begin()), 0};
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data() + colon + 1, end, metric.tolerance);
    if (parsed.ec != std::errc() || parsed.ptr != end || !(metric.tolerance >= 0 && metric.tolerance <= 1))
        return error;
    return metric;
}

std::string to_string(const Metric& metric) {
    std::string text(name_of(metric.kind));
    if (metric.kind == MetricKind::kNone) return text;
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), metric.tolerance).ptr;
    return text + ':' + std::string(digits.data(), end);
}

MetricReference::MetricReference(const Image& original, MetricKind kind, const ViewingConditions& view) : kind_(kind) {
    assert(!original.empty() && kind != MetricKind::kNone && original.channels != 2);
    if (sees_planes(kind)) {
        prepared_.emplace_back(IntensityReference(original));
        return;
    }
    backgrounds_ = original.channels == 4 ? std::vector<float>{0, 1} : std::vector<float>{0};
    const double ppd = pixels_per_degree(view.screen_width, view.fov_degrees);
    for (const float background : backgrounds_) {
        const Image seen = whole_image(rows_over(rows_of(original), background));
        if (kind == MetricKind::kHvse) {
            HvseSettings settings;
            settings.pixels_per_degree = ppd;
            settings.luminance = view.luminance;
            prepared_.emplace_back(HvseReference(seen, settings));
        } else if (kind == MetricKind::kSsim) {
            prepared_.emplace_back(SsimReference(encoded_luma(seen)));
        } else if (kind == MetricKind::kFlip) {
            prepared_.emplace_back(FlipReference(seen, view.flip_pixels_per_degree));
        } else {
            prepared_.emplace_back(SpectrumReference(encoded_luma(seen), filter_of(kind), ppd));
        }
    }
}

double MetricReference::error_of(const Prepared& prepared, const ImageRows& test, double limit) const {
    if (const auto* intensity = std::get_if<IntensityReference>(&prepared)) {
        if (kind_ == MetricKind::kRmse) return intensity->rmse(test, limit);
        const Image image = whole_image(test);
        return kind_ == MetricKind::kTemplateMatch ? intensity->template_match(image)
                                                   : intensity->normalised_rmse(image);
    }
    if (const auto* hvse = std::get_if<HvseReference>(&prepared)) return hvse->failing(test, limit);
    if (const auto* ssim = std::get_if<SsimReference>(&prepared)) return 1 - ssim->mean(luma_rows(test), 1 - limit);
    if (const auto* flip = std::get_if<FlipReference>(&prepared)) return flip->mean(whole_image(test), limit);
    return std::get<SpectrumReference>(prepared).error(whole_image(luma_rows(test)));
}

double MetricReference::error(const ImageRows& test, double limit) const {
    if (backgrounds_.empty()) return std::clamp(error_of(prepared_[0], test, limit), 0.0, 1.0);
    double largest = 0;
    for (size_t i = 0; i < backgrounds_.size() && largest <= limit; ++i)
        largest = std::max(largest, error_of(prepared_[i], rows_over(test, backgrounds_[i]), limit));
    return std::clamp(largest, 0.0, 1.0);
}

}  // namespace citystream::codec::atlas
