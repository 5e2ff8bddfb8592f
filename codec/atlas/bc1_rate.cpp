#include "codec/atlas/bc1_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "codec/atlas/bc1_candidates.h"
#include "codec/atlas/wide_loops.h"
#include "codec/atlas/word_rate.h"

namespace citystream::codec::atlas {

namespace {

constexpr int kTexels = 16;
constexpr uint32_t kMostWindow = 4096;
constexpr size_t kRefits = 2;               ///< index words per block whose endpoints are fitted anew
constexpr size_t kEndpointTrials = 2;       ///< earlier endpoints per block for which all index words are weighed
constexpr uint32_t kMostLambda = 1u << 20;  ///< a byte costs at most 64 bits: J of a row stays below 2^31

/// J in sixteenths.
uint64_t weigh(uint64_t error, uint32_t lambda, uint32_t cost) {
    return error * uint64_t{kErrorUnits} + uint64_t{lambda} * cost;
}

bool equal_endpoints(uint32_t endpoints) {
    return (endpoints & 0xffffu) == endpoints >> 16;
}

/// The few candidates with the least J.
template <size_t kCapacity>
struct Shortlist {
    struct Entry {
        uint64_t j = UINT64_MAX;
        uint32_t word = 0;
    };
    std::array<Entry, kCapacity> slots;  ///< ascending
    size_t count = 0;

    std::span<const Entry> entries() const { return {slots.data(), count}; }
    /// What a further entry must be below.
    uint64_t worst() const { return slots.back().j; }
    void offer(uint64_t j, uint32_t word) {
        if (j >= worst()) return;
        size_t place = std::min(count, kCapacity - 1);
        for (; place > 0 && slots[place - 1].j > j; --place) slots[place] = slots[place - 1];
        slots[place] = {j, word};
        count = std::min(count + 1, kCapacity);
    }
    /// Offers js[i], words[i] for all i.
    void offer_all(std::span<const uint64_t> js, std::span<const uint32_t> words) {
        uint64_t below = worst();
        for (size_t i = 0; i < js.size(); ++i) {
            if (js[i] >= below) continue;
            offer(js[i], words[i]);
            below = worst();
        }
    }
};

}  // namespace

struct Bc1RateEncoder::State {
    Bc1RateOptions options;
    WordRate endpoints, indices;
    Bc1RateTotals totals;
    std::vector<uint32_t> endpoint_costs, index_costs;  ///< of the recent words, times lambda
    std::vector<int32_t> endpoint_bounds;               ///< of the error with them
    std::vector<uint64_t> index_js;                     ///< of the recent index words, with some endpoints
    std::vector<uint32_t> trial_words, trial_costs, trial_errors;
    std::vector<uint64_t> trial_js;

    explicit State(const Bc1RateOptions& given) : options(given), endpoints(given.window), indices(given.window) {}
};

namespace {

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
        state.endpoints.recent_costs(state.endpoint_costs, lambda_);
        state.indices.recent_costs(state.index_costs, lambda_);
        state.index_js.resize(state.index_costs.size());
        least_index_cost_ = uint64_t{lambda_} * state.indices.least_cost();
        other_index_cost_ = std::max(least_index_cost_, least_other_index_cost());
        for (size_t byte = 0; byte < 256; ++byte)
            byte_costs_[byte] = static_cast<int32_t>(lambda_ * state.indices.byte_costs()[byte]);
    }

    Bc1Block search() {
        const uint32_t own = chosen_.endpoints;
        try_indices(own, state_.endpoints.cost(own), Bc1RowErrors(texels_, weights_, own));
        refit_endpoints(own);
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

    /// Weighs the index words there are to choose from, for endpoints that cost `endpoint_cost`.
    void try_indices(uint32_t endpoints, uint32_t endpoint_cost, const Bc1RowErrors& rows) {
        const WordRate& indices = state_.indices;
        const auto take = [&](uint32_t word) {
            take_if_better({endpoints, word, rows.of(word)}, endpoint_cost + indices.cost(word));
        };
        if (equal_endpoints(endpoints)) return take(0);
        take(rows.cheapest(byte_costs_));
        try_continuation(endpoints, endpoint_cost, rows);
        const std::span<const uint32_t> recent = indices.recent();
        const uint64_t endpoint_j = uint64_t{lambda_} * endpoint_cost;
        if (rows.weigh(recent, state_.index_costs, state_.index_js) + endpoint_j >= j_) return;
        for (size_t i = 0; i < recent.size(); ++i) {
            const uint64_t j = state_.index_js[i] + endpoint_j;
            if (j >= j_) continue;
            const uint32_t error = rows.of(recent[i]);
            if (error > limit_) continue;
            j_ = j;
            chosen_ = {endpoints, recent[i], error};
        }
    }

    /// Weighs the index word that makes a match longer, where there is one.
    void try_continuation(uint32_t endpoints, uint32_t endpoint_cost, const Bc1RowErrors& rows) {
        uint32_t next = 0;
        if (state_.indices.continuation(next))
            take_if_better({endpoints, next, rows.of(next)}, endpoint_cost + state_.indices.cost(next));
    }

    /// What all index words but the one that makes a match longer cost at least, times lambda; 0 outside matches.
    uint64_t least_other_index_cost() const {
        uint32_t next = 0;
        if (!state_.indices.continuation(next)) return 0;
        const uint32_t* words = state_.indices.recent().data();
        const uint32_t* costs = state_.index_costs.data();
        const size_t count = state_.index_costs.size();
        uint32_t least = lambda_ * state_.indices.least_other_cost();
        run_wide([=, &least]() CITYSTREAM_INLINED {
            uint32_t smallest = least;
            for (size_t i = 0; i < count; ++i) {
                const uint32_t none = words[i] == next ? UINT32_MAX : 0;
                smallest = std::min(smallest, costs[i] | none);
            }
            least = smallest;
        });
        return least;
    }

    /// New endpoints for the index words that fit best with the block's own, which were tried last.
    void refit_endpoints(uint32_t own) {
        if (equal_endpoints(own)) return;
        const WordRate& indices = state_.indices;
        Shortlist<kRefits> shortlist;
        uint32_t next = 0;
        if (indices.continuation(next)) shortlist.offer(0, next);
        shortlist.offer_all(state_.index_js, indices.recent());
        for (const auto& entry : shortlist.entries()) {
            const Bc1Block fitted = ordered_bc1(fit_bc1_endpoints(texels_, weights_, entry.word));
            // One colour alone shows no indices: its error is not that of the indices it was fitted to.
            if (equal_endpoints(fitted.endpoints)) continue;
            take_if_better(fitted, state_.endpoints.cost(fitted.endpoints) + indices.cost(fitted.indices));
        }
    }

    /// Endpoints that occurred before.
    void try_endpoints(uint32_t own) {
        uint32_t next = 0;
        const bool goes_on = state_.endpoints.continuation(next) && next != own;
        list_trials(own, goes_on ? &next : nullptr);
        const std::span<const uint32_t> words = state_.trial_words, costs = state_.trial_costs;
        std::vector<uint32_t>& errors = state_.trial_errors;
        errors.resize(words.size());
        least_bc1_errors(texels_, weights_, words, errors);
        std::vector<uint64_t>& js = state_.trial_js;
        js.resize(words.size());
        weigh_errors(errors, costs, js);
        Shortlist<kEndpointTrials> shortlist;
        shortlist.offer_all(js, words);
        for (const auto& entry : shortlist.entries()) {
            if (entry.j + least_index_cost_ >= j_) break;
            const Bc1RowErrors rows(texels_, weights_, entry.word);
            const uint32_t cost = state_.endpoints.cost(entry.word);
            if (entry.j + other_index_cost_ >= j_ && !equal_endpoints(entry.word)) {
                try_continuation(entry.word, cost, rows);
            } else {
                try_indices(entry.word, cost, rows);
            }
        }
    }

    /// J of each error and cost; UINT64_MAX where the error is too large.
    void weigh_errors(std::span<const uint32_t> errors, std::span<const uint32_t> costs, std::span<uint64_t> js) const {
        const uint32_t *error = errors.data(), *cost = costs.data();
        uint64_t* out = js.data();
        const size_t count = js.size();
        const uint64_t limit = limit_;
        run_wide([=]() CITYSTREAM_INLINED {
            CITYSTREAM_INDEPENDENT
            for (size_t i = 0; i < count; ++i)
                out[i] = error[i] <= limit ? error[i] * uint64_t{kErrorUnits} + cost[i] : UINT64_MAX;
        });
    }

    /// Lists `next`, where there is one, and other recent endpoints whose error may be small enough; not `own`.
    void list_trials(uint32_t own, const uint32_t* next) {
        const std::span<const uint32_t> recent = state_.endpoints.recent();
        std::vector<int32_t>& bounds = state_.endpoint_bounds;
        bounds.resize(recent.size());
        bound_bc1_errors(texels_, weights_, recent, bounds);
        state_.trial_words.resize(recent.size() + 2);
        state_.trial_costs.resize(recent.size() + 2);
        const uint64_t below = j_ - std::min(j_, least_index_cost_), limit = limit_;
        const uint32_t* costs = state_.endpoint_costs.data();
        uint32_t *trial_words = state_.trial_words.data(), *trial_costs = state_.trial_costs.data();
        size_t count = 0;
        if (next != nullptr) {
            trial_words[0] = *next;
            trial_costs[0] = lambda_ * state_.endpoints.cost(*next);
            ++count;
        }
        const uint32_t other = next != nullptr ? *next : own;
        for (size_t i = 0; i < recent.size(); ++i) {
            const uint32_t word = recent[i], cost = costs[i];
            trial_words[count] = word;
            trial_costs[count] = cost;
            const uint64_t bound = static_cast<uint32_t>(bounds[i]);
            const bool open = bound * kErrorUnits + cost < below && bound <= limit;
            count += static_cast<size_t>(open & (word != own) & (word != other));
        }
        state_.trial_words.resize(count);
        state_.trial_costs.resize(count);
    }

    Bc1RateEncoder::State& state_;
    const ChannelWeights& weights_;
    uint32_t lambda_;
    const Bc1Texels& texels_;
    Bc1Block chosen_;
    uint64_t limit_;
    uint64_t j_;
    uint64_t least_index_cost_, other_index_cost_;  ///< times lambda
    std::array<int32_t, 256> byte_costs_;           ///< of index words, times lambda
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
