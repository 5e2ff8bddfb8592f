#include "codec/facade/quotient_wire.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "codec/bits/bit_stream.h"

namespace citystream::codec::facade {

namespace {

using bits::BitModel;
using bits::BitTree;
using bits::NumberModel;

constexpr uint32_t kSideBits = 13;
constexpr uint32_t kNone = ~0u;
/// Rows before it that a row may be modelled on, and the comparisons that finding them may take.
constexpr uint32_t kModelRows = 64;
constexpr uint64_t kMostComparisons = uint64_t{1} << 27;
/// More labels than this are not worth adaptive models of their own.
constexpr uint32_t kMostModelledLabels = 4096;
constexpr uint32_t kMostLabels = 1u << 26;

/// False once a decoder's bytes have run out: what is read from then on costs nothing and says nothing.
template <typename Coder>
bool has_bytes(const Coder& coder) {
    if constexpr (Coder::kDecodes) return coder.ok();
    return true;
}

/// A number below any count.
template <typename Coder>
uint32_t code_uniform(Coder& coder, uint32_t count, uint32_t value) {
    if (count <= 1u << 16) return coder.uniform(count, value);
    const uint32_t high = coder.uniform(((count - 1) >> 16) + 1, value >> 16);
    return high << 16 | coder.uniform(1u << 16, value & 0xffffu);
}

/// The runs of one axis: which class follows, and how long it is.
class AxisCoder {
  public:
    /// Appends a run at a time until the breaks reach `size`. Fails when decoded runs go past it, are too many, or end
    /// too early.
    template <typename Coder>
    bool code(Coder& coder, uint32_t size, uint32_t most_runs, std::vector<uint32_t>& breaks,
              std::vector<uint32_t>& classes) {
        const std::vector<uint32_t> given_breaks = std::move(breaks), given_classes = std::move(classes);
        breaks = {0};
        classes = {};
        while (breaks.back() < size) {
            const size_t run = classes.size();
            if (run >= most_runs) return false;
            uint32_t run_class = 0, length = 0;
            if constexpr (!Coder::kDecodes) {
                run_class = given_classes[run];
                length = given_breaks[run + 1] - given_breaks[run];
            }
            classes.push_back(code_class(coder, run_class));
            length = code_length(coder, classes.back(), length);
            if (length > size - breaks.back() || !has_bytes(coder)) return false;
            breaks.push_back(breaks.back() + length);
        }
        return true;
    }
    uint32_t class_count() const { return static_cast<uint32_t>(lengths_.size()); }

  private:
    /// As after the last time that the two classes before, or the one before, stood in a row; else new; else any other.
    template <typename Coder>
    uint32_t code_class(Coder& coder, uint32_t given) {
        uint32_t result = kNone;
        uint32_t missed = kNone;
        for (const uint32_t order : {2u, 1u}) {
            const auto guess = followers_.find({order == 2 ? before_last_ : kNone, last_});
            if (guess == followers_.end() || guess->second == missed || result != kNone) continue;
            missed = guess->second;
            if (coder.bit(expected_[order - 1][last_hit_ ? 1 : 0], given == missed ? 1 : 0) != 0) result = missed;
        }
        last_hit_ = result != kNone;
        if (result == kNone) result = code_unexpected(coder, given);
        followers_[{before_last_, last_}] = followers_[{kNone, last_}] = result;
        before_last_ = std::exchange(last_, result);
        return result;
    }

    template <typename Coder>
    uint32_t code_unexpected(Coder& coder, uint32_t given) {
        const uint32_t known = class_count();
        const bool alone = known == 0 || (known == 1 && last_ == 0);
        if (alone || coder.bit(is_new_, given == known ? 1 : 0) != 0) {
            lengths_.push_back(0);
            return known;
        }
        // Neighbours differ: the last class cannot come again.
        const uint32_t other = coder.uniform(known - 1, given - (given > last_ ? 1 : 0));
        return other + (other >= last_ ? 1 : 0);
    }

    /// As the last run of its class, or as the run before last; else a number.
    template <typename Coder>
    uint32_t code_length(Coder& coder, uint32_t run_class, uint32_t given) {
        const uint32_t same = lengths_[run_class];
        uint32_t length = 0;
        if (same != 0 && coder.bit(same_length_[last_same_ ? 1 : 0], given == same ? 1 : 0) != 0) length = same;
        if (same != 0) last_same_ = length != 0;
        if (length == 0 && length_before_last_ != 0 && length_before_last_ != same &&
            coder.bit(repeated_length_, given == length_before_last_ ? 1 : 0) != 0)
            length = length_before_last_;
        if (length == 0) length = length_number_.code(coder, given - 1) % kMaxFacadeSide + 1;
        lengths_[run_class] = length;
        length_before_last_ = std::exchange(last_length_, length);
        return length;
    }

    std::map<std::pair<uint32_t, uint32_t>, uint32_t> followers_;  ///< of the last two classes, of the last one
    std::vector<uint32_t> lengths_;                                ///< last length of each class
    uint32_t last_ = kNone, before_last_ = kNone, last_length_ = 0, length_before_last_ = 0;
    bool last_hit_ = true, last_same_ = true;
    BitModel expected_[2][2] = {{BitModel(0.4), BitModel(0.6)}, {BitModel(0.5), BitModel(0.9)}};
    BitModel is_new_ = BitModel(0.7), same_length_[2] = {BitModel(0.5), BitModel(0.8)}, repeated_length_;
    NumberModel length_number_;
};

/// The distinct labels in rising order of displacement (open ones first), then material.
class LabelTableCoder {
  public:
    template <typename Coder>
    bool code(Coder& coder, uint64_t most_labels, std::vector<uint32_t>& labels) {
        const std::vector<uint32_t> given = std::move(labels);
        labels = {};
        const uint32_t count = count_.code(coder, static_cast<uint32_t>(given.size()) - 1);
        if (count >= most_labels || count >= kMostLabels) return false;
        int32_t depth = kOpenDisplacement, material = 0;
        for (uint32_t i = 0; i <= count; ++i) {
            const uint32_t label = Coder::kDecodes ? 0 : given[i];
            const int32_t last_depth = depth, given_material = static_cast<int32_t>(material_of(label));
            depth = code_depth(coder, depth, displacement_of(label));
            // A material above the last one of the same displacement, or any with another.
            const int32_t least = i > 0 && depth == last_depth ? material + 1 : 0;
            material = least + static_cast<int32_t>(
                                   material_.code(coder, static_cast<uint32_t>(given_material - least)) & 0xffffu);
            if (depth > INT16_MAX || material > UINT16_MAX || !has_bytes(coder)) return false;
            labels.push_back(make_label(depth, static_cast<uint32_t>(material)));
        }
        return true;
    }

  private:
    template <typename Coder>
    int32_t code_depth(Coder& coder, int32_t last, int32_t given) {
        if (last != kOpenDisplacement) return last + rise(coder, given - last);
        if (coder.bit(is_open_, given == kOpenDisplacement ? 1 : 0) != 0) return kOpenDisplacement;
        return static_cast<int16_t>(bits::unzigzag(first_.code(coder, bits::zigzag(given))));
    }

    /// Most displacements are multiples of a few centimetres or of what the last step was a multiple of.
    template <typename Coder>
    int32_t rise(Coder& coder, int32_t given) {
        if (coder.bit(same_rise_, given == last_rise_ ? 1 : 0) != 0) return last_rise_;
        if (coder.bit(in_units_, given % kUnitMm == 0 ? 1 : 0) != 0)
            last_rise_ =
                static_cast<int32_t>(units_.code(coder, static_cast<uint32_t>(given / kUnitMm)) & 0xffffu) * kUnitMm;
        else
            last_rise_ = static_cast<int32_t>(rise_.code(coder, static_cast<uint32_t>(given)) & 0x1ffffu);
        return last_rise_;
    }

    static constexpr int32_t kUnitMm = 5;
    int32_t last_rise_ = 0;
    NumberModel count_, first_, rise_, units_, material_;
    BitModel is_open_ = BitModel(0.1), same_rise_ = BitModel(0.3), in_units_;
};

/// The grid of label numbers, row by row, each modelled on a row before it.
class CellCoder {
  public:
    CellCoder(uint32_t columns, uint32_t labels)
        : columns_(columns),
          labels_(labels),
          replacement_(labels, kNone),
          any_(std::min(labels, kMostModelledLabels)) {}

    /// The cells of one row; `model` is empty for the first.
    template <typename Coder>
    void code_row(Coder& coder, const uint32_t* model, uint32_t* row) {
        for (uint32_t c = 0; c < columns_; ++c) {
            const uint32_t given = Coder::kDecodes ? 0 : row[c];
            const uint32_t left = c > 0 ? row[c - 1] : kNone;
            uint32_t cell = kNone;
            if (model != nullptr && coder.bit(as_model_[context(model, row, c)], given == model[c] ? 1 : 0) != 0)
                cell = model[c];
            if (cell == kNone) cell = code_other(coder, model != nullptr ? model[c] : kNone, left, given);
            row[c] = cell;
        }
    }
    template <typename Coder>
    uint32_t code_distance(Coder& coder, uint32_t distance) {
        return distance_.code(coder, distance);
    }

  private:
    /// Whether the two cells before were as the model's, and whether the model goes on as before and behind.
    uint32_t context(const uint32_t* model, const uint32_t* row, uint32_t c) const {
        const uint32_t last = c > 0 && row[c - 1] == model[c - 1] ? 1 : 0;
        const uint32_t before_last = c > 1 && row[c - 2] == model[c - 2] ? 1 : 0;
        const uint32_t from_last = c > 0 && model[c - 1] == model[c] ? 1 : 0;
        const uint32_t to_next = c + 1 < columns_ && model[c + 1] == model[c] ? 1 : 0;
        const uint32_t row_says = c == 0 ? 2 : row[c - 1] == model[c] ? 1 : 0;
        return last | before_last << 1 | from_last << 2 | to_next << 3 | row_says << 4;
    }

    /// A cell unlike the model's: as on its left; as what replaced the model's label last; any.
    template <typename Coder>
    uint32_t code_other(Coder& coder, uint32_t below, uint32_t left, uint32_t given) {
        const uint32_t start = below == kNone ? 1 : 0;
        if (left != kNone && left != below && coder.bit(as_left_[start][last_left_], given == left ? 1 : 0) != 0) {
            last_left_ = 1;
            return left;
        }
        last_left_ = 0;
        const uint32_t key = below != kNone ? below : left;
        const uint32_t guess = key != kNone ? replacement_[key] : kNone;
        uint32_t cell = kNone;
        if (guess != kNone && guess != left && guess != below &&
            coder.bit(as_replaced_[start], given == guess ? 1 : 0) != 0)
            cell = guess;
        if (cell == kNone)
            cell = labels_ <= kMostModelledLabels ? any_.code(coder, given) : code_uniform(coder, labels_, given);
        cell = std::min(cell, labels_ - 1);
        if (key != kNone) replacement_[key] = cell;
        return cell;
    }

    uint32_t columns_, labels_, last_left_ = 0;
    std::vector<uint32_t> replacement_;
    BitTree any_;
    BitModel as_model_[48], as_left_[2][2], as_replaced_[2];
    NumberModel distance_;
};

/// For each row how far before it lies the row that it differs least from, less one.
std::vector<uint32_t> model_distances(const std::vector<uint32_t>& cells, uint32_t columns, uint32_t rows) {
    std::vector<uint32_t> distances(rows, 0);
    const uint64_t tried = std::clamp<uint64_t>(kMostComparisons / cells.size(), 1, kModelRows);
    for (uint32_t row = 1; row < rows; ++row) {
        uint64_t least = ~uint64_t{0};
        for (uint32_t back = 1; back <= std::min<uint64_t>(tried, row); ++back) {
            const auto here = cells.begin() + static_cast<std::ptrdiff_t>(size_t{row} * columns);
            const auto there = here - static_cast<std::ptrdiff_t>(size_t{back} * columns);
            uint64_t changes = back == 1 ? 0 : 2;
            for (uint32_t c = 0; c < columns; ++c) changes += here[c] != there[c] ? 1 : 0;
            if (changes >= least) continue;
            least = changes;
            distances[row] = back - 1;
        }
    }
    return distances;
}

/// Both directions: writes `parts`, or fills them. Fails (when reading) on what goes past the limits.
template <typename Coder>
Status code_parts(Coder& coder, QuotientParts& parts, const QuotientLimits& limits) {
    const auto failed = [&](const char* what) {
        if constexpr (Coder::kDecodes) return Status(Error{what, coder.position()});
        return Status(Error{what});
    };
    uint32_t sizes[2] = {};
    for (int axis = 0; axis < 2; ++axis) {
        const std::vector<uint32_t>& given = axis == 0 ? parts.x_breaks : parts.y_breaks;
        sizes[axis] = coder.plain_bits(kSideBits, Coder::kDecodes ? 0 : given.back() - 1) + 1;
    }
    AxisCoder x, y;
    const auto most = static_cast<uint32_t>(std::min<uint64_t>(limits.run_cells, kMaxFacadeSide));
    if (!x.code(coder, sizes[0], most, parts.x_breaks, parts.x_classes)) return failed("quotient columns out of range");
    const auto most_rows =
        static_cast<uint32_t>(std::min<uint64_t>(limits.run_cells / parts.x_classes.size(), kMaxFacadeSide));
    if (!y.code(coder, sizes[1], most_rows, parts.y_breaks, parts.y_classes))
        return failed("quotient rows out of range");
    parts.columns = x.class_count();
    parts.rows = y.class_count();
    const uint64_t count = uint64_t{parts.columns} * parts.rows;
    if (count > limits.class_cells) return failed("quotient of more cells than its words can hold");

    std::vector<uint32_t> table, cells, distances(parts.rows, 0);
    const auto depth_first = [](uint32_t a, uint32_t b) {
        return std::pair(displacement_of(a), material_of(a)) < std::pair(displacement_of(b), material_of(b));
    };
    if constexpr (!Coder::kDecodes) {
        table = parts.labels;
        std::sort(table.begin(), table.end(), depth_first);
        table.erase(std::unique(table.begin(), table.end()), table.end());
        for (const uint32_t label : parts.labels) {
            const auto at = std::lower_bound(table.begin(), table.end(), label, depth_first);
            cells.push_back(static_cast<uint32_t>(at - table.begin()));
        }
        distances = model_distances(cells, parts.columns, parts.rows);
    }
    if (!LabelTableCoder().code(coder, count + 1, table)) return failed("labels out of range");
    CellCoder coding(parts.columns, static_cast<uint32_t>(table.size()));
    for (uint32_t row = 0; row < parts.rows; ++row) {
        const uint32_t back = row < 2 ? row : coding.code_distance(coder, distances[row]) + 1;
        if (back > row) return failed("quotient row modelled on none");
        // Room for a row at a time: the count is only claimed.
        if constexpr (Coder::kDecodes) cells.resize(cells.size() + parts.columns);
        uint32_t* here = &cells[size_t{row} * parts.columns];
        coding.code_row(coder, row == 0 ? nullptr : here - size_t{back} * parts.columns, here);
        if (!has_bytes(coder)) return failed("quotient ends too early");
    }
    for (uint32_t& cell : cells) cell = table[cell];
    parts.labels = std::move(cells);
    return Done{};
}

}  // namespace

void put_quotient_wire(const QuotientParts& parts, bits::RangeEncoder& encoder) {
    QuotientParts copy = parts;
    const Status status = code_parts(encoder, copy, {~uint64_t{0}, ~uint64_t{0}});
    assert(status.ok() && copy == parts);
    static_cast<void>(status);
}

Result<QuotientParts> get_quotient_wire(bits::RangeDecoder& decoder, const QuotientLimits& limits) {
    QuotientParts parts;
    if (const Status status = code_parts(decoder, parts, limits); !status) return status.error();
    return parts;
}

}  // namespace citystream::codec::facade
