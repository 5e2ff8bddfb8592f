#include "codec/atlas/rectangle_packing.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <map>

#include "codec/atlas/rectangle_packing_methods.h"

namespace citystream::codec::atlas {

namespace {

/// A rectangle's left or right side, in the order in which a vertical line that moves right meets them: right sides
/// first, so that rectangles may touch.
struct Side {
    uint32_t x;
    bool opens;
    uint32_t rectangle;
};

std::vector<Side> sides_of(std::span<const Rectangle> places) {
    std::vector<Side> sides;
    for (uint32_t i = 0; i < places.size(); ++i) {
        if (places[i].area() == 0) continue;
        sides.push_back({places[i].x, true, i});
        sides.push_back({places[i].x + places[i].width, false, i});
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        if (a.x != b.x) return a.x < b.x;
        if (a.opens != b.opens) return b.opens;
        return a.rectangle < b.rectangle;
    });
    return sides;
}

}  // namespace

uint64_t total_area(std::span<const RectangleSize> sizes) {
    uint64_t sum = 0;
    for (const RectangleSize size : sizes) sum += size.area();
    return sum;
}

RectangleSize predicted_bin(uint64_t area) {
    // The number of bits of area - 1 is ceil(log2(area)), also where area is a power of two.
    const auto alpha = area <= 1 ? 0u : static_cast<uint32_t>(std::bit_width(area - 1));
    const uint32_t half = alpha / 2;
    assert(alpha - half < 32);
    return {1u << (alpha - half), 1u << half};
}

RectangleSize smallest_bin(std::span<const RectangleSize> sizes) {
    const uint64_t area = total_area(sizes);
    RectangleSize largest = {1, 1};
    for (const RectangleSize size : sizes)
        largest = {std::max(largest.width, size.width), std::max(largest.height, size.height)};
    const RectangleSize predicted = predicted_bin(area);
    if (largest.fits_in(predicted)) return predicted;
    RectangleSize bin = {std::bit_ceil(largest.width), std::bit_ceil(largest.height)};
    while (bin.area() < area) bin = next_bin(bin);
    return bin;
}

RectangleSize next_bin(RectangleSize bin) {
    if (bin.width <= bin.height) return {bin.width * 2, bin.height};
    return {bin.width, bin.height * 2};
}

Packing pack_rectangles(std::span<const RectangleSize> sizes, RectangleSize bin, PackMethod method, uint32_t taste,
                        PackWhole whole) {
    assert(sizes.size() <= kMostRectangles && taste < kPackTastes);
    assert(bin.area() > 0 && bin.fits_in({kMaxBinSide, kMaxBinSide}));
    switch (method) {
        case PackMethod::kGuillotine:
            return pack_guillotine(sizes, bin, taste, whole);
        case PackMethod::kSkyline:
            return pack_skyline(sizes, bin, taste, whole);
        default:
            return pack_binary_tree(sizes, bin, whole);
    }
}

bool layout_is_valid(std::span<const Rectangle> places, RectangleSize bin) {
    std::map<uint32_t, uint32_t> open;  // bottom -> top of the rectangles that the line crosses
    for (const Side& side : sides_of(places)) {
        const Rectangle& place = places[side.rectangle];
        if (!side.opens) {
            open.erase(place.y);
            continue;
        }
        const uint64_t top = uint64_t{place.y} + place.height;
        if (uint64_t{place.x} + place.width > bin.width || top > bin.height) return false;
        const auto above = open.lower_bound(place.y);
        if (above != open.end() && above->first < top) return false;
        if (above != open.begin() && std::prev(above)->second > place.y) return false;
        open[place.y] = static_cast<uint32_t>(top);
    }
    return true;
}

}  // namespace citystream::codec::atlas
