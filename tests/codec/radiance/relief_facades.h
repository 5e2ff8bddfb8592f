// Facades for tests of relief masks and BTFs.
#pragma once

#include <algorithm>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::codec::radiance {

struct ReliefBox {
    uint32_t left, bottom, right, top;  ///< texels
    int displacement_mm;
    uint32_t material;
};

/// Boxes one over the other on a wall of displacement 0 and material 0.
inline facade::RunGrid relief_facade(uint32_t width, uint32_t height, const std::vector<ReliefBox>& boxes) {
    facade::FacadeMatrices matrices{width, height, std::vector<int16_t>(size_t{width} * height, 0),
                                    std::vector<uint16_t>(size_t{width} * height, 0)};
    for (const ReliefBox& box : boxes) {
        for (uint32_t y = box.bottom; y < box.top; ++y) {
            for (uint32_t x = box.left; x < box.right; ++x) {
                matrices.displacement_mm[size_t{y} * width + x] = static_cast<int16_t>(box.displacement_mm);
                matrices.material[size_t{y} * width + x] = static_cast<uint16_t>(box.material);
            }
        }
    }
    return *facade::make_run_grid(matrices);
}

/// A window of 120 x 160 cm in a reveal of 20 cm with a frame, a sill and a cornice above; `open`: and a gateway.
inline facade::RunGrid window_relief(bool open) {
    std::vector<ReliefBox> boxes = {{90, 70, 210, 230, -200, 1},
                                    {98, 78, 202, 222, -230, 2},
                                    {146, 78, 154, 222, -200, 1},
                                    {80, 60, 220, 70, 60, 3},
                                    {0, 270, 300, 300, 120, 3}};
    if (open) boxes.push_back({230, 0, 280, 120, facade::kOpenDisplacement, 0});
    return relief_facade(300, 300, boxes);
}

inline uint32_t label_at(const facade::RunGrid& grid, float u, float v) {
    const auto run = [](const std::vector<uint32_t>& breaks, float at) {
        const auto texel = static_cast<uint32_t>(at);
        return static_cast<uint32_t>(std::upper_bound(breaks.begin(), breaks.end() - 1, texel) - breaks.begin()) - 1;
    };
    return grid.label(run(grid.x_breaks, u), run(grid.y_breaks, v));
}

}  // namespace citystream::codec::radiance
