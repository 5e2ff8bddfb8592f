// How near approximations of the radiance layer come to the irradiance that the bits give, and for how many bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "codec/radiance/source_light.h"
#include "codec/result.h"
#include "tests/bench/radiance_samples.h"

namespace citystream::bench {

struct QualitySky {
    std::string name;
    std::vector<codec::radiance::Rgb> radiance;  ///< of source texels
};

/// A uniform sky; a dim one with an area light of 12 degrees' radius, 200 times as bright; and the maps of
/// ../shared/data/hdr_env beside the source tree, if they are there, without their suns. Error: a map cannot be read.
Result<std::vector<QualitySky>> quality_skies(uint32_t texels_across);

struct QualityLine {
    std::string representation;
    uint64_t bytes = 0;
    /// Sky and error: root of the mean square over receivers and channels, over that of the irradiance itself.
    std::vector<std::pair<std::string, double>> errors;
    /// Of a line that compares: what it is compared at, `equal bytes` or `equal error`.
    std::string beside = {};

    double worst_error() const;
    double error(const std::string& sky) const;
};

/// The layer by its steps (layer-1 to layer-3), lossy biclusters on the wire (bicluster-Q: quarters a row), spherical
/// harmonics (sh-N), clustered principal components (cpca-CxV), Haar wavelets (haar-T), occlusion and bent normal,
/// shadow map, ambient light. Then again, marked `compared`, for the area light: of each family the best that takes no
/// more bytes than the layer, and the smallest whose error is not above the layer's.
std::vector<QualityLine> measure_quality(const RadianceSet& set, std::span<const QualitySky> skies,
                                         uint32_t local_side);

}  // namespace citystream::bench
