// How near approximations of the radiance layer come to the irradiance that the bits give, and for how many bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "client/light/environment_map.h"
#include "codec/radiance/source_light.h"
#include "codec/result.h"
#include "tests/bench/radiance_samples.h"

namespace citystream::bench {

struct QualitySky {
    std::string name;
    std::vector<codec::radiance::Rgb> radiance;  ///< of source texels
};

/// A dim sky with an area light of 12 degrees' radius, 200 times as bright: radiance of source texels.
std::vector<codec::radiance::Rgb> area_light(uint32_t texels_across);

/// A uniform sky; the area light's; and the maps of ../shared/data/hdr_env beside the source tree, if they are there,
/// without their suns. Error: a map cannot be read.
Result<std::vector<QualitySky>> quality_skies(uint32_t texels_across);

struct QualityLine {
    std::string representation;
    uint64_t bytes = 0;
    /// Sky and error: root of the mean square over receivers and channels, over that of the irradiance itself.
    std::vector<std::pair<std::string, double>> errors;
    /// Of a line that compares: what it is compared at, `equal bytes` or `equal error` (`equal error, not reached`: the
    /// nearest of a family that does not come as near).
    std::string beside = {};

    double worst_error() const;
    double error(const std::string& sky) const;
};

/// Hears what a representation makes of the first sample under the area light.
using AreaLightListener = std::function<void(const QualityLine& line, std::span<const client::LightSum> irradiance)>;

/// Brute force from the bits (bits: the truth, as the errors' definition has it), the layer by its steps (layer-1 to
/// layer-3), lossy biclusters on the wire (bicluster-Q: quarters a row), spherical harmonics (sh-N), clustered
/// principal components (cpca-CxV), Haar wavelets (haar-T), both of all rows and, for fewer bytes, of one row a
/// receiver (-one-row: what it sees, in whatever direction); occlusion and bent normal, shadow map, ambient light. Then
/// again, marked `compared`, for the area light: of each family the best that takes no more bytes than the layer, and
/// the smallest whose error is not above the layer's. `listener` may be none; a line's bytes and errors are complete
/// but for samples behind the first.
std::vector<QualityLine> measure_quality(const RadianceSet& set, std::span<const QualitySky> skies, uint32_t local_side,
                                         const AreaLightListener& listener = {});

}  // namespace citystream::bench
