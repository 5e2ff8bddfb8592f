// Small scenes made with the real encoders, and ways to look at frames, for the renderer's tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "client/render/device.h"
#include "client/render/vulkan_renderer.h"
#include "codec/atlas/atlas_layer.h"
#include "codec/facade/facade_layer.h"
#include "tests/codec/mesh/mesh_layers.h"

namespace citystream::client::test {

inline RendererOptions small_options(uint32_t width = 320, uint32_t height = 240) {
    RendererOptions options;
    options.width = width;
    options.height = height;
    options.gpu_budget_bytes = 16 << 20;
    options.validation = validation_layer_installed();
    return options;
}

/// A renderer with validation where the layer is installed; every test ends with no_messages().
inline std::unique_ptr<VulkanRenderer> make_renderer(const RendererOptions& options = small_options()) {
    Result<std::unique_ptr<VulkanRenderer>> renderer = VulkanRenderer::create(options);
    if (!renderer) {
        ADD_FAILURE() << renderer.error().text();
        return nullptr;
    }
    return std::move(*renderer);
}

/// Looks from `position` along yaw (clockwise from north) and pitch, degrees.
inline Camera make_camera(std::array<double, 3> position, double yaw, double pitch, uint32_t width = 320,
                          uint32_t height = 240, double fov = 60) {
    constexpr double kRadians = 3.14159265358979323846 / 180;
    const double y = yaw * kRadians;
    const double p = pitch * kRadians;
    Camera camera;
    camera.position = position;
    camera.forward = {std::sin(y) * std::cos(p), std::cos(y) * std::cos(p), std::sin(p)};
    camera.right = {std::cos(y), -std::sin(y), 0};
    camera.up = {-std::sin(y) * std::sin(p), -std::cos(y) * std::sin(p), std::cos(p)};
    camera.fov_y = fov * kRadians;
    camera.width = width;
    camera.height = height;
    camera.near_plane = 0.1;
    return camera;
}

inline std::vector<uint32_t> step_words(const LayerSteps& steps, size_t count = 99) {
    std::vector<uint32_t> words;
    for (size_t i = 0; i < std::min(count, steps.size()); ++i)
        words.push_back(static_cast<uint32_t>(steps[i].words.size()));
    return words;
}

inline std::vector<uint32_t> joined(const LayerSteps& steps, size_t count = 99) {
    std::vector<uint32_t> words;
    for (size_t i = 0; i < std::min(count, steps.size()); ++i) {
        words.insert(words.end(), steps[i].words.begin(), steps[i].words.end());
    }
    return words;
}

inline LayerId upload(LayerStore& store, std::span<const uint32_t> words) {
    const LayerId layer = store.create();
    const Status status = store.append(layer, words);
    EXPECT_TRUE(status.ok()) << (status.ok() ? "" : status.error().text());
    return layer;
}

/// A cheap generator with the same numbers everywhere.
struct Random {
    uint64_t state = 1;
    uint32_t next() {
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        return static_cast<uint32_t>(state >> 32);
    }
    uint32_t below(uint32_t limit) { return static_cast<uint32_t>(uint64_t{next()} * limit >> 32); }
    int32_t between(int32_t low, int32_t high) {
        return low + static_cast<int32_t>(below(static_cast<uint32_t>(high - low + 1)));
    }
    double unit() { return next() / 4294967296.0; }
};

/// Adds a quad with corners in grid units, counter-clockwise, with texture coordinates in whole repeats.
inline void add_quad(codec::mesh::MeshTile& tile, const std::array<std::array<int32_t, 3>, 4>& corners,
                     std::array<float, 3> normal, uint32_t chart, int32_t repeats_u = 1, int32_t repeats_v = 1) {
    const auto first = static_cast<uint32_t>(tile.vertices.size());
    const int32_t u[4] = {0, repeats_u << 16, repeats_u << 16, 0};
    const int32_t v[4] = {0, 0, repeats_v << 16, repeats_v << 16};
    for (size_t i = 0; i < 4; ++i) {
        codec::mesh::MeshVertex vertex{};
        for (size_t c = 0; c < 3; ++c) vertex.position[c] = corners[i][c];
        for (size_t c = 0; c < 3; ++c) vertex.normal[c] = normal[c];
        vertex.texcoord[0] = u[i];
        vertex.texcoord[1] = v[i];
        tile.vertices.push_back(vertex);
    }
    for (const uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) tile.indices.push_back(first + corner);
    tile.triangle_chart.insert(tile.triangle_chart.end(), {chart, chart});
    tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
}

/// A box [low, high] in metres with six sides, chart 0.
inline codec::mesh::MeshTile cube_tile(std::array<int32_t, 3> low, std::array<int32_t, 3> high, int32_t repeats = 1) {
    codec::mesh::MeshTile tile;
    const int32_t x0 = low[0] << 10, y0 = low[1] << 10, z0 = low[2] << 10;
    const int32_t x1 = high[0] << 10, y1 = high[1] << 10, z1 = high[2] << 10;
    add_quad(tile, {{{x0, y0, z0}, {x1, y0, z0}, {x1, y0, z1}, {x0, y0, z1}}}, {0, -1, 0}, 0, repeats, repeats);
    add_quad(tile, {{{x1, y0, z0}, {x1, y1, z0}, {x1, y1, z1}, {x1, y0, z1}}}, {1, 0, 0}, 0, repeats, repeats);
    add_quad(tile, {{{x1, y1, z0}, {x0, y1, z0}, {x0, y1, z1}, {x1, y1, z1}}}, {0, 1, 0}, 0, repeats, repeats);
    add_quad(tile, {{{x0, y1, z0}, {x0, y0, z0}, {x0, y0, z1}, {x0, y1, z1}}}, {-1, 0, 0}, 0, repeats, repeats);
    add_quad(tile, {{{x0, y0, z1}, {x1, y0, z1}, {x1, y1, z1}, {x0, y1, z1}}}, {0, 0, 1}, 0, repeats, repeats);
    add_quad(tile, {{{x0, y1, z0}, {x1, y1, z0}, {x1, y0, z0}, {x0, y0, z0}}}, {0, 0, -1}, 0, repeats, repeats);
    return tile;
}

/// A smooth picture with an orientation: red grows with u, green with v, a blue disc in the upper right.
inline codec::atlas::ChartImage test_chart(uint32_t width, uint32_t height, bool repeat = true) {
    codec::atlas::ChartImage chart;
    chart.width = width;
    chart.height = height;
    chart.repeat_u = chart.repeat_v = repeat;
    chart.metres_per_texel = 0.01f;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width;
            const double v = (y + 0.5) / height;
            const bool disc = (u - 0.7) * (u - 0.7) + (v - 0.7) * (v - 0.7) < 0.04;
            chart.rgb.push_back(static_cast<uint8_t>(40 + 180 * u));
            chart.rgb.push_back(static_cast<uint8_t>(40 + 180 * v));
            chart.rgb.push_back(disc ? 230 : 60);
        }
    }
    return chart;
}

/// A tile to draw from a mesh and an atlas, all steps resident.
inline TileDraw upload_tile(LayerStore& store, const codec::mesh::MeshTile& mesh,
                            std::span<const codec::atlas::ChartImage> charts, std::array<double, 3> origin = {}) {
    TileDraw tile;
    tile.origin = origin;
    const codec::mesh::MeshLayer layer = codec::mesh::test::layer_of(mesh);
    tile.mesh = upload(store, layer.words());
    tile.mesh_steps = layer.steps;
    tile.mesh_ranges = layer.resident.ranges;
    if (!charts.empty()) tile.atlas = upload(store, joined(codec::atlas::encode_atlas(charts)));
    return tile;
}

inline FrameImage draw_or_fail(VulkanRenderer& renderer, const Camera& camera, std::span<const TileDraw> tiles,
                               FrameTimings* timings = nullptr) {
    Result<FrameImage> image = renderer.draw(camera, tiles, timings);
    if (!image) {
        ADD_FAILURE() << image.error().text();
        return {};
    }
    return std::move(*image);
}

inline std::array<int, 3> pixel(const FrameImage& image, uint32_t x, uint32_t y) {
    const uint8_t* p = &image.rgba[4 * (size_t{y} * image.width + x)];
    return {p[0], p[1], p[2]};
}

inline double psnr(const FrameImage& a, const FrameImage& b) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        const double d = static_cast<double>(a.rgba[i]) - b.rgba[i];
        sum += d * d;
        ++count;
    }
    return sum == 0 ? 99.0 : 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / sum);
}

}  // namespace citystream::client::test
