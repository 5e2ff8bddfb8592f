#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "codec/facade/facade_layout.h"
#include "codec/radiance/btf.h"

namespace citystream::codec::radiance {

namespace {

using Vector = std::array<float, 3>;

/// 4 / pi.
constexpr float kEighthTurns = 1.2732395447F;
/// Of directions: the squares of longer ones are not finite.
constexpr float kLongest = 1e18F;

float dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

float triple_product(const Vector& a, const Vector& b, const Vector& c) {
    return dot(a, {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]});
}

/// Place of a unit direction with z >= 0 in Shirley and Chiu's square, 0..1.
std::array<float, 2> hemisphere_square(const Vector& d) {
    const float r = std::sqrt(std::max(1 - d[2], 0.0F));
    const bool is_x = std::abs(d[0]) > std::abs(d[1]);
    const float major = is_x ? d[0] : d[1], minor = is_x ? d[1] : d[0];
    if (major == 0) return {0.5F, 0.5F};
    const float along = major < 0 ? -r : r, across = along * std::atan(minor / major) * kEighthTurns;
    return is_x ? std::array{0.5F + 0.5F * along, 0.5F + 0.5F * across}
                : std::array{0.5F + 0.5F * across, 0.5F + 0.5F * along};
}

Vector table_direction(std::span<const uint32_t> table, uint32_t index) {
    Vector d{};
    for (size_t i = 0; i < 3; ++i) d[i] = std::bit_cast<float>(table[size_t{index} * BTF_DIRECTION_WORDS + i]);
    return d;
}

/// A cell of the grid: its corners counter-clockwise from the lower left one, and on which side of each edge's great
/// circle a direction is.
struct SphereCell {
    uint32_t x = 0, y = 0, across = 0;
    std::array<Vector, 4> corner{};
    std::array<float, 4> edge{};

    uint32_t number(uint32_t k) const { return (y + k / 2) * across + x + (k == 1 || k == 2 ? 1 : 0); }

    void look(std::span<const uint32_t> table, const Vector& d) {
        for (uint32_t k = 0; k < 4; ++k) corner[k] = table_direction(table, number(k));
        for (uint32_t k = 0; k < 4; ++k) edge[k] = triple_product(d, corner[k], corner[(k + 1) & 3]);
    }

    /// To the neighbour beyond an edge, where there is one.
    bool step() {
        const bool lower = edge[0] < 0 && y > 0, upper = edge[2] < 0 && y + 2 < across;
        const bool right = edge[1] < 0 && x + 2 < across, left = edge[3] < 0 && x > 0;
        if (lower || upper)
            y = lower ? y - 1 : y + 1;
        else if (left || right)
            x = left ? x - 1 : x + 1;
        return lower || upper || left || right;
    }
};

/// A unit vector, not below the grid's lowest ring: what is lower is taken at the ring.
Vector above_ring(const Vector& direction, uint32_t across) {
    const Vector d = {direction[0], direction[1], std::max(direction[2], 0.0F)};
    const float size = std::sqrt(dot(d, d));
    if (!(size > 0 && size < kLongest)) return {0, 0, 1};
    const float ring = 1 - 1 / static_cast<float>(across), lowest = 1 - ring * ring, z = d[2] / size;
    if (z >= lowest) return {d[0] / size, d[1] / size, z};
    const float stretch = std::sqrt((1 - lowest * lowest) / (d[0] * d[0] + d[1] * d[1]));
    return {d[0] * stretch, d[1] * stretch, lowest};
}

}  // namespace

SphereShares sphere_shares(std::span<const uint32_t> table, uint32_t across, const Vector& direction) {
    const Vector d = above_ring(direction, across);
    const std::array<float, 2> square = hemisphere_square(d);
    const auto cell_of = [&](float at) {
        const float in_grid = at * static_cast<float>(across) - 0.5F;
        return static_cast<uint32_t>(std::clamp(std::floor(in_grid), 0.0F, static_cast<float>(across - 2)));
    };
    SphereCell cell{cell_of(square[0]), cell_of(square[1]), across, {}, {}};
    // Cells end at great circles between their corners, which is not quite where those of the square do.
    constexpr uint32_t kMostTries = 4;
    for (uint32_t tries = 0; tries < kMostTries; ++tries) {
        cell.look(table, d);
        if (tries + 1 == kMostTries || !cell.step()) break;
    }
    SphereShares shares;
    float sum = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const float whole = triple_product(cell.corner[(k + 3) & 3], cell.corner[k], cell.corner[(k + 1) & 3]);
        shares.cell[k] = cell.number(k);
        shares.share[k] = whole * std::max(cell.edge[(k + 1) & 3], 0.0F) * std::max(cell.edge[(k + 2) & 3], 0.0F);
        sum += shares.share[k];
    }
    for (uint32_t k = 0; k < 4; ++k) shares.share[k] = sum > 0 ? shares.share[k] / sum : (k == 0 ? 1.0F : 0.0F);
    return shares;
}

Result<BtfView> BtfView::create(std::span<const uint32_t> words) {
    if (words.size() < BTF_VIEW_TABLE)
        return Error{"BTF of " + std::to_string(words.size()) + " words, fewer than its head has", 0};
    if (words[BTF_WORD_MAGIC] != BTF_MAGIC) return Error{"not a BTF: wrong magic", 0};
    const uint32_t form = words[BTF_WORD_SHAPE];
    const BtfShape shape{form & 255, form >> 8 & 255, form >> 16 != 0};
    if (shape.patch_log2 < BTF_LEAST_PATCH_LOG2 || shape.patch_log2 > BTF_MOST_PATCH_LOG2 ||
        shape.views_across < BTF_LEAST_VIEWS_ACROSS || shape.views_across > BTF_MOST_VIEWS_ACROSS || form >> 16 > 1)
        return Error{"BTF whose shape is out of range", 4 * BTF_WORD_SHAPE};
    if (words.size() != shape.words())
        return Error{"BTF of " + std::to_string(words.size()) + " words, its shape has " +
                     std::to_string(shape.words())};
    if (words[BTF_WORD_RECORDS] != shape.records_word() || words[BTF_WORD_COVERAGE] != shape.coverage_word())
        return Error{"BTF whose parts do not follow each other", 4 * BTF_WORD_RECORDS};
    for (uint32_t i = 0; i < BTF_DIRECTIONS + shape.views(); ++i) {
        const Vector d = table_direction(words.subspan(BTF_DIRECTION_TABLE), i);
        if (!(std::abs(dot(d, d) - 1) < 1e-3F) || d[2] < 0)
            return Error{"BTF whose direction is not a unit vector",
                         4 * (BTF_DIRECTION_TABLE + uint64_t{i} * BTF_DIRECTION_WORDS)};
    }
    return BtfView(words, shape);
}

uint32_t BtfView::byte(uint32_t view, uint32_t texel, uint32_t direction) const {
    return words_[shape_.record_word(view, texel) + direction / 4] >> 8 * (direction % 4) & 255;
}

uint32_t BtfView::slot_byte(uint32_t view, uint32_t texel, uint32_t slot) const {
    return words_[shape_.record_word(view, texel) + BTF_RECORD_SLOTS + slot / 4] >> 8 * (slot % 4) & 255;
}

float BtfView::coverage(uint32_t view, uint32_t texel) const {
    if (!shape_.has_coverage) return 1;
    const uint64_t at = uint64_t{view} * shape_.texels_per_view() + texel;
    return static_cast<float>(words_[shape_.coverage_word() + at / 4] >> 8 * (at % 4) & 255) / 255;
}

BtfPlace BtfView::place(const std::array<float, 2>& at, const Vector& to_viewer, uint32_t mip) const {
    const SphereShares views = sphere_shares(words_.subspan(BTF_VIEW_TABLE), shape_.views_across, to_viewer);
    mip = std::min(mip, shape_.patch_log2);
    const uint32_t side = shape_.patch() >> mip;
    std::array<uint32_t, 2> low{};
    std::array<float, 2> part{};
    for (size_t i = 0; i < 2; ++i) {
        // In this order a place that is no number is one of the patch, too.
        const float in_grid =
            std::max(0.0F, std::min(static_cast<float>(side - 1), at[i] * static_cast<float>(side) - 0.5F));
        low[i] = static_cast<uint32_t>(in_grid);
        part[i] = in_grid - static_cast<float>(low[i]);
    }
    BtfPlace place;
    for (uint32_t k = 0; k < 4; ++k) {
        const bool right = (k & 1) != 0, above = (k & 2) != 0;
        const uint32_t x = std::min(low[0] + (right ? 1 : 0), side - 1),
                       y = std::min(low[1] + (above ? 1 : 0), side - 1);
        const float share = (right ? part[0] : 1 - part[0]) * (above ? part[1] : 1 - part[1]);
        for (uint32_t v = 0; v < 4; ++v) {
            place.view[4 * k + v] = views.cell[v];
            place.texel[4 * k + v] = shape_.first_texel(mip) + y * side + x;
            place.share[4 * k + v] = share * views.share[v];
        }
    }
    return place;
}

float BtfView::value(const BtfPlace& place, uint32_t direction) const {
    float sum = 0;
    for (size_t r = 0; r < place.share.size(); ++r)
        sum += place.share[r] * static_cast<float>(byte(place.view[r], place.texel[r], direction));
    return sum / 255;
}

std::array<float, BTF_SLOTS> BtfView::slot_shares(const BtfPlace& place) const {
    std::array<float, BTF_SLOTS> shares{};
    float sum = 0;
    for (uint32_t slot = 0; slot < BTF_SLOTS; ++slot) {
        for (size_t r = 0; r < place.share.size(); ++r)
            shares[slot] += place.share[r] * static_cast<float>(slot_byte(place.view[r], place.texel[r], slot));
        sum += shares[slot];
    }
    for (float& share : shares) share = sum > 0 ? share / sum : 0;
    return shares;
}

float BtfView::coverage(const BtfPlace& place) const {
    if (!shape_.has_coverage) return 1;
    float sum = 0;
    for (size_t r = 0; r < place.share.size(); ++r) sum += place.share[r] * coverage(place.view[r], place.texel[r]);
    return sum;
}

float BtfView::sun_cosine(const BtfPlace& place, const Vector& to_sun) const {
    if (to_sun[2] <= 0) return 0;
    const auto table = words_.subspan(BTF_DIRECTION_TABLE);
    const SphereShares lights = sphere_shares(table, BTF_DIRECTIONS_ACROSS, to_sun);
    float shown = 0, plain = 0;
    for (size_t k = 0; k < 4; ++k) {
        const uint32_t cosine = table[lights.cell[k] * BTF_DIRECTION_WORDS + 3] & 0xffff;
        shown += lights.share[k] * value(place, lights.cell[k]);
        plain += lights.share[k] * static_cast<float>(cosine) / 65536;
    }
    return to_sun[2] * shown / plain;
}

float BtfView::openness(const BtfPlace& place) const {
    float shown = 0, plain = 0;
    for (uint32_t j = 0; j < BTF_DIRECTIONS; ++j) {
        const uint32_t word = words_[BTF_DIRECTION_TABLE + j * BTF_DIRECTION_WORDS + 3];
        const auto share = static_cast<float>(word >> 16);
        shown += share * value(place, j);
        plain += share * static_cast<float>(word & 0xffff) / 65536;
    }
    return shown / plain;
}

double shade_btf(const BtfView& btf, const BtfPlace& place, std::span<const double, BTF_DIRECTIONS> light,
                 std::span<const double, BTF_SLOTS> albedo) {
    double sum = 0, mean_albedo = 0;
    for (uint32_t j = 0; j < BTF_DIRECTIONS; ++j) sum += light[j] * double{btf.value(place, j)};
    const auto shares = btf.slot_shares(place);
    for (uint32_t slot = 0; slot < BTF_SLOTS; ++slot) mean_albedo += double{shares[slot]} * albedo[slot];
    return sum * mean_albedo;
}

}  // namespace citystream::codec::radiance
