// A facade map drawn to a picture as it looks from straight ahead: each texel the mean, in linear light, of what it
// covers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "codec/facade/facade_layout.h"
#include "codec/facade/run_grid.h"
#include "tiles/layers/image_cache.h"

namespace citystream::tiles::layers {

/// What a material slot shows: a colour, or an image that repeats.
struct SlotColour {
    std::array<float, 3> flat{};              ///< linear light; of slots without an image
    std::shared_ptr<const ChartImage> image;  ///< on texels about as large as the picture's
    double metres_per_repeat = 1;

    /// Linear light at a point of the wall, metres from the facade's lower left corner.
    std::array<float, 3> at(double x, double y) const;
};
using SlotColours = std::array<SlotColour, FACADE_PALETTE_SLOTS>;

/// Slot of the palette that a label shows.
uint32_t slot_of(uint32_t label);

/// The map on `width` x `height` texels, clamped, row 0 at the bottom. Slots count by the exact area that they cover in
/// a texel (a finer grid of samples would alias: windows and bays are about as large as texels); an image is looked up
/// at the texel's centre. Open cells count only where a texel holds nothing else, and show their slot.
/// O(cells + overlaps of cells with texels).
ChartImage paint_facade(const codec::facade::RunGrid& map, double texel_metres, const SlotColours& slots,
                        uint32_t width, uint32_t height);

}  // namespace citystream::tiles::layers
