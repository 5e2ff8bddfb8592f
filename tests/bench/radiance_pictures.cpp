#include "tests/bench/radiance_pictures.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/render/tone.h"
#include "tiles/radiance/occluder_scene.h"
#include "tiles/radiance/visibility_bake.h"

namespace citystream::bench {

namespace {

using client::Direction;
using client::LightSum;
using tiles::radiance::SurfaceTriangle;

constexpr double kAlbedo = 0.7;
/// Of by_rays(), so many pixels are below the brightness that is shown as kShownBright.
constexpr double kShownShare = 0.98, kShownBright = 0.8;

Direction minus(const Direction& a, const Direction& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Direction cross(const Direction& a, const Direction& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Direction unit(const Direction& a) {
    const double length = std::sqrt(client::dot(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}

/// From the tile's base, grid units.
Direction from_base(const GridPoint& point, const GridPoint& base) {
    return {static_cast<double>(point.x - base.x), static_cast<double>(point.y - base.y),
            static_cast<double>(point.z - base.z)};
}

/// Corner and two edges.
struct Facet {
    Direction corner, u, v, normal;
};

/// Along a ray, in lengths of its direction; infinite where it passes by (Moeller and Trumbore 1997).
double hit(const Facet& facet, const Direction& from, const Direction& direction) {
    const Direction p = cross(direction, facet.v);
    const double determinant = client::dot(facet.u, p);
    if (determinant == 0) return HUGE_VAL;
    const Direction s = minus(from, facet.corner);
    const double a = client::dot(s, p) / determinant;
    const Direction q = cross(s, facet.u);
    const double b = client::dot(direction, q) / determinant, t = client::dot(facet.v, q) / determinant;
    return a >= 0 && b >= 0 && a + b <= 1 && t > 0 ? t : HUGE_VAL;
}

std::vector<Facet> facets_of(const TileSurroundings& tile) {
    std::vector<Facet> facets;
    for (const SurfaceTriangle& triangle : tile.own) {
        const Direction corner = from_base(triangle.corners[0], tile.base);
        const Direction u = minus(from_base(triangle.corners[1], tile.base), corner);
        const Direction v = minus(from_base(triangle.corners[2], tile.base), corner);
        const Direction normal = cross(u, v);
        if (client::dot(normal, normal) > 0) facets.push_back({corner, u, v, unit(normal)});
    }
    return facets;
}

}  // namespace

/// A camera and what it looks at.
struct TilePicture::View {
    std::vector<Facet> facets;
    Direction eye{}, forward{}, right{}, up{};

    explicit View(const TileSurroundings& tile) : facets(facets_of(tile)) {
        const double side = static_cast<double>(kTileMetres) * (1 << kGridBits);
        double top = 0;
        for (const SurfaceTriangle& triangle : tile.own) {
            for (const GridPoint& corner : triangle.corners) top = std::max(top, from_base(corner, tile.base)[2]);
        }
        eye = {-0.35 * side, -0.2 * side, top + 0.35 * side};
        forward = unit(minus({0.48 * side, 0.48 * side, 0.2 * top}, eye));
        right = unit(cross(forward, {0, 0, 1}));
        up = cross(right, forward);
    }

    /// The place a pixel shows and its normal towards the eye; false: none.
    bool look(double across, double upward, Direction& place, Direction& normal) const {
        Direction direction{};
        for (size_t c = 0; c < 3; ++c) direction[c] = forward[c] + across * right[c] + upward * up[c];
        double nearest = HUGE_VAL;
        for (const Facet& facet : facets) {
            const double t = hit(facet, eye, direction);
            if (t >= nearest || client::dot(facet.normal, direction) >= 0) continue;
            nearest = t;
            normal = facet.normal;
        }
        for (size_t c = 0; c < 3; ++c) place[c] = eye[c] + nearest * direction[c];
        return nearest < HUGE_VAL;
    }
};

Result<TilePicture> TilePicture::create(const RadianceSample& sample, uint32_t width, uint32_t height) {
    using namespace codec::radiance;
    const auto table = write_receiver_table(sample.places, sample.spacing_log2);
    if (!table) return table.error();
    const auto receivers = ReceiverTableView::create(*table);
    if (!receivers) return receivers.error();
    TilePicture picture;
    picture.width_ = width;
    picture.height_ = height;
    const View view(sample.surroundings);
    constexpr double kHalfAcross = 0.6;
    std::vector<GridPoint> points;
    std::vector<Direction> normals;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            Direction place{}, normal{};
            const double across = (2 * (x + 0.5) - width) / width * kHalfAcross;
            if (!view.look(across, (height - 2 * (y + 0.5)) / width * kHalfAcross, place, normal)) continue;
            const auto as_float = [](const Direction& d) {
                return std::array<float, 3>{static_cast<float>(d[0]), static_cast<float>(d[1]),
                                            static_cast<float>(d[2])};
            };
            const ReceiverShares shares = receivers->shares(as_float(place), as_float(normal));
            if (shares.count == 0) continue;
            const GridPoint& base = sample.surroundings.base;
            picture.pixel_.push_back(y * width + x);
            picture.shares_.push_back(shares);
            points.push_back(
                {base.x + std::llround(place[0]), base.y + std::llround(place[1]), base.z + std::llround(place[2])});
            normals.push_back(normal);
        }
    }
    if (points.empty()) return Error{"nothing of the tile is in view"};
    auto places = bake_places(points, normals, sample);
    if (!places) return places.error();
    picture.places_ = std::move(*places);
    return picture;
}

PixelLight TilePicture::between_receivers(std::span<const LightSum> irradiance) const {
    PixelLight light(shares_.size());
    for (size_t p = 0; p < light.size(); ++p) {
        for (uint32_t i = 0; i < shares_[p].count; ++i) {
            const LightSum& receiver = irradiance[shares_[p].receiver[i]];
            for (size_t c = 0; c < 3; ++c) light[p][c] += shares_[p].weight[i] * receiver[c];
        }
    }
    return light;
}

void TilePicture::cast_rays(std::span<const codec::radiance::Rgb> radiance) {
    by_rays_ = exact_irradiance(places_).irradiance(radiance);
    std::vector<double> brightness;
    for (const LightSum& sum : by_rays_) brightness.push_back(std::max({sum[0], sum[1], sum[2]}));
    const auto nearly_all =
        brightness.begin() + static_cast<std::ptrdiff_t>(kShownShare * static_cast<double>(brightness.size() - 1));
    std::nth_element(brightness.begin(), nearly_all, brightness.end());
    exposure_ = *nearly_all > 0 ? kShownBright / *nearly_all / (kAlbedo / std::numbers::pi) : 1;
}

std::vector<uint8_t> TilePicture::shown(const PixelLight& light) const {
    std::vector<uint8_t> picture(size_t{3} * width_ * height_);
    for (size_t p = 0; p < pixel_.size(); ++p) {
        std::array<double, 3> radiance{};
        for (size_t c = 0; c < 3; ++c)
            radiance[c] = exposure_ * kAlbedo / std::numbers::pi * std::max(0.0, light[p][c]);
        const auto colour = client::shown_light(radiance);
        for (size_t c = 0; c < 3; ++c)
            picture[size_t{3} * pixel_[p] + c] = static_cast<uint8_t>(std::lround(255 * std::min(1.0, colour[c])));
    }
    return picture;
}

Status TilePicture::write_png(const PixelLight& light, const std::string& file) const {
    const auto out = OIIO::ImageOutput::create(file);
    const OIIO::ImageSpec spec(static_cast<int>(width_), static_cast<int>(height_), 3, OIIO::TypeDesc::UINT8);
    const std::vector<uint8_t> picture = shown(light);
    if (!out || !out->open(file, spec) || !out->write_image(OIIO::TypeDesc::UINT8, picture.data()) || !out->close())
        return Error{file + ": cannot be written"};
    return Done{};
}

TilePicture::Difference TilePicture::difference(const PixelLight& light) const {
    double squares = 0, truth = 0, shown_squares = 0;
    const std::vector<uint8_t> made = shown(light), exact = shown(by_rays_);
    for (size_t p = 0; p < light.size(); ++p) {
        for (size_t c = 0; c < 3; ++c) {
            const double off = light[p][c] - by_rays_[p][c];
            squares += off * off;
            truth += by_rays_[p][c] * by_rays_[p][c];
            const size_t at = size_t{3} * pixel_[p] + c;
            const auto steps = static_cast<double>(int{made[at]} - int{exact[at]});
            shown_squares += steps * steps;
        }
    }
    const double mean = shown_squares / (3 * static_cast<double>(light.size()));
    return {std::sqrt(squares / std::max(truth, 1e-300)), 10 * std::log10(255.0 * 255.0 / std::max(mean, 1e-9))};
}

}  // namespace citystream::bench
