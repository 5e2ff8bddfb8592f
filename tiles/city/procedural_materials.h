// The generated city's materials and facade palettes. Images are drawn once per city and put in the catalog.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/city/city_model.h"
#include "tiles/city/grammar_facades.h"

namespace citystream::tiles::city::procedural {

/// Catalog indices of what the generator dresses roofs, ground and plants with.
struct MaterialSet {
    std::vector<uint32_t> pitched_roofs;  ///< tiles, slates
    uint32_t flat_roof = 0, metal_roof = 0, coping = 0, soffit = 0, chimney = 0, machinery = 0;
    uint32_t road = 0, main_road = 0, asphalt = 0, crossing = 0, pavement = 0, plaza = 0, lawn = 0, meadow = 0,
             yard = 0;
    uint32_t bark = 0;
    std::vector<uint32_t> foliage;
    /// Palette indices by use.
    std::vector<uint32_t> house_palettes, apartment_palettes, tower_palettes, hall_palettes;
};

/// Fills materials, images and palettes of the catalog. The seed changes the grain of the textures, not their order.
MaterialSet make_materials(CityCatalog& catalog, uint64_t seed);

}  // namespace citystream::tiles::city::procedural
