// What the type names of CityJSON and CityGML mean to us.
#pragma once

#include <optional>
#include <string_view>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

/// Of a city object ("Building", "BuildingPart", "Road", "TINRelief", ...); unknown names and extensions ("+X") are
/// kOther.
ObjectKind object_kind(std::string_view type);

/// Of a semantic surface ("WallSurface", "Window", ...). Empty for surfaces that only exist inside a building (rooms'
/// walls, floors and ceilings).
std::optional<SurfaceKind> surface_kind(std::string_view type);

}  // namespace citystream::tiles::city
