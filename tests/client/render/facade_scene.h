// One facade on a wall with its atlas, in the form that a facade renderer draws, and the picture that double-precision
// rays make of it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "client/render/facade_map_facts.h"
#include "codec/facade/facade_form.h"
#include "codec/facade/facade_ray.h"
#include "tests/client/render/pictures.h"

namespace citystream::client::test {

/// A facade of two walls' worth of texels: window, door, cornice and balcony, in and out of the wall; `open`: with a
/// gateway through it.
inline codec::facade::RunGrid window_facade(bool open = false) {
    codec::facade::FacadeMatrices matrices{600, 400, std::vector<int16_t>(240000, 0), std::vector<uint16_t>(240000, 0)};
    const auto box = [&](uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, int depth, uint32_t slot) {
        for (uint32_t y = y0; y < y1; ++y) {
            for (uint32_t x = x0; x < x1; ++x) {
                matrices.displacement_mm[size_t{y} * 600 + x] = static_cast<int16_t>(depth);
                matrices.material[size_t{y} * 600 + x] = static_cast<uint16_t>(slot);
            }
        }
    };
    box(60, 120, 260, 300, -250, 1);
    box(150, 120, 170, 300, -150, 2);
    box(50, 100, 270, 120, 200, 2);
    box(380, 0, 500, 260, -400, 3);
    box(0, 370, 600, 400, 350, 2);
    if (open) box(280, 0, 360, 240, codec::facade::kOpenDisplacement, 0);
    return *codec::facade::make_run_grid(matrices);
}

/// The same facade seen in a mirror.
inline codec::facade::RunGrid mirrored(const codec::facade::RunGrid& grid) {
    codec::facade::RunGrid other = grid;
    for (uint32_t i = 0; i <= grid.columns(); ++i) other.x_breaks[i] = grid.width() - grid.x_breaks[grid.columns() - i];
    for (uint32_t r = 0; r < grid.rows(); ++r) {
        for (uint32_t c = 0; c < grid.columns(); ++c)
            other.labels[size_t{r} * grid.columns() + c] = grid.label(grid.columns() - 1 - c, r);
    }
    return other;
}

/// The words in which a renderer gets the map: its form, raw where that refuses it, patch for the default.
inline std::vector<uint32_t> words_for(FacadeRenderer renderer, const codec::facade::RunGrid& grid) {
    using codec::facade::FacadeForm;
    const FacadeForm form = form_for(renderer).value_or(FacadeForm::kPatch);
    auto words = codec::facade::encode_form(form, grid);
    if (!words) words = codec::facade::encode_form(FacadeForm::kRaw, grid);
    EXPECT_TRUE(words.ok());
    return words ? *words : std::vector<uint32_t>();
}

/// Those whose hits are the reference's; the others are relief mapping.
inline constexpr FacadeRenderer kExactRenderers[] = {FacadeRenderer::kPatch, FacadeRenderer::kMaxMip,
                                                     FacadeRenderer::kFdm, FacadeRenderer::kCfdm,
                                                     FacadeRenderer::kBcfdm};

/// The wall of a facade: metres.
struct Wall {
    Vec3 corner = {0, 0, 0};               ///< lower left seen from outside
    std::array<double, 2> along = {6, 0};  ///< to the lower right
    double height = 4;

    codec::facade::Placement placement(uint32_t map) const {
        const auto grid = [](double metres) { return static_cast<int32_t>(std::lround(metres * 1024)); };
        return {{grid(corner[0]), grid(corner[1]), grid(corner[2])},
                {grid(along[0]), grid(along[1])},
                static_cast<uint32_t>(grid(height)),
                map,
                0};
    }
    double width() const { return std::hypot(along[0], along[1]); }
    Vec3 unit_along() const { return {along[0] / width(), along[1] / width(), 0}; }
    Vec3 outwards() const { return {along[1] / width(), -along[0] / width(), 0}; }
};

struct FacadeScene {
    codec::facade::RunGrid grid;
    Wall wall;
    TileDraw tile;
    std::vector<uint32_t> atlas_words;
    std::vector<uint32_t> atlas_sizes;
    codec::facade::Palette palette{};
};

inline std::vector<codec::atlas::ChartImage> test_charts() {
    return {test_chart(64, 64), test_chart(32, 32), test_chart(128, 32), test_chart(16, 16)};
}

/// Uploads facades on the walls, all showing `grid` (dictionary entry 7) with four charts, as one tile.
inline FacadeScene facade_scene(LayerStore& store, FacadeRenderer renderer, const codec::facade::RunGrid& grid,
                                std::span<const Wall> walls,
                                const std::vector<codec::atlas::ChartImage>& charts = test_charts()) {
    FacadeScene scene;
    scene.grid = grid;
    scene.wall = walls[0];
    const LayerSteps atlas = codec::atlas::encode_atlas(charts);
    scene.atlas_words = joined(atlas);
    scene.atlas_sizes = step_words(atlas);
    for (uint32_t slot = 0; slot < FACADE_PALETTE_SLOTS; ++slot)
        scene.palette.slots[slot] = {slot % 4, 0.5f + 0.25f * static_cast<float>(slot % 4)};
    codec::facade::FacadeTile layer;
    for (const Wall& wall : walls) layer.placements.push_back(wall.placement(7));
    layer.palettes.push_back(scene.palette);
    scene.tile.facade = upload(store, joined(codec::facade::encode_facades(layer)));
    scene.tile.atlas = upload(store, scene.atlas_words);
    scene.tile.facade_maps = {{3, kNoLayer}, {7, upload(store, words_for(renderer, grid))}, {9, kNoLayer}};
    scene.tile.map_of_placement.assign(walls.size(), 1);
    return scene;
}

/// What a ray through a pixel sees of the scene's first wall: its distance along the view direction (infinite: nothing)
/// and colour. Of the mean of several rays the other two are the centre's.
struct SeenPoint {
    double distance = std::numeric_limits<double>::infinity();
    Vec3 colour{};
    Vec3 texel{}, normal{};  ///< what it is made of
};

class FacadePainter {
  public:
    FacadePainter(const FacadeScene& scene, const Camera& camera)
        : scene_(scene),
          camera_(camera),
          depths_(scene.grid.depths()),
          finest_{finest_run(scene.grid, 0), finest_run(scene.grid, 1)},
          atlas_(codec::atlas::AtlasLayerView::create(scene.atlas_words, scene.atlas_sizes)) {
        Vec3 from_corner{};
        for (size_t c = 0; c < 3; ++c) from_corner[c] = camera.position[c] - scene.wall.corner[c];
        origin_ = to_facade(from_corner);
    }

    /// One ray; `share`: of the pixel's width and height that it stands for.
    SeenPoint look(double x, double y, double share = 1) const {
        const Vec3 d = direction(x, y);
        // Nothing nearer than the near plane is drawn: the ray starts there.
        Vec3 begin{};
        for (size_t c = 0; c < 3; ++c) begin[c] = origin_[c] + camera_.near_plane * d[c];
        const auto hit = codec::facade::cast_facade_ray(scene_.grid, depths_, begin.data(), d.data());
        if (!hit.hit) return {};
        const double distance = hit.t + camera_.near_plane;
        const auto axis = static_cast<size_t>(hit.normal_axis);
        // Neighbouring pixels' rays meet the plane of the hit.
        const auto at = [&](double px, double py) -> std::array<double, 2> {
            const Vec3 other = direction(px, py);
            const double t = distance * d[axis] / other[axis];
            return {origin_[0] + t * other[0], origin_[1] + t * other[1]};
        };
        const auto& entry = scene_.palette.slots[codec::facade::material_of(hit.label)];
        const double scale = 0.01 / static_cast<double>(entry.metres_per_repeat);
        const double half = 0.5 * share;
        const auto px = at(x + half, y), mx = at(x - half, y), py = at(x, y + half), my = at(x, y - half);
        const auto uv = at(x, y);
        Vec3 normal = axis == 0 ? scene_.wall.unit_along() : axis == 1 ? Vec3{0, 0, 1} : scene_.wall.outwards();
        for (double& c : normal) c *= hit.normal_sign;
        const Sampler sampler{*atlas_, entry.chart_word};
        const Vec3 texel = sampler({uv[0] * scale, uv[1] * scale}, {(px[0] - mx[0]) * scale, (px[1] - mx[1]) * scale},
                                   {(py[0] - my[0]) * scale, (py[1] - my[1]) * scale});
        return {distance, lit(texel, normal), texel, normal};
    }

    /// What the pixel around a point shows: the mean of its samples (facade_samples.glsl). `most`: rays of a pixel that
    /// covers more than half of the facade's finest runs.
    SeenPoint look_at_pixel(double x, double y, uint32_t most) const {
        SeenPoint centre = look(x, y);
        if (!std::isfinite(centre.distance) || most == 1 || is_resolved(x, y, centre.distance)) return centre;
        const double share = 1 / std::sqrt(most);
        const auto wrapped = [](double part) { return part > 0.5 ? part - 1 : part; };
        Vec3 sum{};
        double hits = 0;
        for (uint32_t i = 0; i < most; ++i) {
            const uint32_t row = i * (most == 5 ? 2 : 5) % most;
            const SeenPoint seen =
                look(x + wrapped(static_cast<double>(i) / most), y + wrapped(static_cast<double>(row) / most), share);
            if (!std::isfinite(seen.distance)) continue;
            for (size_t c = 0; c < 3; ++c) sum[c] += seen.colour[c];
            ++hits;
        }
        for (size_t c = 0; c < 3; ++c) centre.colour[c] = sum[c] / hits;
        return centre;
    }

  private:
    bool is_resolved(double x, double y, double distance) const {
        const Vec3 d = direction(x, y), right = direction(x + 1, y), down = direction(x, y + 1);
        for (size_t c = 0; c < 2; ++c) {
            const auto change = [&](const Vec3& other) {
                return std::abs(other[c] - d[c] - d[c] * (other[2] - d[2]) / d[2]);
            };
            if (2 * distance * (change(right) + change(down)) > finest_[c]) return false;
        }
        return true;
    }
    Vec3 to_facade(const Vec3& metres) const {
        const Vec3 along = scene_.wall.unit_along(), outwards = scene_.wall.outwards();
        return {dot(metres, along) / scene_.wall.width() * scene_.grid.width(),
                metres[2] / scene_.wall.height * scene_.grid.height(), dot(metres, outwards) * 1000};
    }
    Vec3 direction(double x, double y) const { return to_facade(ray_through(camera_, x, y)); }

    const FacadeScene& scene_;
    const Camera& camera_;
    codec::facade::DepthRange depths_;
    std::array<double, 2> finest_;  ///< texels
    Result<codec::atlas::AtlasLayerView> atlas_;
    Vec3 origin_{};
};

/// More than the default: one ray is what several come down to where facades are near.
inline constexpr uint32_t kTestedSamples = FACADE_SAMPLES;

inline FrameImage cast_facade_picture(const FacadeScene& scene, const Camera& camera,
                                      uint32_t samples = kTestedSamples) {
    const FacadePainter painter(scene, camera);
    return picture(camera, [&](double x, double y) {
        const SeenPoint seen = painter.look_at_pixel(x, y, samples);
        return std::isfinite(seen.distance) ? seen.colour : kSkyColour;
    });
}

/// Float and double may take different sides at the edges of the relief: few pixels, whatever their colour.
inline void expect_almost_equal(const FrameImage& gpu, const FrameImage& cpu, const std::string& name) {
    keep(gpu, name + "_gpu");
    keep(cpu, name + "_cpu");
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

}  // namespace citystream::client::test
