#include "codec/mesh/binned_buffer.h"

#include <gtest/gtest.h>

#include <random>

namespace citystream::codec::mesh {
namespace {

GridPoint random_point(std::mt19937_64& random, int32_t size) {
    GridPoint point{};
    for (int32_t& x : point) x = static_cast<int32_t>(random() % static_cast<uint64_t>(2 * size)) - size;
    return point;
}

TEST(BinnedBuffer, RandomAccessEqualsSequentialUnpackingAndLeastLevelsAreKept) {
    std::mt19937_64 random(1);
    std::vector<GridPoint> points;
    std::vector<uint32_t> most;
    for (int i = 0; i < 5000; ++i) {
        points.push_back(random_point(random, 1 << 16));
        most.push_back(static_cast<uint32_t>(random() % 20));
    }
    const PositionWords packed = constrained_positions(points, most, 12);
    ASSERT_TRUE(check_shape(packed.shape).ok());
    EXPECT_EQ(packed.shape.bins.size(), 13u);
    for (uint32_t dropped = 0; dropped <= 12; ++dropped) {
        const auto buffer = pack_precision(packed.shape, packed.words, level_of(packed.grid, dropped));
        const auto view = PrecisionView::create(buffer);
        ASSERT_TRUE(view.ok()) << view.error().text();
        for (uint32_t v = 0; v < points.size(); ++v) {
            std::array<uint32_t, 3> words{};
            const uint32_t level = view->fetch(v, words);
            const uint32_t own = std::min({dropped, most[packed.order[v]], 12u});
            ASSERT_EQ(level, level_of(packed.grid, own));
            ASSERT_EQ(packed.grid.point_of(words, own),
                      packed.grid.point_of(packed.grid.words_of(points[packed.order[v]]), own));
        }
    }
}

TEST(BinnedBuffer, FullLevelGivesThePointsBack) {
    std::mt19937_64 random(2);
    std::vector<GridPoint> points;
    for (int i = 0; i < 300; ++i) points.push_back(random_point(random, 1 << 20));
    const PositionWords packed = adaptive_positions(points, 10);
    const auto buffer = pack_precision(packed.shape, packed.words, packed.grid.full_bits());
    const auto view = PrecisionView::create(buffer);
    ASSERT_TRUE(view.ok());
    for (uint32_t v = 0; v < points.size(); ++v) {
        std::array<uint32_t, 3> words{};
        view->fetch(v, words);
        ASSERT_EQ(packed.grid.point_of(words, 0), points[v]);
    }
}

TEST(BinnedBuffer, OrderIsStableByLevel) {
    const std::vector<uint32_t> levels = {4, 2, 4, 2, 9};
    EXPECT_EQ(order_by_level(levels), (std::vector<uint32_t>{1, 3, 0, 2, 4}));
}

TEST(BinnedBuffer, TheExampleOfTheFormatPageIsWritten) {
    const std::vector<GridPoint> points = {{0, 0, 0}, {1024, 0, 0}, {0, 1024, 512}};
    const PositionWords packed = constrained_positions(points, std::vector<uint32_t>{6, 4, 6}, 6);
    EXPECT_EQ(packed.grid.origin, (GridPoint{-21, -21, -21}));
    EXPECT_EQ(packed.order, (std::vector<uint32_t>{0, 2, 1}));
    EXPECT_EQ(pack_precision(packed.shape, packed.words, 5),
              (std::vector<uint32_t>{0x31505343, 3, 0x050b0302, 0x00010000, 0x28000000, 0, 0x38000002, 0x1c, 0x18800000,
                                     0x0000040c}));
    EXPECT_EQ(precision_plane(packed.shape, packed.words, 5), (std::vector<uint32_t>{0}));
    EXPECT_EQ(precision_plane(packed.shape, packed.words, 6), (std::vector<uint32_t>{0x3f}));
    EXPECT_EQ(precision_plane(packed.shape, packed.words, 7), (std::vector<uint32_t>{0}));
}

/// Two tiles whose boxes differ and which share `shared` points on the plane x = 0.
struct Neighbours {
    std::vector<GridPoint> shared;
    PositionWords left, right;
};

Neighbours make_neighbours(std::mt19937_64& random, size_t count, Reconstruction reading, bool constrained) {
    Neighbours result;
    std::vector<GridPoint> left, right;
    std::vector<uint32_t> most_shared;
    for (size_t i = 0; i < count; ++i) {
        result.shared.push_back({0, static_cast<int32_t>(random() % 1048576), static_cast<int32_t>(random() % 60000)});
        most_shared.push_back(constrained ? static_cast<uint32_t>(random() % 13) : 12);
    }
    left = right = result.shared;
    // Each tile has more behind it: other boxes, origins and numbers of bits.
    left.push_back({-1048576 * 2, 77, -3000});
    right.push_back({1048576 / 2, 1300000, 90000});
    std::vector<uint32_t> most = most_shared;
    most.push_back(12);
    result.left = constrained_positions(left, most, 12, reading);
    result.right = constrained_positions(right, most, 12, reading);
    return result;
}

std::array<int32_t, 3> from_camera(const PrecisionGrid& grid, const GridPoint& camera) {
    return {grid.origin[0] - camera[0], grid.origin[1] - camera[1], grid.origin[2] - camera[2]};
}

uint32_t buffer_level(const PositionWords& tile, const DropRule& rule, const GridPoint& camera) {
    std::array<uint32_t, 3> low = {~0u, ~0u, ~0u}, high = {};
    for (size_t i = 0; i < tile.words.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], tile.words[i]);
        high[i % 3] = std::max(high[i % 3], tile.words[i]);
    }
    return level_of(tile.grid, dropped_in_box(rule, from_camera(tile.grid, camera), low, high));
}

size_t mismatches(const Neighbours& tiles, const DropRule& rule, const GridPoint& camera, size_t& different_levels) {
    const uint32_t levels[2] = {buffer_level(tiles.left, rule, camera), buffer_level(tiles.right, rule, camera)};
    const uint32_t dropped[2] = {tiles.left.grid.full_bits() - levels[0], tiles.right.grid.full_bits() - levels[1]};
    different_levels += dropped[0] != dropped[1] ? tiles.shared.size() : 0;
    const auto left = pack_precision(tiles.left.shape, tiles.left.words, levels[0]);
    const auto right = pack_precision(tiles.right.shape, tiles.right.words, levels[1]);
    const auto left_view = PrecisionView::create(left), right_view = PrecisionView::create(right);
    // Both orders are stable sorts of the same levels but for the last point: find partners through the order.
    std::vector<uint32_t> partner(tiles.right.order.size());
    for (uint32_t i = 0; i < tiles.right.order.size(); ++i) partner[tiles.right.order[i]] = i;
    size_t count = 0;
    for (uint32_t i = 0; i < tiles.left.order.size(); ++i) {
        if (tiles.left.order[i] >= tiles.shared.size()) continue;
        const GridPoint a = shown_position(*left_view, tiles.left.grid, i, rule, from_camera(tiles.left.grid, camera));
        const GridPoint b = shown_position(*right_view, tiles.right.grid, partner[tiles.left.order[i]], rule,
                                           from_camera(tiles.right.grid, camera));
        count += a != b ? 1 : 0;
    }
    return count;
}

TEST(BinnedBuffer, AMillionVerticesSharedByTilesAtDifferentLevelsNeverDiffer) {
    std::mt19937_64 random(3);
    size_t different = 0, tested = 0;
    for (const Reconstruction reading : {Reconstruction::kLow, Reconstruction::kMiddle, Reconstruction::kThirds}) {
        for (const bool constrained : {false, true}) {
            const Neighbours tiles = make_neighbours(random, 2500, reading, constrained);
            for (int i = 0; i < 80; ++i) {
                const DropRule rule{static_cast<uint32_t>(5 + random() % 2000), 12};
                const int32_t range = 1 << (16 + random() % 12);
                const GridPoint camera = random_point(random, range);
                ASSERT_EQ(mismatches(tiles, rule, camera, different), 0u) << "camera " << i;
                tested += tiles.shared.size();
            }
        }
    }
    EXPECT_GE(tested, 1000000u);
    EXPECT_GE(different, 300000u) << "the tiles were at the same levels";
}

TEST(BinnedBuffer, ShownPositionsNeedNoMoreBitsThanTheRuleGivesTheBuffer) {
    std::mt19937_64 random(4);
    const Neighbours tiles = make_neighbours(random, 500, Reconstruction::kThirds, false);
    const DropRule rule{700, 12};
    for (int i = 0; i < 50; ++i) {
        const GridPoint camera = random_point(random, 1 << 24);
        const uint32_t level = buffer_level(tiles.left, rule, camera);
        const auto cut = pack_precision(tiles.left.shape, tiles.left.words, level);
        const auto all = pack_precision(tiles.left.shape, tiles.left.words, tiles.left.grid.full_bits());
        const auto cut_view = PrecisionView::create(cut), all_view = PrecisionView::create(all);
        for (uint32_t v = 0; v < tiles.left.order.size(); ++v) {
            const auto from = from_camera(tiles.left.grid, camera);
            ASSERT_EQ(shown_position(*cut_view, tiles.left.grid, v, rule, from),
                      shown_position(*all_view, tiles.left.grid, v, rule, from));
        }
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
