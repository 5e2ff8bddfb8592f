#include "codec/radiance/transfer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <utility>

#include "codec/radiance/distinct_row_set.h"

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

/// Which local direction is nearest to each cell of a grid, face by face. Products are linear over a face: in a square
/// of cells none can be the nearest to any whose product is exceeded by that of one and the same other at all four
/// corners. So few are left to be looked at, and most small squares have one alone.
class NearestOfCells {
  public:
    NearestOfCells(const Frame& frame, uint32_t side, const LocalDirections& local)
        : frame_(frame), side_(side), local_(local), nearest_(cube_cells(side), 0) {}

    /// 0 where all of a square is below the plane.
    std::vector<uint16_t> fill() {
        std::vector<uint16_t> all(local_.count());
        std::iota(all.begin(), all.end(), uint16_t{0});
        for (face_ = 0; face_ < kCubeFaces; ++face_) {
            height_ = product_with({0, 0, 1});
            products_.clear();
            for (uint32_t j = 0; j < local_.count(); ++j) products_.push_back(product_with(local_.direction(j)));
            fill_square(0, 0, side_, all);
        }
        return std::move(nearest_);
    }

  private:
    static constexpr uint32_t kParts = 4, kSmall = 4;

    /// Of a vector in the frame's axes.
    FaceProduct product_with(const GridDirection& in_frame) const {
        std::array<int64_t, 3> world{};
        for (size_t k = 0; k < 3; ++k) {
            for (size_t i = 0; i < 3; ++i) world[k] += int64_t{frame_.axes[i][k]} * in_frame[i];
        }
        return face_product(world, side_, face_);
    }

    void fill_square(uint32_t x, uint32_t y, uint32_t size, const std::vector<uint16_t>& candidates) {
        if (x >= side_ || y >= side_) return;
        const uint32_t right = std::min(x + size, side_) - 1, low = std::min(y + size, side_) - 1;
        const std::array<std::array<uint32_t, 2>, 4> corners = {{{x, y}, {right, y}, {x, low}, {right, low}}};
        const auto at = [&](const FaceProduct& product) {
            std::array<int64_t, 4> values{};
            for (size_t c = 0; c < 4; ++c) values[c] = product.at(corners[c][0], corners[c][1]);
            return values;
        };
        const auto heights = at(height_);
        if (*std::max_element(heights.begin(), heights.end()) <= 0) return;
        const std::vector<uint16_t> left = left_of(candidates, at);
        if (left.size() == 1) {
            for (uint32_t row = y; row <= low; ++row) std::fill_n(&nearest_[cell(x, row)], right - x + 1, left[0]);
        } else if (size <= kSmall) {
            for (uint32_t row = y; row <= low; ++row) {
                for (uint32_t column = x; column <= right; ++column)
                    nearest_[cell(column, row)] = nearest_of(left, column, row);
            }
        } else {
            const uint32_t part = (size + kParts - 1) / kParts;
            for (uint32_t i = 0; i < kParts * kParts; ++i)
                fill_square(x + i % kParts * part, y + i / kParts * part, part, left);
        }
    }

    /// Candidates that no other exceeds at all corners.
    template <typename At>
    std::vector<uint16_t> left_of(const std::vector<uint16_t>& candidates, const At& at) const {
        std::vector<std::array<int64_t, 4>> values;
        values.reserve(candidates.size());
        for (const uint16_t j : candidates) values.push_back(at(products_[j]));
        std::array<size_t, 4> best{};
        for (size_t i = 1; i < values.size(); ++i) {
            for (size_t c = 0; c < 4; ++c) best[c] = values[i][c] > values[best[c]][c] ? i : best[c];
        }
        std::vector<uint16_t> left;
        for (size_t i = 0; i < values.size(); ++i) {
            const auto exceeds = [&](size_t k) {
                return values[k][0] > values[i][0] && values[k][1] > values[i][1] && values[k][2] > values[i][2] &&
                       values[k][3] > values[i][3];
            };
            if (std::none_of(best.begin(), best.end(), exceeds)) left.push_back(candidates[i]);
        }
        return left;
    }

    uint16_t nearest_of(const std::vector<uint16_t>& candidates, uint32_t column, uint32_t row) const {
        uint16_t best = candidates[0];
        int64_t most = products_[best].at(column, row);
        for (size_t i = 1; i < candidates.size(); ++i) {
            const int64_t here = products_[candidates[i]].at(column, row);
            if (here <= most) continue;
            most = here;
            best = candidates[i];
        }
        return best;
    }

    size_t cell(uint32_t column, uint32_t row) const { return (size_t{face_} * side_ + row) * side_ + column; }

    const Frame& frame_;
    uint32_t side_, face_ = 0;
    const LocalDirections& local_;
    FaceProduct height_;
    std::vector<FaceProduct> products_;
    std::vector<uint16_t> nearest_;
};

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

constexpr uint32_t kFrameTables = 256;
constexpr uint64_t kHashFactor = 0x9e3779b97f4a7c15u;
constexpr uint32_t kPieceBits = 32, kEvenBits = 0x55555555;
constexpr uint8_t kBitsOfFour[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
constexpr uint32_t kFirstPlacesLog2 = 10;

/// `count` (1..32) bits from one on.
uint32_t bits_from(std::span<const uint32_t> bits, uint32_t first, uint32_t count) {
    const uint32_t word = first / 32, shift = first % 32;
    uint64_t both = bits[word];
    if (shift + count > 32) both |= uint64_t{bits[word + 1]} << 32;
    return static_cast<uint32_t>(both >> shift & ((uint64_t{1} << count) - 1));
}

/// Sample rows 2r and 2r + 1 are row r of the texels; calls visit(first sample of the upper row, samples) for each
/// piece of 16 texels or, at the end of a row, fewer.
template <typename Visit>
void visit_pieces(uint32_t side, Visit visit) {
    const uint32_t across = kSamplesAcross * side;
    for (uint32_t row = 0; row < kCubeFaces * side; ++row) {
        for (uint32_t x = 0; x < across; x += kPieceBits)
            visit(kSamplesAcross * row * across + x, std::min(kPieceBits, across - x));
    }
}

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
    if (rule == TransferRule::kSamples) return NearestOfCells(frame, kSamplesAcross * side, local).fill();
    const std::vector<uint16_t> of_texels = NearestOfCells(frame, side, local).fill();
    std::vector<uint16_t> table(sample_count(side));
    for (uint32_t s = 0; s < table.size(); ++s) table[s] = of_texels[texel_of_sample(side, s)];
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

/// Of a frame: which samples of which pieces each local direction has, and its last receiver.
struct DistinctRowMaker::FrameTable {
    uint32_t frame = ~0u;
    std::vector<uint32_t> begin;   ///< of each local direction's part of the next three
    std::vector<uint16_t> piece;   ///< rising
    std::vector<uint64_t> mask;    ///< samples above the plane that go to the local direction
    std::vector<uint64_t> last;    ///< those that the last receiver saw
    std::vector<uint32_t> row_of;  ///< its rows; kNone: there is none yet
    static constexpr uint32_t kNone = ~0u;

    FrameTable() = default;
    FrameTable(uint32_t number, const Frame& axes, uint32_t side, const LocalDirections& local);

  private:
    struct Part {
        uint16_t local, piece;
        uint64_t mask;
    };
    static std::vector<Part> parts_of(const Frame& axes, uint32_t side, const LocalDirections& local);
};

std::vector<DistinctRowMaker::FrameTable::Part> DistinctRowMaker::FrameTable::parts_of(const Frame& axes, uint32_t side,
                                                                                       const LocalDirections& local) {
    const std::vector<uint16_t> local_of = local_of_samples(axes, side, local);
    const std::vector<uint32_t> above = samples_above(axes, side);
    std::vector<Part> parts;
    std::vector<uint64_t> masks(local.count(), 0);
    std::vector<uint16_t> met;
    uint16_t piece = 0;
    visit_pieces(side, [&](uint32_t first, uint32_t count) {
        met.clear();
        for (uint32_t row = 0; row < kSamplesAcross; ++row) {
            for (uint32_t i = 0; i < count; ++i) {
                const uint32_t s = first + row * kSamplesAcross * side + i;
                if ((above[s / 32] >> s % 32 & 1) == 0) continue;
                if (masks[local_of[s]] == 0) met.push_back(local_of[s]);
                masks[local_of[s]] |= uint64_t{1} << (row * kPieceBits + i);
            }
        }
        for (const uint16_t j : met) parts.push_back({j, piece, std::exchange(masks[j], 0)});
        ++piece;
    });
    return parts;
}

DistinctRowMaker::FrameTable::FrameTable(uint32_t number, const Frame& axes, uint32_t side,
                                         const LocalDirections& local)
    : frame(number), begin(local.count() + 1, 0), row_of(local.count(), kNone) {
    const std::vector<Part> parts = parts_of(axes, side, local);
    for (const Part& part : parts) ++begin[part.local + 1u];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    piece.resize(parts.size());
    mask.resize(parts.size());
    last.resize(parts.size(), 0);
    std::vector<uint32_t> place(begin.begin(), begin.end() - 1);
    for (const Part& part : parts) {
        const uint32_t at = place[part.local]++;
        piece[at] = part.piece;
        mask[at] = part.mask;
    }
}

DistinctRowMaker::DistinctRowMaker(uint32_t side, const LocalDirections& local)
    : side_(side), local_(local), tables_(kFrameTables), distinct_{{texel_count(side), {0}, {}, {}}, {}} {}

DistinctRowMaker::~DistinctRowMaker() = default;

DistinctRowMaker::FrameTable& DistinctRowMaker::table_of(uint32_t frame, uint32_t frame_code) {
    FrameTable& table = tables_[frame % kFrameTables];
    if (table.frame != frame) table = FrameTable(frame, unpack_frame(frame_code), side_, local_);
    return table;
}

void DistinctRowMaker::combine(std::span<const uint32_t> bits) {
    const uint32_t across = kSamplesAcross * side_;
    pieces_.clear();
    visit_pieces(side_, [&](uint32_t first, uint32_t count) {
        pieces_.push_back(bits_from(bits, first, count) | uint64_t{bits_from(bits, first + across, count)} << 32);
    });
}

/// The entries of a row from what its frame's last receiver sees.
void DistinctRowMaker::gather(const FrameTable& table, uint32_t local) {
    const uint32_t in_row = (kSamplesAcross * side_ + kPieceBits - 1) / kPieceBits;
    entries_.clear();
    for (uint32_t i = table.begin[local]; i < table.begin[local + 1]; ++i) {
        const auto upper = static_cast<uint32_t>(table.last[i]), lower = static_cast<uint32_t>(table.last[i] >> 32);
        const uint32_t any = upper | lower, piece = table.piece[i];
        const uint32_t texel = piece / in_row * side_ + piece % in_row * (kPieceBits / kSamplesAcross);
        for (uint32_t left = (any | any >> 1) & kEvenBits; left != 0; left &= left - 1) {
            const auto at = static_cast<uint32_t>(std::countr_zero(left));
            const uint32_t quarters = kBitsOfFour[(upper >> at & 3) | (lower >> at & 3) << 2];
            entries_.push_back((texel + at / kSamplesAcross) << 8 | quarters);
        }
    }
}

void DistinctRowMaker::grow_places() {
    places_log2_ = places_.empty() ? kFirstPlacesLog2 : places_log2_ + 1;
    places_.assign(size_t{1} << places_log2_, 0);
    for (uint32_t row = 0; row < hashes_.size(); ++row) {
        size_t place = hashes_[row] >> (64 - places_log2_);
        while (places_[place] != 0) place = (place + 1) % places_.size();
        places_[place] = row + 1;
    }
}

/// Of the row of `entries_`, which joins the others if it is not there.
uint32_t DistinctRowMaker::number_of_row() {
    Transfer& rows = distinct_.rows;
    uint64_t hash = entries_.size();
    for (const uint32_t entry : entries_) hash = (hash ^ entry) * kHashFactor;
    const auto is_row = [&](uint32_t row) {
        const uint32_t begin = rows.row_begin[row];
        if (hashes_[row] != hash || rows.row_begin[row + 1] - begin != entries_.size()) return false;
        for (size_t i = 0; i < entries_.size(); ++i) {
            if (entries_[i] !=
                (uint32_t{rows.column[begin + i]} << 8 | static_cast<uint32_t>(rows.quarters[begin + i])))
                return false;
        }
        return true;
    };
    if (2 * (hashes_.size() + 1) > places_.size()) grow_places();
    size_t place = hash >> (64 - places_log2_);
    for (; places_[place] != 0; place = (place + 1) % places_.size()) {
        if (is_row(places_[place] - 1)) return places_[place] - 1;
    }
    hashes_.push_back(hash);
    places_[place] = static_cast<uint32_t>(hashes_.size());
    for (const uint32_t entry : entries_) {
        rows.column.push_back(static_cast<uint16_t>(entry >> 8));
        rows.quarters.push_back(static_cast<int8_t>(entry & 0xff));
    }
    rows.row_begin.push_back(static_cast<uint32_t>(rows.column.size()));
    return rows.rows() - 1;
}

void DistinctRowMaker::add(uint32_t frame, uint32_t frame_code, std::span<const uint32_t> bits) {
    FrameTable& table = table_of(frame, frame_code);
    combine(bits);
    for (uint32_t local = 0; local < local_.count(); ++local) {
        uint64_t changed = 0;
        for (uint32_t i = table.begin[local]; i < table.begin[local + 1]; ++i) {
            const uint64_t seen = pieces_[table.piece[i]] & table.mask[i];
            changed |= seen ^ table.last[i];
            table.last[i] = seen;
        }
        if (changed != 0 || table.row_of[local] == FrameTable::kNone) {
            gather(table, local);
            table.row_of[local] = number_of_row();
        }
        distinct_.row_of.push_back(table.row_of[local]);
    }
}

DistinctRows DistinctRowMaker::take() {
    distinct_.rows.column.shrink_to_fit();
    distinct_.rows.quarters.shrink_to_fit();
    return std::move(distinct_);
}

DistinctRows distinct_rows(const Transfer& transfer) {
    DistinctRowSet set(transfer.columns);
    for (uint32_t row = 0; row < transfer.rows(); ++row) {
        const uint32_t begin = transfer.row_begin[row], count = transfer.row_begin[row + 1] - begin;
        set.add(std::span(transfer.column).subspan(begin, count), std::span(transfer.quarters).subspan(begin, count));
    }
    return set.take();
}

Transfer all_rows(const DistinctRows& distinct) {
    Transfer transfer{distinct.rows.columns, {0}, {}, {}};
    for (const uint32_t row : distinct.row_of) append_row(transfer, distinct.rows, row);
    return transfer;
}

}  // namespace citystream::codec::radiance
