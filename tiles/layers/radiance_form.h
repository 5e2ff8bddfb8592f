// What the builder is asked for of the radiance layer, and what it did.
#pragma once

#include <cstdint>
#include <string>

#include "codec/radiance/local_directions.h"
#include "codec/radiance/radiance_transport.h"
#include "codec/radiance/source_directions.h"
#include "codec/result.h"

namespace citystream::tiles::layers {

/// Metres, powers of two: of leaves, and of the widest tiles.
inline constexpr uint32_t kMostLatticeMetres = 16, kWidestLatticeMetres = 64;
/// Columns of a tile's lattice along its side: wider tiles have wider lattices, wider leaves are split.
inline constexpr uint32_t kLatticeColumns = 64;
/// Wider tiles have no radiance layer.
inline constexpr uint32_t kWidestRadianceTileMetres = 1 << 14;

/// LatticeOptions::least_share. Sky's part of the light at points of 64 houses 6 to 10 m wide on 128 m x 128 m, against
/// rays (receivers; root of the mean squared error): at 4 m 1/32: 4,361, 0.0197; 1/8: 3,559, 0.0203; 1/4: 3,090,
/// 0.0216; at 8 m 1/32: 1,799, 0.0326; 1/8: 1,154, 0.0372; 1/4: 782, 0.103. Of 25 towers 16 m wide at 4 m 6,559,
/// 0.0064; 5,806, 0.0066; 5,331, 0.0070. The lattices of inner tiles are as wide as buildings, so that few receivers
/// are all they have: of the houses at 16 m 1/32: 833, 0.092; 1/8: 293, 0.167.
inline constexpr double kLeastShareOfLeaf = 1.0 / 8, kLeastShareOfInner = 1.0 / 32;

struct RadianceForm {
    uint32_t lattice_metres = 4;  ///< spacing of a leaf's receivers: a power of two, 1..kMostLatticeMetres
    uint32_t texels_across = 32;  ///< n of the source: 1..codec::radiance::kMostCubeSide
    uint32_t local_across = 8;    ///< m of the local directions: 1..codec::radiance::kMostLocalSide
    /// Relative radiance that each place may have wrong for fewer bytes (codec/radiance/visibility_smoothing.h); 0..1.
    double error = 0;
    codec::radiance::RadianceTransport transport = codec::radiance::RadianceTransport::kVisibility;
    bool reuse = true;  ///< takes what it can from the archive that is to be replaced
};

/// Whether this build can make the layer: it has Embree.
bool radiance_can_be_built();

/// Error: a value out of range, or no Embree; one line.
Status check_radiance_form(const RadianceForm& form);

/// For Manifest::build_options: " lattice=4m directions=32 local-directions=8", and what is not as by default.
std::string to_string(const RadianceForm& form);

/// Spacing of a tile's lattice, metres: kLatticeColumns across, but that of a leaf is at least what is asked for, and
/// that of an inner tile twice as much. 0: the tile is too wide for the layer.
uint32_t lattice_of_tile(const RadianceForm& form, uint64_t side_metres, bool leaf);

struct RadianceReport {
    uint64_t tiles = 0;      ///< that have the layer
    uint64_t baked = 0;      ///< of them; the others are as in the archive that was there
    uint64_t reused = 0;     ///< of them
    uint64_t recoded = 0;    ///< of those reused: they travelled as visibility, and their bits are written otherwise
    uint64_t widened = 0;    ///< of them: on a wider lattice than asked for, because of too many receivers
    uint64_t left_out = 0;   ///< tiles that have surfaces but no layer
    uint64_t receivers = 0;  ///< of the tiles that were baked
    uint64_t rays = 0;
    double seconds = 0;
    double bake_seconds = 0, encode_seconds = 0;  ///< of all threads together
    uint64_t horizon_bytes = 0;                   ///< that the city's heights took
    codec::radiance::RadianceTransport transport = codec::radiance::RadianceTransport::kVisibility;
};

}  // namespace citystream::tiles::layers
