// Vertices that neighbouring tiles share are shown at one place, whatever steps of each are here: P4 of the rule that
// closes cracks, from the choice of steps to the GPU words of mesh layers as the shader reads them.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>
#include <set>

#include "client/select/position_rule.h"
#include "codec/chart_word.h"
#include "codec/mesh/mesh_content_make.h"
#include "codec/mesh/mesh_resident.h"
#include "codec/mesh/position_error.h"

namespace citystream::client {
namespace {

using codec::mesh::MeshTile;
using codec::mesh::ResidentMeshView;
using tiles::tileset::Bounds;
using tiles::tileset::StepRecord;

using Place = std::array<int64_t, 3>;  // grid units, absolute
constexpr int64_t kSide = 128 << 10;
constexpr size_t kShared = 1'500;
constexpr double kNoTolerance = 0;

struct CornerOf {
    uint32_t triangle = 0, corner = 0;
};

/// A tile with every number of its steps resident.
struct Tile {
    GridPoint corner;
    Bounds bounds;  ///< relative to the first tile's corner
    std::vector<StepRecord> steps;
    std::array<uint32_t, codec::mesh::kMostMeshSteps> dropped{};
    std::vector<std::vector<uint32_t>> words;  ///< by steps - 1
    std::vector<ResidentMeshView> views;
    std::map<Place, CornerOf> corner_at;  ///< of every place at full precision

    Place shown(const CornerOf& at, size_t resident, const codec::mesh::PositionView& view) const {
        const auto corner_of = views[resident - 1].corner(at.triangle, at.corner, view);
        return {corner.x + corner_of.position[0], corner.y + corner_of.position[1], corner.z + corner_of.position[2]};
    }
    codec::mesh::PositionView seen_with(const PositionRule& rule, uint32_t least) const {
        codec::mesh::PositionView view;
        view.from_camera = {static_cast<int32_t>(corner.x - rule.camera[0]),
                            static_cast<int32_t>(corner.y - rule.camera[1]),
                            static_cast<int32_t>(corner.z - rule.camera[2])};
        view.rule = rule.drop;
        view.least_dropped = least;
        return view;
    }
};

/// Two strips of rough ground that meet along x = kSide; every third triangle is a needle a grid unit wide or less.
class SharedVertices : public testing::Test {
  protected:
    void make(const GridPoint& city, float error_of_second) {
        city_ = city;
        std::vector<std::array<int64_t, 3>> border;
        int64_t y = 0;
        for (size_t i = 0; i < kShared; ++i) {
            // Multiples of 4: exact though the second tile drops two bits for good.
            border.push_back({kSide, y, 4 * whole(0, 20'000)});
            y += 4 * whole(1, 2 * kSide / 4 / static_cast<int64_t>(kShared) - 1);
        }
        tiles_ = {};
        tiles_[0] = tile_of(city, border, -1, 0);
        tiles_[1] = tile_of({city.x + kSide, city.y, city.z - (1 << 16)}, border, 1, error_of_second);
    }

    int64_t whole(int64_t low, int64_t high) { return std::uniform_int_distribution<int64_t>(low, high)(random_); }

    Tile tile_of(const GridPoint& corner, const std::vector<std::array<int64_t, 3>>& border, int64_t side,
                 float error) {
        Tile tile;
        tile.corner = corner;
        MeshTile mesh;
        const auto add = [&](int64_t x, int64_t y, int64_t z) {
            const std::array<int64_t, 3> from = {corner.x - city_.x, corner.y - city_.y, corner.z - city_.z};
            mesh.vertices.push_back({{static_cast<int32_t>(x - from[0]), static_cast<int32_t>(y - from[1]),
                                      static_cast<int32_t>(z - from[2])},
                                     {0, 0, 1},
                                     {0, 0}});
            const std::array<double, 3> place = {to_metres(x), to_metres(y), to_metres(z)};
            for (size_t c = 0; c < 3; ++c) {
                tile.bounds.min[c] = mesh.vertices.size() == 1 ? place[c] : std::min(tile.bounds.min[c], place[c]);
                tile.bounds.max[c] = mesh.vertices.size() == 1 ? place[c] : std::max(tile.bounds.max[c], place[c]);
            }
        };
        for (size_t i = 0; i < border.size(); ++i) {
            add(border[i][0], border[i][1], border[i][2]);
            const int64_t away = i % 3 == 0 ? 1 : whole(1 << 8, 100 << 10);
            add(kSide + side * away, border[i][1] + (i % 3 == 0 ? 0 : whole(-900, 900)), 4 * whole(0, 20'000));
        }
        for (uint32_t i = 0; i + 1 < border.size(); ++i) {
            mesh.indices.insert(mesh.indices.end(), {2 * i, 2 * i + 2, 2 * i + 1});
            mesh.indices.insert(mesh.indices.end(), {2 * i + 1, 2 * i + 2, 2 * i + 3});
        }
        mesh.triangle_chart.assign(mesh.indices.size() / 3, codec::colour_word({90, 120, 60}));
        mesh.dressed_begin = static_cast<uint32_t>(mesh.triangle_chart.size());
        codec::mesh::MeshContentOptions options;
        options.finest_error_metres = error;
        const auto content = make_content(mesh, options);
        const auto resident = make_resident(content);
        for (uint32_t s = 1; s <= content.dropped.size(); ++s) {
            StepRecord step;
            step.error = codec::mesh::step_error(error, content.dropped[s - 1]);
            tile.steps.push_back(step);
            tile.words.push_back(resident.with_steps(s));
        }
        tile.dropped = dropped_bits(tile.steps);
        for (const auto& words : tile.words) {
            auto view = ResidentMeshView::create(words, 0);
            EXPECT_TRUE(view) << (view ? "" : view.error().text());
            if (view) tile.views.push_back(std::move(*view));
        }
        const auto exact = tile.seen_with(position_rule(camera(0, 0, 1), kNoTolerance), 0);
        for (uint32_t triangle = 0; triangle < tile.views.back().triangle_count(); ++triangle) {
            for (uint32_t k = 0; k < 3; ++k)
                tile.corner_at[tile.shown({triangle, k}, tile.views.size(), exact)] = {triangle, k};
        }
        return tile;
    }

    /// Metres from the first tile's corner.
    Camera camera(double x, double y, double z) const {
        CameraSample sample{0, to_metres(city_.x) + x, to_metres(city_.y) + y, to_metres(city_.z) + z, 0, -30, 60};
        return Camera::from_sample(sample, 1280, 720);
    }

    struct Counts {
        uint64_t compared = 0, moved = 0, apart = 0;
        std::set<std::array<size_t, 2>> pairs;  ///< of resident steps
    };

    /// All shared vertices from a camera, at all pairs of steps that may be here when each tile has what it chose.
    void compare(const PositionRule& rule, Counts& counts) const {
        std::array<uint32_t, 2> chosen{};
        std::array<codec::mesh::PositionView, 2> seen;
        for (size_t t = 0; t < 2; ++t) {
            const uint32_t granted = granted_in(rule, tiles_[t].bounds, city_);
            chosen[t] = mesh_prefix(tiles_[t].steps, static_cast<uint32_t>(tiles_[t].steps.size()), granted);
            if (tiles_[t].dropped[chosen[t] - 1] > granted) return;  // all there is, and not enough
            seen[t] = tiles_[t].seen_with(rule, tiles_[t].dropped[chosen[t] - 1]);
        }
        for (size_t a = chosen[0]; a <= tiles_[0].views.size(); ++a) {
            for (size_t b = chosen[1]; b <= tiles_[1].views.size(); ++b) {
                counts.pairs.insert({a, b});
                for (const auto& [place, at] : tiles_[0].corner_at) {
                    const auto other = tiles_[1].corner_at.find(place);
                    if (other == tiles_[1].corner_at.end()) continue;
                    const Place one = tiles_[0].shown(at, a, seen[0]), two = tiles_[1].shown(other->second, b, seen[1]);
                    ++counts.compared;
                    counts.moved += one != place ? 1 : 0;
                    counts.apart += one != two ? 1 : 0;
                }
            }
        }
    }

    GridPoint city_;
    std::array<Tile, 2> tiles_;
    std::mt19937 random_{18};
};

TEST_F(SharedVertices, OfAMillionNoneIsShownAtTwoPlacesAtAnyPairOfSteps) {
    Counts counts;
    for (const float error : {0.0f, 0.04f}) {
        make({int64_t{389'120} << 10, int64_t{5'810'176} << 10, 0}, error);
        const uint64_t end = counts.compared + 600'000;
        while (counts.compared < end) {
            const double away = std::exp2(static_cast<double>(whole(20, 140)) / 10);
            const double turn = static_cast<double>(whole(0, 62)) / 10;
            const Camera from = camera(128 + away * std::cos(turn), 64 + away * std::sin(turn),
                                       away * static_cast<double>(whole(1, 9)) / 10);
            compare(position_rule(from, std::exp2(static_cast<double>(whole(-2, 4)))), counts);
        }
    }
    EXPECT_EQ(counts.apart, 0u);
    EXPECT_GT(counts.compared, 1'000'000u);
    EXPECT_GT(counts.moved, counts.compared / 2) << "positions that drop nothing are equal anyway";
    EXPECT_EQ(counts.pairs.size(), 9u) << "all pairs of steps";
}

TEST_F(SharedVertices, WithoutTheRuleTilesAtDifferentStepsComeApart) {
    make({0, 0, 0}, 0);
    const PositionRule nothing = position_rule(camera(128, 64, 40), kNoTolerance);
    uint64_t apart = 0;
    for (const auto& [place, at] : tiles_[0].corner_at) {
        const auto other = tiles_[1].corner_at.find(place);
        if (other == tiles_[1].corner_at.end()) continue;
        apart += tiles_[0].shown(at, 1, tiles_[0].seen_with(nothing, 0)) !=
                         tiles_[1].shown(other->second, 3, tiles_[1].seen_with(nothing, 0))
                     ? 1
                     : 0;
    }
    EXPECT_GT(apart, kShared / 2) << "the test sees cracks where there are some";
}

TEST_F(SharedVertices, MovingCityAndCameraTogetherChangesNothing) {
    make({0, 0, 0}, 0);
    const GridPoint far = {int64_t{3'000'064} << 10, int64_t{-7'000'064} << 10, int64_t{1} << 22};
    for (double away = 30; away < 9'000; away *= 1.7) {
        const PositionRule here = position_rule(camera(away, 40, away / 2), 1);
        PositionRule there = here;
        there.camera = {here.camera[0] + far.x, here.camera[1] + far.y, here.camera[2] + far.z};
        for (const Tile& tile : tiles_) {
            Bounds bounds = tile.bounds;
            bounds.min[2] += to_metres(far.z);
            bounds.max[2] += to_metres(far.z);
            EXPECT_EQ(granted_in(here, tile.bounds, city_), granted_in(there, bounds, far));
            Tile moved = tile;
            moved.corner = {tile.corner.x + far.x, tile.corner.y + far.y, tile.corner.z + far.z};
            for (const auto& [place, at] : tile.corner_at) {
                const Place one = tile.shown(at, 2, tile.seen_with(here, 0));
                const Place two = moved.shown(at, 2, moved.seen_with(there, 0));
                ASSERT_EQ(two, (Place{one[0] + far.x, one[1] + far.y, one[2] + far.z}));
            }
        }
    }
}

}  // namespace
}  // namespace citystream::client
