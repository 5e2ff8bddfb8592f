// The generated city's ground: one triangulated object per square cell, with streets, pavements and lawns as materials
// of the triangles.
#pragma once

#include <cstdint>
#include <string>

#include "tiles/city/generator_layout.h"
#include "tiles/city/procedural_materials.h"

namespace citystream::tiles::city::procedural {

/// Makes the cells. Blocks of quarters whose number on the spiral is `quarters` or more are open country.
class TerrainMaker {
  public:
    TerrainMaker(const CityPlan& plan, const MaterialSet& materials, const CityCatalog& catalog, Vec2 origin,
                 uint64_t quarters)
        : plan_(plan), materials_(materials), catalog_(catalog), origin_(origin), quarters_(quarters) {}

    /// The cell [i, i + 1) x [j, j + 1) times kTerrainCellMetres. Vertices on a common border are the same in both
    /// cells.
    CityObject make(int64_t i, int64_t j, std::string id) const;

  private:
    struct Surface;
    Surface surface_at(const StreetPlace& x, const StreetPlace& y) const;
    uint32_t block_material(int64_t block_x, int64_t block_y) const;

    const CityPlan& plan_;
    const MaterialSet& materials_;
    const CityCatalog& catalog_;
    Vec2 origin_;
    uint64_t quarters_;
};

}  // namespace citystream::tiles::city::procedural
