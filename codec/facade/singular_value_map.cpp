#include "codec/facade/singular_value_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "codec/facade/distinct_matrix.h"
#include "codec/facade/raw_layout.h"
#include "codec/facade/raw_map.h"
#include "codec/facade/singular_value_factorization.h"
#include "codec/facade/svd_layout.h"
#include "codec/facade/texel_form.h"

namespace citystream::codec::facade {

namespace {

constexpr uint32_t kDescriptors[] = {FACADE_SVD_WORD_DISPLACEMENT, FACADE_SVD_WORD_MATERIAL, FACADE_SVD_WORD_BOX_INDEX};

static_assert(FACADE_SVD_WORD_MATERIAL == FACADE_SVD_WORD_DISPLACEMENT + FACADE_SVD_MAP_WORDS);
static_assert(FACADE_SVD_WORD_BOX_INDEX == FACADE_SVD_WORD_MATERIAL + FACADE_SVD_MAP_WORDS);

constexpr uint32_t groups_of(uint32_t terms) {
    return (terms + 3) / 4;
}

// Encoding.

struct Factored {
    DistinctMatrix matrix;
    SingularValueFactors factors;
};

/// Factors the three matrices, each in what the ones before left of the words of the raw map.
class Factorizer {
  public:
    Factorizer(const RunGrid& grid, uint32_t most_times_raw) : grid_(grid), allowance_(grid, most_times_raw) {}

    void set_box_count(uint64_t count) { allowance_.set_box_count(count); }

    Result<Factored> factor(std::string_view what, const std::vector<uint32_t>& values) {
        Factored map{make_distinct_matrix(grid_, values), {}};
        const uint64_t line_words = grid_.width() + grid_.height();
        auto factors = factor_singular_values(map.matrix, allowance_.words() / (4 * line_words) * 4, what);
        if (!factors) return factors.error();
        map.factors = std::move(*factors);
        allowance_.take(line_words * groups_of(map.factors.terms) * 4);
        return map;
    }

  private:
    const RunGrid& grid_;
    WordAllowance allowance_;
};

/// Appends a row of groups for every texel row (or column); returns the first word.
uint32_t append_rows(std::vector<uint32_t>& words, const std::vector<float>& factors, uint32_t terms,
                     const std::vector<uint32_t>& breaks, const std::vector<uint32_t>& line_of) {
    const size_t first = words.size(), stride = size_t{4} * groups_of(terms);
    words.resize(first + breaks.back() * stride, 0);
    for (size_t run = 0; run < line_of.size(); ++run) {
        for (size_t texel = breaks[run]; texel < breaks[run + 1]; ++texel) {
            for (size_t k = 0; k < terms; ++k)
                words[first + texel * stride + k] = std::bit_cast<uint32_t>(factors[line_of[run] * terms + k]);
        }
    }
    return static_cast<uint32_t>(first);
}

/// Appends the factors of matrix `which` (0: D, 1: M, 2: A); `bias` is taken off its values.
void append_factors(std::vector<uint32_t>& words, const RunGrid& grid, const Factored& map, uint32_t which,
                    int32_t bias) {
    const SingularValueFactors& f = map.factors;
    const uint32_t rows = append_rows(words, f.x, f.terms, grid.y_breaks, map.matrix.row_of);
    const uint32_t columns = append_rows(words, f.y, f.terms, grid.x_breaks, map.matrix.column_of);
    uint32_t* descriptor = &words[kDescriptors[which]];
    descriptor[FACADE_SVD_MAP_ROWS] = rows;
    descriptor[FACADE_SVD_MAP_COLUMNS] = columns;
    descriptor[FACADE_SVD_MAP_GROUPS] = groups_of(f.terms);
    descriptor[FACADE_SVD_MAP_LEAST] = f.least - static_cast<uint32_t>(bias);
    words[FACADE_SVD_WORD_TERMS + which] = f.terms;
}

/// M and A of the grid.
struct IndexFactors {
    Factored material, box_index;
    std::vector<FreeBox> boxes;
};

Result<IndexFactors> factor_indices(const RunGrid& grid, Factorizer& factorizer) {
    auto material = factorizer.factor("materials", material_values(grid));
    if (!material) return material.error();
    FreeBoxes free = grow_free_boxes(grid);
    factorizer.set_box_count(free.boxes.size());
    auto box_index = factorizer.factor("box indices", free.box_index);
    if (!box_index) return box_index.error();
    return IndexFactors{std::move(*material), std::move(*box_index), std::move(free.boxes)};
}

Result<std::vector<uint32_t>> write_map(const RunGrid& grid, const Factored& displacement, const IndexFactors& indices,
                                        uint32_t most_times_raw) {
    const uint64_t terms = uint64_t{displacement.factors.terms} + indices.material.factors.terms;
    if (grid.labels.size() * terms > kMostSingularValueWork) return Error{"too many singular values for so many cells"};
    std::vector<uint32_t> words = begin_form(FacadeForm::kSvd, grid, FACADE_SVD_HEADER_WORDS);
    append_factors(words, grid, displacement, 0, kDisplacementBias);
    append_factors(words, grid, indices.material, 1, 0);
    append_factors(words, grid, indices.box_index, 2, 0);
    words[FACADE_SVD_WORD_BOXES] = append_boxes(words, indices.boxes);
    words[FACADE_SVD_WORD_BOX_COUNT] = static_cast<uint32_t>(indices.boxes.size());
    if (words.size() * sizeof(uint32_t) >= raw_map_bytes(grid, indices.boxes.size()) * most_times_raw)
        return Error{"singular value factors do not pay: the map would be larger than raw"};
    return words;
}

// Reading.

struct FactorView {
    std::span<const uint32_t> words;
    uint32_t rows, columns, groups;
    int32_t least;

    FactorView(std::span<const uint32_t> map, uint32_t descriptor)
        : words(map),
          rows(map[descriptor + FACADE_SVD_MAP_ROWS]),
          columns(map[descriptor + FACADE_SVD_MAP_COLUMNS]),
          groups(map[descriptor + FACADE_SVD_MAP_GROUPS]),
          least(static_cast<int32_t>(map[descriptor + FACADE_SVD_MAP_LEAST])) {}

    size_t stride() const { return size_t{4} * groups; }
    float x(uint32_t row, size_t k) const { return std::bit_cast<float>(words[rows + row * stride() + k]); }
    float y(uint32_t column, size_t k) const { return std::bit_cast<float>(words[columns + column * stride() + k]); }

    int32_t look_up(uint32_t column, uint32_t row) const {
        float sum = 0;
        for (size_t k = 0; k < stride(); ++k) sum = sum + x(row, k) * y(column, k);
        return rounded_entry(least, sum);
    }
};

/// Entries at the first texels of runs, a row at a time: the sums of look_up, many columns at once.
class RowReader {
  public:
    RowReader(const FactorView& map, const std::vector<uint32_t>& x_breaks) : map_(map), sums_(x_breaks.size() - 1) {
        turned_.reserve(map.stride() * sums_.size());
        for (size_t k = 0; k < map.stride(); ++k) {
            for (size_t c = 0; c < sums_.size(); ++c) turned_.push_back(map.y(x_breaks[c], k));
        }
    }

    void read_row(uint32_t row) {
        std::fill(sums_.begin(), sums_.end(), 0.0F);
        for (size_t k = 0; k < map_.stride(); ++k) {
            const float x = map_.x(row, k);
            const float* y = turned_.data() + k * sums_.size();
            for (size_t c = 0; c < sums_.size(); ++c) sums_[c] = sums_[c] + x * y[c];
        }
    }
    int32_t entry(size_t run) const { return rounded_entry(map_.least, sums_[run]); }

  private:
    FactorView map_;
    std::vector<float> turned_, sums_;
};

/// Where the sections of matrix `which` end, if they begin at `begin`.
Result<uint64_t> check_factors(std::span<const uint32_t> words, const FormHead& head, uint32_t which, uint64_t begin) {
    const FactorView map(words, kDescriptors[which]);
    const uint64_t columns = begin + uint64_t{head.height} * map.stride();
    const uint64_t end = columns + uint64_t{head.width} * map.stride();
    if (map.rows != begin || map.columns != columns || map.groups != groups_of(words[FACADE_SVD_WORD_TERMS + which]))
        return error_at_word("sections of a singular value map are not in their places", kDescriptors[which]);
    if (end > words.size()) return error_at_word("singular value map ends within its factors", words.size());
    if (map.least < INT16_MIN || static_cast<double>(map.least) > FACADE_SVD_GREATEST)
        return error_at_word("least entry of a singular value map out of range", kDescriptors[which]);
    for (uint64_t i = begin; i < end; ++i) {
        if (!(std::abs(std::bit_cast<float>(words[i])) <= static_cast<float>(FACADE_SVD_GREATEST)))
            return error_at_word("factor of a singular value map out of range", i);
    }
    return end;
}

/// Breaks of the runs of texel lines with the same factors in D and in M.
std::vector<uint32_t> equal_runs(std::span<const uint32_t> words, uint32_t count, uint32_t d_first, uint32_t m_first,
                                 size_t d_stride, size_t m_stride) {
    const auto same = [&](size_t first, size_t stride, size_t line) {
        const auto row = words.begin() + static_cast<std::ptrdiff_t>(first + line * stride);
        return std::equal(row, row + static_cast<std::ptrdiff_t>(stride), row - static_cast<std::ptrdiff_t>(stride));
    };
    std::vector<uint32_t> breaks = {0};
    for (uint32_t line = 1; line < count; ++line) {
        if (!same(d_first, d_stride, line) || !same(m_first, m_stride, line)) breaks.push_back(line);
    }
    breaks.push_back(count);
    return breaks;
}

/// D and M of checked words, whatever depth range the head states.
Result<RunGrid> decode_factors(std::span<const uint32_t> words, const FormHead& head) {
    const FactorView d(words, FACADE_SVD_WORD_DISPLACEMENT), m(words, FACADE_SVD_WORD_MATERIAL);
    RunGrid grid;
    grid.y_breaks = equal_runs(words, head.height, d.rows, m.rows, d.stride(), m.stride());
    grid.x_breaks = equal_runs(words, head.width, d.columns, m.columns, d.stride(), m.stride());
    const uint64_t cells = uint64_t{grid.columns()} * grid.rows();
    if (cells * (d.stride() + m.stride()) > kMostSingularValueWork)
        return Error{"singular value map with too many terms for so many cells"};
    RowReader depths(d, grid.x_breaks), materials(m, grid.x_breaks);
    grid.labels.reserve(cells);
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        depths.read_row(grid.y_breaks[row]);
        materials.read_row(grid.y_breaks[row]);
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const int32_t depth = depths.entry(column), material = materials.entry(column);
            if (depth > INT16_MAX) return Error{"displacement " + std::to_string(depth) + " out of range"};
            if (material < 0 || material > UINT16_MAX)
                return Error{"material " + std::to_string(material) + " out of range"};
            grid.labels.push_back(make_label(depth, static_cast<uint32_t>(material)));
        }
    }
    return merge_equal_runs(grid);
}

DisplacementError error_between(const RunGrid& given, const RunGrid& decoded) {
    const FacadeMatrices a = expand(given), b = expand(decoded);
    DisplacementError error;
    double squares = 0;
    for (size_t i = 0; i < a.displacement_mm.size(); ++i) {
        const double difference = std::abs(double{1} * a.displacement_mm[i] - b.displacement_mm[i]);
        error.greatest_mm = std::max(error.greatest_mm, difference);
        squares += difference * difference;
    }
    error.root_mean_square_mm = std::sqrt(squares / static_cast<double>(a.displacement_mm.size()));
    return error;
}

}  // namespace

Result<std::vector<uint32_t>> encode_singular_value_map(const RunGrid& grid) {
    return encode_singular_value_map(grid, 1);
}

Result<std::vector<uint32_t>> encode_singular_value_map(const RunGrid& grid, uint32_t most_times_raw) {
    Factorizer factorizer(grid, most_times_raw);
    const auto displacement = factorizer.factor("displacements", displacement_values(grid));
    if (!displacement) return displacement.error();
    const auto indices = factor_indices(grid, factorizer);
    if (!indices) return indices.error();
    return write_map(grid, *displacement, *indices, most_times_raw);
}

Result<LossySingularValueMap> encode_lossy_singular_value_map(const RunGrid& grid, uint32_t rank) {
    if (rank == 0) return Error{"a lossy singular value map needs at least one singular value"};
    if (grid.has_open_cells()) return Error{"a facade with open cells has no lossy singular value map"};
    Factored displacement{make_distinct_matrix(grid, displacement_values(grid)), {}};
    auto factors = factor_rank(displacement.matrix, rank, "displacements");
    if (!factors) return factors.error();
    displacement.factors = std::move(*factors);
    Factorizer factorizer(grid, 1);
    const auto indices = factor_indices(grid, factorizer);
    if (!indices) return indices.error();
    auto words = write_map(grid, displacement, *indices, 1);
    if (!words) return words.error();
    const auto decoded = decode_factors(*words, *read_form_head(*words));
    if (!decoded) return decoded.error();
    const std::vector<uint32_t> head = begin_form(FacadeForm::kSvd, *decoded, FACADE_SVD_HEADER_WORDS);
    (*words)[FACADE_FORM_WORD_DEPTHS] = head[FACADE_FORM_WORD_DEPTHS];
    return LossySingularValueMap{std::move(*words), error_between(grid, *decoded)};
}

Status check_singular_value_map(std::span<const uint32_t> words) {
    const auto head = check_form_head(words, FacadeForm::kSvd, FACADE_SVD_HEADER_WORDS);
    if (!head) return head.error();
    uint64_t end = FACADE_SVD_HEADER_WORDS;
    for (uint32_t which = 0; which < 3; ++which) {
        const auto next = check_factors(words, *head, which, end);
        if (!next) return next.error();
        end = *next;
    }
    const uint32_t boxes = words[FACADE_SVD_WORD_BOXES], count = words[FACADE_SVD_WORD_BOX_COUNT];
    if (boxes != end || count == 0 || words.size() != end + uint64_t{count} * FACADE_BOX_WORDS)
        return error_at_word("boxes of a singular value map are not in their place", FACADE_SVD_WORD_BOXES);
    return check_boxes(words, boxes, count, *head);
}

Result<RunGrid> decode_singular_value_map(std::span<const uint32_t> words) {
    if (const Status status = check_singular_value_map(words); !status) return status.error();
    const FormHead head = *read_form_head(words);
    auto grid = decode_factors(words, head);
    if (grid && grid->depths() != head.depths)
        return error_at_word("facade map states another depth range than it has", FACADE_FORM_WORD_DEPTHS);
    return grid;
}

uint32_t singular_value_label(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const int32_t depth = FactorView(words, FACADE_SVD_WORD_DISPLACEMENT).look_up(x, y);
    const int32_t material = FactorView(words, FACADE_SVD_WORD_MATERIAL).look_up(x, y);
    return make_label(depth, static_cast<uint32_t>(material));
}

FreeBox singular_value_box(std::span<const uint32_t> words, uint32_t x, uint32_t y) {
    const auto index = static_cast<uint32_t>(FactorView(words, FACADE_SVD_WORD_BOX_INDEX).look_up(x, y));
    return read_box(words, words[FACADE_SVD_WORD_BOXES], std::min(index, words[FACADE_SVD_WORD_BOX_COUNT] - 1));
}

FactorTerms singular_value_terms(std::span<const uint32_t> words) {
    return {words[FACADE_SVD_WORD_TERMS], words[FACADE_SVD_WORD_TERMS + 1], words[FACADE_SVD_WORD_TERMS + 2]};
}

}  // namespace citystream::codec::facade
