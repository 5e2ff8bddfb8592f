#include "tiles/layers/relief_extraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "tiles/layers/relief_extraction_map.h"
#include "tiles/layers/relief_extraction_pictures.h"
#include "tiles/layers/relief_extraction_views.h"

namespace citystream::tiles::layers {
namespace {

using namespace relief;

constexpr double kTexelMetres = 0.001;  // coarser along sides of more texels than a map can have
constexpr double kStairMetres = 0.015;
constexpr size_t kMostCells = size_t{1} << 21;
constexpr double kMostFalseShare = 0.002, kLeastFalseArea = 0.03;
constexpr uint32_t kLeastInside = 8;  // triangles
constexpr double kNearlyAll = 0.95, kLeastPerBreak = 0.1;
constexpr int kMostRounds = 16;
constexpr double kLeastWrongRays = 4, kMostWrongOfPatch = 0.1, kStrictest = 0.01;
constexpr double kLeastLeft = 0.4;  // of what was to be replaced: with less, the wall is not a relief
constexpr double kFootMetres = 0.1;
constexpr double kLeastClosed = 2;  // square metres of relief
/// Depth windows tried behind the wall: a shallower one makes the solid behind the relief thinner.
constexpr std::array<double, 4> kShares = {1, 0.4, 0.2, 0.08};

/// A facade of one wall, not yet in the catalog.
struct Attempt {
    FacadeParts facade;
    Decision decision;
    CellGrid cells;
    uint32_t replaced = 0;
    double behind = 0;  ///< metres of the depth window
};

double breaks_of(const Attempt& attempt) {
    return attempt.cells.u.cells() + attempt.cells.v.cells();
}

double texel_of(const CellGrid& cells) {
    return std::max(cells.u.texel(), cells.v.texel());
}

double closed_area(const Attempt& attempt) {
    const Axis &u = attempt.cells.u, &v = attempt.cells.v;
    double area = 0;
    for (size_t row = 0; row < v.cells(); ++row) {
        for (size_t column = 0; column < u.cells(); ++column) {
            if (attempt.decision.top[row * u.cells() + column] != kNone)
                area += (u.at[column + 1] - u.at[column]) * (v.at[row + 1] - v.at[row]);
        }
    }
    return area;
}

/// Windows or doors, or parts off the wall's plane that do not stand on its foot: prisms of plain walls have neither.
bool has_relief(const city::CityObject& object, const Attempt& attempt) {
    const auto& patches = attempt.facade.patches;
    double foot = 1e300;
    const Patch* wall = nullptr;
    for (size_t i = 0; i < attempt.facade.parts.size(); ++i) {
        const Part& part = attempt.facade.parts[i];
        if (part.kind != PartKind::kFlat || attempt.decision.shown[i] == 0) continue;
        foot = std::min(foot, part.low.v);
        if (wall == nullptr || patches[part.patch].area > wall->area) wall = &patches[part.patch];
    }
    for (size_t i = 0; i < attempt.facade.parts.size(); ++i) {
        const Part& part = attempt.facade.parts[i];
        if (part.kind != PartKind::kFlat || attempt.decision.shown[i] == 0) continue;
        const city::SurfaceKind surface = object.triangles[part.triangle].surface;
        if (surface == city::SurfaceKind::kWindow || surface == city::SurfaceKind::kDoor) return true;
        const Patch& patch = patches[part.patch];
        if (patch.level_mm != wall->level_mm && patch.low.v > foot + kFootMetres) return true;
    }
    return false;
}

}  // namespace

class ReliefExtractor::Impl {
  public:
    Impl(city::CityCatalog& catalog, ReliefExtractionOptions options)
        : catalog_(catalog), pictures_(catalog), options_(options) {
        for (uint32_t i = 0; i < catalog.palettes.size(); ++i) palettes_.emplace(catalog.palettes[i].material, i);
    }

    void extract(city::CityObject& object) {
        if (object.kind != city::ObjectKind::kBuilding || !object.facades.empty()) return;
        ++report_.buildings;
        report_.triangles_before += object.triangles.size();
        taken_.assign(object.triangles.size(), 0);
        for (const WallFrame& frame : find_wall_frames(object, options_)) {
            ++report_.candidate_planes;
            take_wall(object, frame);
        }
        if (!object.facades.empty()) {
            ++report_.buildings_with_relief;
            drop_taken(object);
        }
        report_.triangles_after += object.triangles.size();
    }

    ReliefExtractionReport report() const {
        ReliefExtractionReport report = report_;
        if (replaced_area_ > 0) report.mean_error = error_sum_ / replaced_area_;
        return report;
    }

  private:
    /// The shallowest depth window that still replaces nearly all: the solid behind the relief stays thin.
    void take_wall(city::CityObject& object, const WallFrame& frame) {
        Attempt best;
        const double most_false = std::max(kLeastFalseArea, kMostFalseShare * frame.area);
        for (const double share : kShares) {
            const double behind = options_.depth_behind * share;
            if (best.replaced > 0 && best.decision.deepest >= -behind) continue;
            Attempt attempt;
            if (!try_wall(object, frame, behind, attempt)) break;
            if (!is_worthwhile(object, attempt) || attempt.decision.false_sides > most_false) continue;
            if (attempt.replaced < kNearlyAll * best.replaced) break;
            best = std::move(attempt);
        }
        if (best.replaced > 0) check(object, frame, best);
    }

    /// Gives back to the mesh what is not seen as before, or all of it.
    void check(city::CityObject& object, const WallFrame& frame, Attempt& attempt) {
        const LayerStack stack(attempt.cells, attempt.facade, -attempt.behind);
        const Surroundings surroundings(frame, attempt.facade, options_.tolerance + attempt.cells.stair);
        const WallViews views(frame, attempt.facade, taken_, catalog_);
        double most_of_patch = kMostWrongOfPatch;
        const double least_left = kLeastLeft * attempt.replaced;
        for (int round = 0;; ++round) {
            Decider decider(attempt.cells, stack, surroundings, attempt.facade, options_.tolerance);
            attempt.decision = decider.decide();
            attempt.replaced = static_cast<uint32_t>(
                std::count(attempt.decision.replaced.begin(), attempt.decision.replaced.end(), 1));
            if (!is_worthwhile(object, attempt)) return;
            const SlotTable slots = choose_slots(attempt.facade, attempt.decision, catalog_);
            const ReliefMap map =
                make_relief_map(attempt.cells, attempt.facade, attempt.decision, slots, options_.tolerance);
            const ViewDifference difference = views.compare(decider, attempt.decision, map, slots);
            const bool is_wrong = difference.wrong_share() > options_.most_wrong;
            bool again = round < kMostRounds && keep_wrong_patches(attempt.facade, difference, most_of_patch);
            // Rather some more patches than the whole wall.
            while (round < kMostRounds && is_wrong && !again && most_of_patch > kStrictest) {
                most_of_patch /= 2;
                again = keep_wrong_patches(attempt.facade, difference, most_of_patch);
            }
            if (again) continue;
            if (is_wrong || attempt.replaced < least_left) {
                ++report_.facades_given_back;
                return;
            }
            report_.rays += difference.rays;
            report_.rays_wrong += difference.wrong;
            finish(object, frame, attempt, slots, map);
            return;
        }
    }

    /// True when there were any.
    static bool keep_wrong_patches(FacadeParts& facade, const ViewDifference& difference, double most_of_patch) {
        bool any = false;
        for (size_t i = 0; i < facade.patches.size(); ++i) {
            const double rays = difference.patch_rays[i], wrong = difference.patch_wrong[i];
            if (facade.patches[i].kept || wrong < kLeastWrongRays || wrong <= most_of_patch * rays) continue;
            facade.patches[i].kept = any = true;
        }
        return any;
    }

    /// A gable's outline alone takes hundreds of steps to save a few triangles.
    bool is_worthwhile(const city::CityObject& object, const Attempt& attempt) const {
        return has_relief(object, attempt) && attempt.replaced >= options_.least_replaced &&
               attempt.replaced >= kLeastPerBreak * breaks_of(attempt) && closed_area(attempt) >= kLeastClosed;
    }

    /// False when there is too little to replace, whatever the depth.
    bool try_wall(const city::CityObject& object, const WallFrame& frame, double behind, Attempt& attempt) {
        attempt.behind = behind;
        attempt.facade = gather_parts(object, frame, taken_, behind, options_);
        const auto inside = std::count_if(attempt.facade.parts.begin(), attempt.facade.parts.end(),
                                          [](const Part& part) { return part.kind != PartKind::kOutside; });
        if (inside < kLeastInside || attempt.facade.patches.empty()) return false;
        attempt.cells = make_cell_grid(frame, attempt.facade, kTexelMetres, kStairMetres, kMostCells);
        if (static_cast<double>(inside) < kLeastPerBreak * breaks_of(attempt)) return false;
        flatten_pictures(object, attempt.facade, pictures_, catalog_);
        const LayerStack stack(attempt.cells, attempt.facade, -behind);
        const Surroundings surroundings(frame, attempt.facade, options_.tolerance + attempt.cells.stair);
        attempt.decision = Decider(attempt.cells, stack, surroundings, attempt.facade, options_.tolerance).decide();
        attempt.replaced =
            static_cast<uint32_t>(std::count(attempt.decision.replaced.begin(), attempt.decision.replaced.end(), 1));
        return true;
    }

    void finish(city::CityObject& object, const WallFrame& frame, const Attempt& attempt, const SlotTable& slots,
                const ReliefMap& map) {
        city::FacadeWall wall;
        wall.lower_left = frame.world({map.left, map.bottom, 0});
        wall.along = {frame.along.x * (map.right - map.left), frame.along.y * (map.right - map.left)};
        wall.height = map.top - map.bottom;
        wall.map = catalog_.facade_maps.add(map.grid, texel_of(attempt.cells));
        wall.palette = palette_index(slots.palette);
        object.facades.push_back(wall);
        ++report_.facades;
        report_.facade_area += wall.height * (map.right - map.left);
        report_.materials_merged += slots.merged;
        count_replaced(attempt);
    }

    void count_replaced(const Attempt& attempt) {
        for (size_t i = 0; i < attempt.facade.parts.size(); ++i) {
            const Part& part = attempt.facade.parts[i];
            if (attempt.decision.replaced[i] == 0) continue;
            taken_[part.triangle] = 1;
            if (attempt.decision.shown[i] == 0) ++report_.triangles_hidden;
            if (attempt.decision.shown[i] != 0 && part.look != part.material) ++report_.textures_flattened;
            if (part.kind != PartKind::kFlat || attempt.decision.shown[i] == 0) continue;
            const double level = attempt.facade.patches[part.patch].level_mm * 0.001;
            double sum = 0;
            for (const Point& p : part.corner) {
                report_.largest_error = std::max(report_.largest_error, std::abs(p.w - level));
                sum += std::abs(p.w - level);
            }
            error_sum_ += part.area * sum / 3;
            replaced_area_ += part.area;
        }
    }

    uint32_t palette_index(const city::FacadePalette& palette) {
        const auto [found, is_new] =
            palettes_.emplace(palette.material, static_cast<uint32_t>(catalog_.palettes.size()));
        if (is_new) catalog_.palettes.push_back(palette);
        return found->second;
    }

    void drop_taken(city::CityObject& object) const {
        std::vector<city::Triangle> kept;
        for (size_t i = 0; i < object.triangles.size(); ++i) {
            if (taken_[i] == 0) kept.push_back(object.triangles[i]);
        }
        constexpr uint32_t kUnused = UINT32_MAX;
        std::vector<uint32_t> place(object.vertices.size(), kUnused);
        std::vector<city::Vec3> vertices;
        for (city::Triangle& t : kept) {
            for (uint32_t& vertex : t.vertex) {
                if (place[vertex] == kUnused) {
                    place[vertex] = static_cast<uint32_t>(vertices.size());
                    vertices.push_back(object.vertices[vertex]);
                }
                vertex = place[vertex];
            }
        }
        object.triangles = std::move(kept);
        object.vertices = std::move(vertices);
    }

    city::CityCatalog& catalog_;
    Pictures pictures_;
    ReliefExtractionOptions options_;
    ReliefExtractionReport report_;
    double error_sum_ = 0, replaced_area_ = 0;
    std::vector<uint8_t> taken_;
    std::map<std::array<uint32_t, FACADE_PALETTE_SLOTS>, uint32_t> palettes_;
};

ReliefExtractor::ReliefExtractor(city::CityCatalog& catalog, ReliefExtractionOptions options)
    : impl_(std::make_unique<Impl>(catalog, options)) {}
ReliefExtractor::~ReliefExtractor() = default;
void ReliefExtractor::extract(city::CityObject& object) {
    impl_->extract(object);
}
ReliefExtractionReport ReliefExtractor::report() const {
    return impl_->report();
}

}  // namespace citystream::tiles::layers
