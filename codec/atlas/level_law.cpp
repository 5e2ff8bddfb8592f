#include "codec/atlas/level_law.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "codec/atlas/chart_border.h"

namespace citystream::codec::atlas {

namespace {

constexpr double kLargestFactor = 256;
constexpr uint32_t kMostLevels = 16;

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

uint32_t LevelLaw::border(uint32_t level) const {
    return border_for_mips(mips(level));
}

Status check_law(const LevelLaw& law) {
    if (!(law.finest > 0) || !std::isfinite(law.finest))
        return Error{"atlas levels start at " + std::to_string(law.finest) + " metres per texel"};
    if (!(law.factor > 1 && law.factor <= kLargestFactor))
        return Error{"atlas levels differ by a factor of " + std::to_string(law.factor) + ", not 1 to 256"};
    if (law.levels == 0 || law.levels > kMostLevels)
        return Error{std::to_string(law.levels) + " atlas levels, not 1 to 16"};
    return Done{};
}

LevelLaw thesis_law() {
    return {0.05, 8, 3, MipRule::kPaper};
}

uint64_t full_tree_nodes(uint32_t depth) {
    if (depth >= 32) return std::numeric_limits<uint64_t>::max();
    return ((uint64_t{1} << (2 * depth)) - 1) / 3 + (uint64_t{1} << (2 * depth));
}

ViewAxis horizontal_axis(double width, double height, double vertical_field_of_view) {
    return {width, 2 * std::atan(std::tan(vertical_field_of_view / 2) * width / height)};
}

double screen_projection(double metres, const ViewAxis& axis, double distance) {
    if (!(distance > 0)) return std::numeric_limits<double>::infinity();
    return metres * axis.pixels / (2 * distance * std::tan(axis.field_of_view / 2));
}

double switch_distance(double metres_per_texel, const ViewAxis& axis, double most_pixels) {
    return metres_per_texel * axis.pixels / (2 * most_pixels * std::tan(axis.field_of_view / 2));
}

uint32_t level_at(const LevelLaw& law, const ViewAxis& axis, double distance, double most_pixels) {
    for (uint32_t level = law.levels; level-- > 1;) {
        if (screen_projection(law.metres_per_texel(level), axis, distance) <= most_pixels) return level;
    }
    return 0;
}

LevelBlend level_blend(const LevelLaw& law, const ViewAxis& axis, double distance, double most_pixels, double band) {
    assert(band >= 0 && band <= 1);
    LevelBlend blend;
    blend.level = level_at(law, axis, distance, most_pixels);
    if (blend.level + 1 >= law.levels || band == 0) return blend;
    const double takes_over = switch_distance(law.metres_per_texel(blend.level + 1), axis, most_pixels);
    const double begin = takes_over * std::max(1 - band, 1 / law.factor);
    const double t = std::clamp((distance - begin) / (takes_over - begin), 0.0, 1.0);
    blend.coarser = t * t * (3 - 2 * t);
    return blend;
}

uint32_t terrain_resolution(const ViewAxis& axis, double tile_side, const std::array<double, 3>& to_nearest) {
    const double distance = std::hypot(to_nearest[0], to_nearest[1], to_nearest[2]);
    if (!(distance > 0)) return kFinestTerrain;
    const double pixels = screen_projection(1, axis, distance) * tile_side * (std::abs(to_nearest[2]) / distance);
    if (!(pixels < kFinestTerrain)) return kFinestTerrain;
    return std::max(kCoarsestTerrain, std::bit_ceil(static_cast<uint32_t>(std::ceil(pixels))));
}

}  // namespace citystream::codec::atlas
