#include "client/render/shadow_cascades.h"

#include "tests/client/render/lit_scene.h"

namespace citystream::client::test {
namespace {

const Vec3 kToSun = {-0.48, -0.6, 0.64};

/// Texels and depth of a point, as a shader has them.
Vec3 seen(const ShadowCascade& cascade, const Vec3& from_camera) {
    const auto at = [&](const float row[4]) {
        double sum = static_cast<double>(row[3]);
        for (size_t i = 0; i < 3; ++i) sum += static_cast<double>(row[i]) * from_camera[i];
        return sum;
    };
    return {at(cascade.column), at(cascade.row), at(cascade.depth)};
}

TEST(ShadowCascades, MapsAreAsLargeAsTheFrameWithinBounds) {
    EXPECT_EQ(shadow_side(320, 180), 512U);
    EXPECT_EQ(shadow_side(512, 640), 1024U);
    EXPECT_EQ(shadow_side(1024, 768), 1024U);
    EXPECT_EQ(shadow_side(1280, 720), 2048U);
    EXPECT_EQ(shadow_side(3840, 2160), 2048U);
}

TEST(ShadowCascades, EachHoldsItsPartOfWhatTheCameraSees) {
    for (const double yaw : {0.0, 77.0, 200.0}) {
        const Camera camera = make_camera({1e6, 5e6, 40}, yaw, -20, 1280, 720);
        const auto views = shadow_cascades(camera, kToSun, 1024);
        for (size_t i = 0; i < views.size(); ++i) {
            const ShadowCascade lookup = shadow_lookup(views[i], camera_cell(camera.position), 1024);
            for (const double end : {0.01, 0.5, 1.0}) {
                for (int corner = 0; corner < 4; ++corner) {
                    const Vec3 ray = ray_through(camera, corner % 2 * 1280.0, corner / 2 * 720.0);
                    const Vec3 at = seen(lookup, along({0, 0, 0}, ray, end * kCascadeEnds[i]));
                    for (size_t c = 0; c < 2; ++c) {
                        EXPECT_GT(at[c], 3);
                        EXPECT_LT(at[c], 1021);
                    }
                    EXPECT_GT(at[2], 0);
                    EXPECT_LT(at[2], 1);
                }
            }
        }
    }
}

TEST(ShadowCascades, TexelsStayWhereTheyAreInTheWorld) {
    const Vec3 point = {1000.3, 2000.7, 12.1};
    Vec3 fractions{};
    for (int step = 0; step < 20; ++step) {
        const Camera camera = make_camera({990 + 0.37 * step, 1990 - 0.21 * step, 30 + 0.11 * step}, 5.0 * step, -10);
        const auto views = shadow_cascades(camera, kToSun, 2048);
        const ShadowCascade lookup = shadow_lookup(views[0], camera_cell(camera.position), 2048);
        const Vec3 at = seen(lookup, minus(point, camera.position));
        for (size_t c = 0; c < 2; ++c) {
            const double fraction = at[c] - std::floor(at[c]);
            if (step == 0) fractions[c] = fraction;
            const double moved = std::abs(fraction - fractions[c]);
            EXPECT_LT(std::min(moved, 1 - moved), 0.01) << "texels";
        }
    }
}

TEST(ShadowCascades, APassPutsPointsWhereTheLookupFindsThem) {
    const Camera camera = make_camera({400, 300, 60}, 30, -30);
    const CameraCell cell = camera_cell(camera.position);
    for (const CascadeView& view : shadow_cascades(camera, kToSun, 512)) {
        const ShadowCascade lookup = shadow_lookup(view, cell, 512);
        const FrameConstants frame = shadow_frame(view, cell, 512);
        const Vec3 from_camera = {12.5, 30.25, -20.75};
        const auto along_row = [&](const float row[3]) {
            double sum = 0;
            for (size_t i = 0; i < 3; ++i) {
                const double from_cell = from_camera[i] + static_cast<double>(cell.fraction[i]);
                sum += static_cast<double>(row[i]) * (from_cell - static_cast<double>(frame.camera_fraction[i]));
            }
            return sum;
        };
        const Vec3 at = seen(lookup, from_camera);
        EXPECT_NEAR((along_row(frame.clip_x) + 1) * 256, at[0], 0.01);
        EXPECT_NEAR((along_row(frame.clip_y) + 1) * 256, at[1], 0.01);
        EXPECT_NEAR(0.5 + along_row(frame.clip_w), at[2], 1e-6);
    }
}

}  // namespace
}  // namespace citystream::client::test
