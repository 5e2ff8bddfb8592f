#include "codec/facade/facade_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "codec/facade/grid_difference.h"

namespace citystream::codec::facade {
namespace {

constexpr uint32_t kWall = make_label(0, 0), kFrame = make_label(-60, 2), kGlass = make_label(-140, 3);
constexpr uint32_t kOpen = make_label(kOpenDisplacement, 0);

/// Texels of any labels, cut at every `least`..`most` texels.
RunGrid random_grid(std::mt19937& random, uint32_t width, uint32_t height, uint32_t most_run) {
    const auto below = [&](uint32_t limit) { return std::uniform_int_distribution<uint32_t>(0, limit - 1)(random); };
    const auto breaks = [&](uint32_t size) {
        std::vector<uint32_t> list = {0};
        while (list.back() < size) list.push_back(std::min(size, list.back() + 1 + below(most_run)));
        return list;
    };
    RunGrid grid{breaks(width), breaks(height), {}};
    for (uint32_t i = 0; i < grid.columns() * grid.rows(); ++i) {
        grid.labels.push_back(below(12) == 0 ? kOpen : make_label(static_cast<int32_t>(below(900)) - 300, below(5)));
    }
    return grid;
}

/// A wall of windows 120 x 150 cm every 250 x 300 cm, frames 7 cm wide.
RunGrid window_wall(uint32_t bays, uint32_t floors) {
    RunGrid grid{{0}, {0}, {}};
    for (uint32_t i = 0; i < bays; ++i) {
        for (const uint32_t at : {65U, 72U, 178U, 185U, 250U}) grid.x_breaks.push_back(250 * i + at);
    }
    for (uint32_t i = 0; i < floors; ++i) {
        for (const uint32_t at : {90U, 97U, 233U, 240U, 300U}) grid.y_breaks.push_back(300 * i + at);
    }
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const uint32_t x = column % 5, y = row % 5;
            const bool opening = x >= 1 && x <= 3 && y >= 1 && y <= 3;
            grid.labels.push_back(x == 2 && y == 2 ? kGlass : opening ? kFrame : kWall);
        }
    }
    return grid;
}

void expect_breaks_on_texels(const std::vector<uint32_t>& breaks, uint32_t texel) {
    for (size_t i = 0; i + 1 < breaks.size(); ++i) EXPECT_EQ(breaks[i] % texel, 0U);
}

TEST(Coarsen, TakesTheLabelThatCoversMostOfEachRowThenOfEachColumnOfATexel) {
    // Against a texel by texel version of the rule.
    std::mt19937 random(5);
    for (const uint32_t texel : {1U, 2U, 3U, 7U, 16U, 40U}) {
        const auto side = [&] { return static_cast<uint32_t>(1 + random() % 33); };
        const uint32_t width = side(), height = side();
        const RunGrid grid = random_grid(random, width, height, 5);
        const FacadeMatrices before = expand(grid), after = expand(coarsen(grid, texel));
        const auto label_of = [&](const FacadeMatrices& m, uint32_t x, uint32_t y) {
            const size_t at = size_t{y} * width + x;
            const bool open = m.displacement_mm[at] == kOpenDisplacement;
            return open ? kOpen : make_label(m.displacement_mm[at], m.material[at]);
        };
        // Of the labels that are not recessed, if `closed` and there are any.
        const auto most = [](const std::map<uint32_t, uint32_t>& votes, bool closed) {
            const auto recessed = [](uint32_t label) { return displacement_of(label) < 0 && label != kOpen; };
            const bool any = std::any_of(votes.begin(), votes.end(), [&](const auto& v) { return !recessed(v.first); });
            uint32_t best = 0, count = 0;
            for (const auto& [label, n] : votes) {
                if (closed && any && recessed(label)) continue;
                const bool higher = displacement_of(label) > displacement_of(best) ||
                                    (displacement_of(label) == displacement_of(best) && label > best);
                if (n > count || (n == count && higher)) best = label, count = n;
            }
            return best;
        };
        for (uint32_t y0 = 0; y0 < height; y0 += texel) {
            for (uint32_t x0 = 0; x0 < width; x0 += texel) {
                const uint32_t x1 = std::min(width, x0 + texel), y1 = std::min(height, y0 + texel);
                std::vector<uint32_t> rows;
                std::map<uint32_t, uint32_t> column;
                for (uint32_t y = y0; y < y1; ++y) {
                    std::map<uint32_t, uint32_t> row;
                    for (uint32_t x = x0; x < x1; ++x) ++row[label_of(before, x, y)];
                    const bool closed = (x0 == 0 && displacement_of(label_of(before, 0, y)) >= 0) ||
                                        (x1 == width && displacement_of(label_of(before, width - 1, y)) >= 0);
                    rows.push_back(most(row, closed));
                    ++column[rows.back()];
                }
                const bool closed = (y0 == 0 && displacement_of(rows.front()) >= 0) ||
                                    (y1 == height && displacement_of(rows.back()) >= 0);
                const uint32_t expected = most(column, closed);
                for (uint32_t y = y0; y < std::min(height, y0 + texel); ++y) {
                    for (uint32_t x = x0; x < std::min(width, x0 + texel); ++x)
                        ASSERT_EQ(label_of(after, x, y), expected) << texel << ": " << x << " " << y;
                }
            }
        }
    }
}

TEST(Coarsen, IsAValidCoarsestGridOfTheSameSizeOnTexels) {
    std::mt19937 random(6);
    for (int i = 0; i < 60; ++i) {
        const auto side = [&] { return static_cast<uint32_t>(1 + random() % 300); };
        const uint32_t width = side(), height = side(), texel = 1 + static_cast<uint32_t>(random() % 70);
        const RunGrid grid = random_grid(random, width, height, 30);
        const RunGrid coarse = coarsen(grid, texel);
        ASSERT_TRUE(is_valid(coarse));
        EXPECT_EQ(merge_equal_runs(coarse), coarse);
        EXPECT_EQ(coarse.width(), width);
        EXPECT_EQ(coarse.height(), height);
        expect_breaks_on_texels(coarse.x_breaks, texel);
        expect_breaks_on_texels(coarse.y_breaks, texel);
        EXPECT_EQ(coarsen(coarse, texel), coarse) << "what is on coarse texels stays";
    }
}

TEST(Coarsen, TexelsOfOneCentimetreChangeNothing) {
    std::mt19937 random(9);
    const RunGrid grid = window_wall(3, 2);
    EXPECT_EQ(coarsen(grid, 1), merge_equal_runs(grid));
}

TEST(Coarsen, ThinFramesVanishAndWindowsStay) {
    const RunGrid coarse = coarsen(window_wall(8, 4), 16);
    uint64_t glass = 0, frame = 0;
    const FacadeMatrices all = expand(coarse);
    for (const uint16_t material : all.material) {
        glass += material == 3;
        frame += material == 2;
    }
    const double texels = static_cast<double>(all.material.size());
    EXPECT_NEAR(static_cast<double>(glass) / texels, 1.06 * 1.36 / (2.5 * 3), 0.05);
    const double exact_frames = 2 * 0.07 * (1.2 + 1.36) / (2.5 * 3);
    EXPECT_LT(static_cast<double>(frame) / texels, 0.8 * exact_frames);
}

TEST(Coarsen, AClosedBorderStaysClosed) {
    // 9 cm of frame around glass: in a texel of 64 cm most is glass, and through it one would look past the corner.
    constexpr uint32_t kFin = make_label(20, 1);
    RunGrid grid{{0, 9, 391, 400}, {0, 9, 291, 300}, {}};
    for (uint32_t row = 0; row < 3; ++row) {
        for (uint32_t column = 0; column < 3; ++column) grid.labels.push_back(row == 1 && column == 1 ? kGlass : kFin);
    }
    for (const uint32_t texel : {4U, 16U, 64U}) {
        const RunGrid coarse = coarsen(grid, texel);
        for (uint32_t column = 0; column < coarse.columns(); ++column) {
            EXPECT_EQ(coarse.label(column, 0), kFin) << texel;
            EXPECT_EQ(coarse.label(column, coarse.rows() - 1), kFin) << texel;
        }
        for (uint32_t row = 0; row < coarse.rows(); ++row) {
            EXPECT_EQ(coarse.label(0, row), kFin) << texel;
            EXPECT_EQ(coarse.label(coarse.columns() - 1, row), kFin) << texel;
        }
    }
}

TEST(Coarsen, OpenCellsOfSeveralMaterialsVoteTogether) {
    // 6 of 10 texels are open, but no single label is as long as the wall.
    const RunGrid grid{
        {0, 3, 6, 10}, {0, 10}, {make_label(kOpenDisplacement, 1), make_label(kOpenDisplacement, 2), make_label(0, 0)}};
    const RunGrid coarse = coarsen(grid, 10);
    ASSERT_EQ(coarse.labels.size(), 1U);
    EXPECT_EQ(displacement_of(coarse.labels[0]), kOpenDisplacement);
}

TEST(MakeLevels, EndsWithTheExactMapAndStatesTheErrorOfTheOthers) {
    std::mt19937 random(11);
    for (int i = 0; i < 40; ++i) {
        const RunGrid grid = i % 2 == 0 ? random_grid(random, 400 + static_cast<uint32_t>(i), 300, 3)
                                        : window_wall(1 + i % 7, 1 + i % 5);
        const std::vector<FacadeLevel> levels = make_levels(grid);
        ASSERT_GE(levels.size(), 1U);
        ASSERT_LE(levels.size(), kMostFacadeLevels);
        EXPECT_EQ(levels.back().grid, merge_equal_runs(grid));
        EXPECT_EQ(levels.back().texel_cm, 1U);
        EXPECT_EQ(levels.back().displacement_error, 0.0F);
        for (size_t k = 0; k + 1 < levels.size(); ++k) {
            EXPECT_GT(levels[k].texel_cm, levels[k + 1].texel_cm);
            EXPECT_GE(levels[k].displacement_error, levels[k + 1].displacement_error);
            EXPECT_EQ(levels[k].grid, coarsen(grid, levels[k].texel_cm));
            EXPECT_LT(levels[k].grid.labels.size(), 0.7 * static_cast<double>(levels[k + 1].grid.labels.size()));
            const double apart = difference(levels[k].grid, grid).displacement_mm * 0.001;
            EXPECT_LE(apart, static_cast<double>(levels[k].displacement_error) + 1e-6);
            // Whole millimetres, as the directory keeps them.
            const float mm = std::round(levels[k].displacement_error * 1000.0F);
            EXPECT_EQ(mm * 0.001F, levels[k].displacement_error);
        }
    }
}

TEST(MakeLevels, AWallOfWindowsHasACoarserLevelAndAPlainWallHasNone) {
    const std::vector<FacadeLevel> windows = make_levels(window_wall(6, 5));
    ASSERT_GE(windows.size(), 2U);
    EXPECT_EQ(windows[windows.size() - 2].texel_cm, 16U);
    EXPECT_EQ(make_levels({{0, 500}, {0, 500}, {kWall}}).size(), 1U);
}

TEST(MakeLevels, ShallowReliefHasNoTexelsTooCoarseToBeDrawn) {
    RunGrid shallow = window_wall(20, 20);
    for (uint32_t& label : shallow.labels) label = make_label(displacement_of(label) / 10, material_of(label));
    for (const FacadeLevel& level : make_levels(shallow)) EXPECT_LE(level.texel_cm, 4U);  // 14 mm deep
    RunGrid deep = window_wall(20, 20);
    for (uint32_t& label : deep.labels) label = make_label(displacement_of(label) * 10, material_of(label));
    EXPECT_EQ(make_levels(deep).front().texel_cm, 64U);
}

TEST(MakeLevels, CoarseTexelsAreAsLongOnTheWallWhateverTheMapsOwn) {
    const RunGrid centimetres = window_wall(6, 5);
    RunGrid fine = centimetres;  // the same wall on texels of 2 mm
    for (auto* breaks : {&fine.x_breaks, &fine.y_breaks}) {
        for (uint32_t& at : *breaks) at *= 5;
    }
    const std::vector<FacadeLevel> levels = make_levels(centimetres, 0.01), fine_levels = make_levels(fine, 0.002);
    ASSERT_GE(levels.size(), 2U);
    ASSERT_EQ(fine_levels.size(), levels.size());
    for (size_t k = 0; k < levels.size(); ++k) {
        EXPECT_EQ(fine_levels[k].texel_cm, levels[k].texel_cm);
        EXPECT_EQ(fine_levels[k].displacement_error, levels[k].displacement_error);
        EXPECT_EQ(fine_levels[k].grid.labels, levels[k].grid.labels);
    }
    EXPECT_EQ(texels_of(0.16, 0.002), 80U);
    EXPECT_EQ(texels_of(0.001, 0.002), 1U);
}

TEST(MakeLevels, TakesMapsOfOneTexelAndOfAllOpenCells) {
    EXPECT_EQ(make_levels({{0, 1}, {0, 1}, {kGlass}}).size(), 1U);
    EXPECT_EQ(make_levels({{0, 8192}, {0, 1}, {kOpen}}).size(), 1U);
    std::mt19937 random(3);
    const RunGrid row = random_grid(random, 8192, 1, 4);
    EXPECT_EQ(make_levels(row).back().grid, merge_equal_runs(row));
}

}  // namespace
}  // namespace citystream::codec::facade
