// Typed access to the fields of a JSON object that was written by someone else: the first thing that is missing or of
// the wrong kind is remembered with its path, and reading goes on with defaults.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "codec/result.h"

namespace citystream::tiles::tileset {

class JsonFields {
  public:
    /// `object` and `first_error` must outlive this. `path` names the object in messages ("" for the root).
    JsonFields(const nlohmann::json& object, std::string path, std::optional<Error>& first_error);

    bool has(std::string_view key) const;
    JsonFields object(std::string_view key) const;
    std::string text(std::string_view key) const;
    double number(std::string_view key, double low, double high) const;
    void numbers(std::string_view key, double low, double high, std::span<double> out) const;
    /// Integers may be JSON numbers or strings of decimal digits (beyond 2^53).
    int64_t integer(std::string_view key, int64_t low, int64_t high) const;
    uint64_t count(std::string_view key, uint64_t high) const;
    bool flag(std::string_view key) const;
    uint64_t hex(std::string_view key) const;  ///< 16 hexadecimal digits
    const nlohmann::json& array(std::string_view key) const;
    const nlohmann::json& json() const { return object_; }

    /// Remembers that something is wrong with a field.
    void fail(std::string_view key, std::string_view what) const;
    void require(bool condition, std::string_view key, std::string_view what) const {
        if (!condition) fail(key, what);
    }

  private:
    const nlohmann::json& field(std::string_view key) const;
    std::string path_of(std::string_view key) const;

    const nlohmann::json& object_;
    std::string path_;
    std::optional<Error>& first_error_;
};

/// An integer as a JSON number where doubles are exact, else as a string.
nlohmann::json exact_integer(int64_t value);
nlohmann::json exact_integer(uint64_t value);
std::string hex16(uint64_t value);

}  // namespace citystream::tiles::tileset
