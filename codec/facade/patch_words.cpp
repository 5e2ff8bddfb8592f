#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include "codec/bits/bit_stream.h"
#include "codec/facade/facade_form_layout.h"
#include "codec/facade/patch_structure.h"

namespace citystream::codec::facade {

namespace {

using Bytes = std::vector<uint8_t>;

constexpr uint32_t kGroupBytes = 16;
constexpr uint32_t kMostUnitLog2 = 3;
constexpr uint32_t kMostPartBits = 14;     // two offsets and 4 more bits in a word
constexpr uint32_t kLeastBandMaxBits = 3;  // else bands take two words

void append_bits(Bytes& bytes, uint32_t& bit, uint32_t value, uint32_t bits) {
    for (uint32_t i = 0; i < bits; ++i, ++bit) {
        if (bit / 8 == bytes.size()) bytes.push_back(0);
        bytes[bit / 8] = static_cast<uint8_t>(bytes[bit / 8] | (value >> i & 1u) << bit % 8);
    }
}

Bytes break_list_bytes(const PatchBreaks& breaks) {
    const uint32_t width = break_width(breaks.empty() ? 0 : breaks.back());
    Bytes bytes;
    uint32_t bit = 0;
    append_bits(bytes, bit, static_cast<uint32_t>(breaks.size()), 5);
    append_bits(bytes, bit, width - PATCH_LEAST_BREAK_BITS, 3);
    for (const uint16_t at : breaks) append_bits(bytes, bit, at, width);
    return bytes;
}

template <typename Values>
Bytes packed_bytes(const Values& values, uint32_t width) {
    Bytes bytes;
    uint32_t bit = 0;
    for (const uint32_t value : values) append_bits(bytes, bit, value, width);
    return bytes;
}

/// The grid's part, and whether it is folded.
struct GridPart {
    Bytes bytes;
    bool folded = false;
};

GridPart grid_part(const PatchGrid& grid) {
    const FoldedGrid folded = fold_grid(grid);
    if ((folded.bits(grid.cell_bits) + 7) / 8 >= (grid.cells.size() * grid.cell_bits + 7) / 8)
        return {packed_bytes(grid.cells, grid.cell_bits), false};
    Bytes bytes;
    uint32_t bit = 0;
    append_bits(bytes, bit, folded.row_bits | folded.column_bits << 3 | (folded.different_columns - 1) << 6,
                PATCH_FOLD_HEAD_BITS);
    for (const uint32_t row : folded.rows) append_bits(bytes, bit, row, folded.row_bits);
    for (const uint32_t column : folded.columns) append_bits(bytes, bit, column, folded.column_bits);
    for (const uint32_t cell : folded.cells) append_bits(bytes, bit, cell, grid.cell_bits);
    return {bytes, true};
}

/// Where the parts lie: whole units, and in one 16-byte group unless longer. Parts of one patch share groups where they
/// can, so that opening a patch takes few loads.
class PartPlacer {
  public:
    explicit PartPlacer(uint32_t unit_log2) : unit_log2_(unit_log2) {}

    /// Unit offset of the bytes; `near`: groups to try first.
    uint32_t place(const Bytes& bytes, std::vector<uint32_t>& near) {
        const auto [known, is_new] = places_.try_emplace(bytes, 0);
        if (is_new) known->second = bytes.size() > kGroupBytes ? place_long(bytes) : place_short(bytes, near);
        near.push_back(known->second / kGroupBytes);
        return known->second >> unit_log2_;
    }
    const Bytes& bytes() const { return bytes_; }

  private:
    /// Groups with room that are tried for a part, newest first.
    static constexpr size_t kMostTried = 64;

    uint32_t place_long(const Bytes& bytes) {
        const uint32_t at = static_cast<uint32_t>(bytes_.size());
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        close_group(static_cast<uint32_t>(bytes.size() % kGroupBytes));
        return at;
    }

    uint32_t place_short(const Bytes& bytes, const std::vector<uint32_t>& near) {
        const uint32_t size = rounded(static_cast<uint32_t>(bytes.size()));
        const auto fits = [&](uint32_t group) { return used_[group] + size <= kGroupBytes; };
        uint32_t group = static_cast<uint32_t>(used_.size());
        for (const uint32_t candidate : near) {
            if (fits(candidate)) group = std::min(group, candidate);
        }
        // The fullest of the open groups.
        uint32_t fullest = 0;
        for (size_t i = open_.size(); group == used_.size() && i-- > 0 && open_.size() - i <= kMostTried;) {
            if (fits(open_[i]) && used_[open_[i]] > fullest) fullest = used_[open_[i]];
        }
        for (size_t i = open_.size(); group == used_.size() && fullest > 0 && i-- > 0;) {
            if (used_[open_[i]] == fullest && fits(open_[i])) group = open_[i];
        }
        if (group == used_.size()) {
            bytes_.resize(bytes_.size() + kGroupBytes);
            used_.push_back(0);
            open_.push_back(group);
        }
        const uint32_t at = group * kGroupBytes + used_[group];
        std::copy(bytes.begin(), bytes.end(), bytes_.begin() + at);
        used_[group] += size;
        if (used_[group] + rounded(1) > kGroupBytes) std::erase(open_, group);
        return at;
    }

    uint32_t rounded(uint32_t size) const { return ((size - 1) >> unit_log2_ << unit_log2_) + (1u << unit_log2_); }

    /// After a long part: its last group may take short ones.
    void close_group(uint32_t used_in_last) {
        if (used_in_last != 0) bytes_.resize(bytes_.size() + kGroupBytes - used_in_last);
        used_.resize(bytes_.size() / kGroupBytes, kGroupBytes);
        if (used_in_last == 0) return;
        used_.back() = rounded(used_in_last);
        if (used_.back() < kGroupBytes) open_.push_back(static_cast<uint32_t>(used_.size()) - 1);
    }

    uint32_t unit_log2_;
    Bytes bytes_;
    std::vector<uint32_t> used_;  ///< bytes of every group
    std::vector<uint32_t> open_;  ///< groups with room
    std::map<Bytes, uint32_t> places_;
};

/// Parts and patch records with one size of unit.
struct PlacedParts {
    Bytes bytes;
    std::vector<std::array<uint32_t, 4>> offsets;  ///< of each patch: rows, columns, palette, grid
    std::vector<uint8_t> cell_fields;              ///< of each patch: bits of a cell - 1, folded
    uint32_t unit_log2 = 0, part_bits = 0;

    bool wide() const { return part_bits > PATCH_NARROW_PART_BITS; }
    size_t words() const { return bytes.size() / 4 + offsets.size() * (wide() ? 2 : 1); }
};

PlacedParts place_parts(const PatchStructure& structure, const std::vector<GridPart>& grids, uint32_t label_bits,
                        uint32_t unit_log2) {
    PartPlacer placer(unit_log2);
    PlacedParts placed;
    placed.unit_log2 = unit_log2;
    uint32_t last = 0;
    for (const PatchRecord& patch : structure.patches) {
        std::vector<uint32_t> near;
        const GridPart& grid = grids[patch.grid];
        const std::array<uint32_t, 4> offsets = {
            placer.place(break_list_bytes(structure.break_lists[patch.rows]), near),
            placer.place(break_list_bytes(structure.break_lists[patch.columns]), near),
            placer.place(packed_bytes(structure.palettes[patch.palette], label_bits), near),
            placer.place(grid.bytes, near)};
        last = std::max(last, *std::max_element(offsets.begin(), offsets.end()));
        placed.offsets.push_back(offsets);
        const uint32_t cell_bits = structure.grids[patch.grid].cell_bits;
        placed.cell_fields.push_back(static_cast<uint8_t>((cell_bits - 1) | (grid.folded ? 8u : 0u)));
    }
    placed.part_bits = bits::bits_for(last);
    placed.bytes = placer.bytes();
    return placed;
}

/// Greatest displacements as codes: least + code * step, rounded up.
struct MaxCode {
    uint32_t bits = 0;
    int32_t least = 0, step = 0;

    MaxCode(const DepthRange& depths, uint32_t bits_given) : bits(bits_given), least(depths.min_mm) {
        const int32_t codes = (1 << bits) - 1;
        if (bits > 0) step = (depths.max_mm - depths.min_mm + codes - 1) / codes;
    }
    uint32_t code(int32_t greatest) const {
        if (step == 0 || greatest <= least) return 0;
        return static_cast<uint32_t>((greatest - least + step - 1) / step);
    }
};

struct Maxima {
    std::vector<int32_t> of_patches, of_lists;
};

int32_t stripe_max(const PatchStructure& structure, const Maxima& maxima, const PatchStripe& stripe) {
    return stripe.is_patch ? maxima.of_patches[stripe.content] : displacement_of(structure.labels[stripe.content]);
}

Maxima find_maxima(const PatchStructure& structure) {
    Maxima maxima;
    for (const PatchRecord& patch : structure.patches) {
        int32_t greatest = kOpenDisplacement;
        for (const uint32_t label : structure.palettes[patch.palette])
            greatest = std::max(greatest, displacement_of(structure.labels[label]));
        maxima.of_patches.push_back(greatest);
    }
    for (const auto& list : structure.lists) {
        int32_t greatest = kOpenDisplacement;
        for (const PatchStripe& stripe : list) greatest = std::max(greatest, stripe_max(structure, maxima, stripe));
        maxima.of_lists.push_back(greatest);
    }
    return maxima;
}

/// Widths of the fields of bands and stripes.
struct Widths {
    uint32_t x = 0, y = 0;  // not written: they follow from the size
    uint32_t first = 0, count = 0, band_max = 0, content = 0, stripe_max = 0;
    bool wide_bands = false;

    uint32_t word() const {
        return first << PATCH_FIRST_WIDTH_BIT | count << PATCH_COUNT_WIDTH_BIT | band_max << PATCH_BAND_MAX_WIDTH_BIT |
               content << PATCH_CONTENT_WIDTH_BIT | stripe_max << PATCH_STRIPE_MAX_WIDTH_BIT;
    }
};

Result<Widths> choose_widths(const PatchStructure& structure) {
    size_t stripes = 0, longest = 1;
    for (const auto& list : structure.lists) {
        stripes += list.size();
        longest = std::max(longest, list.size());
    }
    Widths widths;
    widths.x = bits::bits_for(structure.length - 1);
    widths.y = bits::bits_for(structure.breadth - 1);
    widths.first = bits::bits_for(stripes - structure.lists.back().size());
    widths.count = bits::bits_for(longest - 1);
    widths.content = bits::bits_for(structure.labels.size() + structure.patches.size() - 1);
    const uint32_t in_band = widths.y + widths.first + widths.count;
    widths.wide_bands = in_band + kLeastBandMaxBits > 32;
    widths.band_max = std::min<uint32_t>(PATCH_MOST_MAX_BITS, widths.wide_bands ? 32 - widths.y : 32 - in_band);
    if (widths.first + widths.count > 32 || widths.x + widths.content > 32)
        return Error{"facade has too many stripes or patches for a patch map"};
    widths.stripe_max = std::min<uint32_t>(PATCH_MOST_MAX_BITS, 32 - widths.x - widths.content);
    return widths;
}

void write_patches(const PlacedParts& placed, std::vector<uint32_t>& words) {
    for (size_t i = 0; i < placed.offsets.size(); ++i) {
        const auto& [rows, columns, palette, grid] = placed.offsets[i];
        const uint32_t bits = placed.part_bits;
        const uint32_t cell_bits = uint32_t{placed.cell_fields[i]} << PATCH_CELL_BITS_BIT;
        const uint32_t lists = rows | columns << bits;
        const uint32_t cells = palette | grid << bits;
        if (placed.wide()) {
            words.push_back(lists);
            words.push_back(cells | cell_bits);
        } else {
            words.push_back(lists | cells << 2 * bits | cell_bits);
        }
    }
}

void write_bands(const PatchStructure& structure, const Widths& widths, const Maxima& maxima,
                 std::vector<uint32_t>& words) {
    std::vector<uint32_t> first_of_list;
    uint32_t stripes = 0;
    for (const auto& list : structure.lists) {
        first_of_list.push_back(stripes);
        stripes += static_cast<uint32_t>(list.size());
    }
    const MaxCode code(structure.depths, widths.band_max);
    for (const PatchBand& band : structure.bands) {
        const uint32_t count = static_cast<uint32_t>(structure.lists[band.list].size()) - 1;
        const uint64_t place = band.y0 | uint64_t{code.code(maxima.of_lists[band.list])} << widths.y;
        const uint64_t list = first_of_list[band.list] | uint64_t{count} << widths.first;
        if (widths.wide_bands) {
            words.push_back(static_cast<uint32_t>(place));
            words.push_back(static_cast<uint32_t>(list));
        } else {
            words.push_back(static_cast<uint32_t>(place | list << (widths.y + widths.band_max)));
        }
    }
}

void write_stripes(const PatchStructure& structure, const Widths& widths, const Maxima& maxima,
                   std::vector<uint32_t>& words) {
    const MaxCode code(structure.depths, widths.stripe_max);
    const uint32_t label_count = static_cast<uint32_t>(structure.labels.size());
    for (const auto& list : structure.lists) {
        for (const PatchStripe& stripe : list) {
            const uint64_t content = stripe.content + (stripe.is_patch ? label_count : 0u);
            const uint64_t greatest = code.code(stripe_max(structure, maxima, stripe));
            words.push_back(
                static_cast<uint32_t>(stripe.x0 | content << widths.x | greatest << (widths.x + widths.content)));
        }
    }
}

/// How labels are packed.
struct LabelFields {
    int32_t least = 0, unit = 1;
    uint32_t depth_bits = 0, material_bits = 0;
    bool has_open = false;

    explicit LabelFields(const PatchStructure& structure) : least(structure.depths.min_mm) {
        int32_t greatest = least, common = 0;
        uint32_t material = 0;
        for (const uint32_t label : structure.labels) {
            const int32_t depth = displacement_of(label);
            material = std::max(material, material_of(label));
            has_open = has_open || depth == kOpenDisplacement;
            if (depth == kOpenDisplacement) continue;
            common = std::gcd(common, depth - least);
            greatest = std::max(greatest, depth);
        }
        unit = std::max(common, 1);
        depth_bits = bits::bits_for(code(greatest));
        material_bits = bits::bits_for(material);
    }
    uint32_t code(int32_t depth) const {
        if (depth == kOpenDisplacement) return 0;
        return static_cast<uint32_t>((depth - least) / unit) + (has_open ? 1 : 0);
    }
    uint32_t word() const {
        return static_cast<uint32_t>(unit) | depth_bits << PATCH_DEPTH_WIDTH_BIT |
               material_bits << PATCH_MATERIAL_WIDTH_BIT | uint32_t{has_open} << PATCH_HAS_OPEN_BIT;
    }
};

void write_labels(const PatchStructure& structure, const LabelFields& fields, std::vector<uint32_t>& words) {
    bits::BitWriter writer;
    for (const uint32_t label : structure.labels) {
        writer.put(fields.code(displacement_of(label)), fields.depth_bits);
        writer.put(material_of(label), fields.material_bits);
    }
    const std::vector<uint32_t> packed = writer.finish();
    words.insert(words.end(), packed.begin(), packed.end());
}

}  // namespace

Result<std::vector<uint32_t>> write_patch_words(const PatchStructure& structure) {
    const uint32_t label_bits = bits::bits_for(structure.labels.size() - 1);
    std::vector<GridPart> grids;
    for (const PatchGrid& grid : structure.grids) grids.push_back(grid_part(grid));
    PlacedParts placed = place_parts(structure, grids, label_bits, 0);
    for (uint32_t unit_log2 = 1; unit_log2 <= kMostUnitLog2; ++unit_log2) {
        PlacedParts other = place_parts(structure, grids, label_bits, unit_log2);
        const bool better = other.words() < placed.words() || placed.part_bits > kMostPartBits;
        if (better) placed = std::move(other);
    }
    if (placed.part_bits > kMostPartBits) return Error{"facade has too many parts for a patch map"};
    const auto widths = choose_widths(structure);
    if (!widths) return widths.error();
    const uint32_t width = structure.transposed ? structure.breadth : structure.length;
    const uint32_t height = structure.transposed ? structure.length : structure.breadth;
    std::vector<uint32_t> words(PATCH_PARTS_AT + placed.bytes.size() / 4);
    words[FACADE_FORM_WORD_FORM] = FACADE_FORM_MAGIC | FACADE_FORM_PATCH << 16;
    words[FACADE_FORM_WORD_SIZE] = width | height << 16;
    words[FACADE_FORM_WORD_DEPTHS] =
        make_label(structure.depths.min_mm, 0) | (static_cast<uint32_t>(structure.depths.max_mm) & 0xffffu) << 16;
    words[PATCH_WORD_COUNTS] = static_cast<uint32_t>(structure.bands.size()) |
                               uint32_t{structure.transposed} << PATCH_TRANSPOSED_BIT |
                               uint32_t{widths->wide_bands} << PATCH_WIDE_BANDS_BIT |
                               static_cast<uint32_t>(structure.labels.size()) << PATCH_LABEL_COUNT_BIT;
    words[PATCH_WORD_WIDTHS] =
        widths->word() | placed.unit_log2 << PATCH_UNIT_BIT | placed.part_bits << PATCH_PART_WIDTH_BIT;
    for (size_t i = 0; i < placed.bytes.size(); ++i)
        words[PATCH_PARTS_AT + i / 4] |= uint32_t{placed.bytes[i]} << 8 * (i % 4);
    words[PATCH_WORD_PATCHES] = static_cast<uint32_t>(words.size());
    write_patches(placed, words);
    const LabelFields label_fields(structure);
    words[PATCH_WORD_LABELS] = label_fields.word();
    write_labels(structure, label_fields, words);
    words[PATCH_WORD_BANDS] = static_cast<uint32_t>(words.size());
    const Maxima maxima = find_maxima(structure);
    write_bands(structure, *widths, maxima, words);
    write_stripes(structure, *widths, maxima, words);
    return words;
}

}  // namespace citystream::codec::facade
