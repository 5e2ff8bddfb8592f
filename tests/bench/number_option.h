// Numbers in the options of benches.
#pragma once

#include <charconv>
#include <string_view>

namespace citystream::bench {

/// False, and `value` as it was: the text is no number from `least` to `most` (nan is none).
template <typename Number>
bool take_number(std::string_view text, Number least, Number most, Number& value) {
    Number parsed{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
    if (error != std::errc() || end != text.data() + text.size() || !(parsed >= least && parsed <= most)) return false;
    value = parsed;
    return true;
}

}  // namespace citystream::bench
