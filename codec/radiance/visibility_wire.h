// Visibility bits on the wire: the smallest form of a radiance layer, from which its matrix is made again exactly.
// FORMAT.md, "Visibility".
//
// Three steps, coarse to fine: what is known after one, two or all of them are cells of 4, 2 and 1 samples across,
// which for 32 texels are cubes of 6 x 16 x 16, 6 x 32 x 32 and 6 x 64 x 64. Where a cell is only partly visible every
// other of its samples is taken as visible until the next step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "codec/radiance/sparse_row_code.h"
#include "codec/radiance/visibility_bits.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

inline constexpr uint32_t kVisibilitySteps = 3;

struct VisibilityStep {
    std::vector<std::byte> bytes;
    /// Of the prefix that ends with this step: steradians whose visibility is wrong, of the worst receiver. So the
    /// light that a receiver gathers is wrong by at most this times the brightest radiance. 0 for the last.
    float error = 0;
};

/// Frames are not told: they follow from where receivers are (radiance_layer.h). Nor are bits below the receivers'
/// planes. Deterministic. Receivers that see nearly the same should follow each other, as those of a lattice do.
/// O(samples).
std::vector<VisibilityStep> encode_visibility(const VisibilityTile& tile);

/// Source texels on a side, of a first step. Error: none that can be.
Result<uint32_t> visibility_side(std::span<const std::byte> first_step);

/// What steps.size() >= 1 first steps say of receivers with the frames of `known`, whose words are not looked at; any
/// bytes are safe. No more receivers than limits.receivers, and no more words of bits than limits.entries.
Result<VisibilityTile> decode_visibility(VisibilityTile known, std::span<const std::span<const std::byte>> steps,
                                         const RadianceLimits& limits);

/// The same receiver by receiver, 0.05 to 0.08 ms each of 24,576 samples: `visit(receiver, bits)` is called for each,
/// in order, until it returns false or something is wrong with the bytes. Holds 256 receivers at a time.
using ReceiverVisit = std::function<bool(uint32_t receiver, std::span<const uint32_t> bits)>;
Status visit_visibility(const VisibilityTile& known, std::span<const std::span<const std::byte>> steps,
                        const ReceiverVisit& visit);

}  // namespace citystream::codec::radiance
