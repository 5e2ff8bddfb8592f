#include "tiles/city/generator.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "tiles/city/generator_buildings.h"
#include "tiles/city/generator_terrain.h"
#include "tiles/city/generator_walls.h"

namespace citystream::tiles::city {
namespace {

using namespace procedural;

/// Counts what goes out and tells of progress, a thousand times at most.
class Outlet {
  public:
    Outlet(const GeneratorOptions& options, CityReport& report, const CitySink& sink)
        : options_(options), report_(report), sink_(sink) {}

    /// False once the sink wants no more.
    bool put(CityObject&& object) {
        ++report_.objects_emitted;
        report_.triangles_emitted += object.triangles.size();
        if (object.kind == ObjectKind::kBuilding) {
            ++report_.features_read;
            ++report_.buildings_emitted;
            tell();
        }
        return sink_(std::move(object));
    }

  private:
    void tell() {
        const uint64_t step = std::max<uint64_t>(1, (uint64_t{options_.buildings} + 999) / 1000);
        const uint64_t done = report_.buildings_emitted;
        if (options_.progress && (done % step == 0 || done == options_.buildings))
            options_.progress(done, options_.buildings);
    }

    const GeneratorOptions& options_;
    CityReport& report_;
    const CitySink& sink_;
};

/// The rectangle of quarters that hold the city.
struct QuarterRange {
    Quarter low, high;
    void include(Quarter quarter) {
        low = {std::min(low.i, quarter.i), std::min(low.j, quarter.j)};
        high = {std::max(high.i, quarter.i), std::max(high.j, quarter.j)};
    }
};

/// What all buildings together will want; the plan alone says so.
WallDemand demand_of(const CityPlan& plan, uint32_t buildings) {
    WallDemand demand{};
    uint32_t planned = 0;
    for (uint64_t quarter = 0; planned < buildings; ++quarter) {
        for (const Block& block : plan.blocks(quarter_at(quarter))) {
            for (const BuildingPlan& building : plan_block(block).buildings)
                if (planned++ < buildings) add_demand(demand, building.use);
        }
    }
    return demand;
}

/// One run of the generator.
class Generator {
  public:
    Generator(const GeneratorOptions& options, CityCatalog& catalog, CityReport& report, const CitySink& sink)
        : options_(options),
          catalog_(catalog),
          plan_(options.seed, options.buildings),
          materials_(make_materials(catalog, options.seed)),
          facades_(catalog, options.seed),
          maker_(plan_, materials_, facades_, catalog, options.origin),
          outlet_(options, report, sink) {
        if (options.textures == 0) return;
        walls_.emplace(catalog, options.seed, options.textures, demand_of(plan_, options.buildings));
        maker_.texture_walls(*walls_);
    }

    void run() {
        if (put_quarters() && put_country()) put_terrain();
    }

  private:
    bool put_block(const Block& block) {
        const BlockPlan planned = plan_block(block);
        for (const BuildingPlan& building : planned.buildings) {
            if (buildings_ == options_.buildings) break;
            if (!outlet_.put(maker_.make(building, "building-" + std::to_string(++buildings_)))) return false;
        }
        for (const TreePlan& tree : planned.trees)
            if (!outlet_.put(maker_.make_tree(tree, "tree-" + std::to_string(++trees_)))) return false;
        return true;
    }

    /// Quarter by quarter along the spiral until every building stands.
    bool put_quarters() {
        while (quarters_ == 0 || buildings_ < options_.buildings) {
            const Quarter quarter = quarter_at(quarters_++);
            range_.include(quarter);
            for (const Block& block : plan_.blocks(quarter))
                if (!put_block(block)) return false;
        }
        return true;
    }

    /// Trees in the quarters that the spiral has not reached.
    bool put_country() {
        for (int64_t j = range_.low.j; j <= range_.high.j; ++j) {
            for (int64_t i = range_.low.i; i <= range_.high.i; ++i) {
                if (number_of({i, j}) < quarters_) continue;
                for (Block block : plan_.blocks({i, j})) {
                    block.zone = Zone::kMeadow;
                    if (!put_block(block)) return false;
                }
            }
        }
        return true;
    }

    /// Every cell that the city's quarters and the streets around them touch.
    void put_terrain() {
        const TerrainMaker terrain(plan_, materials_, catalog_, options_.origin, quarters_);
        constexpr Units cell = static_cast<Units>(kTerrainCellMetres) * kMetre;
        const auto first = [this](Axis axis, int64_t quarter) {
            const StreetLine street = plan_.line(axis, 2 * quarter);
            return floor_div(street.axis - street.outer_half, cell);
        };
        const auto end = [this](Axis axis, int64_t quarter) {
            const StreetLine street = plan_.line(axis, 2 * quarter + 2);
            return floor_div(street.axis + street.outer_half + cell - 1, cell);
        };
        const int64_t i_end = end(Axis::kX, range_.high.i), j_end = end(Axis::kY, range_.high.j);
        for (int64_t j = first(Axis::kY, range_.low.j); j < j_end; ++j) {
            for (int64_t i = first(Axis::kX, range_.low.i); i < i_end; ++i) {
                if (!outlet_.put(terrain.make(i, j, "terrain-" + std::to_string(i) + "-" + std::to_string(j)))) return;
            }
        }
    }

    const GeneratorOptions& options_;
    CityCatalog& catalog_;
    CityPlan plan_;
    MaterialSet materials_;
    FacadeDictionary facades_;
    std::optional<WallDealer> walls_;
    BuildingMaker maker_;
    Outlet outlet_;
    QuarterRange range_;
    uint64_t quarters_ = 0;
    uint32_t buildings_ = 0;
    uint64_t trees_ = 0;
};

}  // namespace

void generate_city(const GeneratorOptions& options, CityHeader& header, CityCatalog& catalog, CityReport& report,
                   const CitySink& sink) {
    header.epsg = 0;
    header.title = "generated city (seed " + std::to_string(options.seed) + ", " + std::to_string(options.buildings) +
                   " buildings" +
                   (options.textures > 0 ? ", " + std::to_string(options.textures) + " wall textures)" : ")");
    Generator(options, catalog, report, sink).run();
}

}  // namespace citystream::tiles::city
