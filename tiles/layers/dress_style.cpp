#include "tiles/layers/dress_style.h"

#include <algorithm>
#include <cmath>

#include "tiles/city/generator_random.h"
#include "tiles/layers/dress_plan.h"

namespace citystream::tiles::layers {
namespace {

using city::procedural::FacadeRole;
using city::procedural::FacadeUse;
using city::procedural::Random;

constexpr uint64_t kDressSalt = 0x6472657373ULL;  // keeps the draws apart from the generator's
constexpr int kFirstShopVariant = 3;              // of apartments: three eras without, three with
// Metres: from where offices are towers, to where houses, halls and garages are found.
constexpr double kHighRise = 20, kMostHouse = 13, kMostGarage = 3.6;
constexpr double kClearlyBetter = 0.04;                                  // a storey's height by 4 %
constexpr double kLeastMain = 2.6, kLeastFront = 3.0, kLeastRear = 4.0;  // metres: room for a door and a window

/// The widest wall, of those across `direction` when it is given; ties by place, so that triangle order does not
/// matter. Nothing (size) when there is none.
size_t widest(std::span<const WallRegion> walls, const city::Vec2* across) {
    size_t best = walls.size();
    const auto before = [&](size_t a, size_t b) {
        const double wa = walls[a].width(), wb = walls[b].width();
        return std::abs(wa - wb) > 0.01 ? wa > wb : walls[a].columns.front() < walls[b].columns.front();
    };
    for (size_t w = 0; w < walls.size(); ++w) {
        if (across != nullptr) {
            const city::Vec2 u = walls[w].direction();
            if (std::abs(u.x * across->x + u.y * across->y) > 0.5) continue;
        }
        if (best == walls.size() || before(w, best)) best = w;
    }
    return best;
}

double roof_area(const city::CityObject& object, const GridObject& grid) {
    double area = 0;
    for (const city::Triangle& triangle : object.triangles) {
        const GridPoint &a = grid.points[triangle.vertex[0]], &b = grid.points[triangle.vertex[1]],
                        &c = grid.points[triangle.vertex[2]];
        const double up = static_cast<double>((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
        if (up > 0) area += up / 2;
    }
    return area * kMetresPerGridUnit * kMetresPerGridUnit;
}

FacadeUse use_by_shape(const BuildingShape& shape, Random& random) {
    const double h = shape.height, area = shape.footprint, narrow = std::min(shape.length, shape.depth);
    if (h <= 3.6 && area <= 45) return FacadeUse::kGarage;
    if (h >= 60) return FacadeUse::kTower;
    if (h >= 31) return random.chance(area > 900 ? 75 : 35) ? FacadeUse::kTower : FacadeUse::kApartment;
    if (area >= 700 && h >= 5.6 && h <= 15 && shape.elongation() < 4)
        return random.chance(h < 11 ? 80 : 35) ? FacadeUse::kHall : FacadeUse::kApartment;
    if (h <= 13 && h >= 5.5 && narrow <= 7 && shape.elongation() >= 1.8 && area <= 160 && random.chance(65))
        return FacadeUse::kRowHouse;
    if (h <= 10 && area <= 140) return random.chance(88) ? FacadeUse::kHouse : FacadeUse::kApartment;
    if (h <= 8 && area <= 260) return random.chance(70) ? FacadeUse::kHouse : FacadeUse::kApartment;
    if (h >= 23 && random.chance(40)) return FacadeUse::kTower;
    return FacadeUse::kApartment;
}

/// The grammar's facades that suit a use at this height; what is low has no tower's, what is high no house's.
FacadeUse use_of(const BuildingShape& shape, const city::BuildingFacts& facts, Random& random) {
    const FacadeUse guess = use_by_shape(shape, random);
    const bool high = shape.height >= kHighRise, low = shape.height <= kMostHouse;
    switch (facts.use) {
        case city::BuildingUse::kUnknown:
            break;
        case city::BuildingUse::kHouse:
            return !low ? FacadeUse::kApartment : guess == FacadeUse::kRowHouse ? guess : FacadeUse::kHouse;
        case city::BuildingUse::kResidential:
            if (guess == FacadeUse::kHouse || guess == FacadeUse::kRowHouse) return guess;
            return FacadeUse::kApartment;
        case city::BuildingUse::kApartments:
        case city::BuildingUse::kShop:
            return FacadeUse::kApartment;
        case city::BuildingUse::kOffice:
            return high ? FacadeUse::kTower : FacadeUse::kApartment;
        case city::BuildingUse::kHall:
            return low ? FacadeUse::kHall : high ? FacadeUse::kTower : FacadeUse::kApartment;
        case city::BuildingUse::kGarage:
            return shape.height <= kMostGarage ? FacadeUse::kGarage : low ? FacadeUse::kHall : FacadeUse::kApartment;
    }
    const bool one_storey = guess == FacadeUse::kHall || guess == FacadeUse::kGarage;
    return one_storey && facts.storeys >= 2 ? FacadeUse::kApartment : guess;
}

/// How far a variant's storeys are from the building's, as a factor's logarithm.
double storey_misfit(FacadeUse use, int variant, double height, int storeys) {
    const DressStoreys own = dress_storeys(use, variant);
    return std::abs(std::log(100 * height / (own.ground + (storeys - 1) * own.floor + own.top)));
}

/// The drawn variant, unless the storeys of another fit clearly better.
uint8_t variant_of(const BuildingStyle& style, const BuildingShape& shape, int storeys) {
    const int variants = kDressVariants[static_cast<size_t>(style.use)];
    int best = style.variant;
    double least = storey_misfit(style.use, best, shape.height, storeys) - kClearlyBetter;
    for (int i = 1; i < variants; ++i) {
        const int variant = (style.variant + i) % variants;
        const double misfit = storey_misfit(style.use, variant, shape.height, storeys);
        if (misfit >= least) continue;
        least = misfit;
        best = variant;
    }
    return static_cast<uint8_t>(best);
}

}  // namespace

double BuildingShape::elongation() const {
    const double shorter = std::max(0.1, std::min(length, depth));
    return std::max(length, depth) / shorter;
}

BuildingShape shape_of(const city::CityObject& object, const GridObject& grid, std::span<const WallRegion> walls) {
    BuildingShape shape;
    shape.height = to_metres(grid.top - grid.bottom);
    const city::Vec2 u = walls[widest(walls, nullptr)].direction();
    std::array<double, 2> low = {HUGE_VAL, HUGE_VAL}, high = {-HUGE_VAL, -HUGE_VAL};
    const GridPoint& origin = grid.points.front();
    for (const GridPoint& p : grid.points) {
        const double x = to_metres(p.x - origin.x), y = to_metres(p.y - origin.y);
        const std::array<double, 2> at = {u.x * x + u.y * y, u.x * y - u.y * x};
        for (size_t k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], at[k]);
            high[k] = std::max(high[k], at[k]);
        }
    }
    shape.length = high[0] - low[0];
    shape.depth = high[1] - low[1];
    shape.footprint = roof_area(object, grid);
    if (shape.footprint <= 0) shape.footprint = shape.length * shape.depth;
    return shape;
}

BuildingStyle style_of(const BuildingShape& shape, const StyleDraws& draws, const city::BuildingFacts& facts) {
    Random random(draws.building);
    BuildingStyle style;
    style.use = use_of(shape, facts, random);
    style.variant = static_cast<uint8_t>(random.below(kDressVariants[static_cast<size_t>(style.use)]));
    if (style.use == FacadeUse::kHall)  // variants 0 to 3 are 6 to 9 m high
        style.variant = static_cast<uint8_t>(std::clamp(std::lround(shape.height - 6), 0L, 3L));
    else if (facts.storeys > 0 && style.use != FacadeUse::kGarage)
        style.variant = variant_of(style, shape, facts.storeys);
    style.shop = style.use == FacadeUse::kApartment &&
                 (style.variant >= kFirstShopVariant || facts.use == city::BuildingUse::kShop);
    style.short_side_front = style.use == FacadeUse::kRowHouse || (style.use == FacadeUse::kHouse && random.chance(35));
    style.palette_draw = city::procedural::hash(draws.district, static_cast<int64_t>(style.use), style.variant);
    return style;
}

StyleDraws draws_of(uint64_t seed, std::string_view id, const GridObject& grid) {
    constexpr int kDistrictBits = kGridBits + 9;
    const GridPoint& first =
        *std::min_element(grid.points.begin(), grid.points.end(), [](const GridPoint& a, const GridPoint& b) {
            return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
        });
    uint64_t word = city::procedural::mix(seed ^ kDressSalt);
    StyleDraws draws;
    draws.district = city::procedural::hash(word, first.x >> kDistrictBits, first.y >> kDistrictBits);
    for (char c : id) word = (word ^ static_cast<unsigned char>(c)) * 0x100000001B3ULL;  // FNV-1a
    draws.building = id.empty() ? city::procedural::hash(word, first.x, first.y, first.z) : city::procedural::mix(word);
    return draws;
}

std::vector<FacadeRole> wall_roles(std::span<const WallRegion> walls, const BuildingStyle& style) {
    size_t main = walls.size();
    if (style.short_side_front) {
        const city::Vec2 along = walls[widest(walls, nullptr)].direction();
        main = widest(walls, &along);
    }
    if (main == walls.size() || walls[main].width() < kLeastFront) main = widest(walls, nullptr);
    const city::Vec2 front = walls[main].direction();
    const bool one_door =
        style.use == FacadeUse::kHouse || style.use == FacadeUse::kRowHouse || style.use == FacadeUse::kGarage;
    std::vector<FacadeRole> roles(walls.size(), FacadeRole::kSide);
    size_t rear = walls.size();
    for (size_t w = 0; w < walls.size(); ++w) {
        const city::Vec2 u = walls[w].direction();
        const double facing = u.x * front.x + u.y * front.y, width = walls[w].width();
        if ((w == main && width >= kLeastMain) || (!one_door && facing > 0.7 && width >= kLeastFront + 1))
            roles[w] = FacadeRole::kFront;
        else if (facing < -0.7 && width >= kLeastRear && !one_door)
            roles[w] = FacadeRole::kRear;
        else if (facing < -0.7 && width >= kLeastRear && (rear == walls.size() || width > walls[rear].width()))
            rear = w;
    }
    if (rear != walls.size()) roles[rear] = FacadeRole::kRear;
    return roles;
}

}  // namespace citystream::tiles::layers
