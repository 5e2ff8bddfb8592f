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

struct CellPlace {
    uint32_t face, x, y;
};

/// Sets the bits of a cell, or every other one of them.
void write_cell(const CellLayout& layout, uint32_t samples, CellPlace cell, bool every_other,
                std::span<uint32_t> bits) {
    const uint32_t across = layout.samples_across();
    const uint32_t x_end = std::min((cell.x + 1) * samples, across), y_end = std::min((cell.y + 1) * samples, across);
    for (uint32_t y = cell.y * samples; y < y_end; ++y) {
        for (uint32_t x = cell.x * samples; x < x_end; ++x) {
            if (every_other && (x + y) % 2 == 0) continue;
            const uint32_t s = (cell.face * across + y) * across + x;
            bits[s / 32] |= 1u << s % 32;
        }
    }
}

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

void CellStates::write_bits(const CellLayout& layout, uint32_t levels, std::span<const uint32_t> above,
                            std::span<uint32_t> bits) const {
    const uint32_t level = levels - 1, across = layout.across(level);
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < across; ++y) {
            const uint8_t* const cells = &states_[level][layout.place(level, face, 0, y)];
            for (uint32_t x = 0; x < across; ++x) {
                if (cells[x] == kAllVisible || cells[x] == kMixed)
                    write_cell(layout, layout.cell_samples(level), {face, x, y}, cells[x] == kMixed, bits);
            }
        }
    }
    for (size_t w = 0; w < bits.size(); ++w) bits[w] &= above[w];
}

}  // namespace citystream::codec::radiance
