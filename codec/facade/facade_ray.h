// First hit of a ray with the relief of a facade, in double precision: the reference of the shaders (facade_ray.glsl).
//
// Facade space: u right, v up in texels (centimetres / stretch), w outwards in millimetres. The volume is 0 <= u <=
// width, 0 <= v <= height, depth_min <= w <= depth_max; what lies below D is solid down to depth_min, an open cell is
// air all the way. A ray that comes in through an edge of the facade below D hits there; one that leaves through an
// edge misses; one that starts in the solid hits at t = 0; one from behind hits the back at w = depth_min, but goes in
// through open cells; one that goes down an open cell leaves through the back and misses. A step between two cells is
// hit from the lower one and takes the label of the higher one. Through a corner the ray goes by way of the cell next
// in u. On a break it is in the cell that it goes into.
#pragma once

#include <cstdint>

#include "codec/facade/run_grid.h"

namespace citystream::codec::facade {

struct FacadeRayHit {
    bool hit = false;
    double t = 0;  ///< along the direction given
    uint32_t label = 0;
    int normal_axis = 2;  ///< 0: u, 1: v, 2: w
    int normal_sign = 1;
};

/// `depths`: grid.depths(), which a caller of many rays computes once. Directions of any length (t is in units of it);
/// not finite: no hit. At most columns + rows + 2 steps.
FacadeRayHit cast_facade_ray(const RunGrid& grid, const DepthRange& depths, const double origin[3],
                             const double direction[3]);

inline FacadeRayHit cast_facade_ray(const RunGrid& grid, const double origin[3], const double direction[3]) {
    return cast_facade_ray(grid, grid.depths(), origin, direction);
}

}  // namespace citystream::codec::facade
