#include "codec/mesh/mesh_resident.h"

#include <gtest/gtest.h>

#include "tests/codec/mesh/resident_contents.h"

namespace citystream::codec::mesh {
namespace {

constexpr uint32_t kCharts = 5;
const PositionView kNear = near_view();

std::vector<std::pair<std::string, MeshContent>> contents() {
    std::vector<std::pair<std::string, MeshContent>> list;
    uint32_t seed = 1;
    for (const MeshTopology topology : {MeshTopology::kIndices, MeshTopology::kLocalStrips, MeshTopology::kStripCode}) {
        for (const bool textured : {false, true}) {
            for (const bool smooth : {false, true}) {
                ContentKind kind{.textured = textured, .smooth = smooth, .topology = topology};
                const std::string name = std::to_string(static_cast<int>(topology)) + (textured ? " textured" : "") +
                                         (smooth ? " smooth" : "");
                list.emplace_back("terrain " + name, random_content(terrain_mesh(40), kind, seed++));
                kind.constrained = true;
                list.emplace_back("constrained " + name, random_content(town_mesh(7, seed), kind, seed));
                ++seed;
            }
        }
        list.emplace_back("soup", random_content(soup_mesh(60, 300, 100000, seed), {.topology = topology}, seed));
        ++seed;
    }
    list.emplace_back("prisms alone", random_content({}, {}, seed));
    list.emplace_back("nothing", MeshContent{});
    return list;
}

ResidentMeshView view_of(const std::vector<uint32_t>& words) {
    Result<ResidentMeshView> view = ResidentMeshView::create(words, kCharts);
    EXPECT_TRUE(view.ok()) << view.error().text();
    return std::move(*view);
}

TEST(MeshResident, EveryTriangleComesBackWithAllThatIsDrawnOfIt) {
    for (const auto& [name, content] : contents()) {
        SCOPED_TRACE(name);
        ASSERT_TRUE(check_charts(content, kCharts).ok());
        const ResidentMesh mesh = make_resident(content);
        const std::vector<uint32_t> words = mesh.with_steps(static_cast<uint32_t>(content.dropped.size()));
        const ResidentMeshView view = view_of(words);
        EXPECT_EQ(view.ranges(), mesh.ranges);
        EXPECT_EQ(view.position_begin(), mesh.words.size());
        EXPECT_TRUE(drawn_of(view, kNear) == drawn_of(content));
    }
}

TEST(MeshResident, WordsBeforeThePositionsDoNotDependOnTheStepsThatAreKnown) {
    for (const auto& [name, content] : contents()) {
        SCOPED_TRACE(name);
        const ResidentMesh all = make_resident(content);
        for (uint32_t steps = 1; steps <= content.dropped.size(); ++steps) {
            const ResidentMesh known = make_resident(with_first_steps(content, steps));
            EXPECT_EQ(known.words, all.words);
            EXPECT_EQ(known.shape, all.shape);
            EXPECT_EQ(known.with_steps(steps), all.with_steps(steps));
        }
    }
}

TEST(MeshResident, PlanesTakeALayerFromStepToStepAndCountAsSaid) {
    for (const auto& [name, content] : contents()) {
        SCOPED_TRACE(name);
        const ResidentMesh mesh = make_resident(content);
        uint64_t words = mesh.added_words(0);
        EXPECT_EQ(words, mesh.with_steps(1).size());
        for (uint32_t step = 1; step < content.dropped.size(); ++step) {
            words += mesh.added_words(step);
            const std::vector<uint32_t> before = mesh.with_steps(step), after = mesh.with_steps(step + 1);
            EXPECT_EQ(words, after.size());
            const auto buffer = PrecisionView::create(std::span(before).subspan(mesh.words.size()));
            const auto merged = change_level(*buffer, mesh.levels[step], mesh.planes(step, step + 1));
            ASSERT_TRUE(merged.ok());
            EXPECT_TRUE(std::equal(merged->begin(), merged->end(), after.begin() + mesh.words.size(), after.end()));
        }
    }
}

TEST(MeshResident, AStepOnShowIsTheSameWhateverElseIsKnown) {
    for (const auto& [name, content] : contents()) {
        SCOPED_TRACE(name);
        const ResidentMesh mesh = make_resident(content);
        const auto steps = static_cast<uint32_t>(content.dropped.size());
        const std::vector<uint32_t> all = mesh.with_steps(steps);
        for (uint32_t shown = 1; shown <= steps; ++shown) {
            const std::vector<uint32_t> some = mesh.with_steps(shown);
            const PositionView view = near_view(content.dropped[shown - 1]);
            EXPECT_TRUE(drawn_of(view_of(some), view) == drawn_of(view_of(all), view));
        }
    }
}

// Of tiles that have other origins and other numbers of bits.
TEST(MeshResident, WhatTwoTilesShareIsShownAtTheSamePlaceAtAllLevels) {
    std::mt19937 random(7);
    GridMesh shared;
    for (int i = 0; i < 3000; ++i)
        shared.points.push_back({static_cast<int32_t>(random() % 4000), static_cast<int32_t>(random() % 300000),
                                 static_cast<int32_t>(random() % 90000)});
    for (uint32_t i = 0; i + 2 < 3000; i += 3) shared.triangles.push_back({i, i + 1, i + 2});
    const GridPoint corner = {-(128 << 10), 64 << 10, 32 << 10};  // of the other tile
    GridMesh other = shared;
    for (GridPoint& point : other.points)
        for (size_t c = 0; c < 3; ++c) point[c] -= corner[c];
    other.points.push_back({900000, 0, 0});
    other.triangles.push_back({3000, 3000, 3000});
    const ContentKind kind{
        .textured = false, .smooth = false, .dressed = false, .prisms = false, .dropped = {9, 6, 3, 0}};
    const ResidentMesh a = make_resident(random_content(shared, kind, 3)),
                       b = make_resident(random_content(other, kind, 3));
    ASSERT_NE(a.shape.full_bits, b.shape.full_bits);
    PositionView from_a{{-70000, -100, 5}, {100, RESIDENT_CELL_BITS}, 0}, from_b = from_a;
    for (size_t c = 0; c < 3; ++c) from_b.from_camera[c] += corner[c];
    std::array<uint32_t, 16> met{};
    for (uint32_t steps_a = 1; steps_a <= 4; ++steps_a) {
        for (uint32_t steps_b = 1; steps_b <= 4; ++steps_b) {
            const std::vector<uint32_t> words_a = a.with_steps(steps_a), words_b = b.with_steps(steps_b);
            const ResidentMeshView view_a = view_of(words_a), view_b = view_of(words_b);
            for (uint32_t t = 0; t < 1000; ++t) {
                // The rule of residency: no tile lacks bits that a vertex is not granted to drop.
                const GridPoint at = view_a.corner(t, 0, from_a).position, to = view_b.corner(t, 0, from_b).position;
                const GridPoint point = biased(shared.points[3 * t], 0);
                std::array<int32_t, 3> camera = from_a.from_camera;
                std::array<uint32_t, 3> word{};
                for (size_t c = 0; c < 3; ++c) {
                    camera[c] -= kMeshBias;
                    word[c] = static_cast<uint32_t>(point[c]);
                }
                const uint32_t granted = dropped_in_box(from_a.rule, camera, word, word);
                if (granted < std::max(kind.dropped[steps_a - 1], kind.dropped[steps_b - 1])) continue;
                ++met[granted];
                for (size_t c = 0; c < 3; ++c) ASSERT_EQ(at[c], to[c] + corner[c]);
            }
        }
    }
    EXPECT_GT(met[9], 1000u);
    EXPECT_GT(met[10], 1000u);
}

TEST(MeshResident, AVertexIsOffByNoMoreThanWhatItsDistanceGrants) {
    const MeshContent content = random_content(terrain_mesh(40), {.textured = false, .smooth = false}, 5);
    const ResidentMesh mesh = make_resident(content);
    const std::vector<uint32_t> words = mesh.with_steps(3);
    const ResidentMeshView view = view_of(words);
    const PositionView far{{1 << 20, -(1 << 20), 1 << 14}, {1 << 14, RESIDENT_CELL_BITS}, 0};
    uint32_t moved = 0;
    for (uint32_t t = 0; t < view.triangle_count(); ++t) {
        for (uint32_t k = 0; k < 3; ++k) {
            const auto exact = view.corner(t, k, kNear).position, shown = view.corner(t, k, far).position;
            double square = 0;
            for (size_t c = 0; c < 3; ++c) square += std::pow(double{1} * exact[c] + far.from_camera[c], 2);
            for (size_t c = 0; c < 3; ++c) {
                EXPECT_LE(std::abs(shown[c] - exact[c]), 2.0 / 3 * std::sqrt(square) / (1 << 14));
                moved += shown[c] != exact[c] ? 1 : 0;
            }
        }
    }
    EXPECT_GT(moved, view.triangle_count());
}

TEST(MeshResident, ConstrainedVerticesDropNoMoreThanTheyMay) {
    const MeshContent content =
        random_content(town_mesh(7, 3), {.textured = false, .prisms = false, .constrained = true}, 4);
    const ResidentMesh mesh = make_resident(content);
    EXPECT_GT(mesh.shape.bins.size(), 2u);
    const std::vector<uint32_t> words = mesh.with_steps(1);
    const ResidentMeshView view = view_of(words);
    std::vector<GridPoint> fine, coarse;
    for (size_t p = 0; p < content.points.size(); ++p) {
        GridPoint point = content.points[p];
        for (int32_t& c : point) {
            const uint32_t dropped = std::min<uint32_t>(content.most_dropped[p], 6);
            c = (c >> dropped << dropped) + static_cast<int32_t>(0x55555555u & ((1u << dropped) - 1)) - kMeshBias;
        }
        coarse.push_back(point);
    }
    std::sort(coarse.begin(), coarse.end());
    for (uint32_t t = 0; t < view.triangle_count(); ++t)
        for (uint32_t k = 0; k < 3; ++k) fine.push_back(view.corner(t, k, near_view(6)).position);
    std::sort(fine.begin(), fine.end());
    fine.erase(std::unique(fine.begin(), fine.end()), fine.end());
    coarse.erase(std::unique(coarse.begin(), coarse.end()), coarse.end());
    EXPECT_EQ(fine, coarse);
}

TEST(MeshResident, StripsTakeFewerWordsThanIndices) {
    const auto words = [](MeshTopology topology) {
        const ContentKind kind{.textured = false, .smooth = false, .dressed = false, .topology = topology};
        return make_resident(random_content(terrain_mesh(60), kind, 9)).words.size();
    };
    EXPECT_LT(2 * words(MeshTopology::kLocalStrips), words(MeshTopology::kIndices));
    EXPECT_LT(words(MeshTopology::kStripCode), words(MeshTopology::kLocalStrips));
}

TEST(MeshResident, AThousandBoxesTakeTheirRingsAndHeights) {
    MeshContent content;
    std::mt19937 random(3);
    for (int i = 0; i < 1000; ++i) {
        const auto x = static_cast<int32_t>(random() % 200000), y = static_cast<int32_t>(random() % 200000);
        content.prisms.push_back({make_prism({rectangle(x, y, 9000, 7000)}, 21845, 40000), colour_word({1, 1, 1}),
                                  colour_word({2, 2, 2}), 0});
    }
    const ResidentMesh mesh = make_resident(content);
    // Ten words of 18 bits, two colours of two, one of two ways to cut a top.
    EXPECT_EQ(mesh.shape.full_bits, 18u);
    EXPECT_LE(static_cast<double>(mesh.with_steps(1).size()) * 4 / 1000, 10 * 18 / 8.0 + 3 / 8.0 + 0.2);
    EXPECT_EQ(mesh.ranges.size(), 1u);
}

// The example of RESIDENT.md, word for word.
TEST(MeshResident, TheExampleOfTheFormatHasItsWords) {
    const auto at = [](int32_t unit) { return unit + kMeshBias; };
    MeshContent content;
    content.dropped = {3, 0};
    content.prisms.push_back({make_prism({rectangle(at(1024), at(2048), 10240, 20480)}, at(0), at(5120)),
                              colour_word({180, 180, 180}), colour_word({120, 60, 40}), 0});
    content.points = {{at(0), at(0), at(0)}, {at(1024), at(0), at(0)}, {at(1024), at(0), at(3001)}};
    MeshTriangle& triangle = content.triangles.emplace_back();
    triangle.chart_word = 2;
    for (uint32_t k = 0; k < 3; ++k) triangle.corners[k] = {k, 127, {k > 0 ? 16384 : 0, k > 1 ? 48000 : 0}};
    const ResidentMesh mesh = make_resident(content);
    const std::vector<uint32_t> words = {
        0x324d5343, 0x00000002, 0x0000000b, 0xfffffaab, 0xfffffaab, 0xfffffaab, 0x00000030, 0x00000003, 0x00000001,
        0x00000028, 0x00000001, 0x0000002f, 0x00000208, 0x00000000, 0x00000000, 0x00000000, 0x00040000, 0x0000000a,
        0x00000000, 0x00000001, 0x00000000, 0x0000002b, 0x00000001, 0x00000102, 0x0000002c, 0x00000000, 0x00000000,
        0x00000000, 0x09010201, 0x00000001, 0x0000000a, 0x00000003, 0x0000000a, 0x0000002e, 0x00000001, 0x7e000002,
        0x0000002f, 0x0000002d, 0x00000000, 0x00000000, 0x00000002, 0x80b4b4b4, 0x80283c78, 0x00000e24, 0x00000002,
        0x2ef00400, 0x00000024, 0x000001fc, 0x31505343, 0x00000013, 0x0c0f0101, 0x00000000, 0x00000000, 0x00000000,
        0x2a32a0aa, 0xa62a1aa1, 0xbaa62a1a, 0xaabaa12a, 0xa0aa0aa0, 0x0aa0aa12, 0x210aa12a, 0x00000002};
    EXPECT_EQ(mesh.with_steps(1), words);
    EXPECT_EQ(mesh.planes(1, 2), (std::vector<uint32_t>{0x0007ffff, 0x00040000, 0x0003ffff}));
}

TEST(MeshResident, WordsThatWereChangedAreRefusedOrReadInside) {
    std::mt19937 random(11);
    uint32_t accepted = 0;
    for (const auto& [name, content] : contents()) {
        const ResidentMesh mesh = make_resident(content);
        const std::vector<uint32_t> words = mesh.with_steps(1);
        for (int i = 0; i < 150; ++i) {
            std::vector<uint32_t> changed = words;
            const size_t head = std::min<size_t>(changed.size(), i % 2 == 0 ? 60 : changed.size());
            uint32_t& word = changed[random() % head];
            word = i % 3 == 0 ? static_cast<uint32_t>(random()) : word ^ 1u << random() % 32;
            if (i % 10 == 9) changed.resize(random() % changed.size());
            const auto view = ResidentMeshView::create(changed, kCharts);
            if (!view) continue;
            ++accepted;
            for (uint32_t t = 0; t < view->triangle_count(); t += 1 + view->triangle_count() / 50) {
                const ResidentCorner corner = view->corner(t, static_cast<uint32_t>(i % 3), {{-5, 9, 3}, {77, 12}, 4});
                ASSERT_LT(corner.chart_entry, changed.size());
                int32_t texcoord[2];
                view->texcoord(t, 1, texcoord);
            }
        }
    }
    EXPECT_GT(accepted, 300u);
}

TEST(MeshResident, ContentAnywhereADecoderAcceptsItIsALayer) {
    constexpr int32_t kMost = (1 << 30) - 1, kGrid = 1 << 29;
    constexpr std::array<int32_t, 9> kPlaces = {-kMost, -kGrid - 1, -kGrid, -1, 0, 4096, kGrid - 1, kGrid, kMost};
    MeshTriangle triangle;
    triangle.chart_word = colour_word({1, 2, 3});
    for (uint32_t k = 0; k < 3; ++k) triangle.corners[k].point = k;
    for (size_t i = 0; i < 3 * kPlaces.size() * kPlaces.size() * kPlaces.size(); ++i) {
        const int32_t x = kPlaces[i / 3 % 9], y = kPlaces[i / 27 % 9], z = kPlaces[i / 243];
        MeshContent content;
        content.dropped = {std::array{0u, 5u, kMeshGridBits}[i % 3]};
        content.points = {{x, y, z}, {y, z, x}, {y, x, x}};
        for (GridPoint& point : content.points)
            for (int32_t& c : point) c = c >> content.dropped[0] << content.dropped[0];
        content.triangles = {triangle};
        SCOPED_TRACE(testing::PrintToString(content.points) + " dropped " + std::to_string(content.dropped[0]));
        const std::vector<uint32_t> words = make_resident(content).with_steps(1);
        const ResidentMeshView view = view_of(words);
        const bool is_exact = i % 3 == 0 && std::max({x, y, z}) < kGrid && std::min({x, y, z}) >= -kGrid;
        EXPECT_TRUE(!is_exact || drawn_of(view, kNear) == drawn_of(content));
    }
}

TEST(MeshResident, PartOfTheWordsIsNoLayer) {
    const ResidentMesh mesh = make_resident(random_content(soup_mesh(9, 12, 5000, 1), {.charts = 2}, 1));
    const std::vector<uint32_t> words = mesh.with_steps(1);
    for (size_t size = 0; size < words.size(); ++size)
        EXPECT_FALSE(ResidentMeshView::create(std::span(words).first(size), kCharts).ok());
}

TEST(MeshResident, ChartsOfUntrustedContentAreChecked) {
    MeshContent content = random_content(terrain_mesh(5), {}, 1);
    EXPECT_TRUE(check_charts(content, kCharts).ok());
    EXPECT_FALSE(check_charts(content, kCharts - 2).ok());
    content.prisms[0].wall_chart = 0;
    EXPECT_FALSE(check_charts(content, kCharts).ok());
}

}  // namespace
}  // namespace citystream::codec::mesh
