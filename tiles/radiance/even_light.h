// How much of an even sky's light, none of it from below the horizon, reaches points of a surface, by few rays: to
// compare places on it with each other.
#pragma once

#include <array>
#include <vector>

#include "tiles/radiance/occluder_scene.h"

namespace citystream::tiles::radiance {

class EvenLight {
  public:
    /// `normal`: of the surface, a unit vector.
    explicit EvenLight(const std::array<double, 3>& normal);

    /// 0..1: cosines of the rays that go up and meet nothing, over those of all in the half space above the surface;
    /// at most 75 rays. Places with one normal have the same directions, so that what these miss they miss alike.
    double at(const OccluderScene& scene, const GridPoint& point) const;

  private:
    std::array<double, 3> normal_;
    std::vector<RayDirection> directions_;
    std::vector<double> weights_;  ///< parts of what a whole half space of sky gives
};

}  // namespace citystream::tiles::radiance
