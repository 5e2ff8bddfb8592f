#include "tiles/city/json_fault.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

namespace citystream::tiles::city {
namespace {

using Json = nlohmann::json;

/// Takes no value; remembers where parsing failed.
class FaultFinder : public nlohmann::json_sax<Json> {
  public:
    std::optional<size_t> position;

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(Json::number_integer_t) override { return true; }
    bool number_unsigned(Json::number_unsigned_t) override { return true; }
    bool number_float(Json::number_float_t, const Json::string_t&) override { return true; }
    bool string(Json::string_t&) override { return true; }
    bool binary(Json::binary_t&) override { return true; }
    bool start_object(size_t) override { return true; }
    bool key(Json::string_t&) override { return true; }
    bool end_object() override { return true; }
    bool start_array(size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(size_t at, const std::string&, const Json::exception&) override {
        position = at;
        return false;
    }
};

}  // namespace

Error json_fault(std::string_view text, const std::string& file, uint64_t first_line, uint64_t first_byte,
                 const std::string& reason) {
    FaultFinder finder;
    Json::sax_parse(text.begin(), text.end(), &finder);
    // The position counts the offending character too.
    const size_t at = std::min(std::max<size_t>(finder.position.value_or(0), 1) - 1, text.size());
    const uint64_t line = first_line + static_cast<uint64_t>(std::count(text.begin(), text.begin() + at, '\n'));
    return Error{file + ": line " + std::to_string(line) + ": not well-formed JSON: " + reason, first_byte + at};
}

}  // namespace citystream::tiles::city
