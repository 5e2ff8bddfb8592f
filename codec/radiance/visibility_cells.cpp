#include "codec/radiance/visibility_cells.h"

#include <algorithm>

namespace citystream::codec::radiance {

namespace {

bool bit_of(std::span<const uint32_t> words, uint32_t sample) {
    return (words[sample / 32] >> sample % 32 & 1) != 0;
}

uint8_t joined(uint8_t a, uint8_t b) {
    if (a == kAbsent) return b;
    return b == kAbsent || a == b ? a : static_cast<uint8_t>(kMixed);
}

/// Appends bits to words that are zeros.
class BitAppender {
  public:
    explicit BitAppender(std::span<uint32_t> words) : words_(words) {}

    /// 0..32 bits.
    void add(uint32_t value, uint32_t count) {
        pending_ |= uint64_t{value} << filled_;
        filled_ += count;
        if (filled_ < 32) return;
        words_[word_++] = static_cast<uint32_t>(pending_);
        pending_ >>= 32;
        filled_ -= 32;
    }
    void finish() {
        if (filled_ > 0) words_[word_] = static_cast<uint32_t>(pending_);
    }

  private:
    std::span<uint32_t> words_;
    size_t word_ = 0;
    uint64_t pending_ = 0;
    uint32_t filled_ = 0;
};

/// Eight states as a bit each: visible.
uint32_t visible_of_eight(const uint8_t* states) {
    uint64_t eight = 0;
    for (uint32_t i = 0; i < 8; ++i) eight |= uint64_t{states[i]} << 8 * i;
    constexpr uint64_t kOnes = 0x0101010101010101u;
    const uint64_t visible = eight & ~(eight >> 1) & kOnes;  // kAllVisible is 1, states have two bits
    return static_cast<uint32_t>(visible * 0x0102040810204080u >> 56);
}

constexpr uint32_t kWordBits = 32, kEight = 8;
using RowBits = std::array<uint32_t, kSamplesAcross * kMostCubeSide / kWordBits>;

/// Of a row of samples, even or odd, in a row of cells.
RowBits row_bits(const uint8_t* cells, uint32_t samples, uint32_t across, uint32_t odd) {
    RowBits row{};
    if (samples == 1 && across % kEight == 0) {
        for (uint32_t x = 0; x < across; x += kEight)
            row[x / kWordBits] |= visible_of_eight(cells + x) << x % kWordBits;
        return row;
    }
    // Cells begin at even samples, and words at cells.
    const uint32_t all = (1u << samples) - 1, every_other = (odd != 0 ? 0x55u : 0xaau) & all;
    for (uint32_t x = 0; x < across; x += samples) {
        const uint8_t state = cells[x / samples];
        row[x / kWordBits] |= (state == kAllVisible ? all : state == kMixed ? every_other : 0) << x % kWordBits;
    }
    if (across % kWordBits != 0) row[across / kWordBits] &= (1u << across % kWordBits) - 1;
    return row;
}
static_assert(kAllHidden == 0 && kAllVisible == 1 && kMixed == 2 && kAbsent == 3);

}  // namespace

CellLayout::CellLayout(uint32_t side) : samples_across_(kSamplesAcross * side) {
    for (uint32_t level = 0; level < kCellLevels; ++level)
        across_[level] = (samples_across_ + cell_samples(level) - 1) / cell_samples(level);
}

CellStates::CellStates(const CellLayout& layout) {
    for (uint32_t level = 0; level < kCellLevels; ++level) states_[level].assign(layout.size(level), kAbsent);
}

void CellStates::set_from_bits(const CellLayout& layout, std::span<const uint32_t> bits,
                               std::span<const uint32_t> above) {
    constexpr uint32_t kFinest = kCellLevels - 1;
    const uint32_t across = layout.samples_across();
    uint32_t s = 0;
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < across; ++y) {
            uint8_t* const cells = &at(kFinest, layout.place(kFinest, face, 0, y));
            for (uint32_t x = 0; x < across; ++x, ++s)
                cells[x] = !bit_of(above, s) ? kAbsent : bit_of(bits, s) ? kAllVisible : kAllHidden;
        }
    }
    for (uint32_t level = kFinest; level-- > 0;) join_cells(layout, level);
}

void CellStates::join_cells(const CellLayout& layout, uint32_t level) {
    const uint32_t across = layout.across(level), row = layout.row(level + 1);
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < across; ++y) {
            for (uint32_t x = 0; x < across; ++x) {
                // Of a cell that is cut off by the edge of the face, the border is absent.
                const uint8_t* const parts = &at(level + 1, layout.place(level + 1, face, 2 * x, 2 * y));
                at(level, layout.place(level, face, x, y)) =
                    joined(joined(parts[0], parts[1]), joined(parts[row], parts[row + 1]));
            }
        }
    }
}

void CellStates::list_mixed(const CellLayout& layout, uint32_t level, uint32_t face, uint32_t y,
                            std::vector<uint32_t>& columns) const {
    columns.clear();
    const uint8_t* const cells = &states_[level][layout.place(level, face, 0, y)];
    for (uint32_t x = 0; x < layout.across(level); ++x) {
        if (cells[x] == kMixed) columns.push_back(x);
    }
}

void CellStates::inherit_row(const CellLayout& layout, uint32_t level, uint32_t face, uint32_t y,
                             const CellStates& present) {
    const uint32_t across = layout.across(level);
    const uint8_t* const greater = &states_[level - 1][layout.place(level - 1, face, 0, y)];
    for (uint32_t row = 2 * y; row < std::min(2 * y + 2, across); ++row) {
        const uint32_t first = layout.place(level, face, 0, row);
        uint8_t* const cells = &states_[level][first];
        const uint8_t* const there = &present.states_[level][first];
        for (uint32_t x = 0; x < across; ++x)
            cells[x] = there[x] == kAbsent ? static_cast<uint8_t>(kAbsent) : greater[x / 2];
    }
}

void CellStates::write_bits(const CellLayout& layout, uint32_t levels, std::span<const uint32_t> above,
                            std::span<uint32_t> bits) const {
    const uint32_t level = levels - 1, samples = layout.cell_samples(level), across = layout.samples_across();
    BitAppender appender(bits);
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < across; y += samples) {
            const uint8_t* const cells = &states_[level][layout.place(level, face, 0, y / samples)];
            const RowBits even = row_bits(cells, samples, across, 0);
            const RowBits odd = samples > 1 ? row_bits(cells, samples, across, 1) : even;
            for (uint32_t row = y; row < std::min(y + samples, across); ++row) {
                for (uint32_t x = 0; x < across; x += kWordBits)
                    appender.add((row % 2 == 0 ? even : odd)[x / kWordBits], std::min(kWordBits, across - x));
            }
        }
    }
    appender.finish();
    for (size_t w = 0; w < bits.size(); ++w) bits[w] &= above[w];
}

}  // namespace citystream::codec::radiance
