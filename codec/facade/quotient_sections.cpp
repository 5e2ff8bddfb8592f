#include "codec/facade/quotient_sections.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <string>

#include "codec/bits/bit_stream.h"

namespace citystream::codec::facade {

namespace {

constexpr uint32_t kBlockSide = 1u << BLOCK_LOG2;

/// Where field `index` begins, in bits after the section's beginning.
uint64_t field_bit(uint64_t index, uint32_t bits, bool dense) {
    if (dense || bits == 0) return index * bits;
    const uint64_t in_group = kGroupBits / bits;
    return index / in_group * kGroupBits + index % in_group * bits;
}

uint32_t blocks_of(uint32_t size) {
    return (size + kBlockSide - 1) / kBlockSide;
}

struct BreakGroup {
    uint32_t word[kGroupWords] = {};
};

/// The words of the group of texels first .. first + RUN_GROUP_TEXELS - 1. `next`: index of the first break not before.
BreakGroup break_group(std::span<const uint32_t> breaks, uint32_t first, uint32_t& next) {
    BreakGroup group;
    const uint32_t rank = next, before = next == 0 ? 0 : breaks[next - 1];
    for (; next + 1 < breaks.size() && breaks[next] < first + RUN_GROUP_TEXELS; ++next) {
        const uint32_t bit = breaks[next] - first;
        group.word[bit / 32] |= 1u << bit % 32;
    }
    const uint32_t behind = breaks[next];
    group.word[2] |= behind >> RUN_BEHIND_LOW_BITS << RUN_BEHIND_HIGH_BIT;
    group.word[3] = rank | before << RUN_BEFORE_BIT | behind << RUN_BEHIND_LOW_BIT;
    return group;
}

}  // namespace

uint64_t field_groups(uint64_t count, uint32_t bits, bool dense) {
    if (bits == 0 || count == 0) return 0;
    return field_bit(count - 1, bits, dense) / kGroupBits + 1 +
           ((field_bit(count - 1, bits, dense) % kGroupBits + bits) > kGroupBits ? 1 : 0);
}

void append_fields(std::vector<uint32_t>& words, std::span<const uint32_t> values, uint32_t bits, bool dense) {
    assert(words.size() % kGroupWords == 0);
    const size_t first = words.size();
    words.resize(first + field_groups(values.size(), bits, dense) * kGroupWords, 0);
    for (size_t i = 0; bits > 0 && i < values.size(); ++i) {
        const uint64_t bit = field_bit(i, bits, dense);
        const uint64_t shifted = uint64_t{values[i]} << bit % 32;
        words[first + bit / 32] |= static_cast<uint32_t>(shifted);
        if (bit % 32 + bits > 32) words[first + bit / 32 + 1] |= static_cast<uint32_t>(shifted >> 32);
    }
}

uint32_t read_field(std::span<const uint32_t> words, uint64_t group, uint64_t index, uint32_t bits, bool dense) {
    return bits::read_bits(words, group * kGroupBits + field_bit(index, bits, dense), bits);
}

uint32_t break_groups(uint32_t size) {
    return (size + RUN_GROUP_TEXELS - 1) / RUN_GROUP_TEXELS;
}

void append_breaks(std::vector<uint32_t>& words, std::span<const uint32_t> breaks) {
    uint32_t next = 0;
    for (uint32_t first = 0; first < breaks.back(); first += RUN_GROUP_TEXELS) {
        const BreakGroup group = break_group(breaks, first, next);
        words.insert(words.end(), std::begin(group.word), std::end(group.word));
    }
}

std::vector<uint32_t> read_breaks(std::span<const uint32_t> words, uint32_t group, uint32_t size) {
    std::vector<uint32_t> breaks = {0};
    for (uint32_t texel = 1; texel < size; ++texel) {
        const uint32_t bit = texel % RUN_GROUP_TEXELS;
        const uint32_t word = (group + texel / RUN_GROUP_TEXELS) * kGroupWords + bit / 32;
        if ((words[word] >> bit % 32 & 1) != 0) breaks.push_back(texel);
    }
    breaks.push_back(size);
    return breaks;
}

Run run_at(std::span<const uint32_t> words, uint32_t group, uint32_t texel) {
    const uint32_t first = texel / RUN_GROUP_TEXELS * RUN_GROUP_TEXELS, at = texel - first;
    const uint32_t* word = &words[size_t{group + texel / RUN_GROUP_TEXELS} * kGroupWords];
    Run run = {(word[3] & ((1u << RUN_RANK_BITS) - 1)) - 1, word[3] >> RUN_BEFORE_BIT & ((1u << RUN_RANK_BITS) - 1),
               word[3] >> RUN_BEHIND_LOW_BIT | word[2] >> RUN_BEHIND_HIGH_BIT << RUN_BEHIND_LOW_BITS};
    for (uint32_t bit = RUN_GROUP_TEXELS; bit-- > 0;) {
        if ((word[bit / 32] >> bit % 32 & 1) == 0) continue;
        if (bit > at) {
            run.end = first + bit;
            continue;
        }
        if (run.begin < first + bit) run.begin = first + bit;
        ++run.index;
    }
    return run;
}

uint32_t block_groups(uint32_t width, uint32_t height) {
    return (blocks_of(width) * blocks_of(height) + 15) / 16;
}

namespace {

/// Calls visit(block, class) for each class that shows in each block of an axis, once.
template <typename Visit>
void for_each_class_of_blocks(const RunClasses& axis, Visit visit) {
    const uint32_t blocks = blocks_of(axis.breaks.back());
    std::vector<uint32_t> seen_in(axis.class_count, ~0u);
    size_t run = 0;
    for (uint32_t block = 0; block < blocks; ++block) {
        while (axis.breaks[run + 1] <= block * kBlockSide) ++run;
        for (size_t r = run; r < axis.classes.size() && axis.breaks[r] < (block + 1) * kBlockSide; ++r) {
            if (std::exchange(seen_in[axis.classes[r]], block) != block) visit(block, axis.classes[r]);
        }
    }
}

}  // namespace

std::vector<uint32_t> block_maxima(const RunClasses& columns, const RunClasses& rows,
                                   std::span<const int16_t> displacements, DepthRange depths) {
    const uint32_t across = blocks_of(columns.breaks.back()), up = blocks_of(rows.breaks.back());
    // Open cells, as the least number of all, never are the greatest.
    std::vector<int16_t> of_rows(size_t{rows.class_count} * across, kOpenDisplacement);
    for_each_class_of_blocks(columns, [&](uint32_t block, uint32_t column) {
        for (size_t row = 0; row < rows.class_count; ++row) {
            int16_t& greatest = of_rows[row * across + block];
            greatest = std::max(greatest, displacements[row * columns.class_count + column]);
        }
    });
    std::vector<int16_t> greatest(size_t{across} * up, kOpenDisplacement);
    for_each_class_of_blocks(rows, [&](uint32_t block, uint32_t row) {
        for (size_t x = 0; x < across; ++x) {
            int16_t& here = greatest[block * size_t{across} + x];
            here = std::max(here, of_rows[size_t{row} * across + x]);
        }
    });
    const int32_t step = (depths.max_mm - depths.min_mm + BLOCK_MAX_LEVELS - 1) / BLOCK_MAX_LEVELS;
    std::vector<uint32_t> levels;
    levels.reserve(greatest.size());
    for (const int32_t depth : greatest)
        levels.push_back(depth <= depths.min_mm ? 0 : static_cast<uint32_t>((depth - depths.min_mm + step - 1) / step));
    return levels;
}

LabelCode LabelCode::for_labels(std::span<const uint32_t> labels, DepthRange depths) {
    uint32_t step = 0, material = 0, open = 0;
    for (const uint32_t label : labels) {
        material = std::max(material, material_of(label));
        if (displacement_of(label) == kOpenDisplacement)
            open = 1;
        else
            step = std::gcd(step, static_cast<uint32_t>(displacement_of(label) - depths.min_mm));
    }
    step = std::max(step, 1u);
    const uint32_t most = static_cast<uint32_t>(depths.max_mm - depths.min_mm) / step + open;
    return {depths, step, bits::bits_for(most), bits::bits_for(material)};
}

uint32_t LabelCode::number_of(uint32_t label) const {
    const int32_t depth = displacement_of(label);
    const uint32_t steps = depth == kOpenDisplacement
                               ? static_cast<uint32_t>(depths.max_mm - depths.min_mm) / step_mm + 1
                               : static_cast<uint32_t>(depth - depths.min_mm) / step_mm;
    return steps | material_of(label) << displacement_bits;
}

uint32_t LabelCode::label_of(uint32_t number) const {
    const uint32_t steps = number & ((1u << displacement_bits) - 1);
    const int64_t depth = depths.min_mm + int64_t{steps} * step_mm;
    return make_label(depth > depths.max_mm ? kOpenDisplacement : static_cast<int32_t>(depth),
                      number >> displacement_bits & 0xffffu);
}

Status check_rewritten(std::span<const uint32_t> words, std::span<const uint32_t> rewritten) {
    const auto [here, there] = std::mismatch(words.begin(), words.end(), rewritten.begin(), rewritten.end());
    if (here == words.end() && there == rewritten.end()) return Done{};
    return Error{"facade map is not as its content is written", 4 * static_cast<uint64_t>(here - words.begin())};
}

void append_form_head(std::vector<uint32_t>& words, FacadeForm form, uint32_t width, uint32_t height,
                      DepthRange depths) {
    words.push_back(FACADE_FORM_MAGIC | static_cast<uint32_t>(form) << 16);
    words.push_back(width | height << 16);
    words.push_back((static_cast<uint32_t>(depths.min_mm) & 0xffffu) | static_cast<uint32_t>(depths.max_mm) << 16);
}

}  // namespace citystream::codec::facade
