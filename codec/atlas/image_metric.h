// How different a picture is from its original: one interface to the metrics that the saliency search may use (thesis
// sections 1 and 7.2). Every metric is an error: 0 for equal pictures, at most 1.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "codec/atlas/image.h"
#include "codec/atlas/image_metric_csf.h"
#include "codec/atlas/image_metric_flip.h"
#include "codec/atlas/image_metric_hvse.h"
#include "codec/atlas/image_metric_intensity.h"
#include "codec/atlas/image_metric_ssim.h"
#include "codec/result.h"

namespace citystream::codec::atlas {

enum class MetricKind : uint8_t {
    kNone,
    kRmse,            ///< "rmse": root mean squared difference of encoded intensities
    kNormalisedRmse,  ///< "nrmse": the same, blind to brightness and contrast
    kTemplateMatch,   ///< "tm": 1 - correlation, at most 1
    kMannosSakrison,  ///< "mannos": normalised spectra under a contrast sensitivity filter
    kDaly,            ///< "daly"
    kAhumada,         ///< "ahumada"
    kHvse,            ///< "hvse": share of pixels that are seen to differ
    kSsim,            ///< "ssim": 1 - mean structural similarity of luma, at most 1
    kFlip,            ///< "flip": mean FLIP
};

/// A metric and what a user allows of it.
struct Metric {
    MetricKind kind = MetricKind::kNone;
    /// As the user writes it: the largest error, 0..1; for SSIM the least similarity, 0..1.
    double tolerance = 0;

    /// The largest error that the tolerance allows.
    double largest_error() const { return kind == MetricKind::kSsim ? 1 - tolerance : tolerance; }
    bool operator==(const Metric&) const = default;
};

/// "none", or a name and a tolerance in 0..1: "rmse:0.05", "nrmse:..", "tm:..", "mannos:..", "daly:..", "ahumada:..",
/// "hvse:0.3", "ssim:0.98", "flip:0.05". Error: one line that says what is allowed.
Result<Metric> parse_metric(std::string_view text);
/// What parse_metric takes, shortest form.
std::string to_string(const Metric& metric);
std::string_view name_of(MetricKind kind);

/// Who looks. Pinned, because HVSE changes greatly with it (notes, pitfall 13): not the chart's own width counts, but
/// that of the screen on which a texel is a pixel at most.
struct ViewingConditions {
    double screen_width = 1440;  ///< pixels across: the thesis's viewport
    double fov_degrees = 45;     ///< horizontal
    double luminance = 100;      ///< of white, cd/m^2
    double flip_pixels_per_degree = kFlipPixelsPerDegree;
};

/// A picture prepared for one metric: what depends on the original alone (encodings, pyramid, filtered planes) is done
/// once. Pictures have 1, 3 or 4 channels; with alpha, the metrics see them over black and over white, and the larger
/// error counts (RMSE, NRMSE and TM compare alpha as a fourth intensity instead). Const calls may run on several
/// threads.
class MetricReference {
  public:
    /// Precondition: not empty, kind not kNone.
    MetricReference(const Image& original, MetricKind kind, const ViewingConditions& view = {});

    /// 0..1. Precondition: the original's size and channels.
    double error(const Image& test) const { return error(rows_of(test)); }
    /// The same of a picture that is made as it is read. Once the error is sure to exceed `limit`, reading ends, and
    /// the result is some number above the limit.
    double error(const ImageRows& test, double limit = 1) const;

  private:
    using Prepared = std::variant<IntensityReference, SpectrumReference, HvseReference, SsimReference, FlipReference>;
    double error_of(const Prepared& prepared, const ImageRows& test, double limit) const;

    MetricKind kind_;
    std::vector<float> backgrounds_;  ///< that alpha is laid over; none: pictures are compared as they are
    std::vector<Prepared> prepared_;
};

}  // namespace citystream::codec::atlas
