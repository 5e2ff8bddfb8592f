// Frames against pictures that the test makes itself on the CPU.
#include <cstdlib>
#include <functional>

#include "client/render/frame_file.h"
#include "client/render/lighting_layout.h"
#include "codec/atlas/atlas_layout.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

using Vec3 = std::array<double, 3>;
constexpr Vec3 kSun = {LIGHT_SUN_X, LIGHT_SUN_Y, LIGHT_SUN_Z};

void keep(const FrameImage& image, const std::string& name) {
    const char* folder = std::getenv("CITYSTREAM_TEST_FRAMES");
    if (folder == nullptr) return;
    EXPECT_TRUE(write_png(std::string(folder) + "/" + name + ".png", image).ok());
}

double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Direction through a point of the picture (pixels from the top left), view distance 1.
Vec3 ray_through(const Camera& camera, double x, double y) {
    const double tangent = std::tan(camera.fov_y / 2);
    const double right = (2 * x / camera.width - 1) * tangent * camera.width / camera.height;
    const double up = (1 - 2 * y / camera.height) * tangent;
    Vec3 d{};
    for (size_t c = 0; c < 3; ++c) d[c] = camera.forward[c] + right * camera.right[c] + up * camera.up[c];
    return d;
}

Vec3 lit(const Vec3& texel, const Vec3& normal) {
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

FrameImage picture(const Camera& camera, const std::function<Vec3(double, double)>& colour) {
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

const Vec3 kSkyColour = {SKY_R * 255, SKY_G * 255, SKY_B * 255};

// Ground quad of 16 x 16 m at z = 0 that shows `repeats` of its chart a side.
void expect_quad_like_cpu(bool repeat, int32_t repeats, size_t atlas_steps, const Camera& camera,
                          const std::string& name) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    codec::mesh::MeshTile mesh;
    add_quad(mesh, {{{0, 0, 0}, {16 << 10, 0, 0}, {16 << 10, 16 << 10, 0}, {0, 16 << 10, 0}}}, {0, 0, 1}, 1, repeats,
             repeats);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(1, 1), test_chart(256, 128, repeat)};
    TileDraw tile = upload_tile(*renderer, mesh, {});
    const LayerSteps steps = codec::atlas::encode_atlas(charts);
    const size_t resident = std::min(atlas_steps, steps.size());
    const std::vector<uint32_t> words = joined(steps, resident);
    const auto atlas = codec::atlas::AtlasLayerView::create(words, step_words(steps, resident));
    ASSERT_TRUE(atlas.ok());
    tile.atlas = upload(*renderer, words);
    tile.atlas_finest_mip = atlas->finest_mip();
    const FrameImage gpu = draw_or_fail(*renderer, camera, std::span(&tile, 1));

    const Sampler sampler{*atlas, 1};
    const auto uv_at = [&](double x, double y) -> std::array<double, 2> {
        const Vec3 d = ray_through(camera, x, y);
        const double t = -camera.position[2] / d[2];
        return {(camera.position[0] + t * d[0]) / 16 * repeats, (camera.position[1] + t * d[1]) / 16 * repeats};
    };
    const FrameImage cpu = picture(camera, [&](double x, double y) {
        const auto uv = uv_at(x, y);
        const bool above = ray_through(camera, x, y)[2] >= 0;
        if (above || uv[0] < 0 || uv[1] < 0 || uv[0] > repeats || uv[1] > repeats) return kSkyColour;
        const auto px = uv_at(x + 0.5, y), mx = uv_at(x - 0.5, y), py = uv_at(x, y + 0.5), my = uv_at(x, y - 0.5);
        return lit(sampler(uv, {px[0] - mx[0], px[1] - mx[1]}, {py[0] - my[0], py[1] - my[1]}), {0, 0, 1});
    });
    keep(gpu, name + "_gpu");
    keep(cpu, name + "_cpu");
    EXPECT_GT(psnr(gpu, cpu), 45.0) << name;
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(MeshImage, RepeatedChartLooksLikeATextbookSampler) {
    expect_quad_like_cpu(true, 5, 99, make_camera({7, -2, 3}, 10, -25), "quad_repeat");
}

TEST(MeshImage, ClampedChartMagnifiedLooksLikeATextbookSampler) {
    expect_quad_like_cpu(false, 1, 99, make_camera({8, 6, 2}, 20, -50), "quad_clamp");
}

TEST(MeshImage, CoarseAtlasPrefixLooksLikeItsFinestResidentMip) {
    expect_quad_like_cpu(true, 2, 1, make_camera({7, -2, 6}, 0, -35), "quad_coarse");
}

// A wall of 6 x 4 m with a window, a door and a cornice, facing south at y = 0.
codec::facade::FacadeImage window_facade() {
    codec::facade::FacadeImage image{600, 400, std::vector<int16_t>(240000, 0), std::vector<uint8_t>(240000, 0)};
    const auto box = [&](uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, int16_t depth, uint8_t slot) {
        for (uint32_t y = y0; y < y1; ++y) {
            for (uint32_t x = x0; x < x1; ++x) {
                image.displacement_mm[size_t{y} * 600 + x] = depth;
                image.material[size_t{y} * 600 + x] = slot;
            }
        }
    };
    box(60, 120, 260, 300, -250, 1);
    box(150, 120, 170, 300, -150, 2);
    box(50, 100, 270, 120, 200, 2);
    box(380, 0, 500, 260, -400, 3);
    box(0, 370, 600, 400, 350, 2);
    return image;
}

struct FacadeScene {
    TileDraw tile;
    std::vector<uint32_t> map_words;
    std::vector<uint32_t> atlas_words;
    std::vector<uint32_t> atlas_sizes;
    codec::facade::Palette palette{};
};

FacadeScene facade_scene(LayerStore& store) {
    FacadeScene scene;
    scene.map_words = *codec::facade::encode_facade_map(window_facade());
    std::vector<codec::atlas::ChartImage> charts = {test_chart(64, 64), test_chart(32, 32), test_chart(128, 32),
                                                    test_chart(16, 16)};
    const LayerSteps atlas = codec::atlas::encode_atlas(charts);
    scene.atlas_words = joined(atlas);
    scene.atlas_sizes = step_words(atlas);
    for (uint32_t slot = 0; slot < FACADE_PALETTE_SLOTS; ++slot)
        scene.palette.slots[slot] = {slot % 4, 0.5f + 0.25f * static_cast<float>(slot % 4)};
    codec::facade::FacadeTile layer;
    layer.placements.push_back({{0, 0, 0}, {6 << 10, 0}, 4 << 10, 7, 0});
    layer.palettes.push_back(scene.palette);
    scene.tile.facade = upload(store, joined(codec::facade::encode_facades(layer)));
    scene.tile.facade_placements = 1;
    scene.tile.atlas = upload(store, scene.atlas_words);
    scene.tile.facade_maps = {{3, kNoLayer}, {7, upload(store, scene.map_words)}, {9, kNoLayer}};
    return scene;
}

FrameImage cast_facade_picture(const FacadeScene& scene, const Camera& camera) {
    const auto map = codec::facade::FacadeMapView::create(scene.map_words);
    const auto atlas = codec::atlas::AtlasLayerView::create(scene.atlas_words, scene.atlas_sizes);
    EXPECT_TRUE(map.ok() && atlas.ok());
    return picture(camera, [&](double x, double y) {
        // Facade space: u = 100 x, v = 100 z, w = -1000 y.
        const Vec3 origin = {camera.position[0] * 100, camera.position[2] * 100, camera.position[1] * -1000};
        const auto direction = [&](double px, double py) {
            const Vec3 d = ray_through(camera, px, py);
            return Vec3{d[0] * 100, d[2] * 100, d[1] * -1000};
        };
        const Vec3 d = direction(x, y);
        const auto hit = codec::facade::cast_facade_ray(*map, origin.data(), d.data());
        if (!hit.hit) return kSkyColour;
        const auto axis = static_cast<size_t>(hit.normal_axis);
        const auto at = [&](double px, double py) -> std::array<double, 2> {
            const Vec3 other = direction(px, py);
            const double t = hit.t * d[axis] / other[axis];
            return {origin[0] + t * other[0], origin[1] + t * other[1]};
        };
        const uint32_t slot = hit.label >> 16;
        const double scale = 0.01 / static_cast<double>(scene.palette.slots[slot].metres_per_repeat);
        const auto px = at(x + 0.5, y), mx = at(x - 0.5, y), py = at(x, y + 0.5), my = at(x, y - 0.5);
        const auto uv = at(x, y);
        Vec3 normal{};
        normal[axis == 2 ? 1 : axis == 1 ? 2 : 0] = axis == 2 ? -hit.normal_sign : hit.normal_sign;
        const Sampler sampler{*atlas, scene.palette.slots[slot].atlas_chart};
        return lit(sampler({uv[0] * scale, uv[1] * scale}, {(px[0] - mx[0]) * scale, (px[1] - mx[1]) * scale},
                           {(py[0] - my[0]) * scale, (py[1] - my[1]) * scale}),
                   normal);
    });
}

// Float and double may take different sides at the edges of the relief: few pixels, whatever their colour.
void expect_almost_equal(const FrameImage& gpu, const FrameImage& cpu, const std::string& name) {
    ASSERT_EQ(gpu.rgba.size(), cpu.rgba.size());
    size_t different = 0;
    for (size_t i = 0; i < gpu.rgba.size(); i += 4) {
        int worst = 0;
        for (size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(gpu.rgba[i + c] - cpu.rgba[i + c]));
        different += worst > 6 ? 1 : 0;
    }
    EXPECT_LE(different, gpu.rgba.size() / 4 / 200) << name;
    EXPECT_GT(psnr(gpu, cpu), 35.0) << name;
}

TEST(FacadeImage, LooksLikeRaysCastOnTheCpu) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    EXPECT_FALSE(renderer->has_facade_pipeline());
    const FacadeScene scene = facade_scene(*renderer);
    const std::vector<std::pair<std::string, Camera>> views = {
        {"facade_front", make_camera({3, -5, 2}, 0, 0)},
        {"facade_left", make_camera({-2, -3, 3}, 55, -10)},
        {"facade_right_low", make_camera({7, -2, 0.3}, -50, 20)},
        {"facade_inside_box", make_camera({1.4, -0.1, 2}, 30, 5)},
        {"facade_far", make_camera({-30, -90, 30}, 20, -17, 320, 240, 8)}};
    for (const auto& [name, camera] : views) {
        const FrameImage gpu = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
        const FrameImage cpu = cast_facade_picture(scene, camera);
        keep(gpu, name + "_gpu");
        keep(cpu, name + "_cpu");
        expect_almost_equal(gpu, cpu, name);
    }
    EXPECT_TRUE(renderer->has_facade_pipeline());
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

// Four equal walls around a block, a roof and the ground: from outside no pixel between them shows the background.
TEST(FacadeImage, CornersOfABuildingHaveNoGaps) {
    RendererOptions options = small_options();
    options.background = {1, 0, 1, 1};
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    FacadeScene scene = facade_scene(*renderer);
    codec::facade::FacadeTile layer;
    constexpr int32_t kSide = 6 << 10, kHeight = 4 << 10;
    const int32_t corner[4][2] = {{0, 0}, {kSide, 0}, {kSide, kSide}, {0, kSide}};
    for (size_t i = 0; i < 4; ++i) {
        const auto& a = corner[i];
        const auto& b = corner[(i + 1) % 4];
        layer.placements.push_back({{a[0], a[1], 0}, {b[0] - a[0], b[1] - a[1]}, kHeight, 7, 0});
    }
    layer.palettes.push_back(scene.palette);
    scene.tile.facade = upload(*renderer, joined(codec::facade::encode_facades(layer)));
    scene.tile.facade_placements = 4;
    codec::mesh::MeshTile roof;
    add_quad(roof, {{{0, 0, kHeight}, {kSide, 0, kHeight}, {kSide, kSide, kHeight}, {0, kSide, kHeight}}}, {0, 0, 1},
             0);
    // The ground behind doors that reach down to it.
    add_quad(roof, {{{0, 0, 0}, {kSide, 0, 0}, {kSide, kSide, 0}, {0, kSide, 0}}}, {0, 0, 1}, 0);
    TileDraw tile = upload_tile(*renderer, roof, {});
    tile.facade = scene.tile.facade;
    tile.facade_placements = 4;
    tile.facade_maps = scene.tile.facade_maps;
    tile.atlas = scene.tile.atlas;
    for (int i = 0; i < 24; ++i) {
        const double angle = i * 0.2617993878 + 0.01;
        const double distance = 9 + i % 5 * 7;
        const Vec3 position = {3 + distance * std::sin(angle), 3 + distance * std::cos(angle), 2.0 + i % 4};
        const double yaw = std::atan2(3 - position[0], 3 - position[1]) * 180 / 3.14159265358979323846;
        const Camera camera = make_camera(position, yaw, 0, 320, 240, 40);
        const FrameImage image = draw_or_fail(*renderer, camera, std::span(&tile, 1));
        if (i == 5) keep(image, "block");
        for (uint32_t y = 0; y < 240; ++y) {
            for (uint32_t x = 0; x < 320; ++x) {
                if (pixel(image, x, y) != std::array<int, 3>{255, 0, 255}) continue;
                // Inside the block's silhouette, shrunk a little: its side planes and its height.
                const Vec3 d = ray_through(camera, x + 0.5, y + 0.5);
                double enter = 0, leave = 1e9;
                for (size_t c = 0; c < 3; ++c) {
                    const double low = 0.02, high = c == 2 ? 3.68 : 5.98;
                    const double a = (low - camera.position[c]) / d[c], b = (high - camera.position[c]) / d[c];
                    enter = std::max(enter, std::min(a, b));
                    leave = std::min(leave, std::max(a, b));
                }
                ASSERT_GE(enter, leave) << "background shows at " << x << ", " << y << " of view " << i;
            }
        }
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

}  // namespace
}  // namespace citystream::client::test
