// Environment maps from files: Radiance .hdr, OpenEXR and whatever else OpenImageIO reads.
//
// What the picture shows follows from its sides: 2:1 is latitude and longitude (environment_map.h says how it lies);
// 4:3 and 3:4 are crosses of a cube's faces, 6:1 and 1:6 strips of them in the order +x -x +y -y +z -z. Faces lie as
// OpenGL has them, y up, +z in the middle of a cross, which is taken as north; the -z face of the upright cross hangs
// below -y, upside down. OpenEXR files that call themselves cubes (`envmap`) have the axes of OpenEXR. Values are
// linear; 8 and 16 bit integers are taken as sRGB-coded.
#pragma once

#include <cstdint>
#include <string>

#include "client/light/environment_map.h"
#include "codec/result.h"

namespace citystream::client {

/// Texels that were no radiance, and what was put in their places.
struct TexelDefects {
    uint64_t not_a_number = 0;  ///< 0
    uint64_t infinite = 0;      ///< 65504, the greatest half: what wrote infinity most often had no room for the sun
    uint64_t negative = 0;      ///< 0
    uint64_t too_great = 0;     ///< kGreatestRadiance

    uint64_t all() const { return not_a_number + infinite + negative + too_great; }
    /// One line, "12 texels mended: 10 not a number, 2 negative"; empty without any.
    std::string text() const;
};

/// Mends one texel; a texel counts once, for the first of its faults in the order above.
void mend_texel(Rgb& texel, TexelDefects& defects);

struct EnvironmentFile {
    EnvironmentMap map;
    TexelDefects defects;
};

/// Widest map that is kept: a wider file is reduced while it is read, a strip of rows at a time.
inline constexpr uint32_t kGreatestMapWidth = 4096;
/// Of files in latitude and longitude.
inline constexpr uint64_t kGreatestFilePixels = uint64_t{1} << 28;
/// Of a cube's face in a file.
inline constexpr uint32_t kGreatestFaceSide = 2048;

/// Cubes become maps of 4 columns to a texel of a face's side. Error: one line that names the file if it is missing, no
/// picture, damaged, of another shape, stored turned or mirrored, larger than the limits, or if no texel of it is a
/// radiance.
Result<EnvironmentFile> read_environment(const std::string& file);

}  // namespace citystream::client
