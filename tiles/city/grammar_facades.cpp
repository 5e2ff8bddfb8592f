#include "tiles/city/grammar_facades.h"

#include "tiles/city/generator_random.h"
#include "tiles/city/grammar_styles.h"

namespace citystream::tiles::city::procedural {

Storeys storeys_of(FacadeUse use, FacadeSection section, int variant, int floors) {
    switch (use) {
        case FacadeUse::kHouse:
            return {variant % 2 == 0 ? 300 : 275, 275, 25, floors};
        case FacadeUse::kRowHouse:
            return {variant % 2 == 0 ? 325 : 300, variant % 2 == 0 ? 300 : 275, 50, floors};
        case FacadeUse::kApartment:
            switch (apartment_era(variant)) {
                case ApartmentEra::kOrnate:
                    return {425, 350, 100, floors};
                case ApartmentEra::kPlain:
                    return {325, 275, 75, floors};
                case ApartmentEra::kModern:
                    return {375, 300, 100, floors};
            }
            break;
        case FacadeUse::kTower: {
            const int floor = variant % 2 == 0 ? 375 : 350;
            return {floor, floor, section == FacadeSection::kTop ? 150 : 0, floors};
        }
        case FacadeUse::kHall:
            return {600 + variant % 4 * 100, 0, 0, 1};
        case FacadeUse::kGarage:
            return {275, 0, 0, 1};
    }
    return {};
}

codec::facade::RunGrid derive_facade(const FacadeSpec& spec, uint64_t seed) {
    const Storeys storeys = storeys_of(spec.use, spec.section, spec.variant, spec.floors);
    Canvas canvas(spec.width_cm, storeys.height_cm());
    // One stream for what a style shares over all its walls, one for what differs from wall to wall.
    const Random style(hash(seed, static_cast<int64_t>(spec.use), spec.variant, 17));
    const Random detail(hash(seed, static_cast<int64_t>(spec.role) * 16 + static_cast<int64_t>(spec.section),
                             spec.width_cm * 64 + spec.floors, spec.variant * 2 + (spec.shop ? 1 : 0)));
    switch (spec.use) {
        case FacadeUse::kHouse:
            derive_house(canvas, spec, storeys, style, detail);
            break;
        case FacadeUse::kRowHouse:
            derive_row_house(canvas, spec, storeys, style, detail);
            break;
        case FacadeUse::kApartment:
            derive_apartment(canvas, spec, storeys, style, detail);
            break;
        case FacadeUse::kTower:
            derive_tower(canvas, spec, storeys, style, detail);
            break;
        case FacadeUse::kHall:
            derive_hall(canvas, spec, style, detail);
            break;
        case FacadeUse::kGarage:
            derive_garage(canvas);
            break;
    }
    return canvas.relief();
}

}  // namespace citystream::tiles::city::procedural
