#include "tiles/layers/dress_plan.h"

#include <algorithm>
#include <cmath>

namespace citystream::tiles::layers {
namespace {

using city::procedural::FacadeRole;
using city::procedural::FacadeSection;
using city::procedural::FacadeUse;

constexpr int kMostVariedFloors = 6;  // fronts of higher apartments differ by their era only, all with shops
constexpr int kMostFloorsOfOneMap = 12, kStackPieceFloors = 4, kLeastTopFloors = 3;
constexpr double kStep = 1.165;        // between heights of maps with the same floors
constexpr double kNearEnough = 1.083;  // a stretch that needs no parapet

uint8_t width_class(double width_cm) {
    size_t best = 0;
    for (size_t i = 1; i < kDressWidths.size(); ++i)
        if (std::abs(std::log(width_cm / kDressWidths[i])) < std::abs(std::log(width_cm / kDressWidths[best])))
            best = i;
    return static_cast<uint8_t>(best);
}

/// How far the lowest storey of a front or rear can be cut down, centimetres: to the top of its windows and doors.
int least_height(const DressMapSpec& spec, const DressStoreys& storeys) {
    if (spec.shop) return storeys.ground;
    switch (spec.use) {
        case FacadeUse::kGarage:
            return 240;
        case FacadeUse::kHouse:
            return 262;
        case FacadeUse::kRowHouse:
            return 290;
        case FacadeUse::kApartment:
            return 320;
        case FacadeUse::kTower:
        case FacadeUse::kHall:
            return storeys.ground;
    }
    return 0;
}

int height_of(const DressStoreys& storeys, FacadePiece piece, int floors) {
    switch (piece) {
        case FacadePiece::kGround:
            return storeys.ground + (floors - 1) * storeys.floor + storeys.top;
        case FacadePiece::kUpper:
            return floors * storeys.floor + storeys.top_of_upper;
        case FacadePiece::kBase:
            return storeys.ground + (kStackPieceFloors - 1) * storeys.floor;
        case FacadePiece::kShaft:
            return kStackPieceFloors * storeys.floor;
    }
    return 0;
}

struct Fit {
    int floors = 1, extra_cm = 0;
};

/// The floors nearest to the height; where none is near, the highest that fit below a parapet (or one storey cut
/// down, but not below `least`).
Fit fit_floors(const DressStoreys& storeys, FacadePiece piece, double height_cm, int least) {
    Fit fit;
    const int most_floors = storeys.stacks ? kMostFloorsOfOneMap : 1;
    for (int floors = 2; floors <= most_floors; ++floors) {
        const double here = std::abs(std::log(height_cm / height_of(storeys, piece, floors)));
        if (here < std::abs(std::log(height_cm / height_of(storeys, piece, fit.floors)))) fit.floors = floors;
    }
    int own = height_of(storeys, piece, fit.floors);
    if (std::abs(std::log(height_cm / own)) <= std::log(kNearEnough)) return fit;
    if (own > height_cm && fit.floors > 1) own = height_of(storeys, piece, --fit.floors);
    const double steps = std::round(std::log(height_cm / own) / std::log(kStep));
    fit.extra_cm = static_cast<int>(std::lround(own * (std::pow(kStep, steps) - 1) / 5)) * 5;
    if (fit.extra_cm < 0) fit.extra_cm = std::max(fit.extra_cm, std::min(0, least - own));
    return fit;
}

/// Fronts differ in all variants; rears and sides only as far as their storeys do.
uint8_t shared_variant(FacadeUse use, FacadeRole role, uint8_t variant) {
    if (use == FacadeUse::kGarage) return 0;
    if (role == FacadeRole::kFront || use == FacadeUse::kTower || use == FacadeUse::kHall) return variant;
    return static_cast<uint8_t>(variant % (use == FacadeUse::kApartment ? 3 : 2));
}

/// Row houses, halls and garages have no rear of their own, towers look alike all around but for the entrance.
FacadeRole shared_role(FacadeUse use, FacadePiece piece, FacadeRole role) {
    if (use == FacadeUse::kTower && (piece == FacadePiece::kShaft || piece == FacadePiece::kUpper))
        return FacadeRole::kFront;
    const bool rear = use == FacadeUse::kHouse || use == FacadeUse::kApartment;
    return role == FacadeRole::kRear && !rear ? FacadeRole::kSide : role;
}

/// Everything of the spec but floors and parapet.
DressMapSpec kind_of_map(const BuildingStyle& style, FacadeRole role, double height_cm, bool elevated) {
    DressMapSpec spec;
    spec.use = elevated && style.use == FacadeUse::kGarage ? FacadeUse::kHouse : style.use;
    spec.role = role;
    const bool hall = spec.use == FacadeUse::kHall, house = spec.use == FacadeUse::kHouse;
    if (elevated && role == FacadeRole::kFront && (hall || house)) spec.role = FacadeRole::kSide;
    spec.piece = elevated && !hall ? FacadePiece::kUpper : FacadePiece::kGround;
    spec.role = shared_role(spec.use, spec.piece, spec.role);
    spec.variant = shared_variant(spec.use, spec.role, style.variant);
    if (height_cm * kMostStretch < least_height(spec, dress_storeys(spec.use, spec.variant))) {
        spec.role = FacadeRole::kSide;
        if (hall || spec.use == FacadeUse::kTower) spec.use = FacadeUse::kHouse;
        if (elevated) spec.piece = FacadePiece::kUpper;
        spec.variant = shared_variant(spec.use, spec.role, style.variant);
    }
    spec.shop = style.shop && spec.role == FacadeRole::kFront && spec.piece == FacadePiece::kGround &&
                height_cm >= dress_storeys(spec.use, spec.variant).ground;
    return spec;
}

}  // namespace

DressStoreys dress_storeys(FacadeUse use, int variant) {
    const auto whole = city::procedural::storeys_of(use, FacadeSection::kWhole, variant, 1);
    const auto top = city::procedural::storeys_of(use, FacadeSection::kTop, variant, 1);
    const bool stacks = use != FacadeUse::kHall && use != FacadeUse::kGarage;
    return {whole.ground_cm, whole.floor_cm, whole.top_cm, top.top_cm, stacks};
}

int map_height_cm(const DressMapSpec& spec) {
    return height_of(dress_storeys(spec.use, spec.variant), spec.piece, spec.floors) + spec.extra_cm;
}

WallPlan plan_wall(const BuildingStyle& style, FacadeRole role, double width, double height, bool elevated) {
    const double height_cm = 100 * height;
    DressMapSpec spec = kind_of_map(style, role, height_cm, elevated);
    WallPlan plan;
    plan.columns = static_cast<uint32_t>(std::max(1.0, std::ceil(width / kMostFacadeWidth)));
    spec.width_class = width_class(100 * width / plan.columns);
    const DressStoreys storeys = dress_storeys(spec.use, spec.variant);
    if (spec.use == FacadeUse::kApartment && spec.role == FacadeRole::kFront &&
        height_cm > height_of(storeys, spec.piece, kMostVariedFloors)) {
        spec.variant = static_cast<uint8_t>(spec.variant % 3);
        spec.shop = spec.piece == FacadePiece::kGround;
    }
    const int tall = height_of(storeys, spec.piece, kMostFloorsOfOneMap);
    if (!storeys.stacks || height_cm <= tall + storeys.floor / 2) {
        const int least =
            spec.role == FacadeRole::kSide && spec.use != FacadeUse::kTower && spec.use != FacadeUse::kHall
                ? 0
                : least_height(spec, storeys);
        const Fit fit = fit_floors(storeys, spec.piece, height_cm, least);
        spec.floors = static_cast<uint8_t>(fit.floors);
        spec.extra_cm = static_cast<int16_t>(fit.extra_cm);
        plan.pieces.push_back(spec);
    } else {
        const int grounded = spec.piece == FacadePiece::kGround ? 1 : 0;
        const double above = height_cm - grounded * storeys.ground - storeys.top_of_upper;
        int left = static_cast<int>(std::lround(above / storeys.floor)) + grounded;
        const auto add = [&](FacadePiece piece, int floors) {
            DressMapSpec part = spec;
            part.piece = piece;
            part.floors = static_cast<uint8_t>(floors);
            part.role = shared_role(spec.use, piece, spec.role);
            part.shop = spec.shop && piece == FacadePiece::kBase;
            plan.pieces.push_back(part);
            left -= floors;
        };
        if (grounded != 0) add(FacadePiece::kBase, kStackPieceFloors);
        while (left >= kStackPieceFloors + kLeastTopFloors) add(FacadePiece::kShaft, kStackPieceFloors);
        add(FacadePiece::kUpper, left);
    }
    for (const DressMapSpec& piece : plan.pieces) plan.height_cm += map_height_cm(piece);
    return plan;
}

}  // namespace citystream::tiles::layers
