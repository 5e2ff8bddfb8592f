// Reading the patch form of a facade map (patch_layout.h): bands, stripes, patches and their parts, and the label of a texel. Words are read
// in aligned groups of four and kept while the next ones lie in the same group.
#ifndef CITYSTREAM_FACADE_LOOKUP_PATCH_GLSL
#define CITYSTREAM_FACADE_LOOKUP_PATCH_GLSL

#include "codec/facade/patch_layout.h"
#include "shaders/facade_ray.glsl"

// The group of words read last.
struct PatchGroup {
    uvec4 words;
    uint group;
};

PatchGroup patch_no_group() { return PatchGroup(uvec4(0u), 0xffffffffu); }

uint patch_word(FacadeMap map, INOUT(PatchGroup) kept, uint index) {
    uint group = index >> 2;
    if (kept.group != group) {
        kept.words = layer_words4(map.layer, group);
        kept.group = group;
    }
    return kept.words[index & 3u];
}

uint patch_field(uint word, uint bit, uint bits) { return bits == 0u ? 0u : word >> bit & (0xffffffffu >> (32u - bits)); }

uint patch_bits(FacadeMap map, INOUT(PatchGroup) kept, uint bit, uint bits) {
    uint index = bit >> 5;
    uint shift = bit & 31u;
    uint value = patch_word(map, kept, index) >> shift;
    if (shift + bits > 32u) value = value | patch_word(map, kept, index + 1u) << (32u - shift);
    return patch_field(value, 0u, bits);
}

bool patch_is_transposed(FacadeMap map) { return (map.head.w >> PATCH_TRANSPOSED_BIT & 1u) != 0u; }
uint patch_band_count(FacadeMap map) { return map.head.w & uint(PATCH_BAND_COUNT_MASK); }
uint patch_band_words(FacadeMap map) { return 1u + (map.head.w >> PATCH_WIDE_BANDS_BIT & 1u); }
uint patch_width(uint greatest) { return greatest == 0u ? 0u : uint(findMSB(greatest)) + 1u; }
uint patch_length(FacadeMap map) { return patch_is_transposed(map) ? map_height(map) : map_width(map); }
uint patch_breadth(FacadeMap map) { return patch_is_transposed(map) ? map_width(map) : map_height(map); }
uint patch_x_bits(FacadeMap map) { return patch_width(patch_length(map) - 1u); }
uint patch_y_bits(FacadeMap map) { return patch_width(patch_breadth(map) - 1u); }
uint patch_label_count(FacadeMap map) { return map.head.w >> PATCH_LABEL_COUNT_BIT; }
uint patch_label_bits(FacadeMap map) { return patch_width(patch_label_count(map) - 1u); }
uint patch_band_max_bits(FacadeMap map) { return patch_field(map.own.x, uint(PATCH_BAND_MAX_WIDTH_BIT), 4u); }
uint patch_content_bits(FacadeMap map) { return patch_field(map.own.x, uint(PATCH_CONTENT_WIDTH_BIT), 5u); }

// Greatest displacement from its code.
float patch_max(FacadeMap map, uint code, uint bits) {
    if (bits == 0u) return map_depth_max(map);
    float codes = float((1u << bits) - 1u);
    float stride = ceil((map_depth_max(map) - map_depth_min(map)) / codes);
    return min(map_depth_max(map), map_depth_min(map) + float(code) * stride);
}

uint patch_label(FacadeMap map, INOUT(PatchGroup) kept, uint index) {
    uint fields = map.own.w;
    uint depth_bits = patch_field(fields, uint(PATCH_DEPTH_WIDTH_BIT), 5u);
    uint material_bits = patch_field(fields, uint(PATCH_MATERIAL_WIDTH_BIT), 5u);
    uint has_open = fields >> PATCH_HAS_OPEN_BIT & 1u;
    uint stride = depth_bits + material_bits;
    uint bands_at = map.own.z;
    uint bit = 32u * (bands_at - ((patch_label_count(map) * stride + 31u) >> 5)) + index * stride;
    // Without bits there is nothing to read.
    uint code = depth_bits == 0u ? 0u : patch_bits(map, kept, bit, depth_bits);
    uint material = material_bits == 0u ? 0u : patch_bits(map, kept, bit + depth_bits, material_bits);
    if (code < has_open) return (uint(FACADE_OPEN_DISPLACEMENT) & 0xffffu) | material << 16;
    return ((map.head.z + (code - has_open) * (fields & 0xffffu)) & 0xffffu) | material << 16;
}

// Where a ray is along one axis at some t: in the texel where it came into the volume, or beyond the breaks that it has crossed since.
struct PatchPlace {
    float origin;
    float direction;
    float inverse;
    float texel;  // by which it came in
    float t;
    bool with_ties;  // breaks at exactly t have been crossed
};

// Whether the place is at or above the break.
bool patch_is_past(PatchPlace place, float at) {
    if (place.direction == 0.0) return at <= place.texel;
    float t = (at - place.origin) * place.inverse;
    bool crossed = place.with_ties ? t <= place.t : t < place.t;
    return place.direction > 0.0 ? at <= place.texel || crossed : at <= place.texel && !crossed;
}

// One of a list of records (bands or stripes) whose low bits are rising positions.
struct PatchRun {
    uint index;
    uint word;
    float low;  // texels
    float high;
};

struct PatchRecords {
    uint at;  // word of the first
    uint stride;
    uint count;
    uint bits;   // of the position
    float size;  // end of the last
};

float patch_record_low(PatchRecords records, uint word) { return float(patch_field(word, 0u, records.bits)); }

// The record of a place: by a guess from the place, its neighbours, then bisection.
PatchRun patch_find(FacadeMap map, INOUT(PatchGroup) kept, PatchRecords records, PatchPlace place) {
    PatchRun run = PatchRun(0u, 0u, 0.0, records.size);
    uint high = records.count - 1u;
    bool is_read = false;
    float about = place.direction == 0.0 ? place.texel : place.origin + place.t * place.direction;
    uint probe = min(uint(clamp(about / records.size, 0.0, 1.0) * float(records.count)), high);
    uint last_tried = 2u;
    for (uint tries = 0u; tries <= records.count; ++tries) {
        // All records of the probe's group, from the top.
        uint first = (records.at + probe * records.stride) & ~3u;
        uint begin = first <= records.at ? 0u : (first - records.at + records.stride - 1u) / records.stride;
        uint end = min(records.count, (first + 4u - records.at + records.stride - 1u) / records.stride);
        for (uint i = begin; i < end; ++i) {
            uint word = patch_word(map, kept, records.at + i * records.stride);
            float low = patch_record_low(records, word);
            if (i == 0u || patch_is_past(place, low)) {
                if (i >= run.index) {
                    run.index = i;
                    run.word = word;
                    run.low = low;
                    is_read = true;
                }
            } else if (i <= high) {
                high = i - 1u;
                run.high = low;
            }
        }
        if (run.index >= high && is_read) break;
        if (tries < last_tried) probe = probe <= run.index && is_read ? run.index + 1u : high;
        else probe = (run.index + high + 1u) >> 1;
    }
    return run;
}

PatchRecords patch_bands(FacadeMap map) {
    return PatchRecords(map.own.z, patch_band_words(map), patch_band_count(map), patch_y_bits(map), float(patch_breadth(map)));
}

float patch_band_max(FacadeMap map, uint band_word) {
    uint bits = patch_band_max_bits(map);
    return patch_max(map, patch_field(band_word, patch_y_bits(map), bits), bits);
}

// The stripes of a band whose first word was read with `kept`.
PatchRecords patch_stripes(FacadeMap map, INOUT(PatchGroup) kept, uint band, uint band_word) {
    uint first_bits = patch_field(map.own.x, uint(PATCH_FIRST_WIDTH_BIT), 5u);
    uint count_bits = patch_field(map.own.x, uint(PATCH_COUNT_WIDTH_BIT), 4u);
    bool wide = patch_band_words(map) == 2u;
    uint word = wide ? patch_word(map, kept, map.own.z + 2u * band + 1u) : band_word;
    uint bit = wide ? 0u : patch_y_bits(map) + patch_band_max_bits(map);
    uint stripes_at = map.own.z + patch_band_count(map) * patch_band_words(map);
    return PatchRecords(stripes_at + patch_field(word, bit, first_bits), 1u, 1u + patch_field(word, bit + first_bits, count_bits),
                        patch_x_bits(map), float(patch_length(map)));
}

// A label or, from patch_label_count on, a patch.
uint patch_stripe_content(FacadeMap map, uint stripe_word) {
    return patch_field(stripe_word, patch_x_bits(map), patch_content_bits(map));
}

float patch_stripe_max(FacadeMap map, uint stripe_word) {
    uint bits = patch_field(map.own.x, uint(PATCH_STRIPE_MAX_WIDTH_BIT), 4u);
    return patch_max(map, patch_field(stripe_word, patch_x_bits(map) + patch_content_bits(map), bits), bits);
}

struct PatchBreaks {
    PatchGroup group;
    uint bit;    // of the first break
    uint count;  // inner breaks
    uint bits;   // of one
};

struct Patch {
    PatchBreaks rows;
    PatchBreaks columns;
    PatchGroup palette;
    PatchGroup cells;
    PatchGroup lines;  // indexes of a folded grid
    uint palette_bit;
    uint cells_bit;
    uint cell_bits;
    uint fold;  // head of a folded grid | 1 << 31; 0 of a plain one
};

uint patch_part_bit(FacadeMap map, uint offset) {
    return 32u * uint(PATCH_PARTS_AT) + (offset << (3u + patch_field(map.own.x, uint(PATCH_UNIT_BIT), 2u)));
}

// `kept`: a group that may hold the list.
PatchBreaks patch_breaks(FacadeMap map, PatchGroup kept, uint offset) {
    PatchBreaks breaks = PatchBreaks(kept, patch_part_bit(map, offset), 0u, 0u);
    uint head = patch_word(map, breaks.group, breaks.bit >> 5) >> (breaks.bit & 31u);
    breaks.count = head & 31u;
    breaks.bits = uint(PATCH_LEAST_BREAK_BITS) + (head >> 5 & 7u);
    breaks.bit = breaks.bit + 8u;
    return breaks;
}

// Inner break `index` from the patch's corner.
float patch_break(FacadeMap map, INOUT(PatchBreaks) breaks, uint index) {
    return float(patch_bits(map, breaks.group, breaks.bit + index * breaks.bits, breaks.bits));
}

// The cell of a place along one axis; `corner`: of the patch.
uint patch_cell(FacadeMap map, INOUT(PatchBreaks) breaks, PatchPlace place, float corner) {
    uint low = 0u;
    uint high = breaks.count;
    while (low < high) {
        uint middle = (low + high) >> 1;
        if (patch_is_past(place, corner + patch_break(map, breaks, middle))) low = middle + 1u;
        else high = middle;
    }
    return low;
}

// Parts of a patch often share groups.
Patch patch_open(FacadeMap map, INOUT(PatchGroup) kept, uint index) {
    uint bits = patch_field(map.own.x, uint(PATCH_PART_WIDTH_BIT), 4u);
    bool wide = bits > uint(PATCH_NARROW_PART_BITS);
    uint at = map.own.y + (wide ? 2u * index : index);
    uint lists = patch_word(map, kept, at);
    uint cells = wide ? patch_word(map, kept, at + 1u) : lists;
    uint cells_field = wide ? 0u : 2u * bits;
    PatchBreaks rows = patch_breaks(map, patch_no_group(), patch_field(lists, 0u, bits));
    PatchBreaks columns = patch_breaks(map, rows.group, patch_field(lists, bits, bits));
    uint palette_bit = patch_part_bit(map, patch_field(cells, cells_field, bits));
    uint cells_bit = patch_part_bit(map, patch_field(cells, cells_field + bits, bits));
    PatchGroup palette = patch_no_group();
    if (palette_bit >> 7 == columns.group.group) palette = columns.group;
    else if (palette_bit >> 7 == rows.group.group) palette = rows.group;
    PatchGroup grid = patch_no_group();
    if (cells_bit >> 7 == rows.group.group) grid = rows.group;
    else if (cells_bit >> 7 == columns.group.group) grid = columns.group;
    uint fold = 0u;
    if (cells >> PATCH_FOLDED_BIT != 0u) fold = patch_bits(map, grid, cells_bit, uint(PATCH_FOLD_HEAD_BITS)) | 0x80000000u;
    return Patch(rows, columns, palette, grid, grid, palette_bit, cells_bit, 1u + (cells >> PATCH_CELL_BITS_BIT & 7u), fold);
}

// Label index of a cell.
uint patch_cell_label(FacadeMap map, INOUT(Patch) opened, uint column, uint row) {
    uint across = opened.columns.count + 1u;
    uint cells_bit = opened.cells_bit;
    if (opened.fold != 0u) {
        uint row_bits = opened.fold & 7u;
        uint column_bits = opened.fold >> 3 & 7u;
        uint rows_bit = cells_bit + uint(PATCH_FOLD_HEAD_BITS);
        uint columns_bit = rows_bit + row_bits * (opened.rows.count + 1u);
        cells_bit = columns_bit + column_bits * across;
        across = 1u + (opened.fold >> 6 & 31u);
        if (row_bits != 0u) row = patch_bits(map, opened.lines, rows_bit + row * row_bits, row_bits);
        if (column_bits != 0u) column = patch_bits(map, opened.lines, columns_bit + column * column_bits, column_bits);
    }
    uint cell = row * across + column;
    uint in_palette = patch_bits(map, opened.cells, cells_bit + cell * opened.cell_bits, opened.cell_bits);
    uint label_bits = patch_label_bits(map);
    uint bit = opened.palette_bit + in_palette * label_bits;
    if (opened.palette.group != bit >> 7 && opened.cells.group == bit >> 7) opened.palette = opened.cells;
    return patch_bits(map, opened.palette, bit, label_bits);
}

PatchPlace patch_texel_place(uint texel) { return PatchPlace(0.0, 0.0, 0.0, float(texel), 0.0, false); }

uint lookup_patch(FacadeMap map, uint x, uint y) {
    bool transposed = patch_is_transposed(map);
    PatchPlace along = patch_texel_place(transposed ? y : x);
    PatchPlace across = patch_texel_place(transposed ? x : y);
    PatchGroup kept = patch_no_group();
    PatchRun band = patch_find(map, kept, patch_bands(map), across);
    PatchRecords stripes = patch_stripes(map, kept, band.index, band.word);
    PatchRun stripe = patch_find(map, kept, stripes, along);
    uint content = patch_stripe_content(map, stripe.word);
    if (content >= patch_label_count(map)) {
        Patch opened = patch_open(map, kept, content - patch_label_count(map));
        uint row = patch_cell(map, opened.rows, across, band.low);
        uint column = patch_cell(map, opened.columns, along, stripe.low);
        content = patch_cell_label(map, opened, column, row);
    }
    return patch_label(map, kept, content);
}

#endif
