#include "codec/facade/binary_map.h"

#include <algorithm>
#include <bit>
#include <string>

#include "codec/facade/binary_factorization.h"
#include "codec/facade/binary_layout.h"
#include "codec/facade/distinct_matrix.h"
#include "codec/facade/raw_layout.h"
#include "codec/facade/raw_map.h"
#include "codec/facade/texel_form.h"

namespace citystream::codec::facade {

namespace {

constexpr uint32_t kDescriptors[] = {FACADE_BINARY_WORD_DISPLACEMENT, FACADE_BINARY_WORD_MATERIAL,
                                     FACADE_BINARY_WORD_BOX_INDEX};

static_assert(FACADE_BINARY_WORD_MATERIAL == FACADE_BINARY_WORD_DISPLACEMENT + FACADE_BINARY_MAP_WORDS);
static_assert(FACADE_BINARY_WORD_BOX_INDEX == FACADE_BINARY_WORD_MATERIAL + FACADE_BINARY_MAP_WORDS);

// Encoding.

struct Factored {
    DistinctMatrix matrix;
    BinaryFactors factors;
    uint64_t row_words() const { return (factors.terms.size() + 31) / 32; }
};

/// Rows of bits of all distinct rows (or columns): `row_words` each.
template <typename LinesOfTerm>
std::vector<uint32_t> pack_bits(const Factored& map, uint32_t lines, LinesOfTerm lines_of_term) {
    std::vector<uint32_t> bits(lines * map.row_words(), 0);
    for (size_t term = 0; term < map.factors.terms.size(); ++term) {
        for (const uint32_t line : lines_of_term(map.factors.terms[term]))
            bits[line * map.row_words() + term / 32] |= 1U << (term % 32);
    }
    return bits;
}

/// The distinct line of every texel row or column.
std::vector<uint32_t> texel_lines(const std::vector<uint32_t>& breaks, const std::vector<uint32_t>& line_of) {
    std::vector<uint32_t> lines;
    lines.reserve(breaks.back());
    for (size_t run = 0; run < line_of.size(); ++run)
        lines.insert(lines.end(), breaks[run + 1] - breaks[run], line_of[run]);
    return lines;
}

void append_halves(std::vector<uint32_t>& words, const std::vector<uint32_t>& values) {
    const size_t first = words.size();
    words.resize(first + packed_words(values.size(), 16), 0);
    for (size_t i = 0; i < values.size(); ++i) words[first + i / 2] |= values[i] << (16 * (i % 2));
}

/// Appends one factored matrix and fills in its descriptor. `bias` is taken off its values.
class FactorWriter {
  public:
    FactorWriter(std::vector<uint32_t>& words, const RunGrid& grid, BinaryVariant variant)
        : words_(words), grid_(grid), shared_(variant == BinaryVariant::kShared) {}

    void write(uint32_t descriptor, const Factored& map, uint32_t bias) {
        const auto rows = pack_bits(
            map, map.matrix.rows(), [](const BinaryTerm& t) -> auto& { return t.rows; });
        const auto columns = pack_bits(
            map, map.matrix.columns(), [](const BinaryTerm& t) -> auto& { return t.columns; });
        const auto texel_rows = texel_lines(grid_.y_breaks, map.matrix.row_of);
        const auto texel_columns = texel_lines(grid_.x_breaks, map.matrix.column_of);
        uint32_t head[FACADE_BINARY_MAP_WORDS] = {};
        head[FACADE_BINARY_MAP_ROW_WORDS] = static_cast<uint32_t>(map.row_words());
        head[FACADE_BINARY_MAP_TERMS] = static_cast<uint32_t>(map.factors.terms.size());
        head[FACADE_BINARY_MAP_BASE] = map.factors.base - bias;
        head[FACADE_BINARY_MAP_X] = append_rows(rows, texel_rows, map.row_words());
        head[FACADE_BINARY_MAP_Y] = append_rows(columns, texel_columns, map.row_words());
        head[FACADE_BINARY_MAP_SIGMA] = end();
        for (const BinaryTerm& term : map.factors.terms) words_.push_back(term.value - map.factors.base);
        if (shared_ && !map.factors.terms.empty()) {
            head[FACADE_BINARY_MAP_X_INDEX] = end();
            append_halves(words_, texel_rows);
            head[FACADE_BINARY_MAP_Y_INDEX] = end();
            append_halves(words_, texel_columns);
        }
        std::copy(std::begin(head), std::end(head), words_.begin() + descriptor);
    }

  private:
    uint32_t end() const { return static_cast<uint32_t>(words_.size()); }

    uint32_t append_rows(const std::vector<uint32_t>& rows, const std::vector<uint32_t>& texel_rows, size_t row_words) {
        const uint32_t first = end();
        if (shared_) {
            words_.insert(words_.end(), rows.begin(), rows.end());
            return first;
        }
        for (const size_t row : texel_rows) {
            const auto begin = rows.begin() + static_cast<std::ptrdiff_t>(row * row_words);
            words_.insert(words_.end(), begin, begin + static_cast<std::ptrdiff_t>(row_words));
        }
        return first;
    }

    std::vector<uint32_t>& words_;
    const RunGrid& grid_;
    bool shared_;
};

/// Of disjoint terms, large ones first, and overlapping ones those among which a hit is found sooner.
Result<BinaryFactors> factor_for_search(const DistinctMatrix& matrix, uint64_t most_terms) {
    auto overlapping = factor_binary_first_match(matrix, most_terms);
    auto disjoint = factor_binary(matrix, most_terms);
    if (!disjoint.ok()) return overlapping;
    put_large_terms_first(*disjoint);
    if (!overlapping.ok() || mean_words_searched(matrix, *disjoint) < mean_words_searched(matrix, *overlapping))
        return disjoint;
    return overlapping;
}

/// Factors the three matrices, each in what the ones before left of the words of the raw map.
class Factorizer {
  public:
    Factorizer(const RunGrid& grid, BinaryVariant variant, uint32_t most_times_raw)
        : grid_(grid), variant_(variant), allowance_(grid, most_times_raw) {}

    void set_box_count(uint64_t count) { allowance_.set_box_count(count); }

    Result<Factored> factor(std::string_view what, const std::vector<uint32_t>& values) {
        Factored map{make_distinct_matrix(grid_, values), {}};
        const bool shared = variant_ == BinaryVariant::kShared;
        const uint64_t lines = shared ? map.matrix.rows() + map.matrix.columns() : grid_.width() + grid_.height();
        // A term takes one bit in each line and a word of its own.
        const uint64_t most_terms = allowance_.words() * 32 / (lines + 32);
        auto factors = shared ? factor_for_search(map.matrix, most_terms) : factor_binary(map.matrix, most_terms);
        if (!factors) return refusal(what, factors.error().message);
        map.factors = std::move(*factors);
        uint64_t words = lines * map.row_words() + map.factors.terms.size();
        if (shared) words += packed_words(grid_.height(), 16) + packed_words(grid_.width(), 16);
        if (words > allowance_.words()) return refusal(what, "the map would be larger than raw");
        allowance_.take(words);
        return map;
    }

  private:
    static Error refusal(std::string_view what, const std::string& why) {
        return Error{"binary factors of the " + std::string(what) + " do not pay: " + why};
    }

    const RunGrid& grid_;
    BinaryVariant variant_;
    WordAllowance allowance_;
};

// Reading.

struct FactorView {
    std::span<const uint32_t> words;
    uint32_t x, y, sigma, row_words, base, x_index, y_index, terms;

    FactorView(std::span<const uint32_t> map, uint32_t descriptor)
        : words(map),
          x(map[descriptor + FACADE_BINARY_MAP_X]),
          y(map[descriptor + FACADE_BINARY_MAP_Y]),
          sigma(map[descriptor + FACADE_BINARY_MAP_SIGMA]),
          row_words(map[descriptor + FACADE_BINARY_MAP_ROW_WORDS]),
          base(map[descriptor + FACADE_BINARY_MAP_BASE]),
          x_index(map[descriptor + FACADE_BINARY_MAP_X_INDEX]),
          y_index(map[descriptor + FACADE_BINARY_MAP_Y_INDEX]),
          terms(map[descriptor + FACADE_BINARY_MAP_TERMS]) {}

    uint64_t row_start(uint32_t texel_row) const { return x + uint64_t{line(x_index, texel_row)} * row_words; }
    uint64_t column_start(uint32_t texel_column) const { return y + uint64_t{line(y_index, texel_column)} * row_words; }

    /// Entry at texel (column, row); `hits` becomes the number of terms that cover it.
    int32_t entry(uint32_t column, uint32_t row, uint32_t& hits) const {
        const uint64_t i = row_start(row), j = column_start(column);
        uint32_t value = base;
        hits = 0;
        for (uint32_t w = 0; w < row_words; ++w) {
            const uint32_t bits = words[i + w] & words[j + w];
            if (bits != 0 && hits == 0) value += words[sigma + 32 * w + static_cast<uint32_t>(std::countr_zero(bits))];
            hits += static_cast<uint32_t>(std::popcount(bits));
        }
        return static_cast<int32_t>(value);
    }

    /// The same as the shader does it: the first hit ends it.
    int32_t look_up(uint32_t column, uint32_t row) const {
        const uint64_t i = row_start(row), j = column_start(column);
        for (uint32_t w = 0; w < row_words; ++w) {
            const uint32_t bits = words[i + w] & words[j + w];
            if (bits != 0)
                return static_cast<int32_t>(base +
                                            words[sigma + 32 * w + static_cast<uint32_t>(std::countr_zero(bits))]);
        }
        return static_cast<int32_t>(base);
    }

  private:
    uint32_t line(uint32_t index, uint32_t texel_line) const {
        return index == 0 ? texel_line : packed_entry(words, index, 16, texel_line);
    }
};

Error misplaced(uint32_t descriptor) {
    return error_at_word("sections of a binary factor map are not in their places", descriptor);
}

Status check_absent_terms(const FactorView& map, uint64_t begin, uint64_t end) {
    if (map.terms % 32 == 0) return Done{};
    const uint32_t absent = ~((1U << (map.terms % 32)) - 1);
    for (uint64_t last = begin + map.row_words - 1; last < end; last += map.row_words) {
        if ((map.words[last] & absent) != 0) return error_at_word("bit of a binary term that does not exist", last);
    }
    return Done{};
}

Status check_index(const FactorView& map, uint32_t index, uint32_t count, uint64_t lines) {
    for (uint32_t i = 0; i < count; ++i) {
        if (packed_entry(map.words, index, 16, i) >= lines)
            return error_at_word("row of a binary factor that does not exist", index + i / 2);
    }
    return Done{};
}

/// Where the sections of one matrix end, if they begin at `begin`.
Result<uint64_t> check_factors(std::span<const uint32_t> words, const FormHead& head, uint32_t descriptor,
                               uint64_t begin, bool shared) {
    const FactorView map(words, descriptor);
    if (map.row_words != (uint64_t{map.terms} + 31) / 32) return misplaced(descriptor);
    if (map.x != begin || map.y < map.x || map.sigma < map.y) return misplaced(descriptor);
    const uint64_t x_words = map.y - map.x, y_words = map.sigma - map.y;
    const bool has_index = shared && map.terms > 0;
    if (!has_index) {
        if (x_words != uint64_t{head.height} * map.row_words || y_words != uint64_t{head.width} * map.row_words)
            return misplaced(descriptor);
        if (map.x_index != 0 || map.y_index != 0) return misplaced(descriptor);
    } else if (x_words % map.row_words != 0 || y_words % map.row_words != 0) {
        return misplaced(descriptor);
    }
    uint64_t end = uint64_t{map.sigma} + map.terms;
    if (has_index) {
        if (map.x_index != end || map.y_index != end + packed_words(head.height, 16)) return misplaced(descriptor);
        end = map.y_index + packed_words(head.width, 16);
    }
    if (end > words.size()) return error_at_word("binary factor map ends within its factors", words.size());
    if (map.terms == 0) return end;
    if (const Status status = check_absent_terms(map, map.x, map.sigma); !status) return status.error();
    if (!has_index) return end;
    if (const Status status = check_index(map, map.x_index, head.height, x_words / map.row_words); !status)
        return status.error();
    if (const Status status = check_index(map, map.y_index, head.width, y_words / map.row_words); !status)
        return status.error();
    return end;
}

bool is_shared(std::span<const uint32_t> words) {
    return words[FACADE_BINARY_WORD_FLAGS] == FACADE_BINARY_FLAG_SHARED;
}

/// Breaks of the runs of texel lines with the same bits in D and in M.
template <typename Start>
std::vector<uint32_t> equal_runs(const FactorView& d, const FactorView& m, uint32_t count, Start start) {
    const auto same = [&](const FactorView& map, uint32_t line) {
        const uint32_t* words = map.words.data();
        const uint64_t a = start(map, line - 1), b = start(map, line);
        return a == b || std::equal(words + a, words + a + map.row_words, words + b);
    };
    std::vector<uint32_t> breaks = {0};
    for (uint32_t line = 1; line < count; ++line) {
        if (!same(d, line) || !same(m, line)) breaks.push_back(line);
    }
    breaks.push_back(count);
    return breaks;
}

/// Label of a texel; fails where the factors do not give one.
Result<uint32_t> label_of(const FactorView& d, const FactorView& m, uint32_t x, uint32_t y, bool shared) {
    uint32_t d_hits = 0, m_hits = 0;
    const int32_t depth = d.entry(x, y, d_hits), material = m.entry(x, y, m_hits);
    const auto at = [&](const char* what) {
        return Error{std::string(what) + " at texel " + std::to_string(x) + ", " + std::to_string(y)};
    };
    if (!shared && (d_hits > 1 || m_hits > 1)) return at("binary terms overlap");
    if (depth < INT16_MIN || depth > INT16_MAX) return at("displacement out of range");
    if (material < 0 || material > UINT16_MAX) return at("material out of range");
    return make_label(depth, static_cast<uint32_t>(material));
}

}  // namespace

Result<std::vector<uint32_t>> encode_binary_map(const RunGrid& grid, BinaryVariant variant, uint32_t most_times_raw) {
    Factorizer factorizer(grid, variant, most_times_raw);
    auto displacement = factorizer.factor("displacements", displacement_values(grid));
    if (!displacement) return displacement.error();
    auto material = factorizer.factor("materials", material_values(grid));
    if (!material) return material.error();
    if (grid.labels.size() * (displacement->row_words() + material->row_words()) > kMostBinaryWork)
        return Error{"binary factors with too many terms for so many cells"};
    const FreeBoxes free = grow_free_boxes(grid);
    factorizer.set_box_count(free.boxes.size());
    auto box_index = factorizer.factor("box indices", free.box_index);
    if (!box_index) return box_index.error();

    std::vector<uint32_t> words = begin_form(FacadeForm::kBinary, grid, FACADE_BINARY_HEADER_WORDS);
    words[FACADE_BINARY_WORD_FLAGS] = variant == BinaryVariant::kShared ? FACADE_BINARY_FLAG_SHARED : 0;
    FactorWriter writer(words, grid, variant);
    writer.write(FACADE_BINARY_WORD_DISPLACEMENT, *displacement, kDisplacementBias);
    writer.write(FACADE_BINARY_WORD_MATERIAL, *material, 0);
    writer.write(FACADE_BINARY_WORD_BOX_INDEX, *box_index, 0);
    words.resize(padded_to_group(words.size()), 0);
    words[FACADE_BINARY_WORD_BOXES] = append_boxes(words, free.boxes);
    words[FACADE_BINARY_WORD_BOX_COUNT] = static_cast<uint32_t>(free.boxes.size());
    if (words.size() * sizeof(uint32_t) >= raw_map_bytes(grid, free.boxes.size()) * most_times_raw)
        return Error{"binary factors do not pay: the map would be larger than raw"};
    return words;
}

Status check_binary_map(std::span<const uint32_t> words) {
    const auto head = check_form_head(words, FacadeForm::kBinary, FACADE_BINARY_HEADER_WORDS);
    if (!head) return head.error();
    if (words[FACADE_BINARY_WORD_FLAGS] > FACADE_BINARY_FLAG_SHARED)
        return error_at_word("binary factor map with unknown flags", FACADE_BINARY_WORD_FLAGS);
    uint64_t end = FACADE_BINARY_HEADER_WORDS;
    for (const uint32_t descriptor : kDescriptors) {
        const auto next = check_factors(words, *head, descriptor, end, is_shared(words));
        if (!next) return next.error();
        end = *next;
    }
    const uint32_t boxes = words[FACADE_BINARY_WORD_BOXES], count = words[FACADE_BINARY_WORD_BOX_COUNT];
    if (boxes != padded_to_group(end) || count == 0 || words.size() != boxes + uint64_t{count} * FACADE_BOX_WORDS)
        return error_at_word("boxes of a binary factor map are not in their place", FACADE_BINARY_WORD_BOXES);
    return check_boxes(words, boxes, count, *head);
}

Result<RunGrid> decode_binary_map(std::span<const uint32_t> words) {
    if (const Status status = check_binary_map(words); !status) return status.error();
    const FormHead head = *read_form_head(words);
    const FactorView d(words, FACADE_BINARY_WORD_DISPLACEMENT), m(words, FACADE_BINARY_WORD_MATERIAL);
    RunGrid grid;
    grid.y_breaks = equal_runs(d, m, head.height, [](const FactorView& map, uint32_t y) { return map.row_start(y); });
    grid.x_breaks = equal_runs(d, m, head.width, [](const FactorView& map, uint32_t x) { return map.column_start(x); });
    const uint64_t cells = uint64_t{grid.columns()} * grid.rows();
    if (cells * (uint64_t{d.row_words} + m.row_words) > kMostBinaryWork)
        return Error{"binary factor map with too many terms for so many cells"};
    grid.labels.reserve(cells);
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const auto label = label_of(d, m, grid.x_breaks[column], grid.y_breaks[row], is_shared(words));
            if (!label) return label.error();
            grid.labels.push_back(*label);
        }
    }
    if (grid.depths() != head.depths)
        return error_at_word("facade map states another depth range than it has", FACADE_FORM_WORD_DEPTHS);
    return merge_equal_runs(grid);
}

uint32_t binary_label(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const int32_t depth = FactorView(words, FACADE_BINARY_WORD_DISPLACEMENT).look_up(x, y);
    const int32_t material = FactorView(words, FACADE_BINARY_WORD_MATERIAL).look_up(x, y);
    return make_label(depth, static_cast<uint32_t>(material));
}

FreeBox binary_box(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const auto index = static_cast<uint32_t>(FactorView(words, FACADE_BINARY_WORD_BOX_INDEX).look_up(x, y));
    return read_box(words, words[FACADE_BINARY_WORD_BOXES], std::min(index, words[FACADE_BINARY_WORD_BOX_COUNT] - 1));
}

FactorTerms binary_terms(std::span<const uint32_t> words) {
    return {words[FACADE_BINARY_WORD_DISPLACEMENT + FACADE_BINARY_MAP_TERMS],
            words[FACADE_BINARY_WORD_MATERIAL + FACADE_BINARY_MAP_TERMS],
            words[FACADE_BINARY_WORD_BOX_INDEX + FACADE_BINARY_MAP_TERMS]};
}

}  // namespace citystream::codec::facade
