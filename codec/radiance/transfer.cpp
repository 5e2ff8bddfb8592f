#include "codec/radiance/transfer.h"

#include <algorithm>
#include <bit>
#include <string_view>
#include <unordered_map>

namespace citystream::codec::radiance {

namespace {

struct Entry {
    uint16_t row, column;  ///< row: local direction
    int8_t quarters;
};

/// Entries of one receiver, columns rising.
void gather_entries(std::span<const uint32_t> bits, std::span<const uint32_t> above, std::span<const uint16_t> local,
                    uint32_t side, std::vector<Entry>& entries) {
    const uint32_t samples_across = kSamplesAcross * side;
    const auto sees = [&](uint32_t s) { return (bits[s / 32] & above[s / 32]) >> s % 32 & 1; };
    entries.clear();
    for (uint32_t k = 0; k < texel_count(side); ++k) {
        const uint32_t column = k % side, row = k / side;  // rows of all faces follow each other in both grids
        const uint32_t first = kSamplesAcross * (row * samples_across + column);
        const size_t begin = entries.size();
        for (const uint32_t s : {first, first + 1, first + samples_across, first + samples_across + 1}) {
            if (sees(s) == 0) continue;
            const auto same = std::find_if(entries.begin() + static_cast<std::ptrdiff_t>(begin), entries.end(),
                                           [&](const Entry& e) { return e.row == local[s]; });
            if (same == entries.end())
                entries.push_back({local[s], static_cast<uint16_t>(k), 1});
            else
                ++same->quarters;
        }
    }
}

struct FrameTable {
    std::vector<uint16_t> local;  ///< of each sample
    std::vector<uint32_t> above;
};

/// Tables of the frames that were asked for last: a curved surface has as many frames as receivers.
class FrameTables {
  public:
    FrameTables(const VisibilityTile& tile, const LocalDirections& local, TransferRule rule)
        : tile_(tile), local_(local), rule_(rule) {}

    const FrameTable& of(uint32_t frame) {
        Slot& slot = slots_[frame % kSlots];
        if (slot.frame == frame) return slot.table;
        const Frame axes = unpack_frame(tile_.frames[frame]);
        slot = {frame, {local_of_samples(axes, tile_.side, local_, rule_), samples_above(axes, tile_.side)}};
        return slot.table;
    }

  private:
    static constexpr uint32_t kSlots = 64, kNone = ~0u;
    struct Slot {
        uint32_t frame = kNone;
        FrameTable table;
    };
    const VisibilityTile& tile_;
    const LocalDirections& local_;
    TransferRule rule_;
    Slot slots_[kSlots];
};

/// Appends a receiver's rows.
void append_rows(Transfer& transfer, const std::vector<Entry>& entries, uint32_t local_count) {
    std::vector<uint32_t> place(local_count + 1, 0);
    for (const Entry& e : entries) ++place[e.row + 1u];
    place[0] = transfer.row_begin.back();
    for (uint32_t j = 1; j <= local_count; ++j) {
        place[j] += place[j - 1];
        transfer.row_begin.push_back(place[j]);
    }
    transfer.column.resize(transfer.row_begin.back());
    transfer.quarters.resize(transfer.row_begin.back());
    for (const Entry& e : entries) {
        transfer.column[place[e.row]] = e.column;
        transfer.quarters[place[e.row]++] = e.quarters;
    }
}

/// A row's bytes, by which rows are found again.
std::string_view row_bytes(const Transfer& transfer, uint32_t row, std::vector<char>& room) {
    room.clear();
    for (uint32_t i = transfer.row_begin[row]; i < transfer.row_begin[row + 1]; ++i) {
        room.push_back(static_cast<char>(transfer.column[i] & 0xff));
        room.push_back(static_cast<char>(transfer.column[i] >> 8));
        room.push_back(static_cast<char>(transfer.quarters[i]));
    }
    return {room.data(), room.size()};
}

bool same_rows(const Transfer& a, uint32_t row, const Transfer& b, uint32_t other) {
    const uint32_t begin = a.row_begin[row], count = a.row_begin[row + 1] - begin, there = b.row_begin[other];
    if (b.row_begin[other + 1] - there != count) return false;
    const auto same = [&](const auto& x, const auto& y) {
        return std::equal(x.begin() + begin, x.begin() + begin + count, y.begin() + there);
    };
    return same(a.column, b.column) && same(a.quarters, b.quarters);
}

void append_row(Transfer& to, const Transfer& from, uint32_t row) {
    const auto begin = static_cast<std::ptrdiff_t>(from.row_begin[row]);
    const auto end = static_cast<std::ptrdiff_t>(from.row_begin[row + 1]);
    to.column.insert(to.column.end(), from.column.begin() + begin, from.column.begin() + end);
    to.quarters.insert(to.quarters.end(), from.quarters.begin() + begin, from.quarters.begin() + end);
    to.row_begin.push_back(static_cast<uint32_t>(to.column.size()));
}

}  // namespace

std::vector<uint16_t> local_of_samples(const Frame& frame, uint32_t side, const LocalDirections& local,
                                       TransferRule rule) {
    std::vector<uint16_t> table(sample_count(side));
    for (uint32_t s = 0; s < table.size(); ++s) {
        const GridDirection d = rule == TransferRule::kSamples ? cell_direction(kSamplesAcross * side, s)
                                                               : cell_direction(side, texel_of_sample(side, s));
        table[s] = static_cast<uint16_t>(local.nearest(frame.to_local(d)));
    }
    return table;
}

Transfer make_transfer(const VisibilityTile& tile, const LocalDirections& local, TransferRule rule) {
    Transfer transfer{texel_count(tile.side), {0}, {}, {}};
    FrameTables tables(tile, local, rule);
    std::vector<Entry> entries;
    for (uint32_t r = 0; r < tile.receivers(); ++r) {
        const FrameTable& table = tables.of(tile.frame_of[r]);
        gather_entries(tile.of(r), table.above, table.local, tile.side, entries);
        append_rows(transfer, entries, local.count());
    }
    return transfer;
}

DistinctRows distinct_rows(const Transfer& transfer) {
    DistinctRows distinct{{transfer.columns, {0}, {}, {}}, {}};
    std::unordered_multimap<size_t, uint32_t> places;
    std::vector<char> room;
    for (uint32_t row = 0; row < transfer.rows(); ++row) {
        const size_t hash = std::hash<std::string_view>()(row_bytes(transfer, row, room));
        const auto [first, last] = places.equal_range(hash);
        const auto known = std::find_if(
            first, last, [&](const auto& place) { return same_rows(transfer, row, distinct.rows, place.second); });
        if (known != last) {
            distinct.row_of.push_back(known->second);
            continue;
        }
        places.emplace(hash, distinct.rows.rows());
        distinct.row_of.push_back(distinct.rows.rows());
        append_row(distinct.rows, transfer, row);
    }
    return distinct;
}

Transfer all_rows(const DistinctRows& distinct) {
    Transfer transfer{distinct.rows.columns, {0}, {}, {}};
    for (const uint32_t row : distinct.row_of) append_row(transfer, distinct.rows, row);
    return transfer;
}

}  // namespace citystream::codec::radiance
