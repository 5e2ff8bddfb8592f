#include "tiles/city/building_facts.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <utility>

namespace citystream::tiles::city {
namespace {

constexpr int kMostStoreys = 200;

using KnownUse = std::pair<std::string_view, BuildingUse>;

/// Whole values: PLATEAU's building usages (three digits) and building functions of the German cadastre (31001_...).
constexpr std::array<KnownUse, 24> kCodes = {{
    {"401", BuildingUse::kOffice},
    {"402", BuildingUse::kShop},
    {"403", BuildingUse::kApartments},
    {"404", BuildingUse::kShop},
    {"411", BuildingUse::kHouse},
    {"412", BuildingUse::kApartments},
    {"413", BuildingUse::kShop},
    {"414", BuildingUse::kShop},
    {"415", BuildingUse::kHouse},
    {"421", BuildingUse::kOffice},
    {"422", BuildingUse::kOffice},
    {"431", BuildingUse::kHall},
    {"441", BuildingUse::kHall},
    {"451", BuildingUse::kHall},
    {"31001_1000", BuildingUse::kResidential},
    {"31001_1010", BuildingUse::kHouse},
    {"31001_1020", BuildingUse::kApartments},
    {"31001_2020", BuildingUse::kOffice},
    {"31001_2050", BuildingUse::kShop},
    {"31001_2100", BuildingUse::kHall},
    {"31001_2111", BuildingUse::kHall},
    {"31001_2143", BuildingUse::kHall},
    {"31001_2463", BuildingUse::kGarage},
    {"31001_2721", BuildingUse::kHall},
}};

/// Parts of names, the telling ones first: "apartment house" is no house, "parking garage" none of two floors.
constexpr std::array<KnownUse, 31> kWords = {{
    {"apartment", BuildingUse::kApartments},
    {"tenement", BuildingUse::kApartments},
    {"multi-family", BuildingUse::kApartments},
    {"mehrfamilien", BuildingUse::kApartments},
    {"hotel", BuildingUse::kApartments},
    {"dormitory", BuildingUse::kApartments},
    {"detached", BuildingUse::kHouse},
    {"single-family", BuildingUse::kHouse},
    {"single family", BuildingUse::kHouse},
    {"einfamilien", BuildingUse::kHouse},
    {"terrace", BuildingUse::kHouse},
    {"bungalow", BuildingUse::kHouse},
    {"warehouse", BuildingUse::kHall},
    {"factory", BuildingUse::kHall},
    {"industr", BuildingUse::kHall},
    {"hangar", BuildingUse::kHall},
    {"storage", BuildingUse::kHall},
    {"barn", BuildingUse::kHall},
    {"halle", BuildingUse::kHall},
    {"garage", BuildingUse::kGarage},
    {"carport", BuildingUse::kGarage},
    {"retail", BuildingUse::kShop},
    {"shop", BuildingUse::kShop},
    {"commerc", BuildingUse::kShop},
    {"office", BuildingUse::kOffice},
    {"school", BuildingUse::kOffice},
    {"hospital", BuildingUse::kOffice},
    {"public", BuildingUse::kOffice},
    {"residential", BuildingUse::kResidential},
    {"wohn", BuildingUse::kResidential},
    {"house", BuildingUse::kHouse},
}};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r\n";
    const size_t begin = text.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

BuildingUse use_named(std::string_view text) {
    const auto code =
        std::find_if(kCodes.begin(), kCodes.end(), [&](const KnownUse& known) { return known.first == text; });
    if (code != kCodes.end()) return code->second;
    std::string lower(text.substr(0, 200));
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    const auto word = std::find_if(kWords.begin(), kWords.end(),
                                   [&](const KnownUse& known) { return lower.find(known.first) != std::string::npos; });
    return word == kWords.end() ? BuildingUse::kUnknown : word->second;
}

}  // namespace

void BuildingFacts::inherit(const BuildingFacts& whole) {
    if (storeys == 0) storeys = whole.storeys;
    if (use == BuildingUse::kUnknown) use = whole.use;
}

bool is_building_fact(std::string_view name) {
    constexpr std::array<std::string_view, 4> kNames = {"storeysAboveGround", "function", "usage", "class"};
    return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

void note_building_fact(BuildingFacts& facts, std::string_view name, std::string_view text) {
    text = trimmed(text);
    if (name == "storeysAboveGround") {
        int storeys = 0;
        const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), storeys);
        if (code == std::errc() && storeys >= 1 && storeys <= kMostStoreys)
            facts.storeys = static_cast<uint16_t>(storeys);
        return;
    }
    if (facts.use == BuildingUse::kUnknown) facts.use = use_named(text);
}

}  // namespace citystream::tiles::city
