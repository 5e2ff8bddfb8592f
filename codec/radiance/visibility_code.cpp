#include "codec/radiance/visibility_code.h"

#include <initializer_list>

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kPlacesAcross = 8, kPlaces = kCubeFaces * kPlacesAcross * kPlacesAcross;

/// Bits as one number, lowest first.
class Joint {
  public:
    Joint& add(uint32_t value, uint32_t bits) {
        number_ |= value << bits_;
        bits_ += bits;
        return *this;
    }
    operator uint32_t() const { return number_; }

  private:
    uint32_t number_ = 0, bits_ = 0;
};

/// The visible and the hidden bits of a few columns.
struct Columns {
    uint32_t visible = 0, hidden = 0;
    uint32_t mixed() const { return visible & hidden; }
    /// Of column i: a state of two bits.
    uint32_t state(uint32_t i) const { return (visible >> i & 1) | (hidden >> i & 1) << 1; }
};

Columns columns_of(const uint8_t* row, uint32_t hidden, int32_t x, uint32_t count) {
    return {row_bits(row, x, count), row_bits(row + hidden, x, count)};
}

/// Three columns of three rows, the cell in their middle.
struct Square {
    Columns north, middle, south;
};

Square square_of(const uint8_t* row, uint32_t stride, uint32_t hidden, uint32_t x) {
    const auto west = static_cast<int32_t>(x) - 1;
    return {columns_of(row - stride, hidden, west, 3), columns_of(row, hidden, west, 3),
            columns_of(row + stride, hidden, west, 3)};
}

uint32_t cross(uint32_t north, uint32_t middle, uint32_t south) {
    return (north >> 1 & 1) | (middle & 1) << 1 | (middle >> 2) << 2 | (south >> 1 & 1) << 3;
}
uint32_t square(uint32_t north, uint32_t middle, uint32_t south) {
    return north | middle << 3 | south << 6;
}

/// Of the eight cells before one, four in each of two receivers: how many thirds of them are not as here.
constexpr std::array<uint8_t, 256> make_thirds() {
    std::array<uint8_t, 256> table{};
    for (uint32_t bits = 0; bits < table.size(); ++bits) table[bits] = static_cast<uint8_t>(std::popcount(bits) / 3);
    return table;
}
constexpr auto kThirds = make_thirds();

/// Which columns of a row, or those beside them, have a bit.
uint32_t near_columns(const uint8_t* row, uint32_t bytes) {
    uint32_t bits = row[0];
    if (bytes > 1) bits |= uint32_t{row[1]} << 8;
    return bits | bits << 1 | bits >> 1;
}

}  // namespace

CalmCells calm_cells(const CellLayout& layout, uint32_t face, const KnownStates& known) {
    const uint32_t stride = layout.stride(0), hidden = layout.hidden(0), bytes = layout.row_bytes(0);
    CalmCells calm;
    const auto near = [&](uint32_t row) {
        uint32_t bits = 0;
        for (const CellStates* states : {&known.first, &known.second}) {
            const uint8_t* const middle = states->at(0, row);
            bits |= near_columns(middle - stride, bytes) | near_columns(middle, bytes) |
                    near_columns(middle + stride, bytes);
        }
        return bits;
    };
    const auto in_both = [&](uint32_t row) {
        const uint8_t *a = known.first.at(0, row), *b = known.second.at(0, row);
        return bytes > 1 ? static_cast<uint32_t>(a[0] & b[0]) | static_cast<uint32_t>(a[1] & b[1]) << 8
                         : static_cast<uint32_t>(a[0] & b[0]);
    };
    for (uint32_t y = 0; y < layout.across(0); ++y) {
        const uint32_t row = layout.row(0, face, y);
        const uint8_t* const there = known.present.at(0, row);
        const uint32_t present = bytes > 1 ? there[0] | uint32_t{there[1]} << 8 : there[0];
        const uint32_t even = (in_both(row) & ~near(row + hidden)) | (in_both(row + hidden) & ~near(row));
        calm.rows[y] = static_cast<uint16_t>(present & even);
        calm.any = calm.any || calm.rows[y] != 0;
    }
    return calm;
}

bool are_alike(const CellLayout& layout, uint32_t row, uint32_t cells, const CellStates& a, const CellStates& b) {
    uint32_t differ = 0;
    for (uint32_t i = 0; i < layout.row_bytes(0); ++i) {
        const uint32_t v = *a.at(0, row + i) ^ *b.at(0, row + i);
        const uint32_t h = *a.at(0, row + i + layout.hidden(0)) ^ *b.at(0, row + i + layout.hidden(0));
        differ |= (v | h) & (cells >> 8 * i);
    }
    return differ == 0;
}

void copy_cells(const CellLayout& layout, uint32_t row, uint32_t cells, const CellStates& from, CellStates& to) {
    for (uint32_t i = 0; i < layout.row_bytes(0); ++i) {
        for (const uint32_t byte : {row + i, row + i + layout.hidden(0)})
            *to.at(0, byte) = static_cast<uint8_t>(*to.at(0, byte) | (*from.at(0, byte) & cells >> 8 * i));
    }
}

std::array<uint32_t, VisibilityLevelCode::kContexts> VisibilityLevelCode::context_counts(uint32_t level) {
    const auto bits = [](uint32_t count) { return 1u << count; };
    if (level == 0) return {bits(14), kPlaces * 4, bits(12), bits(14), bits(14), bits(14), bits(15)};
    if (level + 1 == kCellLevels) return {bits(12), kPlaces * 4, bits(12), bits(14), bits(14), bits(14), bits(15)};
    return {bits(14), kPlaces * 4, bits(12), bits(14), bits(14), bits(14), bits(15)};
}

VisibilityLevelCode::VisibilityLevelCode(const CellLayout& layout, uint32_t level)
    : layout_(layout), level_(level), mixer_(context_counts(level), level + 1 == kCellLevels ? 1 : 2, kSets) {}

VisibilityLevelCode::Row VisibilityLevelCode::row_of(const KnownStates& known, const CellStates& states, uint32_t face,
                                                     uint32_t y) const {
    const uint32_t at = layout_.row(level_, face, y);
    Row row{face, y, known.first.at(level_, at), known.second.at(level_, at), states.at(level_, at)};
    if (level_ == 0) {
        row.parts = known.first.at(1, layout_.row(1, face, 2 * y));
    } else {
        row.greater = states.at(level_ - 1, layout_.row(level_ - 1, face, y / 2));
        row.greater_below = row.greater + (y % 2 != 0 ? layout_.stride(level_ - 1) : 0);
    }
    return row;
}

uint32_t VisibilityLevelCode::where(const Row& row, uint32_t x) const {
    const uint32_t scale = std::max(1u, layout_.across(level_) / kPlacesAcross);
    return (row.face * kPlacesAcross + std::min(row.y / scale, kPlacesAcross - 1)) * kPlacesAcross +
           std::min(x / scale, kPlacesAcross - 1);
}

VisibilityLevelCode::Parts VisibilityLevelCode::parts_around(const Row& row, uint32_t x) const {
    const uint32_t stride = layout_.stride(1), hidden = layout_.hidden(1);
    const auto column = static_cast<int32_t>(x);
    const auto parts_of = [&](int32_t part_row, int32_t from, uint32_t count) {
        return columns_of(row.parts + part_row * static_cast<int32_t>(stride), hidden, from, count);
    };
    const bool is_cut = 2 * row.y + 1 >= layout_.across(1);
    const Columns upper = parts_of(0, 2 * column - 1, 4), lower = parts_of(1, 2 * column - 1, 4);
    const uint32_t above = parts_of(-1, 2 * column, 2).mixed(), below = is_cut ? 0 : parts_of(2, 2 * column, 2).mixed();
    const uint32_t beside = upper.mixed() | lower.mixed();
    const uint32_t states = Joint()
                                .add(upper.visible >> 1 & 3, 2)
                                .add(upper.hidden >> 1 & 3, 2)
                                .add(lower.visible >> 1 & 3, 2)
                                .add(lower.hidden >> 1 & 3, 2);
    return {states, (above != 0 ? 1u : 0) | (below != 0 ? 2u : 0) | (beside & 1) << 2 | (beside >> 3) << 3};
}

void VisibilityLevelCode::set_contexts(const Row& row, uint32_t x) {
    const uint32_t stride = layout_.stride(level_), hidden = layout_.hidden(level_);
    const auto column = static_cast<int32_t>(x);
    const Square first = square_of(row.first, stride, hidden, x), second = square_of(row.second, stride, hidden, x);
    const Columns north = columns_of(row.here - stride, hidden, column - 1, 3);
    const Columns west = columns_of(row.here, hidden, column - 2, 2);  // the second one is next to the cell
    const Columns north2 = row.y == 0 ? Columns{} : columns_of(row.here - 2 * stride, hidden, column, 1);
    const uint32_t a = first.middle.state(1), b = second.middle.state(1), both = a | b << 2;
    // Which of the cells before are as the two receivers have them not.
    const auto differ = [&](const Square& other) -> uint32_t {
        const uint32_t above = (north.visible ^ other.north.visible) | (north.hidden ^ other.north.hidden);
        return above | (west.state(1) != other.middle.state(0) ? 8u : 0);
    };
    const uint32_t wrong = differ(first) | differ(second) << 4;
    const uint32_t before = Joint().add(north.visible, 3).add(north.hidden, 3).add(west.state(1), 2);
    const uint32_t around_first = cross(first.north.visible, first.middle.visible, first.south.visible) |
                                  cross(first.north.hidden, first.middle.hidden, first.south.hidden) << 4;
    const uint32_t edges = Joint()
                               .add(square(first.north.mixed(), first.middle.mixed(), first.south.mixed()), 9)
                               .add(second.middle.mixed(), 3)
                               .add(second.north.mixed() >> 1 & 1, 1)
                               .add(second.south.mixed() >> 1 & 1, 1)
                               .add(north.visible >> 1 & 1, 1);
    const uint32_t at = where(row, x) * kCellStates + a, right = wrong | both << 8;
    const uint32_t set = both + kPairs * kThirds[wrong];
    const uint32_t north_mixed = north.mixed() >> 1 & 1, west_mixed = west.mixed() >> 1;
    if (level_ == 0) {
        const auto [parts, ring] = parts_around(row, x);
        const uint32_t second_edges = cross(second.north.mixed(), second.middle.mixed(), second.south.mixed());
        mixer_.set_contexts({Joint().add(around_first, 8).add(both, 4).add(north_mixed, 1).add(west_mixed, 1), at,
                             right, Joint().add(parts, 8).add(ring, 4).add(north_mixed, 1).add(west_mixed, 1),
                             Joint().add(before, 8).add(west.state(0), 2).add(north2.state(0), 2).add(a, 2),
                             Joint().add(parts, 8).add(second_edges, 4).add(b, 2), edges},
                            set);
        return;
    }
    const uint32_t greater_hidden = layout_.hidden(level_ - 1), part = x % 2 + 2 * (row.y % 2);
    const auto greater = [&](const uint8_t* cells, int32_t at_column) {
        return columns_of(cells, greater_hidden, at_column, 1).state(0);
    };
    const uint32_t east = greater(row.greater, (column + 1) / 2), south = greater(row.greater_below, column / 2);
    const uint32_t south_east = greater(row.greater_below, (column + 1) / 2);
    const uint32_t after = east | south << 2;
    mixer_.set_contexts(
        {Joint().add(around_first, 8).add(a, 2).add(part, 2).add(b, 2), at, right,
         Joint().add(before, 8).add(after, 4).add(part, 2),
         Joint().add(before, 8).add(west.state(0), 2).add(north2.state(0), 2).add(part, 2),
         Joint().add(after, 4).add(south_east, 2).add(west.state(1), 2).add(north.state(1), 2).add(both, 4), edges},
        set);
}

void VisibilityLevelCode::set_finest_contexts(const Row& row, uint32_t x) {
    const uint32_t stride = layout_.stride(level_), hidden = layout_.hidden(level_);
    const auto column = static_cast<int32_t>(x);
    const auto three = [&](const uint8_t* cells) { return row_bits(cells, column - 1, 3); };
    const uint32_t first_north = three(row.first - stride), first_middle = three(row.first),
                   first_south = three(row.first + stride);
    const uint32_t second_north = three(row.second - stride), second_middle = three(row.second),
                   second_south = three(row.second + stride);
    const uint32_t a = (first_middle >> 1 & 1) | row_bits(row.first + hidden, column, 1) << 1;
    const uint32_t b = (second_middle >> 1 & 1) | row_bits(row.second + hidden, column, 1) << 1, both = a | b << 2;
    const uint32_t north = three(row.here - stride), west2 = row_bits(row.here, column - 2, 2), west = west2 >> 1;
    const uint32_t north2 = row.y == 0 ? 0 : row_bits(row.here - 2 * stride, column, 1);
    const uint32_t wrong = (north ^ first_north) | (west ^ (first_middle & 1)) << 3 | (north ^ second_north) << 4 |
                           (west ^ (second_middle & 1)) << 7;
    const uint32_t greater_hidden = layout_.hidden(level_ - 1), part = x % 2 + 2 * (row.y % 2);
    const auto greater = [&](const uint8_t* cells, int32_t at) {
        return row_bits(cells, at, 1) | row_bits(cells + greater_hidden, at, 1) << 1;
    };
    const uint32_t east = greater(row.greater, (column + 1) / 2), south = greater(row.greater_below, column / 2);
    const uint32_t south_east = greater(row.greater_below, (column + 1) / 2);
    const uint32_t first_square = square(first_north, first_middle, first_south);
    const uint32_t first_cross = cross(first_north, first_middle, first_south) | (a & 1) << 4;
    const uint32_t second_cross = cross(second_north, second_middle, second_south) | (b & 1) << 4;
    mixer_.set_contexts(
        {Joint().add(first_square, 9).add(part, 2).add(b & 1, 1), where(row, x) * kCellStates + a,
         Joint().add(wrong, 8).add(both, 4),
         Joint()
             .add(north, 3)
             .add(west, 1)
             .add(west2 & 1, 1)
             .add(north2, 1)
             .add(east, 2)
             .add(south, 2)
             .add(south_east, 2)
             .add(part, 2),
         Joint().add(first_cross, 5).add(second_cross, 5).add(west, 1).add(north >> 1 & 1, 1).add(part, 2),
         Joint().add(first_cross, 5).add(north, 3).add(west, 1).add(east, 2).add(south, 2).add(row.y % 2, 1),
         Joint()
             .add(first_square, 9)
             .add(second_middle, 3)
             .add(second_north >> 1 & 1, 1)
             .add(second_south >> 1 & 1, 1)
             .add(north >> 1 & 1, 1)},
        both + kPairs * kThirds[wrong]);
}

}  // namespace citystream::codec::radiance
