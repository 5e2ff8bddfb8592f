// The contexts of the patch map's wire form, and the probabilities with which they begin.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/bits/range_coder.h"

namespace citystream::codec::facade {

/// A number's contexts: length of value + 1 in unary, then the first bits below the leading one.
inline constexpr uint32_t kNumberLengths = 18, kNumberMantissa = 7;
inline constexpr uint32_t kNumberContexts = kNumberLengths + kNumberLengths * kNumberMantissa;

/// First context of each kind of decision.
struct PatchContexts {
    enum Numbers : uint32_t {
        kSize,
        kBandGap,
        kStripeCount,
        kStripeSkip,
        kStripeGap,
        kColumnCount,
        kColumnSkip,
        kColumnGap,
        kRowCount,
        kRowSkip,
        kRowGap,
        kDepth,
        kDepthUnit,
        kMaterial,
        kRank,
        kRankEnd = kRank + 6,  // one for each pool
        kCellRank = kRankEnd,
        kNumberKinds
    };
    enum Flags : uint32_t {
        kTransposed = kNumberKinds * kNumberContexts,
        kIsNew,                      // 6 pools x 4
        kIsPatch = kIsNew + 24,      // type before x type below
        kKnown = kIsPatch + 9,       // 3 kinds of positions x last one known
        kMirrored = kKnown + 6,      // last one mirrored
        kCandidate = kMirrored + 2,  // 6 pools x 4 candidates x (first, after a miss)
        kSameMaterial = kCandidate + 48,
        kCell = kSameMaterial + 2,    // 5 candidates x 32 agreements
        kCellIsNew = kCell + 5 * 32,  // labels seen
        kCount = kCellIsNew + 16
    };
};

/// The models as every map begins.
std::vector<bits::BitModel> patch_wire_models();

}  // namespace citystream::codec::facade
