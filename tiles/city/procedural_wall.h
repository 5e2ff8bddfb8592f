// Periodic textures of walls, as many different ones as a city has facades: what a rectified photograph of a facade
// shows when it is laid side by side and storey upon storey. A texture is a description of a few words; its texels are
// drawn when they are asked for, so that a city may have more of them than fit in memory.
#pragma once

#include <cstdint>

#include "tiles/city/procedural_texture.h"

namespace citystream::tiles::city::procedural {

/// What a texture is drawn for.
enum class WallUse : uint8_t {
    kHouse,      ///< one or two storeys with windows, of detached and row houses
    kApartment,  ///< window rows of blocks of flats, some with balconies
    kTower,      ///< curtain walls and ribbons of windows
    kHall,       ///< industrial cladding with high windows and gates; one storey
    kHouseDoor,  ///< ground floors of houses: doors among windows
    kShop,       ///< ground floors of blocks and towers: shop windows, signs, entrances
    kPlain,      ///< no openings: party walls, gables, plinths
};
inline constexpr int kWallUses = 7;

/// Colours that go together; a building's textures are of one family.
inline constexpr int kWallFamilies = 8;

struct WallTexture {
    WallUse use = WallUse::kPlain;
    uint8_t family = 0;
    uint16_t width = 0, height = 0;       ///< texels: about 512 x 512, a half not powers of two
    int32_t width_mm = 0, height_mm = 0;  ///< one repeat in the world; equal for kPlain
    uint8_t bays = 1, storeys = 1;        ///< window columns and rows of a repeat
    uint64_t seed = 0;                    ///< of everything else
    Rgb colour{};                         ///< of the bare wall
};

/// Texture `number` of a city's textures for one use; the family is number % kWallFamilies. O(1).
WallTexture describe_wall(WallUse use, uint32_t number, uint64_t city_seed);

/// Draws it. A pure function: the same texels from any thread, on every machine. 11 to 24 ns a
/// texel.
Image draw_wall(const WallTexture& texture);

}  // namespace citystream::tiles::city::procedural
