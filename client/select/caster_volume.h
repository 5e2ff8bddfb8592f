// Where things stand whose shadows can fall into a view: the view's pyramid, cut off at a distance and between the
// city's lowest and highest points, swept towards the sun by as far as that height lets shadows reach.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/select/camera.h"
#include "codec/vector.h"

namespace citystream::client {

struct CasterLimits {
    std::array<double, 3> to_sun{0, 0, 1};  ///< unit vector, z above 0
    double view_metres = 0;                 ///< along the view: no shadow is wanted beyond
    double reach_metres = 0;                ///< most that a caster is away from its shadow
    double lowest = 0, highest = 0;         ///< metres: of the city's surfaces
};

/// Convex; tests are conservative: they compare extents along the normals that its faces can have.
class CasterVolume {
  public:
    CasterVolume(const Camera& camera, const CasterLimits& limits);

    /// Whether something in a box (bounds relative to `origin` in metres, z absolute) may cast a shadow into the view.
    /// False is certain; true may be wrong near corners. O(1).
    bool meets(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const;
    /// Metres from the camera to the nearest place where the shadow of something in the box may fall.
    double shadow_distance(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const;

  private:
    using Vector = codec::Vector;
    struct Extent {
        Vector normal{};
        double least = 0, greatest = 0;  ///< of the volume, relative to the camera
    };
    void add_extent(const Vector& normal);

    Camera camera_;
    Vector to_sun_;
    double reach_ = 0;
    std::vector<Vector> corners_;  ///< of the part of the view, relative to the camera; none: it is empty
    std::vector<Extent> extents_;
};

}  // namespace citystream::client
