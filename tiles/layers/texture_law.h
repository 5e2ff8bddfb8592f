// How fine the images of tiles are: metres a texel of leaves, and of the tiles above them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "codec/atlas/level_law.h"
#include "codec/result.h"

namespace citystream::tiles::layers {

/// Texels that the finest tiles ask for, metres, unless told otherwise.
inline constexpr double kLeafTexel = 0.02;

/// How much of the geometry's detail is worth how many texels is not known to a law; that a tile's blurred pictures
/// have it refined is (tile_encoder.h), so coarse levels may leave out what their children bring anyway. Ingolstadt
/// along the paths street, aerial and orbit of tests/data, mean PSNR against the reference and bytes, without shared
/// charts:
///   0.02      44.0, 41.7, 40.1 dB; 1.16, 1.37, 1.02 MB        0.02,2,16  45.0, 43.6, 40.7 dB; 1.12, 1.65, 1.06 MB
///   0.02,4,8  45.0, 43.2, 40.7 dB; 1.12, 1.21, 1.09 MB        0.02,8,3   44.1, 41.1, 39.7 dB; 1.07, 1.12, 0.82 MB
///   0.05,4,4  43.9, 40.9, 39.7 dB; 0.87, 0.95, 0.50 MB        thesis     43.9, 40.9, 39.7 dB; 0.71, 0.76, 0.48 MB
/// (SSIM differs by 0.0002, 0.0021 and 0.0008 at most), and a generated city of 400 buildings with 150 images:
///   0.02      41.7, 44.8, 41.0 dB; 21.9, 1.72, 22.2 MB        0.02,4,8   41.7, 43.9, 41.2 dB; 22.1, 1.12, 22.4 MB
/// There the thesis's law loses 3.7, 0.2 and 2.7 dB for a third of the bytes, with shared charts.
struct TextureLaw {
    /// A level law of the thesis (8.2.1): texels of a tile by its height above the leaves. None: leaves have `finest`
    /// texels, and a tile above them texels of half the error that its geometry has anyway.
    std::optional<codec::atlas::LevelLaw> levels =
        codec::atlas::LevelLaw{kLeafTexel, 4, 8, codec::atlas::MipRule::kFull};
    double finest = kLeafTexel;  ///< of leaves; levels->finest where there is one

    /// Metres a texel of an inner tile. `height`: above the deepest leaf below it; levels of the law end at its root.
    double inner_texel(uint32_t height, double error_metres) const;
    /// Mips that the law keeps beside the finest at a height (LevelLaw::mips). Precondition: it has levels.
    uint32_t mips(uint32_t height) const;
};

/// "METRES,FACTOR,LEVELS", "thesis" (0.05,8,3, of kPaper mips) or "METRES" (`finest` without levels). Error: anything
/// else, and what check_law refuses; one line.
Result<TextureLaw> parse_texture_law(std::string_view text);

/// As parse_texture_law takes it; the thesis's law, whose mips no numbers give, by its name.
std::string to_string(const TextureLaw& law);

}  // namespace citystream::tiles::layers
