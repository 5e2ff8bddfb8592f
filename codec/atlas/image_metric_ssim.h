// Mean structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004): 11 x 11 Gaussian window of sigma 1.5, K1 = 0.01,
// K2 = 0.03, peak 1, edge texels repeated.
#pragma once

#include "codec/atlas/image_rows.h"

namespace citystream::codec::atlas {

/// Encoded (gamma) luma of linear R, G, B: 0.299 R' + 0.587 G' + 0.114 B' in 0..1, one channel. 1 channel: R' = G' =
/// B'.
Image encoded_luma(const Image& linear);

/// One reference picture, to which many are compared.
class SsimReference {
  public:
    /// `luma`: one channel, encoded, 0..1, not empty.
    explicit SsimReference(Image luma);

    /// Mean over all texels, -1..1, 1 for equal pictures. Once it is sure to be below `least`, whatever it is then.
    /// Precondition: the reference's size, one channel. O(texels).
    double mean(const ImageRows& luma, double least = -1) const;

  private:
    Image luma_, mean_, variance_;
};

}  // namespace citystream::codec::atlas
