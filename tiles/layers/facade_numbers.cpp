#include "tiles/layers/facade_numbers.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "codec/facade/grid_difference.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::RunGrid;

constexpr size_t kObjectsAtOnce = 256;

/// Catalog maps in order of first use.
Result<std::vector<uint32_t>> maps_by_first_use(quadtree::ObjectSpool& objects, size_t catalog_size) {
    std::vector<uint32_t> order;
    std::vector<bool> seen(catalog_size);
    const size_t count = objects.facades() > 0 ? objects.index().size() : 0;
    for (size_t begin = 0; begin < count; begin += kObjectsAtOnce) {
        const auto loaded = objects.load(begin, std::min(begin + kObjectsAtOnce, count));
        if (!loaded) return loaded.error();
        for (const quadtree::BuildObject& object : *loaded) {
            for (const quadtree::BuildFacade& facade : object.facades) {
                if (seen[facade.map]) continue;
                seen[facade.map] = true;
                order.push_back(facade.map);
            }
        }
    }
    return order;
}

/// Equal where two maps may become one: size and, by its hash, the relief without its depths.
struct Likeness {
    uint32_t width = 0, height = 0;
    uint64_t materials = 0;
    friend auto operator<=>(const Likeness&, const Likeness&) = default;
};

Likeness likeness_of(const RunGrid& grid) {
    RunGrid flat = grid;
    for (uint32_t& label : flat.labels) {
        const bool open = codec::facade::displacement_of(label) == codec::facade::kOpenDisplacement;
        label = open ? codec::facade::make_label(codec::facade::kOpenDisplacement, 0)
                     : codec::facade::make_label(0, codec::facade::material_of(label));
    }
    flat = codec::facade::merge_equal_runs(flat);
    Likeness likeness{grid.width(), grid.height(), 0xcbf29ce484222325ULL};
    const auto mix = [&](uint32_t word) { likeness.materials = (likeness.materials ^ word) * 0x9e3779b97f4a7c15ULL; };
    for (const auto* list : {&flat.x_breaks, &flat.y_breaks, &flat.labels}) {
        for (const uint32_t word : *list) {
            mix(word);
            likeness.materials ^= likeness.materials >> 29;
        }
    }
    return likeness;
}

/// Mean displacement of the cells that are not open, over all texels: maps that nowhere differ by more than a tolerance
/// have means that do not either.
double mean_displacement(const RunGrid& grid) {
    double sum = 0;
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        const double height = grid.y_breaks[row + 1] - grid.y_breaks[row];
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const int32_t depth = codec::facade::displacement_of(grid.label(column, row));
            if (depth == codec::facade::kOpenDisplacement) continue;
            sum += height * (grid.x_breaks[column + 1] - grid.x_breaks[column]) * depth;
        }
    }
    return sum / (static_cast<double>(grid.width()) * grid.height());
}

class Merger {
  public:
    Merger(const city::FacadeCatalog& catalog, int32_t tolerance_mm) : catalog_(catalog), tolerance_(tolerance_mm) {}

    struct Match {
        uint32_t map;
        int32_t difference_mm;
    };
    /// The first map before this one that may stand for it; else this one may stand for others from now on.
    std::optional<Match> match_or_keep(uint32_t map) {
        const RunGrid grid = catalog_.map(map);
        const double mean = mean_displacement(grid);
        std::multimap<double, Kept>& alike = kept_[likeness_of(grid)];
        constexpr double kRounding = 1e-6;
        std::set<Kept> near;
        const auto end = alike.upper_bound(mean + tolerance_ + kRounding);
        for (auto at = alike.lower_bound(mean - tolerance_ - kRounding); at != end; ++at) near.insert(at->second);
        for (const Kept& candidate : near) {
            const auto found = codec::facade::difference(catalog_.map(candidate.map), grid);
            if (!found.materials && !found.openings && found.displacement_mm <= tolerance_)
                return Match{candidate.map, found.displacement_mm};
        }
        alike.emplace(mean, Kept{count_++, map});
        return std::nullopt;
    }

  private:
    struct Kept {
        uint32_t order = 0, map = 0;
        friend auto operator<=>(const Kept&, const Kept&) = default;
    };
    const city::FacadeCatalog& catalog_;
    int32_t tolerance_;
    uint32_t count_ = 0;
    std::map<Likeness, std::multimap<double, Kept>> kept_;  // by mean displacement
};

}  // namespace

Result<FacadeNumbers> number_facades(quadtree::ObjectSpool& objects, const city::FacadeCatalog& catalog,
                                     uint32_t tolerance_mm) {
    const auto order = maps_by_first_use(objects, catalog.size());
    if (!order) return order.error();
    FacadeNumbers numbers;
    numbers.shown.resize(catalog.size(), FacadeNumbers::kUnused);
    numbers.number.resize(catalog.size(), FacadeNumbers::kUnused);
    Merger merger(catalog, static_cast<int32_t>(std::min<uint32_t>(tolerance_mm, INT16_MAX)));
    for (const uint32_t map : *order) {
        const auto match = tolerance_mm > 0 ? merger.match_or_keep(map) : std::nullopt;
        numbers.shown[map] = match ? match->map : map;
        if (match) {
            ++numbers.merged;
            numbers.greatest_difference_mm = std::max(numbers.greatest_difference_mm, match->difference_mm);
            continue;
        }
        numbers.number[map] = static_cast<uint32_t>(numbers.maps.size());
        numbers.maps.push_back(map);
    }
    return numbers;
}

}  // namespace citystream::tiles::layers
