#include "codec/radiance/visibility_cells.h"

#include <algorithm>
#include <cstring>

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kByteBits = 8, kWordBits = 32, kFinest = kCellLevels - 1;

/// Appends bits to words that are zeros.
class BitAppender {
  public:
    explicit BitAppender(std::span<uint32_t> words) : words_(words) {}

    /// 1..32 bits; those above the count are zeros.
    void add(uint32_t value, uint32_t count) {
        pending_ |= uint64_t{value} << filled_;
        filled_ += count;
        if (filled_ < kWordBits) return;
        words_[word_++] = static_cast<uint32_t>(pending_);
        pending_ >>= kWordBits;
        filled_ -= kWordBits;
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

uint32_t load_word(const uint8_t* bytes) {
    return bytes[0] | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[3]} << 24;
}

/// Each bit of a byte twice.
constexpr std::array<uint16_t, 256> make_doubled() {
    std::array<uint16_t, 256> table{};
    for (uint32_t byte = 0; byte < table.size(); ++byte) {
        for (uint32_t bit = 0; bit < kByteBits; ++bit)
            table[byte] = static_cast<uint16_t>(table[byte] | (byte >> bit & 1) * 3 << 2 * bit);
    }
    return table;
}
constexpr auto kDoubled = make_doubled();

/// Of sixteen bits, whether either of 2i and 2i + 1 is set.
uint8_t halved(uint32_t sixteen) {
    uint32_t pairs = (sixteen | sixteen >> 1) & 0x5555;
    pairs = (pairs | pairs >> 1) & 0x3333;
    pairs = (pairs | pairs >> 2) & 0x0f0f;
    return static_cast<uint8_t>(pairs | pairs >> 4);
}

/// A row of samples, with room for a word to be read at its last byte.
using RowBytes = std::array<uint8_t, kSamplesAcross * kMostCubeSide / kByteBits + sizeof(uint32_t)>;

void store_half(uint8_t* bytes, uint16_t half) {
    bytes[0] = static_cast<uint8_t>(half);
    bytes[1] = static_cast<uint8_t>(half >> kByteBits);
}

/// Each of a row's cells as often as it has samples.
void widen(RowBytes& row, uint32_t bytes, uint32_t times) {
    for (; times > 1; times /= 2, bytes *= 2) {
        for (uint32_t i = bytes; i-- > 0;) {
            store_half(&row[2 * i], kDoubled[row[i]]);
        }
    }
}

/// Eight bytes at a time: most rows of the finest level are that long.
void and_bytes(const uint8_t* a, const uint8_t* b, uint32_t count, uint8_t* to) {
    uint32_t i = 0;
    for (uint64_t x = 0, y = 0; i + sizeof(x) <= count; i += sizeof(x)) {
        std::memcpy(&x, a + i, sizeof(x));
        std::memcpy(&y, b + i, sizeof(y));
        x &= y;
        std::memcpy(to + i, &x, sizeof(x));
    }
    for (; i < count; ++i) to[i] = a[i] & b[i];
}

void append_row(BitAppender& appender, const uint8_t* row, uint32_t across) {
    for (uint32_t x = 0; x < across; x += kWordBits) {
        const uint32_t count = std::min(kWordBits, across - x);
        appender.add(load_word(row + x / kByteBits) & ~0u >> (kWordBits - count), count);
    }
}

}  // namespace

CellLayout::CellLayout(uint32_t side) : samples_across_(kSamplesAcross * side) {
    for (uint32_t level = 0; level < kCellLevels; ++level)
        across_[level] = (samples_across_ + cell_samples(level) - 1) / cell_samples(level);
}

CellStates::CellStates(const CellLayout& layout) {
    for (uint32_t level = 0; level < kCellLevels; ++level) bytes_[level].assign(layout.size(level), 0);
}

void CellStates::clear(uint32_t level) {
    std::fill(bytes_[level].begin(), bytes_[level].end(), uint8_t{0});
}

void CellStates::set_from_bits(const CellLayout& layout, std::span<const uint32_t> bits,
                               std::span<const uint32_t> above) {
    const uint32_t across = layout.samples_across(), hidden = layout.hidden(kFinest);
    clear(kFinest);
    uint32_t s = 0;
    const auto bit_of = [&s](std::span<const uint32_t> words) { return words[s / kWordBits] >> s % kWordBits & 1; };
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < across; ++y) {
            uint8_t* const row = at(kFinest, layout.row(kFinest, face, y));
            for (uint32_t x = 0; x < across; ++x, ++s) {
                if (bit_of(above) == 0) continue;
                uint8_t& byte = row[(bit_of(bits) != 0 ? 0 : hidden) + x / kByteBits];
                byte = static_cast<uint8_t>(byte | 1u << x % kByteBits);
            }
        }
    }
    for (uint32_t level = kFinest; level-- > 0;) join_cells(layout, level);
}

void CellStates::join_cells(const CellLayout& layout, uint32_t level) {
    const uint32_t below = layout.stride(level + 1), part_bytes = layout.row_bytes(level + 1);
    const auto join_row = [&](const uint8_t* parts, uint8_t* row) {
        for (uint32_t i = 0; i < layout.row_bytes(level); ++i) {
            uint32_t sixteen = parts[2 * i] | parts[2 * i + below];
            if (2 * i + 1 < part_bytes)
                sixteen |= uint32_t{parts[2 * i + 1]} << 8 | uint32_t{parts[2 * i + 1 + below]} << 8;
            row[i] = halved(sixteen);
        }
    };
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < layout.across(level); ++y) {
            // Of a cell that is cut off by the edge of the face, the border is absent.
            const uint8_t* const parts = at(level + 1, layout.row(level + 1, face, 2 * y));
            uint8_t* const row = at(level, layout.row(level, face, y));
            join_row(parts, row);
            join_row(parts + layout.hidden(level + 1), row + layout.hidden(level));
        }
    }
}

void CellStates::inherit_row(const CellLayout& layout, uint32_t level, uint32_t face, uint32_t y,
                             const CellStates& present) {
    const uint8_t* const greater = at(level - 1, layout.row(level - 1, face, y));
    const uint32_t greater_bytes = layout.row_bytes(level - 1), greater_hidden = layout.hidden(level - 1);
    RowBytes visible, hidden;
    for (uint32_t i = 0; i < greater_bytes; ++i) {
        const uint32_t v = greater[i], h = greater[greater_hidden + i];
        store_half(&visible[2 * i], kDoubled[v & ~h]);
        store_half(&hidden[2 * i], kDoubled[h & ~v]);
    }
    const uint32_t bytes = layout.row_bytes(level), first = layout.row(level, face, 2 * y);
    for (uint32_t r = 0; r < std::min(2u, layout.across(level) - 2 * y); ++r) {
        const uint32_t byte = first + r * layout.stride(level);
        const uint8_t* const there = present.at(level, byte);
        and_bytes(visible.data(), there, bytes, at(level, byte));
        and_bytes(hidden.data(), there, bytes, at(level, byte + layout.hidden(level)));
    }
}

void CellStates::write_bits(const CellLayout& layout, uint32_t levels, std::span<const uint32_t> above,
                            std::span<uint32_t> bits) const {
    const uint32_t level = levels - 1, samples = layout.cell_samples(level), across = layout.samples_across();
    const uint32_t bytes = layout.row_bytes(level), hidden = layout.hidden(level);
    BitAppender appender(bits);
    RowBytes visible{}, mixed{}, row{};
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < across; ++y) {
            const uint8_t* const cells = at(level, layout.row(level, face, y / samples));
            if (level == kFinest) {
                append_row(appender, cells, across);
                continue;
            }
            if (y % samples == 0) {
                for (uint32_t i = 0; i < bytes; ++i) {
                    mixed[i] = cells[i] & cells[hidden + i];
                    visible[i] = static_cast<uint8_t>(cells[i] & ~cells[hidden + i]);
                }
                widen(visible, bytes, samples);
                widen(mixed, bytes, samples);
            }
            const uint32_t every_other = y % 2 != 0 ? 0x55 : 0xaa;
            for (uint32_t i = 0; i < row.size(); ++i)
                row[i] = static_cast<uint8_t>(visible[i] | (mixed[i] & every_other));
            append_row(appender, row.data(), across);
        }
    }
    appender.finish();
    for (size_t w = 0; w < bits.size(); ++w) bits[w] &= above[w];
}

}  // namespace citystream::codec::radiance
