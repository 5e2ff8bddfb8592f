#include "tiles/city/generator_plots.h"

#include <algorithm>

namespace citystream::tiles::city::procedural {
namespace {

constexpr Units kQuarterMetre = kMetre / 4;

/// Which way a front looks: south, east, north, west.
constexpr std::array<std::array<int64_t, 2>, 4> kFacing = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

Frame facing(int side, Point2 corner) {
    Frame frame;
    frame.corner = corner;
    frame.c = kFacing[static_cast<size_t>(side)][0];
    frame.s = kFacing[static_cast<size_t>(side)][1];
    return frame;
}

struct Angle {
    int64_t c, s, h;
};

/// Puts a width x depth rectangle with its middle at `centre`, turned by `turn` from the axis frame `side`.
Frame frame_about(Point2 centre, Units width, Units depth, int side, Angle turn) {
    const auto [fc, fs] = kFacing[static_cast<size_t>(side)];
    Frame frame;
    frame.c = fc * turn.c - fs * turn.s;
    frame.s = fs * turn.c + fc * turn.s;
    frame.h = turn.h;
    const Point2 middle = frame.at(width / 2, depth / 2);
    frame.corner = {centre.x - middle.x, centre.y - middle.y};
    return frame;
}

/// Extent of a turned rectangle along the axis of its width.
Units turned_extent(Units width, Units depth, Angle turn) {
    return (width * turn.c + depth * (turn.s < 0 ? -turn.s : turn.s)) / turn.h + 2;
}

Angle small_angle(Random& random) {
    constexpr std::array<Angle, 4> kAngles = {{{24, 7, 25}, {40, 9, 41}, {60, 11, 61}, {84, 13, 85}}};
    Angle turn = kAngles[static_cast<size_t>(random.below(4))];
    if (random.chance(50)) turn.s = -turn.s;
    return turn;
}

void scatter_trees(BlockPlan& plan, Random& random, Point2 low, Point2 high, int count) {
    if (high.x <= low.x || high.y <= low.y) return;
    for (int i = 0; i < count; ++i) {
        const Units x = low.x + random.below(static_cast<int>((high.x - low.x) / kQuarterMetre)) * kQuarterMetre;
        const Units y = low.y + random.below(static_cast<int>((high.y - low.y) / kQuarterMetre)) * kQuarterMetre;
        plan.trees.push_back({{x, y}, random.next()});
    }
}

RoofShape house_roof(Random& random) {
    const int draw = random.below(100);
    return draw < 35   ? RoofShape::kGable
           : draw < 55 ? RoofShape::kCrossGable
           : draw < 88 ? RoofShape::kHip
                       : RoofShape::kFlat;
}

BuildingPlan detached_house(Random& random, int side, Point2 plot_middle, Units plot_width, Units setback) {
    BuildingPlan house;
    house.use = FacadeUse::kHouse;
    house.width = std::min<Units>(random.between(8, 12) * kMetre, (plot_width - 2 * kMetre) / kMetre * kMetre);
    house.depth = random.between(8, 10) * kMetre;
    house.walls = {WallRole::kFront, WallRole::kSide, WallRole::kRear, WallRole::kSide};
    house.variant = random.below(kFacadeVariants);
    house.floors = house.variant % 3 == 0 ? 1 : 2;
    house.roof = house_roof(random);
    house.seed = random.next();
    Angle turn{1, 0, 1};
    const bool garage = random.chance(45) && house.width + kGarageWidth + 2 * kMetre <= plot_width;
    if (garage) {
        house.garage_side = random.chance(50) ? 1 : -1;
    } else if (random.chance(45)) {
        turn = small_angle(random);
        if (turned_extent(house.width, house.depth, turn) + 2 * kMetre > plot_width) turn = {1, 0, 1};
    }
    const Units behind = setback + turned_extent(house.depth, house.width, turn) / 2;
    const Units aside = house.garage_side * kGarageWidth / 2;  // house and garage together stand in the middle
    const Point2 centre{plot_middle.x - (side == 0 ? aside : -aside), plot_middle.y + (side == 0 ? behind : -behind)};
    house.frame = frame_about(centre, house.width, house.depth, side, turn);
    return house;
}

void plan_detached(BlockPlan& plan, const Block& block, Random& random) {
    const Units plot = block.width() / std::max<Units>(1, block.width() / (random.between(14, 17) * kMetre));
    const Units middle = (block.y0 + block.y1) / 2;
    for (int side : {0, 2}) {
        for (Units x = block.x0; x + plot <= block.x1; x += plot) {
            const Point2 street{x + plot / 2, side == 0 ? block.y0 : block.y1};
            plan.buildings.push_back(detached_house(random, side, street, plot, random.between(8, 14) * kMetre / 2));
        }
    }
    const Units half = std::min<Units>(5 * kMetre, block.height() / 2 - 24 * kMetre);
    scatter_trees(plan, random, {block.x0 + 2 * kMetre, middle - half}, {block.x1 - 2 * kMetre, middle + half},
                  static_cast<int>(block.width() / (14 * kMetre)));
}

void plan_row(BlockPlan& plan, const Block& block, Random& random, int side) {
    constexpr std::array<int, 4> kWidths = {550, 600, 650, 700};
    const Units setback = 3 * kMetre, gap = 3 * kMetre;
    Units x = block.x0 + kMetre;
    while (true) {
        const Units width = units_of_cm(kWidths[static_cast<size_t>(random.below(4))]);
        const int run = static_cast<int>(std::min<Units>(random.between(5, 8), (block.x1 - kMetre - x) / width));
        if (run < 1) return;
        BuildingPlan house;
        house.use = FacadeUse::kRowHouse;
        house.width = width;
        house.depth = random.between(9, 10) * kMetre;
        house.floors = random.between(2, 3);
        house.variant = random.below(kFacadeVariants);
        house.roof = RoofShape::kGable;
        for (int i = 0; i < run; ++i) {
            const bool first = i == 0, last = i + 1 == run;
            const bool left_end = side == 0 ? first : last, right_end = side == 0 ? last : first;
            house.walls = {WallRole::kFront, right_end ? WallRole::kSide : WallRole::kParty, WallRole::kRear,
                           left_end ? WallRole::kSide : WallRole::kParty};
            const Units left = x + i * width;
            house.frame =
                side == 0 ? facing(0, {left, block.y0 + setback}) : facing(2, {left + width, block.y1 - setback});
            house.seed = random.next();
            plan.buildings.push_back(house);
        }
        x += run * width + gap;
    }
}

void plan_rows(BlockPlan& plan, const Block& block, Random& random) {
    plan_row(plan, block, random, 0);
    plan_row(plan, block, random, 2);
    scatter_trees(plan, random, {block.x0 + 2 * kMetre, block.y0 + 19 * kMetre},
                  {block.x1 - 2 * kMetre, block.y1 - 19 * kMetre}, static_cast<int>(block.width() / (10 * kMetre)));
}

/// Cuts `length` metres into lots of 10..20 m, all even, nothing left.
std::vector<int> cut_lots(int length, Random& random) {
    std::vector<int> lots;
    while (length > 0) {
        int lot = 10 + 2 * random.below(6);
        if (length <= 20) lot = length;
        if (length - lot < 10 && length != lot) lot = length - 10;
        lots.push_back(std::min(lot, 20));
        length -= lots.back();
    }
    return lots;
}

BuildingPlan apartment_house(Random& random, Frame frame, Units width, Units depth, bool shops) {
    BuildingPlan house;
    house.use = FacadeUse::kApartment;
    house.frame = frame;
    house.width = width;
    house.depth = depth;
    house.walls = {WallRole::kFront, WallRole::kParty, WallRole::kRear, WallRole::kParty};
    house.variant = random.below(kFacadeVariants);
    house.floors = 4 + house.variant % 2 + random.below(2);
    house.shop = random.chance(shops ? 75 : 15);
    house.roof = house.variant % 3 == 0 ? RoofShape::kGable : random.chance(60) ? RoofShape::kFlat : RoofShape::kGable;
    house.seed = random.next();
    return house;
}

void plan_perimeter(BlockPlan& plan, const Block& block, Random& random) {
    const Units deep = 12 * kMetre;
    const std::array<Point2, 4> corner = {
        {{block.x0, block.y0}, {block.x1, block.y0}, {block.x1, block.y1}, {block.x0, block.y1}}};
    const bool shops = random.chance(60);
    for (int side = 0; side < 4; ++side) {
        const auto [c, s] = kFacing[static_cast<size_t>(side)];
        const Point2 from = corner[static_cast<size_t>(side)];
        // The corner house at this side's start shows its front to this street and its left wall to the last one.
        BuildingPlan at_corner = apartment_house(random, facing(side, from), deep, deep, true);
        at_corner.walls = {WallRole::kFront, WallRole::kParty, WallRole::kParty, WallRole::kFront};
        if (at_corner.roof == RoofShape::kGable) at_corner.roof = RoofShape::kHip;
        plan.buildings.push_back(at_corner);
        Units along = deep;
        const Units length = side % 2 == 0 ? block.width() : block.height();
        for (int lot : cut_lots(static_cast<int>((length - 2 * deep) / kMetre), random)) {
            plan.buildings.push_back(apartment_house(random, facing(side, {from.x + c * along, from.y + s * along}),
                                                     lot * kMetre, deep, shops));
            along += lot * kMetre;
        }
    }
    scatter_trees(plan, random, {block.x0 + deep + 5 * kMetre, block.y0 + deep + 5 * kMetre},
                  {block.x1 - deep - 5 * kMetre, block.y1 - deep - 5 * kMetre}, random.between(3, 8));
}

int tower_floors(Random& random) {
    const int draw = random.below(100);
    const int shafts = draw < 35 ? 0 : draw < 62 ? 1 : draw < 80 ? 2 : draw < 93 ? 3 : 4;
    return 4 + 8 * shafts + random.between(1, 2) * 2;
}

void plan_towers(BlockPlan& plan, const Block& block, Random& random) {
    const auto columns = std::max<Units>(1, block.width() / (34 * kMetre));
    const auto rows = std::max<Units>(1, block.height() / (40 * kMetre));
    const Units cell_width = block.width() / columns, cell_height = block.height() / rows;
    for (Units row = 0; row < rows; ++row) {
        for (Units column = 0; column < columns; ++column) {
            BuildingPlan tower;
            tower.use = FacadeUse::kTower;
            const auto largest = static_cast<int>((std::min(cell_width, cell_height) / kMetre - 6) / 4);
            tower.width = 4 * kMetre * random.between(4, std::clamp(largest, 4, 8));
            tower.depth = 4 * kMetre * random.between(4, std::clamp(largest, 4, 7));
            tower.walls = {WallRole::kFront, WallRole::kSide, WallRole::kSide, WallRole::kSide};
            tower.floors = tower_floors(random);
            tower.variant = random.below(kFacadeVariants);
            tower.roof = RoofShape::kFlat;
            tower.seed = random.next();
            Angle turn = random.chance(50) ? Angle{4, 3, 5} : small_angle(random);
            if (random.chance(55) || turned_extent(tower.width, tower.depth, turn) + 4 * kMetre > cell_width ||
                turned_extent(tower.depth, tower.width, turn) + 4 * kMetre > cell_height)
                turn = {1, 0, 1};
            const Point2 centre{block.x0 + cell_width * (2 * column + 1) / 2,
                                block.y0 + cell_height * (2 * row + 1) / 2};
            tower.frame = frame_about(centre, tower.width, tower.depth, row == 0 ? 0 : 2, turn);
            plan.buildings.push_back(tower);
        }
    }
    for (Units x = block.x0 + 3 * kMetre; x < block.x1 - 3 * kMetre; x += 9 * kMetre)
        for (Units y : {block.y0 + 2 * kMetre, block.y1 - 2 * kMetre}) plan.trees.push_back({{x, y}, random.next()});
}

void plan_industry(BlockPlan& plan, const Block& block, Random& random) {
    const auto columns = std::max<Units>(1, block.width() / (random.between(34, 60) * kMetre));
    const auto rows = std::max<Units>(1, block.height() / (36 * kMetre));
    const Units cell_width = block.width() / columns, cell_height = block.height() / rows;
    for (Units row = 0; row < rows; ++row) {
        for (Units column = 0; column < columns; ++column) {
            BuildingPlan hall;
            hall.use = FacadeUse::kHall;
            hall.width = std::min<Units>(64, (cell_width / kMetre - 6) / 8 * 8) * kMetre;
            hall.depth = std::min<Units>(40, (cell_height / kMetre - 8) / 8 * 8) * kMetre;
            hall.walls = {WallRole::kFront, WallRole::kSide, WallRole::kRear, WallRole::kSide};
            hall.variant = random.below(kFacadeVariants);
            const int draw = random.below(3);
            hall.roof = draw == 0 ? RoofShape::kGable : draw == 1 ? RoofShape::kFlat : RoofShape::kSawtooth;
            hall.seed = random.next();
            const Point2 centre{block.x0 + cell_width * (2 * column + 1) / 2,
                                block.y0 + cell_height * (2 * row + 1) / 2};
            hall.frame = frame_about(centre, hall.width, hall.depth, row == 0 ? 0 : 2, {1, 0, 1});
            plan.buildings.push_back(hall);
        }
    }
}

}  // namespace

Point2 Frame::at(Units x, Units y) const {
    for (int turn = 0; turn < quarter_turns; ++turn) {
        const Units was_x = x;
        x = -y;
        y = was_x;
    }
    x += offset.x;
    y += offset.y;
    return {corner.x + floor_div(2 * (c * x - s * y) + h, 2 * h), corner.y + floor_div(2 * (s * x + c * y) + h, 2 * h)};
}

Frame Frame::turned(Units width) const {
    Point2 origin{width, 0};
    for (int turn = 0; turn < quarter_turns; ++turn) origin = {-origin.y, origin.x};
    Frame frame = *this;
    frame.offset = {offset.x + origin.x, offset.y + origin.y};
    frame.quarter_turns = (quarter_turns + 1) % 4;
    return frame;
}

BlockPlan plan_block(const Block& block) {
    BlockPlan plan;
    Random random(block.seed);
    switch (block.zone) {
        case Zone::kTowers:
            plan_towers(plan, block, random);
            break;
        case Zone::kPerimeter:
            plan_perimeter(plan, block, random);
            break;
        case Zone::kRows:
            plan_rows(plan, block, random);
            break;
        case Zone::kDetached:
            plan_detached(plan, block, random);
            break;
        case Zone::kIndustry:
            plan_industry(plan, block, random);
            break;
        case Zone::kPark:
        case Zone::kMeadow: {
            const int trees = static_cast<int>(block.width() * block.height() / (kMetre * kMetre) /
                                               (block.zone == Zone::kPark ? 110 : 900));
            scatter_trees(plan, random, {block.x0 + 3 * kMetre, block.y0 + 3 * kMetre},
                          {block.x1 - 3 * kMetre, block.y1 - 3 * kMetre}, trees);
            break;
        }
    }
    return plan;
}

}  // namespace citystream::tiles::city::procedural
