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
/// A surface besides a mask texel's first has at least so little of its area, one part of.
constexpr uint32_t kLeastPart = 32;

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

/// The part of a mask texel with one depth.
struct Piece {
    int32_t displacement = 0;
    uint32_t area = 0;
    uint32_t largest = 0;  ///< area of its largest rectangle
    ReliefStart start;     ///< the middle of that
};

void add_rectangle(std::vector<Piece>& pieces, const std::array<uint32_t, 4>& box, uint32_t label) {
    const auto [x0, y0, x1, y1] = box;
    const uint32_t area = (x1 - x0) * (y1 - y0);
    auto piece = std::ranges::find(pieces, displacement_of(label), &Piece::displacement);
    if (piece == pieces.end()) piece = pieces.insert(piece, Piece{displacement_of(label), 0, 0, {}});
    piece->area += area;
    if (area <= piece->largest) return;
    piece->largest = area;
    piece->start = {x0 + (x1 - x0) / 2, y0 + (y1 - y0) / 2, label};
}

/// Of the square of `side` texels at a place of the map.
std::vector<Piece> largest_pieces(const facade::RunGrid& grid, uint32_t left, uint32_t bottom, uint32_t side) {
    const uint32_t right = std::min(left + side, grid.width()), top = std::min(bottom + side, grid.height());
    std::vector<Piece> pieces;
    for (uint32_t row = run_of(grid.y_breaks, bottom); row < grid.rows() && grid.y_breaks[row] < top; ++row) {
        const uint32_t y0 = std::max(grid.y_breaks[row], bottom), y1 = std::min(grid.y_breaks[row + 1], top);
        for (uint32_t column = run_of(grid.x_breaks, left); column < grid.columns() && grid.x_breaks[column] < right;
             ++column) {
            const uint32_t x0 = std::max(grid.x_breaks[column], left), x1 = std::min(grid.x_breaks[column + 1], right);
            add_rectangle(pieces, {x0, y0, x1, y1}, grid.label(column, row));
        }
    }
    std::ranges::sort(pieces, [](const Piece& a, const Piece& b) {
        return a.area != b.area ? a.area > b.area : a.displacement > b.displacement;
    });
    const uint32_t least = (right - left) * (top - bottom);
    size_t count = 1;
    while (count < std::min<size_t>(pieces.size(), RELIEF_MASK_MOST_SURFACES) &&
           pieces[count].area * kLeastPart >= least)
        ++count;
    pieces.resize(count);
    return pieces;
}

}  // namespace

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

ReliefSurfaces relief_surfaces(const facade::RunGrid& grid) {
    ReliefSurfaces surfaces{relief_mask_shape(grid.width(), grid.height()), {}, {}};
    const uint32_t side = 1u << surfaces.shape.log2_side;
    for (uint32_t y = 0; y < surfaces.shape.up(); ++y) {
        for (uint32_t x = 0; x < surfaces.shape.across(); ++x) {
            const std::vector<Piece> pieces = largest_pieces(grid, x * side, y * side, side);
            surfaces.texels.push_back(static_cast<uint32_t>(surfaces.starts.size()) |
                                      static_cast<uint32_t>(pieces.size()) << RELIEF_MASK_COUNT_SHIFT);
            for (const Piece& piece : pieces) surfaces.starts.push_back(piece.start);
        }
    }
    return surfaces;
}

std::vector<uint32_t> relief_mask_starts(const ReliefSurfaces& surfaces, const FacadeScales& scales) {
    std::vector<uint32_t> words(RELIEF_MASK_TEXELS, 0);
    words[RELIEF_MASK_WORD_MAGIC] = RELIEF_MASK_MAGIC;
    words[RELIEF_MASK_WORD_MAP] = surfaces.shape.width | surfaces.shape.height << 16;
    words[RELIEF_MASK_WORD_SIDE] = surfaces.shape.log2_side;
    words[RELIEF_MASK_WORD_SURFACES] = static_cast<uint32_t>(surfaces.starts.size());
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
    words.insert(words.end(), surfaces.texels.begin(), surfaces.texels.end());
    words.reserve(surfaces.shape.words(surfaces.starts.size()));
    for (const ReliefStart& start : surfaces.starts)
        words.insert(words.end(), {start.x | start.y << 16, 0, start.label});
    return words;
}

void cast_relief_rays(const facade::RunGrid& grid, std::span<uint32_t> words, uint32_t first, uint32_t count) {
    const ReliefMaskShape shape = relief_mask_shape(grid.width(), grid.height());
    const facade::DepthRange depths = grid.depths();
    const auto across = std::bit_cast<float>(words[RELIEF_MASK_WORD_SCALES]),
               up = std::bit_cast<float>(words[RELIEF_MASK_WORD_SCALES + 1]);
    std::array<std::array<double, 3>, RELIEF_DIRECTIONS> along{};
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
        const GridDirection& d = directions().direction(j);
        along[j] = {d[0] * double{across}, d[1] * double{up}, d[2] * kMillimetresPerMetre};
    }
    for (uint32_t surface = first; surface < first + count; ++surface) {
        uint32_t* const to = &words[shape.words(surface)];
        const uint32_t x = to[0] & 0xffff, y = to[0] >> 16, label = to[2];
        const double origin[3] = {x + 0.5, y + 0.5, displacement_of(label) + kAboveSurface};
        uint64_t bits = ~uint64_t{0};
        if (displacement_of(label) != facade::kOpenDisplacement) {
            for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
                if (facade::cast_facade_ray(grid, depths, origin, along[j].data()).hit) bits &= ~(uint64_t{1} << j);
            }
        }
        to[0] = static_cast<uint32_t>(bits);
        to[1] = static_cast<uint32_t>(bits >> 32);
    }
}

std::vector<uint32_t> make_relief_mask(const facade::RunGrid& grid, const FacadeScales& scales) {
    const ReliefSurfaces surfaces = relief_surfaces(grid);
    std::vector<uint32_t> words = relief_mask_starts(surfaces, scales);
    cast_relief_rays(grid, words, 0, static_cast<uint32_t>(surfaces.starts.size()));
    return words;
}

float ReliefShares::free(uint32_t direction) const {
    float sum = open;
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
    const uint32_t surfaces = words[RELIEF_MASK_WORD_SURFACES];
    if (words.size() != shape.words(surfaces))
        return Error{"relief mask of " + std::to_string(words.size()) + " words, its map's has " +
                     std::to_string(shape.words(surfaces))};
    for (uint32_t i = 0; i < shape.texels(); ++i) {
        const uint32_t texel = words[RELIEF_MASK_TEXELS + i], count = texel >> RELIEF_MASK_COUNT_SHIFT;
        const uint64_t first = texel & ((1u << RELIEF_MASK_COUNT_SHIFT) - 1);
        if (count < 1 || count > RELIEF_MASK_MOST_SURFACES || first + count > surfaces)
            return Error{"relief mask whose texel has surfaces that are not there",
                         4 * (RELIEF_MASK_TEXELS + uint64_t{i})};
    }
    return ReliefMaskView(words, shape);
}

FacadeScales ReliefMaskView::scales() const {
    return {std::bit_cast<float>(words_[RELIEF_MASK_WORD_SCALES]),
            std::bit_cast<float>(words_[RELIEF_MASK_WORD_SCALES + 1])};
}

uint32_t ReliefMaskView::surfaces(uint32_t x, uint32_t y) const {
    return words_[RELIEF_MASK_TEXELS + y * shape_.across() + x] >> RELIEF_MASK_COUNT_SHIFT;
}

const uint32_t* ReliefMaskView::surface_words(uint32_t x, uint32_t y, uint32_t surface) const {
    const uint32_t texel = words_[RELIEF_MASK_TEXELS + y * shape_.across() + x];
    const uint64_t number = (texel & ((1u << RELIEF_MASK_COUNT_SHIFT) - 1)) + surface;
    return &words_[shape_.words(number)];
}

uint64_t ReliefMaskView::bits(uint32_t x, uint32_t y, uint32_t surface) const {
    const uint32_t* const words = surface_words(x, y, surface);
    return words[0] | uint64_t{words[1]} << 32;
}

uint32_t ReliefMaskView::label(uint32_t x, uint32_t y, uint32_t surface) const {
    return surface_words(x, y, surface)[2];
}

ReliefMaskView::NextSurface ReliefMaskView::next_surface(uint32_t x, uint32_t y, float depth, bool is_front) const {
    NextSurface next;
    for (uint32_t i = 0; i < surfaces(x, y); ++i) {
        const auto here = static_cast<float>(displacement_of(label(x, y, i)));
        const bool is_own = is_front ? here == depth : here < depth;
        const float away = std::abs(here - depth);
        const bool is_better = is_own != next.is_own ? is_own : away < next.away;
        if (i == 0 || is_better) next = {i, is_own, away};
    }
    return next;
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
    std::array<float, 4> depths{};
    float sum = 0, nearest = std::numeric_limits<float>::max(), nearest_share = 0;
    size_t best = 0;
    for (size_t k = 0; k < 4; ++k) {
        const bool right = (k & 1) != 0, above = (k & 2) != 0;
        const auto texel = [](float i, uint32_t count) {
            return static_cast<uint32_t>(std::clamp(i, 0.0F, static_cast<float>(count - 1)));
        };
        const uint32_t x = texel(low[0] + (right ? 1 : 0), shape_.across());
        const uint32_t y = texel(low[1] + (above ? 1 : 0), shape_.up());
        const float share = (right ? part[0] : 1 - part[0]) * (above ? part[1] : 1 - part[1]);
        const auto [surface, is_own, away] = next_surface(x, y, depth, is_front);
        depths[k] = static_cast<float>(displacement_of(this->label(x, y, surface)));
        shares.bits[k] = bits(x, y, surface);
        shares.share[k] = is_own ? share : 0;
        sum += shares.share[k];
        if (away < nearest || (away == nearest && share > nearest_share)) {
            nearest = away;
            nearest_share = share;
            best = k;
        }
    }
    for (size_t k = 0; k < 4; ++k) shares.share[k] = sum > 0 ? shares.share[k] / sum : (k == best ? 1.0F : 0.0F);
    if (is_front) return shares;
    float foot = 0;
    for (size_t k = 0; k < 4; ++k) foot += shares.share[k] * depths[k];
    const auto edge = static_cast<float>(displacement_of(label));
    if (edge > foot) shares.open = std::clamp((at[2] - foot) / (edge - foot), 0.0F, 1.0F);
    for (float& share : shares.share) share *= 1 - shares.open;
    return shares;
}

double relief_irradiance(const ReliefShares& shares, uint32_t face, std::span<const double, RELIEF_DIRECTIONS> light) {
    double sum = 0;
    for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j)
        sum += light[j] * relief_weights()[face][j] / kWeightOne * double{shares.free(j)};
    return sum;
}

}  // namespace citystream::codec::radiance
