// What near surfaces hide: a picture of their depths as the camera sees them, at the samples of the frame to come, and
// the question whether a box lies behind it. Tiles that do are neither fetched nor drawn.
//
// Errs towards "not hidden": a surface hides only samples whose neighbours are covered, too, so that what the GPU
// rounds otherwise, or what moves by less than a pixel when a finer step arrives, never opens a hole.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/select/camera.h"

namespace citystream::client {

class DepthPicture {
  public:
    /// Begins a picture of nothing for a camera. `margin`: samples by which every surface is taken smaller, 1..8.
    void begin(const Camera& camera, uint32_t margin = 1);
    /// Adds a convex polygon of at most 16 corners (absolute metres), seen from either side. Corners behind the camera
    /// are clipped away. O(rows + pixels).
    void add(std::span<const std::array<double, 3>> corners);
    /// Makes hides() answer for all that was added. More can be added afterwards. O(pixels).
    void finish();
    /// Whether every sample of the frame that the box can touch shows something nearer than all of the box. A box that
    /// reaches the camera's plane is never hidden. Bounds relative to `origin` in x and y, as Camera::sees.
    bool hides(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const;
    /// Share of the samples that something covers.
    double covered() const;

  private:
    static constexpr uint32_t kBlock = 8;  // samples, both ways
    struct Projected {
        double x = 0, y = 0;  ///< samples from the upper left corner
        double nearness = 0;  ///< 1 / distance along the view direction
    };
    std::array<double, 3> view_of(const std::array<double, 3>& point) const;
    Projected project(const std::array<double, 3>& view) const;
    void fill(std::span<const Projected> polygon);
    bool all_nearer(uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, float nearness) const;

    Camera camera_;
    uint32_t margin_ = 1;
    double scale_ = 0;             ///< samples for a tangent of 1
    std::vector<float> nearness_;  ///< of the nearest surface, row by row; 0: none
    std::vector<float> least_;     ///< the same, the least within the margin of every sample
    std::vector<float> blocks_;    ///< least of least_ in every block
    uint32_t blocks_across_ = 0, blocks_down_ = 0;
};

}  // namespace citystream::client
