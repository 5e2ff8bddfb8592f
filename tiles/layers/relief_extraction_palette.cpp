#include "tiles/layers/relief_extraction_palette.h"

#include <algorithm>
#include <cmath>

#include "codec/facade/facade_layout.h"

namespace citystream::tiles::layers::relief {
namespace {

struct Shown {
    uint32_t look = 0;
    double area = 0;
};

std::vector<Shown> shown_looks(const FacadeParts& facade, const Decision& decision) {
    std::map<uint32_t, double> area;
    for (size_t i = 0; i < facade.parts.size(); ++i) {
        if (decision.shown[i] != 0 || decision.beside[i] != 0) area[facade.parts[i].look] += facade.parts[i].area;
    }
    std::vector<Shown> list;
    for (const auto& [look, sum] : area) list.push_back({look, sum});
    std::stable_sort(list.begin(), list.end(), [](const Shown& a, const Shown& b) { return a.area > b.area; });
    return list;
}

double unlikeness(const city::Material& a, const city::Material& b) {
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) sum += std::pow(double{1} * a.rgb[k] - b.rgb[k], 2);
    return sum;
}

}  // namespace

SlotTable choose_slots(const FacadeParts& facade, const Decision& decision, const city::CityCatalog& catalog) {
    SlotTable table;
    uint32_t slots = 0;
    for (const Shown& shown : shown_looks(facade, decision)) {
        if (slots < FACADE_PALETTE_SLOTS) {
            table.palette.material[slots] = shown.look;
            table.slot_of[shown.look] = slots++;
            continue;
        }
        const city::Material& own = catalog.materials[shown.look];
        const auto nearest =
            std::min_element(table.palette.material.begin(), table.palette.material.end(), [&](uint32_t a, uint32_t b) {
                return unlikeness(catalog.materials[a], own) < unlikeness(catalog.materials[b], own);
            });
        table.slot_of[shown.look] = static_cast<uint32_t>(nearest - table.palette.material.begin());
        ++table.merged;
    }
    for (uint32_t s = slots; s < FACADE_PALETTE_SLOTS && slots > 0; ++s)
        table.palette.material[s] = table.palette.material[0];
    return table;
}

}  // namespace citystream::tiles::layers::relief
