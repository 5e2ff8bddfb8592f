// The built-in procedural city: terrain, streets, blocks, plots, buildings with grammar facades, from a seed.
#pragma once

#include <functional>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

struct GeneratorOptions {
    uint32_t buildings = 1000;  ///< exactly this many
    uint64_t seed = 1;
    /// 0: facades with relief, few textures. Else walls are flat and show this many distinct periodic textures (at
    /// least procedural::kLeastTextures; no more than buildings want, generator_walls.h), made when they are asked for.
    uint32_t textures = 0;
    Vec2 origin;  ///< metres added to x and y (origin-shift tests)
    std::function<void(uint64_t done, uint64_t total)> progress;
};

/// Streams the city. Same options, same objects in the same order, on every machine (integer or correctly rounded
/// arithmetic only); the ground, the roofs and what stands where do not depend on `textures`. Terrain comes as square
/// TIN cells of kTerrainCellMetres aligned to the origin, cracks-free at their common borders. Memory stays independent
/// of the number of buildings but for the catalog.
void generate_city(const GeneratorOptions& options, CityHeader& header, CityCatalog& catalog, CityReport& report,
                   const CitySink& sink);

inline constexpr double kTerrainCellMetres = 64;

}  // namespace citystream::tiles::city
