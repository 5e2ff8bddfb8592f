#include "codec/facade/binary_factorization.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>
#include <string>
#include <utility>

namespace citystream::codec::facade {

namespace {

/// A matrix of bits.
class BitMatrix {
  public:
    BitMatrix(size_t rows, size_t columns) : words_((columns + 63) / 64), bits_(rows * words_, 0) {}
    void set(size_t row, size_t column) { bits_[row * words_ + column / 64] |= uint64_t{1} << (column % 64); }
    void clear(size_t row, size_t column) { bits_[row * words_ + column / 64] &= ~(uint64_t{1} << (column % 64)); }
    std::span<const uint64_t> row(size_t row) const { return {&bits_[row * words_], words_}; }

  private:
    size_t words_;
    std::vector<uint64_t> bits_;
};

template <typename Visit>
void for_each_bit(uint64_t word, size_t base, Visit visit) {
    for (; word != 0; word &= word - 1) visit(base + static_cast<size_t>(std::countr_zero(word)));
}

/// Rows or columns that matter for one value, and their weights.
struct Side {
    std::vector<uint32_t> lines;  ///< distinct rows or columns of the matrix, rising
    std::vector<uint64_t> weight;
    std::vector<uint32_t> local;  ///< of a line of the matrix: its place in `lines`
};

Side side_of(const std::vector<uint8_t>& used, const std::vector<uint32_t>& weight) {
    Side side;
    side.local.resize(used.size());
    for (uint32_t line = 0; line < used.size(); ++line) {
        if (used[line] == 0) continue;
        side.local[line] = static_cast<uint32_t>(side.lines.size());
        side.lines.push_back(line);
        side.weight.push_back(weight[line]);
    }
    return side;
}

struct Clique {
    std::vector<uint32_t> rows;     ///< in the order of growth
    std::vector<uint64_t> columns;  ///< bits
    uint64_t size = 0;              ///< texels that it gives their value
};

/// The greedy sequence of cliques of one graph.
struct CliqueGrowth {
    Clique clique;
    std::vector<uint64_t> gain;   ///< of each row: wanted weight within the columns left
    std::vector<uint8_t> joined;  ///< of each row
    uint64_t reach = 0;           ///< wanted weight of all rows within the columns left: no clique to come is larger
};

/// The entries of one value on the rows and columns that have any: `wanted` ones are still to be covered, and a clique
/// may only hold `allowed` ones (the wanted ones and wild cards).
class ValueGraph {
  public:
    ValueGraph(Side rows, Side columns, bool wild_cards)
        : rows_(std::move(rows)),
          columns_(std::move(columns)),
          wanted_by_column_(columns_.lines.size(), rows_.lines.size()),
          allowed_(rows_.lines.size(), columns_.lines.size()),
          wanted_weight_(rows_.lines.size(), 0),
          wild_cards_(wild_cards) {}

    void add_wanted(uint32_t row, uint32_t column) {
        const uint32_t r = rows_.local[row], c = columns_.local[column];
        wanted_by_column_.set(c, r);
        allowed_.set(r, c);
        wanted_weight_[r] += columns_.weight[c];
        left_ += rows_.weight[r] * columns_.weight[c];
    }
    void allow(uint32_t local_row, uint32_t local_column) { allowed_.set(local_row, local_column); }
    const Side& rows() const { return rows_; }
    const Side& columns() const { return columns_; }
    bool empty() const { return left_ == 0; }
    uint64_t work() const { return work_; }

    /// Finds the next clique and covers it.
    BinaryTerm take_term() {
        const Clique clique = grow_clique();
        BinaryTerm term;
        term.texels = clique.size;
        for (const uint32_t r : clique.rows) term.rows.push_back(rows_.lines[r]);
        std::sort(term.rows.begin(), term.rows.end());
        for (size_t w = 0; w < clique.columns.size(); ++w) {
            for_each_bit(clique.columns[w], 64 * w, [&](size_t c) {
                term.columns.push_back(columns_.lines[c]);
                for (const uint32_t r : clique.rows) cover(r, c);
            });
        }
        return term;
    }

  private:
    bool is_wanted(size_t r, size_t c) const { return (wanted_by_column_.row(c)[r / 64] >> (r % 64) & 1) != 0; }

    void cover(size_t r, size_t c) {
        if (!is_wanted(r, c)) return;
        wanted_by_column_.clear(c, r);
        if (!wild_cards_) allowed_.clear(r, c);
        wanted_weight_[r] -= columns_.weight[c];
        left_ -= rows_.weight[r] * columns_.weight[c];
    }

    /// Whether a row may join without taking columns away.
    bool holds_all(size_t r, const std::vector<uint64_t>& columns) const {
        const auto allowed = allowed_.row(r);
        for (size_t w = 0; w < columns.size(); ++w) {
            if ((columns[w] & ~allowed[w]) != 0) return false;
        }
        return true;
    }

    /// The largest clique of the greedy sequence.
    Clique grow_clique() {
        const size_t row_count = rows_.lines.size();
        CliqueGrowth growth{{{}, all_columns(), 0}, wanted_weight_, std::vector<uint8_t>(row_count, 0), left_};
        Clique best;
        while (growth.reach > best.size) {
            const size_t next = next_row(growth);
            work_ += row_count * (1 + growth.clique.columns.size());
            if (next == row_count) break;
            keep_columns(growth, allowed_.row(next));
            for (size_t r = 0; r < row_count; ++r) {
                if (growth.joined[r] != 0 || growth.gain[r] == 0 || !holds_all(r, growth.clique.columns)) continue;
                growth.joined[r] = 1;
                growth.clique.rows.push_back(static_cast<uint32_t>(r));
                growth.clique.size += rows_.weight[r] * growth.gain[r];
            }
            if (growth.clique.size > best.size) best = growth.clique;
        }
        return best;
    }

    /// Takes away the columns that a row does not hold: by what they gave or, if that is less, from what stays.
    void keep_columns(CliqueGrowth& growth, std::span<const uint64_t> allowed) {
        std::vector<uint64_t> removed = growth.clique.columns;
        int kept_count = 0, removed_count = 0;
        for (size_t w = 0; w < removed.size(); ++w) {
            removed[w] &= ~allowed[w];
            growth.clique.columns[w] &= allowed[w];
            removed_count += std::popcount(removed[w]);
            kept_count += std::popcount(growth.clique.columns[w]);
        }
        if (removed_count <= kept_count) {
            count_columns(growth, removed, ~uint64_t{0});
            return;
        }
        std::fill(growth.gain.begin(), growth.gain.end(), 0);
        growth.reach = growth.clique.size = 0;
        count_columns(growth, growth.clique.columns, 1);
    }

    /// Adds what the columns give, or, with `sign` = -1 modulo 2^64, takes it away.
    void count_columns(CliqueGrowth& growth, const std::vector<uint64_t>& columns, uint64_t sign) {
        for (size_t w = 0; w < columns.size(); ++w) {
            for_each_bit(columns[w], 64 * w, [&](size_t c) {
                const auto wanted = wanted_by_column_.row(c);
                const uint64_t weight = sign * columns_.weight[c];
                for (size_t v = 0; v < wanted.size(); ++v) {
                    work_ += 1 + static_cast<uint64_t>(std::popcount(wanted[v]));
                    for_each_bit(wanted[v], 64 * v, [&](size_t r) {
                        growth.gain[r] += weight;
                        growth.reach += rows_.weight[r] * weight;
                        if (growth.joined[r] != 0) growth.clique.size += rows_.weight[r] * weight;
                    });
                }
            });
        }
    }

    std::vector<uint64_t> all_columns() const {
        const size_t count = columns_.lines.size();
        std::vector<uint64_t> bits((count + 63) / 64, ~uint64_t{0});
        if (count % 64 != 0) bits.back() = (uint64_t{1} << (count % 64)) - 1;
        return bits;
    }

    /// The row not yet joined with the greatest gain, the first of equals; row count when no gain is left.
    static size_t next_row(const CliqueGrowth& growth) {
        size_t next = growth.gain.size();
        uint64_t most = 0;
        for (size_t r = 0; r < growth.gain.size(); ++r) {
            if (growth.joined[r] == 0 && growth.gain[r] > most) {
                most = growth.gain[r];
                next = r;
            }
        }
        return next;
    }

    Side rows_, columns_;
    BitMatrix wanted_by_column_, allowed_;
    std::vector<uint64_t> wanted_weight_;  ///< of each row
    uint64_t left_ = 0;                    ///< wanted texels
    uint64_t work_ = 0;                    ///< steps of innermost loops
    bool wild_cards_;
};

/// The cells of each value, values rising.
struct CellsByValue {
    std::vector<uint32_t> cells;   ///< places in the matrix's entries
    std::vector<size_t> begins;    ///< of each value in `cells`; one more at the end
    std::vector<uint64_t> texels;  ///< of each value
    size_t values() const { return texels.size(); }
    std::span<const uint32_t> of(size_t value) const {
        return std::span(cells).subspan(begins[value], begins[value + 1] - begins[value]);
    }
};

CellsByValue cells_by_value(const DistinctMatrix& matrix) {
    CellsByValue sorted;
    sorted.cells.resize(matrix.entries.size());
    std::iota(sorted.cells.begin(), sorted.cells.end(), 0U);
    const auto& entries = matrix.entries;
    std::stable_sort(sorted.cells.begin(), sorted.cells.end(),
                     [&](uint32_t a, uint32_t b) { return entries[a] < entries[b]; });
    for (size_t i = 0; i < sorted.cells.size(); ++i) {
        if (i == 0 || entries[sorted.cells[i]] != entries[sorted.cells[i - 1]]) {
            sorted.begins.push_back(i);
            sorted.texels.push_back(0);
        }
        const uint32_t cell = sorted.cells[i];
        sorted.texels.back() +=
            uint64_t{matrix.row_weight[cell / matrix.columns()]} * matrix.column_weight[cell % matrix.columns()];
    }
    sorted.begins.push_back(sorted.cells.size());
    return sorted;
}

ValueGraph graph_of(const DistinctMatrix& matrix, std::span<const uint32_t> cells, bool wild_cards) {
    std::vector<uint8_t> rows(matrix.rows(), 0), columns(matrix.columns(), 0);
    for (const uint32_t cell : cells) {
        rows[cell / matrix.columns()] = 1;
        columns[cell % matrix.columns()] = 1;
    }
    ValueGraph graph(side_of(rows, matrix.row_weight), side_of(columns, matrix.column_weight), wild_cards);
    for (const uint32_t cell : cells) graph.add_wanted(cell / matrix.columns(), cell % matrix.columns());
    return graph;
}

/// The terms found so far and what they may cost.
struct TermList {
    uint64_t most_terms;
    std::vector<BinaryTerm> terms = {};
    uint64_t work = 0;

    /// Takes all terms of a value.
    Status take(ValueGraph& graph, uint32_t value) {
        while (!graph.empty()) {
            if (terms.size() >= most_terms) return too_many_terms(most_terms);
            if (work + graph.work() > kMostFactorWork) return Error{"they would take too long"};
            terms.push_back(graph.take_term());
            terms.back().value = value;
        }
        work += graph.work();
        return Done{};
    }

    static Error too_many_terms(uint64_t most_terms) {
        return Error{"they need more than " + std::to_string(most_terms) + " terms"};
    }
};

}  // namespace

Result<BinaryFactors> factor_binary(const DistinctMatrix& matrix, uint64_t most_terms) {
    const CellsByValue cells = cells_by_value(matrix);
    if (cells.values() - 1 > most_terms) return TermList::too_many_terms(most_terms);
    TermList list{most_terms};
    for (size_t value = cells.values() - 1; value > 0; --value) {
        ValueGraph graph = graph_of(matrix, cells.of(value), false);
        if (const Status status = list.take(graph, matrix.entries[cells.of(value).front()]); !status)
            return status.error();
    }
    return BinaryFactors{matrix.entries[cells.cells.front()], std::move(list.terms)};
}

Result<BinaryFactors> factor_binary_first_match(const DistinctMatrix& matrix, uint64_t most_terms) {
    const CellsByValue cells = cells_by_value(matrix);
    if (cells.values() - 1 > most_terms) return TermList::too_many_terms(most_terms);
    std::vector<size_t> order(cells.values());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return cells.texels[a] < cells.texels[b]; });
    std::vector<uint8_t> covered(matrix.entries.size(), 0);
    const uint32_t base = matrix.entries[cells.of(order.back()).front()];
    order.pop_back();
    TermList list{most_terms};
    for (const size_t value : order) {
        ValueGraph graph = graph_of(matrix, cells.of(value), true);
        const Side &rows = graph.rows(), &columns = graph.columns();
        for (uint32_t r = 0; r < rows.lines.size(); ++r) {
            const uint8_t* row = &covered[size_t{rows.lines[r]} * matrix.columns()];
            for (uint32_t c = 0; c < columns.lines.size(); ++c) {
                if (row[columns.lines[c]] != 0) graph.allow(r, c);
            }
        }
        if (const Status status = list.take(graph, matrix.entries[cells.of(value).front()]); !status)
            return status.error();
        for (const uint32_t cell : cells.of(value)) covered[cell] = 1;
    }
    return BinaryFactors{base, std::move(list.terms)};
}

void put_large_terms_first(BinaryFactors& factors) {
    std::stable_sort(factors.terms.begin(), factors.terms.end(),
                     [](const BinaryTerm& a, const BinaryTerm& b) { return a.texels > b.texels; });
}

double mean_words_searched(const DistinctMatrix& matrix, const BinaryFactors& factors) {
    const uint64_t texels = std::accumulate(matrix.row_weight.begin(), matrix.row_weight.end(), uint64_t{0}) *
                            std::accumulate(matrix.column_weight.begin(), matrix.column_weight.end(), uint64_t{0});
    uint64_t searched = 0, without_hit = texels;
    for (size_t term = 0; term < factors.terms.size(); ++term) {
        searched += 2 * (term / 32 + 1) * factors.terms[term].texels;
        without_hit -= factors.terms[term].texels;
    }
    searched += 2 * ((factors.terms.size() + 31) / 32) * without_hit;
    return static_cast<double>(searched) / static_cast<double>(texels);
}

}  // namespace citystream::codec::facade
