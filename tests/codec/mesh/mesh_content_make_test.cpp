#include "codec/mesh/mesh_content_make.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "codec/grid.h"
#include "codec/mesh/mesh_triangles.h"
#include "codec/mesh/position_error.h"
#include "tests/codec/mesh/mesh_tiles.h"
#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {
namespace {

constexpr uint32_t kHouses = 40;

/// Houses that stand apart, some turned, some with floors or courtyards.
GridMesh prism_town() {
    std::vector<Prism> houses;
    for (uint32_t i = 0; i < kHouses; ++i) {
        const int32_t x = 1000 + static_cast<int32_t>(i % 8) * 60'000, y = 1000 + static_cast<int32_t>(i / 8) * 60'000;
        const int32_t top = 9000 + 512 * static_cast<int32_t>(i);
        std::vector<Ring> rings = {turned_footprint(x, y, 20'000, 15'000, 0.1 * (i % 4), i % 3)};
        if (i % 7 == 0) rings = {rectangle(x, y, 20'000, 15'000), courtyard(x + 4000, y + 4000, 8000, 6000)};
        houses.push_back(make_prism(std::move(rings), -300, top, i % 5 == 0));
    }
    return join({std::move(houses), {}});
}

/// A tile of one triangle.
MeshTile one_triangle(const std::array<GridPoint, 3>& places) {
    return flat_tile({{places[0], places[1], places[2]}, {{0, 1, 2}}});
}

MeshContentOptions one_step(uint32_t normal_bits = 8) {
    MeshContentOptions options;
    options.most_steps = 1;
    options.normal_bits = normal_bits;
    return options;
}

void expect_sound(const MeshContent& content) {
    ASSERT_FALSE(content.dropped.empty());
    EXPECT_LE(content.dropped.size(), kMostMeshSteps);
    EXPECT_LE(content.dropped.front(), kMeshGridBits);
    for (size_t s = 1; s < content.dropped.size(); ++s)
        EXPECT_EQ(content.dropped[s - 1], content.dropped[s] + kMeshStepBits);
    const std::set<GridPoint> places(content.points.begin(), content.points.end());
    EXPECT_EQ(places.size(), content.points.size()) << "points that are not welded";
    const int32_t unknown = (1 << content.dropped.back()) - 1;
    for (const GridPoint& point : content.points) {
        for (const int32_t c : point) EXPECT_EQ(0, c & unknown);
    }
    std::vector<bool> used(content.points.size());
    for (const MeshTriangle& triangle : content.triangles) {
        for (const MeshCorner& corner : triangle.corners) {
            ASSERT_LT(corner.point, content.points.size());
            used[corner.point] = true;
            EXPECT_LT(corner.normal, 1u << 2 * content.normal_bits);
            if (names_colour(triangle.chart_word)) {
                EXPECT_EQ((std::array<int32_t, 2>{0, 0}), corner.texcoord);
            }
        }
    }
    EXPECT_EQ(used.end(), std::find(used.begin(), used.end(), false)) << "points without triangles";
    for (const MeshPrism& prism : content.prisms) {
        EXPECT_LT(prism.shape.base, prism.shape.top);
        EXPECT_TRUE(names_colour(prism.wall_chart));
        EXPECT_TRUE(names_colour(prism.top_chart));
        EXPECT_EQ(prism.shape.has_floor, names_colour(prism.floor_chart));
        EXPECT_EQ(prism.shape.has_floor, prism.floor_chart != 0);
        for (const PrismWall& wall : prism.shape.walls) {
            const uint32_t dropped = content.dropped.front();
            EXPECT_EQ(wall.base == prism.shape.base, wall.base >> dropped == prism.shape.base >> dropped);
        }
    }
}

TEST(MeshContentMake, KeepsEveryTriangleOfAwkwardMeshesAtFullPrecision) {
    for (MeshCase& c : awkward_meshes()) {
        SCOPED_TRACE(c.name);
        for (GridPoint& point : c.mesh.points) {
            for (int32_t& part : point) part = std::clamp(part, -(1 << 28), 1 << 28);
        }
        MeshTile tile = flat_tile(c.mesh);
        for (const bool dressed : {false, true}) {
            if (dressed) dress_up(tile, 3);
            const MeshContent content = make_content(tile);
            expect_sound(content);
            MeshTile back = to_tile(content), asked = tile;
            EXPECT_EQ(tile.triangle_chart.size(), triangle_count(content));
            // Normals and texture coordinates have tests of their own.
            for (MeshTile* t : {&back, &asked}) {
                for (MeshVertex& v : t->vertices) v = {{v.position[0], v.position[1], v.position[2]}, {0, 0, 1}, {}};
            }
            EXPECT_EQ(triangle_facts(asked, 8), triangle_facts(back, 8));
        }
    }
}

TEST(MeshContentMake, KeepsAllAttributesOfATileThatFitsTheirBits) {
    MeshTile tile = flat_tile(town_mesh(5, 3));
    dress_up(tile, 4);
    for (MeshVertex& vertex : tile.vertices) {
        for (int32_t& part : vertex.texcoord) part = part & 0xffff;
    }
    for (uint32_t t = 0; t < tile.triangle_chart.size(); ++t) {
        if (!names_colour(tile.triangle_chart[t])) continue;
        for (size_t k = 0; k < 3; ++k)
            for (int32_t& part : tile.vertices[tile.indices[3 * size_t{t} + k]].texcoord) part = 0;
    }
    const MeshContent content = make_content(tile, one_step(12));
    expect_sound(content);
    EXPECT_EQ(triangle_facts(tile, 12), triangle_facts(to_tile(content), 12));
}

TEST(MeshContentMake, TakesAllOfATownOfPrismsOutOfTheSurface) {
    const MeshTile tile = flat_tile(prism_town());
    const MeshContent content = make_content(tile);
    EXPECT_EQ(kHouses, content.prisms.size());
    EXPECT_TRUE(content.triangles.empty());
    EXPECT_TRUE(content.points.empty());
    for (const MeshPrism& prism : content.prisms) {
        EXPECT_EQ(kWallColour, prism.wall_chart);
        EXPECT_EQ(kRoofColour, prism.top_chart);
    }
    EXPECT_EQ(triangle_facts(tile, 8), triangle_facts(to_tile(content), 8));
}

TEST(MeshContentMake, PrismsOfSeveralColoursPicturesOrBentNormalsStayInTheSurface) {
    const GridMesh mesh = join({{make_prism({rectangle(0, 0, 5000, 3000)}, 0, 9000)}, {}});
    const MeshTile plain = flat_tile(mesh);
    ASSERT_EQ(1u, make_content(plain).prisms.size());
    const auto wall =
        static_cast<uint32_t>(std::find(plain.triangle_chart.begin(), plain.triangle_chart.end(), kWallColour) -
                              plain.triangle_chart.begin());

    MeshTile coloured = plain, pictured = plain, bent = plain, dressed = plain;
    coloured.triangle_chart[wall] = colour_word({1, 2, 3});
    for (uint32_t& chart : pictured.triangle_chart) chart = 5;
    for (MeshVertex& vertex : bent.vertices) vertex.normal[2] += 0.5f;
    dressed.dressed_begin = 0;
    for (const MeshTile& tile : {coloured, pictured, bent, dressed}) {
        const MeshContent content = make_content(tile, one_step());
        EXPECT_TRUE(content.prisms.empty());
        EXPECT_EQ(triangle_facts(tile, 8), triangle_facts(to_tile(content), 8));
    }
}

TEST(MeshContentMake, PrismsWithWallsWhoseBasesTheFirstStepCannotTellStayInTheSurface) {
    for (const int32_t base : {8, 800}) {
        Prism house = make_prism({rectangle(0, 0, 5000, 3000)}, 0, 9000);
        house.walls[0].base = base;
        const MeshTile tile = flat_tile(join({{house}, {}}));
        const MeshContent content = make_content(tile);
        ASSERT_EQ(6u, content.dropped.front());
        expect_sound(content);
        EXPECT_EQ(base == 800 ? 1u : 0u, content.prisms.size());
        EXPECT_EQ(triangle_facts(tile, 8), triangle_facts(to_tile(content), 8));
    }
}

TEST(MeshContentMake, PrismsKeepTheirColoursWhereHousesShareAWall) {
    GridMesh mesh = join({{make_prism({rectangle(0, 0, 5000, 3000)}, 0, 9000)}, {}});
    const MeshTile first = flat_tile(mesh);
    MeshTile both = first, second = first;
    for (uint32_t& chart : second.triangle_chart) chart = colour_word({9, 9, 9});
    // The same house twice at one place: each triangle is there in two colours.
    for (uint32_t i = 0; i < second.indices.size(); ++i) both.indices.push_back(second.indices[i]);
    both.triangle_chart.insert(both.triangle_chart.end(), second.triangle_chart.begin(), second.triangle_chart.end());
    both.dressed_begin = static_cast<uint32_t>(both.triangle_chart.size());
    const MeshContent content = make_content(both);
    EXPECT_EQ(triangle_facts(both, 8), triangle_facts(to_tile(content), 8));
}

TEST(MeshContentMake, EachStepShowsPlacesWithinItsErrorAndMultiplesExactly) {
    MeshTile tile = flat_tile(soup_mesh(400, 900, 1 << 20, 5));
    for (uint32_t v = 0; v < tile.vertices.size(); v += 7) {
        for (int32_t& part : tile.vertices[v].position) part = part >> kMeshGridBits << kMeshGridBits;
    }
    for (const float error : {0.0f, 0.3f, 40.0f}) {
        const MeshContent content = make_content(tile, {.finest_error_metres = error, .most_steps = 4});
        EXPECT_EQ(finest_dropped(error), content.dropped.back());
        ASSERT_TRUE(content.prisms.empty());
        ASSERT_EQ(tile.triangle_chart.size(), content.triangles.size());
        for (uint32_t steps = 1; steps <= content.dropped.size(); ++steps) {
            const double most = position_error(content.dropped[steps - 1]) * kGridUnitsPerMetre;
            size_t vertex = 0;
            double worst = 0;
            for_each_triangle(content, steps, [&](const PlacedTriangle& triangle) {
                for (const GridPoint& shown : triangle.places) {
                    const auto& p = tile.vertices[tile.indices[vertex]].position;
                    if (tile.indices[vertex++] % 7 == 0) {
                        EXPECT_EQ((GridPoint{p[0], p[1], p[2]}), shown);
                    }
                    worst = std::max(worst, std::hypot(shown[0] - p[0], shown[1] - p[1], shown[2] - p[2]));
                }
            });
            EXPECT_LE(worst, most + 1e-9);
            EXPECT_GE(worst, most / 2);
        }
    }
}

TEST(MeshContentMake, ChoosesStepsByErrorExtentAndLimits) {
    const auto dropped = [](int32_t extent, MeshContentOptions options) {
        return make_content(one_triangle({{{0, 0, 0}, {extent, 0, 0}, {0, extent, 0}}}), options).dropped;
    };
    using Bits = std::vector<uint32_t>;
    EXPECT_EQ((Bits{6, 3, 0}), dropped(100'000, {}));
    EXPECT_EQ((Bits{9, 6, 3, 0}), dropped(100'000, {.most_steps = 4}));
    EXPECT_EQ((Bits{12, 9, 6}), dropped(100'000, {.finest_error_metres = 0.5f}));
    EXPECT_EQ((Bits{0}), dropped(100'000, {.most_steps = 1}));
    EXPECT_EQ((Bits{3, 0}), dropped(100'000, {.most_dropped = 5}));
    EXPECT_EQ((Bits{2}), dropped(100'000, {.finest_error_metres = 100, .most_dropped = 2}));
    EXPECT_EQ((Bits{3, 0}), dropped(40, {}));
    EXPECT_EQ((Bits{0}), dropped(0, {}));
    EXPECT_EQ((Bits{0}), make_content({}).dropped);
    EXPECT_EQ((Bits{16}), dropped(1 << 28, {.finest_error_metres = std::numeric_limits<float>::infinity()}));
}

TEST(MeshContentMake, TrianglesThatTheCutFoldsAreLeftOutAndNoOthers) {
    const MeshContent content =
        make_content(one_triangle({{{0, 0, 0}, {1, 1, 0}, {5000, 3, 0}}}), {.finest_error_metres = 0.5f});
    ASSERT_EQ(6u, content.dropped.back());
    EXPECT_TRUE(content.points.empty());
    EXPECT_TRUE(content.triangles.empty()) << "a triangle that no step can show";
    const MeshContent line = make_content(one_triangle({{{0, 0, 0}, {0, 0, 0}, {5000, 3, 0}}}));
    EXPECT_EQ(2u, line.points.size());
    EXPECT_EQ(1u, line.triangles.size()) << "the cut did not do it";
}

TEST(MeshContentMake, FlatTrianglesGetTheCodeOfTheirPlaneWhereItIsNear) {
    const std::array<GridPoint, 3> places = {{{0, 0, 0}, {40'000, 7'000, 0}, {0, 9'000, 31'000}}};
    const Direction plane = plane_normal(places);
    for (const uint32_t bits : {8u, 10u, 16u}) {
        const auto code = static_cast<uint32_t>(canonical_octahedral(pack_octahedral(plane, bits), bits));
        const double step = std::sqrt(2.0) / octahedral_side(bits);
        for (const double turn : {0.0, 0.3, 0.6, 3.0}) {
            MeshTile tile = one_triangle(places);
            const Direction given =
                unit_direction({plane[0] + turn * step * plane[1], plane[1] - turn * step * plane[0], plane[2]});
            for (MeshVertex& vertex : tile.vertices)
                for (size_t c = 0; c < 3; ++c) vertex.normal[c] = static_cast<float>(given[c]);
            const MeshContent content = make_content(tile, one_step(bits));
            const uint32_t got = content.triangles.at(0).corners[0].normal;
            const double error = angle_between(unpack_octahedral(got, bits), given);
            EXPECT_LE(error, step * 1.001) << bits << " bits";
            if (turn == 0) {
                EXPECT_EQ(code, got);
            }
            if (turn == 3.0) {
                EXPECT_NE(code, got);
            }
        }
        // The other way round is another normal.
        MeshTile turned = one_triangle(places);
        for (MeshVertex& vertex : turned.vertices)
            for (float& part : vertex.normal) part = -part;
        EXPECT_NE(code, make_content(turned, one_step(bits)).triangles.at(0).corners[0].normal);
    }
}

TEST(MeshContentMake, NormalsOfStepsFollowThePlaneOfTheFirstStepWhereThatIsNear) {
    std::mt19937 random(11);
    uint32_t of_first = 0;
    constexpr uint32_t kTriangles = 500;
    for (uint32_t i = 0; i < kTriangles; ++i) {
        std::array<GridPoint, 3> places;
        for (GridPoint& place : places)
            for (int32_t& c : place) c = static_cast<int32_t>(random() % 60'000);
        const MeshTile tile = one_triangle(places);
        const MeshContent content = make_content(tile);
        const MeshTriangle& triangle = content.triangles.at(0);
        std::array<GridPoint, 3> first;
        for (size_t k = 0; k < 3; ++k) {
            first[k] = content.points[triangle.corners[k].point];
            for (int32_t& c : first[k]) c = c >> content.dropped[0] << content.dropped[0];
        }
        const auto code = canonical_octahedral(pack_octahedral(plane_normal(first), 8), 8);
        of_first += code == triangle.corners[0].normal ? 1 : 0;
        EXPECT_LE(angle_between(unpack_octahedral(triangle.corners[0].normal, 8), plane_normal(places)),
                  1.001 * std::sqrt(2.0) / octahedral_side(8));
    }
    EXPECT_GE(of_first, kTriangles * 98 / 100);
}

TEST(MeshContentMake, TextureCoordinatesOfAChartSpanSixteenBits) {
    MeshTile tile = flat_tile(soup_mesh(200, 400, 1 << 12, 9));
    std::mt19937 random(4);
    for (uint32_t t = 0; t < 400; ++t) {
        tile.triangle_chart[t] = t % 3;
        for (size_t k = 0; k < 3; ++k) {
            auto& texcoord = tile.vertices[tile.indices[3 * size_t{t} + k]].texcoord;
            texcoord[0] = static_cast<int32_t>(random());
            texcoord[1] = static_cast<int32_t>(random() % (t % 3 == 1 ? 0x10000 : 0x50000)) - 0x8000;
        }
    }
    const MeshContent content = make_content(tile, one_step());
    std::map<std::pair<uint32_t, size_t>, std::array<int64_t, 2>> ranges;
    size_t corner = 0;
    for (const MeshTriangle& triangle : content.triangles) {
        for (const MeshCorner& c : triangle.corners) {
            const auto& given = tile.vertices[tile.indices[corner++]].texcoord;
            for (size_t axis = 0; axis < 2; ++axis) {
                const int64_t at = c.texcoord[axis];
                auto& range = ranges.try_emplace({triangle.chart_word, axis}, std::array{at, at}).first->second;
                range = {std::min(range[0], at), std::max(range[1], at)};
                const int64_t most = axis == 0 ? 1 << 16 : triangle.chart_word == 1 ? 0 : 7;
                EXPECT_LE(std::abs(at - given[axis]), most);
            }
        }
    }
    for (const auto& [key, range] : ranges) {
        const auto span = static_cast<uint64_t>(range[1] - range[0]);
        const auto bits = static_cast<uint32_t>(std::bit_width(span));
        const uint32_t shift = bits > 16 ? bits - 16 : 0;
        for (const MeshTriangle& triangle : content.triangles) {
            if (triangle.chart_word != key.first) continue;
            for (const MeshCorner& c : triangle.corners)
                EXPECT_EQ(0u, static_cast<uint64_t>(c.texcoord[key.second] - range[0]) % (uint64_t{1} << shift));
        }
    }
}

TEST(MeshContentMake, ConstraintsKeepBitsWherePicturesAreFine) {
    MeshTile tile = flat_tile(prism_town());
    // A pictured wall of 50 by 10 m with 1,024 texels a repeat, twice: once with the repeat over all of it.
    for (int i = 0; i < 2; ++i) {
        const int32_t y = (i + 2) * 300'000;
        const std::array<GridPoint, 3> places = {{{1000, y, 7}, {51'200, y, 7}, {1000, y, 10'240}}};
        const MeshTile wall = one_triangle(places);
        for (size_t k = 0; k < 3; ++k) {
            MeshVertex vertex = wall.vertices[k];
            vertex.texcoord[0] = k == 1 ? (i == 0 ? 1 << 16 : 1 << 20) : 0;
            vertex.texcoord[1] = k == 2 ? 1 << 16 : 0;
            tile.indices.push_back(static_cast<uint32_t>(tile.vertices.size()));
            tile.vertices.push_back(vertex);
        }
        tile.triangle_chart.push_back(0);
    }
    tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
    MeshConstraint constraint;
    constraint.chart_size = [](uint32_t) { return std::array<uint32_t, 2>{1024, 512}; };
    const MeshContent content = make_content(tile, {.constraint = constraint});
    expect_sound(content);
    EXPECT_EQ(kHouses, content.prisms.size());
    ASSERT_EQ(6u, content.points.size());
    ASSERT_EQ(6u, content.most_dropped.size());
    // The finer axis of the first: 10 m for 1,024 texels, half a texel is 5 units. Of the second: 16 * 1,024 over 49 m,
    // half a texel is 1.5 units.
    for (size_t p = 0; p < 3; ++p) EXPECT_EQ(2u, content.most_dropped[p]);
    for (size_t p = 3; p < 6; ++p) EXPECT_EQ(0u, content.most_dropped[p]);

    // What is shown keeps to it.
    const MeshTile shown = to_tile(content, 1);
    const auto first = static_cast<size_t>(tile.vertices.size() - 3);
    for (size_t v = first; v < tile.vertices.size(); ++v) {
        for (size_t c = 0; c < 3; ++c) EXPECT_EQ(tile.vertices[v].position[c], shown.vertices[v].position[c]);
    }
}

TEST(MeshContentMake, ConstraintsLeaveBordersFreeAndPrismsTogether) {
    // A pictured triangle on a corner of a house: the house stays in the surface, so that both show the corner alike.
    MeshTile tile = flat_tile(join({{make_prism({rectangle(500, 500, 5000, 3000)}, 0, 9000)}, {}}));
    const auto add = [&](const std::array<GridPoint, 3>& places) {
        const MeshTile more = one_triangle(places);
        for (size_t k = 0; k < 3; ++k) {
            MeshVertex vertex = more.vertices[k];
            vertex.texcoord[0] = k == 1 ? 1 << 16 : 0;
            vertex.texcoord[1] = k == 2 ? 1 << 16 : 0;
            tile.indices.push_back(static_cast<uint32_t>(tile.vertices.size()));
            tile.vertices.push_back(vertex);
        }
        tile.triangle_chart.push_back(0);
        tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
    };
    add({{{500, 500, 9000}, {1000, 700, 9000}, {700, 1000, 9500}}});
    MeshConstraint constraint;
    constraint.chart_size = [](uint32_t) { return std::array<uint32_t, 2>{1024, 1024}; };
    constraint.tile_side = 1 << 16;
    const MeshContent together = make_content(tile, {.constraint = constraint});
    EXPECT_TRUE(together.prisms.empty());
    EXPECT_FALSE(together.most_dropped.empty());

    // On the tile's border neighbours do not know of the picture.
    MeshTile border;
    std::swap(border, tile);
    add({{{0, 500, 9000}, {0, 700, 9000}, {1 << 16, 1000, 9500}}});
    EXPECT_TRUE(make_content(tile, {.constraint = constraint}).most_dropped.empty());
    constraint.tile_side = 1 << 17;
    EXPECT_FALSE(make_content(tile, {.constraint = constraint}).most_dropped.empty());
}

TEST(MeshContentMake, IsTheSameEveryTime) {
    MeshTile tile = flat_tile(town_mesh(6, 2));
    dress_up(tile, 3);
    const MeshContent a = make_content(tile), b = make_content(tile);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.triangles, b.triangles);
    ASSERT_EQ(a.prisms.size(), b.prisms.size());
}

}  // namespace
}  // namespace citystream::codec::mesh
