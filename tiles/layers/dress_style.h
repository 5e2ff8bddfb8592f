// Guesses a building's use and style from its shape, and what part each wall plays in it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "tiles/city/grammar_facades.h"
#include "tiles/layers/dress_walls.h"

namespace citystream::tiles::layers {

/// What the guess rests on: metres, square metres.
struct BuildingShape {
    double height = 0;
    double footprint = 0;          ///< area seen from above
    double length = 0, depth = 0;  ///< extent along and across the widest wall
    double elongation() const;     ///< longer by shorter extent, at least 1
};

/// `walls` must not be empty.
BuildingShape shape_of(const city::CityObject& object, const GridObject& grid, std::span<const WallRegion> walls);

/// Styles drawn of each use: house, row house, apartment, tower, hall, garage. The grammar knows more
/// (kFacadeVariants), but each multiplies the dictionary.
inline constexpr std::array<int, 6> kDressVariants = {5, 4, 6, 3, 4, 1};

struct BuildingStyle {
    city::procedural::FacadeUse use = city::procedural::FacadeUse::kHouse;
    uint8_t variant = 0;            ///< below kDressVariants of the use
    bool shop = false;              ///< shops in the ground floor of an apartment front; a variant has them or not
    bool short_side_front = false;  ///< the street runs along the narrow side
    uint64_t palette_draw = 0;      ///< random word: buildings of one variant in one district have the same colours
};

/// Random words that a building's style is drawn with.
struct StyleDraws {
    uint64_t building = 0;  ///< from its id, or, when it has none, from where it stands
    uint64_t district = 0;  ///< from the square of 512 m in which its first corner stands
};
StyleDraws draws_of(uint64_t seed, std::string_view id, const GridObject& grid);

/// By what the input says of its use, else by height, footprint and elongation, and by the building's draw where
/// several uses are likely. Where the input says how many storeys there are, they decide between variants whose storeys
/// are of other heights, and a building of several is no hall or garage.
BuildingStyle style_of(const BuildingShape& shape, const StyleDraws& draws, const city::BuildingFacts& facts = {});

/// Role of each wall: the widest wall (or, with short_side_front, the widest across it) is a front, walls that look
/// nearly the same way and are wide, too (but only one of a house); walls that look the other way are rears; others,
/// and those too narrow for a door, are sides.
std::vector<city::procedural::FacadeRole> wall_roles(std::span<const WallRegion> walls, const BuildingStyle& style);

}  // namespace citystream::tiles::layers
