// HVSE: the share of pixels that an abridged visible differences predictor calls different (thesis section 7.2.3, after
// Yee and Newman 2004). Luminance and colour are compared with thresholds that rise with what the neighbourhood hides.
// Formulas and constants are those of notes F6; where the thesis gives none, the public ones of the literature it
// cites.
#pragma once

#include <vector>

#include "codec/atlas/image_rows.h"

namespace citystream::codec::atlas {

/// Contrast sensitivity (Barten): of `cycles_per_degree` >= 0 at `luminance` cd/m^2. csf(3.248, 100) = 525.154, the
/// peak at 100 cd/m^2. 0 at 0. Does not overflow for any arguments; luminance is at least 1e-5.
double contrast_sensitivity(double cycles_per_degree, double luminance);

/// Elevation of the threshold by masking (Daly), >= 1, of a contrast already multiplied by its sensitivity.
double contrast_masking(double contrast);

/// Smallest luminance step that is seen at this adaptation (Ward Larson et al.), cd/m^2; adaptation is at least 1e-5.
double threshold_of_visibility(double adaptation);

/// Pixels per degree of a screen of `width` pixels seen under a horizontal field of view: width pi / (360 tan(fov /
/// 2)), fov in degrees. 10.787 for 512 and 45 degrees.
double pixels_per_degree(double width, double fov_degrees);

struct HvseSettings {
    double pixels_per_degree = 0;  ///< > 0
    double luminance = 100;        ///< of white, cd/m^2
    double colour_factor = 1;      ///< of squared colour differences
    /// Level of the pyramid that is taken as what the eye adapted to: the first whose 2^level exceeds this many pixels,
    /// at most the last. 0: pixels_per_degree.
    double adaptation_pixels = 0;
    /// Who hides differences: the reference only (the thesis; everything but the comparison is done once a reference),
    /// or either picture, whichever has more contrast (the public implementations).
    bool test_masks = false;
    bool adobe_primaries = false;  ///< of the linear R, G, B; false: sRGB's
};

/// One reference picture, its pyramid and thresholds, to which many are compared.
class HvseReference {
  public:
    /// `linear`: three channels, 0..1, not empty.
    HvseReference(const Image& linear, const HvseSettings& settings);

    /// Share of pixels that fail, 0..1; 0 for equal pictures. Once it is sure to exceed `limit`, whatever it is then.
    /// Precondition: the reference's size and three channels.
    double failing(const ImageRows& linear, double limit = 1) const;

  private:
    static constexpr uint32_t kLevels = 8, kBands = 6;
    /// Luminance in cd/m^2, CIE a* and b*: three channels.
    Image appearance_of(const Image& linear) const;
    std::vector<Image> pyramid_of(const Image& appearance) const;
    Image limits_of(const std::vector<Image>& a, const std::vector<Image>& b) const;

    double failing_within(const Image& limits, const ImageRows& linear, double limit) const;

    HvseSettings settings_;
    uint32_t adaptation_level_ = 0;
    Image appearance_;
    std::vector<Image> pyramid_;  ///< kept only if the test masks, too
    Image limits_;                ///< largest luminance difference, largest squared colour difference
};

}  // namespace citystream::codec::atlas
