// Reliefs on which all forms that are looked up by texel are tested.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::codec::facade {

/// A small generator of numbers that are the same everywhere.
class TestNumbers {
  public:
    explicit TestNumbers(uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15ULL + 1) {}
    uint32_t below(uint32_t limit) {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return static_cast<uint32_t>((state_ >> 33) % limit);
    }

  private:
    uint64_t state_;
};

inline FacadeMatrices uniform_relief(uint32_t width, uint32_t height, int16_t depth, uint16_t material) {
    const size_t texels = size_t{width} * height;
    return {width, height, std::vector<int16_t>(texels, depth), std::vector<uint16_t>(texels, material)};
}

inline void fill_rectangle(FacadeMatrices& relief, uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1, int32_t depth,
                           uint32_t material) {
    for (uint32_t y = y0; y < y1 && y < relief.height; ++y) {
        for (uint32_t x = x0; x < x1 && x < relief.width; ++x) {
            relief.displacement_mm[size_t{y} * relief.width + x] = static_cast<int16_t>(depth);
            relief.material[size_t{y} * relief.width + x] = static_cast<uint16_t>(material);
        }
    }
}

/// Every texel has its own random entries, displacements of the range and materials below a limit.
inline FacadeMatrices noise_relief(uint32_t width, uint32_t height, int32_t least, int32_t greatest, uint32_t materials,
                                   uint64_t seed = 1) {
    FacadeMatrices relief = uniform_relief(width, height, 0, 0);
    TestNumbers numbers(seed);
    for (size_t i = 0; i < relief.material.size(); ++i) {
        const uint32_t range = static_cast<uint32_t>(greatest - least + 1);
        relief.displacement_mm[i] = static_cast<int16_t>(least + static_cast<int32_t>(numbers.below(range)));
        relief.material[i] = static_cast<uint16_t>(numbers.below(materials));
    }
    return relief;
}

/// Figure 8 of the paper: equal windows and doors in one wall, so that D has rank one.
inline FacadeMatrices figure8_relief(uint32_t bays = 4, uint32_t floors = 3) {
    FacadeMatrices relief = uniform_relief(20 * bays, 30 * floors, 0, 0);
    for (uint32_t floor = 0; floor < floors; ++floor) {
        for (uint32_t bay = 0; bay < bays; ++bay)
            fill_rectangle(relief, 20 * bay + 5, 20 * bay + 15, 30 * floor + 8, 30 * floor + 22, 25, 3);
    }
    return relief;
}

/// A wall of windows with frames, sills and jitter, one balcony a floor and, if wanted, open air at a gable.
inline FacadeMatrices window_relief(uint32_t width, uint32_t height, uint64_t seed, bool with_gable) {
    FacadeMatrices relief = uniform_relief(width, height, 0, 1);
    TestNumbers numbers(seed);
    for (uint32_t y = 10; y + 40 < height; y += 45) {
        for (uint32_t x = 8; x + 30 < width; x += 35) {
            const uint32_t w = 14 + numbers.below(8), h = 20 + numbers.below(10);
            fill_rectangle(relief, x, x + w, y, y + h, -60, 2);
            fill_rectangle(relief, x + 2, x + w - 2, y + 2, y + h - 2, -90 - static_cast<int32_t>(numbers.below(3)), 4);
            fill_rectangle(relief, x - 1, x + w + 1, y - 2, y, 35, 5);
        }
        fill_rectangle(relief, width / 3, width / 2, y + 5, y + 8, 800, 6);
    }
    for (uint32_t step = 0; with_gable && step < std::min(width, height) / 4; ++step)
        fill_rectangle(relief, 0, step, height - 1 - (step < height ? step : 0), height - step, kOpenDisplacement, 0);
    return relief;
}

/// Each texel becomes a block: as many distinct rows and columns on more texels.
inline FacadeMatrices enlarged(const FacadeMatrices& relief, uint32_t factor) {
    FacadeMatrices large = uniform_relief(relief.width * factor, relief.height * factor, 0, 0);
    for (uint32_t y = 0; y < large.height; ++y) {
        for (uint32_t x = 0; x < large.width; ++x) {
            const size_t from = size_t{y / factor} * relief.width + x / factor, to = size_t{y} * large.width + x;
            large.displacement_mm[to] = relief.displacement_mm[from];
            large.material[to] = relief.material[from];
        }
    }
    return large;
}

struct ReliefCase {
    std::string name;
    FacadeMatrices relief;
};

/// Every kind of small input; most are too small for factors to pay.
inline std::vector<ReliefCase> small_reliefs() {
    FacadeMatrices checkerboard = uniform_relief(16, 16, 0, 0);
    for (uint32_t i = 0; i < 256; ++i) {
        checkerboard.displacement_mm[i] = (i + i / 16) % 2 == 0 ? 30 : -30;
        checkerboard.material[i] = (i + i / 16) % 2;
    }
    FacadeMatrices different = uniform_relief(6, 7, 0, 0);
    for (uint32_t i = 0; i < 42; ++i) {
        different.displacement_mm[i] = static_cast<int16_t>(i * 5);
        different.material[i] = static_cast<uint16_t>(41 - i);
    }
    FacadeMatrices diagonal = uniform_relief(24, 24, -5, 1);
    for (uint32_t i = 0; i < 24; ++i) fill_rectangle(diagonal, i, i + 1, i, 24, 15, 2);
    FacadeMatrices open = uniform_relief(9, 8, 10, 1);
    fill_rectangle(open, 2, 5, 0, 6, kOpenDisplacement, 0);
    return {{"one texel", uniform_relief(1, 1, -7, 9)},
            {"all equal", uniform_relief(7, 5, 120, 300)},
            {"all open", uniform_relief(4, 3, kOpenDisplacement, 0)},
            {"checkerboard", checkerboard},
            {"one row", noise_relief(37, 1, -4, 4, 3)},
            {"one column", noise_relief(1, 41, -4, 4, 3)},
            {"all different", different},
            {"extreme displacements", noise_relief(12, 10, -32768, 32767, 2)},
            {"extreme materials", noise_relief(10, 12, 0, 3, 65536)},
            {"diagonal", diagonal},
            {"open air", open},
            {"windows", window_relief(80, 100, 3, true)}};
}

/// The same on so many texels that factors pay, and facades.
inline std::vector<ReliefCase> large_reliefs() {
    std::vector<ReliefCase> cases;
    for (const ReliefCase& small : small_reliefs()) {
        const FacadeMatrices& relief = small.relief;
        cases.push_back({small.name, enlarged(relief, relief.width < 4 && relief.height < 4 ? 64 : 24)});
    }
    // One row or column is no matrix to factor: bits for each texel cost more than they describe.
    std::erase_if(cases, [](const ReliefCase& c) { return c.name == "one row" || c.name == "one column"; });
    cases.push_back({"figure 8", figure8_relief()});
    cases.push_back({"enlarged facade", enlarged(window_relief(80, 120, 7, true), 4)});
    cases.push_back({"facade", window_relief(400, 500, 5, false)});
    cases.push_back({"facade with a gable", window_relief(300, 420, 6, true)});
    return cases;
}

}  // namespace citystream::codec::facade
