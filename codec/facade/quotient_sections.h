// Sections that the quotient and the tiled form share (quotient_layout.h): fields in groups, run breaks with ranks,
// greatest displacements of blocks, and labels as small numbers. Twins: shaders/facade_runs.glsl.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/facade_form.h"
#include "codec/facade/quotient_layout.h"
#include "codec/result.h"

namespace citystream::codec::facade {

inline constexpr uint32_t kGroupWords = 4, kGroupBits = 128;

/// Groups of `count` fields of `bits` (0..32) bits. `dense` fields may cross from one group into the next; others do
/// not, so that each is one load.
uint64_t field_groups(uint64_t count, uint32_t bits, bool dense = false);
void append_fields(std::vector<uint32_t>& words, std::span<const uint32_t> values, uint32_t bits, bool dense = false);
/// The caller has checked that the section lies inside.
uint32_t read_field(std::span<const uint32_t> words, uint64_t group, uint64_t index, uint32_t bits, bool dense = false);

uint32_t break_groups(uint32_t size);
void append_breaks(std::vector<uint32_t>& words, std::span<const uint32_t> breaks);
/// The breaks of an axis, 0 and size included; the groups must lie inside the words. Only the bits are looked at.
std::vector<uint32_t> read_breaks(std::span<const uint32_t> words, uint32_t group, uint32_t size);
/// The run of a texel, from one group.
struct Run {
    uint32_t index, begin, end;
};
Run run_at(std::span<const uint32_t> words, uint32_t group, uint32_t texel);

uint32_t block_groups(uint32_t width, uint32_t height);
/// The runs of one axis and what each of them shows: cells of a class are equal.
struct RunClasses {
    std::span<const uint32_t> breaks, classes;
    uint32_t class_count;
};
/// Bytes of the blocks. `displacements`: rows.class_count x columns.class_count, row by row. O(row classes x columns +
/// column blocks x rows).
std::vector<uint32_t> block_maxima(const RunClasses& columns, const RunClasses& rows,
                                   std::span<const int16_t> displacements, DepthRange depths);

/// Labels as numbers of few bits: displacement in steps above the least, material above it.
struct LabelCode {
    DepthRange depths;
    uint32_t step_mm = 1, displacement_bits = 0, material_bits = 0;

    /// The narrowest code of these labels: the step divides all their displacements above the least.
    static LabelCode for_labels(std::span<const uint32_t> labels, DepthRange depths);
    uint32_t bits() const { return displacement_bits + material_bits; }
    uint32_t number_of(uint32_t label) const;
    /// Any number gives a label; those whose displacement lies above the greatest are open.
    uint32_t label_of(uint32_t number) const;
    friend bool operator==(const LabelCode&, const LabelCode&) = default;
};

/// For readers that write again what they read: whether the words are the same, with the place of the first that is
/// not.
Status check_rewritten(std::span<const uint32_t> words, std::span<const uint32_t> rewritten);

/// The three words that all forms begin with.
void append_form_head(std::vector<uint32_t>& words, FacadeForm form, uint32_t width, uint32_t height,
                      DepthRange depths);

}  // namespace citystream::codec::facade
