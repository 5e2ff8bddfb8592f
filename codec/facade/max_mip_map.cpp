#include "codec/facade/max_mip_map.h"

#include <algorithm>
#include <string>

#include "codec/facade/distinct_matrix.h"
#include "codec/facade/max_mip_layout.h"
#include "codec/facade/texel_form.h"

namespace citystream::codec::facade {

namespace {

static_assert(kMaxFacadeSide == 1U << (FACADE_MAX_MIP_MOST_LEVELS - 1));
static_assert(FACADE_MAX_MIP_WORD_LEVELS + FACADE_MAX_MIP_MOST_LEVELS <= FACADE_MAX_MIP_HEADER_WORDS);

struct Level {
    uint32_t width = 0, height = 0;
    uint64_t first = 0;  ///< word
};

constexpr uint32_t halved(uint32_t length) {
    return (length + 1) / 2;
}

/// Sizes and places of the levels, 1 x 1 last.
std::vector<Level> pyramid_of(uint32_t width, uint32_t height) {
    std::vector<Level> levels = {{width, height, FACADE_MAX_MIP_HEADER_WORDS}};
    while (levels.back().width > 1 || levels.back().height > 1) {
        const Level& finer = levels.back();
        const uint64_t words = packed_words(uint64_t{finer.width} * finer.height, 16);
        levels.push_back({halved(finer.width), halved(finer.height), finer.first + padded_to_group(words)});
    }
    return levels;
}

uint64_t end_of(const Level& level) {
    return level.first + padded_to_group(packed_words(uint64_t{level.width} * level.height, 16));
}

int32_t entry(std::span<const uint32_t> words, const Level& level, uint32_t x, uint32_t y) {
    const uint64_t index = uint64_t{y} * level.width + x;
    return displacement_of(packed_entry(words, static_cast<uint32_t>(level.first), 16, index));
}

/// Maximum of the up to four entries below entry (x, y) of the next level.
int32_t maximum_of_four(std::span<const uint32_t> words, const Level& finer, uint32_t x, uint32_t y) {
    int32_t maximum = INT16_MIN;
    for (uint32_t v = 2 * y; v < std::min(2 * y + 2, finer.height); ++v) {
        for (uint32_t u = 2 * x; u < std::min(2 * x + 2, finer.width); ++u)
            maximum = std::max(maximum, entry(words, finer, u, v));
    }
    return maximum;
}

Status check_sections(std::span<const uint32_t> words, const std::vector<Level>& levels, const FormHead& head) {
    const uint32_t bits = words[FACADE_MAX_MIP_WORD_BITS] & 0xffU;
    if ((bits != 8 && bits != 16) || words[FACADE_MAX_MIP_WORD_BITS] >> 8 != levels.size())
        return error_at_word("maximum mip map with a wrong number of levels or bits", FACADE_MAX_MIP_WORD_BITS);
    for (uint32_t k = 0; k < levels.size(); ++k) {
        if (words[FACADE_MAX_MIP_WORD_LEVELS + k] != levels[k].first)
            return error_at_word("level " + std::to_string(k) + " of a maximum mip map is not in its place",
                                 FACADE_MAX_MIP_WORD_LEVELS + k);
    }
    const uint64_t materials = end_of(levels.back());
    if (words[FACADE_MAX_MIP_WORD_MATERIALS] != materials)
        return error_at_word("materials of a maximum mip map are not in their place", FACADE_MAX_MIP_WORD_MATERIALS);
    const uint64_t end = materials + padded_to_group(packed_words(uint64_t{head.width} * head.height, bits));
    if (words.size() != end)
        return error_at_word(
            "maximum mip map has " + std::to_string(words.size()) + " words, its sections " + std::to_string(end),
            words.size());
    return Done{};
}

Status check_maxima(std::span<const uint32_t> words, const std::vector<Level>& levels) {
    for (size_t k = 1; k < levels.size(); ++k) {
        for (uint32_t y = 0; y < levels[k].height; ++y) {
            for (uint32_t x = 0; x < levels[k].width; ++x) {
                if (entry(words, levels[k], x, y) == maximum_of_four(words, levels[k - 1], x, y)) continue;
                return error_at_word("entry of level " + std::to_string(k) + " of a maximum mip map is no maximum",
                                     levels[k].first + (uint64_t{y} * levels[k].width + x) / 2);
            }
        }
    }
    return Done{};
}

}  // namespace

Result<std::vector<uint32_t>> encode_max_mip_map(const RunGrid& grid) {
    std::vector<uint32_t> words = begin_form(FacadeForm::kMaxMip, grid, FACADE_MAX_MIP_HEADER_WORDS);
    const std::vector<Level> levels = pyramid_of(grid.width(), grid.height());
    const uint32_t bits = material_bits(grid);
    words[FACADE_MAX_MIP_WORD_BITS] = bits | static_cast<uint32_t>(levels.size()) << 8;
    words[FACADE_MAX_MIP_WORD_LEVELS] = append_packed(words, expand_cells(grid, grid.labels), 16);
    for (size_t k = 1; k < levels.size(); ++k) {
        std::vector<uint32_t> maxima;
        maxima.reserve(size_t{levels[k].width} * levels[k].height);
        for (uint32_t y = 0; y < levels[k].height; ++y) {
            for (uint32_t x = 0; x < levels[k].width; ++x)
                maxima.push_back(static_cast<uint32_t>(maximum_of_four(words, levels[k - 1], x, y)));
        }
        words[FACADE_MAX_MIP_WORD_LEVELS + k] = append_packed(words, maxima, 16);
    }
    words[FACADE_MAX_MIP_WORD_MATERIALS] = append_packed(words, expand_cells(grid, material_values(grid)), bits);
    return words;
}

Status check_max_mip_map(std::span<const uint32_t> words) {
    const auto head = check_form_head(words, FacadeForm::kMaxMip, FACADE_MAX_MIP_HEADER_WORDS);
    if (!head) return head.error();
    const std::vector<Level> levels = pyramid_of(head->width, head->height);
    if (Status status = check_sections(words, levels, *head); !status) return status;
    if (Status status = check_maxima(words, levels); !status) return status;
    return check_depth_range(words, FACADE_MAX_MIP_HEADER_WORDS, *head);
}

Result<RunGrid> decode_max_mip_map(std::span<const uint32_t> words) {
    if (Status status = check_max_mip_map(words); !status) return status.error();
    const FormHead head = *read_form_head(words);
    return unpack_matrices(words, head, FACADE_MAX_MIP_HEADER_WORDS, words[FACADE_MAX_MIP_WORD_MATERIALS],
                           words[FACADE_MAX_MIP_WORD_BITS] & 0xffU);
}

uint32_t max_mip_label(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const uint64_t i = uint64_t{y} * (words[FACADE_FORM_WORD_SIZE] & 0xffffU) + x;
    const uint32_t bits = words[FACADE_MAX_MIP_WORD_BITS] & 0xffU;
    return packed_entry(words, words[FACADE_MAX_MIP_WORD_LEVELS], 16, i) |
           packed_entry(words, words[FACADE_MAX_MIP_WORD_MATERIALS], bits, i) << 16;
}

int32_t max_mip_maximum(std::span<const uint32_t> words, uint32_t level, uint32_t x, uint32_t y) {
    const uint32_t width = words[FACADE_FORM_WORD_SIZE] & 0xffffU;
    const uint64_t i = uint64_t{y} * ((width + (1U << level) - 1) >> level) + x;
    return displacement_of(packed_entry(words, words[FACADE_MAX_MIP_WORD_LEVELS + level], 16, i));
}

}  // namespace citystream::codec::facade
