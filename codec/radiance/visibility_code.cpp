#include "codec/radiance/visibility_code.h"

#include <algorithm>
#include <initializer_list>

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kPlacesAcross = 8, kPlaces = kCubeFaces * kPlacesAcross * kPlacesAcross;

/// Several states as one number.
uint32_t joint(std::initializer_list<uint32_t> states) {
    uint32_t number = 0;
    for (const uint32_t state : states) number = number * kCellStates + state;
    return number;
}

/// How many numbers joint() makes of so many states.
constexpr uint32_t joints(uint32_t states) {
    return 1u << 2 * states;
}

/// The neighbours before a cell, as its row goes.
struct Before {
    uint32_t west, north, north_west, north_east;
};

Before before_of(const CellStates& states, const CellLayout& layout, uint32_t level, uint32_t place) {
    const uint32_t row = layout.row(level);
    return {states.at(level, place - 1), states.at(level, place - row), states.at(level, place - row - 1),
            states.at(level, place - row + 1)};
}

}  // namespace

VisibilityLevelCode::VisibilityLevelCode(const CellLayout& layout, uint32_t level)
    : layout_(layout),
      level_(level),
      bits_({joints(5), joints(1) * kPlaces, joints(6), joints(8), joints(7), joints(7)}, kNodes, kSets) {}

void VisibilityLevelCode::set_contexts(const Receivers& receivers, uint32_t face, uint32_t x, uint32_t y) {
    const CellStates &first = receivers.first, &states = receivers.states;
    const uint32_t row = layout_.row(level_), place = layout_.place(level_, face, x, y);
    const Before here = before_of(states, layout_, level_, place);
    // Which of the cells before are as the other receiver's: two states' worth of bits.
    const auto alike = [&](const CellStates& other) -> uint32_t {
        const Before there = before_of(other, layout_, level_, place);
        return (here.west == there.west ? 1u : 0) + (here.north == there.north ? 2u : 0) +
               (here.north_west == there.north_west ? 4u : 0) + (here.north_east == there.north_east ? 8u : 0);
    };
    const uint32_t a = first.at(level_, place), b = receivers.second.at(level_, place);
    // What comes after is known of the greater cells; of the greatest ones it is taken from the first receiver.
    uint32_t east = first.at(level_, place + 1), south = first.at(level_, place + row);
    uint32_t south_east = first.at(level_, place + row + 1), sibling = 0;
    if (level_ > 0) {
        const auto greater = [&](uint32_t at_x, uint32_t at_y) -> uint32_t {
            return states.at(level_ - 1, layout_.place(level_ - 1, face, at_x / 2, at_y / 2));
        };
        east = greater(x + 1, y);
        south = greater(x, y + 1);
        south_east = greater(x + 1, y + 1);
        sibling = x % 2 + 2 * (y % 2);
    }
    const uint32_t west2 = states.at(level_, place - 2);
    const uint32_t north2 = y == 0 ? static_cast<uint32_t>(kAbsent) : states.at(level_, place - 2 * row);
    const uint32_t scale = std::max(1u, layout_.across(level_) / kPlacesAcross);
    const uint32_t where = (face * kPlacesAcross + std::min(y / scale, kPlacesAcross - 1)) * kPlacesAcross +
                           std::min(x / scale, kPlacesAcross - 1);
    const uint32_t both = joint({a, b});
    bits_.set_contexts(
        {joint({first.at(level_, place + row), first.at(level_, place + 1), first.at(level_, place - row),    //
                first.at(level_, place - 1), a}),                                                             //
         where * joints(1) + a,                                                                               //
         (alike(first) * 16 + alike(receivers.second)) * joints(2) + both,                                    //
         joint({east, south, here.west, here.north, here.north_west, here.north_east, south_east, sibling}),  //
         joint({west2, north2, here.west, here.north, here.north_west, here.north_east, sibling}),            //
         joint({east, south, here.west, here.north, south_east, a, sibling})},
        both);
}

}  // namespace citystream::codec::radiance
