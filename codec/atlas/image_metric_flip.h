// LDR FLIP (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020): how different two pictures look
// when one flips between them.
#pragma once

#include <vector>

#include "codec/atlas/image.h"

namespace citystream::codec::atlas {

inline constexpr double kFlipPixelsPerDegree = 67;  ///< the paper's observer: 0.7 m from a 0.7 m wide screen of 3840

/// One reference picture, filtered once, to which many are compared.
class FlipReference {
  public:
    /// `linear`: three channels, 0..1, not empty; pixels_per_degree > 0.
    explicit FlipReference(const Image& linear, double pixels_per_degree = kFlipPixelsPerDegree);

    /// Difference of each texel, 0..1, rows as in the image. Precondition: `linear` has the reference's size and three
    /// channels. O(texels * pixels_per_degree).
    std::vector<float> map(const Image& linear) const;
    /// Mean of the map. Once it is sure to exceed `limit`, whatever it is then.
    double mean(const Image& linear, double limit = 1) const;

  private:
    /// Of one picture: hue-adjusted L*a*b* after the contrast filters, strength of its edges and of its points.
    struct Features {
        Image lab, edge, point;
    };
    Features features_of(const Image& linear) const;
    void compare(const Features& test, uint32_t in_a, uint32_t in_b, uint32_t rows, float* out) const;
    /// Calls visit(y, differences of the rows from y on) band by band, until it returns false.
    template <typename Visit>
    void visit_bands(const Image& linear, const Visit& visit) const;

    double pixels_per_degree_;
    Features reference_;
};

}  // namespace citystream::codec::atlas
