// What dressing does to the outline of a building: nothing.
#include <algorithm>
#include <limits>
#include <numbers>

#include "tests/tiles/city/city_probe.h"
#include "tests/tiles/layers/dress_probe.h"
#include "tiles/city/generator_random.h"

namespace citystream::tiles::layers {
namespace {

using city::CityObject;
using city::SurfaceKind;
using city::Vec2;
using city::Vec3;
using city::procedural::Random;

struct Dressed {
    CityObject before, after;
    DressReport report;
};

/// With a dresser of its own.
Dressed dress(const CityObject& object) {
    city::CityCatalog catalog = plain_catalog();
    Dresser dresser(1, catalog);
    Dressed out{object, object, {}};
    dresser.dress(out.after);
    out.report = dresser.report();
    return out;
}

int64_t floor_of(const CityObject& object) {
    int64_t low = INT64_MAX;
    for (const Vec3& v : object.vertices) low = std::min(low, to_grid(v.z));
    return low;
}

size_t wall_triangles(const CityObject& object) {
    return static_cast<size_t>(std::count_if(object.triangles.begin(), object.triangles.end(),
                                             [](const auto& t) { return t.surface == SurfaceKind::kWall; }));
}

/// Surface still closed, area kept, every facade on a wall and looking out.
void expect_same_outline(const Dressed& d) {
    const int64_t floor = floor_of(d.before);
    ASSERT_EQ(open_lines(d.before, floor), 0u) << d.before.id << ": the test's building is open";
    EXPECT_EQ(open_lines(d.after, floor), 0u) << d.before.id;
    EXPECT_NEAR(upright_area(d.after), upright_area(d.before), 2e-4 * upright_area(d.before)) << d.before.id;
    EXPECT_EQ(facades_off_their_walls(d.before, d.after), 0u) << d.before.id;
    for (const auto& t : d.after.triangles)
        for (uint32_t v : t.vertex) ASSERT_LT(v, d.after.vertices.size());
}

TEST(DressGeometry, EveryWallOfABoxBecomesFacades) {
    const Dressed d = dress(HouseBuilder("box").prism({rectangle(11, 8, {100, 200}, 0.3)}, 2, 8).done());
    EXPECT_EQ(d.after.facades.size(), 4u);
    EXPECT_EQ(wall_triangles(d.after), 0u);
    EXPECT_EQ(d.after.triangles.size(), 4u);
    EXPECT_EQ(d.report.dressed_buildings, 1u);
    expect_same_outline(d);
}

TEST(DressGeometry, LShapesAndCourtyardsKeepTheirOutline) {
    const Ring l = {{0, 0}, {14.03, 0.71}, {13.6, 6.2}, {7.1, 5.9}, {6.8, 12.4}, {-0.4, 12.1}};
    const Dressed shape = dress(HouseBuilder("l").prism({l}, 0, 9.37).done());
    EXPECT_EQ(wall_triangles(shape.after), 0u);
    expect_same_outline(shape);
    Ring hole = rectangle(9, 7, {6, 6}, 0.1);
    std::reverse(hole.begin(), hole.end());
    const Dressed court = dress(HouseBuilder("court").prism({rectangle(24, 21), hole}, 0, 14.2).done());
    EXPECT_GE(court.after.facades.size(), 8u);
    expect_same_outline(court);
}

TEST(DressGeometry, AFootprintInsideOutIsDressedOutwardsOnceTheReaderHasTurnedIt) {
    // A solid whose faces all look inwards.
    const city::TestFolder folder;
    const std::string file = folder.write("inside_out.json", R"({"type":"CityJSON","version":"2.0",
        "transform":{"scale":[0.01,0.01,0.01],"translate":[0,0,0]},
        "CityObjects":{"b":{"type":"Building","geometry":[{"type":"Solid","lod":"1","boundaries":[[
        [[0,1,2,3]],[[7,6,5,4]],[[4,5,1,0]],[[5,6,2,1]],[[6,7,3,2]],[[7,4,0,3]]]]}]}},
        "vertices":[[0,0,0],[1200,0,0],[1200,900,0],[0,900,0],[0,0,600],[1200,0,600],[1200,900,600],[0,900,600]]})");
    city::CityHeader header;
    city::CityReport report;
    city::CityCatalog catalog;
    Dresser dresser(1, catalog);
    size_t objects = 0;
    const Status status = city::read_city({file}, {}, header, catalog, report, [&](CityObject&& object) {
        Dressed d{object, object, {}};
        dresser.dress(d.after);
        EXPECT_EQ(d.after.facades.size(), 4u);
        expect_same_outline(d);
        for (const city::FacadeWall& wall : d.after.facades) {
            const Vec2 middle{wall.lower_left.x + wall.along.x / 2 - 6, wall.lower_left.y + wall.along.y / 2 - 4.5};
            EXPECT_GT(middle.x * wall.along.y - middle.y * wall.along.x, 0) << "looks inwards";
        }
        ++objects;
        return true;
    });
    ASSERT_TRUE(status.ok());
    EXPECT_EQ(objects, 1u);
}

TEST(DressGeometry, AWallInPiecesIsDressedLikeAWhole) {
    const Ring ring = rectangle(11, 8);
    const CityObject whole = HouseBuilder("same").prism({ring}, 0, 6).done();
    HouseBuilder pieces("same");
    for (size_t i = 1; i < 4; ++i) pieces.wall(ring[i], ring[(i + 1) % 4], 0, 6);
    // The first wall as a strip of quads and a fan of triangles around an inner point.
    pieces.wall({0, 0}, {3.5, 0}, 0, 6);
    const Vec3 inner{7, 0, 2.5};
    const std::vector<Vec3> around = {{3.5, 0, 0}, {8, 0, 0}, {11, 0, 0}, {11, 0, 6}, {3.5, 0, 6}};
    for (size_t i = 0; i < around.size(); ++i)
        pieces.triangle({inner, around[i], around[(i + 1) % around.size()]}, SurfaceKind::kWall);
    std::vector<Vec3> roof, floor;
    for (const Vec2& p : ring) roof.push_back({p.x, p.y, 6});
    for (const Vec2& p : {ring[3], ring[2], ring[1], Vec2{8, 0}, Vec2{3.5, 0}, ring[0]}) floor.push_back({p.x, p.y, 0});
    roof.insert(roof.begin() + 1, {3.5, 0, 6});
    pieces.face({roof}, SurfaceKind::kRoof, 1).face({floor}, SurfaceKind::kGround, 1);
    const Dressed a = dress(whole), b = dress(pieces.done());
    expect_same_outline(b);
    ASSERT_EQ(a.after.facades.size(), 4u);
    ASSERT_EQ(b.after.facades.size(), 4u);
    EXPECT_EQ(b.report.walls, 4u);
    const auto places = [](const CityObject& object) {
        std::set<std::array<double, 4>> found;
        for (const auto& f : object.facades) found.insert({f.lower_left.x, f.lower_left.y, f.along.x, f.height});
        return found;
    };
    EXPECT_EQ(places(a.after), places(b.after));
}

/// A house with a gable roof, its ridge along x.
CityObject gable_house(double width, double depth, double eaves, double ridge, double turn) {
    const auto at = [&](double x, double y, double z) {
        return Vec3{50 + std::cos(turn) * x - std::sin(turn) * y, 70 + std::sin(turn) * x + std::cos(turn) * y, z};
    };
    const Vec3 a = at(0, 0, 0), b = at(width, 0, 0), c = at(width, depth, 0), d = at(0, depth, 0);
    const auto up = [](Vec3 p, double z) { return Vec3{p.x, p.y, z}; };
    const Vec3 r0 = at(0, depth / 2, ridge), r1 = at(width, depth / 2, ridge);
    HouseBuilder house("gable");
    house.face({{d, c, b, a}}, SurfaceKind::kGround, 1);
    house.face({{a, b, up(b, eaves), up(a, eaves)}}, SurfaceKind::kWall);
    house.face({{c, d, up(d, eaves), up(c, eaves)}}, SurfaceKind::kWall);
    house.face({{b, c, up(c, eaves), r1, up(b, eaves)}}, SurfaceKind::kWall);
    house.face({{d, a, up(a, eaves), r0, up(d, eaves)}}, SurfaceKind::kWall);
    house.face({{up(a, eaves), up(b, eaves), r1, r0}}, SurfaceKind::kRoof, 1);
    house.face({{up(c, eaves), up(d, eaves), r0, r1}}, SurfaceKind::kRoof, 1);
    return house.done();
}

TEST(DressGeometry, AGableIsDressedUpToItsEavesAndTheRestStaysMesh) {
    const Dressed d = dress(gable_house(9.3, 7.7, 5.6, 8.9, 0.4));
    expect_same_outline(d);
    EXPECT_EQ(d.after.facades.size(), 4u);
    EXPECT_EQ(wall_triangles(d.after), 2u);
    for (const auto& wall : d.after.facades) EXPECT_NEAR(wall.height, 5.6, 1e-3);
}

TEST(DressGeometry, ShedAndSteppedWallsAreCutExactly) {
    // Shed roof: the side walls are trapezoids; the back wall is higher.
    const Vec3 a{0, 0, 0}, b{8, 0, 0}, c{8, 6, 0}, e{0, 6, 0};
    const auto up = [](Vec3 p, double z) { return Vec3{p.x, p.y, z}; };
    HouseBuilder shed("shed");
    shed.face({{e, c, b, a}}, SurfaceKind::kGround, 1);
    shed.face({{a, b, up(b, 3.1), up(a, 3.1)}}, SurfaceKind::kWall);
    shed.face({{b, c, up(c, 4.7), up(b, 3.1)}}, SurfaceKind::kWall);
    shed.face({{c, e, up(e, 4.7), up(c, 4.7)}}, SurfaceKind::kWall);
    shed.face({{e, a, up(a, 3.1), up(e, 4.7)}}, SurfaceKind::kWall);
    shed.face({{up(a, 3.1), up(b, 3.1), up(c, 4.7), up(e, 4.7)}}, SurfaceKind::kRoof, 1);
    const Dressed d = dress(shed.done());
    expect_same_outline(d);
    EXPECT_EQ(d.after.facades.size(), 4u);

    // A front with a low and a high part, and a gap under an arcade, in one plane.
    HouseBuilder step("step");
    step.face({{{0, 0, 0},
                {6, 0, 0},
                {6, 0, 2.4},
                {9, 0, 2.4},
                {9, 0, 0},
                {16, 0, 0},
                {16, 0, 12},
                {7, 0, 12},
                {7, 0, 6},
                {0, 0, 6}}},
              SurfaceKind::kWall);
    const CityObject front = step.done();
    const Dressed s = dress(front);
    EXPECT_NEAR(upright_area(s.after), upright_area(front), 1e-3);
    EXPECT_EQ(facades_off_their_walls(front, s.after), 0u);
    EXPECT_GE(s.after.facades.size(), 2u);
    EXPECT_GT(s.report.facade_area, 0.8 * s.report.wall_area);
}

TEST(DressGeometry, AWallWithAHoleIsDressedAroundIt) {
    HouseBuilder builder("hole");
    builder.face({{{0, 0, 0}, {14, 0, 0}, {14, 0, 9}, {0, 0, 9}}, {{5, 0, 3}, {5, 0, 6}, {8, 0, 6}, {8, 0, 3}}},
                 SurfaceKind::kWall);
    const CityObject before = builder.done();
    const Dressed d = dress(before);
    EXPECT_NEAR(upright_area(d.after), 14 * 9 - 3 * 3, 1e-2);
    EXPECT_EQ(facades_off_their_walls(before, d.after), 0u);
    EXPECT_GE(d.after.facades.size(), 3u);
    EXPECT_GT(d.report.facade_area, 0.9 * d.report.wall_area);
}

TEST(DressGeometry, SmallWallsStayAsTheyWere) {
    const Dressed narrow = dress(HouseBuilder("narrow").prism({rectangle(1.3, 1.2)}, 0, 7).done());
    EXPECT_TRUE(narrow.after.facades.empty());
    EXPECT_EQ(narrow.after.triangles.size(), narrow.before.triangles.size());
    EXPECT_EQ(narrow.report.walls_small, 4u);
    const Dressed low = dress(HouseBuilder("low").prism({rectangle(10, 8)}, 0, 1.8).done());
    EXPECT_TRUE(low.after.facades.empty());
}

TEST(DressGeometry, RoundTowersStayPlainAndOctagonsAreDressed) {
    const auto round = [](int facets, double radius) {
        Ring ring;
        for (int i = 0; i < facets; ++i) {
            const double angle = 2 * std::numbers::pi * i / facets;
            ring.push_back({radius * std::cos(angle), radius * std::sin(angle)});
        }
        return ring;
    };
    const Dressed silo = dress(HouseBuilder("silo").prism({round(24, 9)}, 0, 14).done());
    EXPECT_TRUE(silo.after.facades.empty());
    EXPECT_EQ(silo.report.walls_curved, 24u);
    const Dressed octagon = dress(HouseBuilder("octagon").prism({round(8, 6)}, 0, 9).done());
    EXPECT_EQ(octagon.after.facades.size(), 8u);
    expect_same_outline(octagon);
}

TEST(DressGeometry, WallsBetweenTwoPartsOfABuildingStayPlain) {
    HouseBuilder builder("parts");
    builder.prism({rectangle(10, 9)}, 0, 12).prism({rectangle(8, 9, {10, 0})}, 0, 5);
    const Dressed d = dress(builder.done());
    EXPECT_EQ(d.report.walls_shared, 1u);  // the low part's; of the high part's the upper half is seen
    EXPECT_EQ(facades_off_their_walls(d.before, d.after), 0u);
    EXPECT_NEAR(upright_area(d.after), upright_area(d.before), 1e-2);
    size_t above = 0;
    for (const auto& wall : d.after.facades) {
        if (std::abs(wall.lower_left.x - 10) > 1e-6 || std::abs(wall.along.x) > 1e-6) continue;
        EXPECT_NEAR(wall.lower_left.z, 5, 1e-3);
        ++above;
    }
    EXPECT_EQ(above, 1u);
}

TEST(DressGeometry, ObjectsThatAreNoPlainBuildingsAreLeftAlone) {
    CityObject bridge = HouseBuilder("bridge").prism({rectangle(10, 9)}, 0, 6).done();
    bridge.kind = city::ObjectKind::kBridge;
    EXPECT_TRUE(dress(bridge).after.facades.empty());
    CityObject facade = HouseBuilder("facade").prism({rectangle(10, 9)}, 0, 6).done();
    facade.facades.push_back({{0, 0, 0}, {10, 0}, 6, 0, 0});
    EXPECT_EQ(dress(facade).after.facades.size(), 1u);
    CityObject detailed = HouseBuilder("detailed").prism({rectangle(10, 9)}, 0, 6).done();
    detailed.triangles.front().surface = SurfaceKind::kWindow;
    EXPECT_TRUE(dress(detailed).after.facades.empty());
    EXPECT_TRUE(dress(CityObject{}).after.facades.empty());
}

TEST(DressGeometry, DefectsOfTheModelDoNoHarm) {
    const CityObject sound = HouseBuilder("defect").prism({rectangle(10, 9)}, 0, 6).done();
    CityObject doubled = sound;
    doubled.triangles.insert(doubled.triangles.end(), sound.triangles.begin(), sound.triangles.end());
    EXPECT_NEAR(upright_area(dress(doubled).after), upright_area(doubled), 1e-3);
    CityObject flat = sound;
    flat.triangles.push_back(flat.triangles.front());
    flat.triangles.back().vertex[1] = flat.triangles.back().vertex[0];
    EXPECT_EQ(dress(flat).after.facades.size(), 4u);
    CityObject lost = sound;
    lost.triangles[0].vertex[0] = 1000000;
    EXPECT_TRUE(dress(lost).after.facades.empty());
    CityObject material = sound;
    material.triangles[0].material = 77;
    EXPECT_TRUE(dress(material).after.facades.empty());
    for (double wild : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e30, 1e6}) {
        CityObject far = sound;
        far.vertices[0].x = wild;
        EXPECT_TRUE(dress(far).after.facades.empty()) << wild;
    }
    CityObject open = sound;
    open.triangles.erase(open.triangles.begin());
    EXPECT_NEAR(upright_area(dress(open).after), upright_area(open), 1e-3);
}

TEST(DressGeometry, AWallOfManyCornersEndsInReasonableTime) {
    // A comb of teeth as one wall, and thousands of walls on one line.
    std::vector<Vec3> comb = {{0, 0, 0}, {4000, 0, 0}};
    for (int i = 1000; i-- > 0;) {
        comb.push_back({4.0 * i + 3, 0, 8.0 + i % 3});
        comb.push_back({4.0 * i + 1, 0, 5});
    }
    const CityObject teeth = HouseBuilder("comb").face({comb}, SurfaceKind::kWall).done();
    EXPECT_NEAR(upright_area(dress(teeth).after), upright_area(teeth), 1e-2);
    HouseBuilder many("many");
    for (int i = 0; i < 3000; ++i) {
        many.wall({0, 0.0}, {20, 0.0}, i * 3.0, i * 3.0 + 2.5);
        many.wall({20, 0.0}, {0, 0.0}, i * 3.0, i * 3.0 + 2.5);
    }
    const CityObject walls = many.done();
    EXPECT_NEAR(upright_area(dress(walls).after), upright_area(walls), 1);
}

TEST(DressGeometry, RandomBuildingsStayClosedWhateverTheirTurn) {
    Random random(7);
    city::CityCatalog catalog = plain_catalog();
    Dresser dresser(1, catalog);
    const auto check = [&](const CityObject& object) {
        Dressed d{object, object, {}};
        dresser.dress(d.after);
        expect_same_outline(d);
    };
    for (int i = 0; i < 400; ++i) {
        const double turn = random.below(6283) / 1000.0;
        const double w = random.between(200, 4200) / 100.0, depth = random.between(200, 3000) / 100.0,
                     h = random.between(210, i % 7 == 0 ? 19000 : 2600) / 100.0;
        if (i % 3 == 0) {
            check(gable_house(w, depth, h, h + depth / 3, turn));
            continue;
        }
        Ring ring = rectangle(w, depth, {1000.0 * i, -500.0 * i}, turn);
        if (i % 3 == 1) {  // a bend of some millimetres in a long wall, as surveys have it
            const Vec2 &a = ring[0], &b = ring[1];
            const double share = random.between(20, 80) / 100.0, bend = random.between(-9, 9) / 1000.0;
            ring.insert(ring.begin() + 1, Vec2{a.x + share * (b.x - a.x) + bend * std::sin(turn),
                                               a.y + share * (b.y - a.y) - bend * std::cos(turn)});
        }
        check(HouseBuilder("random-" + std::to_string(i)).prism({ring}, 3.217, 3.217 + h).done());
        if (HasFailure()) return;
    }
}

}  // namespace
}  // namespace citystream::tiles::layers
