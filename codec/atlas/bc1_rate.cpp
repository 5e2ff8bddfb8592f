#include "codec/atlas/bc1_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "codec/atlas/word_rate.h"

namespace citystream::codec::atlas {

namespace {

constexpr int kTexels = 16;
constexpr uint32_t kMostWindow = 4096;
constexpr size_t kRefits = 2;          ///< index words per block whose endpoints are fitted anew
constexpr size_t kEndpointTrials = 2;  ///< earlier endpoints per block for which all index words are weighed
constexpr int32_t kSixteenths = 16;
constexpr uint32_t kMostLambda = 1u << 20;  ///< a byte costs at most 64 bits: J of a row stays below 2^31

/// J in sixteenths.
uint64_t weigh(uint64_t error, uint32_t lambda, uint32_t cost) {
    return error * uint64_t{kSixteenths} + uint64_t{lambda} * cost;
}

/// Squared error of every byte of an index word (a row of four texels), for fixed endpoints.
struct RowErrors {
    std::array<std::array<int32_t, 256>, 4> error;  ///< below 2^26

    explicit RowErrors(const float code_error[4][kTexels]) {
        for (size_t row = 0; row < 4; ++row) {
            int32_t pair[2][16];
            for (size_t half = 0; half < 2; ++half) {
                const size_t texel = 4 * row + 2 * half;
                for (size_t codes = 0; codes < 16; ++codes) {
                    pair[half][codes] = static_cast<int32_t>(code_error[codes & 3][texel]) +
                                        static_cast<int32_t>(code_error[codes >> 2][texel + 1]);
                }
            }
            for (size_t high = 0; high < 16; ++high) {
                for (size_t low = 0; low < 16; ++low) error[row][high * 16 + low] = pair[0][low] + pair[1][high];
            }
        }
    }

    uint32_t of(uint32_t word) const {
        return static_cast<uint32_t>(error[0][word & 255] + error[1][word >> 8 & 255] + error[2][word >> 16 & 255] +
                                     error[3][word >> 24]);
    }

    /// The word whose rows are each best by J (in sixteenths) when their bytes are literals of these costs times
    /// lambda.
    uint32_t best_literals(std::span<const int32_t, 256> byte_costs) const {
        uint32_t word = 0;
        for (uint32_t row = 0; row < 4; ++row) {
            std::array<int32_t, 256> j;
            int32_t least = std::numeric_limits<int32_t>::max();
            for (size_t byte = 0; byte < 256; ++byte) {
                j[byte] = error[row][byte] * kSixteenths + byte_costs[byte];
                least = std::min(least, j[byte]);
            }
            word |= static_cast<uint32_t>(std::find(j.begin(), j.end(), least) - j.begin()) << (8 * row);
        }
        return word;
    }
};

/// The error when every texel has its nearest colour.
uint32_t least_error(const float code_error[4][kTexels]) {
    float nearest[kTexels];
    for (int i = 0; i < kTexels; ++i) {
        const float low = std::min(code_error[0][i], code_error[1][i]);
        const float high = std::min(code_error[2][i], code_error[3][i]);
        nearest[i] = std::min(low, high);
    }
    uint32_t sum = 0;
    for (const float error : nearest) sum += static_cast<uint32_t>(static_cast<int32_t>(error));
    return sum;
}

bool equal_endpoints(uint32_t endpoints) {
    return (endpoints & 0xffffu) == endpoints >> 16;
}

/// The few candidates with the least J.
struct Shortlist {
    struct Entry {
        uint64_t j;
        uint32_t word;
    };
    size_t capacity;
    std::vector<Entry> entries;  ///< ascending

    explicit Shortlist(size_t most) : capacity(most) { entries.reserve(most + 1); }
    /// What a further entry must be below.
    uint64_t worst() const { return entries.size() == capacity ? entries.back().j : ~uint64_t{0}; }
    void offer(uint64_t j, uint32_t word) {
        if (capacity == 0 || j >= worst()) return;
        auto place = entries.begin();
        while (place != entries.end() && place->j <= j) ++place;
        entries.insert(place, {j, word});
        if (entries.size() > capacity) entries.pop_back();
    }
};

}  // namespace

struct Bc1RateEncoder::State {
    Bc1RateOptions options;
    WordRate endpoints, indices;
    Bc1RateTotals totals;
    std::vector<uint32_t> endpoint_costs, index_costs;  ///< of the recent words
    std::vector<int32_t> endpoint_bounds;               ///< of the error with them

    explicit State(const Bc1RateOptions& given) : options(given), endpoints(given.window), indices(given.window) {}
};

namespace {

/// What bounds a block's error from below for any indices: extremes and sums of its channels.
struct BlockRange {
    int32_t low[3], high[3], sum[3];

    explicit BlockRange(const Bc1Texels& texels) {
        for (int c = 0; c < 3; ++c) {
            low[c] = 255;
            high[c] = sum[c] = 0;
            for (const float texel : texels.channel[c]) {
                const auto value = static_cast<int32_t>(texel);
                low[c] = std::min(low[c], value);
                high[c] = std::max(high[c], value);
                sum[c] += value;
            }
        }
    }

    /// The texels' mean is no nearer to the colours between the endpoints than the texels are on average (squares are
    /// convex); nor are the texels of the extremes. Without branches, for many endpoints at once.
    int32_t least_error(uint32_t endpoints, const std::array<int32_t, 3>& weights) const {
        int32_t bound = 0;
        for (int c = 0; c < 3; ++c) {
            const int32_t from = level(endpoints, c), to = level(endpoints >> 16, c);
            const int32_t first = std::min(from, to), last = std::max(from, to);
            const int32_t off = std::max(std::max(sum[c] - kTexels * last, kTexels * first - sum[c]), 0);
            const int32_t above = std::max(high[c] - last, 0), below = std::max(first - low[c], 0);
            bound += std::max(off * off >> 4, above * above + below * below) * weights[static_cast<size_t>(c)];
        }
        return bound;
    }

  private:
    static int32_t level(uint32_t colour, int channel) {
        if (channel == 1) return static_cast<int32_t>((colour >> 3 & 0xfcu) | (colour >> 9 & 3u));
        const uint32_t field = channel == 0 ? colour >> 11 : colour;
        return static_cast<int32_t>((field << 3 & 0xf8u) | (field >> 2 & 7u));
    }
};

/// Bounds for recent endpoints.
void least_errors(const BlockRange& range, std::span<const WordRate::Seen> recent, const ChannelWeights& weights,
                  std::vector<int32_t>& bounds) {
    bounds.resize(recent.size());
    std::array<int32_t, 3> weight;
    for (size_t c = 0; c < 3; ++c) weight[c] = static_cast<int32_t>(weights.weight[c]);
    int32_t* out = bounds.data();
    for (size_t i = 0; i < recent.size(); ++i) out[i] = range.least_error(recent[i].word, weight);
}

/// The search for one block's words.
class BlockChoice {
  public:
    BlockChoice(Bc1RateEncoder::State& state, const Bc1Texels& texels, const Bc1Block& best)
        : state_(state),
          weights_(state.options.encoder.weights),
          lambda_(state.options.lambda),
          texels_(texels),
          chosen_(best),
          limit_(best.error + uint64_t{kTexels} * state.options.most_rise_per_texel) {
        j_ = weigh(best.error, lambda_, state.endpoints.cost(best.endpoints) + state.indices.cost(best.indices));
        state.endpoints.recent_costs(state.endpoint_costs);
        state.indices.recent_costs(state.index_costs);
        for (size_t byte = 0; byte < 256; ++byte)
            byte_costs_[byte] = static_cast<int32_t>(lambda_ * state.indices.byte_costs()[byte]);
    }

    Bc1Block search() {
        const uint32_t own = chosen_.endpoints;
        float code_error[4][kTexels];
        bc1_code_errors(texels_, weights_, own, code_error);
        try_indices(own, state_.endpoints.cost(own), code_error, true);
        try_endpoints(own);
        return chosen_;
    }

  private:
    void take_if_better(const Bc1Block& block, uint32_t cost) {
        if (block.error > limit_) return;
        const uint64_t j = weigh(block.error, lambda_, cost);
        if (j >= j_) return;
        j_ = j;
        chosen_ = block;
    }

    /// Weighs the index words there are to choose from, for endpoints that cost `endpoint_cost`; `refit`: also with new
    /// endpoints for those that fit best.
    void try_indices(uint32_t endpoints, uint32_t endpoint_cost, const float code_error[4][kTexels], bool refit) {
        const RowErrors rows(code_error);
        const WordRate& indices = state_.indices;
        if (equal_endpoints(endpoints)) {
            take_if_better({endpoints, 0, rows.of(0)}, endpoint_cost + indices.cost(0));
            return;
        }
        const uint32_t literals = rows.best_literals(byte_costs_);
        take_if_better({endpoints, literals, rows.of(literals)}, endpoint_cost + indices.cost(literals));
        Shortlist shortlist(refit ? kRefits : 0);
        uint32_t next = 0;
        if (indices.continuation(next)) {
            take_if_better({endpoints, next, rows.of(next)}, endpoint_cost + indices.cost(next));
            if (refit) shortlist.offer(0, next);
        }
        const std::span<const WordRate::Seen> recent = indices.recent();
        for (size_t i = 0; i < recent.size(); ++i) {
            const uint32_t error = rows.of(recent[i].word), cost = state_.index_costs[i];
            take_if_better({endpoints, recent[i].word, error}, endpoint_cost + cost);
            if (refit) shortlist.offer(weigh(error, lambda_, cost), recent[i].word);
        }
        for (const Shortlist::Entry& entry : shortlist.entries) {
            const Bc1Block fitted = ordered_bc1(fit_bc1_endpoints(texels_, weights_, entry.word));
            // One colour alone shows no indices: its error is not that of the indices it was fitted to.
            if (equal_endpoints(fitted.endpoints)) continue;
            take_if_better(fitted, state_.endpoints.cost(fitted.endpoints) + indices.cost(fitted.indices));
        }
    }

    /// Endpoints that occurred before.
    void try_endpoints(uint32_t own) {
        const BlockRange range(texels_);
        Shortlist shortlist(kEndpointTrials);
        const std::span<const WordRate::Seen> recent = state_.endpoints.recent();
        float code_error[4][kTexels];
        const auto offer = [&](uint32_t word, uint32_t cost, uint64_t bound) {
            if (word == own || weigh(bound, lambda_, cost) >= std::min(j_, shortlist.worst())) return;
            bc1_code_errors(texels_, weights_, word, code_error);
            const uint32_t error = least_error(code_error);
            if (error <= limit_) shortlist.offer(weigh(error, lambda_, cost), word);
        };
        uint32_t next = 0;
        const bool goes_on = state_.endpoints.continuation(next);
        if (goes_on) offer(next, state_.endpoints.cost(next), 0);
        least_errors(range, recent, weights_, state_.endpoint_bounds);
        for (size_t i = 0; i < recent.size(); ++i) {
            if (goes_on && recent[i].word == next) continue;
            offer(recent[i].word, state_.endpoint_costs[i], static_cast<uint64_t>(state_.endpoint_bounds[i]));
        }
        for (const Shortlist::Entry& entry : shortlist.entries) {
            if (entry.j >= j_) break;
            bc1_code_errors(texels_, weights_, entry.word, code_error);
            try_indices(entry.word, state_.endpoints.cost(entry.word), code_error, false);
        }
    }

    Bc1RateEncoder::State& state_;
    const ChannelWeights& weights_;
    uint32_t lambda_;
    const Bc1Texels& texels_;
    Bc1Block chosen_;
    uint64_t limit_;
    uint64_t j_;
    std::array<int32_t, 256> byte_costs_;  ///< of index words, times lambda
};

}  // namespace

double bc1_psnr(uint64_t error, uint64_t blocks) {
    if (error == 0) return 99;
    const double channels = 3.0 * kTexels * static_cast<double>(blocks);
    return 10 * std::log10(255.0 * 255.0 * channels / static_cast<double>(error));
}

Bc1RateEncoder::Bc1RateEncoder(const Bc1RateOptions& options) {
    Bc1RateOptions checked = options;
    checked.window = std::clamp(options.window, 1u, kMostWindow);
    checked.lambda = std::min(options.lambda, kMostLambda);
    state_ = std::make_unique<State>(checked);
}

Bc1RateEncoder::~Bc1RateEncoder() = default;

std::vector<uint32_t> Bc1RateEncoder::encode(std::span<const Bc1Texels> blocks) {
    const Bc1RateOptions& options = state_->options;
    std::vector<Bc1Block> best(blocks.size());
    encode_bc1_blocks(blocks, options.encoder, best);
    std::vector<uint32_t> words;
    for (const Bc1Block& block : best) words.push_back(block.endpoints);
    state_->endpoints.expect(words);
    words.clear();
    for (const Bc1Block& block : best) words.push_back(block.indices);
    state_->indices.expect(words);
    words.clear();
    words.reserve(2 * blocks.size());
    for (size_t i = 0; i < blocks.size(); ++i) {
        Bc1Block block = best[i];
        if (options.lambda > 0) block = BlockChoice(*state_, blocks[i], block).search();
        state_->endpoints.append(block.endpoints);
        state_->indices.append(block.indices);
        ++state_->totals.blocks;
        state_->totals.best_error += best[i].error;
        state_->totals.error += block.error;
        if (block.error > best[i].error)
            state_->totals.largest_rise = std::max<uint64_t>(state_->totals.largest_rise, block.error - best[i].error);
        words.push_back(block.endpoints);
        words.push_back(block.indices);
    }
    return words;
}

const Bc1RateTotals& Bc1RateEncoder::totals() const {
    return state_->totals;
}

}  // namespace citystream::codec::atlas
