// The value-or-error type that every decoder and parser returns. Bad bytes never throw.
#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace citystream {

/// What is wrong and where. `offset` is a byte offset in the input being decoded (kNoOffset when there is none).
struct Error {
    static constexpr uint64_t kNoOffset = ~uint64_t{0};
    std::string message;
    uint64_t offset = kNoOffset;

    /// One line for a person: the message, followed by "(at byte N)" when an offset is known.
    std::string text() const {
        return offset == kNoOffset ? message : message + " (at byte " + std::to_string(offset) + ")";
    }
};

/// A T or an Error. Reading the wrong one is a programming error (asserted).
template <typename T>
class [[nodiscard]] Result {
  public:
    Result(T value) : value_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
    Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

    bool ok() const { return value_.has_value(); }
    explicit operator bool() const { return ok(); }
    const T& value() const& {
        assert(ok());
        return *value_;
    }
    T& value() & {
        assert(ok());
        return *value_;
    }
    T&& value() && {
        assert(ok());
        return std::move(*value_);
    }
    const T& operator*() const& { return value(); }
    T& operator*() & { return value(); }
    T&& operator*() && { return std::move(*this).value(); }
    const T* operator->() const { return &value(); }
    T* operator->() { return &value(); }
    const Error& error() const {
        assert(!ok());
        return error_;
    }

  private:
    std::optional<T> value_;
    Error error_;
};

/// Result of a call that yields nothing but success.
struct Done {};
using Status = Result<Done>;

}  // namespace citystream
