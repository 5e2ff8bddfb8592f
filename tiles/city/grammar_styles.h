// The productions of the facade grammar, one per use of a building: wall -> floors -> bays -> elements.
// `style` decides what all walls of a variant share, `detail` what differs within a wall (curtains, which bay has the
// door).
#pragma once

#include "tiles/city/generator_random.h"
#include "tiles/city/grammar.h"
#include "tiles/city/grammar_facades.h"

namespace citystream::tiles::city::procedural {

enum class ApartmentEra : uint8_t { kOrnate, kPlain, kModern };
constexpr ApartmentEra apartment_era(int variant) {
    return static_cast<ApartmentEra>(variant % 3);
}

void derive_house(Canvas& canvas, const FacadeSpec& spec, const Storeys& storeys, Random style, Random detail);
void derive_row_house(Canvas& canvas, const FacadeSpec& spec, const Storeys& storeys, Random style, Random detail);
void derive_apartment(Canvas& canvas, const FacadeSpec& spec, const Storeys& storeys, Random style, Random detail);
void derive_tower(Canvas& canvas, const FacadeSpec& spec, const Storeys& storeys, Random style, Random detail);
void derive_hall(Canvas& canvas, const FacadeSpec& spec, Random style, Random detail);
void derive_garage(Canvas& canvas);

/// The rectangles of the storeys, from the foot upwards; what remains above the last is the top.
std::vector<Rect> storey_rects(const Canvas& canvas, const Storeys& storeys);

}  // namespace citystream::tiles::city::procedural
