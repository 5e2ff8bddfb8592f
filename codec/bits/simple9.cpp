#include "codec/bits/simple9.h"

#include <algorithm>

namespace citystream::codec::bits {

namespace {

/// Values from `begin` on that go into a word of a selector (fewer at the end only), 0 if they do not fit.
size_t fitting(std::span<const uint32_t> values, size_t begin, uint32_t selector) {
    const size_t count = std::min<size_t>(kSimple9Counts[selector], values.size() - begin);
    const auto part = values.subspan(begin, count);
    const bool fits =
        std::all_of(part.begin(), part.end(), [&](uint32_t value) { return value >> kSimple9Widths[selector] == 0; });
    return fits ? count : 0;
}

/// For each value the selector of the word that begins with it in the shortest code of it and those after it.
std::vector<uint8_t> best_selectors(std::span<const uint32_t> values) {
    std::vector<uint8_t> selectors(values.size());
    std::vector<uint32_t> words(values.size() + 1, 0);
    for (size_t i = values.size(); i-- > 0;) {
        words[i] = ~uint32_t{0};
        for (uint32_t selector = 0; selector < kSimple9Selectors; ++selector) {
            const size_t count = fitting(values, i, selector);
            if (count == 0 || words[i + count] + 1 >= words[i]) continue;
            words[i] = words[i + count] + 1;
            selectors[i] = static_cast<uint8_t>(selector);
        }
    }
    return selectors;
}

}  // namespace

std::optional<std::vector<uint32_t>> pack_simple9(std::span<const uint32_t> values) {
    if (std::any_of(values.begin(), values.end(), [](uint32_t value) { return value > kSimple9Most; }))
        return std::nullopt;
    const std::vector<uint8_t> selectors = best_selectors(values);
    std::vector<uint32_t> words;
    for (size_t i = 0; i < values.size();) {
        const uint32_t selector = selectors[i];
        uint32_t word = selector;
        for (uint32_t place = 0; place < kSimple9Counts[selector] && i < values.size(); ++place, ++i)
            word |= values[i] << (4 + place * kSimple9Widths[selector]);
        words.push_back(word);
    }
    return words;
}

Status check_simple9(std::span<const uint32_t> words, uint64_t count) {
    uint64_t before = 0;
    for (size_t i = 0; i < words.size(); ++i) {
        const uint32_t codes = simple9_count(words[i]);
        if (codes == 0) return Error{"Simple-9 selector does not exist", 4 * i};
        if (before >= count) return Error{"Simple-9 word after the last code", 4 * i};
        const uint32_t selector = words[i] & 15;
        const uint64_t kept = std::min<uint64_t>(codes, count - before);
        const auto used = static_cast<uint32_t>(kept) * kSimple9Widths[selector];
        if (used < 28 && words[i] >> (4 + used) != 0) return Error{"Simple-9 padding is not zero", 4 * i};
        before += codes;
    }
    if (before < count) return Error{"Simple-9 words end before the last code", 4 * words.size()};
    return Done{};
}

std::vector<uint32_t> unpack_simple9(std::span<const uint32_t> words, size_t count) {
    std::vector<uint32_t> values;
    values.reserve(count);
    for (const uint32_t word : words) {
        for (uint32_t place = 0; place < simple9_count(word) && values.size() < count; ++place)
            values.push_back(simple9_code(word, place));
    }
    return values;
}

}  // namespace citystream::codec::bits
