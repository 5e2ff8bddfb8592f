#include "codec/facade/quotient_map.h"

#include <algorithm>
#include <cassert>
#include <string>

#include "codec/bits/bit_stream.h"
#include "codec/facade/quotient_sections.h"

namespace citystream::codec::facade {

namespace {

constexpr uint32_t kHeaderWords = 8;
/// What cells with labels instead of indexes may cost more: groups, or a share of the map.
constexpr uint64_t kDirectGroups = 16, kDirectShare = 64;
/// Cells are packed without gaps where gaps would cost more than so many groups and this share of the map.
constexpr uint64_t kMostGaps = 4, kMostGapShare = 64;
static_assert(kHeaderWords == RUN_BREAKS_GROUP * kGroupWords);
static_assert(kMaxFacadeSide < 1u << QUOTIENT_CLASS_BITS);

/// Fields of the map's own words, and where the sections begin, in groups.
struct Layout {
    FormHead head;
    uint32_t columns = 0, rows = 0;
    bool direct = false, dense = false;
    uint32_t column_bits = 0, row_bits = 0, cell_bits = 0, displacement_bits = 0;
    uint64_t row_breaks = 0, maxima = 0, column_classes = 0, row_classes = 0, labels = 0, cells = 0, end = 0;

    bool columns_are_texels() const { return columns == head.width; }
    bool rows_are_texels() const { return rows == head.height; }
    uint64_t cell_count() const { return uint64_t{columns} * rows; }

    /// Places the sections one behind the other.
    void place(uint64_t label_count) {
        row_breaks = RUN_BREAKS_GROUP + break_groups(head.width);
        maxima = row_breaks + break_groups(head.height);
        column_classes = maxima + block_groups(head.width, head.height);
        row_classes = column_classes + field_groups(head.width, column_bits);
        labels = row_classes + field_groups(head.height, row_bits);
        cells = labels + (direct ? 0 : field_groups(label_count, 32));
        end = cells + field_groups(cell_count(), cell_bits, dense);
    }
};

/// Classes that are the texels themselves need no numbers.
uint32_t class_bits(uint32_t classes, uint32_t size) {
    return classes == size ? 0 : bits::bits_for(classes - 1);
}

/// The class of every texel of an axis.
std::vector<uint32_t> texel_classes(std::span<const uint32_t> breaks, std::span<const uint32_t> classes) {
    std::vector<uint32_t> texels(breaks.back());
    for (size_t run = 0; run < classes.size(); ++run)
        std::fill(texels.begin() + breaks[run], texels.begin() + breaks[run + 1], classes[run]);
    return texels;
}

std::vector<uint32_t> maxima_of(const QuotientParts& parts, DepthRange depths) {
    std::vector<int16_t> displacements;
    displacements.reserve(parts.labels.size());
    for (const uint32_t label : parts.labels) displacements.push_back(static_cast<int16_t>(displacement_of(label)));
    return block_maxima({parts.x_breaks, parts.x_classes, parts.columns}, {parts.y_breaks, parts.y_classes, parts.rows},
                        displacements, depths);
}

Layout layout_for(const QuotientParts& parts, DepthRange depths, const LabelCode& code, uint64_t label_count) {
    Layout layout;
    layout.head = {FacadeForm::kQuotient, parts.x_breaks.back(), parts.y_breaks.back(), depths};
    layout.columns = parts.columns;
    layout.rows = parts.rows;
    layout.column_bits = class_bits(parts.columns, layout.head.width);
    layout.row_bits = class_bits(parts.rows, layout.head.height);
    const auto placed = [&](bool direct, bool dense) {
        layout.direct = direct;
        layout.dense = dense;
        layout.cell_bits = direct ? code.bits() : bits::bits_for(label_count - 1);
        layout.displacement_bits = direct ? code.displacement_bits : 0;
        layout.place(label_count);
        return layout.end;
    };
    const uint64_t table = placed(false, true);
    const bool direct = placed(true, true) <= table + std::max(kDirectGroups, table / kDirectShare);
    const uint64_t dense_end = placed(direct, true), end = placed(direct, false);
    placed(direct, end - dense_end > std::max(kMostGaps, end / kMostGapShare));
    return layout;
}

void append_header(std::vector<uint32_t>& words, const Layout& layout, uint32_t step_mm) {
    append_form_head(words, FacadeForm::kQuotient, layout.head.width, layout.head.height, layout.head.depths);
    words.push_back(layout.columns | layout.rows << QUOTIENT_CLASS_BITS |
                    (layout.direct ? 1u : 0u) << QUOTIENT_DIRECT_BIT | (layout.dense ? 1u : 0u) << QUOTIENT_DENSE_BIT);
    words.push_back(layout.column_bits | layout.row_bits << 4 | layout.cell_bits << 8 | layout.displacement_bits << 14);
    words.push_back(static_cast<uint32_t>(layout.column_classes | layout.row_classes << 16));
    words.push_back(layout.direct ? step_mm : static_cast<uint32_t>(layout.labels));
    words.push_back(static_cast<uint32_t>(layout.cells));
}

Error wrong(const char* what, uint64_t word) {
    return Error{std::string("quotient map: ") + what, 4 * word};
}

/// Header and section bounds: what reading needs. Everything else shows when the parts are written again.
Result<Layout> read_layout(std::span<const uint32_t> words) {
    const auto head = read_form_head(words);
    if (!head) return head.error();
    if (head->form != FacadeForm::kQuotient) return wrong("of another form", FACADE_FORM_WORD_FORM);
    if (words.size() < kHeaderWords) return wrong("ends in its header", words.size());
    Layout layout;
    layout.head = *head;
    const uint32_t classes = words[QUOTIENT_WORD_CLASSES], widths = words[QUOTIENT_WORD_WIDTHS];
    const uint32_t class_mask = (1u << QUOTIENT_CLASS_BITS) - 1;
    layout.columns = classes & class_mask;
    layout.rows = classes >> QUOTIENT_CLASS_BITS & class_mask;
    layout.direct = (classes >> QUOTIENT_DIRECT_BIT & 1) != 0;
    layout.dense = (classes >> QUOTIENT_DENSE_BIT & 1) != 0;
    if (layout.columns == 0 || layout.rows == 0 || layout.columns > head->width || layout.rows > head->height)
        return wrong("counts of distinct rows and columns out of range", QUOTIENT_WORD_CLASSES);
    layout.column_bits = class_bits(layout.columns, head->width);
    layout.row_bits = class_bits(layout.rows, head->height);
    layout.cell_bits = widths >> 8 & 63;
    layout.displacement_bits = widths >> 14;
    if (layout.cell_bits > 32 || layout.displacement_bits > std::min(layout.cell_bits, 16u))
        return wrong("field widths out of range", QUOTIENT_WORD_WIDTHS);
    // Cells that take no room must not claim any.
    if (layout.cell_bits == 0 && layout.cell_count() != 1) return wrong("cells without bits", QUOTIENT_WORD_WIDTHS);
    layout.place(0);
    const uint64_t cells = words[QUOTIENT_WORD_CELLS];
    if (cells < layout.cells || cells - layout.cells > words.size())
        return wrong("cells are not where they belong", QUOTIENT_WORD_CELLS);
    layout.end += cells - layout.cells;
    layout.cells = cells;
    if (layout.end * kGroupWords != words.size()) return wrong("does not end where its cells end", words.size());
    return layout;
}

/// The classes of runs, those of their first texels. False when one is out of range.
bool read_classes(std::span<const uint32_t> words, uint64_t group, uint32_t bits, bool texels, uint32_t count,
                  std::span<const uint32_t> breaks, std::vector<uint32_t>& classes) {
    for (size_t run = 0; run + 1 < breaks.size(); ++run) {
        classes.push_back(texels ? breaks[run] : read_field(words, group, breaks[run], bits));
        if (classes.back() >= count) return false;
    }
    return true;
}

Status read_labels(std::span<const uint32_t> words, const Layout& layout, QuotientParts& parts) {
    const LabelCode code = {layout.head.depths, words[QUOTIENT_WORD_LABELS], layout.displacement_bits, 0};
    const uint64_t label_count = (layout.cells - layout.labels) * kGroupWords;
    parts.labels.reserve(layout.cell_count());
    for (uint64_t cell = 0; cell < layout.cell_count(); ++cell) {
        const uint32_t number = read_field(words, layout.cells, cell, layout.cell_bits, layout.dense);
        if (!layout.direct && number >= label_count)
            return wrong("label of a cell out of range", layout.cells * kGroupWords);
        parts.labels.push_back(layout.direct ? code.label_of(number) : words[layout.labels * kGroupWords + number]);
    }
    return Done{};
}

}  // namespace

Result<std::vector<uint32_t>> encode_quotient_map(const RunGrid& grid) {
    return write_quotient_map(make_quotient(merge_equal_runs(grid)));
}

std::vector<uint32_t> write_quotient_map(const QuotientParts& parts) {
    const DepthRange depths = RunGrid{{}, {}, parts.labels}.depths();
    const LabelCode code = LabelCode::for_labels(parts.labels, depths);
    std::vector<uint32_t> table = parts.labels;
    std::sort(table.begin(), table.end());
    table.erase(std::unique(table.begin(), table.end()), table.end());
    const Layout layout = layout_for(parts, depths, code, table.size());

    std::vector<uint32_t> words;
    words.reserve(layout.end * kGroupWords);
    append_header(words, layout, code.step_mm);
    append_breaks(words, parts.x_breaks);
    append_breaks(words, parts.y_breaks);
    append_fields(words, maxima_of(parts, depths), 8);
    append_fields(words, texel_classes(parts.x_breaks, parts.x_classes), layout.column_bits);
    append_fields(words, texel_classes(parts.y_breaks, parts.y_classes), layout.row_bits);
    if (!layout.direct) append_fields(words, table, 32);
    std::vector<uint32_t> cells = parts.labels;
    for (uint32_t& cell : cells) {
        cell = layout.direct
                   ? code.number_of(cell)
                   : static_cast<uint32_t>(std::lower_bound(table.begin(), table.end(), cell) - table.begin());
    }
    append_fields(words, cells, layout.cell_bits, layout.dense);
    assert(words.size() == layout.end * kGroupWords);
    return words;
}

Result<QuotientParts> read_quotient_map(std::span<const uint32_t> words) {
    const auto layout = read_layout(words);
    if (!layout) return layout.error();
    QuotientParts parts;
    parts.columns = layout->columns;
    parts.rows = layout->rows;
    parts.x_breaks = read_breaks(words, RUN_BREAKS_GROUP, layout->head.width);
    parts.y_breaks = read_breaks(words, static_cast<uint32_t>(layout->row_breaks), layout->head.height);
    if (!read_classes(words, layout->column_classes, layout->column_bits, layout->columns_are_texels(), parts.columns,
                      parts.x_breaks, parts.x_classes))
        return wrong("class of a column out of range", layout->column_classes * kGroupWords);
    if (!read_classes(words, layout->row_classes, layout->row_bits, layout->rows_are_texels(), parts.rows,
                      parts.y_breaks, parts.y_classes))
        return wrong("class of a row out of range", layout->row_classes * kGroupWords);
    if (const Status labels = read_labels(words, *layout, parts); !labels) return labels.error();
    // Ranks, maxima, paddings, widths, the depth range, the label table: all follow from the parts.
    if (const Status same = check_rewritten(words, write_quotient_map(parts)); !same) return same.error();
    return parts;
}

Status check_quotient_map(std::span<const uint32_t> words) {
    const auto parts = read_quotient_map(words);
    return parts ? Status(Done{}) : Status(parts.error());
}

Result<RunGrid> decode_quotient_map(std::span<const uint32_t> words) {
    const auto parts = read_quotient_map(words);
    if (!parts) return parts.error();
    return merge_equal_runs(expand_quotient(*parts));
}

uint32_t quotient_label(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const uint32_t classes = words[QUOTIENT_WORD_CLASSES], widths = words[QUOTIENT_WORD_WIDTHS];
    const uint32_t size = words[FACADE_FORM_WORD_SIZE], groups = words[QUOTIENT_WORD_CLASS_GROUPS];
    const uint32_t mask = (1u << QUOTIENT_CLASS_BITS) - 1;
    const uint32_t columns = classes & mask, rows = classes >> QUOTIENT_CLASS_BITS & mask;
    const uint32_t column = columns == (size & 0xffffu) ? x : read_field(words, groups & 0xffffu, x, widths & 15);
    const uint32_t row = rows == size >> 16 ? y : read_field(words, groups >> 16, y, widths >> 4 & 15);
    const uint32_t cell = read_field(words, words[QUOTIENT_WORD_CELLS], uint64_t{row} * columns + column,
                                     widths >> 8 & 63, (classes >> QUOTIENT_DENSE_BIT & 1) != 0);
    if ((classes >> QUOTIENT_DIRECT_BIT & 1) == 0) return words[words[QUOTIENT_WORD_LABELS] * kGroupWords + cell];
    const uint32_t depths = words[FACADE_FORM_WORD_DEPTHS];
    const LabelCode code = {
        {displacement_of(depths), displacement_of(depths >> 16)}, words[QUOTIENT_WORD_LABELS], widths >> 14, 0};
    return code.label_of(cell);
}

}  // namespace citystream::codec::facade
