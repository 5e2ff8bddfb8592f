// Reading the patch form of a facade map (patch_layout.h): bands, stripes, patches and their parts, and the label of a texel. Words are read
// in aligned groups of four and kept while the next ones lie in the same group. Written for few branches: neighbouring pixels share their
// groups, and a branch costs all of them.
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

// Greatest displacements from their codes: min(most, base + code * stride).
struct PatchMaxima {
    uint bits;  // of a code
    float base;
    float stride;
};

// What the head says, unpacked once a ray.
struct PatchShape {
    uvec2 layer;
    bool is_transposed;
    float most_depth;
    float breadth;  // texels across the bands
    float extent;   // texels along them
    uint bands_at;
    uint bands;
    uint band_words;
    uint y_bits;  // of a band's position
    PatchMaxima band_maxima;
    uint first_bits;
    uint count_bits;
    uint stripes_at;
    uint x_bits;  // of a stripe's position
    uint content_bits;
    PatchMaxima stripe_maxima;
    uint labels;
    uint label_bits;  // of a label's index
    uint labels_bit;  // where the labels begin
    uint least_depth;
    uint depth_unit;
    uint depth_bits;
    uint material_bits;
    uint has_open;
    uint patches_at;
    uint part_bits;
    uint part_shift;  // log2 of the bits that an offset counts
};

void patch_group(uvec2 layer, INOUT(PatchGroup) kept, uint group) {
    if (kept.group != group) {
        kept.words = layer_words4(layer, group);
        kept.group = group;
    }
}

uint patch_word(uvec2 layer, INOUT(PatchGroup) kept, uint index) {
    patch_group(layer, kept, index >> 2);
    return kept.words[index & 3u];
}

// Fields of 0..31 bits.
uint patch_field(uint word, uint bit, uint bits) { return word >> (bit & 31u) & ((1u << bits) - 1u); }

uint patch_bits(uvec2 layer, INOUT(PatchGroup) kept, uint bit, uint bits) {
    patch_group(layer, kept, bit >> 7);
    bool is_upper = (bit & 64u) != 0u;
    bool is_odd = (bit & 32u) != 0u;
    uint even = is_upper ? kept.words.z : kept.words.x;
    uint odd = is_upper ? kept.words.w : kept.words.y;
    uint value = is_odd ? odd : even;
    uint next = is_odd ? kept.words.z : odd;
    if ((bit & 127u) + bits > 128u) next = patch_word(layer, kept, (bit >> 5) + 1u);
    // In two shifts: one of 32 is undefined.
    uint shift = bit & 31u;
    return patch_field(value >> shift | next << (31u - shift) << 1, 0u, bits);
}

uint patch_width(uint greatest) { return greatest == 0u ? 0u : uint(findMSB(greatest)) + 1u; }

PatchMaxima patch_maxima(FacadeMap map, uint bits) {
    if (bits == 0u) return PatchMaxima(0u, map_depth_max(map), 0.0);
    float codes = float((1u << bits) - 1u);
    return PatchMaxima(bits, map_depth_min(map), ceil((map_depth_max(map) - map_depth_min(map)) / codes));
}

PatchShape patch_shape(FacadeMap map) {
    PatchShape shape;
    uint counts = map.head.w;
    uint widths = map.own.x;
    uint fields = map.own.w;
    shape.layer = map.layer;
    shape.is_transposed = (counts >> PATCH_TRANSPOSED_BIT & 1u) != 0u;
    shape.most_depth = map_depth_max(map);
    uint length = shape.is_transposed ? map_height(map) : map_width(map);
    uint breadth = shape.is_transposed ? map_width(map) : map_height(map);
    shape.extent = float(length);
    shape.breadth = float(breadth);
    shape.bands_at = map.own.z;
    shape.bands = counts & uint(PATCH_BAND_COUNT_MASK);
    shape.band_words = 1u + (counts >> PATCH_WIDE_BANDS_BIT & 1u);
    shape.y_bits = patch_width(breadth - 1u);
    shape.band_maxima = patch_maxima(map, patch_field(widths, uint(PATCH_BAND_MAX_WIDTH_BIT), 4u));
    shape.first_bits = patch_field(widths, uint(PATCH_FIRST_WIDTH_BIT), 5u);
    shape.count_bits = patch_field(widths, uint(PATCH_COUNT_WIDTH_BIT), 4u);
    shape.stripes_at = shape.bands_at + shape.bands * shape.band_words;
    shape.x_bits = patch_width(length - 1u);
    shape.content_bits = patch_field(widths, uint(PATCH_CONTENT_WIDTH_BIT), 5u);
    shape.stripe_maxima = patch_maxima(map, patch_field(widths, uint(PATCH_STRIPE_MAX_WIDTH_BIT), 4u));
    shape.labels = counts >> PATCH_LABEL_COUNT_BIT;
    shape.label_bits = patch_width(shape.labels - 1u);
    shape.least_depth = map.head.z;
    shape.depth_unit = fields & 0xffffu;
    shape.depth_bits = patch_field(fields, uint(PATCH_DEPTH_WIDTH_BIT), 5u);
    shape.material_bits = patch_field(fields, uint(PATCH_MATERIAL_WIDTH_BIT), 5u);
    shape.has_open = fields >> PATCH_HAS_OPEN_BIT & 1u;
    shape.labels_bit = 32u * (shape.bands_at - ((shape.labels * (shape.depth_bits + shape.material_bits) + 31u) >> 5));
    shape.patches_at = map.own.y;
    shape.part_bits = patch_field(widths, uint(PATCH_PART_WIDTH_BIT), 4u);
    shape.part_shift = 3u + patch_field(widths, uint(PATCH_UNIT_BIT), 2u);
    return shape;
}

// A label's displacement, as its low half. Without bits there is nothing to read.
uint patch_label_depth(PatchShape shape, INOUT(PatchGroup) kept, uint index) {
    uint code = 0u;
    uint bit = shape.labels_bit + index * (shape.depth_bits + shape.material_bits);
    if (shape.depth_bits != 0u) code = patch_bits(shape.layer, kept, bit, shape.depth_bits);
    if (code < shape.has_open) return uint(FACADE_OPEN_DISPLACEMENT) & 0xffffu;
    return (shape.least_depth + (code - shape.has_open) * shape.depth_unit) & 0xffffu;
}

uint patch_label_material(PatchShape shape, INOUT(PatchGroup) kept, uint index) {
    if (shape.material_bits == 0u) return 0u;
    uint bit = shape.labels_bit + index * (shape.depth_bits + shape.material_bits) + shape.depth_bits;
    return patch_bits(shape.layer, kept, bit, shape.material_bits);
}

// Where a ray is along one axis at some t: in the texel where it came into the volume, or beyond the breaks that it has crossed since.
struct PatchPlace {
    float origin;
    float inverse;  // 1 / direction; 0 where it has not moved along the axis
    bool rises;
    float texel;  // by which it came in
    float t;      // -kNever where it has not moved
    bool with_ties;  // breaks at exactly t have been crossed
    float about;     // where it is, rounded
};

PatchPlace patch_texel_place(float texel) { return PatchPlace(0.0, 0.0, true, texel, -kNever, false, texel); }

// Whether the place is at or above the break.
bool patch_is_past(PatchPlace place, float at) {
    float t = (at - place.origin) * place.inverse;
    bool crossed = t < place.t || (place.with_ties && t == place.t);
    return place.rises ? at <= place.texel || crossed : at <= place.texel && !crossed;
}

// One of a list of records (bands or stripes) whose low bits are rising positions.
struct PatchRun {
    uint index;
    uint word;
    float low;  // texels
    float high;
};

struct PatchRecords {
    uint at;      // word of the first
    uint stride;  // 1 or 2
    uint count;
    uint bits;   // of the position
    float size;  // end of the last
};

float patch_record_low(PatchRecords records, uint word) { return float(patch_field(word, 0u, records.bits)); }

// The record of a place: by a guess from the place, its neighbours, then bisection.
PatchRun patch_find(PatchShape shape, INOUT(PatchGroup) kept, PatchRecords records, PatchPlace place) {
    PatchRun run = PatchRun(0u, 0u, 0.0, records.size);
    uint low = 0u;  // the record is one of low..high - 1, and low - 1 has been read
    uint high = records.count;
    uint probe = min(uint(clamp(place.about / records.size, 0.0, 1.0) * float(records.count)), records.count - 1u);
    for (uint tries = 0u; tries <= records.count; ++tries) {
        // All records of the probe's group.
        uint first = (records.at + probe * records.stride) & ~3u;
        patch_group(shape.layer, kept, first >> 2);
        for (uint i = 0u; i < 4u; ++i) {
            // Wraps round before the list's first word.
            uint word = first + i - records.at;
            uint index = word >> (records.stride - 1u);
            float position = patch_record_low(records, kept.words[i]);
            bool is_record = index < records.count && (word & (records.stride - 1u)) == 0u;
            bool is_past = index == 0u || patch_is_past(place, position);
            if (is_record && is_past && index >= low) {
                run.index = index;
                run.word = kept.words[i];
                run.low = position;
                low = index + 1u;
            }
            if (is_record && !is_past && index < high) {
                run.high = position;
                high = index;
            }
        }
        if (low >= high) break;
        if (tries < 2u) probe = low > 0u && probe < low ? low : high - 1u;
        else probe = (low + high) >> 1;
    }
    return run;
}

PatchRecords patch_bands(PatchShape shape) {
    return PatchRecords(shape.bands_at, shape.band_words, shape.bands, shape.y_bits, shape.breadth);
}

float patch_max(PatchShape shape, PatchMaxima maxima, uint word, uint bit) {
    return min(shape.most_depth, maxima.base + float(patch_field(word, bit, maxima.bits)) * maxima.stride);
}

float patch_band_max(PatchShape shape, uint band_word) { return patch_max(shape, shape.band_maxima, band_word, shape.y_bits); }

// The stripes of a band whose first word was read with `kept`.
PatchRecords patch_stripes(PatchShape shape, INOUT(PatchGroup) kept, uint band, uint band_word) {
    uint word = band_word;
    uint bit = shape.y_bits + shape.band_maxima.bits;
    if (shape.band_words == 2u) {
        word = patch_word(shape.layer, kept, shape.bands_at + 2u * band + 1u);
        bit = 0u;
    }
    return PatchRecords(shape.stripes_at + patch_field(word, bit, shape.first_bits), 1u,
                        1u + patch_field(word, bit + shape.first_bits, shape.count_bits), shape.x_bits, shape.extent);
}

// A label or, from shape.labels on, a patch.
uint patch_stripe_content(PatchShape shape, uint stripe_word) { return patch_field(stripe_word, shape.x_bits, shape.content_bits); }

float patch_stripe_max(PatchShape shape, uint stripe_word) {
    return patch_max(shape, shape.stripe_maxima, stripe_word, shape.x_bits + shape.content_bits);
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

uint patch_part_bit(PatchShape shape, uint offset) { return 32u * uint(PATCH_PARTS_AT) + (offset << shape.part_shift); }

// `kept`: a group that may hold the list.
PatchBreaks patch_breaks(PatchShape shape, PatchGroup kept, uint offset) {
    PatchBreaks breaks = PatchBreaks(kept, patch_part_bit(shape, offset), 0u, 0u);
    uint head = patch_word(shape.layer, breaks.group, breaks.bit >> 5) >> (breaks.bit & 31u);
    breaks.count = head & 31u;
    breaks.bits = uint(PATCH_LEAST_BREAK_BITS) + (head >> 5 & 7u);
    breaks.bit = breaks.bit + 8u;
    return breaks;
}

// Inner break `index` from the patch's corner.
float patch_break(PatchShape shape, INOUT(PatchBreaks) breaks, uint index) {
    return float(patch_bits(shape.layer, breaks.group, breaks.bit + index * breaks.bits, breaks.bits));
}

// The cell of a place along one axis; `corner`: of the patch.
uint patch_cell(PatchShape shape, INOUT(PatchBreaks) breaks, PatchPlace place, float corner) {
    uint low = 0u;
    uint high = breaks.count;
    while (low < high) {
        uint middle = (low + high) >> 1;
        if (patch_is_past(place, corner + patch_break(shape, breaks, middle))) low = middle + 1u;
        else high = middle;
    }
    return low;
}

// Parts of a patch often share groups.
Patch patch_open(PatchShape shape, INOUT(PatchGroup) kept, uint index) {
    uint bits = shape.part_bits;
    bool wide = bits > uint(PATCH_NARROW_PART_BITS);
    uint at = shape.patches_at + (wide ? 2u * index : index);
    uint lists = patch_word(shape.layer, kept, at);
    uint cells = wide ? patch_word(shape.layer, kept, at + 1u) : lists;
    uint cells_field = wide ? 0u : 2u * bits;
    PatchBreaks rows = patch_breaks(shape, patch_no_group(), patch_field(lists, 0u, bits));
    PatchBreaks columns = patch_breaks(shape, rows.group, patch_field(lists, bits, bits));
    uint palette_bit = patch_part_bit(shape, patch_field(cells, cells_field, bits));
    uint cells_bit = patch_part_bit(shape, patch_field(cells, cells_field + bits, bits));
    PatchGroup palette = patch_no_group();
    if (palette_bit >> 7 == columns.group.group) palette = columns.group;
    else if (palette_bit >> 7 == rows.group.group) palette = rows.group;
    PatchGroup grid = patch_no_group();
    if (cells_bit >> 7 == rows.group.group) grid = rows.group;
    else if (cells_bit >> 7 == columns.group.group) grid = columns.group;
    uint fold = 0u;
    if (cells >> PATCH_FOLDED_BIT != 0u) fold = patch_bits(shape.layer, grid, cells_bit, uint(PATCH_FOLD_HEAD_BITS)) | 0x80000000u;
    return Patch(rows, columns, palette, grid, grid, palette_bit, cells_bit, 1u + (cells >> PATCH_CELL_BITS_BIT & 7u), fold);
}

// Label index of a cell.
uint patch_cell_label(PatchShape shape, INOUT(Patch) opened, uint column, uint row) {
    uint across = opened.columns.count + 1u;
    uint cells_bit = opened.cells_bit;
    if (opened.fold != 0u) {
        uint row_bits = opened.fold & 7u;
        uint column_bits = opened.fold >> 3 & 7u;
        uint rows_bit = cells_bit + uint(PATCH_FOLD_HEAD_BITS);
        uint columns_bit = rows_bit + row_bits * (opened.rows.count + 1u);
        cells_bit = columns_bit + column_bits * across;
        across = 1u + (opened.fold >> 6 & 31u);
        if (row_bits != 0u) row = patch_bits(shape.layer, opened.lines, rows_bit + row * row_bits, row_bits);
        if (column_bits != 0u) column = patch_bits(shape.layer, opened.lines, columns_bit + column * column_bits, column_bits);
    }
    uint cell = row * across + column;
    uint in_palette = patch_bits(shape.layer, opened.cells, cells_bit + cell * opened.cell_bits, opened.cell_bits);
    uint bit = opened.palette_bit + in_palette * shape.label_bits;
    if (opened.palette.group != bit >> 7 && opened.cells.group == bit >> 7) opened.palette = opened.cells;
    return patch_bits(shape.layer, opened.palette, bit, shape.label_bits);
}

uint lookup_patch(FacadeMap map, uint x, uint y) {
    PatchShape shape = patch_shape(map);
    PatchPlace along = patch_texel_place(float(shape.is_transposed ? y : x));
    PatchPlace across = patch_texel_place(float(shape.is_transposed ? x : y));
    PatchGroup kept = patch_no_group();
    PatchRun band = patch_find(shape, kept, patch_bands(shape), across);
    PatchRecords stripes = patch_stripes(shape, kept, band.index, band.word);
    PatchRun stripe = patch_find(shape, kept, stripes, along);
    uint content = patch_stripe_content(shape, stripe.word);
    if (content >= shape.labels) {
        Patch opened = patch_open(shape, kept, content - shape.labels);
        uint row = patch_cell(shape, opened.rows, across, band.low);
        uint column = patch_cell(shape, opened.columns, along, stripe.low);
        content = patch_cell_label(shape, opened, column, row);
    }
    return patch_label_depth(shape, kept, content) | patch_label_material(shape, kept, content) << 16;
}

#endif
