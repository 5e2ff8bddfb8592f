// What the receivers of a tile see: a bit for every sample direction (source_directions.h), 1 where nothing of the city
// is in the way. Everything else of the radiance layer is made from these bits and the receivers' frames.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/frames.h"

namespace citystream::codec::radiance {

/// Receivers of a tile are at most so many, so that rows (receiver times local directions) have 24 bits.
inline constexpr uint32_t kMostReceivers = 1 << 20;

struct VisibilityTile {
    uint32_t side = 0;               ///< source texels on a side, 1..kMostCubeSide
    std::vector<uint32_t> frames;    ///< frame codes (frames.h), no more than receivers
    std::vector<uint32_t> frame_of;  ///< of each receiver, a place in `frames`
    std::vector<uint32_t> words;     ///< words_a_receiver each: sample s is bit s % 32 of word s / 32
    friend bool operator==(const VisibilityTile&, const VisibilityTile&) = default;

    uint32_t receivers() const { return static_cast<uint32_t>(frame_of.size()); }
    uint32_t words_a_receiver() const { return (sample_count(side) + 31) / 32; }
    /// Adds a receiver that sees nothing yet. Its frame joins the table if it is not there.
    void add_receiver(uint32_t frame_code);
    bool sees(uint32_t receiver, uint32_t sample) const;
    void set(uint32_t receiver, uint32_t sample);
    std::span<const uint32_t> of(uint32_t receiver) const;
};

/// Samples above a frame's plane, as a receiver's words.
std::vector<uint32_t> samples_above(const Frame& frame, uint32_t side);

/// Clears the bits below the receivers' own planes, which are not stored.
void clear_below_planes(VisibilityTile& tile);

}  // namespace citystream::codec::radiance
