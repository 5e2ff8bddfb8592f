#include "tiles/city/generator_terrain.h"

#include <utility>
#include <vector>

#include "tiles/city/generator.h"
#include "tiles/city/generator_mesh.h"

namespace citystream::tiles::city::procedural {
namespace {

constexpr Units kCell = static_cast<Units>(kTerrainCellMetres) * kMetre;

using Part = StreetPlace::Part;

}  // namespace

/// What a rectangle of ground shows. Streets' images span the carriageway and run along it; all others lie flat on the
/// map.
struct TerrainMaker::Surface {
    enum class Mapping : uint8_t { kFlat, kAlongX, kAlongY };
    uint32_t material = 0;
    Mapping mapping = Mapping::kFlat;
    StreetLine street;
};

uint32_t TerrainMaker::block_material(int64_t block_x, int64_t block_y) const {
    const Quarter quarter{floor_div(block_x, 2), floor_div(block_y, 2)};
    if (number_of(quarter) >= quarters_) return materials_.meadow;
    switch (plan_.zone_of(block_x, block_y)) {
        case Zone::kTowers:
            return materials_.plaza;
        case Zone::kIndustry:
            return materials_.yard;
        case Zone::kMeadow:
            return materials_.meadow;
        default:
            return materials_.lawn;
    }
}

TerrainMaker::Surface TerrainMaker::surface_at(const StreetPlace& x, const StreetPlace& y) const {
    // A street that merged blocks swallowed is their ground; at a crossing it is gone when both its arms are.
    const bool x_gone =
        x.part == Part::kBlock || (plan_.closed(Axis::kX, x.line, y.block) &&
                                   (y.part == Part::kBlock || plan_.closed(Axis::kX, x.line, y.block - 1)));
    const bool y_gone =
        y.part == Part::kBlock || (plan_.closed(Axis::kY, y.line, x.block) &&
                                   (x.part == Part::kBlock || plan_.closed(Axis::kY, y.line, x.block - 1)));
    Surface surface;
    if (x_gone && y_gone) {
        // On a swallowed street the block below its line owns the ground as well as the one above.
        surface.material = block_material(x.block, y.block);
        return surface;
    }
    const bool on_x = !x_gone && x.part == Part::kCarriageway, on_y = !y_gone && y.part == Part::kCarriageway;
    const StreetLine street_x = x_gone ? StreetLine{} : plan_.line(Axis::kX, x.line);
    const StreetLine street_y = y_gone ? StreetLine{} : plan_.line(Axis::kY, y.line);
    if (on_x && on_y) {
        surface.material = materials_.asphalt;
    } else if (on_x) {
        surface.street = street_x;
        surface.mapping = Surface::Mapping::kAlongY;
        surface.material = !y_gone ? materials_.crossing : street_x.main ? materials_.main_road : materials_.road;
    } else if (on_y) {
        surface.street = street_y;
        surface.mapping = Surface::Mapping::kAlongX;
        surface.material = !x_gone ? materials_.crossing : street_y.main ? materials_.main_road : materials_.road;
    } else {
        surface.material = materials_.pavement;
    }
    return surface;
}

CityObject TerrainMaker::make(int64_t i, int64_t j, std::string id) const {
    ObjectBuilder object(std::move(id), ObjectKind::kTerrain, catalog_, origin_);
    const Point2 corner{i * kCell, j * kCell};
    const std::vector<Units> xs = plan_.breaks(Axis::kX, corner.x, corner.x + kCell);
    const std::vector<Units> ys = plan_.breaks(Axis::kY, corner.y, corner.y + kCell);
    std::vector<StreetPlace> columns;
    for (size_t c = 0; c + 1 < xs.size(); ++c) columns.push_back(plan_.place(Axis::kX, (xs[c] + xs[c + 1]) / 2));
    std::vector<std::vector<Units>> heights(ys.size());
    for (size_t r = 0; r < ys.size(); ++r)
        for (Units x : xs) heights[r].push_back(plan_.terrain(x, ys[r]));
    for (size_t r = 0; r + 1 < ys.size(); ++r) {
        const StreetPlace row = plan_.place(Axis::kY, (ys[r] + ys[r + 1]) / 2);
        for (size_t c = 0; c + 1 < xs.size(); ++c) {
            const Surface surface = surface_at(columns[c], row);
            const double metres_per_repeat =
                static_cast<double>(catalog_.materials[surface.material].metres_per_repeat);
            const auto texcoord = [&](const Point3& at) -> Vec2 {
                const double u = metres(at.x - corner.x) / metres_per_repeat,
                             v = metres(at.y - corner.y) / metres_per_repeat;
                const auto across = [&surface](Units from) {
                    return metres(from - surface.street.axis + surface.street.carriage_half) /
                           metres(2 * surface.street.carriage_half);
                };
                switch (surface.mapping) {
                    case Surface::Mapping::kAlongX:
                        return {across(at.y), u};
                    case Surface::Mapping::kAlongY:
                        return {across(at.x), v};
                    case Surface::Mapping::kFlat:
                        break;
                }
                return {u, v};
            };
            const Point3 a{xs[c], ys[r], heights[r][c]}, b{xs[c + 1], ys[r], heights[r][c + 1]},
                d{xs[c + 1], ys[r + 1], heights[r + 1][c + 1]}, e{xs[c], ys[r + 1], heights[r + 1][c]};
            object.triangle({a, b, d}, {texcoord(a), texcoord(b), texcoord(d)}, surface.material, SurfaceKind::kGround);
            object.triangle({a, d, e}, {texcoord(a), texcoord(d), texcoord(e)}, surface.material, SurfaceKind::kGround);
        }
    }
    return object.finish();
}

}  // namespace citystream::tiles::city::procedural
