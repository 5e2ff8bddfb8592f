#include "codec/atlas/alpha_mask.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <vector>

#include "codec/atlas/box_taps.h"
#include "codec/atlas/linear_bytes.h"

namespace citystream::codec::atlas {

namespace {

// Of the scale on which texels are compared: eighths of a level of alpha.
constexpr int32_t kEighths = 8;
// What the pattern adds to alpha, up to this many eighths either way, and how steeply alpha then rises through the
// test: patterns keep a contrast of 64 levels, which blocks of 8 values tell apart.
constexpr int32_t kPattern = 63, kSteepness = 4;

/// A place of an 8 x 8 ordered pattern, 0..63: every prefix of places is spread evenly.
int32_t pattern_rank(uint32_t x, uint32_t y) {
    const uint32_t across = x ^ y;
    uint32_t rank = 0;
    for (uint32_t bit = 0; bit < 3; ++bit) rank = rank << 2 | (across >> bit & 1U) << 1 | (y >> bit & 1U);
    return static_cast<int32_t>(rank);
}

size_t texels_of(const ChartImage& image) {
    return size_t{image.width} * image.height;
}

/// Texel before (-1) or behind (1) texel i of an axis, as filtering continues it.
uint32_t beside(uint32_t i, int step, uint32_t side, bool repeat) {
    if (step < 0) return i > 0 ? i - 1 : (repeat ? side - 1 : 0);
    return i + 1 < side ? i + 1 : (repeat ? 0 : side - 1);
}

constexpr uint64_t kPlaces = 16;  ///< of every texel: 1 and 3 eighths of it away from its centre, either way

uint64_t places_there(const ChartImage& image, std::span<const uint8_t> alpha) {
    constexpr uint32_t kEighth = 8, kWhole = kEighth * kEighth;
    const auto at = [&](uint32_t x, uint32_t y) -> uint32_t { return alpha[size_t{y} * image.width + x]; };
    uint64_t count = 0;
    // How much of a place beside `own` is there, whose neighbours that way are known.
    const auto count_corner = [&](uint32_t own, uint32_t along_x, uint32_t along_y, uint32_t across) {
        for (const uint32_t up : {7U, 5U}) {
            for (const uint32_t right : {7U, 5U}) {
                const uint32_t sum = up * (right * own + (kEighth - right) * along_x) +
                                     (kEighth - up) * (right * along_y + (kEighth - right) * across);
                count += sum >= kWhole * kAlphaTest ? 1 : 0;
            }
        }
    };
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            for (const int step_y : {-1, 1}) {
                const uint32_t other_y = beside(y, step_y, image.height, image.repeat_v);
                for (const int step_x : {-1, 1}) {
                    const uint32_t other_x = beside(x, step_x, image.width, image.repeat_u);
                    count_corner(at(x, y), at(other_x, y), at(x, other_y), at(other_x, other_y));
                }
            }
        }
    }
    return count;
}

/// Alpha with the pattern, in eighths, so steepened about `threshold` that this lands at the test.
std::vector<uint8_t> steepened(const ChartImage& image, int32_t threshold) {
    std::vector<uint8_t> out(image.alpha.size());
    size_t i = 0;
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x, ++i) {
            const int32_t value = kEighths * image.alpha[i] + 2 * pattern_rank(x & 7U, y & 7U) - kPattern;
            out[i] = static_cast<uint8_t>(std::clamp(kAlphaTest + (value - threshold) * kSteepness / kEighths, 0, 255));
        }
    }
    return out;
}

/// Colours and alpha of the next coarser mip, alpha's plain mean.
ChartImage filtered(const ChartImage& fine) {
    const LinearBytes& light = LinearBytes::tables();
    ChartImage out;
    out.width = std::max(1U, fine.width >> 1);
    out.height = std::max(1U, fine.height >> 1);
    out.repeat_u = fine.repeat_u;
    out.repeat_v = fine.repeat_v;
    out.metres_per_texel = 2 * fine.metres_per_texel;
    out.rgb.reserve(3 * texels_of(out));
    out.alpha.reserve(texels_of(out));
    for (uint32_t y = 0; y < out.height; ++y) {
        const BoxTaps up = box_taps(y, fine.height);
        for (uint32_t x = 0; x < out.width; ++x) {
            const BoxTaps across = box_taps(x, fine.width);
            std::array<uint64_t, 3> seen{}, all{};
            uint64_t weight = 0;
            for_each_tap(across, up, [&](uint32_t i, uint32_t j, uint64_t share) {
                const size_t texel = size_t{2 * y + j} * fine.width + 2 * x + i;
                for (size_t c = 0; c < 3; ++c) {
                    const uint64_t linear = share * light.linear(fine.rgb[3 * texel + c]);
                    all[c] += linear;
                    seen[c] += fine.alpha[texel] * linear;
                }
                weight += share * fine.alpha[texel];
            });
            const uint64_t total = uint64_t{across.total} * up.total;
            for (size_t c = 0; c < 3; ++c)
                out.rgb.push_back(weight > 0 ? light.mean(seen[c], weight) : light.mean(all[c], total));
            out.alpha.push_back(static_cast<uint8_t>((2 * weight + total) / (2 * total)));
        }
    }
    return out;
}

/// Half the sides, rounded up: colours of what is there, and whether anything is (alpha 255 or 0).
ChartImage covered(const ChartImage& fine) {
    ChartImage out;
    out.width = (fine.width + 1) / 2;
    out.height = (fine.height + 1) / 2;
    out.rgb.resize(3 * texels_of(out));
    out.alpha.resize(texels_of(out));
    for (uint32_t y = 0; y < out.height; ++y) {
        for (uint32_t x = 0; x < out.width; ++x) {
            std::array<uint32_t, 3> sum{};
            uint32_t weight = 0;
            for (uint32_t j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j) {
                for (uint32_t i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i) {
                    const size_t texel = size_t{j} * fine.width + i;
                    weight += fine.alpha[texel];
                    for (size_t c = 0; c < 3; ++c) sum[c] += fine.alpha[texel] * fine.rgb[3 * texel + c];
                }
            }
            if (weight == 0) continue;
            const size_t texel = size_t{y} * out.width + x;
            for (size_t c = 0; c < 3; ++c) out.rgb[3 * texel + c] = static_cast<uint8_t>(sum[c] / weight);
            out.alpha[texel] = 255;
        }
    }
    return out;
}

void fill_from(const ChartImage& coarse, ChartImage& fine) {
    for (uint32_t y = 0; y < fine.height; ++y) {
        for (uint32_t x = 0; x < fine.width; ++x) {
            const size_t texel = size_t{y} * fine.width + x, from = size_t{y / 2} * coarse.width + x / 2;
            if (fine.alpha[texel] == 0) std::copy_n(&coarse.rgb[3 * from], 3, &fine.rgb[3 * texel]);
        }
    }
}

}  // namespace

bool all_there(std::span<const uint8_t> alpha) {
    return std::all_of(alpha.begin(), alpha.end(), [](uint8_t value) { return value >= kAlphaTest; });
}

AreaShare there_of(const ChartImage& image) {
    if (image.alpha.empty()) return {1, 1};
    assert(image.alpha.size() == texels_of(image));
    return {places_there(image, image.alpha), kPlaces * uint64_t{texels_of(image)}};
}

void keep_share(ChartImage& image, AreaShare share) {
    if (image.alpha.empty()) return;
    const uint64_t places = kPlaces * uint64_t{texels_of(image)};
    const auto excess = [&](int32_t threshold) {  // of places there over those wanted, times share.whole
        return static_cast<int64_t>(places_there(image, steepened(image, threshold)) * share.whole) -
               static_cast<int64_t>(share.part * places);
    };
    // The more is asked of a texel, the fewer are there: the thresholds beside the wanted share, the nearer one wins.
    int32_t many = -kPattern - kEighths, few = kEighths * 255 + kPattern + kEighths;
    while (few - many > 1) {
        const int32_t middle = many + (few - many) / 2;
        (excess(middle) >= 0 ? many : few) = middle;
    }
    image.alpha = steepened(image, excess(many) <= -excess(few) ? many : few);
}

void fill_hidden_colours(ChartImage& image) {
    const auto hidden = std::count(image.alpha.begin(), image.alpha.end(), uint8_t{0});
    if (hidden == 0 || static_cast<size_t>(hidden) == image.alpha.size()) return;
    std::vector<ChartImage> levels = {covered(image)};
    while (texels_of(levels.back()) > 1) levels.push_back(covered(levels.back()));
    for (size_t level = levels.size() - 1; level-- > 0;) fill_from(levels[level + 1], levels[level]);
    fill_from(levels[0], image);
}

ChartImage downsample_masked(const ChartImage& image) {
    ChartImage coarse = filtered(image);
    keep_share(coarse, there_of(image));
    return coarse;
}

}  // namespace citystream::codec::atlas
