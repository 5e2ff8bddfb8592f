#include "client/load/load_arguments.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace citystream::client {
namespace {

struct Unit {
    std::string_view name;
    double seconds;
};

constexpr std::array<Unit, 6> kUnits = {{{"", 1}, {"s", 1}, {"ms", 1e-3}, {"m", 60}, {"min", 60}, {"h", 3600}}};

}  // namespace

Result<double> parse_load_duration(const std::string& text) {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view name(end, static_cast<size_t>(text.data() + text.size() - end));
    const auto unit = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == name; });
    const double seconds = error == std::errc() && unit != kUnits.end() ? number * unit->seconds : 0;
    if (!(seconds > 0) || !(seconds <= 86400))
        return Error{"'" + text + "' is no duration up to a day, like 30s, 500ms or 2m"};
    return seconds;
}

}  // namespace citystream::client
