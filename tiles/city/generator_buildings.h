// From a building's plan to its geometry, and the dictionary of the facades that were needed so far.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tiles/city/generator_plots.h"
#include "tiles/city/generator_walls.h"
#include "tiles/city/procedural_materials.h"

namespace citystream::tiles::city::procedural {

/// Derives each distinct facade once; equal maps of different specs share an index.
class FacadeDictionary {
  public:
    FacadeDictionary(CityCatalog& catalog, uint64_t seed) : catalog_(catalog), seed_(seed) {}
    /// Index in catalog.facade_maps.
    uint32_t map_of(const FacadeSpec& spec);

  private:
    CityCatalog& catalog_;
    uint64_t seed_;
    std::map<FacadeSpec, uint32_t> by_spec_;
};

class BuildingMaker {
  public:
    BuildingMaker(const CityPlan& plan, const MaterialSet& materials, FacadeDictionary& facades,
                  const CityCatalog& catalog, Vec2 origin)
        : plan_(plan), materials_(materials), facades_(facades), catalog_(catalog), origin_(origin) {}

    /// From now on walls are flat and textured; `walls` outlives this.
    void texture_walls(WallDealer& walls) { walls_ = &walls; }

    CityObject make(const BuildingPlan& building, std::string id) const;
    CityObject make_tree(const TreePlan& tree, std::string id) const;

  private:
    const CityPlan& plan_;
    const MaterialSet& materials_;
    FacadeDictionary& facades_;
    const CityCatalog& catalog_;
    Vec2 origin_;
    WallDealer* walls_ = nullptr;
};

}  // namespace citystream::tiles::city::procedural
