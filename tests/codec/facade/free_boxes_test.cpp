// Boxes of free space: the near-linear growth on runs against the paper's growth on texels.
#include "codec/facade/free_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

/// Section 4.2 as it is written, on texels.
class TexelBoxes {
  public:
    explicit TexelBoxes(const FacadeMatrices& relief) : relief_(relief), of_texel_(relief.material.size()) {
        std::vector<uint8_t> has_box(of_texel_.size(), 0);
        for (uint32_t y = 0; y < relief.height; ++y) {
            for (uint32_t x = 0; x < relief.width; ++x) {
                if (has_box[at(x, y)] != 0) continue;
                const FreeBox box = grow(x, y);
                for (uint32_t v = box.y0; v < box.y1; ++v) {
                    for (uint32_t u = box.x0; u < box.x1; ++u) {
                        if (has_box[at(u, v)] != 0 || depth(u, v) != depth(x, y)) continue;
                        has_box[at(u, v)] = 1;
                        of_texel_[at(u, v)] = box;
                    }
                }
            }
        }
    }
    FreeBox box(uint32_t x, uint32_t y) const { return of_texel_[at(x, y)]; }

  private:
    size_t at(uint32_t x, uint32_t y) const { return size_t{y} * relief_.width + x; }
    int16_t depth(uint32_t x, uint32_t y) const { return relief_.displacement_mm[at(x, y)]; }
    bool is_free(uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1, int16_t height) const {
        for (uint32_t y = y0; y < y1; ++y) {
            for (uint32_t x = x0; x < x1; ++x) {
                if (depth(x, y) > height) return false;
            }
        }
        return true;
    }
    FreeBox grow(uint32_t x, uint32_t y) const {
        const int16_t height = depth(x, y);
        FreeBox box{x, x + 1, y, y + 1};
        for (bool grows = true; grows;) {
            const FreeBox before = box;
            if (box.x0 > 0 && is_free(box.x0 - 1, box.x0, box.y0, box.y1, height)) --box.x0;
            if (box.x1 < relief_.width && is_free(box.x1, box.x1 + 1, box.y0, box.y1, height)) ++box.x1;
            if (box.y0 > 0 && is_free(box.x0, box.x1, box.y0 - 1, box.y0, height)) --box.y0;
            if (box.y1 < relief_.height && is_free(box.x0, box.x1, box.y1, box.y1 + 1, height)) ++box.y1;
            grows = !(box == before);
        }
        return box;
    }

    const FacadeMatrices& relief_;
    std::vector<FreeBox> of_texel_;
};

void expect_boxes_of_texels(const FacadeMatrices& relief, const std::string& name) {
    const RunGrid grid = make_run_grid(relief).value();
    const FreeBoxes free = grow_free_boxes(grid);
    const TexelBoxes expected(relief);
    ASSERT_EQ(free.box_index.size(), grid.labels.size()) << name;
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const FreeBox box = free.boxes[free.box_index[size_t{row} * grid.columns() + column]];
            for (uint32_t y = grid.y_breaks[row]; y < grid.y_breaks[row + 1]; ++y) {
                for (uint32_t x = grid.x_breaks[column]; x < grid.x_breaks[column + 1]; ++x)
                    ASSERT_TRUE(box == expected.box(x, y)) << name << " at " << x << ", " << y;
            }
        }
    }
}

TEST(FreeBoxes, AreThoseOfGrowingOnTexels) {
    for (const ReliefCase& c : small_reliefs()) expect_boxes_of_texels(c.relief, c.name);
    expect_boxes_of_texels(figure8_relief(), "figure 8");
    expect_boxes_of_texels(window_relief(200, 180, 4, true), "facade");
}

TEST(FreeBoxes, AreThoseOfGrowingOnTexelsForRandomRectangles) {
    TestNumbers numbers(17);
    for (int round = 0; round < 300; ++round) {
        FacadeMatrices relief = uniform_relief(1 + numbers.below(40), 1 + numbers.below(40), 0, 0);
        for (uint32_t i = numbers.below(30); i > 0; --i) {
            const uint32_t x = numbers.below(relief.width), y = numbers.below(relief.height);
            fill_rectangle(relief, x, x + 1 + numbers.below(12), y, y + 1 + numbers.below(12),
                           static_cast<int32_t>(numbers.below(5)) - 2, numbers.below(2));
        }
        expect_boxes_of_texels(relief, "round " + std::to_string(round));
        if (HasFatalFailure()) return;
    }
}

TEST(FreeBoxes, AreNumberedInTheOrderOfTheirCellsAndDistinct) {
    const FreeBoxes free = grow_free_boxes(make_run_grid(window_relief(300, 300, 9, true)).value());
    uint32_t next = 0;
    for (const uint32_t index : free.box_index) {
        ASSERT_LE(index, next);
        next = std::max(next, index + 1);
    }
    EXPECT_EQ(next, free.boxes.size());
    std::map<std::tuple<uint32_t, uint32_t, uint32_t, uint32_t>, int> seen;
    for (const FreeBox& box : free.boxes) EXPECT_EQ((++seen[{box.x0, box.x1, box.y0, box.y1}]), 1);
}

TEST(FreeBoxes, OverTheHighestSurfacesAreTheFacade) {
    const RunGrid grid = make_run_grid(figure8_relief()).value();  // its windows stand out
    const FreeBoxes free = grow_free_boxes(grid);
    for (size_t cell = 0; cell < grid.labels.size(); ++cell) {
        const bool is_whole = free.boxes[free.box_index[cell]] == FreeBox{0, 80, 0, 90};
        EXPECT_EQ(is_whole, displacement_of(grid.labels[cell]) == 25);
    }
}

TEST(FreeBoxes, OfALargeStaircaseNeedNoScanOfTheirAreas) {
    // 2,000 steps inside each other: 4 million cells, boxes of all sizes up to the whole facade.
    FacadeMatrices relief = uniform_relief(2000, 2000, 0, 0);
    for (uint32_t y = 0; y < 2000; ++y) {
        for (uint32_t x = 0; x < 2000; ++x)
            relief.displacement_mm[size_t{y} * 2000 + x] = static_cast<int16_t>(std::max(x, y));
    }
    const FreeBoxes free = grow_free_boxes(make_run_grid(relief).value());
    EXPECT_EQ(free.boxes.size(), 2000u);
}

TEST(FreeBoxes, OfALargeEmptyFacadeIsOne) {
    const RunGrid grid{{0, kMaxFacadeSide}, {0, kMaxFacadeSide}, {make_label(3, 1)}};
    EXPECT_EQ(grow_free_boxes(grid).boxes, (std::vector<FreeBox>{{0, kMaxFacadeSide, 0, kMaxFacadeSide}}));
}

}  // namespace
}  // namespace citystream::codec::facade
