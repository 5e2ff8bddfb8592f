// What every form of a tile's atlas has to keep, seen in rendered frames: nothing bleeds from chart to chart, a chart
// that repeats looks like a texture of its own with GL_REPEAT, and editing one chart changes no pixel of another.
//
// Source: "Space-Optimized Texture Atlases" 8.1, checks 16 to 18 of the notes.
#include <algorithm>

#include "codec/atlas/page_layer.h"
#include "tests/client/render/pictures.h"

namespace citystream::client::test {
namespace {

using codec::atlas::AtlasForm;
using codec::atlas::ChartImage;
using codec::atlas::PageLayerView;

constexpr int32_t kMetre = 1 << 10;
constexpr std::array<float, 3> kToTheSun = {static_cast<float>(LIGHT_SUN_X), static_cast<float>(LIGHT_SUN_Y),
                                            static_cast<float>(LIGHT_SUN_Z)};

/// How charts become an atlas.
struct Way {
    std::string name;
    AtlasForm form = AtlasForm::kCharts;
    uint32_t mips = 0;  ///< of pages
};

LayerSteps encode(const Way& way, std::span<const ChartImage> charts) {
    if (way.form == AtlasForm::kCharts) return codec::atlas::encode_atlas(charts);
    codec::atlas::PageOptions options;
    options.mips = way.mips;
    auto pages = codec::atlas::encode_pages(charts, options);
    EXPECT_TRUE(pages.ok()) << (pages.ok() ? "" : pages.error().text());
    return pages.ok() ? std::move(pages).value() : LayerSteps();
}

TileDraw tile_of(LayerStore& store, const codec::mesh::MeshTile& mesh, const Way& way, const LayerSteps& steps,
                 size_t count = 99) {
    TileDraw tile = upload_tile(store, mesh, {});
    const auto facts = codec::atlas::check_atlas(joined(steps, count), step_words(steps, count));
    EXPECT_TRUE(facts.ok());
    tile.atlas = upload(store, joined(steps, count));
    tile.atlas_form = way.form;
    tile.atlas_finest_mip = facts.ok() ? facts->finest_mip : 0;
    return tile;
}

std::unique_ptr<VulkanRenderer> renderer_on_black(uint32_t width = 320, uint32_t height = 240) {
    RendererOptions options = small_options(width, height);
    options.background = {0, 0, 0, 1};
    return make_renderer(options);
}

/// A wall of quads of 1 x 1 m, one for each chart, `columns` in a row, facing south.
codec::mesh::MeshTile wall_of(std::span<const ChartImage> charts, int32_t columns, std::array<float, 3> normal) {
    codec::mesh::MeshTile mesh;
    for (uint32_t i = 0; i < charts.size(); ++i) {
        const int32_t x = static_cast<int32_t>(i) % columns * kMetre, z = static_cast<int32_t>(i) / columns * kMetre;
        const int32_t repeats_u = charts[i].repeat_u ? 3 : 1, repeats_v = charts[i].repeat_v ? 2 : 1;
        add_quad(mesh, {{{x, 0, z}, {x + kMetre, 0, z}, {x + kMetre, 0, z + kMetre}, {x, 0, z + kMetre}}}, normal, i,
                 repeats_u, repeats_v);
    }
    return mesh;
}

constexpr int32_t kColumns = 6, kRows = 4;

/// Charts of nothing but red, green or blue in turns, in shades, of sizes that pages have to resize and of those that
/// they take as they are; some repeat.
std::vector<ChartImage> pure_charts() {
    Random random;
    std::vector<ChartImage> charts;
    for (uint32_t i = 0; i < kColumns * kRows; ++i) {
        ChartImage chart;
        chart.width = i % 2 == 0 ? 28 : 5 + random.below(60);
        chart.height = i % 4 < 2 ? 28 : 5 + random.below(60);
        chart.repeat_u = i % 3 != 0;
        chart.repeat_v = i % 5 != 0;
        chart.metres_per_texel = 0.02F;
        chart.rgb.assign(size_t{3} * chart.width * chart.height, 0);
        const uint32_t colour = (i + i / kColumns) % 3;
        for (size_t texel = 0; texel < chart.rgb.size() / 3; ++texel)
            chart.rgb[3 * texel + colour] = static_cast<uint8_t>(120 + random.below(136));
        charts.push_back(std::move(chart));
    }
    return charts;
}

/// From close by to where a pixel covers many texels, head-on and along the wall.
std::vector<Camera> bleeding_cameras() {
    return {make_camera({3, -1.2, 2}, 0, 0),    make_camera({3, -4, 2}, 0, 0),
            make_camera({3, -16, 2}, 5, 0),     make_camera({3, -60, 2}, 0, 0, 320, 240, 20),
            make_camera({-1, -0.15, 2}, 88, 0), make_camera({3, -0.2, -2}, 0, 80),
            make_camera({7, -3, 5}, -40, -30)};
}

struct Colours {
    int foreign = 0;                 ///< greatest value of a channel that is not a pixel's largest
    std::array<size_t, 3> pixels{};  ///< by largest channel
};

Colours colours_of(const FrameImage& frame) {
    Colours seen;
    for (size_t i = 0; i < frame.rgba.size(); i += 4) {
        const uint8_t* p = &frame.rgba[i];
        const size_t largest = static_cast<size_t>(std::max_element(p, p + 3) - p);
        if (p[largest] == 0) continue;
        ++seen.pixels[largest];
        for (size_t c = 0; c < 3; ++c) seen.foreign = c == largest ? seen.foreign : std::max<int>(seen.foreign, p[c]);
    }
    return seen;
}

void expect_no_bleeding(const Way& way) {
    const auto renderer = renderer_on_black();
    ASSERT_NE(renderer, nullptr);
    const std::vector<ChartImage> charts = pure_charts();
    const codec::mesh::MeshTile mesh = wall_of(charts, kColumns, kToTheSun);
    const LayerSteps steps = encode(way, charts);
    for (size_t count = 1; count <= steps.size(); ++count) {
        const TileDraw tile = tile_of(*renderer, mesh, way, steps, count);
        size_t camera_number = 0;
        for (const Camera& camera : bleeding_cameras()) {
            const FrameImage frame = draw_or_fail(*renderer, camera, std::span(&tile, 1));
            keep(frame, way.name + "_bleeding_" + std::to_string(count) + "_" + std::to_string(camera_number++));
            const Colours seen = colours_of(frame);
            EXPECT_LE(seen.foreign, 1) << way.name << ", " << count << " steps, camera " << camera_number;
            for (const size_t pixels : seen.pixels) EXPECT_GT(pixels, 20U) << "a colour is not seen: too easy";
        }
        renderer->destroy(tile.atlas);
        renderer->destroy(tile.mesh);
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(AtlasChecks, NothingBleedsBetweenChartsOfTheirOwn) {
    expect_no_bleeding({"charts", AtlasForm::kCharts});
}

TEST(AtlasChecks, NothingBleedsBetweenChartsOfAPage) {
    for (const uint32_t mips : {0U, 1U, 2U, 4U})
        expect_no_bleeding({"pages" + std::to_string(mips), AtlasForm::kPages, mips});
}

TEST(AtlasChecks, AChartLaidOverItsNeighbourIsSeenToBleed) {
    const auto renderer = renderer_on_black();
    ASSERT_NE(renderer, nullptr);
    const std::vector<ChartImage> charts = pure_charts();
    const Way way = {"shifted", AtlasForm::kPages, 2};
    LayerSteps steps = encode(way, charts);
    const std::vector<uint32_t> words = joined(steps);
    const auto view = PageLayerView::create(words, step_words(steps));
    ASSERT_TRUE(view.ok());
    ASSERT_EQ(view->page_count(), 1U);
    const size_t table = PAGES_HEADER_WORDS + PAGES_PAGE_WORDS;
    for (size_t i = 0; i < charts.size(); ++i) {
        uint32_t& u = steps[0].words[table + PAGES_CHART_WORDS * i + PAGES_CHART_U];
        const uint32_t moved = u + (1U << 22);  // by four texels, twice the border
        if (codec::atlas::check_wrap_axis(moved, view->border(), view->width(0)).ok()) u = moved;
    }
    const TileDraw tile = tile_of(*renderer, wall_of(charts, kColumns, kToTheSun), way, steps);
    const FrameImage frame = draw_or_fail(*renderer, bleeding_cameras()[1], std::span(&tile, 1));
    EXPECT_GT(colours_of(frame).foreign, 60);
}

constexpr uint32_t kWallWidth = 60, kWallHeight = 44;  // what a page of M = 2 takes as it is
constexpr int32_t kTilesU = 7, kTilesV = 5;
constexpr std::array<std::array<uint8_t, 3>, 2> kCellColours = {{{33, 203, 33}, {222, 40, 222}}};

/// Cells of 8 x 8 texels in two colours that BC1 keeps exactly, laid so that cells go on across the chart's ends, and
/// so that no texel of the levels 0 and 1, and none of level 2 of a page, lies in two of them.
ChartImage cells() {
    ChartImage chart{kWallWidth, kWallHeight, true, true, 0.01F, {}};
    for (uint32_t y = 0; y < kWallHeight; ++y) {
        for (uint32_t x = 0; x < kWallWidth; ++x) {
            const uint32_t column = (x + 6) % kWallWidth / 8, row = (y + 6) % kWallHeight / 8;
            const auto& colour = kCellColours[(column * 5 + row * 3 + column * row) % 7 < 3 ? 1 : 0];
            chart.rgb.insert(chart.rgb.end(), colour.begin(), colour.end());
        }
    }
    return chart;
}

/// A texture of its own: levels with their texels' offset from the texture's start, and GL_REPEAT by modulo.
struct RepeatedTexture {
    struct Level {
        int width = 0, height = 0;
        double shift = 0;  ///< texels of the level from its texel 0 to the texture's start
        std::vector<std::array<uint8_t, 3>> texels;
    };
    std::vector<Level> levels;

    static RepeatedTexture of(ChartImage image, size_t count) {
        RepeatedTexture texture;
        while (true) {
            Level level{static_cast<int>(image.width), static_cast<int>(image.height), 0, {}};
            for (size_t i = 0; i < image.rgb.size(); i += 3)
                level.texels.push_back({image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]});
            texture.levels.push_back(std::move(level));
            if (texture.levels.size() == count) return texture;
            image = codec::atlas::downsample(image);
        }
    }

    /// The texels of a chart of a page: each of them once, without what its border repeats.
    static RepeatedTexture of(const PageLayerView& view, uint32_t chart) {
        RepeatedTexture texture;
        const codec::atlas::PageChart own = view.chart(chart);
        const codec::atlas::ChartFrame frame = frame_of(own.packed, view.border());
        const auto x = static_cast<uint32_t>(frame.origin_u), y = static_cast<uint32_t>(frame.origin_v);
        for (uint32_t mip = 0; mip <= view.mips(); ++mip) {
            Level level{static_cast<int>(frame.size_u) >> mip, static_cast<int>(frame.size_v) >> mip, 0, {}};
            level.shift = static_cast<double>(x) / (1 << mip) - (x >> mip);
            EXPECT_EQ(level.shift, static_cast<double>(y) / (1 << mip) - (y >> mip));
            for (int row = 0; row < level.height; ++row) {
                for (int column = 0; column < level.width; ++column) {
                    auto& texel = level.texels.emplace_back();
                    view.texel(own.page, mip, (x >> mip) + static_cast<uint32_t>(column),
                               (y >> mip) + static_cast<uint32_t>(row), texel.data());
                }
            }
            texture.levels.push_back(std::move(level));
        }
        return texture;
    }

    Vec3 bilinear(const Level& level, const std::array<double, 2>& uv) const {
        const double x = uv[0] * level.width + level.shift - 0.5, y = uv[1] * level.height + level.shift - 0.5;
        const auto wrapped = [](double i, int size) { return ((static_cast<int>(i) % size) + size) % size; };
        Vec3 sum{};
        for (int k = 0; k < 4; ++k) {
            const int column = wrapped(std::floor(x) + k % 2, level.width);
            const int row = wrapped(std::floor(y) + k / 2, level.height);
            const double weight = (k % 2 != 0 ? x - std::floor(x) : 1 - (x - std::floor(x))) *
                                  (k / 2 != 0 ? y - std::floor(y) : 1 - (y - std::floor(y)));
            for (size_t c = 0; c < 3; ++c)
                sum[c] += weight * level.texels[static_cast<size_t>(row * level.width + column)][c];
        }
        return sum;
    }

    /// Trilinear; dx, dy: change of the place from pixel to pixel; finest: level that is resident.
    Vec3 operator()(const std::array<double, 2>& uv, double texels_per_pixel, uint32_t finest) const {
        const double lod = std::clamp(std::log2(texels_per_pixel), static_cast<double>(finest),
                                      static_cast<double>(levels.size() - 1));
        const auto level = static_cast<size_t>(lod);
        const Vec3 a = bilinear(levels[level], uv);
        if (lod == static_cast<double>(level)) return a;
        const Vec3 b = bilinear(levels[level + 1], uv);
        Vec3 out{};
        for (size_t c = 0; c < 3; ++c) out[c] = a[c] + (b[c] - a[c]) * (lod - static_cast<double>(level));
        return out;
    }
};

struct Difference {
    size_t pixels = 0, above_one = 0;
    int greatest = 0;
};

/// Pixels well inside a wall of 7 x 5 m in the plane y = 0 whose every square metre is one repeat.
Difference compare(const FrameImage& frame, const Camera& camera, const RepeatedTexture& texture, uint32_t finest) {
    const auto uv_at = [&](double x, double y) -> std::array<double, 2> {
        const Vec3 d = ray_through(camera, x, y);
        const double t = -camera.position[1] / d[1];
        return {camera.position[0] + t * d[0], camera.position[2] + t * d[2]};
    };
    const auto inside = [](const std::array<double, 2>& uv) {
        return uv[0] > 0 && uv[1] > 0 && uv[0] < kTilesU && uv[1] < kTilesV;
    };
    Difference out;
    for (uint32_t y = 1; y + 1 < frame.height; ++y) {
        for (uint32_t x = 1; x + 1 < frame.width; ++x) {
            const double px = x + 0.5, py = y + 0.5;
            if (ray_through(camera, px, py)[1] <= 0 || !inside(uv_at(px - 1, py)) || !inside(uv_at(px + 1, py)) ||
                !inside(uv_at(px, py - 1)) || !inside(uv_at(px, py + 1)))
                continue;
            const auto left = uv_at(px - 0.5, py), right = uv_at(px + 0.5, py);
            const auto up = uv_at(px, py - 0.5), down = uv_at(px, py + 0.5);
            const double rho =
                std::max(std::hypot((right[0] - left[0]) * kWallWidth, (right[1] - left[1]) * kWallHeight),
                         std::hypot((down[0] - up[0]) * kWallWidth, (down[1] - up[1]) * kWallHeight));
            const Vec3 expected = lit(texture(uv_at(px, py), rho, finest), {0, -1, 0});
            const auto got = pixel(frame, x, y);
            int worst = 0;
            for (size_t c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(got[c] - static_cast<int>(std::lround(expected[c]))));
            ++out.pixels;
            out.above_one += worst > 1 ? 1 : 0;
            out.greatest = std::max(out.greatest, worst);
        }
    }
    return out;
}

/// The wall of 7 x 5 repeats among other charts.
struct TiledWall {
    std::vector<ChartImage> charts = {test_chart(28, 12), cells(), test_chart(44, 60)};
    codec::mesh::MeshTile mesh;
    TiledWall() {
        add_quad(
            mesh,
            {{{0, 0, 0}, {kTilesU * kMetre, 0, 0}, {kTilesU * kMetre, 0, kTilesV * kMetre}, {0, 0, kTilesV * kMetre}}},
            {0, -1, 0}, 1, kTilesU, kTilesV);
    }
};

/// Head-on, where the level of detail is the same in the whole picture: texels of many pixels, of one, of half a one.
std::vector<Camera> head_on_cameras() {
    return {make_camera({3.03, -1.1, 2.47}, 0, 0), make_camera({3.5, -3, 2.5}, 0, 0),
            make_camera({3.41, -4.4, 2.53}, 0, 0), make_camera({3.5, -5.9, 2.4}, 0, 0)};
}

void expect_like_texture(VulkanRenderer& renderer, const TileDraw& tile, const std::vector<Camera>& cameras,
                         const RepeatedTexture& texture, const std::string& name) {
    size_t number = 0;
    for (const Camera& camera : cameras) {
        const FrameImage frame = draw_or_fail(renderer, camera, std::span(&tile, 1));
        keep(frame, name + std::to_string(number));
        const Difference difference = compare(frame, camera, texture, tile.atlas_finest_mip);
        EXPECT_GT(difference.pixels, 5000U);
        EXPECT_LE(difference.above_one * 1000, difference.pixels) << name << ", camera " << number;
        EXPECT_LE(difference.greatest, 2) << name << ", camera " << number;
        ++number;
    }
    EXPECT_EQ(renderer.validation_messages(), 0u);
}

TEST(AtlasChecks, AWallTiledFromTheAtlasIsThatOfATextureOfItsOwn) {
    const TiledWall wall;
    const RepeatedTexture texture = RepeatedTexture::of(cells(), 2);
    for (const Way& way : {Way{"charts_wrap", AtlasForm::kCharts}, Way{"pages_wrap", AtlasForm::kPages, 2}}) {
        const auto renderer = renderer_on_black();
        ASSERT_NE(renderer, nullptr);
        const TileDraw tile = tile_of(*renderer, wall.mesh, way, encode(way, wall.charts));
        expect_like_texture(*renderer, tile, head_on_cameras(), texture, way.name);
    }
}

TEST(AtlasChecks, AWallTiledFromPagesHasNoSeamAtAnyLevel) {
    const TiledWall wall;
    const Way way = {"pages_levels", AtlasForm::kPages, 2};
    const LayerSteps steps = encode(way, wall.charts);
    const std::vector<uint32_t> words = joined(steps);
    const auto view = PageLayerView::create(words, step_words(steps));
    ASSERT_TRUE(view.ok());
    const RepeatedTexture texture = RepeatedTexture::of(*view, 1);
    for (const auto& level : texture.levels) {
        for (const auto& texel : level.texels)
            ASSERT_TRUE(texel == kCellColours[0] || texel == kCellColours[1]) << "not kept exactly: the test is wrong";
    }
    const auto renderer = renderer_on_black();
    ASSERT_NE(renderer, nullptr);
    std::vector<Camera> cameras = head_on_cameras();
    cameras.push_back(make_camera({3.5, -11, 2.5}, 0, 0, 320, 240, 45));
    cameras.push_back(make_camera({3.5, -30, 2.5}, 0, 0, 320, 240, 16));
    expect_like_texture(*renderer, tile_of(*renderer, wall.mesh, way, steps), cameras, texture, "levels");
    // The coarsest level alone, where the border is half a texel: also along the wall.
    cameras = {make_camera({-0.5, -0.6, 2.5}, 80, 0), make_camera({3.5, -0.8, -0.5}, 0, 70),
               make_camera({8, -2, 6}, -50, -25)};
    expect_like_texture(*renderer, tile_of(*renderer, wall.mesh, way, steps, 1), cameras, texture, "coarsest");
}

void expect_edits_to_stay_in_their_chart(const Way& way) {
    const auto renderer = renderer_on_black();
    ASSERT_NE(renderer, nullptr);
    constexpr uint32_t kEdited = 9;
    std::vector<ChartImage> charts, edited;
    Random random;
    for (uint32_t i = 0; i < kColumns * kRows; ++i) {
        charts.push_back(test_chart(8 + random.below(50), 8 + random.below(50), i % 2 == 0));
        for (uint8_t& value : charts.back().rgb) value = static_cast<uint8_t>(value + random.below(16));
    }
    edited = charts;
    for (uint8_t& value : edited[kEdited].rgb) value = static_cast<uint8_t>(20 + random.below(230));
    const codec::mesh::MeshTile mesh = wall_of(charts, kColumns, kToTheSun);
    codec::mesh::MeshTile only = mesh;
    only.indices.assign(mesh.indices.begin() + 6 * kEdited, mesh.indices.begin() + 6 * kEdited + 6);
    only.triangle_chart.assign(2, kEdited);
    only.dressed_begin = 2;
    const LayerSteps before_steps = encode(way, charts), after_steps = encode(way, edited);
    const TileDraw before = tile_of(*renderer, mesh, way, before_steps);
    const TileDraw after = tile_of(*renderer, mesh, way, after_steps);
    const TileDraw alone = tile_of(*renderer, only, way, before_steps);
    for (const Camera& camera : bleeding_cameras()) {
        const FrameImage a = draw_or_fail(*renderer, camera, std::span(&before, 1));
        const FrameImage b = draw_or_fail(*renderer, camera, std::span(&after, 1));
        const FrameImage mask = draw_or_fail(*renderer, camera, std::span(&alone, 1));
        size_t of_it = 0, changed = 0, changed_elsewhere = 0;
        for (size_t i = 0; i < a.rgba.size(); i += 4) {
            const bool its = mask.rgba[i] != 0, differs = !std::equal(&a.rgba[i], &a.rgba[i] + 4, &b.rgba[i]);
            of_it += its ? 1 : 0;
            changed += its && differs ? 1 : 0;
            changed_elsewhere += !its && differs ? 1 : 0;
        }
        EXPECT_EQ(changed_elsewhere, 0U) << way.name;
        EXPECT_GT(2 * changed, of_it) << "the edit is not seen: too easy";
        EXPECT_GT(of_it, 10U);
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(AtlasChecks, EditingAChartChangesNoPixelOfAnother) {
    expect_edits_to_stay_in_their_chart({"charts_edit", AtlasForm::kCharts});
    for (const uint32_t mips : {0U, 2U, 3U})
        expect_edits_to_stay_in_their_chart({"pages_edit" + std::to_string(mips), AtlasForm::kPages, mips});
}

}  // namespace
}  // namespace citystream::client::test
