#include "codec/facade/patch_wire.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <numeric>
#include <utility>

#include "codec/facade/patch_structure.h"
#include "codec/facade/patch_wire_model.h"

namespace citystream::codec::facade {

namespace {

using bits::unzigzag;
using bits::zigzag;
using C = PatchContexts;

/// Pools as the contexts number them.
enum Pool : uint32_t { kLists, kPatches, kBreaks, kGrids, kPalettes, kLabels, kPools };

constexpr uint32_t kNone = ~0u;
constexpr uint32_t kMostSkipped = 31;  ///< known cuts between two positions
constexpr uint32_t kRecent = 63;       ///< things of a pool that are told by how long ago they were used

/// Cuts of an axis that are known from what came before.
class KnownCuts {
  public:
    explicit KnownCuts(uint32_t size) : words_((size + 64) / 64, 0) {}
    void add(uint32_t at) { words_[at / 64] |= uint64_t{1} << at % 64; }
    bool has(uint32_t at) const { return (words_[at / 64] >> at % 64 & 1) != 0; }
    void clear() { std::fill(words_.begin(), words_.end(), 0); }
    /// Least cut > `at`, kNone when there is none.
    uint32_t after(uint32_t at) const {
        uint64_t rest = words_[at / 64] & ~uint64_t{1} << at % 64;
        for (size_t word = at / 64;;) {
            if (rest != 0) return static_cast<uint32_t>(64 * word) + static_cast<uint32_t>(std::countr_zero(rest));
            if (++word == words_.size()) return kNone;
            rest = words_[word];
        }
    }

  private:
    std::vector<uint64_t> words_;
};

/// One pool's things by how long ago they were used, and how many there are.
class Recency {
  public:
    uint32_t known() const { return known_; }
    const std::vector<uint32_t>& recent() const { return recent_; }
    void use(uint32_t index) {
        known_ = std::max(known_, index + 1);
        const auto place = std::find(recent_.begin(), recent_.end(), index);
        if (place != recent_.end()) recent_.erase(place);
        recent_.insert(recent_.begin(), index);
        if (recent_.size() > kRecent) recent_.pop_back();
    }

  private:
    uint32_t known_ = 0;
    std::vector<uint32_t> recent_;
};

/// Both directions in one: an encoder reads the structure, a decoder fills it.
template <typename Coder>
class PatchCoder {
  public:
    static constexpr bool kDecodes = Coder::kDecodes;

    PatchCoder(Coder& coder, PatchStructure& map, size_t budget_bytes)
        : coder_(coder), map_(map), budget_(budget_bytes), models_(patch_wire_models()) {}

    /// False when a decoder finds what no encoder writes.
    bool code() {
        map_.transposed = flag(C::kTransposed, map_.transposed);
        map_.length = number(C::kSize, map_.length - 1) + 1;
        map_.breadth = number(C::kSize, map_.breadth - 1) + 1;
        if (map_.length > kMaxFacadeSide || map_.breadth > kMaxFacadeSide) return false;
        depth_unit_ = number(C::kDepthUnit, kDecodes ? 0 : common_depth_unit() - 1) + 1;
        cuts_ = KnownCuts(map_.length);
        row_cuts_ = KnownCuts(map_.breadth);
        if (!code_bands()) return false;
        for (size_t b = 0; b < map_.bands.size(); ++b) {
            if (!code_band(b) || failed_) return false;
        }
        map_.depths = depth_range(map_.labels);
        return !failed_;
    }

  private:
    using Stripes = std::vector<PatchStripe>;

    // --- decisions
    bool flag(uint32_t context, bool value) { return coder_.bit(models_[context], static_cast<uint32_t>(value)) != 0; }

    uint32_t number(uint32_t kind, uint32_t value) {
        const uint32_t base = kind * kNumberContexts;
        const uint64_t coded = uint64_t{value} + 1;
        uint32_t length = 1;
        while (length < kNumberLengths && flag(base + length - 1, coded >> length != 0)) ++length;
        const uint32_t mantissa = base + kNumberLengths + (length - 1) * kNumberMantissa;
        uint32_t result = 1, rest = length - 1;
        for (uint32_t node = 1; rest > 0 && node <= kNumberMantissa;) {
            --rest;
            const uint32_t bit = coder_.bit(models_[mantissa + node - 1], static_cast<uint32_t>(coded >> rest & 1));
            result = 2 * result + bit;
            node = 2 * node + bit;
        }
        result = result << rest | coder_.plain_bits(rest, static_cast<uint32_t>(coded));
        return result - 1;
    }

    bool fail() {
        failed_ = true;
        return false;
    }

    /// What a decoded structure takes of the resident bytes.
    bool spend(size_t bytes) {
        if (!kDecodes) return true;
        if (bytes > budget_) return fail();
        budget_ -= bytes;
        return true;
    }

    /// A thing of a pool: one of the candidates, the next new one, or one by how long ago it was used. kNone: wrong.
    uint32_t refer(Pool pool, uint32_t index, std::array<uint32_t, 4> candidates, uint32_t new_context) {
        Recency& used = recency_[pool];
        uint32_t misses = 0;
        for (size_t i = 0; i < candidates.size(); ++i) {
            const uint32_t candidate = candidates[i];
            const bool is_again = std::find(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(i),
                                            candidate) != candidates.begin() + static_cast<std::ptrdiff_t>(i);
            if (candidate >= used.known() || is_again) continue;
            const auto context = static_cast<uint32_t>(C::kCandidate + pool * 8 + 2 * i + (misses > 0 ? 1 : 0));
            if (flag(context, index == candidate)) {
                used.use(candidate);
                return candidate;
            }
            ++misses;
        }
        const uint32_t known = used.known();
        uint32_t result = known;
        if (known > 0 && !flag(C::kIsNew + pool * 4 + std::min(new_context, 3u), index == known)) {
            const std::vector<uint32_t>& recent = used.recent();
            const auto place = std::find(recent.begin(), recent.end(), index);
            const uint32_t rank =
                number(C::kRank + static_cast<uint32_t>(pool), static_cast<uint32_t>(place - recent.begin()));
            if (rank < recent.size()) {
                result = recent[rank];
            } else {
                result = coder_.plain_bits(static_cast<uint32_t>(std::bit_width(known)), index);
                if (result >= known) {
                    fail();
                    return kNone;
                }
            }
        }
        used.use(result);
        return result;
    }

    /// A position > `before` and < `end`. kNone: wrong.
    uint32_t position(uint32_t kind, uint32_t numbers, const KnownCuts& cuts, uint32_t value, uint32_t before,
                      uint32_t end) {
        uint32_t next = cuts.after(before);
        if (next < end) {
            uint32_t skipped = 0;
            bool is_known = false;
            if (!kDecodes) {
                for (uint32_t at = next; at < value && skipped <= kMostSkipped; at = cuts.after(at)) ++skipped;
                is_known = skipped <= kMostSkipped && cuts.has(value);
            }
            uint32_t& last_known = last_known_[kind];
            last_known = flag(C::kKnown + 2 * kind + last_known, is_known) ? 1 : 0;
            if (last_known != 0) {
                skipped = number(numbers, skipped);
                if (skipped > kMostSkipped) fail();
                for (uint32_t i = 0; i < skipped && next < end; ++i) next = cuts.after(next);
                if (next < end) return next;
                fail();
                return kNone;
            }
        }
        const uint64_t at = uint64_t{before} + 1 + number(numbers + 1, value - before - 1);
        if (at < end) return static_cast<uint32_t>(at);
        fail();
        return kNone;
    }

    // --- structure
    uint32_t common_depth_unit() const {
        uint32_t unit = 0;
        for (const uint32_t label : map_.labels) {
            const int32_t depth = displacement_of(label);
            if (depth != kOpenDisplacement) unit = std::gcd(unit, static_cast<uint32_t>(std::abs(depth)));
        }
        return std::max(unit, 1u);
    }

    bool code_bands() {
        const uint32_t count = number(C::kStripeCount, static_cast<uint32_t>(map_.bands.size()) - 1) + 1;
        if (count > map_.breadth || !spend(size_t{count} * 4)) return fail();
        map_.bands.resize(count);
        for (uint32_t b = 1; b < count; ++b) {
            const uint32_t before = map_.bands[b - 1].y0;
            map_.bands[b].y0 = before + 1 + number(C::kBandGap, map_.bands[b].y0 - before - 1);
            if (map_.bands[b].y0 >= map_.breadth) return fail();
        }
        return true;
    }

    bool code_band(size_t b) {
        PatchBand& band = map_.bands[b];
        band_height_ = (b + 1 < map_.bands.size() ? map_.bands[b + 1].y0 : map_.breadth) - band.y0;
        const uint32_t below = b > 0 ? map_.bands[b - 1].list : kNone;
        const uint32_t before = b > 1 ? map_.bands[b - 2].list : kNone;
        const uint32_t known = recency_[kLists].known();
        band.list = refer(kLists, band.list, {before, below, kNone, kNone}, 0);
        if constexpr (kDecodes) {
            if (!coder_.ok()) return fail();
        }
        if (failed_) return false;
        if (band.list < known) return true;
        if (kDecodes) map_.lists.emplace_back();
        return code_list(map_.lists[band.list], below == kNone ? nullptr : &map_.lists[below]);
    }

    bool code_list(Stripes& list, const Stripes* below) {
        const uint32_t count = number(C::kStripeCount, static_cast<uint32_t>(list.size()) - 1) + 1;
        if (count > map_.length || !spend(size_t{count} * 4)) return fail();
        list.resize(count);
        for (uint32_t i = 1; i < count; ++i) {
            list[i].x0 = position(0, C::kStripeSkip, cuts_, list[i].x0, list[i - 1].x0, map_.length);
            if (failed_) return false;
        }
        for (uint32_t i = 1; i < count; ++i) cuts_.add(list[i].x0);
        row_cuts_.clear();
        size_t under = 0;
        for (uint32_t i = 0; i < count; ++i) {
            while (below != nullptr && under + 1 < below->size() && (*below)[under + 1].x0 <= list[i].x0) ++under;
            stripe_width_ = (i + 1 < count ? list[i + 1].x0 : map_.length) - list[i].x0;
            const PatchStripe* neighbours[3] = {i > 0 ? &list[i - 1] : nullptr, i > 1 ? &list[i - 2] : nullptr,
                                                below != nullptr ? &(*below)[under] : nullptr};
            if (!code_stripe(list[i], neighbours)) return false;
        }
        return true;
    }

    static uint32_t type_of(const PatchStripe* stripe) { return stripe == nullptr ? 0 : stripe->is_patch ? 2 : 1; }
    static uint32_t content_of(const PatchStripe* stripe, bool is_patch) {
        return stripe != nullptr && stripe->is_patch == is_patch ? stripe->content : kNone;
    }

    /// `neighbours`: the stripe before, the one before that, and the one below.
    bool code_stripe(PatchStripe& stripe, const PatchStripe* const neighbours[3]) {
        const uint32_t types = 3 * type_of(neighbours[0]) + type_of(neighbours[2]);
        stripe.is_patch = flag(C::kIsPatch + types, stripe.is_patch);
        const uint32_t before = content_of(neighbours[0], stripe.is_patch);
        const uint32_t beside = content_of(neighbours[1], stripe.is_patch);
        const uint32_t below = content_of(neighbours[2], stripe.is_patch);
        if (!stripe.is_patch) {
            stripe.content = code_label(stripe.content, {beside, below, last_wall_, kNone}, 0);
            last_wall_ = stripe.content;
            return !failed_;
        }
        const uint32_t known = recency_[kPatches].known();
        stripe.content = refer(kPatches, stripe.content, {beside, below, before, kNone}, below == kNone ? 0 : 1);
        if (failed_) return false;
        if (stripe.content == known) {
            if (kDecodes) map_.patches.emplace_back();
            if (!spend(4) || !code_patch(map_.patches[known], stripe.x0)) return false;
        }
        const PatchRecord& patch = map_.patches[stripe.content];
        for (const uint32_t at : map_.break_lists[patch.columns]) {
            if (at < stripe_width_) cuts_.add(stripe.x0 + at);
        }
        for (const uint32_t at : map_.break_lists[patch.rows]) {
            if (at < band_height_) row_cuts_.add(at);
        }
        last_patch_ = stripe.content;
        return true;
    }

    uint32_t code_label(uint32_t index, const std::array<uint32_t, 4>& candidates, uint32_t new_context) {
        const uint32_t known = recency_[kLabels].known();
        const uint32_t result = refer(kLabels, index, candidates, new_context);
        if (failed_ || result < known) return result;
        if (kDecodes) map_.labels.push_back(0);
        // Different labels take a bit each at least.
        if (spend(known % 8 == 0 ? 1 : 0)) code_new_label(map_.labels[known]);
        return result;
    }

    void code_new_label(uint32_t& label) {
        const bool again = flag(C::kSameMaterial, material_of(label) == last_material_);
        const uint32_t material = again ? last_material_ : number(C::kMaterial, material_of(label));
        const bool is_open = flag(C::kSameMaterial + 1, displacement_of(label) == kOpenDisplacement);
        last_material_ = material;
        if (material > 0xffffu) {
            fail();
            return;
        }
        const int32_t unit = static_cast<int32_t>(depth_unit_);
        int32_t depth = kOpenDisplacement;
        if (!is_open) {
            const int32_t steps = unzigzag(number(C::kDepth, zigzag(displacement_of(label) / unit - last_depth_)));
            const int64_t decoded = (int64_t{last_depth_} + steps) * unit;
            if (decoded <= kOpenDisplacement || decoded > 32767) {
                fail();
                return;
            }
            last_depth_ += steps;
            depth = static_cast<int32_t>(decoded);
        }
        if (kDecodes) label = make_label(depth, material);
    }

    bool code_patch(PatchRecord& patch, uint32_t x0) {
        const PatchRecord* last = last_patch_ == kNone ? nullptr : &map_.patches[last_patch_];
        const std::array<uint32_t, 4> none = {kNone, kNone, kNone, kNone};
        const auto like = [&](uint32_t index) { return std::array<uint32_t, 4>{index, kNone, kNone, kNone}; };
        uint32_t known = recency_[kBreaks].known();
        patch.rows = refer(kBreaks, patch.rows, last ? like(last->rows) : none, 0);
        if (failed_ || (patch.rows == known && !code_rows(patch.rows))) return false;
        known = recency_[kBreaks].known();
        patch.columns = refer(kBreaks, patch.columns, last ? like(last->columns) : none, 1);
        if (failed_ || (patch.columns == known && !code_columns(patch.columns, x0))) return false;
        known = recency_[kGrids].known();
        const size_t rows = map_.break_lists[patch.rows].size() + 1;
        const size_t columns = map_.break_lists[patch.columns].size() + 1;
        patch.grid = refer(kGrids, patch.grid, last ? like(last->grid) : none, 0);
        if (failed_ || (patch.grid == known && !code_grid(patch.grid, rows, columns))) return false;
        const PatchGrid& grid = map_.grids[patch.grid];
        if (grid.columns != columns || grid.cells.size() != rows * columns) return fail();
        known = recency_[kPalettes].known();
        patch.palette = refer(kPalettes, patch.palette, last ? like(last->palette) : none, 0);
        if (failed_ || (patch.palette == known && !code_palette(patch.palette, grid, last))) return false;
        return map_.palettes[patch.palette].size() == label_count(grid) || fail();
    }

    /// Makes room for a list that a decoder is about to read. False when it cannot be one.
    bool begin_breaks(uint32_t index, uint32_t count, uint32_t extent) {
        if (count > PATCH_MOST_BREAKS || count >= extent || !spend(1 + count * PATCH_LEAST_BREAK_BITS / 8))
            return fail();
        if (kDecodes) map_.break_lists.emplace_back(count);
        return index < map_.break_lists.size() || fail();
    }

    bool code_rows(uint32_t index) {
        const uint32_t given = kDecodes ? 0 : static_cast<uint32_t>(map_.break_lists[index].size());
        const uint32_t count = number(C::kRowCount, given);
        if (!begin_breaks(index, count, band_height_)) return false;
        PatchBreaks& breaks = map_.break_lists[index];
        uint32_t before = 0;
        for (uint16_t& at : breaks) {
            before = position(2, C::kRowSkip, row_cuts_, at, before, band_height_);
            if (failed_) return false;
            at = static_cast<uint16_t>(before);
        }
        return fits_break_list(breaks) || fail();
    }

    /// The right half of a window mostly mirrors the left.
    bool code_columns(uint32_t index, uint32_t x0) {
        const uint32_t given = kDecodes ? 0 : static_cast<uint32_t>(map_.break_lists[index].size());
        const uint32_t count = number(C::kColumnCount, given);
        if (!begin_breaks(index, count, stripe_width_)) return false;
        PatchBreaks& breaks = map_.break_lists[index];
        uint32_t before = 0, last_mirrored = 0;
        for (size_t i = 0; i < breaks.size(); ++i) {
            const uint32_t mirrored = stripe_width_ - breaks[breaks.size() - 1 - i];
            if (2 * i >= breaks.size() && mirrored > before && mirrored < stripe_width_) {
                last_mirrored = flag(C::kMirrored + last_mirrored, breaks[i] == mirrored) ? 1 : 0;
                if (last_mirrored != 0) {
                    breaks[i] = static_cast<uint16_t>(mirrored);
                    before = mirrored;
                    continue;
                }
            }
            const uint32_t at = position(1, C::kColumnSkip, cuts_, x0 + breaks[i], x0 + before, x0 + stripe_width_);
            if (failed_) return false;
            before = at - x0;
            breaks[i] = static_cast<uint16_t>(before);
        }
        return fits_break_list(breaks) || fail();
    }

    static uint32_t label_count(const PatchGrid& grid) {
        return 1u + *std::max_element(grid.cells.begin(), grid.cells.end());
    }

    bool code_grid(uint32_t index, size_t rows, size_t columns) {
        if (rows * columns < 2 || !spend((rows * columns + 7) / 8)) return fail();
        if (kDecodes) {
            map_.grids.emplace_back();
            map_.grids[index].columns = static_cast<uint32_t>(columns);
            map_.grids[index].cells.resize(rows * columns);
        }
        PatchGrid& grid = map_.grids[index];
        uint32_t seen = 0, mirror_misses = 0;
        for (size_t r = 0; r < rows; ++r) {
            for (size_t c = 0; c < columns; ++c) {
                uint16_t& cell = grid.cells[r * columns + c];
                if (seen > 0) cell = static_cast<uint16_t>(code_cell(grid, columns, r, c, seen, mirror_misses));
                if (cell > seen || failed_) return fail();
                seen = std::max<uint32_t>(seen, cell + 1u);
            }
        }
        if (seen < 2 || seen > 1u << PATCH_MOST_CELL_BITS) return fail();
        if (kDecodes) grid.cell_bits = static_cast<uint32_t>(std::bit_width(seen - 1));
        return true;
    }

    /// Candidates: the mirrored cell, below, left, two to the left, two below; then any label seen, or the next one.
    uint32_t code_cell(const PatchGrid& grid, size_t columns, size_t r, size_t c, uint32_t seen,
                       uint32_t& mirror_misses) {
        const uint32_t cell = grid.cells[r * columns + c];
        const auto at = [&](size_t row, size_t column) { return uint32_t{grid.cells[row * columns + column]}; };
        const uint32_t candidates[5] = {2 * c >= columns ? at(r, columns - 1 - c) : kNone, r > 0 ? at(r - 1, c) : kNone,
                                        c > 0 ? at(r, c - 1) : kNone, c > 1 ? at(r, c - 2) : kNone,
                                        r > 1 ? at(r - 2, c) : kNone};
        const uint32_t diagonal = r > 0 && c > 0 ? at(r - 1, c - 1) : kNone;
        const uint32_t agree = (candidates[1] == candidates[2] ? 1u : 0u) | (candidates[1] == diagonal ? 2u : 0u) |
                               (candidates[2] == diagonal ? 4u : 0u);
        const uint32_t state = std::min(mirror_misses, 3u);
        for (uint32_t i = 0; i < 5; ++i) {
            const bool is_again = std::find(candidates, candidates + i, candidates[i]) != candidates + i;
            if (candidates[i] == kNone || is_again) continue;
            const bool has_mirror = candidates[0] != kNone;
            const uint32_t context = C::kCell + 32 * i + 4 * agree + (i == 0 || has_mirror ? state : 0u);
            const bool hit = flag(context, cell == candidates[i]);
            if (i == 0 && !hit && mirror_misses < 3) ++mirror_misses;
            if (hit) return candidates[i];
        }
        if (flag(C::kCellIsNew + std::min(seen, 15u), cell == seen)) return seen;
        const uint32_t rank = number(C::kCellRank, seen - 1 - cell);
        if (rank >= seen) fail();
        return seen - 1 - std::min(rank, seen - 1);
    }

    bool code_palette(uint32_t index, const PatchGrid& grid, const PatchRecord* last) {
        const uint32_t count = label_count(grid);
        if (!spend((count + 7) / 8)) return false;
        if (kDecodes) map_.palettes.emplace_back(count);
        PatchPalette& palette = map_.palettes[index];
        const PatchPalette* like = last ? &map_.palettes[last->palette] : nullptr;
        uint32_t before = kNone;
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t same = like != nullptr && i < like->size() ? (*like)[i] : kNone;
            const uint32_t label =
                code_label(palette[i], {same, before + 1, i == 0 ? last_wall_ : kNone, kNone}, same == kNone ? 2 : 1);
            if (failed_) return false;
            const auto end = palette.begin() + static_cast<std::ptrdiff_t>(i);
            if (std::find(palette.begin(), end, label) != end) return fail();
            palette[i] = before = label;
        }
        return true;
    }

    Coder& coder_;
    PatchStructure& map_;
    size_t budget_;
    bool failed_ = false;
    std::vector<bits::BitModel> models_;
    std::array<Recency, kPools> recency_;
    std::array<uint32_t, 3> last_known_ = {1, 1, 1};
    KnownCuts cuts_{1}, row_cuts_{1};
    uint32_t band_height_ = 1, stripe_width_ = 1;
    uint32_t last_patch_ = kNone, last_wall_ = kNone;
    uint32_t last_material_ = 0, depth_unit_ = 1;
    int32_t last_depth_ = 0;
};

}  // namespace

void put_patch_wire(std::span<const uint32_t> words, bits::RangeEncoder& encoder) {
    auto structure = read_patch_words(words);
    assert(structure.ok());
    [[maybe_unused]] const bool coded = PatchCoder(encoder, *structure, 0).code();
    assert(coded);
}

Result<std::vector<uint32_t>> get_patch_wire(bits::RangeDecoder& decoder, size_t resident_bytes) {
    PatchStructure structure;
    if (!PatchCoder(decoder, structure, resident_bytes).code())
        return Error{"patch map: wire form does not decode", decoder.position()};
    if (const Status status = check_extents(structure); !status) return status.error();
    return write_patch_words(structure);
}

}  // namespace citystream::codec::facade
