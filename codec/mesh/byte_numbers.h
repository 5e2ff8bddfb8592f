// Numbers in bytes of 7 bits, low ones first, the highest bit set in all but the last byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace citystream::codec::mesh {

inline void put_number(std::vector<std::byte>& bytes, uint64_t value) {
    for (; value >= 128; value >>= 7) bytes.push_back(static_cast<std::byte>((value & 127u) | 128u));
    bytes.push_back(static_cast<std::byte>(value));
}

/// Reads untrusted bytes; once something is missing or too large everything is 0 and ok() false.
class NumberReader {
  public:
    explicit NumberReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    uint8_t byte() {
        const auto one = take(1);
        return one.empty() ? uint8_t{0} : static_cast<uint8_t>(one[0]);
    }
    /// Below 2^bits, bits 1..63.
    uint64_t number(uint32_t bits) {
        uint64_t value = 0;
        for (uint32_t shift = 0; shift < bits; shift += 7) {
            const uint8_t part = byte();
            value |= static_cast<uint64_t>(part & 127u) << shift;
            if (part < 128) {
                ok_ = ok_ && value >> bits == 0;
                return ok_ ? value : 0;
            }
        }
        ok_ = false;
        return 0;
    }
    std::span<const std::byte> take(uint64_t count) {
        ok_ = ok_ && count <= bytes_.size() - at_;
        if (!ok_) return {};
        at_ += count;
        return bytes_.subspan(at_ - count, count);
    }

    bool ok() const { return ok_; }
    size_t position() const { return at_; }
    size_t left() const { return bytes_.size() - at_; }

  private:
    std::span<const std::byte> bytes_;
    size_t at_ = 0;
    bool ok_ = true;
};

}  // namespace citystream::codec::mesh
