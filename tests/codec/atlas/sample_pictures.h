// Pictures that the tests of charts and metrics share; the same everywhere, from integers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "codec/atlas/image.h"

namespace citystream::codec::atlas::sample {

/// Numbers 0..255 without pattern.
class Noise {
  public:
    explicit Noise(uint32_t seed) : state_(seed * 2654435761u + 1) {}
    uint32_t operator()() {
        state_ = state_ * 1664525u + 1013904223u;
        return state_ >> 24;
    }

  private:
    uint32_t state_;
};

/// Image of the 8-bit sRGB values that `value(x, y, channel)` gives, clamped to 0..255.
template <typename Value>
Image picture(uint32_t width, uint32_t height, const Value& value) {
    std::vector<uint8_t> bytes;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            for (uint32_t c = 0; c < 3; ++c)
                bytes.push_back(static_cast<uint8_t>(std::clamp<int>(static_cast<int>(value(x, y, c)), 0, 255)));
        }
    }
    return linear_image(width, height, 3, bytes);
}

inline Image flat(uint32_t width, uint32_t height, int red, int green, int blue) {
    return picture(width, height, [&](uint32_t, uint32_t, uint32_t c) { return c == 0 ? red : c == 1 ? green : blue; });
}

/// A wall with evenly spaced windows, without noise.
inline Image facade(uint32_t width, uint32_t height, uint32_t bay = 16) {
    return picture(width, height, [&](uint32_t x, uint32_t y, uint32_t c) {
        const bool window = x % bay >= bay / 4 && x % bay < 3 * bay / 4 && y % bay >= bay / 4 && y % bay < 3 * bay / 4;
        return (window ? 70 : 150) + 10 * static_cast<int>(c);
    });
}

/// Blobs of several sizes, as a photograph has them: noise on grids of 1, 2, 4, .. texels, the coarser the stronger.
inline Image blotches(uint32_t width, uint32_t height, uint32_t seed, int strength = 40) {
    std::vector<std::vector<int>> grids;
    Noise noise(seed);
    for (uint32_t side = 1; side <= 16; side *= 2) {
        auto& grid = grids.emplace_back((size_t{width} / side + 1) * (height / side + 1) * 3);
        for (int& value : grid) value = static_cast<int>(noise()) - 128;
    }
    return picture(width, height, [&](uint32_t x, uint32_t y, uint32_t c) {
        int sum = 0, weight = 0;
        for (uint32_t k = 0; k < grids.size(); ++k) {
            const uint32_t side = 1u << k;
            sum += (static_cast<int>(k) + 1) * grids[k][((y / side) * (width / side + 1) + x / side) * 3 + c];
            weight += static_cast<int>(k) + 1;
        }
        return 128 + 4 * strength * sum / weight / 128;
    });
}

/// The same with `amplitude` of noise more.
inline Image with_noise(const Image& image, uint32_t amplitude, uint32_t seed) {
    const std::vector<uint8_t> bytes = srgb_bytes(image);
    Noise noise(seed);
    return picture(image.width, image.height, [&](uint32_t x, uint32_t y, uint32_t c) {
        const int value = bytes[3 * (size_t{y} * image.width + x) + c];
        return value + static_cast<int>(noise() % (2 * amplitude + 1)) - static_cast<int>(amplitude);
    });
}

}  // namespace citystream::codec::atlas::sample
