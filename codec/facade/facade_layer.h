// Facade layer of a tile: where the facades of the city's dictionary stand, and which charts their material slots show.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/facade_layout.h"
#include "codec/layer_steps.h"
#include "codec/result.h"

namespace citystream::codec::facade {

struct Placement {
    int32_t origin[3];  ///< grid units, tile-relative: lower left corner seen from outside
    int32_t along[2];   ///< grid units: to the lower right corner; the outward normal is (along_y, -along_x)
    uint32_t height;    ///< grid units
    uint32_t map;       ///< index in the dictionary
    uint32_t palette;
    friend bool operator==(const Placement&, const Placement&) = default;
};

struct PaletteEntry {
    uint32_t chart_word;  ///< codec/chart_word.h
    float metres_per_repeat;
    friend bool operator==(const PaletteEntry&, const PaletteEntry&) = default;
};

struct Palette {
    PaletteEntry slots[FACADE_PALETTE_SLOTS];
    friend bool operator==(const Palette&, const Palette&) = default;
};

struct FacadeTile {
    std::vector<Placement> placements;
    std::vector<Palette> palettes;
    friend bool operator==(const FacadeTile&, const FacadeTile&) = default;
};

/// Precondition (programming error): the limits that decode_facades checks. One step, error 0 (a facade map is exact).
LayerSteps encode_facades(const FacadeTile& tile);

/// Coordinates and heights must lie within +-2^30 grid units, metres_per_repeat be finite and not negative (0 where a
/// slot is not used; its chart must exist all the same). Checks and reads. `dictionary_size`: number of maps;
/// `atlas_chart_count`: charts of the tile's atlas.
Result<FacadeTile> decode_facades(std::span<const uint32_t> words, uint32_t dictionary_size,
                                  uint32_t atlas_chart_count);

}  // namespace citystream::codec::facade
