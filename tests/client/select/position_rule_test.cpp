#include "client/select/position_rule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_resident_layout.h"
#include "codec/mesh/position_error.h"

namespace citystream::client {
namespace {

using codec::mesh::kMeshBias;
using codec::mesh::kMeshGridBits;
using codec::mesh::Reconstruction;
using tiles::tileset::Bounds;
using tiles::tileset::StepRecord;

constexpr GridPoint kCity{int64_t{389'120} << 10, int64_t{5'810'176} << 10, 0};

class PositionRuleTest : public testing::Test {
  protected:
    Camera camera_at(double x, double y, double z, double yaw, double pitch) const {
        const CameraSample sample{0, to_metres(kCity.x) + x, to_metres(kCity.y) + y, z, yaw, pitch, 60};
        return Camera::from_sample(sample, 1280, 720);
    }
    Camera random_camera() {
        return camera_at(between(-500, 1500), between(-500, 1500), between(1, 800), between(0, 360), between(-60, 20));
    }
    double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

    std::mt19937 random_{5};
};

/// As a tile's shader has it: words count from a multiple of 2^kMeshGridBits, less the bias.
struct Vertex {
    std::array<int64_t, 3> place{};  ///< grid units, absolute
    std::array<int64_t, 3> origin{};
    std::array<uint32_t, 3> words{};

    explicit Vertex(const std::array<int64_t, 3>& at) : place(at) {
        for (size_t c = 0; c < 3; ++c) {
            const int64_t biased = place[c] + kMeshBias;
            origin[c] = ((biased >> kMeshGridBits) - 1) * (int64_t{1} << kMeshGridBits) - kMeshBias;
            words[c] = static_cast<uint32_t>(place[c] - origin[c]);
        }
    }
    uint32_t granted(const PositionRule& rule) const {
        std::array<int32_t, 3> from_camera{};
        for (size_t c = 0; c < 3; ++c) from_camera[c] = static_cast<int32_t>(origin[c] - rule.camera[c]);
        return dropped_in_box(rule.drop, from_camera, words, words);
    }
    /// Metres, absolute.
    std::array<double, 3> shown(uint32_t dropped) const {
        std::array<double, 3> out{};
        for (size_t c = 0; c < 3; ++c)
            out[c] = to_metres(origin[c] + (words[c] >> dropped << dropped) +
                               reading_offset(Reconstruction::kThirds, dropped));
        return out;
    }
};

/// Pixels from the picture's centre; nothing where a point is not in the picture.
std::optional<std::array<double, 2>> project(const Camera& camera, const std::array<double, 3>& point) {
    const auto along = [&](const std::array<double, 3>& axis) {
        return (point[0] - camera.position[0]) * axis[0] + (point[1] - camera.position[1]) * axis[1] +
               (point[2] - camera.position[2]) * axis[2];
    };
    const double depth = along(camera.forward);
    if (depth < camera.near_plane) return std::nullopt;
    const double scale = camera.pixels_per_metre(depth);
    return std::array<double, 2>{along(camera.right) * scale, along(camera.up) * scale};
}

bool in_picture(const Camera& camera, const std::array<double, 2>& pixel) {
    return std::abs(pixel[0]) <= camera.width / 2.0 && std::abs(pixel[1]) <= camera.height / 2.0;
}

TEST_F(PositionRuleTest, EveryVertexOfABoxIsGrantedAtLeastWhatTheBoxIs) {
    uint32_t more = 0, equal = 0;
    for (int i = 0; i < 20'000; ++i) {
        const PositionRule rule = position_rule(random_camera(), std::exp2(between(-3, 4)));
        Bounds bounds;
        for (size_t c = 0; c < 3; ++c) {
            bounds.min[c] = to_metres(to_grid(between(0, 900)));
            bounds.max[c] = bounds.min[c] + to_metres(to_grid(std::exp2(between(-2, 8))));
        }
        const uint32_t of_box = granted_in(rule, bounds, kCity);
        for (int k = 0; k < 8; ++k) {
            const std::array<int64_t, 3> corner = {kCity.x, kCity.y, 0};
            std::array<int64_t, 3> place{};
            for (size_t c = 0; c < 3; ++c) {
                // Corners of the box, too: there the nearest vertex is.
                const double share = k < 4 ? std::round(between(0, 1)) : between(0, 1);
                place[c] = corner[c] + to_grid(bounds.min[c] + share * (bounds.max[c] - bounds.min[c]));
            }
            const uint32_t of_vertex = Vertex(place).granted(rule);
            ASSERT_GE(of_vertex, of_box);
            ++(of_vertex > of_box ? more : equal);
        }
    }
    EXPECT_GT(more, 5'000u);
    EXPECT_GT(equal, 10'000u) << "a box that is granted nothing would pass as well";
}

TEST_F(PositionRuleTest, NoVertexIsFartherThanTheToleranceFromItsPlaceAnywhereInThePicture) {
    double worst = 0;
    uint32_t seen = 0;
    for (int i = 0; i < 200'000; ++i) {
        const double pixels = std::exp2(between(-2, 3));
        const Camera camera = random_camera();
        const PositionRule rule = position_rule(camera, pixels);
        const Vertex vertex(
            {kCity.x + to_grid(between(0, 1000)), kCity.y + to_grid(between(0, 1000)), to_grid(between(0, 100))});
        const uint32_t dropped = vertex.granted(rule);
        const auto place = project(camera, vertex.shown(0));
        if (!place || !in_picture(camera, *place)) continue;
        const auto shown = project(camera, vertex.shown(dropped));
        ASSERT_TRUE(shown);
        const double off = std::hypot((*shown)[0] - (*place)[0], (*shown)[1] - (*place)[1]);
        // The distance changes with the vertex: by a share that is small next to the error itself.
        ASSERT_LE(off, pixels * 1.02);
        worst = std::max(worst, off / pixels);
        ++seen;
    }
    EXPECT_GT(seen, 20'000u);
    EXPECT_GT(worst, 0.5) << "of the tolerance: the rule gives away more than a bit";
}

TEST_F(PositionRuleTest, TurningChangesNothingAndAGreaterToleranceNeverGrantsLess) {
    const Bounds bounds{{100, 200, 0}, {228, 328, 40}};
    uint32_t levels = 0;
    for (double z = 50; z < 20'000; z *= 1.3) {
        uint32_t before = 0;
        for (double pixels = 0.125; pixels <= 16; pixels *= 2) {
            const uint32_t granted = granted_in(position_rule(camera_at(0, 0, z, 0, 0), pixels), bounds, kCity);
            EXPECT_EQ(granted, granted_in(position_rule(camera_at(0, 0, z, 130, -50), pixels), bounds, kCity));
            EXPECT_GE(granted, before);
            EXPECT_LE(granted, uint32_t{RESIDENT_CELL_BITS});
            levels |= 1u << granted;
            before = granted;
        }
    }
    EXPECT_EQ(levels >> 4, (1u << (RESIDENT_CELL_BITS - 3)) - 1) << "every number of bits from 4 is granted somewhere";
    const Camera far = camera_at(0, 0, 1e5, 0, -80);
    EXPECT_EQ(granted_in(position_rule(far, 0), bounds, kCity), 0u);
    EXPECT_EQ(granted_in(position_rule(camera_at(150, 250, 20, 0, 0), 100), bounds, kCity), 0u) << "camera in the box";
}

TEST_F(PositionRuleTest, ACameraOutOfThisWorldGrantsWhatTheFarthestOneIsGranted) {
    const Bounds bounds{{0, 0, 0}, {128, 128, 10}};
    for (const double metres : {1e7, 1e12, 1e300}) {
        EXPECT_EQ(granted_in(position_rule(camera_at(metres, -metres, 0, 0, 0), 1), bounds, kCity),
                  uint32_t{RESIDENT_CELL_BITS});
    }
}

TEST_F(PositionRuleTest, TheStatedErrorBoundsThatOfEveryDistanceAndIsMet) {
    for (int i = 0; i < 2'000; ++i) {
        const double pixels = std::exp2(between(-2, 3));
        const PositionRule rule = position_rule(random_camera(), pixels);
        const double nearest = std::exp2(between(0, 12)), farthest = nearest * std::exp2(between(0, 4));
        const uint32_t least = static_cast<uint32_t>(between(0, 6));
        const double stated = greatest_position_error(rule, least, nearest, farthest);
        double found = 0;
        for (int k = 0; k <= 4'000; ++k) {
            const double distance = nearest * std::pow(farthest / nearest, k / 4'000.0);
            const auto units = static_cast<uint32_t>(distance * kGridUnitsPerMetre);
            const uint32_t dropped = std::max(least, rule.drop.dropped_at(units));
            found = std::max(found, rule.error_pixels(dropped, distance));
        }
        EXPECT_LE(found, stated * (1 + 1e-9));
        EXPECT_GE(found, stated * 0.98);
        if (least <= rule.drop.dropped_at(static_cast<uint32_t>(nearest * kGridUnitsPerMetre))) {
            EXPECT_LE(stated, pixels);
        }
    }
}

StepRecord step_of(float error) {
    StepRecord step;
    step.error = error;
    return step;
}

TEST(MeshPrefix, IsTheFirstStepThatDropsNoMoreThanGrantedOrAllThatCanBeHad) {
    std::vector<StepRecord> steps;
    for (const uint32_t dropped : {8u, 5u, 2u}) steps.push_back(step_of(codec::mesh::step_error(0.05f, dropped)));
    EXPECT_EQ(dropped_bits(steps), (std::array<uint32_t, 4>{8, 5, 2, 2}));
    const auto prefix = [&](uint32_t granted) { return uint32_t{mesh_prefix(steps, 3, granted)}; };
    EXPECT_EQ(prefix(12), 1u);
    EXPECT_EQ(prefix(8), 1u);
    EXPECT_EQ(prefix(7), 2u);
    EXPECT_EQ(prefix(5), 2u);
    EXPECT_EQ(prefix(4), 3u);
    EXPECT_EQ(prefix(0), 3u) << "the last step is all there is";
    EXPECT_EQ(mesh_prefix(steps, 2, 0), 2u) << "the third step cannot be had";
    EXPECT_EQ(mesh_prefix(steps, 0, 12), 0u);
    EXPECT_EQ(mesh_prefix({step_of(3.0f)}, 1, 0), 1u);
}

TEST(MeshPrefix, AStepTableOfAMeshLayerIsNeverReadAsDroppingLessThanItDoes) {
    codec::mesh::MeshTile tile;
    for (const auto& [x, y] : {std::pair{0, 0}, {1 << 20, 0}, {0, 1 << 20}})
        tile.vertices.push_back({{x, y, 0}, {0, 0, 1}, {0, 0}});
    tile.indices = {0, 1, 2};
    tile.triangle_chart = {0};
    tile.dressed_begin = 1;
    for (const float error : {0.0f, 0.05f, 0.25f, 1.25f, 6.25f}) {
        std::vector<StepRecord> steps;
        codec::mesh::MeshLayerOptions options;
        options.content.finest_error_metres = error;
        for (const auto& step : codec::mesh::encode_mesh_layer(tile, options)) steps.push_back(step_of(step.error));
        const uint32_t finest = codec::mesh::finest_dropped(error);
        const auto dropped = dropped_bits(steps);
        ASSERT_EQ(steps.size(), 3u);
        for (size_t s = 0; s < steps.size(); ++s) {
            const auto truth = finest + 3 * static_cast<uint32_t>(steps.size() - 1 - s);
            EXPECT_GE(dropped[s], truth) << "error " << error << " step " << s;
            EXPECT_LE(dropped[s], truth + 1) << "error " << error << " step " << s;
        }
    }
}

}  // namespace
}  // namespace citystream::client
