#include "tiles/tileset/json_fields.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace citystream::tiles::tileset {
namespace {

using Json = nlohmann::json;

constexpr int64_t kExactInDouble = int64_t{1} << 53;

const Json& empty_object() {
    static const Json empty = Json::object();
    return empty;
}

const Json& empty_array() {
    static const Json empty = Json::array();
    return empty;
}

template <typename T>
std::optional<T> parse_number(const std::string& text, int base) {
    T value{};
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (failure != std::errc{} || end != text.data() + text.size() || text.empty()) return std::nullopt;
    return value;
}

}  // namespace

JsonFields::JsonFields(const Json& object, std::string path, std::optional<Error>& first_error)
    : object_(object.is_object() ? object : empty_object()), path_(std::move(path)), first_error_(first_error) {
    if (!object.is_object() && !first_error_)
        first_error_ = Error{(path_.empty() ? "the document" : path_) + " is not an object"};
}

std::string JsonFields::path_of(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void JsonFields::fail(std::string_view key, std::string_view what) const {
    if (!first_error_) first_error_ = Error{fmt::format("{} {}", path_of(key), what)};
}

bool JsonFields::has(std::string_view key) const {
    return object_.find(key) != object_.end();
}

const Json& JsonFields::field(std::string_view key) const {
    static const Json absent;
    const auto found = object_.find(key);
    if (found != object_.end()) return *found;
    fail(key, "is missing");
    return absent;
}

JsonFields JsonFields::object(std::string_view key) const {
    const Json& value = field(key);
    if (!value.is_object()) fail(key, "is not an object");
    return {value.is_object() ? value : empty_object(), path_of(key), first_error_};
}

const Json& JsonFields::array(std::string_view key) const {
    const Json& value = field(key);
    if (value.is_array()) return value;
    fail(key, "is not an array");
    return empty_array();
}

std::string JsonFields::text(std::string_view key) const {
    const Json& value = field(key);
    if (value.is_string()) return value.get<std::string>();
    fail(key, "is not a string");
    return {};
}

bool JsonFields::flag(std::string_view key) const {
    const Json& value = field(key);
    if (value.is_boolean()) return value.get<bool>();
    fail(key, "is not true or false");
    return false;
}

double JsonFields::number(std::string_view key, double low, double high) const {
    const Json& value = field(key);
    const double number = value.is_number() ? value.get<double>() : NAN;
    if (number >= low && number <= high) return number;
    fail(key, fmt::format("is not a number from {} to {}", low, high));
    return low;
}

void JsonFields::numbers(std::string_view key, double low, double high, std::span<double> out) const {
    const Json& values = array(key);
    if (values.size() != out.size()) return fail(key, fmt::format("does not have {} numbers", out.size()));
    for (size_t i = 0; i < out.size(); ++i) {
        out[i] = values[i].is_number() ? values[i].get<double>() : NAN;
        if (!(out[i] >= low && out[i] <= high))
            return fail(key, fmt::format("has a number outside {} to {}", low, high));
    }
}

int64_t JsonFields::integer(std::string_view key, int64_t low, int64_t high) const {
    const Json& value = field(key);
    std::optional<int64_t> number;
    if (value.is_string()) number = parse_number<int64_t>(value.get_ref<const std::string&>(), 10);
    const bool fits =
        value.is_number_integer() && (!value.is_number_unsigned() || value.get<uint64_t>() <= uint64_t{INT64_MAX});
    if (fits) number = value.get<int64_t>();
    if (number && *number >= low && *number <= high) return *number;
    fail(key, fmt::format("is not an integer from {} to {}", low, high));
    return low;
}

uint64_t JsonFields::count(std::string_view key, uint64_t high) const {
    const Json& value = field(key);
    std::optional<uint64_t> number;
    if (value.is_string()) number = parse_number<uint64_t>(value.get_ref<const std::string&>(), 10);
    if (value.is_number_unsigned()) number = value.get<uint64_t>();
    if (number && *number <= high) return *number;
    fail(key, fmt::format("is not an integer from 0 to {}", high));
    return 0;
}

uint64_t JsonFields::hex(std::string_view key) const {
    const std::string digits = text(key);
    const auto number = digits.size() == 16 ? parse_number<uint64_t>(digits, 16) : std::nullopt;
    if (!number) fail(key, "is not a checksum of 16 hexadecimal digits");
    return number.value_or(0);
}

Json exact_integer(int64_t value) {
    if (value >= -kExactInDouble && value <= kExactInDouble) return value;
    return std::to_string(value);
}

Json exact_integer(uint64_t value) {
    if (value <= uint64_t{kExactInDouble}) return value;
    return std::to_string(value);
}

std::string hex16(uint64_t value) {
    return fmt::format("{:016x}", value);
}

}  // namespace citystream::tiles::tileset
