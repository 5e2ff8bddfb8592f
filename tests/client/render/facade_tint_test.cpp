#include "codec/atlas/facade_tint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "codec/atlas/tint_layout.h"
#include "tests/client/render/facade_scene.h"

namespace citystream::client::test {
namespace {

using codec::atlas::FacadeTint;
using codec::atlas::Tint;
using codec::atlas::tint_palette;
using codec::atlas::tint_place;

codec::mesh::MeshTile wall_and_roof() {
    codec::mesh::MeshTile mesh;
    const auto add = [&](const std::array<std::array<int32_t, 3>, 4>& corners, const std::array<float, 3>& normal) {
        for (const size_t k : {0, 1, 2, 0, 2, 3}) {
            codec::mesh::MeshVertex vertex{};
            for (size_t c = 0; c < 3; ++c) {
                vertex.position[c] = corners[k][c] * 1024;
                vertex.normal[c] = normal[c];
            }
            mesh.indices.push_back(static_cast<uint32_t>(mesh.vertices.size()));
            mesh.vertices.push_back(vertex);
        }
        mesh.triangle_chart.insert(mesh.triangle_chart.end(), 2, 0);
    };
    add({{{0, 0, 0}, {60, 0, 0}, {60, 0, 10}, {0, 0, 10}}}, {0, -1, 0});
    add({{{0, 0, 10}, {60, 0, 10}, {60, 40, 10}, {0, 40, 10}}}, {0, 0, 1});
    mesh.dressed_begin = static_cast<uint32_t>(mesh.triangle_chart.size());
    return mesh;
}

FrameImage tinted_frame(const FacadeTint& tint, const Camera& camera) {
    RendererOptions options = small_options();
    options.facade_tint = tint;
    const auto renderer = make_renderer(options);
    if (renderer == nullptr) return {};
    TileDraw tile = upload_tile(*renderer, wall_and_roof(), {});
    tile.atlas = kNoLayer;
    const FrameImage image = draw_or_fail(*renderer, camera, std::span(&tile, 1));
    EXPECT_EQ(renderer->validation_messages(), 0u);
    return image;
}

// A wall of one colour is lit alike all over: what is left is the tint, which is known in closed form.
TEST(TintedFrames, WallsShowTheMixOfTheirPlaceAndRoofsNone) {
    const Camera camera = make_camera({30, -40, 25}, 0, -25);
    const FacadeTint tint{0.4, 7};
    const FrameImage plain = tinted_frame({}, camera), image = tinted_frame(tint, camera);
    ASSERT_EQ(plain.rgba.size(), image.rgba.size());
    size_t walls = 0, roofs = 0;
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const Vec3 ray = ray_through(camera, x + 0.5, y + 0.5);
            const double t = -camera.position[1] / ray[1];
            const double wall_x = camera.position[0] + t * ray[0], wall_z = camera.position[2] + t * ray[2];
            // Metres inside the wall's edges.
            const double inside = std::min({wall_x, 60 - wall_x, wall_z, 10 - wall_z});
            if (std::abs(inside) < 0.5) continue;
            if (inside < 0) {
                ASSERT_EQ(pixel(image, x, y), pixel(plain, x, y)) << x << ", " << y;
                roofs += pixel(plain, x, y) != pixel(plain, 0, 0);
                continue;
            }
            ++walls;
            const Tint expected = codec::atlas::tint_at(tint_palette(), tint_place({wall_x, 0, 0}, tint));
            const double light = pixel(plain, x, y)[0] / 255.0 / 0.7;
            for (size_t c = 0; c < 3; ++c) {
                const double tinted = 0.7 * (0.6 + 0.4 * double{expected[c]});
                ASSERT_NEAR(pixel(image, x, y)[c], 255 * std::min(1.0, tinted * light), 2.0) << x << ", " << y;
            }
        }
    }
    EXPECT_GT(walls, 2000u);
    EXPECT_GT(roofs, 2000u);
}

// Relief takes its tint along the wall and outwards, as a wall of triangles in its place would.
TEST(TintedFrames, ReliefIsTintedLikeTheWallsOfItsPlaces) {
    const FacadeTint tint{1, 3};
    // From so far that hardly anything but fronts is seen.
    const Camera camera = make_camera({3, -200, 2}, 0, 0, 320, 240, 1.1);
    FrameImage frames[2];
    size_t seen_points = 0, like = 0;
    for (const bool tinted : {false, true}) {
        RendererOptions options = small_options();
        if (tinted) options.facade_tint = tint;
        const auto renderer = make_renderer(options);
        ASSERT_NE(renderer, nullptr);
        const Wall wall;
        const FacadeScene scene = facade_scene(*renderer, FacadeRenderer::kPatch, window_facade(), std::span(&wall, 1));
        frames[tinted ? 1 : 0] = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
        EXPECT_EQ(renderer->validation_messages(), 0u);
        if (!tinted) continue;
        const FacadePainter painter(scene, camera);
        for (uint32_t y = 2; y < camera.height; y += 5) {
            for (uint32_t x = 2; x < camera.width; x += 5) {
                const SeenPoint seen = painter.look(x + 0.5, y + 0.5);
                const auto plain = pixel(frames[0], x, y);
                if (!std::isfinite(seen.distance) || *std::max_element(plain.begin(), plain.end()) == 255) continue;
                const Vec3 ray = ray_through(camera, x + 0.5, y + 0.5);
                const double along =
                    ray[0] * camera.forward[0] + ray[1] * camera.forward[1] + ray[2] * camera.forward[2];
                Vec3 at{};
                for (size_t c = 0; c < 3; ++c) at[c] = camera.position[c] + seen.distance / along * ray[c];
                const Tint expected = codec::atlas::tint_at(tint_palette(), tint_place(at, tint));
                ++seen_points;
                bool same = true;
                for (size_t c = 0; c < 3; ++c)
                    same &= std::abs(pixel(frames[1], x, y)[c] - plain[c] * double{expected[c]}) <= 1.5;
                like += same;
            }
        }
    }
    EXPECT_GT(seen_points, 1000u);
    EXPECT_GT(static_cast<double>(like), 0.97 * static_cast<double>(seen_points));
}

}  // namespace
}  // namespace citystream::client::test
