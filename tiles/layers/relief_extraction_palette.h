// The materials of one facade's relief: at most 16 slots.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "tiles/layers/relief_extraction_decision.h"

namespace citystream::tiles::layers::relief {

struct SlotTable {
    std::map<uint32_t, uint32_t> slot_of;  ///< by look of the parts
    city::FacadePalette palette;
    uint32_t merged = 0;  ///< looks that share the slot of another
};

/// Slots by area shown.
SlotTable choose_slots(const FacadeParts& facade, const Decision& decision, const city::CityCatalog& catalog);

}  // namespace citystream::tiles::layers::relief
