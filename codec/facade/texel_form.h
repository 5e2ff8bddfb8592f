// What the forms that are looked up by texel share (raw, maximum mips, singular value and binary factors): their head,
// matrices packed at 8, 16 or 32 bits an entry, and boxes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "codec/facade/facade_form.h"
#include "codec/facade/free_boxes.h"
#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// `header_words` words: the common head of the map, then zeros.
std::vector<uint32_t> begin_form(FacadeForm form, const RunGrid& grid, size_t header_words);

/// Reads the head of a map that must have this form and at least `header_words` words.
Result<FormHead> check_form_head(std::span<const uint32_t> words, FacadeForm form, size_t header_words);

constexpr uint64_t padded_to_group(uint64_t words) {
    return (words + 3) & ~uint64_t{3};
}

/// Words that `count` entries of 8, 16 or 32 bits take.
constexpr uint64_t packed_words(uint64_t count, uint32_t bits) {
    return (count * bits + 31) / 32;
}

/// Entry of a packed matrix that begins at word `first`.
constexpr uint32_t packed_entry(std::span<const uint32_t> words, uint32_t first, uint32_t bits, uint64_t index) {
    const uint64_t bit = index * bits;
    const uint32_t word = words[first + (bit >> 5)] >> (bit & 31);
    return bits == 32 ? word : word & ((1U << bits) - 1);
}

/// Appends the entries (of which the low bits count) and zeros up to a group of 4 words. Returns the first word.
uint32_t append_packed(std::vector<uint32_t>& words, std::span<const uint32_t> entries, uint32_t bits);

/// One value a cell -> one value a texel, row by row from the bottom.
std::vector<uint32_t> expand_cells(const RunGrid& grid, std::span<const uint32_t> cell_values);

/// Bits of an entry of a packed matrix of materials (8, 16) or box indices (16, 32).
uint32_t material_bits(const RunGrid& grid);
constexpr uint32_t box_index_bits(uint64_t box_count) {
    return box_count <= 65536 ? 16 : 32;
}

/// Words that the factors of D, M and A may take together: those of the raw form times a factor, and never so many that
/// a section's first word would not fit its field.
class WordAllowance {
  public:
    WordAllowance(const RunGrid& grid, uint32_t most_times_raw);
    /// Once the boxes are known: box indices of the raw form may be shorter than assumed.
    void set_box_count(uint64_t count);
    /// Precondition: words <= words().
    void take(uint64_t words) { words_ -= words; }
    uint64_t words() const { return words_; }

  private:
    uint64_t texels_, most_times_raw_, words_ = 0;
};

/// Appends the records of FACADE_BOX_WORDS. Returns the first word.
uint32_t append_boxes(std::vector<uint32_t>& words, std::span<const FreeBox> boxes);
FreeBox read_box(std::span<const uint32_t> words, uint32_t first, uint32_t index);
/// That the boxes are not empty and lie in the map. The records must lie in the words.
Status check_boxes(std::span<const uint32_t> words, uint32_t first, uint32_t count, const FormHead& head);

/// That the packed displacements have the depth range that the head states. The matrix must lie in the words.
Status check_depth_range(std::span<const uint32_t> words, uint32_t displacements, const FormHead& head);
/// The coarsest grid of packed displacements and materials. Both matrices must lie in the words.
Result<RunGrid> unpack_matrices(std::span<const uint32_t> words, const FormHead& head, uint32_t displacements,
                                uint32_t materials, uint32_t material_entry_bits);

/// An error at a word of the input.
Error error_at_word(std::string message, uint64_t word);

}  // namespace citystream::codec::facade
