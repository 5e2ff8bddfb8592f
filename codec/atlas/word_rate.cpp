#include "codec/atlas/word_rate.h"

#include <algorithm>
#include <bit>

namespace citystream::codec::atlas {

namespace {

// Costs that made the endpoints and index words of photographs smallest at equal error after zstd 1.5 at level 19.
constexpr uint32_t kContinued = 8;        // a longer match
constexpr uint32_t kRepeated = 5 * 16;    // a match at the distance of the one before
constexpr uint32_t kMatch = 6 * 16;       // any match; then the bits of its distance
constexpr uint32_t kAfterMatch = 3 * 16;  // literals start again
constexpr uint32_t kUpdateInterval = 256;

}  // namespace

uint32_t log2_sixteenths(uint64_t value) {
    // 16 log2(1 + (i + 1/2) / 64), rounded.
    static const std::array<uint8_t, 64> fractions = [] {
        std::array<uint8_t, 64> table;
        for (uint64_t i = 0; i < table.size(); ++i) {
            // Squaring the mantissa (31 fraction bits) gives one more bit of the logarithm each time.
            uint64_t mantissa = (2 * i + 129) << 24;
            uint32_t bits = 0;
            for (int bit = 0; bit < 5; ++bit) {
                mantissa = mantissa * mantissa >> 31;
                const uint32_t one = mantissa >> 32 != 0 ? 1 : 0;
                mantissa >>= one;
                bits = bits << 1 | one;
            }
            table[i] = static_cast<uint8_t>((bits + 1) / 2);
        }
        return table;
    }();
    const auto whole = static_cast<uint32_t>(std::bit_width(value)) - 1;
    const uint64_t mantissa = whole >= 6 ? value >> (whole - 6) : value << (6 - whole);
    return whole * 16 + fractions[mantissa & 63];
}

WordRate::WordRate(uint32_t window) : window_(std::max(window, 1u)) {
    byte_costs_.fill(8 * 16);
}

void WordRate::update_costs() {
    uint64_t total = 0;
    for (const uint64_t count : counts_) total += count + 1;
    const uint32_t all = log2_sixteenths(total);
    for (size_t byte = 0; byte < 256; ++byte)
        byte_costs_[byte] = std::max(all - log2_sixteenths(counts_[byte] + 1), 4u);
}

void WordRate::expect(std::span<const uint32_t> words) {
    for (const uint32_t word : words) {
        for (uint32_t shift = 0; shift < 32; shift += 8) ++counts_[word >> shift & 255u];
    }
    update_costs();
}

uint32_t WordRate::literal_cost(uint32_t word) const {
    uint32_t cost = in_match_ ? kAfterMatch : 0;
    for (uint32_t shift = 0; shift < 32; shift += 8) cost += byte_costs_[word >> shift & 255u];
    return cost;
}

uint32_t WordRate::cost_of(const Seen& seen) const {
    const uint32_t literals = literal_cost(seen.word);
    if (last_distance_ != 0 && words_[words_.size() - last_distance_] == seen.word)
        return std::min(in_match_ ? kContinued : kRepeated, literals);
    return std::min(literals, kMatch + log2_sixteenths(words_.size() - seen.position));
}

void WordRate::recent_costs(std::vector<uint32_t>& costs) const {
    costs.resize(recent_.size());
    for (size_t i = 0; i < recent_.size(); ++i) costs[i] = cost_of(recent_[i]);
}

uint32_t WordRate::cost(uint32_t word) const {
    const auto found = last_position_.find(word);
    return found == last_position_.end() ? literal_cost(word) : cost_of({word, found->second});
}

bool WordRate::continuation(uint32_t& word) const {
    if (!in_match_) return false;
    word = words_[words_.size() - last_distance_];
    return true;
}

void WordRate::append(uint32_t word) {
    const auto position = static_cast<uint32_t>(words_.size());
    const auto found = last_position_.find(word);
    const uint32_t literals = literal_cost(word);
    if (found != last_position_.end() && cost_of({word, found->second}) < literals) {
        if (words_[position - std::max(last_distance_, 1u)] != word || last_distance_ == 0)
            last_distance_ = position - found->second;
        in_match_ = true;
    } else {
        in_match_ = false;
        for (uint32_t shift = 0; shift < 32; shift += 8) ++counts_[word >> shift & 255u];
    }
    words_.push_back(word);
    last_position_[word] = position;
    remember(word, position);
    if (words_.size() % kUpdateInterval == 0) update_costs();
}

void WordRate::remember(uint32_t word, uint32_t position) {
    auto place = std::find_if(recent_.begin(), recent_.end(), [word](const Seen& seen) { return seen.word == word; });
    if (place == recent_.end()) {
        if (recent_.size() < window_) recent_.emplace_back();
        place = recent_.end() - 1;
    }
    std::move_backward(recent_.begin(), place, place + 1);
    recent_.front() = {word, position};
}

}  // namespace citystream::codec::atlas
