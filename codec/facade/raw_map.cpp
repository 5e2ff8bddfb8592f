#include "codec/facade/raw_map.h"

#include "codec/facade/distinct_matrix.h"
#include "codec/facade/raw_layout.h"
#include "codec/facade/texel_form.h"

namespace citystream::codec::facade {

namespace {

struct RawSections {
    FormHead head;
    uint32_t material_bits = 0, box_index_bits = 0, box_count = 0;
    uint32_t displacements = 0, materials = 0, box_indices = 0, boxes = 0;
    uint64_t texels = 0;
};

RawSections read_sections(std::span<const uint32_t> words, const FormHead& head) {
    return {head,
            words[FACADE_RAW_WORD_BITS] & 0xffU,
            words[FACADE_RAW_WORD_BITS] >> 8,
            words[FACADE_RAW_WORD_BOX_COUNT],
            words[FACADE_RAW_WORD_DISPLACEMENTS],
            words[FACADE_RAW_WORD_MATERIALS],
            words[FACADE_RAW_WORD_BOX_INDICES],
            words[FACADE_RAW_WORD_BOXES],
            uint64_t{head.width} * head.height};
}

/// That the sections are where the encoder puts them and end with the words.
Status check_sections(std::span<const uint32_t> words, const RawSections& map) {
    if (map.material_bits != 8 && map.material_bits != 16)
        return error_at_word("raw facade map with materials of " + std::to_string(map.material_bits) + " bits",
                             FACADE_RAW_WORD_BITS);
    if (map.box_index_bits != 0 && map.box_index_bits != 16 && map.box_index_bits != 32)
        return error_at_word("raw facade map with box indices of " + std::to_string(map.box_index_bits) + " bits",
                             FACADE_RAW_WORD_BITS);
    const uint64_t materials = FACADE_RAW_HEADER_WORDS + padded_to_group(packed_words(map.texels, 16));
    const uint64_t box_indices = materials + padded_to_group(packed_words(map.texels, map.material_bits));
    const uint64_t boxes = box_indices + padded_to_group(packed_words(map.texels, map.box_index_bits));
    if (map.displacements != FACADE_RAW_HEADER_WORDS || map.materials != materials || map.box_indices != box_indices ||
        map.boxes != boxes)
        return error_at_word("sections of a raw facade map are not in their places", FACADE_RAW_WORD_DISPLACEMENTS);
    if ((map.box_count == 0) != (map.box_index_bits == 0))
        return error_at_word("raw facade map with boxes or box indices alone", FACADE_RAW_WORD_BOX_COUNT);
    if (words.size() != boxes + uint64_t{map.box_count} * FACADE_BOX_WORDS)
        return error_at_word("raw facade map has " + std::to_string(words.size()) + " words, not as many as it says",
                             words.size());
    return Done{};
}

/// That every texel's index names a box around it.
Status check_box_indices(std::span<const uint32_t> words, const RawSections& map) {
    uint64_t i = 0;
    uint32_t last = UINT32_MAX;  // neighbours mostly have the same box
    FreeBox box;
    for (uint32_t y = 0; y < map.head.height; ++y) {
        for (uint32_t x = 0; x < map.head.width; ++x, ++i) {
            const uint32_t index = packed_entry(words, map.box_indices, map.box_index_bits, i);
            const uint64_t at = map.box_indices + (i * map.box_index_bits >> 5);
            if (index >= map.box_count) return error_at_word("free box that does not exist", at);
            if (index != last) box = read_box(words, map.boxes, index);
            last = index;
            if (x < box.x0 || x >= box.x1 || y < box.y0 || y >= box.y1)
                return error_at_word("texel outside its free box", at);
        }
    }
    return Done{};
}

uint64_t texel_index(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    return uint64_t{y} * (words[FACADE_FORM_WORD_SIZE] & 0xffffU) + x;
}

}  // namespace

Result<std::vector<uint32_t>> encode_raw_map(const RunGrid& grid, bool with_boxes) {
    std::vector<uint32_t> words = begin_form(FacadeForm::kRaw, grid, FACADE_RAW_HEADER_WORDS);
    const FreeBoxes free = with_boxes ? grow_free_boxes(grid) : FreeBoxes{};
    const uint32_t bits = material_bits(grid), index_bits = with_boxes ? box_index_bits(free.boxes.size()) : 0;
    words[FACADE_RAW_WORD_BITS] = bits | index_bits << 8;
    words[FACADE_RAW_WORD_DISPLACEMENTS] = append_packed(words, expand_cells(grid, grid.labels), 16);
    words[FACADE_RAW_WORD_MATERIALS] = append_packed(words, expand_cells(grid, material_values(grid)), bits);
    words[FACADE_RAW_WORD_BOX_INDICES] = static_cast<uint32_t>(words.size());
    if (with_boxes) append_packed(words, expand_cells(grid, free.box_index), index_bits);
    words[FACADE_RAW_WORD_BOXES] = append_boxes(words, free.boxes);
    words[FACADE_RAW_WORD_BOX_COUNT] = static_cast<uint32_t>(free.boxes.size());
    return words;
}

uint64_t raw_map_bytes(const RunGrid& grid, uint64_t box_count) {
    const uint64_t texels = uint64_t{grid.width()} * grid.height();
    uint64_t words = FACADE_RAW_HEADER_WORDS + box_count * FACADE_BOX_WORDS;
    for (const uint32_t bits : {16U, material_bits(grid), box_index_bits(box_count)})
        words += padded_to_group(packed_words(texels, bits));
    return words * sizeof(uint32_t);
}

Status check_raw_map(std::span<const uint32_t> words) {
    const auto head = check_form_head(words, FacadeForm::kRaw, FACADE_RAW_HEADER_WORDS);
    if (!head) return head.error();
    const RawSections map = read_sections(words, *head);
    if (Status status = check_sections(words, map); !status) return status;
    if (Status status = check_depth_range(words, map.displacements, *head); !status) return status;
    if (map.box_count == 0) return Done{};
    if (Status status = check_boxes(words, map.boxes, map.box_count, *head); !status) return status;
    return check_box_indices(words, map);
}

Result<RunGrid> decode_raw_map(std::span<const uint32_t> words) {
    if (Status status = check_raw_map(words); !status) return status.error();
    const RawSections map = read_sections(words, *read_form_head(words));
    return unpack_matrices(words, map.head, map.displacements, map.materials, map.material_bits);
}

uint32_t raw_label(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const uint64_t i = texel_index(words, x, y);
    const uint32_t bits = words[FACADE_RAW_WORD_BITS] & 0xffU;
    return packed_entry(words, words[FACADE_RAW_WORD_DISPLACEMENTS], 16, i) |
           packed_entry(words, words[FACADE_RAW_WORD_MATERIALS], bits, i) << 16;
}

uint32_t raw_box_count(std::span<const uint32_t> words) {
    return words[FACADE_RAW_WORD_BOX_COUNT];
}

FreeBox raw_box(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const uint32_t index = packed_entry(words, words[FACADE_RAW_WORD_BOX_INDICES], words[FACADE_RAW_WORD_BITS] >> 8,
                                        texel_index(words, x, y));
    return read_box(words, words[FACADE_RAW_WORD_BOXES], index);
}

}  // namespace citystream::codec::facade
