// Pictures that the tests make themselves on the CPU, in double, to compare frames with.
#pragma once

#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>

#include "client/render/frame_file.h"
#include "client/render/lighting_layout.h"
#include "codec/atlas/atlas_layout.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {

using Vec3 = std::array<double, 3>;
inline constexpr Vec3 kSun = {LIGHT_SUN_X, LIGHT_SUN_Y, LIGHT_SUN_Z};

inline void keep(const FrameImage& image, const std::string& name) {
    const char* folder = std::getenv("CITYSTREAM_TEST_FRAMES");
    if (folder == nullptr) return;
    EXPECT_TRUE(write_png(std::string(folder) + "/" + name + ".png", image).ok());
}

inline double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Direction through a point of the picture (pixels from the top left), view distance 1.
inline Vec3 ray_through(const Camera& camera, double x, double y) {
    const double tangent = std::tan(camera.fov_y / 2);
    const double right = (2 * x / camera.width - 1) * tangent * camera.width / camera.height;
    const double up = (1 - 2 * y / camera.height) * tangent;
    Vec3 d{};
    for (size_t c = 0; c < 3; ++c) d[c] = camera.forward[c] + right * camera.right[c] + up * camera.up[c];
    return d;
}

inline Vec3 lit(const Vec3& texel, const Vec3& normal) {
    const double light = LIGHT_AMBIENT + LIGHT_SUN * std::max(0.0, dot(normal, kSun));
    Vec3 out{};
    for (size_t c = 0; c < 3; ++c) out[c] = std::min(255.0, texel[c] * light);
    return out;
}

// The CPU's sampler: textbook OpenGL, in double, over the decoded texels.
struct Sampler {
    const codec::atlas::AtlasLayerView& atlas;
    uint32_t chart;

    int wrap(double i, int size, bool repeat) const {
        const int n = static_cast<int>(i);
        return repeat ? ((n % size) + size) % size : std::min(std::max(n, 0), size - 1);
    }
    Vec3 mip(uint32_t level, double u, double v) const {
        const int width = static_cast<int>(std::max(1u, atlas.width(chart) >> level));
        const int height = static_cast<int>(std::max(1u, atlas.height(chart) >> level));
        const double x = u * width - 0.5, y = v * height - 0.5;
        Vec3 sum{};
        for (int j = 0; j < 2; ++j) {
            for (int i = 0; i < 2; ++i) {
                const double wx = i == 0 ? 1 - (x - std::floor(x)) : x - std::floor(x);
                const double wy = j == 0 ? 1 - (y - std::floor(y)) : y - std::floor(y);
                uint8_t rgb[3];
                atlas.texel(chart, level,
                            static_cast<uint32_t>(
                                wrap(std::floor(x) + i, width, (atlas.flags(chart) & ATLAS_CHART_REPEAT_U) != 0)),
                            static_cast<uint32_t>(
                                wrap(std::floor(y) + j, height, (atlas.flags(chart) & ATLAS_CHART_REPEAT_V) != 0)),
                            rgb);
                for (size_t c = 0; c < 3; ++c) sum[c] += wx * wy * rgb[c];
            }
        }
        return sum;
    }
    Vec3 operator()(const std::array<double, 2>& uv, const std::array<double, 2>& dx,
                    const std::array<double, 2>& dy) const {
        const double w = atlas.width(chart), h = atlas.height(chart);
        const double rho = std::max(std::hypot(dx[0] * w, dx[1] * h), std::hypot(dy[0] * w, dy[1] * h));
        const double last = atlas.mip_count(chart) - 1.0;
        const double lod = std::min(std::max(std::log2(rho), static_cast<double>(atlas.finest_mip())), last);
        const auto level = static_cast<uint32_t>(lod);
        const Vec3 a = mip(level, uv[0], uv[1]);
        if (lod == level) return a;
        const Vec3 b = mip(level + 1, uv[0], uv[1]);
        Vec3 out{};
        for (size_t c = 0; c < 3; ++c) out[c] = a[c] + (b[c] - a[c]) * (lod - level);
        return out;
    }
};

/// Of any channel of any pixel.
inline int greatest_difference(const FrameImage& a, const FrameImage& b) {
    int greatest = 0;
    EXPECT_EQ(a.rgba.size(), b.rgba.size());
    for (size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i)
        greatest = std::max(greatest, std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
    return greatest;
}

inline FrameImage picture(const Camera& camera, const std::function<Vec3(double, double)>& colour) {
    FrameImage image{camera.width, camera.height, {}};
    for (uint32_t y = 0; y < camera.height; ++y) {
        for (uint32_t x = 0; x < camera.width; ++x) {
            const Vec3 c = colour(x + 0.5, y + 0.5);
            for (const double value : c) image.rgba.push_back(static_cast<uint8_t>(std::lround(value)));
            image.rgba.push_back(255);
        }
    }
    return image;
}

inline constexpr Vec3 kSkyColour = {SKY_R * 255, SKY_G * 255, SKY_B * 255};

/// A ground quad of 16 x 16 m at z = 0 with its corner at the origin, that shows `repeats` of a chart a side;
/// sampler(uv, change of uv by a pixel to the right, and down).
template <typename Sampler>
FrameImage ground_quad_picture(const Camera& camera, int32_t repeats, const Sampler& sampler) {
    const auto uv_at = [&](double x, double y) -> std::array<double, 2> {
        const Vec3 d = ray_through(camera, x, y);
        const double t = -camera.position[2] / d[2];
        return {(camera.position[0] + t * d[0]) / 16 * repeats, (camera.position[1] + t * d[1]) / 16 * repeats};
    };
    return picture(camera, [&](double x, double y) {
        const auto uv = uv_at(x, y);
        const bool above = ray_through(camera, x, y)[2] >= 0;
        if (above || uv[0] < 0 || uv[1] < 0 || uv[0] > repeats || uv[1] > repeats) return kSkyColour;
        const auto px = uv_at(x + 0.5, y), mx = uv_at(x - 0.5, y), py = uv_at(x, y + 0.5), my = uv_at(x, y - 0.5);
        return lit(sampler(uv, {px[0] - mx[0], px[1] - mx[1]}, {py[0] - my[0], py[1] - my[1]}), {0, 0, 1});
    });
}

}  // namespace citystream::client::test
