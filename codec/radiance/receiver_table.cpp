#include "codec/radiance/receiver_table.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <tuple>

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kNone = ~0U;
constexpr int32_t kMostColumn = RECEIVER_MOST_COLUMN;
constexpr uint32_t kMostRows = 65536;

auto key_of(const ReceiverPlace& place) {
    return std::tuple(place.surface_class, place.column[1], place.column[0], place.depth);
}

Error error_at(const std::string& what, size_t word) {
    return {"receivers: " + what, word * sizeof(uint32_t)};
}

/// Ends of runs of places with the same class, or class and row.
template <typename Same>
size_t run_end(std::span<const ReceiverPlace> places, size_t begin, const Same& same) {
    size_t end = begin;
    while (end < places.size() && same(places[end], places[begin])) ++end;
    return end;
}

int32_t floor_to(int32_t value, uint32_t bits) {
    return static_cast<int32_t>(static_cast<uint32_t>(value >> bits) << bits);
}

class TableWriter {
  public:
    TableWriter(std::span<const ReceiverPlace> places, uint32_t spacing_log2)
        : places_(places), spacing_log2_(spacing_log2) {}

    Result<std::vector<uint32_t>> write() {
        if (spacing_log2_ < RECEIVER_LEAST_SPACING || spacing_log2_ > RECEIVER_MOST_SPACING) {
            return Error{"receivers: a spacing of 2^" + std::to_string(spacing_log2_) + " grid units"};
        }
        if (places_.size() > RECEIVER_MOST) return Error{"receivers: " + std::to_string(places_.size()) + " of them"};
        for (size_t i = 0; i < places_.size(); ++i) {
            if (const Status good = check(i); !good) return good.error();
        }
        words_.assign(RECEIVER_HEADER_WORDS, 0);
        words_[RECEIVER_WORD_MAGIC] = RECEIVER_MAGIC;
        words_[RECEIVER_WORD_COUNT] = static_cast<uint32_t>(places_.size());
        words_[RECEIVER_WORD_SPACING] = spacing_log2_;
        const auto same_class = [](const auto& a, const auto& b) { return a.surface_class == b.surface_class; };
        for (size_t begin = 0, end = 0; begin < places_.size(); begin = end) {
            end = run_end(places_, begin, same_class);
            if (const Status good = write_class(begin, end); !good) return good.error();
        }
        words_[RECEIVER_WORD_ENTRIES] = static_cast<uint32_t>(words_.size());
        words_.insert(words_.end(), entries_.begin(), entries_.end());
        return words_;
    }

  private:
    Status check(size_t i) const {
        const ReceiverPlace& place = places_[i];
        if (place.surface_class >= RECEIVER_CLASSES || std::abs(place.column[0]) > kMostColumn ||
            std::abs(place.column[1]) > kMostColumn) {
            return Error{"receivers: class or column of receiver " + std::to_string(i)};
        }
        if (i > 0 && key_of(place) < key_of(places_[i - 1])) {
            return Error{"receivers: receiver " + std::to_string(i) + " is out of order"};
        }
        return Done{};
    }

    Status write_class(size_t begin, size_t end) {
        const auto of_class = places_.subspan(begin, end - begin);
        const auto by_depth = [](const auto& a, const auto& b) { return a.depth < b.depth; };
        const auto [low, high] = std::minmax_element(of_class.begin(), of_class.end(), by_depth);
        const int32_t base = floor_to(low->depth, spacing_log2_);
        if ((int64_t{high->depth} - base) >> spacing_log2_ >= (1 << (16 - RECEIVER_DEPTH_BITS)) - 1) {
            return Error{"receivers: depths from " + std::to_string(low->depth) + " to " + std::to_string(high->depth)};
        }
        const int32_t first_row = of_class.front().column[1], last_row = of_class.back().column[1];
        const size_t header = RECEIVER_WORD_CLASSES + size_t{of_class.front().surface_class} * RECEIVER_CLASS_WORDS;
        const auto rows = static_cast<uint32_t>(last_row - first_row + 1);
        const size_t table = words_.size();
        words_[header + RECEIVER_CLASS_FIRST_ROW] = static_cast<uint32_t>(first_row);
        words_[header + RECEIVER_CLASS_ROWS] = rows;
        words_[header + RECEIVER_CLASS_ROW_TABLE] = static_cast<uint32_t>(table);
        words_[header + RECEIVER_CLASS_DEPTH] = static_cast<uint32_t>(base);
        words_.resize(table + size_t{rows} * RECEIVER_ROW_WORDS, 0);
        const auto same_row = [](const auto& a, const auto& b) { return a.column[1] == b.column[1]; };
        for (size_t first = 0, last = 0; first < of_class.size(); first = last) {
            last = run_end(of_class, first, same_row);
            const auto row = static_cast<size_t>(of_class[first].column[1] - first_row);
            if (const Status good = write_row(of_class.subspan(first, last - first), table + row * RECEIVER_ROW_WORDS);
                !good) {
                return good.error();
            }
            for (size_t i = first; i < last; ++i) entries_.push_back(entry_of(of_class[i], base));
        }
        return Done{};
    }

    Status write_row(std::span<const ReceiverPlace> row, size_t at) {
        if (row.size() > 65535) return Error{"receivers: " + std::to_string(row.size()) + " in one row"};
        const int32_t first = row.front().column[0];
        const auto columns = static_cast<uint32_t>(row.back().column[0] - first + 1);
        words_[at + RECEIVER_ROW_COLUMNS] = (static_cast<uint32_t>(first) & 0xffff) | columns << 16;
        words_[at + RECEIVER_ROW_BEGINS] = static_cast<uint32_t>(words_.size());
        words_[at + RECEIVER_ROW_FIRST] = static_cast<uint32_t>(entries_.size());
        const size_t begins = words_.size();
        words_.resize(begins + (columns + 2) / 2, 0);
        size_t next = 0;
        for (uint32_t column = 0; column <= columns; ++column) {
            while (next < row.size() && row[next].column[0] < first + static_cast<int32_t>(column)) ++next;
            words_[begins + column / 2] |= static_cast<uint32_t>(next) << column % 2 * 16;
        }
        return Done{};
    }

    uint32_t entry_of(const ReceiverPlace& place, int32_t base) const {
        const uint32_t unit_bits = spacing_log2_ - RECEIVER_DEPTH_BITS;
        const uint32_t half = unit_bits == 0 ? 0 : 1U << (unit_bits - 1);
        const uint32_t depth = (static_cast<uint32_t>(place.depth - base) + half) >> unit_bits;
        return depth | uint32_t{static_cast<uint8_t>(place.tilt[0])} << 16 |
               uint32_t{static_cast<uint8_t>(place.tilt[1])} << 24;
    }

    std::span<const ReceiverPlace> places_;
    uint32_t spacing_log2_;
    std::vector<uint32_t> words_, entries_;
};

std::array<uint32_t, 3> axes_of(uint32_t surface_class) {
    const uint32_t own = surface_class / 2;
    return {own, (own + 1) % 3, (own + 2) % 3};
}

int32_t first_column(uint32_t columns_word) {
    return static_cast<int16_t>(columns_word & 0xffff);
}

/// A row's columns and receivers, checked: where its receivers end.
Result<uint32_t> check_row(std::span<const uint32_t> words, size_t at, uint32_t tables_end, uint32_t next_receiver) {
    const uint32_t columns = words[at + RECEIVER_ROW_COLUMNS] >> 16;
    if (columns == 0) return next_receiver;
    const uint32_t begins = words[at + RECEIVER_ROW_BEGINS];
    if (begins >= tables_end || (columns + 2) / 2 > tables_end - begins) {
        return error_at("a row's columns are outside", at + RECEIVER_ROW_BEGINS);
    }
    if (words[at + RECEIVER_ROW_FIRST] != next_receiver)
        return error_at("a row's first receiver", at + RECEIVER_ROW_FIRST);
    uint32_t before = 0;
    for (uint32_t column = 0; column <= columns; ++column) {
        const uint32_t begin = words[begins + column / 2] >> column % 2 * 16 & 0xffff;
        if (begin < before || (column == 0 && begin != 0)) {
            return error_at("a column begins before the one before it", begins + column / 2);
        }
        before = begin;
    }
    return next_receiver + before;
}

/// Of a receiver, in the world's axes.
std::array<float, 3> normal_of(uint32_t surface_class, uint32_t word) {
    const auto [own, a, b] = axes_of(surface_class);
    std::array<float, 3> normal{};
    normal[own] = surface_class % 2 == 0 ? RECEIVER_TILT_ONE : -RECEIVER_TILT_ONE;
    normal[a] = static_cast<int8_t>(word >> 16);
    normal[b] = static_cast<int8_t>(word >> 24);
    return normal;
}

}  // namespace

Result<std::vector<uint32_t>> write_receiver_table(std::span<const ReceiverPlace> places, uint32_t spacing_log2) {
    return TableWriter(places, spacing_log2).write();
}

Result<ReceiverTableView> ReceiverTableView::create(std::span<const uint32_t> words) {
    if (words.size() < RECEIVER_HEADER_WORDS) return error_at("no room for a header", words.size());
    if (words[RECEIVER_WORD_MAGIC] != RECEIVER_MAGIC) return error_at("no such format", RECEIVER_WORD_MAGIC);
    const uint32_t count = words[RECEIVER_WORD_COUNT], spacing = words[RECEIVER_WORD_SPACING];
    if (count > RECEIVER_MOST || count > words.size() - RECEIVER_HEADER_WORDS) {
        return error_at(std::to_string(count) + " receivers in " + std::to_string(words.size()) + " words",
                        RECEIVER_WORD_COUNT);
    }
    if (spacing < RECEIVER_LEAST_SPACING || spacing > RECEIVER_MOST_SPACING) {
        return error_at("a spacing of 2^" + std::to_string(spacing), RECEIVER_WORD_SPACING);
    }
    if (words.size() > 0xffffffffU) return error_at("too many words", 0);
    const auto tables_end = static_cast<uint32_t>(words.size() - count);
    if (words[RECEIVER_WORD_ENTRIES] != tables_end)
        return error_at("receivers are not at the end", RECEIVER_WORD_ENTRIES);
    uint32_t receivers = 0;
    for (uint32_t surface_class = 0; surface_class < RECEIVER_CLASSES; ++surface_class) {
        const size_t header = RECEIVER_WORD_CLASSES + size_t{surface_class} * RECEIVER_CLASS_WORDS;
        const uint32_t rows = words[header + RECEIVER_CLASS_ROWS], table = words[header + RECEIVER_CLASS_ROW_TABLE];
        if (rows == 0) continue;
        if (rows > kMostRows || table > tables_end || size_t{rows} * RECEIVER_ROW_WORDS > tables_end - table) {
            return error_at("a class's rows are outside", header + RECEIVER_CLASS_ROWS);
        }
        for (uint32_t row = 0; row < rows; ++row) {
            const auto end = check_row(words, table + size_t{row} * RECEIVER_ROW_WORDS, tables_end, receivers);
            if (!end) return end.error();
            receivers = *end;
            if (receivers > count) return error_at("rows of more receivers than there are", RECEIVER_WORD_COUNT);
        }
    }
    if (receivers != count) return error_at("rows of fewer receivers than there are", RECEIVER_WORD_COUNT);
    return ReceiverTableView(words);
}

uint32_t ReceiverTableView::entry(uint32_t receiver) const {
    return words_[words_[RECEIVER_WORD_ENTRIES] + receiver];
}

uint32_t ReceiverTableView::begin_of(uint32_t begins, uint32_t column) const {
    return words_[begins + column / 2] >> column % 2 * 16 & 0xffff;
}

std::array<uint32_t, 2> ReceiverTableView::column(uint32_t surface_class, int32_t i, int32_t j) const {
    const uint32_t header = RECEIVER_WORD_CLASSES + surface_class * RECEIVER_CLASS_WORDS;
    const uint32_t row = static_cast<uint32_t>(j) - words_[header + RECEIVER_CLASS_FIRST_ROW];
    if (row >= words_[header + RECEIVER_CLASS_ROWS]) return {0, 0};
    const uint32_t at = words_[header + RECEIVER_CLASS_ROW_TABLE] + row * RECEIVER_ROW_WORDS;
    const uint32_t columns = words_[at + RECEIVER_ROW_COLUMNS];
    const uint32_t place = static_cast<uint32_t>(i) - static_cast<uint32_t>(first_column(columns));
    if (place >= columns >> 16) return {0, 0};
    const uint32_t begins = words_[at + RECEIVER_ROW_BEGINS], first = words_[at + RECEIVER_ROW_FIRST];
    return {first + begin_of(begins, place), first + begin_of(begins, place + 1)};
}

std::vector<ReceiverPlace> ReceiverTableView::places() const {
    std::vector<ReceiverPlace> result;
    const uint32_t unit_bits = words_[RECEIVER_WORD_SPACING] - RECEIVER_DEPTH_BITS;
    for (uint32_t surface_class = 0; surface_class < RECEIVER_CLASSES; ++surface_class) {
        const uint32_t header = RECEIVER_WORD_CLASSES + surface_class * RECEIVER_CLASS_WORDS;
        for (uint32_t row = 0; row < words_[header + RECEIVER_CLASS_ROWS]; ++row) {
            const auto j = static_cast<int32_t>(words_[header + RECEIVER_CLASS_FIRST_ROW] + row);
            const uint32_t at = words_[header + RECEIVER_CLASS_ROW_TABLE] + row * RECEIVER_ROW_WORDS;
            const uint32_t columns = words_[at + RECEIVER_ROW_COLUMNS];
            for (uint32_t place = 0; place < columns >> 16; ++place) {
                const int32_t i = first_column(columns) + static_cast<int32_t>(place);
                const auto [begin, end] = column(surface_class, i, j);
                for (uint32_t receiver = begin; receiver < end; ++receiver) {
                    const uint32_t word = entry(receiver);
                    const uint32_t depth = words_[header + RECEIVER_CLASS_DEPTH] + ((word & 0xffff) << unit_bits);
                    result.push_back({surface_class,
                                      {i, j},
                                      static_cast<int32_t>(depth),
                                      {static_cast<int8_t>(word >> 16), static_cast<int8_t>(word >> 24)}});
                }
            }
        }
    }
    return result;
}

/// A point seen along a class: own axis, then the column's.
struct ReceiverTableView::Question {
    uint32_t surface_class = 0;
    std::array<float, 3> normal{};
    std::array<float, 2> place{};  ///< spacings
    float depth = 0;               ///< at column (0, 0), in spacings / 64 from the class's base
    std::array<float, 2> slope{};  ///< spacings / 64 from column to column
    bool loose = false;            ///< of another surface: the point's own depth counts, and its normal little

    float depth_at(int32_t i, int32_t j) const {
        return depth + slope[0] * static_cast<float>(i) + slope[1] * static_cast<float>(j);
    }
    float tolerance() const {
        return loose ? static_cast<float>(RECEIVER_LOOSE_TOLERANCE) : static_cast<float>(RECEIVER_TOLERANCE);
    }
    /// Whether a receiver's normal is near enough.
    bool takes(uint32_t word) const {
        const float a = static_cast<int8_t>(word >> 16), b = static_cast<int8_t>(word >> 24);
        const float one = surface_class % 2 == 0 ? RECEIVER_TILT_ONE : -RECEIVER_TILT_ONE;
        const float cosine = one * normal[0] + a * normal[1] + b * normal[2];
        const float lengths =
            (normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) * (one * one + a * a + b * b);
        if (loose) return cosine >= 0;
        return cosine > 0 && cosine * cosine > static_cast<float>(RECEIVER_COSINE_SQUARED) * lengths;
    }
    /// What a receiver that is not turned as the surface is costs, in units of depth.
    float turned(uint32_t word) const {
        const float a = static_cast<int8_t>(word >> 16), b = static_cast<int8_t>(word >> 24);
        const float one = surface_class % 2 == 0 ? RECEIVER_TILT_ONE : -RECEIVER_TILT_ONE;
        const float cosine = one * normal[0] + a * normal[1] + b * normal[2];
        const float lengths =
            (normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) * (one * one + a * a + b * b);
        return static_cast<float>(RECEIVER_TURNED) * (1 - cosine * std::abs(cosine) / lengths);
    }
    bool within_columns() const {
        constexpr float kMost = kMostColumn;
        return std::abs(place[0]) < kMost && std::abs(place[1]) < kMost;
    }
};

struct ReceiverTableView::Choice {
    uint32_t receiver = kNone;
    float off = 0;  ///< depth, in spacings / 64
};

ReceiverTableView::Question ReceiverTableView::question(uint32_t surface_class, const std::array<float, 3>& point,
                                                        const std::array<float, 3>& normal) const {
    const auto [own, a, b] = axes_of(surface_class);
    constexpr auto kUnits = static_cast<float>(1 << RECEIVER_DEPTH_BITS);
    const uint32_t header = RECEIVER_WORD_CLASSES + surface_class * RECEIVER_CLASS_WORDS;
    const auto base = static_cast<float>(static_cast<int32_t>(words_[header + RECEIVER_CLASS_DEPTH]));
    Question result;
    result.surface_class = surface_class;
    result.normal = {normal[own], normal[a], normal[b]};
    result.place = {point[a] / spacing(), point[b] / spacing()};
    result.depth = (point[own] - base) / spacing() * kUnits;
    return result;
}

ReceiverTableView::Choice ReceiverTableView::best(const Question& question, int32_t i, int32_t j) const {
    const auto [begin, end] = column(question.surface_class, i, j);
    const float depth = question.depth_at(i, j);
    const auto is_shallow = [&](uint32_t word) {
        return static_cast<float>(word & 0xffff) < depth - question.tolerance();
    };
    uint32_t first = begin;
    for (uint32_t high = end; first + RECEIVER_FEW < high;) {
        const uint32_t middle = first + (high - first) / 2;
        if (is_shallow(entry(middle))) {
            first = middle + 1;
        } else {
            high = middle;
        }
    }
    Choice result;
    result.off = question.tolerance();
    for (uint32_t receiver = first; receiver < end; ++receiver) {
        const uint32_t word = entry(receiver);
        const float above = static_cast<float>(word & 0xffff) - depth;
        if (!(above <= question.tolerance())) break;
        const float off = std::abs(above);
        const bool nearer = result.receiver == kNone ? off <= result.off : off < result.off;
        if (!is_shallow(word) && nearer && question.takes(word)) result = {receiver, off};
    }
    return result;
}

ReceiverShares ReceiverTableView::shares_of(const Question& question) const {
    ReceiverShares result;
    if (!question.within_columns()) return result;
    const auto [x, y] = question.place;
    const float i = std::floor(x), j = std::floor(y);
    float sum = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const float weight = (k % 2 == 1 ? x - i : 1 - (x - i)) * (k / 2 == 1 ? y - j : 1 - (y - j));
        if (!(weight > 0)) continue;
        const Choice choice = best(question, static_cast<int32_t>(i) + static_cast<int32_t>(k % 2),
                                   static_cast<int32_t>(j) + static_cast<int32_t>(k / 2));
        if (choice.receiver == kNone) continue;
        result.receiver[result.count] = choice.receiver;
        result.weight[result.count++] = weight;
        sum += weight;
    }
    for (uint32_t k = 0; k < result.count; ++k) result.weight[k] /= sum;
    return result;
}

ReceiverShares ReceiverTableView::stand_in(const std::array<float, 3>& point, const std::array<float, 3>& normal,
                                           uint32_t own_class) const {
    ReceiverShares result;
    result.own_surface = false;
    Choice nearest;
    for (uint32_t surface_class = 0; surface_class < RECEIVER_CLASSES; ++surface_class) {
        Question loose = question(surface_class, point, normal);
        loose.loose = true;
        const bool looks_down = surface_class == RECEIVER_DOWNWARDS && own_class != RECEIVER_DOWNWARDS;
        if (looks_down || !loose.within_columns()) continue;
        for (int32_t k = 0; k < 4; ++k) {
            Choice choice = best(loose, static_cast<int32_t>(std::floor(loose.place[0])) + k % 2,
                                 static_cast<int32_t>(std::floor(loose.place[1])) + k / 2);
            if (choice.receiver == kNone) continue;
            choice.off += loose.turned(entry(choice.receiver));
            if (nearest.receiver != kNone && !(choice.off < nearest.off)) continue;
            nearest = choice;
            result.normal = normal_of(surface_class, entry(choice.receiver));
        }
    }
    if (nearest.receiver == kNone) return result;
    result.count = 1;
    result.receiver[0] = nearest.receiver;
    result.weight[0] = 1;
    return result;
}

ReceiverShares ReceiverTableView::shares(const std::array<float, 3>& point, const std::array<float, 3>& normal) const {
    const std::array<float, 3> size = {std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2])};
    const uint32_t axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
    Question own = question(2 * axis + (normal[axis] < 0 ? 1 : 0), point, normal);
    constexpr auto kUnits = static_cast<float>(1 << RECEIVER_DEPTH_BITS);
    own.slope = {-own.normal[1] / own.normal[0] * kUnits, -own.normal[2] / own.normal[0] * kUnits};
    own.depth -= own.slope[0] * own.place[0] + own.slope[1] * own.place[1];
    const ReceiverShares result = shares_of(own);
    return result.count > 0 ? result : stand_in(point, normal, own.surface_class);
}

}  // namespace citystream::codec::radiance
