#include "tiles/city/procedural_texture.h"

#include <algorithm>

#include "tiles/city/generator_random.h"

namespace citystream::tiles::city::procedural {
namespace {

constexpr int kSize = kTextureSize;

/// -256..255, smooth, repeating after kSize texels; `cells` lattice cells across (a power of two).
int tileable_noise(int x, int y, int cells, uint64_t seed) {
    const int pitch = kSize / cells;
    const int cx = x / pitch, cy = y / pitch;
    const auto weight = [pitch](int offset) {
        const int t = (2 * offset + 1) * 128 / pitch;  // 0..256
        return t * t * (768 - 2 * t) / 65536;
    };
    const int tx = weight(x % pitch), ty = weight(y % pitch);
    const auto lattice = [cells, seed](int i, int j) {
        return static_cast<int>(hash(seed, i % cells, j % cells) & 511) - 256;
    };
    const int low = lattice(cx, cy) * (256 - tx) + lattice(cx + 1, cy) * tx;
    const int high = lattice(cx, cy + 1) * (256 - tx) + lattice(cx + 1, cy + 1) * tx;
    return (low / 256 * (256 - ty) + high / 256 * ty) / 256;
}

/// One hashed value per cell, -256..255.
int cell_noise(int i, int j, uint64_t seed) {
    return static_cast<int>(hash(seed, i, j, 5) & 511) - 256;
}

/// Two octaves of blotches.
int blotches(int x, int y, uint64_t seed) {
    return (tileable_noise(x, y, 8, seed) * 2 + tileable_noise(x, y, 32, seed + 1)) / 3;
}

template <typename Shade>
Image draw(Shade shade) {
    Image image;
    image.width = image.height = kSize;
    image.rgb.reserve(size_t{3} * kSize * kSize);
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            const auto [colour, level] = shade(x, y);
            // Brightness changes keep the hue, so a block's colours stay on one line for BC1.
            for (uint8_t channel : colour)
                image.rgb.push_back(static_cast<uint8_t>(std::clamp(channel + channel * level / 160, 0, 255)));
        }
    }
    return image;
}

struct Texel {
    Rgb colour;
    int level;  ///< brightness change, about -60..60
};

}  // namespace

Image brick_texture(Rgb brick, Rgb joint, int across, int courses, uint64_t seed) {
    const int width = kSize / across, height = kSize / courses;
    return draw([=](int x, int y) -> Texel {
        const int course = y / height;
        const int shifted = (x + course % 2 * width / 2) % kSize;
        if (y % height == 0 || shifted % width == 0) return {joint, blotches(x, y, seed) * 8 / 256};
        return {brick, cell_noise(shifted / width, course, seed) * 26 / 256 + blotches(x, y, seed) * 10 / 256};
    });
}

Image plaster_texture(Rgb colour, int strength, uint64_t seed) {
    return draw([=](int x, int y) -> Texel {
        return {colour, blotches(x, y, seed) * strength / 256 + tileable_noise(x, y, 64, seed + 9) * 3 / 256};
    });
}

Image slab_texture(Rgb stone, Rgb joint, int across, int courses, bool bond, uint64_t seed) {
    const int width = kSize / across, height = kSize / courses;
    return draw([=](int x, int y) -> Texel {
        const int course = y / height;
        const int shifted = (x + (bond ? course % 2 * width / 2 : 0)) % kSize;
        if (y % height < 2 || shifted % width < 2) return {joint, 0};
        return {stone, cell_noise(shifted / width, course, seed) * 14 / 256 + blotches(x, y, seed) * 10 / 256};
    });
}

Image tile_texture(Rgb tile, int across, int courses, uint64_t seed) {
    const int width = kSize / across, height = kSize / courses;
    return draw([=](int x, int y) -> Texel {
        const int course = y / height, row = y % height;
        const int shifted = (x + course % 2 * width / 2) % kSize;
        // Lower rim of a tile bright, its upper end in the shade of the tile above.
        const int slope = row == 0 ? -46 : row >= height - 2 ? -24 : 8 - 12 * row / height;
        const int edge = shifted % width == 0 ? -30 : 0;
        return {tile, slope + edge + cell_noise(shifted / width, course, seed) * 20 / 256};
    });
}

Image sheet_texture(Rgb sheet, int seams, uint64_t seed) {
    const int pitch = kSize / seams;
    return draw([=](int x, int y) -> Texel {
        const int in = x % pitch;
        const int seam = in == 0 ? 26 : in == 1 ? -30 : 0;
        return {sheet, seam + blotches(x, y, seed) * 8 / 256};
    });
}

Image ground_texture(Rgb colour, int grain, int blotch, uint64_t seed) {
    return draw([=](int x, int y) -> Texel {
        return {colour, tileable_noise(x, y, 64, seed) * grain / 256 + blotches(x, y, seed + 3) * blotch / 256};
    });
}

Image road_texture(int lanes, uint64_t seed) {
    const Rgb asphalt = {92, 92, 95}, paint = {222, 222, 218};
    const int half = lanes > 2 ? 1 : 2;  // texels, half a line's width: wide roads spread over the same texels
    return draw([=](int x, int y) -> Texel {
        const bool dash = y % 64 < 32;
        for (int lane = 1; lane < lanes; ++lane) {
            const int line = kSize * lane / lanes;
            const bool middle_of_wide = lanes > 2 && 2 * lane == lanes;
            if (x >= line - half && x < line + half && (dash || middle_of_wide)) return {paint, 0};
        }
        if (x < 3 || x >= kSize - 3) return {{120, 120, 120}, 0};
        return {asphalt, tileable_noise(x, y, 64, seed) * 14 / 256 + blotches(x, y, seed) * 10 / 256};
    });
}

Image crossing_texture(uint64_t seed) {
    return draw([=](int x, int y) -> Texel {
        if (x % 16 >= 4 && x % 16 < 12) return {{222, 222, 218}, 0};
        return {{92, 92, 95}, tileable_noise(x, y, 64, seed) * 14 / 256};
    });
}

}  // namespace citystream::tiles::city::procedural
