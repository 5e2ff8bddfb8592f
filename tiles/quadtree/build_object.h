// A city object on its way through the builder: positions on the global grid, paints instead of materials, and the
// error it has gathered so far. The serialised form is what the spool files hold between the passes.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/grid.h"
#include "codec/result.h"
#include "tiles/city/city_model.h"

namespace citystream::tiles::quadtree {

/// What a triangle shows: a catalog material, a facade map seen flat, a flat colour, or the tile's own picture of its
/// ground.
enum class PaintKind : uint8_t { kFlat, kMaterial, kFacade, kGroundPicture };

struct Paint {
    PaintKind kind = PaintKind::kFlat;
    uint32_t a = 0;  ///< kFlat: r | g << 8 | b << 16 (sRGB); kMaterial: catalog index; kFacade: map; kGroundPicture:
                     ///< index in the tile
    uint32_t b = 0;  ///< kFacade: palette
    friend auto operator<=>(const Paint&, const Paint&) = default;

    static Paint flat(const std::array<uint8_t, 3>& rgb) {
        return {
            PaintKind::kFlat,
            static_cast<uint32_t>(rgb[0]) | static_cast<uint32_t>(rgb[1]) << 8 | static_cast<uint32_t>(rgb[2]) << 16,
            0};
    }
    std::array<uint8_t, 3> rgb() const {
        return {static_cast<uint8_t>(a), static_cast<uint8_t>(a >> 8), static_cast<uint8_t>(a >> 16)};
    }
};

inline constexpr double kTexcoordUnits = 65536;  ///< texture coordinates are integers of 2^-16 repeats

struct BuildTriangle {
    std::array<uint32_t, 3> vertex{};
    std::array<std::array<int64_t, 2>, 3> texcoord{};
    uint32_t paint = 0;  ///< index in BuildObject::paints
    city::SurfaceKind surface = city::SurfaceKind::kUnknown;
};

struct BuildFacade {
    GridPoint origin;                ///< absolute: lower left corner seen from outside
    std::array<int32_t, 2> along{};  ///< to the lower right corner
    uint32_t height = 0;
    uint32_t map = 0, palette = 0;

    /// Corners counter-clockwise from outside, from the lower left one.
    std::array<GridPoint, 4> corners() const;
};

/// Inclusive box in grid units; empty while lo > hi.
struct GridBox {
    GridPoint lo{INT64_MAX, INT64_MAX, INT64_MAX}, hi{INT64_MIN, INT64_MIN, INT64_MIN};
    bool empty() const { return lo.x > hi.x; }
    void add(const GridPoint& point);
    void add(const GridBox& box);
};

struct BuildObject {
    city::ObjectKind kind = city::ObjectKind::kOther;
    float error = 0;                  ///< metres: how far it is from the input object, at most
    bool block = false;               ///< already an outline block
    std::vector<GridPoint> vertices;  ///< absolute
    std::vector<BuildTriangle> triangles;
    std::vector<Paint> paints;
    std::vector<BuildFacade> facades;

    GridBox box() const;
    /// Index of `paint` in paints, appended when new.
    uint32_t paint_index(const Paint& paint);
    /// Ground-like: part of the surface on which things stand (terrain, land use, road, water).
    bool ground() const;
};

/// Unnormalised normal (twice the area, grid units squared) of a triangle.
std::array<double, 3> triangle_normal(const GridPoint& a, const GridPoint& b, const GridPoint& c);

void serialise(const BuildObject& object, std::vector<std::byte>& out);
/// Reads objects back to back until the end of `bytes`. Fails only when a spool file was damaged behind our back.
Result<std::vector<BuildObject>> deserialise_all(std::span<const std::byte> bytes);

}  // namespace citystream::tiles::quadtree
