// Is there a triangle of the model where the relief would draw a side, or could nobody see that place?
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/layers/relief_extraction_parts.h"

namespace citystream::tiles::layers::relief {

class Surroundings {
  public:
    /// `facade` must outlive it. Looks for parts up to `reach` metres away.
    Surroundings(const WallFrame& frame, const FacadeParts& facade, double reach);

    /// A part that is no front lies within reach of the point.
    bool covers(const Point& p) const;
    /// Going along u (`along_u`) or v, up or down (`sign`), the next surface is seen from its back: the point is inside
    /// the building.
    bool encloses(const Point& p, bool along_u, double sign) const;

  private:
    size_t bucket_of(double u, double v) const;
    /// Bounds of all parts, packed for the search along a ray.
    struct Bounds {
        float low_u, high_u, low_v, high_v, low_w, high_w;
    };
    const FacadeParts& facade_;
    std::vector<Bounds> bounds_;
    double reach_;
    size_t across_ = 1, up_ = 1;
    std::vector<uint32_t> begin_, entries_;  // of the buckets: part indices
};

/// Distance of a point from a triangle.
double distance_to_part(const Point& p, const Part& part);

}  // namespace citystream::tiles::layers::relief
