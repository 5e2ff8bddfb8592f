#include "tiles/city/generator_buildings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "tiles/city/generator_mesh.h"
#include "tiles/city/generator_roofs.h"
#include "tiles/city/grammar.h"

namespace citystream::tiles::city::procedural {
namespace {

constexpr int kTowerBaseFloors = 4, kTowerShaftFloors = 8;
/// How far plinths reach into the ground, and how far the ground floor stays above it.
constexpr Units kFooting = kMetre / 2, kClearance = kMetre / 16;

struct GroundRange {
    Units low = 0, high = 0;
};

/// Least and greatest height of the ground at and between the corners of a rectangle.
GroundRange ground_under(const CityPlan& plan, const Frame& frame, Point2 low, Point2 high) {
    GroundRange range{INT64_MAX, INT64_MIN};
    const auto steps_of = [](Units length) { return std::max<Units>(2, (length + 6 * kMetre - 1) / (6 * kMetre)); };
    const Units columns = steps_of(high.x - low.x), rows = steps_of(high.y - low.y);
    for (Units j = 0; j <= rows; ++j) {
        for (Units i = 0; i <= columns; ++i) {
            const Point2 at = frame.at(low.x + (high.x - low.x) * i / columns, low.y + (high.y - low.y) * j / rows);
            const Units z = plan.ground(at.x, at.y);
            range.low = std::min(range.low, z);
            range.high = std::max(range.high, z);
        }
    }
    return range;
}

uint32_t pick(const std::vector<uint32_t>& list, Random& random) {
    return list[static_cast<size_t>(random.below(static_cast<int>(list.size())))];
}

/// Shared state while one building is made.
struct Site {
    const BuildingPlan& plan;
    const MaterialSet& materials;
    FacadeDictionary& facades;
    const CityCatalog& catalog;
    ObjectBuilder& object;
    Random random;
    uint32_t palette;
    std::optional<WallDress> dress;  // textures instead of facades

    uint32_t slot(Slot slot) const {
        if (dress && (slot == Slot::kWall || slot == Slot::kPlinth)) return dress->plain.material;
        return catalog.palettes[palette].material[static_cast<size_t>(slot)];
    }
};

FacadeRole facade_role(WallRole role) {
    return role == WallRole::kFront  ? FacadeRole::kFront
           : role == WallRole::kRear ? FacadeRole::kRear
                                     : FacadeRole::kSide;
}

int cm_of(Units length) {
    return static_cast<int>(length * 100 / kMetre);
}

std::array<Point2, 5> ring_of(const BuildingPlan& plan) {
    const Units w = plan.width, d = plan.depth;
    return {plan.frame.at(0, 0), plan.frame.at(w, 0), plan.frame.at(w, d), plan.frame.at(0, d), plan.frame.at(0, 0)};
}

/// Repeats of a texture over a wall: whole windows, whole storeys; of a bare wall as many as it has metres.
Vec2 repeats_over(const WallTexture& texture, Units width, Units height) {
    const double across = metres(width) * 1000 / texture.width_mm, up = metres(height) * 1000 / texture.height_mm;
    if (texture.use == WallUse::kPlain) return {across, up};
    const auto whole = [](double repeats, int parts) {
        return std::max(1.0, std::floor(repeats * parts + 0.5)) / parts;
    };
    return {whole(across, texture.bays), whole(up, texture.storeys)};
}

/// A wall in two bands, so that walls which show their ground floor and others meet at the same corners.
void add_textured_wall(Site& site, Point2 left, Point2 right, Units width, std::array<Units, 3> levels,
                       const WallMaterial& below, const WallMaterial& above) {
    const auto [foot, middle, head] = levels;
    const Vec2 low = repeats_over(below.texture, width, middle - foot);
    site.object.wall(left, right, foot, middle, below.material, {0, 0}, low);
    if (head == middle) return;
    const double start = below.material == above.material ? low.y : 0;
    const Vec2 high = repeats_over(above.texture, width, head - middle);
    site.object.wall(left, right, middle, head, above.material, {0, start}, {high.x, start + high.y});
}

/// The same walls as add_section's, with the building's textures.
void add_textured_section(Site& site, FacadeSection section, const Storeys& storeys, Units foot) {
    const BuildingPlan& plan = site.plan;
    const WallDress& dress = *site.dress;
    const std::array<Point2, 5> ring = ring_of(plan);
    const Units head = foot + units_of_cm(storeys.height_cm());
    const bool ground_floor =
        dress.has_ground_floor && (section == FacadeSection::kWhole || section == FacadeSection::kBase);
    // What is left over a ground floor is a storey at least, or belongs to it.
    const bool two_bands = ground_floor && storeys.floors > 1;
    const Units middle = two_bands ? foot + units_of_cm(storeys.ground_cm) : head;
    // A single storey has no wall above its ground floor: its other sides show the texture meant for that.
    const WallMaterial& around = ground_floor && !two_bands ? dress.front : dress.side;
    for (size_t side = 0; side < 4; ++side) {
        const bool front = plan.use == FacadeUse::kTower || plan.walls[side] == WallRole::kFront;
        const bool party = plan.walls[side] == WallRole::kParty;
        const WallMaterial& above = party ? dress.plain : front ? dress.front : around;
        add_textured_wall(site, ring[side], ring[side + 1], side % 2 == 0 ? plan.width : plan.depth,
                          {foot, middle, head}, ground_floor && front ? dress.ground_floor : above, above);
    }
}

/// Dresses the four walls of one section; returns its height.
Units add_section(Site& site, FacadeSection section, int floors, Units foot) {
    const BuildingPlan& plan = site.plan;
    const Storeys storeys = storeys_of(plan.use, section, plan.variant, floors);
    const Units height = units_of_cm(storeys.height_cm());
    if (site.dress) {
        add_textured_section(site, section, storeys, foot);
        return height;
    }
    const std::array<Point2, 5> ring = ring_of(plan);
    for (size_t side = 0; side < 4; ++side) {
        if (plan.walls[side] == WallRole::kParty) {
            site.object.wall(ring[side], ring[side + 1], foot, foot + height, site.slot(Slot::kWall));
            continue;
        }
        FacadeSpec spec;
        spec.use = plan.use;
        spec.role = facade_role(plan.walls[side]);
        if (section == FacadeSection::kShaft || section == FacadeSection::kTop) spec.role = FacadeRole::kFront;
        spec.section = section;
        spec.variant = static_cast<uint8_t>(plan.variant);
        spec.floors = static_cast<uint8_t>(floors);
        spec.shop = plan.shop && spec.role == FacadeRole::kFront;
        spec.width_cm = static_cast<uint16_t>(cm_of(side % 2 == 0 ? plan.width : plan.depth));
        site.object.facade(ring[side], ring[side + 1], foot, height, site.facades.map_of(spec), site.palette);
    }
    return height;
}

Units add_walls(Site& site, Units foot) {
    if (site.plan.use != FacadeUse::kTower) return add_section(site, FacadeSection::kWhole, site.plan.floors, foot);
    Units height = add_section(site, FacadeSection::kBase, kTowerBaseFloors, foot);
    int left = site.plan.floors - kTowerBaseFloors;
    for (; left > kTowerShaftFloors; left -= kTowerShaftFloors)
        height += add_section(site, FacadeSection::kShaft, kTowerShaftFloors, foot + height);
    return height + add_section(site, FacadeSection::kTop, left, foot + height);
}

void add_chimney(Site& site, const RoofBase& base, Units ridge) {
    const Units x = base.width * site.random.between(2, 6) / 8, y = base.depth / 2 + kMetre / 4;
    box(site.object, base.frame, {x - kMetre / 4, y}, {x + 3 * kMetre / 8, y + 3 * kMetre / 4}, base.level + ridge / 2,
        base.level + ridge + 3 * kMetre / 4, site.materials.chimney, site.materials.coping);
}

/// Lift house and cooling units on a flat roof.
void add_machinery(Site& site, const RoofBase& base, Units drop) {
    const Units deck = base.level - drop, margin = 3 * kMetre / 2;
    const bool tower = site.plan.use == FacadeUse::kTower;
    const Units w = tower ? base.width / 3 : 3 * kMetre, d = tower ? base.depth / 3 : 4 * kMetre;
    const Units room_x = base.width - w - 2 * margin, room_y = base.depth - d - 2 * margin;
    if (room_x <= 0 || room_y <= 0) return;
    const Units x = margin + room_x * site.random.between(2, 6) / 8,
                y = margin + room_y * site.random.between(2, 6) / 8;
    box(site.object, base.frame, {x, y}, {x + w, y + d}, deck, deck + (tower ? 4 : 3) * kMetre,
        tower ? site.materials.machinery : site.slot(Slot::kWall), site.materials.flat_roof);
}

void add_roof(Site& site, Units level) {
    const BuildingPlan& plan = site.plan;
    RoofBase base{plan.frame, plan.width, plan.depth, level};
    const bool hall = plan.use == FacadeUse::kHall, house = plan.use == FacadeUse::kHouse;
    const uint32_t tiles = pick(site.materials.pitched_roofs, site.random);
    RoofMaterials roof{tiles,
                       site.slot(Slot::kWall),
                       site.materials.soffit,
                       site.materials.coping,
                       site.materials.chimney,
                       site.slot(Slot::kGlass)};
    if (hall) roof.roof = site.materials.metal_roof;
    if (plan.roof == RoofShape::kFlat) roof.roof = site.materials.flat_roof;
    RoofPitch pitch{hall ? 1 : site.random.between(6, 9), hall ? 5 : 10, 0};
    if (house) pitch.eaves = site.random.between(2, 3) * kMetre / 4;
    if (hall || plan.use == FacadeUse::kRowHouse || plan.roof == RoofShape::kGable)
        pitch.eaves = std::max(pitch.eaves, 3 * kMetre / 8);
    const Units drop = plan.use == FacadeUse::kTower       ? 5 * kMetre / 4
                       : plan.use == FacadeUse::kApartment ? 5 * kMetre / 8
                                                           : 3 * kMetre / 16;
    switch (plan.roof) {
        case RoofShape::kFlat:
            flat_roof(site.object, base, drop, roof);
            if (!house) add_machinery(site, base, drop);
            return;
        case RoofShape::kSawtooth:
            sawtooth_roof(site.object, base, roof);
            return;
        case RoofShape::kHip: {
            const Units ridge = hip_roof(site.object, base, pitch, roof);
            if (house && site.random.chance(60)) add_chimney(site, base, ridge);
            return;
        }
        case RoofShape::kCrossGable:
            base = {plan.frame.turned(plan.width), plan.depth, plan.width, level};
            [[fallthrough]];
        case RoofShape::kGable: {
            const Units ridge = gable_roof(site.object, base, pitch, roof);
            if (hall) return;
            if (site.random.chance(70)) add_chimney(site, base, ridge);
            const int dormers = plan.use == FacadeUse::kApartment ? static_cast<int>(base.width / (5 * kMetre))
                                                                  : site.random.between(0, 2);
            for (int i = 0; i < dormers; ++i)
                dormer(site.object, base, pitch, base.width * (2 * i + 1) / (2 * dormers), roof);
            return;
        }
    }
}

/// A flat-roofed garage against the left or right wall, its door to the street.
void add_garage(Site& site, Units foot, Units footing) {
    const BuildingPlan& plan = site.plan;
    const Units left = plan.garage_side < 0 ? -kGarageWidth : plan.width, right = left + kGarageWidth;
    const Units front = kGarageSetback, back = front + kGarageDepth,
                height = units_of_cm(storeys_of(FacadeUse::kGarage, FacadeSection::kWhole, 0, 1).height_cm());
    const auto at = [&plan](Units x, Units y) { return plan.frame.at(x, y); };
    if (site.dress) {
        site.object.wall(at(left, front), at(right, front), foot, foot + height, site.slot(Slot::kDoor));
    } else {
        FacadeSpec spec;
        spec.use = FacadeUse::kGarage;
        spec.width_cm = static_cast<uint16_t>(cm_of(kGarageWidth));
        site.object.facade(at(left, front), at(right, front), foot, height, site.facades.map_of(spec), site.palette);
    }
    site.object.wall(at(left, front), at(right, front), footing, foot, site.slot(Slot::kPlinth));
    const auto side = [&](Point2 from, Point2 to) {
        site.object.wall(from, to, foot, foot + height, site.slot(Slot::kWall));
        site.object.wall(from, to, footing, foot, site.slot(Slot::kPlinth));
    };
    side(at(right, back), at(left, back));
    if (plan.garage_side > 0)
        side(at(right, front), at(right, back));
    else
        side(at(left, back), at(left, front));
    const Units head = foot + height;
    site.object.polygon({lift(at(left, front), head), lift(at(right, front), head), lift(at(right, back), head),
                         lift(at(left, back), head)},
                        site.materials.flat_roof, SurfaceKind::kRoof);
}

const std::vector<uint32_t>& palettes_for(const MaterialSet& materials, FacadeUse use) {
    switch (use) {
        case FacadeUse::kApartment:
            return materials.apartment_palettes;
        case FacadeUse::kTower:
            return materials.tower_palettes;
        case FacadeUse::kHall:
            return materials.hall_palettes;
        default:
            return materials.house_palettes;
    }
}

}  // namespace

uint32_t FacadeDictionary::map_of(const FacadeSpec& spec) {
    const auto known = by_spec_.find(spec);
    if (known != by_spec_.end()) return known->second;
    const uint32_t map = catalog_.facade_maps.add(derive_facade(spec, seed_));
    by_spec_.emplace(spec, map);
    return map;
}

CityObject BuildingMaker::make(const BuildingPlan& building, std::string id) const {
    ObjectBuilder object(std::move(id), ObjectKind::kBuilding, catalog_, origin_);
    Random random(building.seed);
    const uint32_t palette = pick(palettes_for(materials_, building.use), random);
    Site site{building, materials_, facades_, catalog_, object, random, palette, std::nullopt};
    if (walls_ != nullptr) {
        Random textures(hash(building.seed, 31));
        site.dress = walls_->deal(building.use, textures);
    }
    Point2 low{0, 0}, high{building.width, building.depth};
    if (building.garage_side < 0) low.x -= kGarageWidth;
    if (building.garage_side > 0) high.x += kGarageWidth;
    const GroundRange ground = ground_under(plan_, building.frame, low, high);
    const Units foot = ground.high + kClearance, footing = ground.low - kFooting;
    const Units height = add_walls(site, foot);
    const std::array<Point2, 5> ring = ring_of(building);
    for (size_t side = 0; side < 4; ++side)
        object.wall(ring[side], ring[side + 1], footing, foot, site.slot(Slot::kPlinth));
    if (building.garage_side != 0) add_garage(site, foot, footing);
    add_roof(site, foot + height);
    return object.finish();
}

CityObject BuildingMaker::make_tree(const TreePlan& tree, std::string id) const {
    ObjectBuilder object(std::move(id), ObjectKind::kVegetation, catalog_, origin_);
    Random random(tree.seed);
    // Six directions, sixty degrees apart, in thousandths.
    constexpr std::array<Point2, 6> kDirections = {
        {{1000, 0}, {500, 866}, {-500, 866}, {-1000, 0}, {-500, -866}, {500, -866}}};
    const Units reach = random.between(12, 24) * kMetre / 10, bole = random.between(8, 12) * kMetre / 5;
    const bool conifer = random.chance(25);
    const Units belly = bole + (conifer ? 0 : reach), crown = bole + reach * (conifer ? 4 : 3);
    const Units ground = plan_.ground(tree.at.x, tree.at.y);
    const uint32_t foliage = pick(materials_.foliage, random);
    const auto around = [&](size_t i, Units radius) {
        return Point2{tree.at.x + kDirections[i % 6].x * radius / 1000,
                      tree.at.y + kDirections[i % 6].y * radius / 1000};
    };
    const Point3 top = lift(tree.at, ground + crown), below = lift(tree.at, ground + bole - kMetre / 4);
    for (size_t i = 0; i < 6; ++i) {
        const Point3 a = lift(around(i, reach), ground + belly), b = lift(around(i + 1, reach), ground + belly);
        object.polygon({a, b, top}, foliage, SurfaceKind::kUnknown);
        object.polygon({b, a, below}, foliage, SurfaceKind::kUnknown);
    }
    for (size_t i = 0; i < 6; i += 2)
        object.polygon(
            {lift(around(i, kMetre / 4), ground - kMetre / 4), lift(around(i + 2, kMetre / 4), ground - kMetre / 4),
             lift(tree.at, ground + bole + kMetre / 2)},
            materials_.bark, SurfaceKind::kUnknown);
    return object.finish();
}

}  // namespace citystream::tiles::city::procedural
