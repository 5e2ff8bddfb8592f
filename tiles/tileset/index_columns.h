// Columns of an index entry: one number of each record, split into planes of bytes (all low bytes first), so that equal
// bytes lie side by side for zstd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace citystream::tiles::tileset {

class ColumnWriter {
  public:
    template <typename Value>
    void add(size_t count, size_t bytes, Value value_at) {
        const size_t begin = out_.size();
        out_.resize(begin + count * bytes);
        for (size_t i = 0; i < count; ++i) {
            const uint32_t value = value_at(i);
            for (size_t plane = 0; plane < bytes; ++plane)
                out_[begin + plane * count + i] = static_cast<std::byte>(value >> (8 * plane));
        }
    }
    std::vector<std::byte> take() { return std::move(out_); }

  private:
    std::vector<std::byte> out_;
};

class ColumnReader {
  public:
    explicit ColumnReader(std::span<const std::byte> raw) : raw_(raw) {}

    /// Precondition: the bytes hold count * bytes more.
    template <typename Put>
    void read(size_t count, size_t bytes, Put put) {
        for (size_t i = 0; i < count; ++i) {
            uint32_t value = 0;
            for (size_t plane = 0; plane < bytes; ++plane)
                value |= static_cast<uint32_t>(raw_[plane * count + i]) << (8 * plane);
            put(i, value);
        }
        raw_ = raw_.subspan(count * bytes);
    }

  private:
    std::span<const std::byte> raw_;
};

}  // namespace citystream::tiles::tileset
