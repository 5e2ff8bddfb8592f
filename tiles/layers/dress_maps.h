// The dictionary of a dressed city: derives each map of dress_plan.h once, and brings the grammar's materials and
// palettes into the catalog.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>

#include "codec/facade/run_grid.h"
#include "tiles/city/procedural_materials.h"
#include "tiles/layers/dress_plan.h"

namespace citystream::tiles::layers {

/// The relief of a map, kDressWidths[...] x map_height_cm texels; displacement is nowhere negative within 9 cm of its
/// border.
codec::facade::RunGrid derive_dress_map(const DressMapSpec& spec, uint64_t seed);

class DressMaps {
  public:
    /// `catalog` must outlive this; it is not touched before the first call.
    DressMaps(uint64_t seed, city::CityCatalog& catalog) : seed_(seed), catalog_(catalog) {}

    /// Index in catalog.facade_maps.
    uint32_t map_of(const DressMapSpec& spec);
    /// Index in catalog.palettes.
    uint32_t palette_of(const BuildingStyle& style);
    /// A plain material in the colour of a palette's walls.
    uint32_t wall_material(uint32_t palette);
    size_t size() const { return maps_.size(); }

  private:
    const city::procedural::MaterialSet& materials();

    uint64_t seed_;
    city::CityCatalog& catalog_;
    std::optional<city::procedural::MaterialSet> materials_;
    std::unordered_map<uint64_t, uint32_t> maps_;
    std::map<uint32_t, uint32_t> wall_materials_;
};

}  // namespace citystream::tiles::layers
