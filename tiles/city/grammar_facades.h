// The facade grammar's start symbols: which facades the generator knows and how each is derived.
// A facade is a function of its spec and the city's seed, so equal specs share one map.
#pragma once

#include <compare>
#include <cstdint>

#include "codec/facade/run_grid.h"

namespace citystream::tiles::city::procedural {

enum class FacadeUse : uint8_t { kHouse, kRowHouse, kApartment, kTower, kHall, kGarage };
enum class FacadeRole : uint8_t { kFront, kRear, kSide };

/// Which part of a stacked facade this is: towers are taller than one map may be.
enum class FacadeSection : uint8_t { kWhole, kBase, kShaft, kTop };

/// Variants of style of each use; a building uses the same variant on all its walls.
inline constexpr int kFacadeVariants = 9;

struct FacadeSpec {
    FacadeUse use = FacadeUse::kHouse;
    FacadeRole role = FacadeRole::kFront;
    FacadeSection section = FacadeSection::kWhole;
    uint8_t variant = 0;  ///< 0..kFacadeVariants - 1
    uint8_t floors = 1;   ///< of this section
    bool shop = false;    ///< shops on the ground floor (apartment fronts)
    uint16_t width_cm = 0;
    friend auto operator<=>(const FacadeSpec&, const FacadeSpec&) = default;  // NOLINT(modernize-use-nullptr)
};

/// Heights of the storeys of a section, all multiples of 25 cm (256 grid units are 25 cm, so walls lie on the grid
/// exactly).
struct Storeys {
    int ground_cm = 0, floor_cm = 0, top_cm = 0, floors = 0;
    int height_cm() const { return ground_cm + (floors - 1) * floor_cm + top_cm; }
};
Storeys storeys_of(FacadeUse use, FacadeSection section, int variant, int floors);

/// Derives the facade: width_cm x storeys_of(spec).height_cm() texels, displacement >= 0 along the border. On its
/// coarsest grid; time does not depend on the texels.
codec::facade::RunGrid derive_facade(const FacadeSpec& spec, uint64_t seed);

}  // namespace citystream::tiles::city::procedural
