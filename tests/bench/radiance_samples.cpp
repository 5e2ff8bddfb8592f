#include "tests/bench/radiance_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "codec/radiance/frames.h"
#include "tests/bench/measure.h"
#include "tests/tiles/radiance/box_city.h"
#include "tiles/radiance/clipped_polygon.h"
#include "tiles/radiance/visibility_bake.h"

namespace citystream::bench {

namespace {

using namespace tiles::radiance;
using codec::radiance::VisibilityTile;
using Vector = std::array<double, 3>;

constexpr uint32_t kMeshBits = 16;
constexpr int64_t kTileSide = kTileMetres << kGridBits, kBaseStep = int64_t{64} << kGridBits;
using TileNumber = std::array<int64_t, 2>;

Vector normal_of(const Receiver& receiver) {
    return receiver_normal(receiver.surface_class, receiver.tilt);
}

RadianceSample sample_of(BakedTile&& tile, double seconds) {
    RadianceSample sample{std::move(tile.visibility), {}, seconds};
    for (const Receiver& receiver : tile.receivers) sample.normals.push_back(normal_of(receiver));
    return sample;
}

BakeOptions bake_options(const SampleOptions& options) {
    BakeOptions bake;
    bake.lattice.spacing = to_grid(options.lattice_metres);
    bake.texels_across = options.texels_across;
    return bake;
}

/// A tile's south-west corner and base height; places count from there.
GridPoint base_of(const TileNumber& tile, std::span<const SurfaceTriangle> own) {
    int64_t lowest = own.empty() ? 0 : own[0].corners[0].z;
    for (const SurfaceTriangle& triangle : own) {
        for (const GridPoint& corner : triangle.corners) lowest = std::min(lowest, corner.z);
    }
    const int64_t steps = lowest >= 0 ? lowest / kBaseStep : -((-lowest - 1) / kBaseStep) - 1;
    return {tile[0] * kTileSide, tile[1] * kTileSide, steps * kBaseStep};
}

Result<RadianceSample> bake(TileSurroundings&& tile, const TileNumber& number, const SampleOptions& options) {
    Result<BakedTile> baked = Error{"not baked"};
    const double seconds = seconds_of([&] {
        baked = bake_tile({tile.own, tile.around, tile.heights.get()}, bake_options(options));
    });
    if (!baked) return baked.error();
    tile.base = base_of(number, tile.own);
    const int64_t spacing = to_grid(options.lattice_metres);
    const auto places = places_of(baked->receivers, tile.base, spacing);
    RadianceSample sample = sample_of(std::move(*baked), seconds);
    sample.spacing_log2 = static_cast<uint32_t>(std::countr_zero(static_cast<uint64_t>(spacing)));
    sample.places = places;
    sample.surroundings = std::move(tile);
    return sample;
}

/// Of a normal that is not zero, as a receiver holds it.
Receiver receiver_at(const GridPoint& point, const Vector& normal) {
    uint32_t own = 0;
    for (uint32_t axis = 1; axis < 3; ++axis) {
        if (std::abs(normal[axis]) > std::abs(normal[own])) own = axis;
    }
    Receiver receiver;
    receiver.surface_class = static_cast<uint8_t>(2 * own + (normal[own] < 0 ? 1 : 0));
    const auto axes = class_axes(receiver.surface_class);
    for (size_t i = 0; i < 2; ++i)
        receiver.tilt[i] = static_cast<int8_t>(std::lround(kTiltOne * normal[axes[i + 1]] / std::abs(normal[own])));
    receiver.point = point;
    return receiver;
}

/// Bits of the coordinates in turn.
uint64_t morton_code(const GridPoint& point) {
    uint64_t code = 0;
    for (uint32_t bit = 0; bit <= kMeshBits; ++bit) {
        code |= (static_cast<uint64_t>(point.x) >> bit & 1) << 3 * bit;
        code |= (static_cast<uint64_t>(point.y) >> bit & 1) << (3 * bit + 1);
        code |= (static_cast<uint64_t>(point.z) >> bit & 1) << (3 * bit + 2);
    }
    return code;
}

std::vector<Receiver> receivers_at_vertices(const std::vector<GridPoint>& points,
                                            const std::vector<std::array<uint32_t, 3>>& triangles, uint32_t most) {
    std::vector<Vector> normals(points.size());
    for (const auto& corners : triangles) {
        const auto normal = exact_normal({{points[corners[0]], points[corners[1]], points[corners[2]]}});
        for (const uint32_t corner : corners) {
            for (size_t c = 0; c < 3; ++c) normals[corner][c] += static_cast<double>(normal[c]);
        }
    }
    std::vector<uint32_t> order;
    for (uint32_t v = 0; v < points.size(); ++v) {
        if (normals[v] != Vector{}) order.push_back(v);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return morton_code(points[a]) < morton_code(points[b]); });
    const size_t count = std::min<size_t>(order.size(), most);
    std::vector<Receiver> receivers;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t v = order[i * order.size() / count];
        receivers.push_back(receiver_at(points[v], normals[v]));
    }
    return receivers;
}

/// A triangle's part within a square of the tile grid, as triangles.
void add_part(const SurfaceTriangle& triangle, const std::array<int64_t, 2>& tile,
              std::vector<SurfaceTriangle>& parts) {
    const int64_t west = tile[0] * kTileSide, south = tile[1] * kTileSide;
    ClippedPolygon polygon;
    for (const GridPoint& corner : triangle.corners)
        polygon.add({static_cast<double>(corner.x - west), static_cast<double>(corner.y - south),
                     static_cast<double>(corner.z)});
    constexpr auto kSide = static_cast<double>(kTileSide);
    polygon.clip({1, 0}, 0);
    polygon.clip({-1, 0}, kSide);
    polygon.clip({0, 1}, 0);
    polygon.clip({0, -1}, kSide);
    std::vector<GridPoint> points;
    for (const auto& [x, y, z] : polygon.points())
        points.push_back({west + std::llround(x), south + std::llround(y), std::llround(z)});
    for (size_t i = 2; i < points.size(); ++i) {
        const SurfaceTriangle part{{points[0], points[i - 1], points[i]}};
        if (exact_normal(part) != std::array<int64_t, 3>{}) parts.push_back(part);
    }
}

int64_t tile_of(int64_t grid) {
    return grid >= 0 ? grid / kTileSide : -((-grid - 1) / kTileSide) - 1;
}

/// Which triangles lie in each tile, and the city's heights.
class CityTiles {
  public:
    explicit CityTiles(const SourceMesh& city) {
        for (const auto& corners : city.triangles) {
            SurfaceTriangle triangle;
            for (size_t i = 0; i < 3; ++i) {
                const auto& p = city.points[corners[i]];
                triangle.corners[i] = {to_grid(p[0]), to_grid(p[1]), to_grid(p[2])};
            }
            add(triangle);
        }
    }

    /// Those with at least the middle number of triangles, `count` of them.
    std::vector<TileNumber> choose(uint32_t count) const {
        std::vector<size_t> sizes;
        for (const auto& [tile, triangles] : tiles_) sizes.push_back(triangles.size());
        std::sort(sizes.begin(), sizes.end());
        std::vector<TileNumber> full, chosen;
        for (const auto& [tile, triangles] : tiles_) {
            if (triangles.size() >= sizes[sizes.size() / 2]) full.push_back(tile);
        }
        const size_t most = std::min<size_t>(count, full.size());
        for (size_t i = 0; i < most; ++i) chosen.push_back(full[(2 * i + 1) * full.size() / (2 * most)]);
        return chosen;
    }

    /// Under all of it at its lowest point, as the builder has it.
    void add_flat_ground() {
        const int64_t z = low_.z;
        test::Surface ground;
        test::add_quad(
            ground, {GridPoint{low_.x, low_.y, z}, {high_.x, low_.y, z}, {high_.x, high_.y, z}, {low_.x, high_.y, z}});
        for (const SurfaceTriangle& triangle : ground) add(triangle);
    }

    std::vector<SurfaceTriangle> parts(const TileNumber& tile) const {
        std::vector<SurfaceTriangle> parts;
        const auto found = tiles_.find(tile);
        if (found == tiles_.end()) return parts;
        for (const uint32_t t : found->second) add_part(triangles_[t], tile, parts);
        return parts;
    }
    std::vector<SurfaceTriangle> parts_around(const TileNumber& tile) const {
        std::vector<SurfaceTriangle> around;
        for (int64_t y = tile[1] - 1; y <= tile[1] + 1; ++y) {
            for (int64_t x = tile[0] - 1; x <= tile[0] + 1; ++x) {
                if (TileNumber{x, y} != tile) test::add(around, parts({x, y}));
            }
        }
        return around;
    }
    HeightGrid heights() const {
        HeightGrid heights(height_cell_of(low_.x, low_.y), height_cell_of(high_.x, high_.y), low_.z);
        heights.add(triangles_);
        return heights;
    }

  private:
    void add(const SurfaceTriangle& triangle) {
        GridPoint low = triangle.corners[0], high = low;
        for (const GridPoint& p : triangle.corners) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
        const auto number = static_cast<uint32_t>(triangles_.size());
        triangles_.push_back(triangle);
        for (int64_t y = tile_of(low.y); y <= tile_of(high.y); ++y) {
            for (int64_t x = tile_of(low.x); x <= tile_of(high.x); ++x) tiles_[{x, y}].push_back(number);
        }
        if (number == 0) {
            low_ = low;
            high_ = high;
        }
        low_ = {std::min(low.x, low_.x), std::min(low.y, low_.y), std::min(low.z, low_.z)};
        high_ = {std::max(high.x, high_.x), std::max(high.y, high_.y), std::max(high.z, high_.z)};
    }

    std::vector<SurfaceTriangle> triangles_;
    std::map<TileNumber, std::vector<uint32_t>> tiles_;
    GridPoint low_, high_;
};

}  // namespace

uint64_t RadianceSet::receivers() const {
    uint64_t count = 0;
    for (const RadianceSample& sample : samples) count += sample.visibility.receivers();
    return count;
}

double RadianceSet::bake_seconds() const {
    double seconds = 0;
    for (const RadianceSample& sample : samples) seconds += sample.bake_seconds;
    return seconds;
}

Result<RadianceSample> bake_vertices(const SourceMesh& mesh, const SampleOptions& options) {
    const codec::mesh::GridMesh grid = quantise(mesh, kMeshBits).mesh;
    std::vector<GridPoint> points;
    for (const auto& p : grid.points) points.push_back({p[0], p[1], p[2]});
    std::vector<SurfaceTriangle> triangles;
    for (const auto& [a, b, c] : grid.triangles) triangles.push_back({{points[a], points[b], points[c]}});
    BakedTile tile;
    tile.receivers = receivers_at_vertices(points, grid.triangles, options.most_receivers);
    if (tile.receivers.empty()) return Error{"no vertex has a normal"};
    constexpr int64_t kFar = (int64_t{1} << kMeshBits) + kLiftOff;
    Status cast = Done{};
    const double seconds = seconds_of([&] {
        const auto scene =
            OccluderScene::create(triangles, nullptr, {{-kLiftOff, -kLiftOff, -kLiftOff}, {kFar, kFar, kFar}});
        if (!scene) {
            cast = scene.error();
        } else {
            cast_visibility(tile.receivers, *scene, bake_options(options), tile);
        }
    });
    if (!cast) return cast.error();
    return sample_of(std::move(tile), seconds);
}

Result<std::vector<RadianceSample>> bake_city_tiles(const SourceMesh& city, const SampleOptions& options) {
    CityTiles tiles(city);
    const std::vector<TileNumber> chosen = tiles.choose(options.tiles);
    if (!city.has_ground) tiles.add_flat_ground();
    const auto heights = std::make_shared<const HeightGrid>(tiles.heights());
    std::vector<RadianceSample> samples;
    for (const TileNumber& tile : chosen) {
        auto sample = bake({{}, tiles.parts(tile), tiles.parts_around(tile), heights}, tile, options);
        if (!sample) return sample.error();
        if (sample->visibility.receivers() > 0) samples.push_back(std::move(*sample));
    }
    return samples;
}

Result<RadianceSample> bake_box_city(bool turned, const SampleOptions& options, const TileNumber& tile) {
    return bake({{}, test::city_tile(tile[0], tile[1], turned), test::tiles_around(tile[0], tile[1], turned), nullptr},
                tile, options);
}

Result<RadianceSample> bake_places(std::span<const GridPoint> points, std::span<const Vector> normals,
                                   const RadianceSample& tile) {
    BakedTile baked;
    for (size_t i = 0; i < points.size(); ++i) baked.receivers.push_back(receiver_at(points[i], normals[i]));
    StartBox box{points[0], points[0]};
    for (const GridPoint& p : points) {
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
    }
    std::vector<SurfaceTriangle> triangles = tile.surroundings.own;
    test::add(triangles, tile.surroundings.around);
    BakeOptions options;
    options.texels_across = tile.visibility.side;
    Status cast = Done{};
    const double seconds = seconds_of([&] {
        const auto scene = OccluderScene::create(triangles, tile.surroundings.heights.get(), widened(box, 0));
        if (!scene)
            cast = scene.error();
        else
            cast_visibility(baked.receivers, *scene, options, baked);
    });
    if (!cast) return cast.error();
    return sample_of(std::move(baked), seconds);
}

RadianceSample open_sphere(uint32_t vertices, uint32_t texels_across) {
    RadianceSample sample;
    sample.visibility.side = texels_across;
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    sample.bake_seconds = seconds_of([&] {
        for (uint32_t i = 0; i < vertices; ++i) {
            const double z = 1 - (2 * i + 1.0) / vertices, r = std::sqrt(1 - z * z);
            sample.normals.push_back({r * std::cos(golden * i), r * std::sin(golden * i), z});
            const uint32_t frame = codec::radiance::pack_frame(sample.normals.back());
            sample.visibility.add_receiver(frame);
            const auto above = codec::radiance::samples_above(codec::radiance::unpack_frame(frame), texels_across);
            std::copy(above.begin(), above.end(),
                      sample.visibility.words.end() - static_cast<std::ptrdiff_t>(above.size()));
        }
    });
    return sample;
}

SourceMesh bumpy_sphere(uint32_t vertices) {
    uint32_t n = 1;
    while (6 * (n + 1) * (n + 1) + 2 <= vertices) ++n;
    SourceMesh mesh;
    std::map<std::array<int64_t, 3>, uint32_t> known;
    const auto vertex = [&](uint32_t face, uint32_t i, uint32_t k) {
        // Corners of the cube's grid, in steps of a half: the same on all faces that meet there.
        const double s = 2.0 * i / n - 1, t = 2.0 * k / n - 1;
        const double side = face % 2 == 0 ? 1 : -1;
        Vector p{};
        p[face / 2] = side;
        p[(face / 2 + 1) % 3] = s * side;
        p[(face / 2 + 2) % 3] = t;
        const std::array<int64_t, 3> key = {std::llround(p[0] * n), std::llround(p[1] * n), std::llround(p[2] * n)};
        const auto [at, fresh] = known.try_emplace(key, static_cast<uint32_t>(mesh.points.size()));
        if (!fresh) return at->second;
        for (double& c : p) c = std::tan(c * std::numbers::pi / 4);  // squares of much the same size
        const double length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (double& c : p) c /= length;
        const double bumps = std::sin(7 * p[0] + 1) * std::sin(6 * p[1] + 2) * std::sin(8 * p[2] + 3);
        for (double& c : p) c *= 1 + 0.2 * bumps;
        mesh.points.push_back(p);
        return at->second;
    };
    for (uint32_t face = 0; face < 6; ++face) {
        for (uint32_t k = 0; k < n; ++k) {
            for (uint32_t i = 0; i < n; ++i) {
                const uint32_t a = vertex(face, i, k), b = vertex(face, i + 1, k), c = vertex(face, i + 1, k + 1),
                               d = vertex(face, i, k + 1);
                mesh.triangles.push_back({a, b, c});
                mesh.triangles.push_back({a, c, d});
            }
        }
    }
    return mesh;
}

}  // namespace citystream::bench
