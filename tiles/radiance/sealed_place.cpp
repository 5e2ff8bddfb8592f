#include "tiles/radiance/sealed_place.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "codec/radiance/source_directions.h"

namespace citystream::tiles::radiance {

namespace {

constexpr uint32_t kLeastBacks = 4;
constexpr uint32_t kFirstSide = 4, kSecondSide = 8;  ///< cells of the cube whose middles are the directions

/// With more than no part along an axis.
std::vector<RayDirection> directions_along(const std::array<double, 3>& axis, uint32_t side) {
    std::vector<RayDirection> directions;
    for (uint32_t cell = 0; cell < codec::radiance::cube_cells(side); ++cell) {
        const RayDirection direction = ray_direction(codec::radiance::cell_direction(side, cell));
        if (direction[0] * axis[0] + direction[1] * axis[1] + direction[2] * axis[2] > 0)
            directions.push_back(direction);
    }
    return directions;
}

/// Whether a ray leaves the model.
bool opens(const OccluderScene& scene, const GridPoint& from, std::span<const RayDirection> directions) {
    constexpr size_t kBundle = OccluderScene::kBundle;
    for (size_t first = 0; first < directions.size(); first += kBundle) {
        const auto bundle = directions.subspan(first, std::min(kBundle, directions.size() - first));
        uint64_t blocked = 0;
        scene.blocked(from, bundle, {&blocked, 1});
        if (blocked != (uint64_t{1} << bundle.size()) - 1) return true;
    }
    return false;
}

/// Whether the sky can be seen from where a ray first meets something: off that surface as a ray's beginning is off its
/// own.
bool opens_along(const OccluderScene& scene, const GridPoint& from, const RayDirection& direction, int64_t hop,
                 std::span<const RayDirection> up) {
    const double reach = scene.reach().triangles, met = scene.free_way(from, direction, reach);
    if (met >= reach && direction[2] < 0) return false;
    const auto way = static_cast<double>(std::max<int64_t>(0, std::min(to_grid(met) - kLiftOff, hop)));
    const auto along = [&](uint32_t axis) { return std::llround(way * static_cast<double>(direction[axis])); };
    return opens(scene, {from.x + along(0), from.y + along(1), from.z + along(2)}, up);
}

}  // namespace

bool sealed(const OccluderScene& scene, const GridPoint& point, const std::array<double, 3>& normal, int64_t hop) {
    static const std::vector<RayDirection> kUp = directions_along({0, 0, 1}, kSecondSide);
    const std::vector<RayDirection> first = directions_along(normal, kFirstSide);
    const GridPoint from = lifted(point, normal);
    uint32_t backs = 0;
    for (const RayDirection& direction : first) {
        if (opens_along(scene, from, direction, hop, kUp)) return false;
        backs += scene.nearest_side(from, direction) == OccluderScene::Side::kBack ? 1 : 0;
    }
    return backs >= kLeastBacks;
}

}  // namespace citystream::tiles::radiance
