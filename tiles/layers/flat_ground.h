// The flat ground of a city whose input has none: a rectangle at the city's lowest point, under all of its extent.
#pragma once

#include "tiles/city/city_model.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// The part of it that lies in one tile: never empty, also for a city thinner than the grid.
quadtree::BuildObject flat_ground_of_tile(const quadtree::GridBox& city, const GridPoint& corner, int64_t side);

/// All of it, for the uncompressed reference. Its material is added to the catalog.
city::CityObject flat_ground_of_city(const quadtree::GridBox& city, city::CityCatalog& catalog);

}  // namespace citystream::tiles::layers
