// Metrics of the spatial domain (thesis section 1.1), on sRGB-encoded intensities 0..1 of all channels together, as
// corrected in notes F5: the sum of squares is divided by the number of values, so that results lie in 0..1.
#pragma once

#include <vector>

#include "codec/atlas/image_rows.h"

namespace citystream::codec::atlas {

/// One reference picture, encoded once, to which many are compared. Calls are O(values). Precondition of all: the test
/// has the reference's size and channels.
class IntensityReference {
  public:
    explicit IntensityReference(const Image& linear);

    /// Root of the mean squared difference, 0..1. Once it is sure to exceed `limit`, whatever it is then.
    double rmse(const ImageRows& linear, double limit) const;
    /// 1 - the correlation coefficient, 0..2 (template match, section 1.1.3). A constant picture correlates with
    /// nothing but another constant one.
    double template_match(const Image& linear) const;
    /// Half the RMSE of both pictures scaled to mean 0 and deviation 1 (section 1.1.2): sqrt((1 - correlation) / 2),
    /// 0..1. Blind to brightness and contrast.
    double normalised_rmse(const Image& linear) const;

  private:
    size_t area_ = 0;
    std::vector<float> encoded_;
    double mean_ = 0, deviation_ = 0;  ///< deviation_: root of the summed squares about the mean
};

}  // namespace citystream::codec::atlas
