#include "codec/atlas/level_law.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "codec/atlas/chart_border.h"

namespace citystream::codec::atlas {

namespace {

constexpr double kLargestFactor = 256;
constexpr uint32_t kMostLevels = 16;

/// As few digits as name the number.
std::string shortest(double value) {
    std::array<char, 32> digits;
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

}  // namespace

double LevelLaw::metres_per_texel(uint32_t level) const {
    double metres = finest;
    for (uint32_t i = 0; i < level; ++i) metres *= factor;
    return metres;
}

uint32_t LevelLaw::mips(uint32_t level) const {
    if (level + 1 >= levels) return 0;
    // The largest h with 2^h <= factor, by comparison: a logarithm could round 8 to just below 3.
    uint32_t halvings = 0;
    while (halvings < kMostMips + 1 && std::ldexp(1.0, static_cast<int>(halvings) + 1) <= factor) ++halvings;
    if (rule == MipRule::kPaper) halvings = std::max(halvings, 1u) - 1;
    return std::min(halvings, kMostMips);
}

Status check_law(const LevelLaw& law) {
    if (!(law.finest > 0) || !std::isfinite(law.finest))
        return Error{"atlas levels start at " + shortest(law.finest) + " metres per texel"};
    if (!(law.factor > 1 && law.factor <= kLargestFactor))
        return Error{"atlas levels differ by a factor of " + shortest(law.factor) + ", not more than 1 and at most " +
                     shortest(kLargestFactor)};
    if (law.levels == 0 || law.levels > kMostLevels)
        return Error{std::to_string(law.levels) + " atlas levels, not 1 to 16"};
    return Done{};
}

LevelLaw thesis_law() {
    return {0.05, 8, 3, MipRule::kPaper};
}

}  // namespace citystream::codec::atlas
