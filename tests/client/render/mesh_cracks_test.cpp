// No cracks between tiles whose mesh layers are here in different steps, as the GPU draws them.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "client/select/position_rule.h"
#include "codec/chart_word.h"
#include "codec/mesh/mesh_content_make.h"
#include "codec/mesh/position_error.h"
#include "tests/client/render/device_test.h"
#include "tests/client/render/mesh_picture.h"
#include "tests/client/render/precision_picture.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

constexpr uint32_t kSize = 400;
constexpr int kPoints = 17, kTiles = 8;  // points of a tile's side; tiles of the ground's side
constexpr int kSide = 1 << 16;           // of a tile, grid units
constexpr int kSpacing = kSide / (kPoints - 1);

struct GroundTile {
    std::array<int64_t, 3> corner{};
    tiles::tileset::Bounds bounds;
    std::vector<tiles::tileset::StepRecord> steps;
    std::vector<uint32_t> dropped;
    std::vector<codec::mesh::MeshRange> ranges;
    std::vector<std::vector<uint32_t>> words;  ///< by steps - 1
};

/// A point of the ground, the same for all tiles that have it.
std::array<int32_t, 3> ground_point(int x, int y) {
    std::mt19937 random(static_cast<uint32_t>(y * 4099 + x));
    const auto jitter = [&] { return static_cast<int32_t>(random() % (kSpacing / 2)) - kSpacing / 4; };
    return {x * kSpacing + jitter(), y * kSpacing + jitter(), static_cast<int32_t>(random() % 3000)};
}

GroundTile ground_tile(int tx, int ty) {
    GroundTile tile;
    // Tiles count from different heights.
    tile.corner = {tx * kSide, ty * kSide, ((tx + ty) % 3 - 1) * (1 << 16)};
    codec::mesh::MeshTile mesh;
    for (int y = 0; y < kPoints; ++y) {
        for (int x = 0; x < kPoints; ++x) {
            const auto at = ground_point(tx * (kPoints - 1) + x, ty * (kPoints - 1) + y);
            codec::mesh::MeshVertex vertex{{}, {0, 0, 1}, {0, 0}};
            for (size_t c = 0; c < 3; ++c) {
                vertex.position[c] = at[c] - static_cast<int32_t>(tile.corner[c]);
                const double metres = to_metres(at[c]);
                tile.bounds.min[c] = mesh.vertices.empty() ? metres : std::min(tile.bounds.min[c], metres);
                tile.bounds.max[c] = mesh.vertices.empty() ? metres : std::max(tile.bounds.max[c], metres);
            }
            mesh.vertices.push_back(vertex);
        }
    }
    for (uint32_t y = 0; y + 1 < kPoints; ++y) {
        for (uint32_t x = 0; x + 1 < kPoints; ++x) {
            const uint32_t a = y * kPoints + x;
            mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + kPoints + 1, a, a + kPoints + 1, a + kPoints});
        }
    }
    mesh.triangle_chart.assign(mesh.indices.size() / 3, codec::colour_word({90, 120, 60}));
    mesh.dressed_begin = static_cast<uint32_t>(mesh.triangle_chart.size());
    const auto content = make_content(mesh);
    const auto resident = make_resident(content);
    tile.dropped = content.dropped;
    tile.ranges = resident.ranges;
    for (uint32_t s = 1; s <= content.dropped.size(); ++s) {
        tiles::tileset::StepRecord step;
        step.error = codec::mesh::step_error(0, content.dropped[s - 1]);
        tile.steps.push_back(step);
        tile.words.push_back(resident.with_steps(s));
    }
    return tile;
}

class MeshCracks : public DeviceTest {
  protected:
    void SetUp() override {
        DeviceTest::SetUp();
        if (HasFatalFailure()) return;
        picture_ = std::make_unique<MeshPicture>(device_, kSize, kSize);
        for (int i = 0; i < kTiles * kTiles; ++i) tiles_.push_back(ground_tile(i % kTiles, i / kTiles));
    }
    void TearDown() override {
        picture_.reset();
        DeviceTest::TearDown();
    }

    std::unique_ptr<MeshPicture> picture_;
    std::vector<GroundTile> tiles_;
};

TEST_F(MeshCracks, TilesAtAllPairsOfStepsShowNoPixelOfTheBackground) {
    std::mt19937 random(3);
    std::set<std::pair<size_t, size_t>> pairs;
    size_t shared = 0, cracks_without_rule = 0;
    const double middle = to_metres(kTiles * kSide) / 2;
    for (int frame = 0; shared < 1'000'000; ++frame) {
        // Straight down from 4 to 200 m above the middle, never so high that the edge of the ground shows.
        const double height = 4 * std::pow(1.03, frame % 132);
        const Camera camera =
            make_camera({middle + frame % 7, middle - frame % 5, height}, frame * 37, -90, kSize, kSize, 50);
        const PositionRule rule = position_rule(camera, frame % 2 == 0 ? 8 : 60);
        std::vector<MeshDraw> draws, lawless;
        std::vector<size_t> here;
        for (const GroundTile& tile : tiles_) {
            const uint32_t granted = granted_in(rule, tile.bounds, {0, 0, 0});
            const size_t chosen = mesh_prefix(tile.steps, static_cast<uint32_t>(tile.steps.size()), granted);
            here.push_back(chosen + random() % (tile.steps.size() - chosen + 1));
            draws.push_back(
                {tile.words[here.back() - 1], tile.ranges, tile.corner, rule.drop, tile.dropped[chosen - 1]});
            lawless.push_back({tile.words[here.back() - 1], tile.ranges, tile.corner, {~0u, 0}, 0});
            const size_t t = here.size() - 1;
            if (t % kTiles > 0) pairs.insert({here[t - 1], here[t]});
            shared += (t % kTiles > 0 ? kPoints : 0) + (t >= kTiles ? kPoints : 0);
        }
        ASSERT_EQ(pixels_of_nothing(picture_->draw(camera, draws)), 0u) << "frame " << frame;
        if (frame % 40 == 39) cracks_without_rule += pixels_of_nothing(picture_->draw(camera, lawless));
    }
    EXPECT_GT(cracks_without_rule, 100u) << "the scene would not show cracks";
    EXPECT_EQ(pairs.size(), 9u) << "not all pairs of steps";
}

}  // namespace
}  // namespace citystream::client::test
