// What stands between a point of a tile and the sky: rays against the triangles around it (Embree), and beyond their
// reach against the city's heights.
//
// What a ray meets depends on nothing but the ray: triangles count within `reach` of the ray's beginning, cells of the
// height grid from there to `horizon`, whatever else the scene holds. So two tiles that both hold every triangle within
// reach of a point see the same from it. Rays begin at grid points and triangles have grid corners, and Embree's robust
// mode reckons with the differences, which are exact: results do not depend on the scene's origin or on the order of
// its triangles.
//
// Queries are const and may come from many threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "codec/result.h"
#include "tiles/radiance/height_grid.h"
#include "tiles/radiance/surface_triangle.h"

namespace citystream::tiles::radiance {

/// Metres. At an elevation of 3 degrees, a texel of the 6 x 32 x 32 source, a tower of 60 m hides the sky at 1,200 m.
struct OccluderReach {
    double triangles = 128;
    double horizon = 1200;
};

/// Grid units. Rays leave a surface from this far above it (1.6 cm): more than corners rounded to the grid are off
/// their plane, less than anything that a lattice of metres could show.
inline constexpr int64_t kLiftOff = 16;

/// Inclusive box, absolute grid units.
struct StartBox {
    GridPoint low, high;
};
/// The box and what is within `metres` of it, and within kLiftOff more, in x and y.
StartBox widened(const StartBox& box, double metres);
/// Whether a triangle's bounds meet the box, seen from above.
bool meets(const SurfaceTriangle& triangle, const StartBox& box);

/// Unit vectors; rounded to float once, so that all who ask about a direction ask about the same one.
using RayDirection = std::array<float, 3>;
/// Of a vector that is not zero.
RayDirection ray_direction(const std::array<int32_t, 3>& direction);

class OccluderScene {
  public:
    /// Further directions are asked for in bundles of this many: neighbours in one bundle share their way.
    static constexpr size_t kBundle = 16;

    /// For rays that begin within `start`. What they cannot reach is left out; neither `triangles` nor `heights` (null:
    /// the horizon is clear) is kept. Exact as long as nothing in reach is further than 16 km from start.low. Error:
    /// Embree's message, such as no memory.
    static Result<OccluderScene> create(std::span<const SurfaceTriangle> triangles, const HeightGrid* heights,
                                        const StartBox& start, const OccluderReach& reach = {});

    ~OccluderScene();
    OccluderScene(OccluderScene&&) noexcept;
    OccluderScene& operator=(OccluderScene&&) noexcept;

    /// For each direction whether something is in its way: bit i % 64 of word i / 64. `blocked` has
    /// (directions + 63) / 64 words.
    void blocked(const GridPoint& from, std::span<const RayDirection> directions, std::span<uint64_t> blocked) const;

    /// Which side of the nearest triangle within reach a ray meets; where triangles coincide the front counts.
    /// Touching: it is within kLiftOff, so that the ray as good as begins on it.
    enum class Side : uint8_t { kNothing, kFront, kBack, kTouching };
    Side nearest_side(const GridPoint& from, const RayDirection& direction) const;

    /// How far a ray goes before it meets a triangle, of those within reach; `most` where it meets none so soon.
    /// Metres.
    double free_way(const GridPoint& from, const RayDirection& direction, double most) const;

    const OccluderReach& reach() const;

  private:
    struct State;
    explicit OccluderScene(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// Where rays of a point on a surface begin: kLiftOff along its unit normal, rounded to the grid.
GridPoint lifted(const GridPoint& point, const std::array<double, 3>& normal);

/// Whether a point of a surface is probably inside of something or under the ground, where nobody sees it: of about 48
/// rays into the half space above the surface more meet backs of triangles than fronts, and at least four do. A point
/// below a canopy is not: it has the ground's front below it. One beside a wall that faces the wrong way is.
/// So is a point at which one of the rays touches something: it is in a crease; one of a surface that looks down, of
/// whose rays three in four meet nothing: it is a floor, with the ground at its own height or missing; and one under
/// the ground: the nearest thing straight up is a back, straight down there is no front, and at most one in ten of the
/// rays that go up meets nothing.
bool buried(const OccluderScene& scene, const GridPoint& point, const std::array<double, 3>& normal);
/// Whether nine in ten of these rays meet backs, or it is a floor or under the ground: nobody can see it.
bool enclosed(const OccluderScene& scene, const GridPoint& point, const std::array<double, 3>& normal);

}  // namespace citystream::tiles::radiance
