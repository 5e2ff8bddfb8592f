// Geometry of generated buildings and terrain: orientation, welding, seams, standing on the ground, facade walls that
// fit their maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "tiles/city/generator.h"

namespace citystream::tiles::city {
namespace {

struct City {
    CityCatalog catalog;
    std::vector<CityObject> buildings, cells, plants;
};

City generate(uint32_t buildings, uint64_t seed, uint32_t textures = 0) {
    City city;
    CityHeader header;
    CityReport report;
    GeneratorOptions options;
    options.buildings = buildings;
    options.seed = seed;
    options.textures = textures;
    generate_city(options, header, city.catalog, report, [&city](CityObject&& object) {
        auto& list = object.kind == ObjectKind::kBuilding  ? city.buildings
                     : object.kind == ObjectKind::kTerrain ? city.cells
                                                           : city.plants;
        list.push_back(std::move(object));
        return true;
    });
    return city;
}

Vec3 normal_of(const CityObject& object, const Triangle& triangle) {
    const Vec3 &a = object.vertices[triangle.vertex[0]], &b = object.vertices[triangle.vertex[1]],
               &c = object.vertices[triangle.vertex[2]];
    const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z};
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

double length(const Vec3& v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

/// The height of the terrain's triangles, looked up by cell.
class Ground {
  public:
    explicit Ground(const City& city) {
        for (const CityObject& cell : city.cells) cells_[key(low_corner(cell))] = &cell;
    }
    bool height(double x, double y, double& z) const {
        const auto cell = cells_.find({static_cast<int>(std::floor(x / kTerrainCellMetres)),
                                       static_cast<int>(std::floor(y / kTerrainCellMetres))});
        if (cell == cells_.end()) return false;
        const CityObject& object = *cell->second;
        for (const Triangle& triangle : object.triangles) {
            const Vec3 &a = object.vertices[triangle.vertex[0]], &b = object.vertices[triangle.vertex[1]],
                       &c = object.vertices[triangle.vertex[2]];
            const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
            const double s = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / area;
            const double t = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / area;
            if (s < -1e-9 || t < -1e-9 || s + t > 1 + 1e-9) continue;
            z = a.z + s * (b.z - a.z) + t * (c.z - a.z);
            return true;
        }
        return false;
    }

  private:
    static Vec3 low_corner(const CityObject& cell) {
        Vec3 low = cell.vertices.front();
        for (const Vec3& at : cell.vertices) low = {std::min(low.x, at.x), std::min(low.y, at.y), 0};
        return low;
    }
    static std::pair<int, int> key(const Vec3& at) {
        return {static_cast<int>(std::floor(at.x / kTerrainCellMetres)),
                static_cast<int>(std::floor(at.y / kTerrainCellMetres))};
    }
    std::map<std::pair<int, int>, const CityObject*> cells_;
};

TEST(GeneratedTerrain, SharesTheVerticesOfCommonBorders) {
    const City city = generate(150, 7);
    ASSERT_GT(city.cells.size(), 8U);
    // Every border line of a cell, as the set of its vertices; two cells at a line must list the same.
    std::map<std::tuple<int, double, double>, std::vector<std::set<std::pair<double, double>>>> borders;
    for (const CityObject& cell : city.cells) {
        Vec3 low = cell.vertices.front();
        for (const Vec3& at : cell.vertices) low = {std::min(low.x, at.x), std::min(low.y, at.y), 0};
        EXPECT_EQ(std::fmod(low.x, kTerrainCellMetres), 0);
        EXPECT_EQ(std::fmod(low.y, kTerrainCellMetres), 0);
        for (double side : {0.0, kTerrainCellMetres}) {
            std::set<std::pair<double, double>> upright, level;
            for (const Vec3& at : cell.vertices) {
                if (at.x == low.x + side) upright.emplace(at.y, at.z);
                if (at.y == low.y + side) level.emplace(at.x, at.z);
            }
            borders[{0, low.x + side, low.y}].push_back(upright);
            borders[{1, low.y + side, low.x}].push_back(level);
        }
    }
    size_t shared = 0;
    for (const auto& [where, sides] : borders) {
        EXPECT_GE(sides.front().size(), 3U);
        if (sides.size() == 2) {
            ++shared;
            EXPECT_EQ(sides[0], sides[1]);
        }
    }
    EXPECT_GT(shared, city.cells.size());
}

TEST(GeneratedTerrain, FillsEveryCellOnceFacingUp) {
    const City city = generate(40, 8);
    for (const CityObject& cell : city.cells) {
        double area = 0;
        for (const Triangle& triangle : cell.triangles) {
            const Vec3 normal = normal_of(cell, triangle);
            EXPECT_GT(normal.z, 0);
            area += normal.z / 2;
        }
        EXPECT_EQ(area, kTerrainCellMetres * kTerrainCellMetres);
    }
}

TEST(GeneratedBuildings, StandOnTheGroundWithPlinthsThatReachIntoIt) {
    const City city = generate(250, 11);
    const Ground ground(city);
    for (const CityObject& building : city.buildings) {
        double foot = 1e9, bottom = 1e9;
        for (const FacadeWall& wall : building.facades) foot = std::min(foot, wall.lower_left.z);
        for (const Vec3& at : building.vertices) bottom = std::min(bottom, at.z);
        for (const FacadeWall& wall : building.facades) {
            if (wall.lower_left.z > foot) continue;  // upper section of a tower
            for (int step = 0; step <= 8; ++step) {
                double z = 0;
                ASSERT_TRUE(ground.height(wall.lower_left.x + wall.along.x * step / 8,
                                          wall.lower_left.y + wall.along.y * step / 8, z))
                    << building.id << " stands beside the terrain";
                EXPECT_GE(foot, z) << building.id << " is buried";
                EXPECT_LT(bottom, z) << building.id << " floats";
                EXPECT_LT(foot - bottom, 9) << building.id;
            }
        }
    }
}

TEST(GeneratedBuildings, HaveTrianglesWithAreaAndWeldedVertices) {
    for (const uint32_t textures : {0, 100}) {
        const City city = generate(250, 12, textures);
        for (const auto* list : {&city.buildings, &city.plants, &city.cells}) {
            for (const CityObject& object : *list) {
                for (const Triangle& triangle : object.triangles)
                    EXPECT_GT(length(normal_of(object, triangle)), 1e-5) << object.id;
                std::set<std::tuple<double, double, double>> distinct;
                for (const Vec3& at : object.vertices) distinct.insert({at.x, at.y, at.z});
                EXPECT_EQ(distinct.size(), object.vertices.size()) << object.id;
            }
        }
        for (const CityObject& plant : city.plants) EXPECT_LE(plant.triangles.size(), 16U);
    }
}

TEST(GeneratedBuildings, TurnTheirWallsOutwards) {
    const City city = generate(250, 13);
    for (const CityObject& building : city.buildings) {
        double foot = 1e9;
        for (const FacadeWall& wall : building.facades) foot = std::min(foot, wall.lower_left.z);
        // The plinth's lower vertices are the footprint's corners.
        double bottom = 1e9;
        for (const Vec3& at : building.vertices) bottom = std::min(bottom, at.z);
        Vec3 centre;
        double corners = 0;
        for (const Vec3& at : building.vertices) {
            if (at.z != bottom) continue;
            centre = {centre.x + at.x, centre.y + at.y, 0};
            ++corners;
        }
        ASSERT_GE(corners, 4);
        centre = {centre.x / corners, centre.y / corners, 0};
        for (const FacadeWall& wall : building.facades) {
            const double out = (wall.lower_left.x + wall.along.x / 2 - centre.x) * wall.along.y -
                               (wall.lower_left.y + wall.along.y / 2 - centre.y) * wall.along.x;
            EXPECT_GT(out, 0) << building.id;
        }
        if (corners > 4) continue;  // a garage makes the outline concave
        for (const Triangle& triangle : building.triangles) {
            const Vec3 normal = normal_of(building, triangle);
            const Vec3& at = building.vertices[triangle.vertex[0]];
            const bool plinth = std::all_of(triangle.vertex.begin(), triangle.vertex.end(),
                                            [&](uint32_t vertex) { return building.vertices[vertex].z <= foot; });
            if (!plinth) continue;
            EXPECT_GT((at.x - centre.x) * normal.x + (at.y - centre.y) * normal.y, 0) << building.id;
        }
    }
}

TEST(GeneratedBuildings, EncloseAVolumeWithTheirFacades) {
    // Seen from below, every building is open only at its foot: outward area over all surfaces sums to the footprint,
    // straight up.
    for (const uint32_t textures : {0, 100}) {
        const City city = generate(250, 15, textures);
        for (const CityObject& building : city.buildings) {
            Vec3 sum;
            for (const Triangle& triangle : building.triangles) {
                const Vec3 normal = normal_of(building, triangle);
                sum = {sum.x + normal.x / 2, sum.y + normal.y / 2, sum.z + normal.z / 2};
            }
            for (const FacadeWall& wall : building.facades) {
                sum.x += wall.along.y * wall.height;
                sum.y -= wall.along.x * wall.height;
            }
            EXPECT_GT(sum.z, 0) << building.id;
            // Chimneys and dormers sink into roofs without a floor; sideways they add nothing but the dormers' hidden
            // backs, garages their missing wall against the house.
            EXPECT_LT(std::hypot(sum.x, sum.y), 45) << building.id;
        }
    }
}

TEST(GeneratedFacadeWalls, StretchTheirMapsByLessThanOnePercent) {
    const City city = generate(250, 14);
    for (const CityObject& building : city.buildings) {
        for (const FacadeWall& wall : building.facades) {
            const codec::facade::RunGrid map = city.catalog.facade_maps.map(wall.map);
            const double width = std::hypot(wall.along.x, wall.along.y) * 100, height = wall.height * 100;
            EXPECT_NEAR(width / map.width(), 1, 0.01) << building.id;
            EXPECT_NEAR(height / map.height(), 1, 0.01) << building.id;
        }
    }
}

}  // namespace
}  // namespace citystream::tiles::city
