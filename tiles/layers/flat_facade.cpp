#include "tiles/layers/flat_facade.h"

#include <utility>

#include "codec/facade/facade_levels.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::RunGrid;

constexpr uint32_t kWhole = 65536;
constexpr size_t kMostPanels = 8;
constexpr double kFinestTexel = 0.08, kCoarsestTexel = 1.28;  // metres
constexpr uint32_t kClosed = codec::facade::make_label(0, 0);

/// Closed and open cells, and no other difference.
RunGrid silhouette(RunGrid grid) {
    for (uint32_t& label : grid.labels) {
        const bool open = codec::facade::displacement_of(label) == codec::facade::kOpenDisplacement;
        label = open ? codec::facade::make_label(codec::facade::kOpenDisplacement, 0) : kClosed;
    }
    return codec::facade::merge_equal_runs(grid);
}

uint32_t fraction(uint32_t texel, uint32_t size) {
    return static_cast<uint32_t>(uint64_t{kWhole} * texel / size);
}

/// Largest runs of closed cells row by row, each as high as it can be.
std::vector<FacadePanel> closed_rectangles(const RunGrid& grid) {
    const uint32_t columns = grid.columns(), rows = grid.rows();
    std::vector<bool> free(grid.labels.size());
    for (size_t i = 0; i < free.size(); ++i) free[i] = grid.labels[i] == kClosed;
    std::vector<FacadePanel> panels;
    for (uint32_t row = 0; row < rows; ++row) {
        for (uint32_t column = 0; column < columns; ++column) {
            const auto is_free = [&](uint32_t c, uint32_t r) { return free[size_t{r} * columns + c]; };
            if (!is_free(column, row)) continue;
            uint32_t right = column, top = row;
            while (right < columns && is_free(right, row)) ++right;
            const auto row_is_free = [&](uint32_t r) {
                for (uint32_t c = column; c < right; ++c) {
                    if (!is_free(c, r)) return false;
                }
                return true;
            };
            while (top < rows && row_is_free(top)) ++top;
            for (uint32_t r = row; r < top; ++r) {
                for (uint32_t c = column; c < right; ++c) free[size_t{r} * columns + c] = false;
            }
            panels.push_back(
                {{fraction(grid.x_breaks[column], grid.width()), fraction(grid.y_breaks[row], grid.height())},
                 {fraction(grid.x_breaks[right], grid.width()), fraction(grid.y_breaks[top], grid.height())}});
        }
    }
    return panels;
}

int64_t part_of(int64_t length, uint32_t share) {
    return (length * share + kWhole / 2) >> 16;
}

}  // namespace

FacadePanels flat_panels(const RunGrid& map, double texel_metres) {
    if (!map.has_open_cells()) return {{{{0, 0}, {kWhole, kWhole}}}, 0};
    const RunGrid outline = silhouette(map);
    FacadePanels flat;
    for (double metres = kFinestTexel; metres <= kCoarsestTexel; metres *= 2) {
        const uint32_t texels = codec::facade::texels_of(metres, texel_metres);
        flat = {closed_rectangles(codec::facade::coarsen(outline, texels)), texels * texel_metres};
        if (flat.panels.size() <= kMostPanels) break;
    }
    return flat;
}

FlatQuad flat_quad(const quadtree::BuildFacade& facade, const FacadePanel& panel) {
    constexpr std::array<std::array<bool, 2>, 4> kFar = {{{false, false}, {true, false}, {true, true}, {false, true}}};
    FlatQuad quad;
    for (size_t k = 0; k < 4; ++k) {
        const uint32_t x = kFar[k][0] ? panel.hi[0] : panel.lo[0], y = kFar[k][1] ? panel.hi[1] : panel.lo[1];
        quad.corners[k] = {facade.origin.x + part_of(facade.along[0], x), facade.origin.y + part_of(facade.along[1], x),
                           facade.origin.z + part_of(facade.height, y)};
        quad.texcoords[k] = {x, y};
    }
    return quad;
}

void add_flat_wall(quadtree::BuildObject& object, const quadtree::BuildFacade& facade, const FacadePanels& flat,
                   const quadtree::Paint& paint) {
    const uint32_t paint_index = object.paint_index(paint);
    constexpr std::array<std::array<uint32_t, 3>, 2> kTriangles = {{{0, 1, 2}, {0, 2, 3}}};
    for (const FacadePanel& panel : flat.panels) {
        const auto base = static_cast<uint32_t>(object.vertices.size());
        const FlatQuad quad = flat_quad(facade, panel);
        for (const GridPoint& corner : quad.corners) object.vertices.push_back(corner);
        for (const auto& corners : kTriangles) {
            quadtree::BuildTriangle triangle;
            triangle.paint = paint_index;
            triangle.surface = city::SurfaceKind::kWall;
            for (size_t k = 0; k < 3; ++k) {
                triangle.vertex[k] = base + corners[k];
                triangle.texcoord[k] = quad.texcoords[corners[k]];
            }
            object.triangles.push_back(triangle);
        }
    }
}

}  // namespace citystream::tiles::layers
