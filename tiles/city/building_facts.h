// What an input says of a building besides its shape: how many storeys it has and what it is used for. Dressing goes by
// it where it is there (tiles/layers/dress_style.h).
#pragma once

#include <cstdint>
#include <string_view>

namespace citystream::tiles::city {

enum class BuildingUse : uint8_t { kUnknown, kHouse, kApartments, kResidential, kOffice, kShop, kHall, kGarage };

struct BuildingFacts {
    uint16_t storeys = 0;  ///< above ground; 0: not said
    BuildingUse use = BuildingUse::kUnknown;

    /// Takes what is said of the building that this is a part of where nothing is said here.
    void inherit(const BuildingFacts& whole);
    friend bool operator==(const BuildingFacts&, const BuildingFacts&) = default;
};

/// Whether an attribute of CityJSON or a property of CityGML (without its prefix) may be a fact: storeysAboveGround,
/// function, usage, class.
bool is_building_fact(std::string_view name);

/// Notes an attribute's text. What is no number of storeys from 1 to 200 and no use that is known is passed over; a use
/// that was noted stays. Uses are known by their English or German names, by the codes of PLATEAU (usage 401 to 451)
/// and of ALKIS ("31001_2463").
void note_building_fact(BuildingFacts& facts, std::string_view name, std::string_view text);

}  // namespace citystream::tiles::city
