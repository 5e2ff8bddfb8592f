// Numbers in white-space separated text.
#pragma once

#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace citystream::tiles::city {

/// Calls take(double) for each token of `text` (separated by white space or commas). A token that is no number is NaN.
template <typename Take>
void for_each_number(std::string_view text, Take take) {
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto is_gap = [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == ','; };
    while (true) {
        while (at != end && is_gap(*at)) ++at;
        if (at == end) return;
        const char* stop = at;
        while (stop != end && !is_gap(*stop)) ++stop;
        if (*at == '+') ++at;
        double value = 0;
        const auto [next, code] = std::from_chars(at, stop, value);
        take(code == std::errc() && next == stop ? value : std::numeric_limits<double>::quiet_NaN());
        at = stop;
    }
}

}  // namespace citystream::tiles::city
