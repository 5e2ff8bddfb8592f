// Made-up tiles with a baked radiance layer, lights for them, and the picture that rays on the CPU make of both.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "client/render/frame_light.h"
#include "client/render/light_constants.h"
#include "client/render/tone.h"
#include "codec/chart_word_layout.h"
#include "codec/radiance/irradiance.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/source_directions.h"
#include "tests/client/render/pictures.h"
#include "tests/tiles/radiance/box_city.h"
#include "tiles/radiance/visibility_bake.h"

namespace citystream::client::test {

using tiles::radiance::test::Surface;

inline constexpr uint32_t kLitTexels = 16, kLitLocals = 8;
inline constexpr uint32_t kLitSpacingLog2 = 12;  ///< 4 m
inline constexpr Vec3 kAlbedo = {200, 150, 100};

inline double pi() {
    return std::acos(-1.0);
}

/// One renderer for the tests of a file, made when first asked for: compiling shaders takes longer than drawing with
/// them.
class SharedRenderer : public testing::Environment {
  public:
    explicit SharedRenderer(const RendererOptions& options) : options_(options) {}
    void TearDown() override { renderer_.reset(); }
    VulkanRenderer* get() {
        if (renderer_ == nullptr) renderer_ = make_renderer(options_);
        return renderer_.get();
    }

  private:
    RendererOptions options_;
    std::unique_ptr<VulkanRenderer> renderer_;
};

inline uint64_t next_light_number() {
    static uint64_t lights = 0;
    return ++lights;
}

/// A light of which `radiance` is what comes from each direction, with a number of its own.
template <typename Radiance>
FrameLight light_of(const Radiance& radiance, uint32_t map_width = 64) {
    FrameLight light;
    light.number = next_light_number();
    light.texels_across = kLitTexels;
    std::vector<codec::radiance::Rgb> texels;
    for (uint32_t texel = 0; texel < codec::radiance::texel_count(kLitTexels); ++texel) {
        const auto at = codec::radiance::cell_direction(kLitTexels, texel);
        Direction unit{};
        double length = 0;
        for (size_t i = 0; i < 3; ++i) length += static_cast<double>(at[i]) * static_cast<double>(at[i]);
        for (size_t i = 0; i < 3; ++i) unit[i] = static_cast<double>(at[i]) / std::sqrt(length);
        texels.push_back(radiance(unit));
    }
    light.sky = codec::radiance::whole_light(codec::radiance::weighted_light(texels, kLitTexels));
    light.background.width = map_width;
    light.background.height = map_width / 2;
    for (uint32_t row = 0; row < map_width / 2; ++row) {
        for (uint32_t column = 0; column < map_width; ++column)
            light.background.texels.push_back(
                radiance(map_direction(map_width, map_width / 2, column + 0.5, row + 0.5)));
    }
    light.ambient = harmonic_light(light.background);
    return light;
}

inline FrameLight uniform_light(Rgb radiance = {1, 1, 1}) {
    return light_of([&](const Direction&) { return radiance; });
}

/// Bright and blue above, dark and brown below, brighter in the east.
inline FrameLight day_light() {
    return light_of([](const Direction& d) -> Rgb {
        const double up = std::max(d[2], 0.0), east = 0.5 + 0.5 * d[0], low = d[2] < 0 ? 0.25 : 1;
        return {static_cast<float>(low * (0.4 + 0.5 * east)), static_cast<float>(low * (0.5 + 0.2 * east + 0.2 * up)),
                static_cast<float>(low * (0.5 + 0.6 * up))};
    });
}

/// Triangles of a tile as a mesh of one colour; places count from its origin.
inline codec::mesh::MeshTile mesh_of(const Surface& surface, const GridPoint& origin) {
    codec::mesh::MeshTile tile;
    const auto byte = [](double value) { return static_cast<uint32_t>(value); };
    const uint32_t colour = CHART_WORD_COLOUR | byte(kAlbedo[0]) | byte(kAlbedo[1]) << 8 | byte(kAlbedo[2]) << 16;
    for (const auto& triangle : surface) {
        const auto normal = tiles::radiance::test::unit_normal(triangle);
        for (const GridPoint& corner : triangle.corners) {
            codec::mesh::MeshVertex vertex{};
            vertex.position[0] = static_cast<int32_t>(corner.x - origin.x);
            vertex.position[1] = static_cast<int32_t>(corner.y - origin.y);
            vertex.position[2] = static_cast<int32_t>(corner.z - origin.z);
            for (size_t c = 0; c < 3; ++c) vertex.normal[c] = static_cast<float>(normal[c]);
            tile.indices.push_back(static_cast<uint32_t>(tile.vertices.size()));
            tile.vertices.push_back(vertex);
        }
        tile.triangle_chart.push_back(colour);
    }
    tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
    return tile;
}

struct LitTile {
    Surface surface;
    GridPoint origin;
    std::vector<uint32_t> words;  ///< of its radiance layer; none: it has no such layer
};

/// Bakes the layer, codes it and reads it back, all steps.
inline LitTile lit_tile(const Surface& own, const Surface& around, const GridPoint& origin) {
    tiles::radiance::BakeOptions options;
    options.texels_across = kLitTexels;
    options.lattice = {.spacing = int64_t{1} << kLitSpacingLog2, .jobs = 2};
    const auto baked = tiles::radiance::bake_tile({own, around}, options);
    EXPECT_TRUE(baked.ok());
    if (!baked) return {own, origin, {}};
    const codec::radiance::RadianceTile tile = {
        kLitSpacingLog2, tiles::radiance::places_of(baked->receivers, origin, int64_t{1} << kLitSpacingLog2),
        baked->visibility};
    const auto steps = codec::radiance::encode_radiance_layer(tile, kLitLocals, 1);
    EXPECT_TRUE(steps.ok()) << (steps ? "" : steps.error().text());
    if (!steps) return {own, origin, {}};
    std::vector<std::span<const std::byte>> wire;
    uint64_t bytes = 0;
    for (const auto& step : *steps) {
        wire.emplace_back(step.wire);
        bytes += step.decoded_bytes;
    }
    const auto words = codec::radiance::decode_radiance_layer(wire, bytes, codec::radiance::MatrixForm::kBiclusters);
    EXPECT_TRUE(words.ok()) << (words ? "" : words.error().text());
    return {own, origin, words ? *words : std::vector<uint32_t>()};
}

inline TileDraw upload_lit(LayerStore& store, const LitTile& tile) {
    const auto metres = [](int64_t units) { return static_cast<double>(units) / 1024; };
    TileDraw draw = upload_tile(store, mesh_of(tile.surface, tile.origin), {},
                                {metres(tile.origin.x), metres(tile.origin.y), metres(tile.origin.z)});
    if (!tile.words.empty()) draw.radiance = upload(store, tile.words);
    return draw;
}

/// Where a ray first meets triangles: distance in the ray's lengths, which one.
struct Meeting {
    double t = std::numeric_limits<double>::infinity();
    size_t tile = 0, triangle = 0;
};

inline Vec3 metres_of(const GridPoint& point) {
    return {static_cast<double>(point.x) / 1024, static_cast<double>(point.y) / 1024,
            static_cast<double>(point.z) / 1024};
}

inline Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Möller and Trumbore, both sides.
inline std::optional<double> meets(const tiles::radiance::SurfaceTriangle& triangle, const Vec3& from, const Vec3& d) {
    const Vec3 p = metres_of(triangle.corners[0]);
    const Vec3 u = minus(metres_of(triangle.corners[1]), p), v = minus(metres_of(triangle.corners[2]), p);
    const Vec3 h = cross(d, v);
    const double determinant = dot(u, h);
    if (std::abs(determinant) < 1e-12) return {};
    const Vec3 s = minus(from, p), q = cross(s, u);
    const double a = dot(s, h) / determinant, b = dot(d, q) / determinant, t = dot(v, q) / determinant;
    if (a < 0 || b < 0 || a + b > 1 || t <= 1e-6) return {};
    return t;
}

/// The light of surfaces on the CPU: the lookup of receiver_table.h in double, with the CPU's irradiance.
class LitPainter {
  public:
    LitPainter(std::span<const LitTile> tiles, const FrameLight& light)
        : tiles_(tiles),
          light_(light),
          unit_(codec::radiance::irradiance_unit(light.sky)),
          constants_(light_constants(light, unit_, 1)) {
        for (const LitTile& tile : tiles) {
            irradiance_.emplace_back();
            tables_.emplace_back();
            if (tile.words.empty()) continue;
            const auto view = codec::radiance::RadianceLayerView::create(tile.words);
            EXPECT_TRUE(view.ok());
            if (!view) continue;
            irradiance_.back() = codec::radiance::irradiance_words(*view, light.sky);
            tables_.back() = *codec::radiance::ReceiverTableView::create(view->table());
        }
    }

    Meeting meeting(const Vec3& from, const Vec3& d) const {
        Meeting nearest;
        for (size_t i = 0; i < tiles_.size(); ++i) {
            for (size_t k = 0; k < tiles_[i].surface.size(); ++k) {
                const auto t = meets(tiles_[i].surface[k], from, d);
                if (t && *t < nearest.t) nearest = {*t, i, k};
            }
        }
        return nearest;
    }

    /// Irradiance of the sky over pi, times exposure.
    Vec3 sky_at(size_t tile, const Vec3& point, const Vec3& normal) const {
        const auto& table = tables_[tile];
        if (!table) return open_sky_light(constants_, normal);
        const Vec3 origin = metres_of(tiles_[tile].origin);
        std::array<float, 3> place{}, across{};
        for (size_t c = 0; c < 3; ++c) {
            place[c] = static_cast<float>((point[c] - origin[c]) * 1024);
            across[c] = static_cast<float>(normal[c]);
        }
        const auto shares = table->shares(place, across);
        if (shares.count == 0) return open_sky_light(constants_, normal);
        Vec3 sum{};
        for (uint32_t k = 0; k < shares.count; ++k) {
            const auto irradiance = codec::radiance::irradiance_of(irradiance_[tile], shares.receiver[k], unit_);
            for (size_t c = 0; c < 3; ++c)
                sum[c] += static_cast<double>(shares.weight[k]) * static_cast<double>(irradiance[c]);
        }
        for (double& value : sum) value *= static_cast<double>(light_.exposure) / pi();
        if (shares.own_surface) return sum;
        const auto& [x, y, z] = shares.normal;
        const double length = std::hypot(x, y, z);
        const Vec3 here = open_sky_light(constants_, normal),
                   there = open_sky_light(constants_, {x / length, y / length, z / length});
        for (size_t c = 0; c < 3; ++c) sum[c] *= std::min(here[c] / std::max(there[c], 1e-9), 4.0);
        return sum;
    }

    bool is_in_sun(const Meeting& where, const Vec3& point) const {
        const auto normal = tiles::radiance::test::unit_normal(tiles_[where.tile].surface[where.triangle]);
        if (dot(normal, light_.sun->direction) <= 0) return false;
        Vec3 from = point;
        for (size_t c = 0; c < 3; ++c) from[c] += 1e-4 * normal[c];
        return std::isinf(meeting(from, light_.sun->direction).t);
    }

    /// What a surface shows, 0..255.
    Vec3 colour(const Meeting& where, const Vec3& point) const {
        const auto normal = tiles::radiance::test::unit_normal(tiles_[where.tile].surface[where.triangle]);
        Vec3 light = sky_at(where.tile, point, normal);
        if (light_.sun && is_in_sun(where, point)) {
            for (size_t c = 0; c < 3; ++c)
                light[c] += static_cast<double>(light_.exposure) / pi() * light_.sun->irradiance[c] *
                            dot(normal, light_.sun->direction);
        }
        for (size_t c = 0; c < 3; ++c) light[c] *= srgb_decoded(kAlbedo[c] / 255);
        Vec3 shown = shown_light(light);
        for (double& value : shown) value *= 255;
        return shown;
    }

  private:
    std::span<const LitTile> tiles_;
    const FrameLight& light_;
    std::array<float, 3> unit_;
    LightConstants constants_;
    std::vector<std::vector<uint32_t>> irradiance_;
    std::vector<std::optional<codec::radiance::ReceiverTableView>> tables_;
};

/// How far a frame is from the painter's, over pixels whose neighbours show the same triangle.
struct PictureMatch {
    uint32_t pixels = 0, off = 0;  ///< off by more than 2 of 255
    double worst = 0;
};

inline Vec3 along(const Vec3& from, const Vec3& d, double t) {
    return {from[0] + t * d[0], from[1] + t * d[1], from[2] + t * d[2]};
}

/// `taken`: whether a point is compared.
template <typename Taken>
PictureMatch match(const FrameImage& image, const Camera& camera, const LitPainter& painter, const Taken& taken) {
    std::vector<Meeting> seen(size_t{image.width} * image.height);
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x)
            seen[size_t{y} * image.width + x] = painter.meeting(camera.position, ray_through(camera, x + 0.5, y + 0.5));
    }
    PictureMatch result;
    for (uint32_t y = 1; y + 1 < image.height; ++y) {
        for (uint32_t x = 1; x + 1 < image.width; ++x) {
            const Meeting& here = seen[size_t{y} * image.width + x];
            bool inside = std::isfinite(here.t);
            for (int k = 0; inside && k < 9; ++k) {
                const size_t row = y + static_cast<uint32_t>(k / 3) - 1, column = x + static_cast<uint32_t>(k % 3) - 1;
                const Meeting& other = seen[row * image.width + column];
                inside = std::isfinite(other.t) && other.tile == here.tile && other.triangle == here.triangle;
            }
            if (!inside) continue;
            const Vec3 point = along(camera.position, ray_through(camera, x + 0.5, y + 0.5), here.t);
            if (!taken(here, point)) continue;
            const Vec3 expected = painter.colour(here, point);
            const auto shown = pixel(image, x, y);
            double worst = 0;
            for (size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(expected[c] - shown[c]));
            ++result.pixels;
            result.off += worst > 2 ? 1 : 0;
            result.worst = std::max(result.worst, worst);
        }
    }
    return result;
}

}  // namespace citystream::client::test
