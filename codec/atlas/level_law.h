// How coarse the atlas of each tree level is, and how many mips it keeps.
//
// Source: "Space-Optimized Texture Atlases" 8.2.1 (level law, Table 2), as corrected in the notes: levels count from
// the leaf, 0. What goes with it stands elsewhere: borders follow from the mips (chart_border.h), and which level a
// view asks for (8.2.2, Equation 5) from the length of a texel, which counts as error of its tile
// (client/select/selection.h).
#pragma once

#include <cstdint>

#include "codec/result.h"

namespace citystream::codec::atlas {

enum class MipRule : uint8_t {
    kPaper,  ///< log2(factor) - 1 mips: the last halving before the next level is left to aliasing (pitfall 9)
    kFull,   ///< log2(factor) mips: every level can be minified as far as the next level's texels
};

/// Each level's texels are `factor` times as long as those of the level below it.
struct LevelLaw {
    double finest = 0.05;  ///< metres per texel of the leaves (level 0)
    double factor = 8;     ///< > 1
    uint32_t levels = 3;   ///< of the tree: the root is level levels - 1
    MipRule rule = MipRule::kPaper;

    /// lambda: factor^level * finest, metres per texel.
    double metres_per_texel(uint32_t level) const;
    /// M: mips besides the finest; 0 at the root, else by the rule, rounded down, at most kMostMips (chart_border.h).
    uint32_t mips(uint32_t level) const;
    bool operator==(const LevelLaw&) const = default;
};

/// Refuses numbers that are not finite or out of range (finest > 0, 1 < factor <= 256, 1..16 levels).
Status check_law(const LevelLaw& law);

/// Table 2: 0.05, 0.4 and 3.2 metres per texel; mips 2, 2, 0.
LevelLaw thesis_law();

}  // namespace citystream::codec::atlas
