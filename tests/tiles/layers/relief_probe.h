// Looks at a facade of a city object: what its relief shows at a place and along a ray.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "codec/facade/facade_ray.h"
#include "tiles/city/city_model.h"

namespace citystream::tiles::layers {

class ReliefProbe {
  public:
    ReliefProbe(const city::CityCatalog& catalog, const city::FacadeWall& wall)
        : wall_(wall),
          grid_(catalog.facade_maps.map(wall.map)),
          depths_(grid_.depths()),
          palette_(catalog.palettes[wall.palette]),
          length_(std::hypot(wall.along.x, wall.along.y)) {}

    city::Vec3 normal() const { return {wall_.along.y / length_, -wall_.along.x / length_, 0}; }
    const codec::facade::RunGrid& grid() const { return grid_; }

    /// Metres in the wall's frame: x to the right, y up, z outwards.
    city::Vec3 local(const city::Vec3& p) const {
        const double x = p.x - wall_.lower_left.x, y = p.y - wall_.lower_left.y;
        return {(x * wall_.along.x + y * wall_.along.y) / length_, p.z - wall_.lower_left.z,
                x * normal().x + y * normal().y};
    }
    /// The label over a place of the wall, in metres; nothing beside the wall and where it is open.
    std::optional<uint32_t> label_at(double x, double y) const {
        const double u = x / length_ * grid_.width(), v = y / wall_.height * grid_.height();
        if (u < 0 || v < 0 || u >= grid_.width() || v >= grid_.height()) return std::nullopt;
        const uint32_t label = grid_.label(cell(grid_.x_breaks, u), cell(grid_.y_breaks, v));
        if (codec::facade::displacement_of(label) == codec::facade::kOpenDisplacement) return std::nullopt;
        return label;
    }
    std::optional<double> depth_at(double x, double y) const {
        const auto label = label_at(x, y);
        if (!label) return std::nullopt;
        return codec::facade::displacement_of(*label) * 0.001;
    }
    uint32_t material_of(uint32_t label) const { return palette_.material[codec::facade::material_of(label)]; }
    /// Metres from `from` to the relief along a unit direction; nothing when the ray misses it.
    std::optional<double> distance(const city::Vec3& from, const city::Vec3& direction) const {
        const auto hit = cast(from, direction);
        if (!hit.hit) return std::nullopt;
        return hit.t;
    }
    /// The material that a ray sees.
    std::optional<uint32_t> material_along(const city::Vec3& from, const city::Vec3& direction) const {
        const auto hit = cast(from, direction);
        if (!hit.hit) return std::nullopt;
        return material_of(hit.label);
    }

  private:
    codec::facade::FacadeRayHit cast(const city::Vec3& from, const city::Vec3& direction) const {
        const city::Vec3 at = local(from),
                         end = local({from.x + direction.x, from.y + direction.y, from.z + direction.z});
        const double across = grid_.width() / length_, up = grid_.height() / wall_.height;
        const double origin[3] = {at.x * across, at.y * up, at.z * 1000};
        const double way[3] = {(end.x - at.x) * across, (end.y - at.y) * up, (end.z - at.z) * 1000};
        return codec::facade::cast_facade_ray(grid_, depths_, origin, way);
    }
    static uint32_t cell(const std::vector<uint32_t>& breaks, double at) {
        return static_cast<uint32_t>(std::upper_bound(breaks.begin(), breaks.end() - 1, at) - breaks.begin()) - 1;
    }
    city::FacadeWall wall_;
    codec::facade::RunGrid grid_;
    codec::facade::DepthRange depths_;
    city::FacadePalette palette_;
    double length_;
};

}  // namespace citystream::tiles::layers
