#include "tiles/layers/flat_ground.h"

#include <algorithm>
#include <array>

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::GridBox;

constexpr std::array<uint8_t, 3> kColour = {142, 140, 132};
constexpr std::array<std::array<uint32_t, 3>, 2> kTriangles = {{{0, 1, 2}, {0, 2, 3}}};

/// Counter-clockwise from the lower left.
std::array<GridPoint, 4> corners_of(const GridBox& city, const GridPoint& lo, const GridPoint& hi) {
    const int64_t x0 = std::max(lo.x, city.lo.x), x1 = std::max(x0 + 1, std::min(hi.x, city.hi.x));
    const int64_t y0 = std::max(lo.y, city.lo.y), y1 = std::max(y0 + 1, std::min(hi.y, city.hi.y));
    const int64_t z = city.lo.z;
    return {GridPoint{x0, y0, z}, GridPoint{x1, y0, z}, GridPoint{x1, y1, z}, GridPoint{x0, y1, z}};
}

}  // namespace

BuildObject flat_ground_of_tile(const GridBox& city, const GridPoint& corner, int64_t side) {
    BuildObject ground;
    ground.kind = city::ObjectKind::kTerrain;
    ground.paints = {quadtree::Paint::flat(kColour)};
    const auto corners = corners_of(city, corner, {corner.x + side, corner.y + side, 0});
    ground.vertices.assign(corners.begin(), corners.end());
    ground.triangles.resize(kTriangles.size());
    for (size_t i = 0; i < kTriangles.size(); ++i) ground.triangles[i].vertex = kTriangles[i];
    return ground;
}

city::CityObject flat_ground_of_city(const GridBox& city, city::CityCatalog& catalog) {
    city::CityObject ground;
    ground.kind = city::ObjectKind::kTerrain;
    for (const GridPoint& p : corners_of(city, city.lo, city.hi))
        ground.vertices.push_back({to_metres(p.x), to_metres(p.y), to_metres(p.z)});
    city::Material material;
    material.rgb = kColour;
    catalog.materials.push_back(material);
    ground.triangles.resize(kTriangles.size());
    for (size_t i = 0; i < kTriangles.size(); ++i) {
        ground.triangles[i].vertex = kTriangles[i];
        ground.triangles[i].material = static_cast<uint32_t>(catalog.materials.size() - 1);
    }
    return ground;
}

}  // namespace citystream::tiles::layers
