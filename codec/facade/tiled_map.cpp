#include "codec/facade/tiled_map.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <numeric>
#include <string>

#include "codec/bits/bit_stream.h"
#include "codec/facade/quotient_sections.h"
#include "codec/facade/tiled_layout.h"

namespace citystream::codec::facade {

namespace {

constexpr uint32_t kTileSide = 1u << TILE_SIDE_LOG2, kTileCells = kTileSide * kTileSide;
constexpr uint32_t kHeaderWords = 8, kMostCellBits = 6, kUnitWords = (1u << TILE_PATTERN_UNIT_LOG2) / 32;
static_assert(kTileCells == 1u << kMostCellBits);

uint32_t tiles_of(uint32_t runs) {
    return (runs + kTileSide - 1) / kTileSide;
}

struct TileRecord {
    uint32_t cell_bits = 0, pattern = 0, palette = 0;
};

/// Patterns and palettes, each once, in the order of first use.
class TilePools {
  public:
    /// `numbers`: label numbers of the tile's cells, row by row.
    TileRecord add(const std::vector<uint32_t>& numbers) {
        std::vector<uint32_t> palette, cells;
        for (const uint32_t number : numbers) {
            const auto known = std::find(palette.begin(), palette.end(), number);
            cells.push_back(static_cast<uint32_t>(known - palette.begin()));
            if (known == palette.end()) palette.push_back(number);
        }
        const uint32_t bits = bits::bits_for(palette.size() - 1);
        return {bits, bits == 0 ? 0 : pattern(cells, bits), this->palette(palette)};
    }
    const std::vector<uint32_t>& pattern_words() const { return pattern_words_; }
    const std::vector<uint32_t>& palette_entries() const { return entries_; }

  private:
    uint32_t pattern(const std::vector<uint32_t>& cells, uint32_t bits) {
        const auto unit = static_cast<uint32_t>(pattern_words_.size() / kUnitWords);
        const auto [at, added] = patterns_.try_emplace(cells, unit);
        if (!added) return at->second;
        bits::BitWriter writer;
        for (const uint32_t cell : cells) writer.put(cell, bits);
        const std::vector<uint32_t> words = writer.finish();
        pattern_words_.insert(pattern_words_.end(), words.begin(), words.end());
        return unit;
    }

    /// A single label is found wherever it stands.
    uint32_t palette(const std::vector<uint32_t>& labels) {
        const auto first = static_cast<uint32_t>(entries_.size());
        const auto [at, added] = palettes_.try_emplace(labels, first);
        if (!added) return at->second;
        for (const uint32_t label : labels) {
            palettes_.try_emplace({label}, static_cast<uint32_t>(entries_.size()));
            entries_.push_back(label);
        }
        return first;
    }

    std::map<std::vector<uint32_t>, uint32_t> patterns_, palettes_;
    std::vector<uint32_t> pattern_words_, entries_;
};

/// Label numbers of a tile's cells; those past the last column or row are like the last.
std::vector<uint32_t> tile_numbers(const RunGrid& grid, const LabelCode& code, uint32_t tile_x, uint32_t tile_y) {
    std::vector<uint32_t> numbers;
    for (uint32_t y = 0; y < kTileSide; ++y) {
        const uint32_t row = std::min(tile_y * kTileSide + y, grid.rows() - 1);
        for (uint32_t x = 0; x < kTileSide; ++x) {
            const uint32_t column = std::min(tile_x * kTileSide + x, grid.columns() - 1);
            numbers.push_back(code.number_of(grid.label(column, row)));
        }
    }
    return numbers;
}

std::vector<uint32_t> maxima_of(const RunGrid& grid, DepthRange depths) {
    std::vector<int16_t> displacements;
    displacements.reserve(grid.labels.size());
    for (const uint32_t label : grid.labels) displacements.push_back(static_cast<int16_t>(displacement_of(label)));
    std::vector<uint32_t> runs(std::max(grid.columns(), grid.rows()));
    std::iota(runs.begin(), runs.end(), 0u);
    const std::span<const uint32_t> all(runs);
    return block_maxima({grid.x_breaks, all.first(grid.columns()), grid.columns()},
                        {grid.y_breaks, all.first(grid.rows()), grid.rows()}, displacements, depths);
}

/// Fields of the map's own words.
struct Layout {
    FormHead head;
    uint32_t tiles_across = 0, pattern_bits = 0, palette_bits = 0, label_bits = 0, displacement_bits = 0, step_mm = 1;
    uint32_t records = 0, patterns = 0, palettes = 0;

    uint32_t record_bits() const { return TILE_CELL_BITS_BITS + pattern_bits + palette_bits; }
    uint32_t row_breaks() const { return RUN_BREAKS_GROUP + break_groups(head.width); }
    uint32_t maxima() const { return row_breaks() + break_groups(head.height); }
    LabelCode code() const { return {head.depths, step_mm, displacement_bits, label_bits - displacement_bits}; }

    TileRecord record(std::span<const uint32_t> words, uint64_t tile) const {
        const uint32_t field = read_field(words, records, tile, record_bits());
        const uint32_t rest = field >> TILE_CELL_BITS_BITS;
        const auto palette = static_cast<uint32_t>(uint64_t{rest} >> pattern_bits);
        return {field & ((1u << TILE_CELL_BITS_BITS) - 1),
                rest & static_cast<uint32_t>((uint64_t{1} << pattern_bits) - 1), palette};
    }
};

Layout layout_of(std::span<const uint32_t> words) {
    const uint32_t widths = words[TILED_WORD_WIDTHS], size = words[FACADE_FORM_WORD_SIZE];
    const uint32_t depths = words[FACADE_FORM_WORD_DEPTHS];
    Layout layout;
    layout.head = {
        FacadeForm::kTiled, size & 0xffffu, size >> 16, {displacement_of(depths), displacement_of(depths >> 16)}};
    layout.tiles_across = widths & 2047;
    layout.pattern_bits = widths >> 11 & 31;
    layout.palette_bits = widths >> 16 & 31;
    layout.label_bits = widths >> 21 & 63;
    layout.displacement_bits = widths >> 27;
    layout.step_mm = words[TILED_WORD_STEP];
    layout.records = words[TILED_WORD_RECORDS];
    layout.patterns = words[TILED_WORD_PATTERNS];
    layout.palettes = words[TILED_WORD_PALETTES];
    return layout;
}

Error wrong(const char* what, uint64_t word) {
    return Error{std::string("tiled map: ") + what, 4 * word};
}

/// Bounds of the sections: what reading needs. Everything else shows when the grid is written again.
Result<Layout> read_layout(std::span<const uint32_t> words) {
    const auto head = read_form_head(words);
    if (!head) return head.error();
    if (head->form != FacadeForm::kTiled) return wrong("of another form", FACADE_FORM_WORD_FORM);
    if (words.size() < kHeaderWords || words.size() % kGroupWords != 0) return wrong("ends in a group", words.size());
    const Layout layout = layout_of(words);
    if (layout.record_bits() > 32 || layout.label_bits > 32 ||
        layout.displacement_bits > std::min(layout.label_bits, 16u))
        return wrong("field widths out of range", TILED_WORD_WIDTHS);
    const uint64_t maxima_end = uint64_t{layout.maxima()} + block_groups(head->width, head->height);
    if (layout.records != maxima_end || layout.patterns < layout.records || layout.palettes < layout.patterns ||
        layout.palettes > words.size() / kGroupWords)
        return wrong("sections are not where they belong", TILED_WORD_RECORDS);
    return layout;
}

/// Which label of its palette a cell has.
uint32_t tile_entry(std::span<const uint32_t> words, const Layout& layout, const TileRecord& record, uint32_t cell) {
    const uint64_t first = (uint64_t{layout.patterns} * kGroupWords + uint64_t{record.pattern} * kUnitWords) * 32;
    return record.palette + bits::read_bits(words, first + uint64_t{cell} * record.cell_bits, record.cell_bits);
}

uint32_t entry_label(std::span<const uint32_t> words, const Layout& layout, uint32_t entry) {
    return layout.code().label_of(read_field(words, layout.palettes, entry, layout.label_bits));
}

void append_header(std::vector<uint32_t>& words, const Layout& layout) {
    append_form_head(words, FacadeForm::kTiled, layout.head.width, layout.head.height, layout.head.depths);
    words.push_back(layout.tiles_across | layout.pattern_bits << 11 | layout.palette_bits << 16 |
                    layout.label_bits << 21 | layout.displacement_bits << 27);
    words.insert(words.end(), {layout.records, layout.patterns, layout.palettes, layout.step_mm});
}

/// The layout once the pools are filled. Fails when a record is too wide.
Result<Layout> layout_for(const RunGrid& grid, const LabelCode& code, const TilePools& pools, size_t tiles,
                          uint32_t last_pattern, uint32_t last_palette) {
    Layout layout;
    layout.head = {FacadeForm::kTiled, grid.width(), grid.height(), code.depths};
    layout.tiles_across = tiles_of(grid.columns());
    layout.pattern_bits = bits::bits_for(last_pattern);
    layout.palette_bits = bits::bits_for(last_palette);
    layout.label_bits = code.bits();
    layout.displacement_bits = code.displacement_bits;
    layout.step_mm = code.step_mm;
    if (layout.record_bits() > 32) return Error{"facade too irregular for tiles: their records do not fit in 32 bits"};
    layout.records = layout.maxima() + block_groups(grid.width(), grid.height());
    layout.patterns = layout.records + static_cast<uint32_t>(field_groups(tiles, layout.record_bits()));
    layout.palettes =
        layout.patterns + static_cast<uint32_t>((pools.pattern_words().size() + kGroupWords - 1) / kGroupWords);
    return layout;
}

/// Reads the labels of a tile's cells. False when its pattern or palette lies outside.
bool read_tile(std::span<const uint32_t> words, const Layout& layout, uint64_t tile, RunGrid& grid) {
    const TileRecord record = layout.record(words, tile);
    const uint64_t units = uint64_t{layout.palettes - layout.patterns} * kGroupWords / kUnitWords;
    const uint64_t palette_groups = words.size() / kGroupWords - layout.palettes;
    if (record.cell_bits > kMostCellBits || record.pattern + uint64_t{record.cell_bits} > units) return false;
    const auto left = static_cast<uint32_t>(tile % layout.tiles_across) * kTileSide;
    const auto bottom = static_cast<uint32_t>(tile / layout.tiles_across) * kTileSide;
    for (uint32_t cell = 0; cell < kTileCells; ++cell) {
        const uint32_t column = left + cell % kTileSide, row = bottom + cell / kTileSide;
        if (column >= grid.columns() || row >= grid.rows()) continue;
        const uint32_t entry = tile_entry(words, layout, record, cell);
        if (field_groups(uint64_t{entry} + 1, layout.label_bits) > palette_groups) return false;
        grid.labels[size_t{row} * grid.columns() + column] = entry_label(words, layout, entry);
    }
    return true;
}

}  // namespace

Result<std::vector<uint32_t>> encode_tiled_map(const RunGrid& given) {
    const RunGrid grid = merge_equal_runs(given);
    const LabelCode code = LabelCode::for_labels(grid.labels, grid.depths());
    TilePools pools;
    std::vector<TileRecord> records;
    uint32_t last_pattern = 0, last_palette = 0;
    for (uint32_t y = 0; y < tiles_of(grid.rows()); ++y) {
        for (uint32_t x = 0; x < tiles_of(grid.columns()); ++x) {
            records.push_back(pools.add(tile_numbers(grid, code, x, y)));
            last_pattern = std::max(last_pattern, records.back().pattern);
            last_palette = std::max(last_palette, records.back().palette);
        }
    }
    const auto layout = layout_for(grid, code, pools, records.size(), last_pattern, last_palette);
    if (!layout) return layout.error();
    std::vector<uint32_t> fields;
    for (const TileRecord& record : records) {
        const uint64_t parts = record.pattern | uint64_t{record.palette} << layout->pattern_bits;
        fields.push_back(static_cast<uint32_t>(record.cell_bits | parts << TILE_CELL_BITS_BITS));
    }
    std::vector<uint32_t> words;
    append_header(words, *layout);
    append_breaks(words, grid.x_breaks);
    append_breaks(words, grid.y_breaks);
    append_fields(words, maxima_of(grid, code.depths), 8);
    append_fields(words, fields, layout->record_bits());
    words.insert(words.end(), pools.pattern_words().begin(), pools.pattern_words().end());
    words.resize(size_t{layout->palettes} * kGroupWords, 0);
    append_fields(words, pools.palette_entries(), layout->label_bits);
    return words;
}

Result<RunGrid> decode_tiled_map(std::span<const uint32_t> words) {
    const auto layout = read_layout(words);
    if (!layout) return layout.error();
    RunGrid grid{read_breaks(words, RUN_BREAKS_GROUP, layout->head.width),
                 read_breaks(words, layout->row_breaks(), layout->head.height),
                 {}};
    const uint64_t across = tiles_of(grid.columns()), tiles = across * tiles_of(grid.rows());
    if (layout->tiles_across != across ||
        layout->records + field_groups(tiles, layout->record_bits()) != layout->patterns)
        return wrong("tiles are not as many as the runs need", TILED_WORD_WIDTHS);
    grid.labels.resize(size_t{grid.columns()} * grid.rows());
    for (uint64_t tile = 0; tile < tiles; ++tile) {
        if (!read_tile(words, *layout, tile, grid))
            return wrong("tile outside its pools", layout->records * kGroupWords);
    }
    const auto rewritten = encode_tiled_map(grid);
    if (!rewritten) return rewritten.error();
    if (const Status same = check_rewritten(words, *rewritten); !same) return same.error();
    return grid;
}

Status check_tiled_map(std::span<const uint32_t> words) {
    const auto grid = decode_tiled_map(words);
    return grid ? Status(Done{}) : Status(grid.error());
}

uint32_t tiled_label(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const Layout layout = layout_of(words);
    const uint32_t column = run_at(words, RUN_BREAKS_GROUP, x).index, row = run_at(words, layout.row_breaks(), y).index;
    const uint64_t tile = uint64_t{row / kTileSide} * layout.tiles_across + column / kTileSide;
    const uint32_t cell = row % kTileSide * kTileSide + column % kTileSide;
    return entry_label(words, layout, tile_entry(words, layout, layout.record(words, tile), cell));
}

}  // namespace citystream::codec::facade
