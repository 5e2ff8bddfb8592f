// The parts that make coarse tiles, one by one: outlines, blocks, crowds, decimation, ground, skirts, cuts at cells,
// relief.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "codec/facade/run_grid.h"
#include "tests/tiles/layers/image_files.h"
#include "tiles/layers/block.h"
#include "tiles/layers/coarsen.h"
#include "tiles/layers/cutout.h"
#include "tiles/layers/decimate.h"
#include "tiles/layers/ground.h"
#include "tiles/layers/hidden_faces.h"
#include "tiles/layers/outline.h"
#include "tiles/layers/relief_mesh.h"
#include "tiles/layers/skirts.h"
#include "tiles/layers/surface_distance.h"
#include "tiles/quadtree/object_spool.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::BuildTriangle;
using quadtree::Paint;

constexpr int64_t kMetre = 1024;

void add(BuildObject& object, uint32_t a, uint32_t b, uint32_t c) {
    BuildTriangle triangle;
    triangle.vertex = {a, b, c};
    object.triangles.push_back(triangle);
}

/// Walls and a flat roof over an outline in metres.
BuildObject prism(const std::vector<std::array<double, 2>>& outline, double height) {
    BuildObject object;
    object.kind = city::ObjectKind::kBuilding;
    object.paints = {Paint::flat({200, 100, 50})};
    Outline corners;
    for (const auto& p : outline) {
        corners.push_back({to_grid(p[0]), to_grid(p[1])});
        object.vertices.push_back({corners.back()[0], corners.back()[1], 0});
        object.vertices.push_back({corners.back()[0], corners.back()[1], to_grid(height)});
    }
    const auto n = static_cast<uint32_t>(outline.size());
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t j = (i + 1) % n;
        add(object, 2 * i, 2 * j, 2 * j + 1);
        add(object, 2 * i, 2 * j + 1, 2 * i + 1);
    }
    const auto roof = triangulate_outline(corners);
    for (size_t i = 0; i + 2 < roof.size(); i += 3)
        add(object, 2 * roof[i] + 1, 2 * roof[i + 1] + 1, 2 * roof[i + 2] + 1);
    return object;
}

/// A lattice of ground, `cells` x `cells` of one metre, with a height function.
template <typename Height>
BuildObject lattice(int cells, const Height& height) {
    BuildObject ground;
    ground.kind = city::ObjectKind::kTerrain;
    ground.paints = {Paint::flat({90, 120, 60})};
    for (int y = 0; y <= cells; ++y) {
        for (int x = 0; x <= cells; ++x) ground.vertices.push_back({x * kMetre, y * kMetre, to_grid(height(x, y))});
    }
    const auto at = [cells](int x, int y) { return static_cast<uint32_t>(y * (cells + 1) + x); };
    for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
            add(ground, at(x, y), at(x + 1, y), at(x + 1, y + 1));
            add(ground, at(x, y), at(x + 1, y + 1), at(x, y + 1));
        }
    }
    return ground;
}

struct Workshop {
    city::CityCatalog catalog;
    ImageCache images{catalog, 1 << 20};
    FacadePainter facades{catalog, images, 20000};
    FacadeNumbers numbers;
};

/// A wall of 3 m x 3 m with a window recess of `depth_mm` in its middle, added to the catalog.
uint32_t add_recessed_map(city::CityCatalog& catalog, int16_t depth_mm) {
    codec::facade::RunGrid grid{{0, 100, 200, 300}, {0, 100, 200, 300}, std::vector<uint32_t>(9)};
    grid.labels[4] = codec::facade::make_label(-depth_mm, 1);
    if (catalog.palettes.empty()) {
        city::Material dark;
        dark.rgb = {20, 20, 30};
        catalog.palettes.emplace_back();
        catalog.palettes[0].material = {catalog.add_material({}), catalog.add_material(dark)};
    }
    return catalog.facade_maps.add(grid);
}

/// A facade along the x axis, `metres` wide and high.
quadtree::BuildFacade facade_of(uint32_t map, int metres) {
    quadtree::BuildFacade facade;
    facade.along = {static_cast<int32_t>(metres * kMetre), 0};
    facade.height = static_cast<uint32_t>(metres * kMetre);
    facade.map = map;
    return facade;
}

const std::vector<std::array<double, 2>> kNotched = {{0, 0},     {10, 0},    {10, 10},  {5.2, 10},
                                                     {5.2, 9.8}, {4.8, 9.8}, {4.8, 10}, {0, 10}};

TEST(Outline, TheRoofsOutlineIsTheFootprint) {
    const auto loops = roof_outlines(prism(kNotched, 5), {});
    ASSERT_EQ(loops.size(), 1U);
    EXPECT_EQ(loops[0].size(), kNotched.size());
    EXPECT_NEAR(doubled_area(loops[0]) / 2 / (kMetre * kMetre), 100 - 0.4 * 0.2, 0.01);
}

TEST(Outline, SimplifyingDropsTheNotchAndKeepsTheCorners) {
    Outline outline = roof_outlines(prism(kNotched, 5), {})[0];
    simplify_outline(outline, 0.5 * kMetre);
    EXPECT_EQ(outline.size(), 4U);
}

TEST(Outline, EarClippingCoversAConcavePolygonExactly) {
    const Outline polygon = {{0, 0}, {10, 0}, {10, 10}, {5, 3}, {0, 10}};
    const auto triangles = triangulate_outline(polygon);
    ASSERT_EQ(triangles.size(), 9U);
    double area = 0;
    for (size_t i = 0; i < triangles.size(); i += 3) {
        const double part = doubled_area({polygon[triangles[i]], polygon[triangles[i + 1]], polygon[triangles[i + 2]]});
        EXPECT_GT(part, 0);
        area += part;
    }
    EXPECT_EQ(area, doubled_area(polygon));
}

TEST(Outline, ACrossedPolygonIsRefused) {
    EXPECT_TRUE(triangulate_outline({{0, 0}, {0, 10}, {10, 10}, {10, 0}}).empty());
}

TEST(Block, StaysWithinTheErrorItStates) {
    Workshop shop;
    const BuildObject house = prism(kNotched, 5);
    const auto block = make_block(house, 1.0, shop.images, shop.facades);
    ASSERT_TRUE(block.has_value());
    EXPECT_EQ(block->triangles.size(), 10U);
    EXPECT_LE(block->error, 1.0F);
    EXPECT_GT(block->error, 0.05F);
    const auto a = surface_of(house, {}), b = surface_of(*block, {});
    EXPECT_NEAR(surface_distance(a, b, 1e9) * kMetresPerGridUnit, static_cast<double>(block->error), 1e-6);
}

TEST(Block, IsNotMadeWhereItWouldBeTooFarOff) {
    Workshop shop;
    EXPECT_FALSE(make_block(prism(kNotched, 5), 0.05, shop.images, shop.facades).has_value());
}

TEST(Block, CountsTheReliefOfTheFacadesThatItLoses) {
    Workshop shop;
    BuildObject house = prism(kNotched, 5);
    const auto plain = make_block(house, 2.0, shop.images, shop.facades);
    house.facades.push_back(facade_of(add_recessed_map(shop.catalog, 500), 5));
    const auto block = make_block(house, 2.0, shop.images, shop.facades);
    ASSERT_TRUE(plain.has_value() && block.has_value());
    EXPECT_GE(block->error, 0.5F);
    EXPECT_FALSE(make_block(house, 0.5, shop.images, shop.facades).has_value());
}

class CoarsenFacades : public testing::Test {
  protected:
    /// A house of notched outline with one facade, coarsened to an error.
    BuildObject coarse(int16_t depth_mm, double error) {
        TileContent content;
        content.objects.push_back(prism(kNotched, 5));
        content.objects[0].facades.push_back(facade_of(add_recessed_map(shop_.catalog, depth_mm), 5));
        const TileWorkshop workshop{
            shop_.catalog, shop_.images, shop_.facades, shop_.numbers, {true, true, true, false}, {}};
        CoarsenSpec spec;
        spec.side = 512 * kMetre;
        spec.error_metres = error;
        spec.triangle_limit = 1000;
        CoarseContent out = coarsen(std::move(content), spec, workshop);
        EXPECT_EQ(out.content.objects.size(), 1U);
        return out.content.objects.at(0);
    }
    static bool has_picture(const BuildObject& object) {
        return std::any_of(object.paints.begin(), object.paints.end(),
                           [](const Paint& paint) { return paint.kind == quadtree::PaintKind::kFacade; });
    }
    Workshop shop_;
};

TEST_F(CoarsenFacades, ReliefStaysWhileTwiceItsDepthIsMoreThanTheError) {
    EXPECT_EQ(coarse(400, 0.7).facades.size(), 1U);
    EXPECT_EQ(coarse(400, 0.9).facades.size(), 0U);
}

TEST_F(CoarsenFacades, AWallWhoseWindowsStillShowKeepsItsPictureInsteadOfBecomingABlock) {
    const BuildObject near = coarse(100, 0.9), far = coarse(100, 3.0);
    EXPECT_TRUE(has_picture(near));
    EXPECT_FALSE(near.block);
    EXPECT_FALSE(has_picture(far));
    EXPECT_TRUE(far.block);
}

TEST(Crowd, ABoxOfTheSameFootprintReplacesSmallThings) {
    Workshop shop;
    std::vector<BuildObject> objects;
    for (double x : {0.0, 3.0, 6.0}) objects.push_back(prism({{x, 0}, {x + 2, 0}, {x + 2, 2}, {x, 2}}, 3));
    objects.push_back(prism({{0, 0}, {30, 0}, {30, 30}, {0, 30}}, 20));
    merge_crowds(objects, 10 * kMetre, shop.images, shop.facades);
    ASSERT_EQ(objects.size(), 2U);
    const auto box = objects[1].box();
    const double area = to_metres(box.hi.x - box.lo.x) * to_metres(box.hi.y - box.lo.y);
    EXPECT_NEAR(area, 12, 0.05);
    EXPECT_NEAR(to_metres(box.hi.z - box.lo.z), 3, 0.01);
    EXPECT_GT(objects[1].error, 1.0F);
    EXPECT_LT(objects[1].error, 10.0F);
}

/// A material whose picture is half there, in stripes.
uint32_t add_stripes(city::CityCatalog& catalog, const ImageFolder& folder) {
    std::vector<uint8_t> texels;
    for (int i = 0; i < 16 * 16; ++i) texels.insert(texels.end(), {20, 160, 30, i % 8 < 4 ? uint8_t{255} : uint8_t{0}});
    catalog.images.push_back({folder.write("stripes.png", 16, 16, 4, texels)});
    city::Material stripes;
    stripes.image = static_cast<int32_t>(catalog.images.size() - 1);
    return catalog.add_material(stripes);
}

/// Two crossed upright pictures, 1 m wide and high.
BuildObject crossed_pictures(double x, double y, uint32_t material) {
    BuildObject tree;
    tree.kind = city::ObjectKind::kOther;
    tree.paints = {{quadtree::PaintKind::kMaterial, material, 0}};
    for (const auto& [dx, dy] : {std::array{0.5, 0.0}, std::array{0.0, 0.5}}) {
        const auto v = static_cast<uint32_t>(tree.vertices.size());
        for (const auto& [side, z] : {std::array{-1, 0}, std::array{1, 0}, std::array{1, 1}, std::array{-1, 1}})
            tree.vertices.push_back({to_grid(x + side * dx), to_grid(y + side * dy), z * kMetre});
        add(tree, v, v + 1, v + 2);
        add(tree, v, v + 2, v + 3);
    }
    return tree;
}

double upright_area(const BuildObject& object) {
    double area = 0;
    for (const BuildTriangle& t : object.triangles) {
        const auto n = quadtree::triangle_normal(object.vertices[t.vertex[0]], object.vertices[t.vertex[1]],
                                                 object.vertices[t.vertex[2]]);
        area += std::hypot(n[0], n[1]) / 2 / (kMetre * kMetre);
    }
    return area;
}

TEST(Crowd, WhatIsCutOutBecomesFewerOfItsOwnFacesThatCoverAsMuch) {
    const ImageFolder folder;
    Workshop shop;
    const uint32_t stripes = add_stripes(shop.catalog, folder);
    std::vector<BuildObject> objects;
    for (int i = 0; i < 4; ++i) objects.push_back(crossed_pictures(1 + 2 * i, 1, stripes));
    ASSERT_TRUE(see_through(objects[0], shop.images));
    merge_crowds(objects, 10 * kMetre, shop.images, shop.facades);
    ASSERT_EQ(objects.size(), 1U);
    EXPECT_EQ(objects[0].triangles.size(), 4U);
    for (const Paint& paint : objects[0].paints) EXPECT_EQ(paint.kind, quadtree::PaintKind::kMaterial);
    const auto box = objects[0].box();
    EXPECT_EQ(box.lo.z, 0);
    EXPECT_EQ(box.hi.z, kMetre) << "no higher than they were";
    EXPECT_GT(upright_area(objects[0]), 2.5) << "two of eight square metres would be left without enlarging";
    EXPECT_GT(objects[0].error, 0.0F);
}

TEST(Crowd, SolidThingsBesideCutOutOnesStillBecomeABoxOfTheirOwn) {
    const ImageFolder folder;
    Workshop shop;
    const uint32_t stripes = add_stripes(shop.catalog, folder);
    std::vector<BuildObject> objects;
    for (double x : {1.0, 5.0}) {
        objects.push_back(crossed_pictures(x, 1, stripes));
        objects.push_back(prism({{x, 3}, {x + 2, 3}, {x + 2, 5}, {x, 5}}, 3));
    }
    EXPECT_FALSE(see_through(objects[1], shop.images));
    merge_crowds(objects, 10 * kMetre, shop.images, shop.facades);
    ASSERT_EQ(objects.size(), 2U);
    EXPECT_EQ(objects[0].triangles.size(), 10U);
    EXPECT_FALSE(see_through(objects[0], shop.images));
    EXPECT_TRUE(see_through(objects[1], shop.images));
}

TEST(ThinFaces, StatesTheDistanceMeasuredAndMakesNothingWhereThatIsTooFar) {
    const ImageFolder folder;
    Workshop shop;
    const uint32_t stripes = add_stripes(shop.catalog, folder);
    BuildObject bush = crossed_pictures(0, 0, stripes);
    for (int i = 1; i < 6; ++i) {
        const BuildObject more = crossed_pictures(0.8 * i, 0.5 * i, stripes);
        const auto base = static_cast<uint32_t>(bush.vertices.size());
        bush.vertices.insert(bush.vertices.end(), more.vertices.begin(), more.vertices.end());
        for (const BuildTriangle& t : more.triangles)
            add(bush, t.vertex[0] + base, t.vertex[1] + base, t.vertex[2] + base);
    }
    const auto thin = thin_faces(bush, 4, shop.images);
    ASSERT_TRUE(thin.has_value());
    EXPECT_LT(thin->triangles.size(), bush.triangles.size());
    EXPECT_NEAR(surface_distance(surface_of(bush, {}), surface_of(*thin, {}), 1e9) * kMetresPerGridUnit,
                static_cast<double>(thin->error), 1e-6);
    EXPECT_FALSE(thin_faces(bush, 0.01, shop.images).has_value());
}

TEST(Decimate, AFlatLatticeKeepsItsBorderAndLosesItsInside) {
    BuildObject ground = lattice(16, [](int, int) { return 0.0; });
    decimate(ground, 0.1);
    EXPECT_LE(ground.triangles.size(), 16U * 4 + 4);
    std::set<std::pair<int64_t, int64_t>> border;
    for (const GridPoint& p : ground.vertices) {
        if (p.x == 0 || p.y == 0 || p.x == 16 * kMetre || p.y == 16 * kMetre) border.insert({p.x, p.y});
    }
    EXPECT_EQ(border.size(), 64U);
    EXPECT_LT(ground.error, 1e-9F);
}

TEST(Decimate, TheStatedErrorHoldsOnAHill) {
    const auto hill = [](int x, int y) { return 2 * std::sin(x * 0.4) * std::cos(y * 0.3); };
    const BuildObject before = lattice(20, hill);
    BuildObject after = before;
    decimate(after, 0.25);
    EXPECT_LT(after.triangles.size(), before.triangles.size());
    EXPECT_GT(after.error, 0.0F);
    const auto fine = surface_of(before, {}), coarse = surface_of(after, {});
    double worst = 0;
    for (const Triangle3& t : fine) {
        for (const Point3& p : t) {
            double nearest = 1e300;
            for (const Triangle3& c : coarse) nearest = std::min(nearest, squared_distance(p, c));
            worst = std::max(worst, std::sqrt(nearest));
        }
    }
    EXPECT_LE(worst * kMetresPerGridUnit, static_cast<double>(after.error) + 1e-6);
}

TEST(Decimate, LeavesThreeFacesAtOneEdgeAlone) {
    BuildObject fan;
    fan.paints = {Paint::flat({1, 2, 3})};
    fan.vertices = {{0, 0, 0}, {1024, 0, 0}, {0, 1024, 0}, {0, 0, 1024}, {0, -1024, 0}};
    add(fan, 0, 1, 2);
    add(fan, 0, 1, 3);
    add(fan, 0, 1, 4);
    decimate(fan, 0.5);
    EXPECT_EQ(fan.triangles.size(), 3U);
}

TEST(Ground, BecomesAPictureOfItselfWhenItHasTooManyTriangles) {
    Workshop shop;
    std::vector<BuildObject> ground = {lattice(60, [](int x, int y) { return (x * 7 + y * 13) % 3 * 1.0; })};
    std::vector<ChartImage> pictures;
    coarsen_ground(ground, pictures, {{}, 64 * kMetre, 0.1, 100}, shop.images);
    ASSERT_EQ(ground.size(), 1U);
    ASSERT_EQ(pictures.size(), 1U);
    EXPECT_EQ(pictures[0].rgb[0], 90);
    const auto box = ground[0].box();
    EXPECT_EQ(box.hi.x, 60 * kMetre);
    EXPECT_EQ(box.hi.y, 60 * kMetre);
}

TEST(Skirts, HangFromEveryBorderEdgeAndLookOutwards) {
    const std::vector<BuildObject> ground = {lattice(4, [](int, int) { return 1.0; })};
    const auto skirts = make_skirts(ground, {0, 0, 0}, 4 * kMetre, 2 * kMetre);
    ASSERT_EQ(skirts.size(), 16U);
    for (const SkirtQuad& skirt : skirts) {
        const auto n = unit_normal(skirt.corners[0], skirt.corners[1], skirt.corners[2]);
        const double x = to_metres(skirt.corners[0].x + skirt.corners[1].x) / 2 - 2,
                     y = to_metres(skirt.corners[0].y + skirt.corners[1].y) / 2 - 2;
        EXPECT_GT(static_cast<double>(n[0]) * x + static_cast<double>(n[1]) * y, 0);
        EXPECT_EQ(skirt.corners[3].z - skirt.corners[0].z, 2 * kMetre);
        EXPECT_EQ(skirt.normal[2], 1.0F);
    }
}

TEST(HiddenFaces, TheFloorGoesAndTheRoofStays) {
    BuildObject house = prism({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, 3);
    add(house, 0, 4, 2);
    add(house, 0, 6, 4);
    drop_hidden_faces(house);
    EXPECT_EQ(house.triangles.size(), 10U);
}

TEST(CutAtCells, ThePartsHaveTheAreaOfTheWholeAndMeetInThePointsOfBothSides) {
    BuildObject ground;
    ground.kind = city::ObjectKind::kTerrain;
    ground.paints = {Paint::flat({1, 2, 3})};
    ground.vertices = {{-5000, 3000, 0}, {150000, 20000, 5000}, {40000, 170001, 900}};
    add(ground, 0, 1, 2);
    const auto area = [](const BuildObject& object) {
        double sum = 0;
        for (const BuildTriangle& t : object.triangles)
            sum += quadtree::triangle_normal(object.vertices[t.vertex[0]], object.vertices[t.vertex[1]],
                                             object.vertices[t.vertex[2]])[2];
        return sum;
    };
    const auto parts = quadtree::cut_at_cells(ground);
    EXPECT_GT(parts.size(), 5U);
    double sum = 0;
    std::map<std::array<int64_t, 3>, int> on_line;
    for (const BuildObject& part : parts) {
        sum += area(part);
        std::set<std::array<int64_t, 3>> own;
        for (const GridPoint& p : part.vertices) {
            if (p.x == 65536 && p.y % 65536 != 0) own.insert({p.x, p.y, p.z});
        }
        for (const auto& p : own) ++on_line[p];
    }
    EXPECT_NEAR(sum / area(ground), 1, 1e-4);
    EXPECT_FALSE(on_line.empty());
    for (const auto& [p, count] : on_line) EXPECT_EQ(count, 2);
}

TEST(Relief, AWindowRecessHasAFrontABackAndFourSidesOfTheRightWinding) {
    codec::facade::RunGrid map{{0, 10, 20, 30}, {0, 10, 20, 30}, std::vector<uint32_t>(9)};
    map.labels[4] = codec::facade::make_label(-100, 3);
    const auto relief = make_relief(map);
    ASSERT_EQ(relief.size(), 2U);
    EXPECT_EQ(relief.at(3).indices.size(), 6U);
    double front = 0;
    for (const auto& [slot, part] : relief) {
        for (size_t i = 0; i < part.indices.size(); i += 3) {
            const auto& a = part.positions[part.indices[i]];
            const auto& b = part.positions[part.indices[i + 1]];
            const auto& c = part.positions[part.indices[i + 2]];
            const auto& n = part.normals[part.indices[i]];
            const std::array<float, 3> u = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                                       v = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
            const std::array<float, 3> w = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                            u[0] * v[1] - u[1] * v[0]};
            EXPECT_GT(w[0] * n[0] + w[1] * n[1] + w[2] * n[2], 0.0F);
            if (n[2] > 0.5F) front += static_cast<double>(w[2]) / 2;
        }
    }
    EXPECT_NEAR(front, 0.09, 1e-6);
}

TEST(StandIns, ShowPicturesOnlyWhereFlatFacadesCanBeSeen) {
    Workshop shop;
    TileContent content;
    content.objects.emplace_back();
    content.objects[0].kind = city::ObjectKind::kBuilding;
    content.objects[0].facades.push_back(facade_of(add_recessed_map(shop.catalog, 300), 3));
    shop.numbers.shown = shop.numbers.number = shop.numbers.maps = {0};
    const auto atlas_bytes = [&](double parent_error, bool relief) {
        const TileWorkshop workshop{
            shop.catalog, shop.images, shop.facades, shop.numbers, {true, relief, true, false}, {}};
        TileSpec spec;
        spec.side = 64 * kMetre;
        spec.parent_error = parent_error;
        const EncodedTile tile = encode_tile(spec, content, workshop);
        EXPECT_EQ(tile.record.steps(tileset::Layer::kFacade).size(), relief ? 1U : 0U);
        uint64_t bytes = 0;
        for (const tileset::StepRecord& step : tile.record.steps(tileset::Layer::kAtlas)) bytes += step.decoded_bytes;
        return bytes;
    };
    // Relief 0.3 m deep has an error of 0.6 m when it is flat.
    const uint64_t picture = atlas_bytes(0.7, true), colour = atlas_bytes(0.5, true);
    EXPECT_LT(colour, picture);
    EXPECT_GT(atlas_bytes(0.5, false), picture) << "without relief windows are only in the picture";
    EXPECT_EQ(atlas_bytes(std::numeric_limits<double>::infinity(), true), picture);
}

TEST(Relief, AnOpenCellHasNoFrontAndItsNeighboursReachDownToTheLeastDepth) {
    codec::facade::RunGrid map{{0, 10, 20}, {0, 10}, {codec::facade::make_label(50, 2), 0}};
    map.labels[1] = codec::facade::make_label(codec::facade::kOpenDisplacement, 0);
    const auto relief = make_relief(map);
    ASSERT_EQ(relief.size(), 1U);
    const ReliefPart& part = relief.at(2);
    double front = 0;
    for (size_t i = 0; i < part.positions.size(); ++i) {
        EXPECT_FLOAT_EQ(part.positions[i][2], 0.05F);  // the least depth is the only one: no sides
        EXPECT_LE(part.positions[i][0], 0.1F);
    }
    for (size_t i = 0; i < part.indices.size(); i += 3) front += 0.005;
    EXPECT_NEAR(front, 0.01, 1e-9);
    map.labels.push_back(0);
    map.labels.push_back(codec::facade::make_label(-30, 0));
    map.y_breaks.push_back(20);
    double lowest = 1;
    for (const auto& [slot, own] : make_relief(map)) {
        for (const auto& position : own.positions) lowest = std::min(lowest, static_cast<double>(position[2]));
    }
    EXPECT_NEAR(lowest, -0.03, 1e-6);
}

}  // namespace
}  // namespace citystream::tiles::layers
