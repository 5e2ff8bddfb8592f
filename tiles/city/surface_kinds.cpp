#include "tiles/city/surface_kinds.h"

#include <algorithm>
#include <array>
#include <utility>

namespace citystream::tiles::city {

ObjectKind object_kind(std::string_view type) {
    if (type.starts_with("Building")) return ObjectKind::kBuilding;
    if (type.starts_with("Bridge")) return ObjectKind::kBridge;
    constexpr std::array<std::pair<std::string_view, ObjectKind>, 17> kKinds = {{
        {"Road", ObjectKind::kRoad},
        {"Railway", ObjectKind::kRoad},
        {"Square", ObjectKind::kRoad},
        {"TransportSquare", ObjectKind::kRoad},
        {"TransportationComplex", ObjectKind::kRoad},
        {"Track", ObjectKind::kRoad},
        {"TINRelief", ObjectKind::kTerrain},
        {"ReliefFeature", ObjectKind::kTerrain},
        {"LandUse", ObjectKind::kLandUse},
        {"WaterBody", ObjectKind::kWater},
        {"Waterway", ObjectKind::kWater},
        {"PlantCover", ObjectKind::kVegetation},
        {"SolitaryVegetationObject", ObjectKind::kVegetation},
        {"CityFurniture", ObjectKind::kFurniture},
        {"BreaklineRelief", ObjectKind::kTerrain},
        {"MassPointRelief", ObjectKind::kTerrain},
        {"RasterRelief", ObjectKind::kTerrain},
    }};
    const auto found = std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& kind) { return kind.first == type; });
    return found == kKinds.end() ? ObjectKind::kOther : found->second;
}

std::optional<SurfaceKind> surface_kind(std::string_view type) {
    if (type.starts_with("Interior") || type == "FloorSurface" || type == "CeilingSurface") return std::nullopt;
    if (type == "WallSurface" || type == "OuterCeilingSurface") return SurfaceKind::kWall;
    if (type == "RoofSurface" || type == "OuterFloorSurface") return SurfaceKind::kRoof;
    if (type == "GroundSurface") return SurfaceKind::kGround;
    if (type == "Window" || type == "WindowSurface") return SurfaceKind::kWindow;
    if (type == "Door" || type == "DoorSurface") return SurfaceKind::kDoor;
    if (type == "BuildingInstallation") return SurfaceKind::kInstallation;
    return SurfaceKind::kUnknown;
}

}  // namespace citystream::tiles::city
