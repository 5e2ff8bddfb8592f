#include <algorithm>
#include <string>

#include "codec/bits/bit_stream.h"
#include "codec/facade/facade_form_layout.h"
#include "codec/facade/patch_structure.h"

namespace citystream::codec::facade {

namespace {

Error wrong(const std::string& what, uint64_t word) {
    return {"patch map: " + what, 4 * word};
}

/// Sections and widths as the head gives them.
struct Head {
    uint32_t bands = 0, band_words = 1, patch_words = 1;
    uint32_t unit_log2 = 0, part_bits = 0, label_bits = 0;
    uint32_t x_bits = 0, y_bits = 0, first_bits = 0, count_bits = 0, band_max_bits = 0, content_bits = 0;
    uint32_t depth_unit = 1, depth_bits = 0, material_bits = 0;
    bool has_open = false;
    uint32_t patches_at = 0, labels_at = 0, bands_at = 0, stripes_at = 0;
    uint32_t patches = 0, labels = 0, stripes = 0;
};

uint32_t field(uint32_t word, uint32_t bit, uint32_t bits) {
    return bits == 0 ? 0 : word >> bit & (0xffffffffu >> (32 - bits));
}

class Reader {
  public:
    explicit Reader(std::span<const uint32_t> words) : words_(words), builder_({}) {}

    Result<PatchStructure> read() {
        if (const Status status = read_head(); !status) return status.error();
        builder_ = PatchBuilder(structure_);
        uint32_t before = 0;
        for (uint32_t i = 0; i < head_.bands; ++i) {
            const Status status = read_band(i, before);
            if (!status) return status.error();
        }
        return builder_.take();
    }

  private:
    Status read_head() {
        if (words_.size() < PATCH_PARTS_AT + 2 || words_.size() >= size_t{1} << 30)
            return wrong(std::to_string(words_.size()) + " words", 0);
        if (words_[FACADE_FORM_WORD_FORM] != (FACADE_FORM_MAGIC | FACADE_FORM_PATCH << 16))
            return wrong("another form or version", 0);
        const uint32_t counts = words_[PATCH_WORD_COUNTS];
        const uint32_t width = words_[FACADE_FORM_WORD_SIZE] & 0xffffu, height = words_[FACADE_FORM_WORD_SIZE] >> 16;
        if (width == 0 || height == 0 || width > kMaxFacadeSide || height > kMaxFacadeSide)
            return wrong("size of " + std::to_string(width) + " x " + std::to_string(height), 4);
        structure_.transposed = (counts >> PATCH_TRANSPOSED_BIT & 1u) != 0;
        structure_.length = structure_.transposed ? height : width;
        structure_.breadth = structure_.transposed ? width : height;
        structure_.depths = {displacement_of(words_[FACADE_FORM_WORD_DEPTHS]),
                             displacement_of(words_[FACADE_FORM_WORD_DEPTHS] >> 16)};
        head_.bands = counts & PATCH_BAND_COUNT_MASK;
        head_.band_words = 1 + (counts >> PATCH_WIDE_BANDS_BIT & 1u);
        head_.labels = counts >> PATCH_LABEL_COUNT_BIT;
        if (head_.bands == 0 || head_.labels == 0) return wrong("no bands or labels", PATCH_WORD_COUNTS);
        head_.x_bits = bits::bits_for(structure_.length - 1);
        head_.y_bits = bits::bits_for(structure_.breadth - 1);
        head_.label_bits = bits::bits_for(head_.labels - 1);
        const uint32_t widths = words_[PATCH_WORD_WIDTHS];
        head_.first_bits = field(widths, PATCH_FIRST_WIDTH_BIT, 5);
        head_.count_bits = field(widths, PATCH_COUNT_WIDTH_BIT, 4);
        head_.band_max_bits = field(widths, PATCH_BAND_MAX_WIDTH_BIT, 4);
        head_.content_bits = field(widths, PATCH_CONTENT_WIDTH_BIT, 5);
        head_.unit_log2 = field(widths, PATCH_UNIT_BIT, 2);
        head_.part_bits = field(widths, PATCH_PART_WIDTH_BIT, 4);
        head_.patch_words = head_.part_bits > PATCH_NARROW_PART_BITS ? 2 : 1;
        const uint32_t labels = words_[PATCH_WORD_LABELS];
        head_.depth_unit = labels & 0xffffu;
        head_.depth_bits = field(labels, PATCH_DEPTH_WIDTH_BIT, 5);
        head_.material_bits = field(labels, PATCH_MATERIAL_WIDTH_BIT, 5);
        head_.has_open = (labels >> PATCH_HAS_OPEN_BIT & 1u) != 0;
        if (head_.depth_bits > 17 || head_.material_bits > 16 || head_.x_bits + head_.content_bits > 32 ||
            head_.y_bits + head_.band_max_bits > 32 || head_.part_bits * 2 > PATCH_CELL_BITS_BIT ||
            (head_.band_words == 1 && head_.y_bits + head_.band_max_bits + head_.first_bits + head_.count_bits > 32))
            return wrong("field widths do not fit a word", PATCH_WORD_WIDTHS);
        return read_sections();
    }

    Status read_sections() {
        head_.patches_at = words_[PATCH_WORD_PATCHES];
        head_.bands_at = words_[PATCH_WORD_BANDS];
        const uint64_t label_words = (uint64_t{head_.labels} * (head_.depth_bits + head_.material_bits) + 31) / 32;
        const uint64_t stripes_at = uint64_t{head_.bands_at} + head_.bands * head_.band_words;
        if (head_.patches_at < PATCH_PARTS_AT || head_.patches_at + label_words > head_.bands_at ||
            stripes_at >= words_.size())
            return wrong("sections out of order", PATCH_WORD_PATCHES);
        head_.labels_at = head_.bands_at - static_cast<uint32_t>(label_words);
        head_.stripes_at = static_cast<uint32_t>(stripes_at);
        head_.patches = (head_.labels_at - head_.patches_at) / head_.patch_words;
        head_.stripes = static_cast<uint32_t>(words_.size()) - head_.stripes_at;
        return read_label_words();
    }

    Status read_label_words() {
        const uint32_t stride = head_.depth_bits + head_.material_bits;
        for (uint32_t i = 0; i < head_.labels; ++i) {
            const uint64_t bit = 32 * uint64_t{head_.labels_at} + uint64_t{i} * stride;
            const uint32_t code = bits::read_bits(words_, bit, head_.depth_bits);
            const uint32_t material = bits::read_bits(words_, bit + head_.depth_bits, head_.material_bits);
            int64_t depth = kOpenDisplacement;
            if (!head_.has_open || code > 0) {
                const uint32_t steps = code - (head_.has_open ? 1 : 0);
                depth = structure_.depths.min_mm + int64_t{steps} * head_.depth_unit;
                if (depth > 32767) return wrong("displacement of a label", head_.labels_at);
            }
            labels_.push_back(make_label(static_cast<int32_t>(depth), material));
        }
        return Done{};
    }

    Status read_band(uint32_t index, uint32_t& before) {
        const uint32_t at = head_.bands_at + index * head_.band_words;
        const uint32_t y0 = field(words_[at], 0, head_.y_bits);
        if (index == 0 ? y0 != 0 : (y0 <= before || y0 >= structure_.breadth)) return wrong("bands do not rise", at);
        before = y0;
        const uint32_t list = head_.band_words == 2 ? at + 1 : at;
        const uint32_t bit = head_.band_words == 2 ? 0 : head_.y_bits + head_.band_max_bits;
        const uint32_t first = field(words_[list], bit, head_.first_bits);
        const uint32_t count = 1 + field(words_[list], bit + head_.first_bits, head_.count_bits);
        if (uint64_t{first} + count > head_.stripes) return wrong("stripes of a band out of range", list);
        const auto known = lists_.find(first);
        if (known != lists_.end()) {
            if (known->second.count != count) return wrong("overlapping stripe lists", list);
            builder_.band(y0, known->second.index);
            return Done{};
        }
        stripes_read_ += count;
        if (stripes_read_ > head_.stripes) return wrong("overlapping stripe lists", list);
        std::vector<PatchStripe> stripes;
        for (uint32_t i = 0; i < count; ++i) {
            Status status = read_stripe(head_.stripes_at + first + i, stripes);
            if (!status) return status;
        }
        const uint32_t index_of_list = builder_.list(stripes);
        lists_[first] = {count, index_of_list};
        builder_.band(y0, index_of_list);
        return Done{};
    }

    Status read_stripe(uint32_t at, std::vector<PatchStripe>& stripes) {
        PatchStripe stripe;
        stripe.x0 = field(words_[at], 0, head_.x_bits);
        if (stripes.empty() ? stripe.x0 != 0 : (stripe.x0 <= stripes.back().x0 || stripe.x0 >= structure_.length))
            return wrong("stripes do not rise", at);
        const uint32_t content = field(words_[at], head_.x_bits, head_.content_bits);
        if (content < head_.labels) {
            stripe.content = builder_.label(labels_[content]);
        } else {
            stripe.is_patch = true;
            const auto patch = read_patch(content - head_.labels, at);
            if (!patch) return patch.error();
            stripe.content = *patch;
        }
        stripes.push_back(stripe);
        return Done{};
    }

    /// Index of the patch in the builder.
    Result<uint32_t> read_patch(uint32_t index, uint32_t stripe_at) {
        if (index >= head_.patches) return wrong("no such patch", stripe_at);
        const auto known = patches_.find(index);
        if (known != patches_.end()) return known->second;
        const uint32_t at = head_.patches_at + index * head_.patch_words;
        const uint32_t bits = head_.part_bits;
        const uint32_t lists = words_[at], cells = words_[at + head_.patch_words - 1];
        const uint32_t cells_bit = head_.patch_words == 2 ? 0 : 2 * bits;
        const auto rows = read_breaks(field(lists, 0, bits), at);
        if (!rows) return rows.error();
        const auto columns = read_breaks(field(lists, bits, bits), at);
        if (!columns) return columns.error();
        const auto grid =
            read_grid(field(cells, cells_bit + bits, bits), cells, rows->size() + 1, columns->size() + 1, at);
        if (!grid) return grid.error();
        const auto labels = read_labels(field(cells, cells_bit, bits), *grid, at);
        if (!labels) return labels.error();
        const uint32_t patch = builder_.patch(*rows, *columns, *labels);
        patches_[index] = patch;
        return patch;
    }

    /// First bit of a part.
    uint64_t part_bit(uint32_t offset) const {
        return 32 * uint64_t{PATCH_PARTS_AT} + (8ull * offset << head_.unit_log2);
    }
    bool in_parts(uint64_t bit, uint64_t bits) const { return bit + bits <= 32 * uint64_t{head_.patches_at}; }

    Result<PatchBreaks> read_breaks(uint32_t offset, uint32_t at) const {
        const uint64_t bit = part_bit(offset);
        if (!in_parts(bit, 8)) return wrong("breaks of a patch out of range", at);
        const uint32_t count = bits::read_bits(words_, bit, 5);
        const uint32_t width = PATCH_LEAST_BREAK_BITS + bits::read_bits(words_, bit + 5, 3);
        if (count * width > PATCH_BREAK_LIST_BITS || !in_parts(bit, 8 + count * width))
            return wrong("breaks of a patch out of range", at);
        PatchBreaks breaks;
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t value = bits::read_bits(words_, bit + 8 + i * width, width);
            if (value <= (breaks.empty() ? 0u : breaks.back())) return wrong("breaks of a patch do not rise", at);
            breaks.push_back(static_cast<uint16_t>(value));
        }
        return breaks;
    }

    /// Fields of `bits` bits, values below `end`, from `bit` on, which goes on behind them.
    Result<std::vector<uint32_t>> read_fields(uint64_t& bit, uint64_t count, uint32_t bits, uint32_t end,
                                              uint32_t at) const {
        if (!in_parts(bit, count * bits)) return wrong("cells of a patch out of range", at);
        std::vector<uint32_t> values;
        for (uint64_t i = 0; i < count; ++i, bit += bits) {
            values.push_back(bits::read_bits(words_, bit, bits));
            if (values.back() >= end) return wrong("cells of a patch refer to no row or column", at);
        }
        return values;
    }

    /// Indexes of the lines of a folded grid among the different ones: all their own where they have no bits.
    Result<std::vector<uint32_t>> read_lines(uint64_t& bit, size_t count, uint32_t bits, uint32_t at) const {
        if (bits > 0) return read_fields(bit, count, bits, PATCH_MOST_BREAKS + 1, at);
        std::vector<uint32_t> lines(count);
        for (uint32_t i = 0; i < count; ++i) lines[i] = i;
        return lines;
    }

    /// The cells. `field_word`: the patch's last word.
    Result<std::vector<uint32_t>> read_grid(uint32_t offset, uint32_t field_word, size_t rows, size_t columns,
                                            uint32_t at) const {
        const uint32_t cell_bits = 1 + (field_word >> PATCH_CELL_BITS_BIT & 7u);
        const uint32_t any_cell = 1u << cell_bits;
        uint64_t bit = part_bit(offset);
        if (field_word >> PATCH_FOLDED_BIT == 0) return read_fields(bit, rows * columns, cell_bits, any_cell, at);
        if (!in_parts(bit, PATCH_FOLD_HEAD_BITS)) return wrong("cells of a patch out of range", at);
        const uint32_t head = bits::read_bits(words_, bit, PATCH_FOLD_HEAD_BITS);
        const uint32_t different_columns = 1 + (head >> 6);
        bit += PATCH_FOLD_HEAD_BITS;
        auto row_lines = read_lines(bit, rows, head & 7u, at);
        if (!row_lines) return row_lines;
        auto column_lines = read_lines(bit, columns, head >> 3 & 7u, at);
        if (!column_lines) return column_lines;
        const uint64_t different_rows = 1 + *std::max_element(row_lines->begin(), row_lines->end());
        if (different_columns != 1 + *std::max_element(column_lines->begin(), column_lines->end()))
            return wrong("different columns of a patch", at);
        auto cells = read_fields(bit, different_rows * different_columns, cell_bits, any_cell, at);
        if (!cells) return cells;
        std::vector<uint32_t> grid;
        for (const uint32_t row : *row_lines) {
            for (const uint32_t column : *column_lines) grid.push_back((*cells)[row * different_columns + column]);
        }
        return grid;
    }

    Result<std::vector<uint32_t>> read_labels(uint32_t palette, const std::vector<uint32_t>& grid, uint32_t at) const {
        const uint64_t palette_bit = part_bit(palette);
        std::vector<uint32_t> labels;
        bool differ = false;
        for (const uint32_t cell : grid) {
            const uint64_t bit = palette_bit + uint64_t{cell} * head_.label_bits;
            if (!in_parts(bit, head_.label_bits)) return wrong("palette of a patch out of range", at);
            const uint32_t label = bits::read_bits(words_, bit, head_.label_bits);
            if (label >= head_.labels) return wrong("label of a patch out of range", at);
            labels.push_back(labels_[label]);
            differ = differ || labels.back() != labels.front();
        }
        if (!differ) return wrong("patch of one label", at);
        return labels;
    }

    struct List {
        uint32_t count = 0, index = 0;
    };

    std::span<const uint32_t> words_;
    Head head_;
    PatchStructure structure_;
    PatchBuilder builder_;
    std::vector<uint32_t> labels_;
    uint64_t stripes_read_ = 0;
    std::map<uint32_t, List> lists_;
    std::map<uint32_t, uint32_t> patches_;
};

}  // namespace

Status check_extents(const PatchStructure& map) {
    const auto last = [&](uint32_t list) { return map.break_lists[list].empty() ? 0u : map.break_lists[list].back(); };
    std::vector<uint32_t> last_row(map.lists.size(), 0);
    for (size_t l = 0; l < map.lists.size(); ++l) {
        const std::vector<PatchStripe>& list = map.lists[l];
        for (size_t s = 0; s < list.size(); ++s) {
            if (!list[s].is_patch) continue;
            const uint32_t end = s + 1 < list.size() ? list[s + 1].x0 : map.length;
            const PatchRecord& patch = map.patches[list[s].content];
            if (list[s].x0 + last(patch.columns) >= end) return Error{"patch map: patch wider than its stripe"};
            last_row[l] = std::max(last_row[l], last(patch.rows));
        }
    }
    for (size_t b = 0; b < map.bands.size(); ++b) {
        const uint32_t end = b + 1 < map.bands.size() ? map.bands[b + 1].y0 : map.breadth;
        if (map.bands[b].y0 + last_row[map.bands[b].list] >= end) return Error{"patch map: patch taller than its band"};
    }
    return Done{};
}

Result<PatchStructure> read_patch_words(std::span<const uint32_t> words) {
    auto structure = Reader(words).read();
    if (!structure) return structure;
    if (const Status status = check_extents(*structure); !status) return status.error();
    if (depth_range(structure->labels) != structure->depths) return wrong("depths", FACADE_FORM_WORD_DEPTHS);
    // There is one way to write a structure: whatever else the words say about it is wrong.
    const auto again = write_patch_words(*structure);
    if (!again) return again.error();
    const auto [differs, of_again] = std::mismatch(words.begin(), words.end(), again->begin(), again->end());
    if (differs != words.end() || of_again != again->end())
        return wrong("not as this structure is written", static_cast<uint64_t>(differs - words.begin()));
    return structure;
}

}  // namespace citystream::codec::facade
