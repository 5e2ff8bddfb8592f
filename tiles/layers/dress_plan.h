// From a level rectangle of a wall to the facades on it: how many side by side and one over the other, and which map
// of a bounded dictionary each shows.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "tiles/city/grammar_facades.h"
#include "tiles/layers/dress_style.h"

namespace citystream::tiles::layers {

/// Widths of the maps, centimetres: each 1.17 times the one before, so that a map is stretched by at most 8.5 %.
/// Wider walls carry several facades side by side.
inline constexpr std::array<uint16_t, 16> kDressWidths = {160, 185, 215, 250, 290, 340,  395,  460,
                                                          535, 625, 730, 850, 990, 1155, 1350, 1575};
inline constexpr double kMostFacadeWidth = 16.9;  ///< metres
/// A map is stretched or squeezed by at most this factor; walls lower than any map of their use are the exception.
inline constexpr double kMostStretch = 1.085;

/// Which storeys a map shows.
enum class FacadePiece : uint8_t {
    kGround,  ///< from the ground to the top
    kUpper,   ///< storeys above the ground floor, and the top: no door
    kBase,    ///< the four lowest storeys of a stack
    kShaft    ///< four storeys in the middle of a stack
};

/// Key of a map in the dictionary: equal specs are equal maps.
struct DressMapSpec {
    city::procedural::FacadeUse use = city::procedural::FacadeUse::kHouse;
    city::procedural::FacadeRole role = city::procedural::FacadeRole::kFront;
    FacadePiece piece = FacadePiece::kGround;
    uint8_t variant = 0;
    uint8_t floors = 1;
    int16_t extra_cm = 0;     ///< parapet above the top (multiples of 5), or, negative, how much of the top is missing
    uint8_t width_class = 0;  ///< index in kDressWidths
    bool shop = false;
    friend auto operator<=>(const DressMapSpec&, const DressMapSpec&) = default;  // NOLINT(modernize-use-nullptr)
    int width_cm() const { return kDressWidths[width_class]; }
};

/// Storey heights of a use and variant, centimetres.
struct DressStoreys {
    int ground = 0, floor = 0, top = 0;
    int top_of_upper = 0;  ///< as `top`, of kUpper pieces
    bool stacks = false;   ///< false: one storey, however high (halls, garages)
};
DressStoreys dress_storeys(city::procedural::FacadeUse use, int variant);

/// Unstretched height of a map, centimetres.
int map_height_cm(const DressMapSpec& spec);

/// The facades of one rectangle, a grid of columns side by side and pieces from the foot upwards.
struct WallPlan {
    uint32_t columns = 1;
    std::vector<DressMapSpec> pieces;
    int height_cm = 0;  ///< of the pieces, unstretched
};

/// `width` and `height` in metres, at least 1.5 and 2.2. `elevated`: the wall begins above the ground.
WallPlan plan_wall(const BuildingStyle& style, city::procedural::FacadeRole role, double width, double height,
                   bool elevated);

}  // namespace citystream::tiles::layers
