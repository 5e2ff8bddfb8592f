#include "client/stream/byte_count.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string_view>

namespace citystream::client {
namespace {

struct Unit {
    std::string_view name;
    double bytes;
};

constexpr std::array<Unit, 10> kUnits = {{{"", 1},
                                          {"b", 1},
                                          {"kib", 1024.0},
                                          {"mib", 1048576.0},
                                          {"gib", 1073741824.0},
                                          {"tib", 1099511627776.0},
                                          {"kb", 1e3},
                                          {"mb", 1e6},
                                          {"gb", 1e9},
                                          {"tb", 1e12}}};

}  // namespace

Result<uint64_t> parse_byte_count(const std::string& text) {
    std::string lower(text);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    double value = 0;
    const auto [end, status] = std::from_chars(lower.data(), lower.data() + lower.size(), value);
    const std::string_view name(end, static_cast<size_t>(lower.data() + lower.size() - end));
    const auto unit = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == name; });
    if (status != std::errc{} || unit == kUnits.end()) {
        return Error{"\"" + text + "\" is not a size (expected for example 512MiB or 1GiB)"};
    }
    const double bytes = value * unit->bytes;
    if (!(bytes >= 0) || bytes > 1e18) return Error{"\"" + text + "\": size out of range"};
    return static_cast<uint64_t>(bytes);
}

}  // namespace citystream::client
