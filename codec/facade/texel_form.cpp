#include "codec/facade/texel_form.h"

#include <algorithm>

#include "codec/facade/raw_layout.h"

namespace citystream::codec::facade {

std::vector<uint32_t> begin_form(FacadeForm form, const RunGrid& grid, size_t header_words) {
    std::vector<uint32_t> words(header_words, 0);
    const DepthRange depths = grid.depths();
    words[FACADE_FORM_WORD_FORM] = FACADE_FORM_MAGIC | static_cast<uint32_t>(form) << 16;
    words[FACADE_FORM_WORD_SIZE] = grid.width() | grid.height() << 16;
    words[FACADE_FORM_WORD_DEPTHS] =
        (static_cast<uint32_t>(depths.min_mm) & 0xffffU) | static_cast<uint32_t>(depths.max_mm) << 16;
    return words;
}

Result<FormHead> check_form_head(std::span<const uint32_t> words, FacadeForm form, size_t header_words) {
    auto head = read_form_head(words);
    if (!head) return head.error();
    if (head->form != form)
        return error_at_word("facade map has the form " + std::string(form_name(head->form)) + ", expected is " +
                                 std::string(form_name(form)),
                             FACADE_FORM_WORD_FORM);
    if (words.size() < header_words) return error_at_word("facade map ends within its header", words.size());
    return head;
}

uint32_t append_packed(std::vector<uint32_t>& words, std::span<const uint32_t> entries, uint32_t bits) {
    const size_t first = words.size();
    words.resize(first + padded_to_group(packed_words(entries.size(), bits)), 0);
    const uint32_t mask = bits == 32 ? UINT32_MAX : (1U << bits) - 1;
    for (size_t i = 0; i < entries.size(); ++i)
        words[first + (i * bits >> 5)] |= (entries[i] & mask) << (i * bits & 31);
    return static_cast<uint32_t>(first);
}

std::vector<uint32_t> expand_cells(const RunGrid& grid, std::span<const uint32_t> cell_values) {
    std::vector<uint32_t> texels(size_t{grid.width()} * grid.height());
    const size_t width = grid.width();
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        const size_t first = grid.y_breaks[row] * width;
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            std::fill(&texels[first] + grid.x_breaks[column], &texels[first] + grid.x_breaks[column + 1],
                      cell_values[size_t{row} * grid.columns() + column]);
        }
        for (size_t y = grid.y_breaks[row] + 1; y < grid.y_breaks[row + 1]; ++y)
            std::copy_n(&texels[first], width, &texels[y * width]);
    }
    return texels;
}

uint32_t material_bits(const RunGrid& grid) {
    const bool fits_byte =
        std::all_of(grid.labels.begin(), grid.labels.end(), [](uint32_t label) { return material_of(label) < 256; });
    return fits_byte ? 8 : 16;
}

uint32_t append_boxes(std::vector<uint32_t>& words, std::span<const FreeBox> boxes) {
    const size_t first = words.size();
    words.reserve(first + boxes.size() * FACADE_BOX_WORDS);
    for (const FreeBox& box : boxes) {
        words.push_back(box.x0 | box.x1 << 16);
        words.push_back(box.y0 | box.y1 << 16);
    }
    return static_cast<uint32_t>(first);
}

FreeBox read_box(std::span<const uint32_t> words, uint32_t first, uint32_t index) {
    const size_t at = first + size_t{index} * FACADE_BOX_WORDS;
    const uint32_t x = words[at + FACADE_BOX_WORD_X], y = words[at + FACADE_BOX_WORD_Y];
    return {x & 0xffffU, x >> 16, y & 0xffffU, y >> 16};
}

Status check_boxes(std::span<const uint32_t> words, uint32_t first, uint32_t count, const FormHead& head) {
    for (uint32_t i = 0; i < count; ++i) {
        const FreeBox box = read_box(words, first, i);
        if (box.x0 >= box.x1 || box.x1 > head.width || box.y0 >= box.y1 || box.y1 > head.height)
            return error_at_word("free box " + std::to_string(i) + " is empty or leaves the facade",
                                 first + uint64_t{i} * FACADE_BOX_WORDS);
    }
    return Done{};
}

Status check_depth_range(std::span<const uint32_t> words, uint32_t displacements, const FormHead& head) {
    DepthRange found{INT32_MAX, INT32_MIN};
    for (uint64_t i = 0; i < uint64_t{head.width} * head.height; ++i) {
        const int32_t depth = displacement_of(packed_entry(words, displacements, 16, i));
        if (depth == kOpenDisplacement) continue;
        found.min_mm = std::min(found.min_mm, depth);
        found.max_mm = std::max(found.max_mm, depth);
    }
    if (found.min_mm > found.max_mm) found = {};
    if (found != head.depths)
        return error_at_word("facade map states another depth range than it has", FACADE_FORM_WORD_DEPTHS);
    return Done{};
}

Result<RunGrid> unpack_matrices(std::span<const uint32_t> words, const FormHead& head, uint32_t displacements,
                                uint32_t materials, uint32_t material_entry_bits) {
    const uint64_t texels = uint64_t{head.width} * head.height;
    FacadeMatrices matrices{head.width, head.height, std::vector<int16_t>(texels), std::vector<uint16_t>(texels)};
    for (uint64_t i = 0; i < texels; ++i) {
        matrices.displacement_mm[i] = static_cast<int16_t>(packed_entry(words, displacements, 16, i));
        matrices.material[i] = static_cast<uint16_t>(packed_entry(words, materials, material_entry_bits, i));
    }
    return make_run_grid(matrices);
}

WordAllowance::WordAllowance(const RunGrid& grid, uint32_t most_times_raw)
    : texels_(uint64_t{grid.width()} * grid.height()), most_times_raw_(most_times_raw) {
    constexpr uint64_t kMostWords = uint64_t{1} << 31;
    for (const uint32_t bits : {16U, material_bits(grid), 32U}) words_ += packed_words(texels_, bits) * most_times_raw_;
    words_ = std::min(words_, kMostWords);
}

void WordAllowance::set_box_count(uint64_t count) {
    const uint64_t saved = packed_words(texels_, 32) - packed_words(texels_, box_index_bits(count));
    words_ -= std::min(words_, saved * most_times_raw_);
}

Error error_at_word(std::string message, uint64_t word) {
    return Error{std::move(message), word * sizeof(uint32_t)};
}

}  // namespace citystream::codec::facade
