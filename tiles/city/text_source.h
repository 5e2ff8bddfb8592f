// Bytes of a city model file in chunks, decompressed on the way (xz, gzip: by content, not by name).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "codec/result.h"

namespace citystream::tiles::city {

/// One input, read from front to back. Memory: one chunk and the decompressor's window (xz inputs that ask for more
/// than 256 MiB are refused).
class TextSource {
  public:
    static Result<TextSource> open(const std::string& path);
    /// `bytes` must outlive the source. `name` stands for the path in messages and for resolving image paths.
    static Result<TextSource> from_memory(std::string name, std::string_view bytes);

    TextSource(TextSource&&) noexcept;
    TextSource& operator=(TextSource&&) noexcept;
    ~TextSource();

    /// Fills the front of `out` with the next decompressed bytes; 0 at the end. Error: damaged or truncated
    /// compression, read failure.
    Result<size_t> read(std::span<char> out);
    /// Starts over from the first byte.
    Status rewind();

    const std::string& name() const;
    bool compressed() const;
    uint64_t stored_bytes_done() const;  ///< of the file as stored, for progress
    uint64_t stored_bytes_total() const;

  private:
    struct State;
    explicit TextSource(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// Splits a source into lines.
class LineReader {
  public:
    /// No line may be longer (a decompression bomb without line ends stops here).
    static constexpr uint64_t kMaxLineBytes = uint64_t{1} << 32;
    /// Compressed lines may not be longer than this many times what was read of the file so far, plus kFreeBytes.
    static constexpr uint64_t kMaxExpansion = 400;
    static constexpr uint64_t kFreeBytes = uint64_t{64} << 20;

    explicit LineReader(TextSource& source) : source_(source) {}

    /// Replaces `line` by the next one without its line end; false at the end of the input. A last line without line
    /// end counts.
    Result<bool> next(std::string& line);
    /// Appends all that is left (line ends included).
    Status rest(std::string& text);
    uint64_t line_number() const { return line_number_; }  ///< of the line returned last, from 1
    uint64_t line_offset() const { return line_offset_; }  ///< decompressed byte at which it starts

  private:
    Result<bool> refill();
    Status check_length(uint64_t length) const;

    TextSource& source_;
    std::string chunk_;
    size_t position_ = 0;
    uint64_t line_number_ = 0;
    uint64_t line_offset_ = 0;
    uint64_t next_offset_ = 0;
};

}  // namespace citystream::tiles::city
