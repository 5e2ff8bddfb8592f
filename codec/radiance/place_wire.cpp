#include "codec/radiance/place_wire.h"

#include <cassert>
#include <cstdlib>
#include <utility>

#include "codec/bits/range_coder.h"

namespace citystream::codec::radiance {

namespace {

constexpr int64_t kUnits = 1 << RECEIVER_DEPTH_BITS;
/// A receiver is told by the one below it in the row before when its depth is off by no more units than this.
constexpr int64_t kMostOff = 3 * kUnits / 4;

uint32_t unit_bits(uint32_t spacing_log2) {
    return spacing_log2 - RECEIVER_DEPTH_BITS;
}

/// Of a row: depths in units.
struct Entry {
    int32_t column = 0, depth = 0;
    std::array<int8_t, 2> tilt{};
};
using Row = std::vector<Entry>;

/// Of a class: the rows from the first to the last, some of them empty.
struct ClassRows {
    int32_t first = 0;
    std::vector<Row> rows;
};

int64_t floor_quotient(int64_t a, int64_t b) {
    return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/// By how many units a plane rises over so many columns along the axis of a tilt.
int64_t rise(uint32_t surface_class, int8_t tilt, int64_t columns) {
    const int64_t sign = surface_class % 2 == 0 ? -1 : 1;
    return floor_quotient(2 * sign * tilt * kUnits * columns + RECEIVER_TILT_ONE, 2 * RECEIVER_TILT_ONE);
}

template <typename Coder>
class PlaceCode {
  public:
    PlaceCode(Coder& coder, int64_t most_depth, uint32_t most) : coder_(coder), most_depth_(most_depth), most_(most) {}

    /// Null, or what is wrong with what was read.
    const char* code(uint32_t surface_class, ClassRows& rows) {
        surface_class_ = surface_class;
        const uint32_t count = row_count_.code(coder_, static_cast<uint32_t>(rows.rows.size()));
        if (count == 0) return nullptr;
        rows.first = bits::unzigzag(first_row_.code(coder_, bits::zigzag(rows.first)));
        if (std::abs(int64_t{rows.first}) > RECEIVER_MOST_COLUMN ||
            int64_t{rows.first} + count - 1 > RECEIVER_MOST_COLUMN)
            return "rows of receivers that cannot be";
        if constexpr (Coder::kDecodes) rows.rows.resize(count);
        const Row none;
        const Row* before = &none;
        for (Row& row : rows.rows) {
            if (const char* wrong = code_row(*before, row); wrong != nullptr) return wrong;
            before = &row;
        }
        return nullptr;
    }

  private:
    static constexpr uint32_t kHistory = 4;
    enum class Event : uint8_t { kNew, kKept, kGone, kEnd };

    /// What comes next in a row that is to be written.
    Event event_of(const Row& before, size_t place, const Row& row, size_t next) const {
        if (next == row.size()) return place == before.size() ? Event::kEnd : Event::kGone;
        if (place == before.size()) return Event::kNew;
        const Entry &here = row[next], &there = before[place];
        if (here.column != there.column) return here.column < there.column ? Event::kNew : Event::kGone;
        const int64_t off = here.depth - expected(there);
        if (std::abs(off) <= kMostOff) return Event::kKept;
        return off < 0 ? Event::kNew : Event::kGone;
    }

    const char* code_row(const Row& before, Row& row) {
        Row done;
        size_t place = 0;
        for (uint32_t history = 0;;) {
            Event event = Event::kEnd;
            if constexpr (!Coder::kDecodes) event = event_of(before, place, row, done.size());
            const bool at_end = place == before.size();
            Entry entry;
            if (event == Event::kNew || event == Event::kKept) entry = row[done.size()];
            if (coder_.bit(is_new_[at_end ? 1 : 0][last_new_], event == Event::kNew ? 1 : 0) != 0) {
                last_new_ = 1;
                if (const char* wrong = code_new(done, entry); wrong != nullptr) return wrong;
                continue;
            }
            last_new_ = 0;
            if (at_end) break;
            const uint32_t kept = coder_.bit(is_kept_[history], event == Event::kKept ? 1 : 0);
            history = (2 * history + 1 - kept) % kHistory;
            const Entry& there = before[place++];
            if (kept == 0) continue;
            if (const char* wrong = code_kept(there, done, entry); wrong != nullptr) return wrong;
        }
        row = std::move(done);
        if constexpr (Coder::kDecodes) {
            if (!coder_.ok()) return "receivers' places end too soon";
        }
        return nullptr;
    }

    /// In the next row, on the plane of one of this.
    int64_t expected(const Entry& there) const { return there.depth + rise(surface_class_, there.tilt[1], 1); }

    const char* code_kept(const Entry& there, Row& done, Entry& entry) {
        entry.column = there.column;
        const bool same = code_tilt(kKeptTilt, there.tilt, entry);
        auto& model = kept_depth_[same ? last_off_ : kOffClasses - 1];
        const uint32_t off = code_off(model, expected(there), entry);
        last_off_ = off == 0 ? 0 : 1;
        return add(done, entry);
    }

    /// Told by the one before it in its row, or, of the first of a row, by the last first one that was new.
    const char* code_new(Row& done, Entry& entry) {
        if (done.empty()) {
            const auto told = static_cast<uint32_t>(bits::zigzag(entry.column - first_.column));
            entry.column = wrapped(first_.column, bits::unzigzag(first_column_.code(coder_, told)));
            code_tilt(kFirstTilt, first_.tilt, entry);
            code_off(first_depth_, first_.depth, entry);
            first_ = entry;
            return add(done, entry);
        }
        const Entry last = done.back();
        const uint32_t step = step_.code(coder_, static_cast<uint32_t>(entry.column - last.column));
        if (step > 2 * RECEIVER_MOST_COLUMN) return "a column of receivers that cannot be";
        entry.column = last.column + static_cast<int32_t>(step);
        code_tilt(kNextTilt, last.tilt, entry);
        code_off(step == 0 ? same_column_depth_ : next_depth_, last.depth + rise(surface_class_, last.tilt[0], step),
                 entry);
        return add(done, entry);
    }

    /// Whether a tilt is the one expected.
    bool code_tilt(uint32_t of, const std::array<int8_t, 2>& expected_tilt, Entry& entry) {
        auto& same = same_tilt_[of];
        last_same_[of] = coder_.bit(same[last_same_[of]], entry.tilt == expected_tilt ? 1 : 0);
        if (last_same_[of] != 0) {
            entry.tilt = expected_tilt;
            return true;
        }
        for (size_t axis = 0; axis < 2; ++axis) {
            const uint32_t told = bits::zigzag(entry.tilt[axis] - expected_tilt[axis]);
            const int32_t more = bits::unzigzag(tilt_[axis].code(coder_, told));
            entry.tilt[axis] = static_cast<int8_t>(wrapped(expected_tilt[axis], more));
        }
        return false;
    }

    /// A depth by its difference to what is expected, which is returned in zigzag.
    uint32_t code_off(bits::NumberModel& model, int64_t expected_depth, Entry& entry) {
        const auto told = static_cast<int32_t>(entry.depth - expected_depth);
        const uint32_t off = model.code(coder_, bits::zigzag(told));
        if constexpr (Coder::kDecodes) {
            const int64_t depth = expected_depth + bits::unzigzag(off);
            entry.depth = static_cast<int32_t>(std::abs(depth) > most_depth_ ? most_depth_ + 1 : depth);
        }
        return off;
    }

    /// Sum modulo 2^32, which what is written never needs.
    static int32_t wrapped(int32_t a, int32_t b) {
        return static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
    }

    const char* add(Row& done, const Entry& entry) {
        if (count_++ == most_) return "more receivers than there may be";
        if (std::abs(int64_t{entry.column}) > RECEIVER_MOST_COLUMN) return "a column of receivers that cannot be";
        if (std::abs(int64_t{entry.depth}) > most_depth_) return "a receiver's depth that cannot be";
        if (!done.empty() && std::pair(entry.column, entry.depth) < std::pair(done.back().column, done.back().depth))
            return "receivers that are out of order";
        done.push_back(entry);
        return nullptr;
    }

    enum TiltOf : uint32_t { kKeptTilt, kFirstTilt, kNextTilt, kTiltsOf };
    static constexpr uint32_t kOffClasses = 3;

    Coder& coder_;
    int64_t most_depth_;  ///< units
    uint32_t most_, count_ = 0, surface_class_ = 0;
    uint32_t last_new_ = 0, last_off_ = 0, last_same_[kTiltsOf] = {};
    Entry first_;
    bits::NumberModel row_count_, first_row_, first_column_, step_;
    bits::NumberModel kept_depth_[kOffClasses], first_depth_, next_depth_, same_column_depth_, tilt_[2];
    bits::BitModel is_new_[2][2], is_kept_[kHistory], same_tilt_[kTiltsOf][2];
};

int64_t most_units(uint32_t spacing_log2) {
    return kMostDepth >> unit_bits(spacing_log2);
}

std::vector<ClassRows> rows_of(std::span<const ReceiverPlace> places, uint32_t spacing_log2) {
    std::vector<ClassRows> classes(RECEIVER_CLASSES);
    for (const ReceiverPlace& place : places) {
        ClassRows& of = classes[place.surface_class];
        if (of.rows.empty()) of.first = place.column[1];
        of.rows.resize(static_cast<size_t>(place.column[1] - of.first) + 1);
        const int32_t depth = rounded_depth(place.depth, spacing_log2) >> unit_bits(spacing_log2);
        of.rows.back().push_back({place.column[0], depth, place.tilt});
    }
    return classes;
}

}  // namespace

int32_t rounded_depth(int32_t depth, uint32_t spacing_log2) {
    const int64_t unit = int64_t{1} << unit_bits(spacing_log2);
    return static_cast<int32_t>(floor_quotient(depth + unit / 2, unit) * unit);
}

std::vector<std::byte> encode_places(std::span<const ReceiverPlace> places, uint32_t spacing_log2) {
    bits::RangeEncoder coder;
    PlaceCode<bits::RangeEncoder> code(coder, most_units(spacing_log2), RECEIVER_MOST);
    std::vector<ClassRows> classes = rows_of(places, spacing_log2);
    for (uint32_t surface_class = 0; surface_class < RECEIVER_CLASSES; ++surface_class) {
        [[maybe_unused]] const char* wrong = code.code(surface_class, classes[surface_class]);
        assert(wrong == nullptr);
    }
    return coder.finish();
}

Result<std::vector<ReceiverPlace>> decode_places(std::span<const std::byte> bytes, uint32_t spacing_log2,
                                                 uint32_t most) {
    bits::RangeDecoder coder(bytes);
    PlaceCode<bits::RangeDecoder> code(coder, most_units(spacing_log2), most);
    std::vector<ReceiverPlace> places;
    for (uint32_t surface_class = 0; surface_class < RECEIVER_CLASSES; ++surface_class) {
        ClassRows of;
        if (const char* wrong = code.code(surface_class, of); wrong != nullptr) return Error{wrong, coder.position()};
        for (size_t row = 0; row < of.rows.size(); ++row) {
            const int32_t j = of.first + static_cast<int32_t>(row);
            for (const Entry& entry : of.rows[row])
                places.push_back(
                    {surface_class, {entry.column, j}, entry.depth << unit_bits(spacing_log2), entry.tilt});
        }
    }
    if (const Status status = coder.finish(); !status) return status.error();
    return places;
}

}  // namespace citystream::codec::radiance
