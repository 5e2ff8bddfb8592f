// Sets of rectangles for the packing tests, the same from every standard library.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/atlas/rectangle_packing_atlas.h"

namespace citystream::codec::atlas::tests {

class Dice {
  public:
    explicit Dice(uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}
    /// low .. high, both included.
    uint32_t roll(uint32_t low, uint32_t high) {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return low + static_cast<uint32_t>((state_ >> 33) % (uint64_t{high} - low + 1));
    }

  private:
    uint64_t state_;
};

/// Sides low..high, the small ones more frequent.
inline std::vector<RectangleSize> random_sizes(Dice& dice, size_t count, uint32_t low, uint32_t high) {
    std::vector<RectangleSize> sizes(count);
    const auto side = [&] { return dice.roll(low, dice.roll(low, high)); };
    for (RectangleSize& size : sizes) {
        size.width = side();
        size.height = side();
    }
    return sizes;
}

/// Facade-like charts: sides around `mean` texels, sources up to twice as large.
inline std::vector<ChartRequest> random_charts(Dice& dice, size_t count, uint32_t mean, uint32_t most) {
    std::vector<ChartRequest> charts(count);
    for (ChartRequest& chart : charts) {
        const auto side = [&] {
            return std::min(most, (dice.roll(mean / 4, mean) + dice.roll(mean / 4, mean + mean / 2)));
        };
        chart.wanted = {side(), side()};
        chart.source = {chart.wanted.width * dice.roll(8, 16) / 8, chart.wanted.height * dice.roll(8, 16) / 8};
        chart.repeat_u = dice.roll(0, 1) != 0;
        chart.repeat_v = dice.roll(0, 1) != 0;
    }
    return charts;
}

/// Texels of a page that some rectangle covers, counted cell by cell of `unit` x `unit` texels (which all sides are
/// multiples of); `once`: none is covered twice or lies outside.
inline uint64_t counted_texels(const std::vector<Rectangle>& places, uint32_t width, uint32_t height, uint32_t unit,
                               bool& once) {
    const uint32_t across = width / unit, up = height / unit;
    std::vector<uint8_t> covered(uint64_t{across} * up, 0);
    uint64_t cells = 0;
    once = true;
    for (const Rectangle& place : places) {
        for (uint32_t y = place.y / unit; y < (place.y + place.height) / unit; ++y) {
            for (uint32_t x = place.x / unit; x < (place.x + place.width) / unit; ++x, ++cells)
                once = once && x < across && y < up && covered[uint64_t{y} * across + x]++ == 0;
        }
    }
    return cells * unit * unit;
}

/// Padded rectangles of the charts of one page.
inline std::vector<Rectangle> padded_on(const AtlasPacking& packing, uint32_t page) {
    std::vector<Rectangle> places;
    for (const PackedChart& chart : packing.charts) {
        if (chart.page == page) places.push_back(chart.padded);
    }
    return places;
}

}  // namespace citystream::codec::atlas::tests
