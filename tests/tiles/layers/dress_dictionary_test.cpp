// Which facades a dressed building gets: plausible ones, from a dictionary that stays small.
#include <algorithm>
#include <chrono>

#include "tests/tiles/layers/dress_probe.h"
#include "tiles/city/generator_random.h"
#include "tiles/city/grammar.h"
#include "tiles/city/surface_colours.h"
#include "tiles/layers/dress_maps.h"
#include "tiles/layers/dress_plan.h"

namespace citystream::tiles::layers {
namespace {

using city::CityObject;
using city::procedural::FacadeRole;
using city::procedural::FacadeUse;
using city::procedural::Random;
using city::procedural::Slot;

CityObject random_building(Random& random, int number) {
    const double turn = random.below(6283) / 1000.0;
    const int kind = random.below(10);
    const double w = random.between(300, kind < 7 ? 1400 : 6000) / 100.0,
                 d = random.between(300, kind < 7 ? 1200 : 4000) / 100.0,
                 h = random.between(220, kind < 7   ? 1200
                                         : kind < 9 ? 4000
                                                    : 20000) /
                     100.0;
    Ring ring = rectangle(w, d, {13.0 * number, 7.0 * number}, turn);
    if (random.chance(40)) {  // an L
        const auto at = [&](double x, double y) {
            return city::Vec2{ring[0].x + (ring[1].x - ring[0].x) * x + (ring[3].x - ring[0].x) * y,
                              ring[0].y + (ring[1].y - ring[0].y) * x + (ring[3].y - ring[0].y) * y};
        };
        ring = {at(0, 0), at(1, 0), at(1, 0.4), at(0.6, 0.4), at(0.6, 1), at(0, 1)};
    }
    return HouseBuilder("building-" + std::to_string(number)).prism({ring}, 0, h).done();
}

/// What can be compared between catalogs that number their maps differently.
struct Placed {
    city::FacadeWall wall;
    codec::facade::RunGrid map;
};
std::vector<Placed> placed(const CityObject& object, const city::CityCatalog& catalog) {
    std::vector<Placed> found;
    for (const auto& wall : object.facades) found.push_back({wall, catalog.facade_maps.map(wall.map)});
    return found;
}

void expect_equal(const std::vector<Placed>& a, const std::vector<Placed>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].wall.lower_left.x, b[i].wall.lower_left.x);
        EXPECT_EQ(a[i].wall.height, b[i].wall.height);
        EXPECT_EQ(a[i].wall.palette, b[i].wall.palette);
        EXPECT_TRUE(a[i].map == b[i].map);
    }
}

TEST(DressDictionary, ABuildingsDressDependsOnNothingButItself) {
    Random random(3);
    std::vector<CityObject> city;
    for (int i = 0; i < 40; ++i) city.push_back(random_building(random, i));
    city::CityCatalog forwards = plain_catalog(), backwards = plain_catalog(), alone = plain_catalog();
    std::vector<CityObject> a = city, b = city;
    Dresser first(11, forwards), second(11, backwards), third(11, alone);
    for (CityObject& object : a) first.dress(object);
    std::for_each(b.rbegin(), b.rend(), [&](CityObject& object) { second.dress(object); });
    for (size_t i = 0; i < city.size(); ++i) expect_equal(placed(a[i], forwards), placed(b[i], backwards));
    CityObject one = city[17];
    third.dress(one);
    expect_equal(placed(a[17], forwards), placed(one, alone));
}

TEST(DressDictionary, TriangleOrderDoesNotMatter) {
    Random random(4);
    city::CityCatalog catalog = plain_catalog();
    Dresser dresser(2, catalog);
    for (int i = 0; i < 50; ++i) {
        CityObject a = random_building(random, i), b = a;
        std::reverse(b.triangles.begin(), b.triangles.end());
        dresser.dress(a);
        dresser.dress(b);
        expect_equal(placed(a, catalog), placed(b, catalog));
    }
}

CityObject twin(int number, double east) {
    return HouseBuilder("twin-" + std::to_string(number)).prism({rectangle(11, 9, {east, 0})}, 0, 8).done();
}

TEST(DressDictionary, SeedsIdsAndDistrictsMakeDifferentStyles) {
    std::set<std::pair<uint32_t, uint32_t>> styles;
    city::CityCatalog catalog = plain_catalog();
    Dresser dresser(5, catalog);
    for (int i = 0; i < 60; ++i) {
        CityObject object = twin(i, 0);
        dresser.dress(object);
        ASSERT_FALSE(object.facades.empty());
        styles.insert({object.facades[0].map, object.facades[0].palette});
    }
    EXPECT_GT(styles.size(), 5u);  // one district: a few colours
    city::CityCatalog other_catalog = plain_catalog();
    Dresser other(6, other_catalog);
    int same = 0;
    std::set<uint32_t> palettes;
    for (int i = 0; i < 30; ++i) {
        CityObject a = twin(i, 600.0 * i), b = a;
        dresser.dress(a);
        other.dress(b);
        same += a.facades[0].palette == b.facades[0].palette ? 1 : 0;
        palettes.insert(a.facades[0].palette);
    }
    EXPECT_LT(same, 15);
    EXPECT_GT(palettes.size(), 6u);
}

TEST(DressDictionary, GrowsLikeTheVarietyOfWallsAndNotLikeTheCity) {
    Random random(1);
    city::CityCatalog catalog = plain_catalog();
    Dresser dresser(1, catalog);
    const auto begin = std::chrono::steady_clock::now();
    size_t at_half = 0;
    for (int i = 0; i < 10000; ++i) {
        CityObject object = random_building(random, i);
        dresser.dress(object);
        if (i == 4999) at_half = catalog.facade_maps.size();
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const DressReport report = dresser.report();
    EXPECT_EQ(report.dressed_buildings, 10000u);
    EXPECT_GT(report.facades, 40000u);
    EXPECT_LT(catalog.facade_maps.size(), 6000u);
    EXPECT_LT(catalog.facade_maps.size(), at_half * 5 / 4);
    EXPECT_LE(catalog.palettes.size(), 64u);
    EXPECT_LT(seconds * 1e6 / static_cast<double>(report.walls), 500) << "microseconds a wall";
    // The dictionary is what it says: sound, and closed at its border, so that neighbouring walls meet.
    for (uint32_t i = 0; i < catalog.facade_maps.size(); ++i) {
        const codec::facade::RunGrid map = catalog.facade_maps.map(i);
        ASSERT_TRUE(codec::facade::is_valid(map));
        ASSERT_LE(std::max(map.width(), map.height()), codec::facade::kMaxFacadeSide);
        ASSERT_FALSE(map.has_open_cells());
        constexpr uint32_t kMargin = 9;  // texels
        int32_t least = 0;
        for (uint32_t r = 0; r < map.rows(); ++r) {
            for (uint32_t c = 0; c < map.columns(); ++c) {
                const bool inside = map.x_breaks[c] >= kMargin && map.x_breaks[c + 1] + kMargin <= map.width() &&
                                    map.y_breaks[r] >= kMargin && map.y_breaks[r + 1] + kMargin <= map.height();
                if (!inside) least = std::min(least, codec::facade::displacement_of(map.label(c, r)));
            }
        }
        EXPECT_GE(least, 0) << map.width() << " x " << map.height();
    }
}

TEST(DressDictionary, MapsAreStretchedLittle) {
    Random random(9);
    for (int i = 0; i < 20000; ++i) {
        BuildingStyle style;
        style.use = static_cast<FacadeUse>(random.below(6));
        style.variant = static_cast<uint8_t>(random.below(kDressVariants[static_cast<size_t>(style.use)]));
        style.shop = random.chance(50);
        const auto role = static_cast<FacadeRole>(random.below(3));
        const double width = random.between(150, 20000) / 100.0, height = random.between(260, 30000) / 100.0;
        const bool elevated = random.chance(30);
        const WallPlan plan = plan_wall(style, role, width, height, elevated);
        ASSERT_FALSE(plan.pieces.empty());
        const double across = 100 * width / plan.columns / plan.pieces[0].width_cm(),
                     up = 100 * height / plan.height_cm;
        EXPECT_LT(std::max(across, 1 / across), kMostStretch);
        const bool lower_than_its_ground_floor = height < 4.3;
        EXPECT_LT(std::max(up, 1 / up), lower_than_its_ground_floor ? 1.2 : kMostStretch + 0.005)
            << "use " << static_cast<int>(plan.pieces[0].use) << " height " << height;
    }
}

TEST(DressDictionary, TowersAreStackedAndOnlyTheirFootHasDoors) {
    BuildingStyle style;
    for (FacadeUse use : {FacadeUse::kTower, FacadeUse::kApartment, FacadeUse::kRowHouse}) {
        style.use = use;
        const WallPlan plan = plan_wall(style, FacadeRole::kFront, 30, 153, false);
        EXPECT_EQ(plan.columns, 2u);
        ASSERT_GE(plan.pieces.size(), 4u);
        EXPECT_EQ(plan.pieces.front().piece, FacadePiece::kBase);
        EXPECT_EQ(plan.pieces.back().piece, FacadePiece::kUpper);
        for (const DressMapSpec& spec : plan.pieces) {
            const codec::facade::RunGrid map = derive_dress_map(spec, 1);
            EXPECT_EQ(static_cast<int>(map.width()), spec.width_cm());
            EXPECT_EQ(static_cast<int>(map.height()), map_height_cm(spec));
            const bool door = std::any_of(map.labels.begin(), map.labels.end(), [](uint32_t label) {
                return codec::facade::material_of(label) == static_cast<uint32_t>(Slot::kDoor);
            });
            const bool wanted = &spec == &plan.pieces.front() && use != FacadeUse::kTower;  // towers' are of glass
            EXPECT_EQ(door, wanted);
        }
    }
    city::CityCatalog catalog = plain_catalog();
    Dresser dresser(1, catalog);
    CityObject tower = HouseBuilder("tower").prism({rectangle(30, 24)}, 5, 5 + 201.37).done();
    dresser.dress(tower);
    std::map<std::pair<double, double>, double> heights;  // by foot of the wall
    for (const auto& wall : tower.facades) heights[{wall.lower_left.x, wall.lower_left.y}] += wall.height;
    EXPECT_EQ(heights.size(), 8u);
    for (const auto& [place, height] : heights) EXPECT_NEAR(height, 201.37, 1e-3);
    EXPECT_EQ(open_lines(tower, to_grid(5)), 0u);
}

TEST(DressDictionary, OneStyleABuildingAndOneHouseDoor) {
    Random random(12);
    city::CityCatalog catalog = plain_catalog();
    Dresser dresser(1, catalog);
    for (int i = 0; i < 100; ++i) {
        CityObject house = HouseBuilder("house-" + std::to_string(i))
                               .prism({rectangle(random.between(900, 1200) / 100.0, random.between(850, 1000) / 100.0)},
                                      0, random.between(280, 500) / 100.0)
                               .done();
        dresser.dress(house);
        ASSERT_FALSE(house.facades.empty());
        std::set<uint32_t> palettes;
        for (const auto& wall : house.facades) palettes.insert(wall.palette);
        EXPECT_EQ(palettes.size(), 1u);
    }
    EXPECT_GT(dresser.report().by_use[static_cast<size_t>(FacadeUse::kHouse)], 60u);
    const BuildingStyle style;
    HouseBuilder builder("e");
    builder.prism({{{0, 0}, {4, 0}, {4, 2}, {8, 2}, {8, 0}, {12, 0}, {12, 9}, {0, 9}}}, 0, 5);
    GridObject grid;
    const CityObject object = builder.done();
    ASSERT_TRUE(put_on_grid(object, grid));
    const WallSearch search = find_walls(object, grid);
    const auto roles = wall_roles(search.walls, style);
    EXPECT_EQ(std::count(roles.begin(), roles.end(), FacadeRole::kFront), 1);
}

TEST(DressDictionary, NothingIsAddedToACityWithoutWalls) {
    city::CityCatalog catalog = plain_catalog();
    Dresser dresser(1, catalog);
    CityObject flat = HouseBuilder("flat").prism({rectangle(10, 10)}, 0, 1).done();
    dresser.dress(flat);
    EXPECT_EQ(catalog.materials.size(), 2u);
    EXPECT_TRUE(catalog.palettes.empty());
    EXPECT_TRUE(catalog.images.empty());
    EXPECT_TRUE(catalog.facade_maps.empty());
}

TEST(DressDictionary, WallsWithoutAColourTakeThatOfTheFacadesAndOthersKeepTheirs) {
    for (const bool uncoloured : {true, false}) {
        city::CityCatalog catalog = plain_catalog();
        if (uncoloured)
            catalog.materials[0].rgb = city::default_colour(city::ObjectKind::kBuilding, city::SurfaceKind::kWall);
        Dresser dresser(1, catalog);
        // The last wall is too narrow to be dressed.
        CityObject object = HouseBuilder("corner")
                                .prism({{{0, 0}, {10, 0}, {10, 8}, {0, 8}, {0, 7}, {-0.9, 7}, {-0.9, 0}}}, 0, 6)
                                .done();
        dresser.dress(object);
        size_t walls = 0;
        for (const auto& t : object.triangles) {
            if (t.surface != city::SurfaceKind::kWall) continue;
            ++walls;
            EXPECT_EQ(t.material != 0, uncoloured);
            EXPECT_LT(catalog.materials[t.material].image, 0);
        }
        EXPECT_GE(walls, 2u);
    }
}

}  // namespace
}  // namespace citystream::tiles::layers
