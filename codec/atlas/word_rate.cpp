#include "codec/atlas/word_rate.h"

#include <algorithm>
#include <bit>

#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

// Costs that made the endpoints and index words of photographs smallest at equal error after zstd 1.5 at level 19.
constexpr uint32_t kContinued = 8;        // a longer match
constexpr uint32_t kRepeated = 5 * 16;    // a match at the distance of the one before
constexpr uint32_t kMatch = 6 * 16;       // any match; then the bits of its distance
constexpr uint32_t kAfterMatch = 3 * 16;  // literals start again
constexpr uint32_t kUpdateInterval = 256;

/// 16 log2(1 + (bits + 1/2) / 64), rounded, for six bits.
inline CITYSTREAM_INLINED uint32_t log_of_fraction(uint32_t bits) {
    return (16177 + bits * (5253 - 20 * bits)) >> 14;
}

// Numbers below this are floats without loss, whose exponent and mantissa give the logarithm of several at once.
constexpr uint32_t kExactFloats = 1u << 24;
constexpr uint32_t kMantissaBits = 23, kExponentBias = 127;

/// log2_sixteenths of a value in 1 .. kExactFloats - 1.
inline CITYSTREAM_INLINED uint32_t log2_of_small(int32_t value) {
    const auto bits = std::bit_cast<uint32_t>(static_cast<float>(value));
    return ((bits >> kMantissaBits) - kExponentBias) * 16 + log_of_fraction(bits >> (kMantissaBits - 6) & 63);
}

}  // namespace

uint32_t log2_sixteenths(uint64_t value) {
    const auto whole = static_cast<uint32_t>(std::bit_width(value)) - 1;
    const uint64_t mantissa = whole >= 6 ? value >> (whole - 6) : value << (6 - whole);
    return whole * 16 + log_of_fraction(mantissa & 63);
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
    least_byte_cost_ = *std::min_element(byte_costs_.begin(), byte_costs_.end());
    for (size_t i = 0; i < recent_words_.size(); ++i) recent_literals_[i] = literal_sum(recent_words_[i]);
}

void WordRate::expect(std::span<const uint32_t> words) {
    for (const uint32_t word : words) {
        for (uint32_t shift = 0; shift < 32; shift += 8) ++counts_[word >> shift & 255u];
    }
    update_costs();
}

uint32_t WordRate::literal_sum(uint32_t word) const {
    uint32_t cost = 0;
    for (uint32_t shift = 0; shift < 32; shift += 8) cost += byte_costs_[word >> shift & 255u];
    return cost;
}

uint32_t WordRate::literal_cost(uint32_t word) const {
    return literal_sum(word) + (in_match_ ? kAfterMatch : 0);
}

uint32_t WordRate::cost_of(uint32_t word, uint32_t position) const {
    const uint32_t literals = literal_cost(word);
    if (last_distance_ != 0 && words_[words_.size() - last_distance_] == word)
        return std::min(in_match_ ? kContinued : kRepeated, literals);
    return std::min(literals, kMatch + log2_sixteenths(words_.size() - position));
}

void WordRate::recent_costs(std::vector<uint32_t>& costs, uint32_t scale) const {
    const size_t count = recent_words_.size();
    costs.resize(count);
    if (words_.size() >= kExactFloats) {
        for (size_t i = 0; i < count; ++i) costs[i] = scale * cost_of(recent_words_[i], recent_positions_[i]);
        return;
    }
    const auto now = static_cast<int32_t>(words_.size());
    const uint32_t after = in_match_ ? kAfterMatch : 0;
    const uint32_t *literals = recent_literals_.data(), *positions = recent_positions_.data();
    uint32_t* out = costs.data();
    run_wide([=]() CITYSTREAM_INLINED {
        CITYSTREAM_INDEPENDENT
        for (size_t i = 0; i < count; ++i) {
            const uint32_t match = kMatch + log2_of_small(now - static_cast<int32_t>(positions[i]));
            out[i] = scale * std::min(literals[i] + after, match);
        }
    });
    if (last_distance_ == 0) return;
    const size_t next = place_of(words_[words_.size() - last_distance_]);
    if (next < count) out[next] = scale * std::min(literals[next] + after, in_match_ ? kContinued : kRepeated);
}

uint32_t WordRate::least_cost() const {
    return std::min(4 * least_byte_cost_, last_distance_ == 0 ? kMatch : in_match_ ? kContinued : kRepeated);
}

uint32_t WordRate::least_other_cost() const {
    // All of recent() came after it.
    const uint32_t match = kMatch + log2_sixteenths(recent_words_.size() + 1);
    return std::min(4 * least_byte_cost_ + (in_match_ ? kAfterMatch : 0), match);
}

uint32_t WordRate::cost(uint32_t word) const {
    const uint32_t position = last_position_.find(word);
    return position == WordPositions::kNone ? literal_cost(word) : cost_of(word, position);
}

bool WordRate::continuation(uint32_t& word) const {
    if (!in_match_) return false;
    word = words_[words_.size() - last_distance_];
    return true;
}

void WordRate::append(uint32_t word) {
    const auto position = static_cast<uint32_t>(words_.size());
    const uint32_t before = last_position_.find(word);
    if (before != WordPositions::kNone && cost_of(word, before) < literal_cost(word)) {
        if (words_[position - std::max(last_distance_, 1u)] != word || last_distance_ == 0)
            last_distance_ = position - before;
        in_match_ = true;
    } else {
        in_match_ = false;
        for (uint32_t shift = 0; shift < 32; shift += 8) ++counts_[word >> shift & 255u];
    }
    words_.push_back(word);
    last_position_.set(word, position);
    remember(word, position);
    if (words_.size() % kUpdateInterval == 0) update_costs();
}

/// Of a word in recent(); its size where it is not there.
size_t WordRate::place_of(uint32_t word) const {
    const auto count = static_cast<int32_t>(recent_words_.size());
    const uint32_t* words = recent_words_.data();
    int32_t place = count;
    run_wide([=, &place]() CITYSTREAM_INLINED {
        int32_t least = count;
        for (int32_t i = 0; i < count; ++i) {
            const int32_t outside = words[i] == word ? 0 : count;
            least = std::min(least, std::max(i, outside));
        }
        place = least;
    });
    return static_cast<size_t>(place);
}

void WordRate::remember(uint32_t word, uint32_t position) {
    size_t place = place_of(word);
    if (place == recent_words_.size() && place < window_) {
        for (auto* each : {&recent_words_, &recent_positions_, &recent_literals_}) each->emplace_back();
    }
    place = std::min<size_t>(place, recent_words_.size() - 1);
    const auto move_to_front = [place](std::vector<uint32_t>& values, uint32_t front) {
        std::move_backward(values.begin(), values.begin() + static_cast<ptrdiff_t>(place),
                           values.begin() + static_cast<ptrdiff_t>(place) + 1);
        values.front() = front;
    };
    move_to_front(recent_words_, word);
    move_to_front(recent_positions_, position);
    move_to_front(recent_literals_, literal_sum(word));
}

}  // namespace citystream::codec::atlas
