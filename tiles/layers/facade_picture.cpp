#include "tiles/layers/facade_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace citystream::tiles::layers {
namespace {

using codec::facade::RunGrid;

/// How much of a texel each slot covers; slots of open cells stand behind the others.
using Coverage = std::array<float, 2 * FACADE_PALETTE_SLOTS>;

/// Part of a run of the map that lies in one texel of an axis.
struct Overlap {
    uint32_t run = 0, texel = 0;
    float length = 0;  ///< texels of the map
};

/// In order of runs, and of texels in each.
std::vector<Overlap> overlaps_of(const std::vector<uint32_t>& breaks, uint32_t texels) {
    std::vector<Overlap> out;
    const double step = static_cast<double>(breaks.back()) / texels;
    for (uint32_t run = 0; run + 1 < breaks.size(); ++run) {
        const double begin = breaks[run], end = breaks[run + 1];
        for (auto texel = static_cast<uint32_t>(begin / step); texel < texels && texel * step < end; ++texel) {
            const double length = std::min(end, (texel + 1) * step) - std::max(begin, texel * step);
            if (length > 0) out.push_back({run, texel, static_cast<float>(length)});
        }
    }
    return out;
}

size_t coverage_index(uint32_t label) {
    const bool open = codec::facade::displacement_of(label) == codec::facade::kOpenDisplacement;
    return slot_of(label) + (open ? FACADE_PALETTE_SLOTS : 0);
}

std::array<float, 3> mean_of_slots(const Coverage& coverage, const SlotColours& slots, double x, double y) {
    float covered = 0;
    for (size_t slot = 0; slot < FACADE_PALETTE_SLOTS; ++slot) covered += coverage[slot];
    const size_t first = covered > 0 ? 0 : FACADE_PALETTE_SLOTS;
    std::array<float, 3> sum{};
    float weight = 0;
    for (size_t slot = 0; slot < FACADE_PALETTE_SLOTS; ++slot) {
        const float share = coverage[first + slot];
        if (share <= 0) continue;
        const auto rgb = slots[slot].at(x, y);
        for (size_t c = 0; c < 3; ++c) sum[c] += share * rgb[c];
        weight += share;
    }
    for (float& channel : sum) channel /= weight;
    return sum;
}

}  // namespace

uint32_t slot_of(uint32_t label) {
    return codec::facade::material_of(label) % FACADE_PALETTE_SLOTS;
}

std::array<float, 3> SlotColour::at(double x, double y) const {
    if (!image) return flat;
    const auto wrap = [&](double metres, uint32_t size) {
        const double repeats = metres / metres_per_repeat;
        const auto texel = static_cast<int64_t>(std::floor((repeats - std::floor(repeats)) * size));
        return static_cast<size_t>(std::clamp<int64_t>(texel, 0, int64_t{size} - 1));
    };
    const uint8_t* rgb = image->rgb.data() + 3 * (wrap(y, image->height) * image->width + wrap(x, image->width));
    return {srgb_to_linear(rgb[0]), srgb_to_linear(rgb[1]), srgb_to_linear(rgb[2])};
}

ChartImage paint_facade(const RunGrid& map, double texel_metres, const SlotColours& slots, uint32_t width,
                        uint32_t height) {
    ChartImage out;
    out.width = width;
    out.height = height;
    out.rgb.resize(size_t{3} * width * height);
    const double step_x = texel_metres * map.width() / width, step_y = texel_metres * map.height() / height;
    const std::vector<Overlap> across = overlaps_of(map.x_breaks, width), up = overlaps_of(map.y_breaks, height);
    std::vector<Coverage> row(width);
    for (size_t i = 0; i < up.size();) {
        const uint32_t y = up[i].texel;
        std::fill(row.begin(), row.end(), Coverage{});
        for (; i < up.size() && up[i].texel == y; ++i) {
            for (const Overlap& part : across)
                row[part.texel][coverage_index(map.label(part.run, up[i].run))] += part.length * up[i].length;
        }
        for (uint32_t x = 0; x < width; ++x) {
            const auto rgb = mean_of_slots(row[x], slots, (x + 0.5) * step_x, (y + 0.5) * step_y);
            for (size_t c = 0; c < 3; ++c) out.rgb[3 * (size_t{y} * width + x) + c] = linear_to_srgb(rgb[c]);
        }
    }
    return out;
}

}  // namespace citystream::tiles::layers
