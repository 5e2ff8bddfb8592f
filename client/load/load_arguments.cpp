#include "client/load/load_arguments.h"

#include <array>
#include <charconv>
#include <optional>
#include <string_view>

namespace citystream::client {
namespace {

struct Unit {
    std::string_view name;
    double scale;
};

/// "<number><unit>" times the unit's scale; nothing when it is not that.
template <size_t N>
std::optional<double> parse_with_unit(const std::string& text, const std::array<Unit, N>& units) {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) return std::nullopt;
    const std::string_view rest(end, static_cast<size_t>(text.data() + text.size() - end));
    for (const Unit& unit : units) {
        if (rest == unit.name) return number * unit.scale;
    }
    return std::nullopt;
}

}  // namespace

Result<double> parse_load_duration(const std::string& text) {
    static constexpr std::array<Unit, 6> kUnits = {
        {{"", 1}, {"s", 1}, {"ms", 1e-3}, {"m", 60}, {"min", 60}, {"h", 3600}}};
    const auto seconds = parse_with_unit(text, kUnits);
    if (!seconds || !(*seconds > 0) || !(*seconds <= 86400))
        return Error{"'" + text + "' is no duration up to a day, like 30s, 500ms or 2m"};
    return *seconds;
}

Result<uint64_t> parse_load_bytes(const std::string& text) {
    static constexpr std::array<Unit, 8> kUnits = {{{"", 1},
                                                    {"B", 1},
                                                    {"KiB", 1024},
                                                    {"MiB", 1048576},
                                                    {"GiB", 1073741824},
                                                    {"kB", 1e3},
                                                    {"MB", 1e6},
                                                    {"GB", 1e9}}};
    const auto bytes = parse_with_unit(text, kUnits);
    if (!bytes || !(*bytes >= 1) || !(*bytes <= 1e15))
        return Error{"'" + text + "' is no amount of memory like 512MiB or 1GiB"};
    return static_cast<uint64_t>(*bytes);
}

}  // namespace citystream::client
