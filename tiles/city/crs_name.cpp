#include "tiles/city/crs_name.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string>

namespace citystream::tiles::city {
namespace {

int32_t leading_number(std::string_view text) {
    int32_t value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return code == std::errc() && value > 0 ? value : 0;
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// German surveying authorities' names of ETRS89 / UTM zones.
int32_t adv_code(std::string_view name) {
    constexpr std::string_view kUtm = "etrs89_utm";
    const size_t at = name.find(kUtm);
    if (at == std::string_view::npos) return 0;
    const int32_t zone = leading_number(name.substr(at + kUtm.size()));
    constexpr int32_t kEtrs89Utm = 25800;
    return zone >= 28 && zone <= 38 ? kEtrs89Utm + zone : 0;
}

}  // namespace

int32_t epsg_of(std::string_view name) {
    std::string lower(name.substr(0, 400));
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const std::string_view text = lower;
    constexpr std::string_view kEpsg = "epsg";
    const size_t at = text.find(kEpsg);
    if (at == std::string_view::npos) return adv_code(text);
    std::string_view tail = text.substr(at + kEpsg.size());
    if (const size_t stop = tail.find_first_of(",+ "); stop != std::string_view::npos) tail = tail.substr(0, stop);
    // The code is the last number: a version may stand before it ("EPSG:6.12:3068", "EPSG/0/7415").
    size_t end = tail.size();
    while (end > 0 && !is_digit(tail[end - 1])) --end;
    size_t begin = end;
    while (begin > 0 && is_digit(tail[begin - 1])) --begin;
    return leading_number(tail.substr(begin, end - begin));
}

bool is_geographic(int32_t epsg) {
    constexpr std::array kDegrees = {4258, 4269, 4326, 4612, 4937, 4979, 6318, 6319, 6667, 6668, 6697, 7423, 9286};
    return std::find(kDegrees.begin(), kDegrees.end(), epsg) != kDegrees.end();
}

}  // namespace citystream::tiles::city
