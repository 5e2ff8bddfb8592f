#include "codec/radiance/relief_mask.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <string>

#include "codec/facade/facade_ray.h"
#include "codec/radiance/irradiance.h"
#include "codec/radiance/local_directions.h"

namespace citystream::codec::radiance {

namespace {

using facade::displacement_of;

constexpr uint32_t kWeightOne = 1u << IRRADIANCE_WEIGHT_BITS;
/// Side of the cube grid over which cosines are averaged, as cell_averages has it.
constexpr uint32_t kAverageSide = 256;
/// Millimetres between the surface and where rays start: less than any step of the relief.
constexpr double kAboveSurface = 0.5;
constexpr double kMillimetresPerMetre = 1000;

const LocalDirections& directions() {
    static const LocalDirections all(RELIEF_DIRECTIONS_ACROSS);
    return all;
}

/// Of the sides of reveals: how far a direction (integers) points along each face's normal.
int32_t along_normal(const GridDirection& d, uint32_t face) {
    switch (face) {
        case RELIEF_FACE_RIGHT:
            return d[0];
        case RELIEF_FACE_LEFT:
            return -d[0];
        case RELIEF_FACE_UPPER:
            return d[1];
        case RELIEF_FACE_LOWER:
            return -d[1];
        default:
            return d[2];
    }
}

ReliefWeights make_weights() {
    std::array<std::array<double, RELIEF_DIRECTIONS>, RELIEF_FACES> sum{};
    std::array<double, RELIEF_DIRECTIONS> solid_angle{};
    for (uint32_t cell = 0; cell < cube_cells(kAverageSide); ++cell) {
        const GridDirection d = cell_direction(kAverageSide, cell);
        if (d[2] <= 0) continue;
        const uint32_t j = directions().nearest({d[0], d[1], d[2]});
        const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
        const double here = cell_solid_angle(kAverageSide, cell);
        solid_angle[j] += here;
        for (uint32_t face = 0; face < RELIEF_FACES; ++face)
            sum[face][j] += here * (std::max(along_normal(d, face), 0) / length);
    }
    ReliefWeights weights{};
    for (uint32_t face = 0; face < RELIEF_FACES; ++face) {
        for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
            const double mean = sum[face][j] / solid_angle[j];
            weights[face][j] = std::min(static_cast<uint32_t>(std::floor(mean * kWeightOne + 0.5)), kWeightOne - 1);
        }
    }
    return weights;
}

uint32_t run_of(const std::vector<uint32_t>& breaks, uint32_t texel) {
    return static_cast<uint32_t>(std::upper_bound(breaks.begin(), breaks.end(), texel) - breaks.begin()) - 1;
}

}  // namespace

uint32_t ReliefMaskShape::middle(uint32_t i, uint32_t size) const {
    return std::min((i << log2_side) + (1u << log2_side) / 2, size - 1);
}

ReliefMaskShape relief_mask_shape(uint32_t width, uint32_t height) {
    assert(width >= 1 && width <= facade::kMaxFacadeSide && height >= 1 && height <= facade::kMaxFacadeSide);
    ReliefMaskShape shape{width, height, 0};
    while (shape.texels() > RELIEF_MASK_MOST_TEXELS) ++shape.log2_side;
    return shape;
}

const ReliefWeights& relief_weights() {
    static const ReliefWeights weights = make_weights();
    return weights;
}

std::vector<uint32_t> relief_mask_head(const ReliefMaskShape& shape, const FacadeScales& scales) {
    std::vector<uint32_t> words(RELIEF_MASK_TEXELS, 0);
    words[RELIEF_MASK_WORD_MAGIC] = RELIEF_MASK_MAGIC;
    words[RELIEF_MASK_WORD_MAP] = shape.width | shape.height << 16;
    words[RELIEF_MASK_WORD_SIDE] = shape.log2_side;
    for (size_t i = 0; i < 2; ++i) words[RELIEF_MASK_WORD_SCALES + i] = std::bit_cast<uint32_t>(scales[i]);
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
        const GridDirection& d = directions().direction(j);
        uint32_t* const to = &words[RELIEF_MASK_DIRECTIONS + size_t{j} * RELIEF_MASK_DIRECTION_WORDS];
        to[0] = (static_cast<uint32_t>(d[0]) & 0xffffu) | static_cast<uint32_t>(d[1]) << 16;
        to[1] = static_cast<uint32_t>(d[2]);
        for (uint32_t face = 0; face < RELIEF_FACES; ++face)
            words[RELIEF_MASK_WEIGHTS + face * RELIEF_MASK_FACE_WORDS + j / 2] |= relief_weights()[face][j]
                                                                                  << 16 * (j % 2);
    }
    return words;
}

std::vector<uint32_t> make_relief_mask(const facade::RunGrid& grid, const FacadeScales& scales) {
    const ReliefMaskShape shape = relief_mask_shape(grid.width(), grid.height());
    const facade::DepthRange depths = grid.depths();
    std::vector<uint32_t> words = relief_mask_head(shape, scales);
    std::array<std::array<double, 3>, RELIEF_DIRECTIONS> along{};
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
        const GridDirection& d = directions().direction(j);
        along[j] = {d[0] * double{scales[0]}, d[1] * double{scales[1]}, d[2] * kMillimetresPerMetre};
    }
    for (uint32_t y = 0; y < shape.up(); ++y) {
        const uint32_t v = shape.middle(y, shape.height), row = run_of(grid.y_breaks, v);
        for (uint32_t x = 0; x < shape.across(); ++x) {
            const uint32_t u = shape.middle(x, shape.width);
            const uint32_t label = grid.label(run_of(grid.x_breaks, u), row);
            const double origin[3] = {u + 0.5, v + 0.5, displacement_of(label) + kAboveSurface};
            uint64_t bits = ~uint64_t{0};
            if (displacement_of(label) != facade::kOpenDisplacement) {
                for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
                    if (facade::cast_facade_ray(grid, depths, origin, along[j].data()).hit) bits &= ~(uint64_t{1} << j);
                }
            }
            words.push_back(static_cast<uint32_t>(bits));
            words.push_back(static_cast<uint32_t>(bits >> 32));
            words.push_back(label);
        }
    }
    return words;
}

float ReliefShares::free(uint32_t direction) const {
    float sum = 0;
    for (size_t k = 0; k < 4; ++k) sum += (bits[k] >> direction & 1) != 0 ? share[k] : 0;
    return sum;
}

Result<ReliefMaskView> ReliefMaskView::create(std::span<const uint32_t> words) {
    if (words.size() < RELIEF_MASK_TEXELS)
        return Error{"relief mask of " + std::to_string(words.size()) + " words, fewer than its head has", 0};
    if (words[RELIEF_MASK_WORD_MAGIC] != RELIEF_MASK_MAGIC) return Error{"not a relief mask: wrong magic", 0};
    const uint32_t map = words[RELIEF_MASK_WORD_MAP], width = map & 0xffff, height = map >> 16;
    if (width == 0 || height == 0 || width > facade::kMaxFacadeSide || height > facade::kMaxFacadeSide)
        return Error{"relief mask of a map of " + std::to_string(width) + " x " + std::to_string(height) + " texels",
                     4 * RELIEF_MASK_WORD_MAP};
    const ReliefMaskShape shape = relief_mask_shape(width, height);
    if (words[RELIEF_MASK_WORD_SIDE] != shape.log2_side)
        return Error{"relief mask whose texels are not those of its map", 4 * RELIEF_MASK_WORD_SIDE};
    for (size_t i = 0; i < 2; ++i) {
        const auto scale = std::bit_cast<float>(words[RELIEF_MASK_WORD_SCALES + i]);
        if (!std::isfinite(scale) || scale <= 0)
            return Error{"relief mask without a scale", 4 * (RELIEF_MASK_WORD_SCALES + i)};
    }
    if (words.size() != shape.words())
        return Error{"relief mask of " + std::to_string(words.size()) + " words, its map's has " +
                     std::to_string(shape.words())};
    return ReliefMaskView(words, shape);
}

FacadeScales ReliefMaskView::scales() const {
    return {std::bit_cast<float>(words_[RELIEF_MASK_WORD_SCALES]),
            std::bit_cast<float>(words_[RELIEF_MASK_WORD_SCALES + 1])};
}

uint64_t ReliefMaskView::bits(uint32_t x, uint32_t y) const {
    const uint32_t* const texel = &words_[RELIEF_MASK_TEXELS + (y * shape_.across() + x) * RELIEF_MASK_TEXEL_WORDS];
    return texel[0] | uint64_t{texel[1]} << 32;
}

uint32_t ReliefMaskView::label(uint32_t x, uint32_t y) const {
    return words_[RELIEF_MASK_TEXELS + (y * shape_.across() + x) * RELIEF_MASK_TEXEL_WORDS + 2];
}

ReliefShares ReliefMaskView::shares(const std::array<float, 3>& at, uint32_t label, int axis, int sign) const {
    const bool is_front = axis == 2;
    const auto side = static_cast<float>(1u << shape_.log2_side);
    std::array<float, 2> low{}, part{};
    for (int i = 0; i < 2; ++i) {
        // In front of a reveal, where rays came from.
        const float place = axis == i ? at[i] + static_cast<float>(sign) * 0.5F * side : at[i];
        const float in_grid = place / side - 0.5F;
        low[i] = std::floor(in_grid);
        part[i] = in_grid - low[i];
    }
    const float depth = is_front ? static_cast<float>(displacement_of(label)) : at[2];
    ReliefShares shares;
    float sum = 0, nearest = std::numeric_limits<float>::max(), nearest_share = 0;
    size_t best = 0;
    for (size_t k = 0; k < 4; ++k) {
        const bool right = (k & 1) != 0, above = (k & 2) != 0;
        const auto texel = [](float i, uint32_t count) {
            return static_cast<uint32_t>(std::clamp(i, 0.0F, static_cast<float>(count - 1)));
        };
        const uint32_t x = texel(low[0] + (right ? 1 : 0), shape_.across());
        const uint32_t y = texel(low[1] + (above ? 1 : 0), shape_.up());
        shares.bits[k] = bits(x, y);
        const auto here = static_cast<float>(displacement_of(this->label(x, y)));
        const float share = (right ? part[0] : 1 - part[0]) * (above ? part[1] : 1 - part[1]);
        const bool is_own = is_front ? here == depth : here < depth;
        shares.share[k] = is_own ? share : 0;
        sum += shares.share[k];
        const float away = std::abs(here - depth);
        if (away < nearest || (away == nearest && share > nearest_share)) {
            nearest = away;
            nearest_share = share;
            best = k;
        }
    }
    for (size_t k = 0; k < 4; ++k) shares.share[k] = sum > 0 ? shares.share[k] / sum : (k == best ? 1.0F : 0.0F);
    return shares;
}

double relief_irradiance(const ReliefShares& shares, uint32_t face, std::span<const double, RELIEF_DIRECTIONS> light) {
    double sum = 0;
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j)
        sum += light[j] * relief_weights()[face][j] / kWeightOne * double{shares.free(j)};
    return sum;
}

}  // namespace citystream::codec::radiance
