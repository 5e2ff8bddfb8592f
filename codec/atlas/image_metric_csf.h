// Metrics of the spatial-frequency domain (thesis section 1.2): both pictures are scaled to mean 0 and deviation 1,
// transformed, weighted by a contrast sensitivity filter and compared.
#pragma once

#include <complex>
#include <vector>

#include "codec/atlas/image.h"

namespace citystream::codec::atlas {

/// The three filters, of r >= 0 cycles per degree.
/// Mannos and Sakrison: 2.6 (.0192 + .114 r) exp(-(.114 r)^1.1), peak .98 at 7.9 (.144 of the thesis peaks at 6.25, not
/// at its stated 8: notes F7).
double mannos_sakrison_filter(double cycles_per_degree);
/// Daly: (.008 / r^3 + 1)^-.2 1.42 r exp(-.3 r sqrt(1 + .06 exp(.3 r))); 0 at 0.
double daly_filter(double cycles_per_degree);
/// Ahumada: exp(-(r / 97.32)^2) - .685 exp(-(r / 12.16)^2); the signs of the exponents as corrected in notes F7.
double ahumada_filter(double cycles_per_degree);

using SensitivityFilter = double (*)(double cycles_per_degree);

/// One reference picture, transformed once.
class SpectrumReference {
  public:
    /// `luma`: one channel, encoded, not empty; pixels_per_degree > 0.
    SpectrumReference(const Image& luma, SensitivityFilter filter, double pixels_per_degree);

    /// Root of |difference|^2 over twice the |spectra|^2, both filtered: 0..1, 0 for pictures that are equal up to
    /// brightness and contrast. Precondition: the reference's size. O(area log area).
    double error(const Image& luma) const;

  private:
    using Spectrum = std::vector<std::complex<double>>;
    Spectrum filtered_spectrum(const Image& luma) const;

    std::vector<double> weight_;
    Spectrum spectrum_;
};

}  // namespace citystream::codec::atlas
