#include "codec/radiance/btf.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <string>

#include "codec/facade/facade_layout.h"
#include "codec/facade/facade_ray.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/series_angle.h"

namespace citystream::codec::radiance {

namespace {

using facade::displacement_of;
using facade::RunGrid;

static_assert(BTF_SLOTS == FACADE_PALETTE_SLOTS);

constexpr double kMillimetresPerMetre = 1000;
constexpr uint32_t kShareOne = 1u << 16;
constexpr uint32_t kFullCoverage = 255;
/// Of sums of a ray's weights, before those of slots are divided in 32 bits. Each ray counts one more, so that what no
/// light reaches has its slot, too.
constexpr uint32_t kLightShift = 4;

std::array<float, 3> unit(const GridDirection& d) {
    const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
    return {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
}

uint32_t slot_of_label(uint32_t label) {
    return std::min<uint32_t>(facade::material_of(label), FACADE_PALETTE_SLOTS - 1);
}

uint32_t byte_of(uint32_t word, uint32_t i) {
    return word >> 8 * (i & 3) & 255;
}

uint32_t run_of(const std::vector<uint32_t>& breaks, uint32_t texel) {
    return static_cast<uint32_t>(std::upper_bound(breaks.begin(), breaks.end(), texel) - breaks.begin()) - 1;
}

/// What a ray of a texel met.
struct Meeting {
    uint32_t slot = 0, face = 0;
    uint64_t bits = 0;
    bool hit = false;
};

/// Fills a view of a BTF's words: the finest mip by rays, then the others.
class Maker {
  public:
    Maker(const RunGrid& grid, const ReliefMaskView& mask, const BtfShape& shape, std::span<uint32_t> words)
        : grid_(grid), depths_(grid.depths()), mask_(mask), shape_(shape), words_(words) {}

    void make(uint32_t view) {
        for (uint32_t texel = 0; texel < shape_.patch() * shape_.patch(); ++texel) make_texel(view, texel);
        for (uint32_t mip = 1; mip < shape_.mips(); ++mip) make_mip(view, mip);
    }

  private:
    void make_texel(uint32_t view, uint32_t texel);
    Meeting cast(uint32_t view, uint32_t texel, uint32_t ray) const;
    void make_mip(uint32_t view, uint32_t mip);
    void make_mip_texel(uint32_t view, uint32_t mip, uint32_t texel);
    uint32_t& record(uint32_t view, uint32_t texel) { return words_[shape_.record_word(view, texel)]; }
    uint32_t coverage(uint32_t view, uint32_t texel) const;
    void set_coverage(uint32_t view, uint32_t texel, uint32_t byte);

    const RunGrid& grid_;
    facade::DepthRange depths_;
    const ReliefMaskView& mask_;
    BtfShape shape_;
    std::span<uint32_t> words_;
};

Meeting Maker::cast(uint32_t view, uint32_t texel, uint32_t ray) const {
    const double side = shape_.patch();
    const double in_x = (ray + 0.5) / BTF_RAYS, in_y = (ray * BTF_RAY_GENERATOR % BTF_RAYS + 0.5) / BTF_RAYS;
    const double u = (texel % shape_.patch() + in_x) / side * grid_.width();
    const double v = (texel / shape_.patch() + in_y) / side * grid_.height();
    std::array<double, 3> to_viewer{};
    for (size_t i = 0; i < 3; ++i)
        to_viewer[i] = std::bit_cast<float>(words_[BTF_VIEW_TABLE + view * BTF_DIRECTION_WORDS + i]);
    const FacadeScales scales = mask_.scales();
    const double direction[3] = {-to_viewer[0] * double{scales[0]}, -to_viewer[1] * double{scales[1]},
                                 -to_viewer[2] * kMillimetresPerMetre};
    const double begin = (std::max(depths_.max_mm, 0) + 1) / direction[2];
    const double origin[3] = {u + begin * direction[0], v + begin * direction[1], begin * direction[2]};
    facade::FacadeRayHit hit = facade::cast_facade_ray(grid_, depths_, origin, direction);
    std::array<double, 3> at{};
    for (size_t i = 0; i < 3; ++i) at[i] = origin[i] + hit.t * direction[i];
    if (!hit.hit) {
        // What comes to the back within the facade went through an open texel.
        const double back = depths_.min_mm / direction[2], x = u + back * direction[0], y = v + back * direction[1];
        if (x >= 0 && y >= 0 && x <= grid_.width() && y <= grid_.height()) return {};
        hit.label = grid_.label(run_of(grid_.x_breaks, std::min(static_cast<uint32_t>(u), grid_.width() - 1)),
                                run_of(grid_.y_breaks, std::min(static_cast<uint32_t>(v), grid_.height() - 1)));
        if (displacement_of(hit.label) == facade::kOpenDisplacement) return {};
        at = {u, v, static_cast<double>(displacement_of(hit.label))};
    }
    const ReliefShares shares =
        mask_.shares({static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])}, hit.label,
                     hit.normal_axis, hit.normal_sign);
    const auto best =
        static_cast<size_t>(std::max_element(shares.share.begin(), shares.share.end()) - shares.share.begin());
    return {slot_of_label(hit.label), relief_face(hit.normal_axis, hit.normal_sign),
            shares.open > shares.share[best] ? ~uint64_t{0} : shares.bits[best], true};
}

void Maker::make_texel(uint32_t view, uint32_t texel) {
    std::array<uint32_t, BTF_DIRECTIONS> light{};
    std::array<uint32_t, BTF_SLOTS> slot_light{};
    uint32_t hits = 0, all_light = 0;
    for (uint32_t ray = 0; ray < BTF_RAYS; ++ray) {
        const Meeting met = cast(view, texel, ray);
        if (!met.hit) continue;
        ++hits;
        uint32_t sum = 0;
        for (uint64_t left = met.bits; left != 0; left &= left - 1) {
            const auto direction = static_cast<uint32_t>(std::countr_zero(left));
            light[direction] += relief_weights()[met.face][direction];
            sum += relief_weights()[met.face][direction];
        }
        slot_light[met.slot] += (sum >> kLightShift) + 1;
        all_light += (sum >> kLightShift) + 1;
    }
    set_coverage(view, texel, (hits * kFullCoverage + BTF_RAYS / 2) / BTF_RAYS);
    if (hits == 0) return;
    uint32_t* const to = &record(view, texel);
    for (uint32_t i = 0; i < BTF_DIRECTIONS; ++i)
        to[i / 4] |= (light[i] * 255 + hits * (kShareOne / 2)) / (hits * kShareOne) << 8 * (i % 4);
    for (uint32_t slot = 0; slot < BTF_SLOTS; ++slot)
        to[BTF_RECORD_SLOTS + slot / 4] |= (slot_light[slot] * 255 + all_light / 2) / all_light << 8 * (slot % 4);
}

void Maker::make_mip(uint32_t view, uint32_t mip) {
    const uint32_t side = shape_.patch() >> mip;
    for (uint32_t texel = 0; texel < side * side; ++texel) make_mip_texel(view, mip, texel);
}

void Maker::make_mip_texel(uint32_t view, uint32_t mip, uint32_t texel) {
    const uint32_t side = shape_.patch() >> mip, x = 2 * (texel % side), y = 2 * (texel / side);
    const uint32_t here = shape_.first_texel(mip) + texel;
    std::array<const uint32_t*, 4> finer{};
    std::array<uint32_t, 4> share{}, light{};
    uint32_t covered = 0, all_light = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const uint32_t number = shape_.first_texel(mip - 1) + (y + k / 2) * 2 * side + x + k % 2;
        finer[k] = &record(view, number);
        share[k] = coverage(view, number);
        covered += share[k];
        light[k] = 1;
        for (uint32_t i = 0; i < BTF_DIRECTIONS; ++i) light[k] += byte_of(finer[k][i / 4], i);
        light[k] *= share[k];
        all_light += light[k];
    }
    set_coverage(view, here, (covered + 2) / 4);
    if (covered == 0) return;
    uint32_t* const to = &record(view, here);
    for (uint32_t i = 0; i < BTF_DIRECTIONS; ++i) {
        uint32_t sum = 0;
        for (uint32_t k = 0; k < 4; ++k) sum += share[k] * byte_of(finer[k][i / 4], i);
        // Rounded up from a half or from three quarters in turns: the mean of many stays as it is.
        to[i / 4] |= (4 * sum + covered * (1 + i % 2)) / (4 * covered) << 8 * (i % 4);
    }
    for (uint32_t slot = 0; slot < BTF_SLOTS; ++slot) {
        uint32_t sum = 0;
        for (uint32_t k = 0; k < 4; ++k) sum += light[k] * byte_of(finer[k][BTF_RECORD_SLOTS + slot / 4], slot);
        to[BTF_RECORD_SLOTS + slot / 4] |= (sum + all_light / 2) / all_light << 8 * (slot % 4);
    }
}

uint32_t Maker::coverage(uint32_t view, uint32_t texel) const {
    if (!shape_.has_coverage) return kFullCoverage;
    const uint64_t at = uint64_t{view} * shape_.texels_per_view() + texel;
    return byte_of(words_[shape_.coverage_word() + at / 4], static_cast<uint32_t>(at));
}

void Maker::set_coverage(uint32_t view, uint32_t texel, uint32_t byte) {
    if (!shape_.has_coverage) return;
    const uint64_t at = uint64_t{view} * shape_.texels_per_view() + texel;
    words_[shape_.coverage_word() + at / 4] |= byte << 8 * (at % 4);
}

}  // namespace

uint32_t BtfShape::first_texel(uint32_t mip) const {
    assert(mip < mips());
    return ((4u << 2 * patch_log2) - (4u << 2 * (patch_log2 - mip))) / 3;
}

uint32_t BtfShape::texels_per_view() const {
    return (((4u << 2 * patch_log2) - 1) / 3 + 3) & ~3u;
}

uint64_t BtfShape::record_word(uint32_t view, uint32_t texel) const {
    return records_word() + (uint64_t{view} * texels_per_view() + texel) * BTF_RECORD_WORDS;
}

uint64_t BtfShape::coverage_word() const {
    return has_coverage ? record_word(views(), 0) : 0;
}

uint64_t BtfShape::words() const {
    return record_word(views(), 0) + (has_coverage ? records() / 4 : 0);
}

uint32_t palette_slots(const RunGrid& grid) {
    uint32_t slots = 0;
    for (const uint32_t label : grid.labels) {
        if (displacement_of(label) != facade::kOpenDisplacement) slots |= 1u << slot_of_label(label);
    }
    return slots;
}

Result<BtfShape> btf_shape(const BtfOptions& options, bool has_open) {
    const bool is_power = std::has_single_bit(options.patch);
    if (!is_power || options.patch < 1u << BTF_LEAST_PATCH_LOG2 || options.patch > 1u << BTF_MOST_PATCH_LOG2)
        return Error{"BTF of " + std::to_string(options.patch) + " texels a patch: 4, 8, 16, 32 or 64"};
    if (options.views_across < BTF_LEAST_VIEWS_ACROSS || options.views_across > BTF_MOST_VIEWS_ACROSS)
        return Error{"BTF of " + std::to_string(options.views_across) + " views across: 4 to 16"};
    return BtfShape{static_cast<uint32_t>(std::countr_zero(options.patch)), options.views_across, has_open};
}

std::vector<uint32_t> btf_head(const BtfShape& shape, uint32_t slots, const FacadeScales& scales) {
    std::vector<uint32_t> words(shape.records_word(), 0);
    words[BTF_WORD_MAGIC] = BTF_MAGIC;
    words[BTF_WORD_SHAPE] = shape.patch_log2 | shape.views_across << 8 | (shape.has_coverage ? 1u << 16 : 0);
    words[BTF_WORD_SLOTS] = slots;
    words[BTF_WORD_RECORDS] = shape.records_word();
    words[BTF_WORD_COVERAGE] = static_cast<uint32_t>(shape.coverage_word());
    for (size_t i = 0; i < 2; ++i) words[BTF_WORD_SCALES + i] = std::bit_cast<uint32_t>(scales[i]);
    const auto write_table = [&](uint32_t table, const LocalDirections& directions) {
        for (uint32_t j = 0; j < directions.count(); ++j) {
            const std::array<float, 3> d = unit(directions.direction(j));
            for (size_t i = 0; i < 3; ++i)
                words[table + size_t{j} * BTF_DIRECTION_WORDS + i] = std::bit_cast<uint32_t>(d[i]);
        }
    };
    const LocalDirections lights(BTF_DIRECTIONS_ACROSS);
    write_table(BTF_DIRECTION_TABLE, lights);
    write_table(BTF_VIEW_TABLE, LocalDirections(shape.views_across));
    const CellAverages averages = cell_averages(lights);
    for (uint32_t j = 0; j < BTF_DIRECTIONS; ++j) {
        const double share = averages.solid_angle[j] / (2 * kPi);
        words[BTF_DIRECTION_TABLE + j * BTF_DIRECTION_WORDS + 3] =
            relief_weights()[RELIEF_FACE_FRONT][j] | static_cast<uint32_t>(std::floor(share * kShareOne + 0.5)) << 16;
    }
    return words;
}

void make_btf_view(const RunGrid& grid, const ReliefMaskView& mask, const BtfShape& shape, uint32_t view,
                   std::span<uint32_t> words) {
    Maker(grid, mask, shape, words).make(view);
}

Result<std::vector<uint32_t>> make_btf(const RunGrid& grid, const ReliefMaskView& mask, const BtfOptions& options) {
    if (mask.shape().width != grid.width() || mask.shape().height != grid.height())
        return Error{"BTF with the relief mask of another map"};
    const auto shape = btf_shape(options, grid.has_open_cells());
    if (!shape) return shape.error();
    std::vector<uint32_t> words = btf_head(*shape, palette_slots(grid), mask.scales());
    words.resize(shape->words(), 0);
    for (uint32_t view = 0; view < shape->views(); ++view) make_btf_view(grid, mask, *shape, view, words);
    return words;
}

}  // namespace citystream::codec::radiance
