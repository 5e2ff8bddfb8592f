#include "tiles/city/facade_catalog.h"

#include <xxhash.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <cstring>
#include <span>

#include "codec/bits/zstd_frame.h"

namespace citystream::tiles::city {
namespace {

using codec::facade::RunGrid;

constexpr int kZstdLevel = 3;              // maps are read back a few times and never sent in this form
constexpr size_t kMapOverheadBytes = 104;  // vector, its block, hash node

/// What stands before the runs: counts of the three lists that follow.
struct Head {
    uint32_t columns = 0, rows = 0, labels = 0;
};
static_assert(sizeof(Head) == 12);

template <typename T>
void put(std::vector<std::byte>& out, std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    out.insert(out.end(), bytes.begin(), bytes.end());
}

std::vector<uint16_t> lengths_of(const std::vector<uint32_t>& breaks) {
    std::vector<uint16_t> lengths;
    for (size_t i = 1; i < breaks.size(); ++i) lengths.push_back(static_cast<uint16_t>(breaks[i] - breaks[i - 1]));
    return lengths;
}

size_t index_bytes(size_t labels) {
    return labels <= 256 ? 1 : 4;
}

/// Head, lengths of columns and rows, distinct labels, for each cell the index of its label.
std::vector<std::byte> serialise(const RunGrid& grid) {
    std::vector<uint32_t> distinct = grid.labels;
    std::sort(distinct.begin(), distinct.end());
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    const Head head{grid.columns(), grid.rows(), static_cast<uint32_t>(distinct.size())};
    std::vector<std::byte> raw;
    put(raw, std::span(&head, 1));
    put(raw, std::span<const uint16_t>(lengths_of(grid.x_breaks)));
    put(raw, std::span<const uint16_t>(lengths_of(grid.y_breaks)));
    put(raw, std::span<const uint32_t>(distinct));
    const size_t size = index_bytes(distinct.size());
    for (const uint32_t label : grid.labels) {
        const auto index =
            static_cast<uint32_t>(std::lower_bound(distinct.begin(), distinct.end(), label) - distinct.begin());
        const auto bytes = std::as_bytes(std::span(&index, 1));
        raw.insert(raw.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    }
    return raw;
}

/// Reads what serialise() wrote.
class MapReader {
  public:
    explicit MapReader(std::span<const std::byte> raw) : raw_(raw) {}

    RunGrid run() {
        const Head head = take<Head>();
        RunGrid grid;
        grid.x_breaks = take_breaks(head.columns);
        grid.y_breaks = take_breaks(head.rows);
        std::vector<uint32_t> distinct(head.labels);
        for (uint32_t& label : distinct) label = take<uint32_t>();
        grid.labels.resize(size_t{head.columns} * head.rows);
        const size_t size = index_bytes(distinct.size());
        for (uint32_t& label : grid.labels) {
            uint32_t index = 0;
            std::memcpy(&index, raw_.data() + at_, size);
            at_ += size;
            label = distinct[index];
        }
        return grid;
    }

  private:
    template <typename T>
    T take() {
        T value;
        std::memcpy(&value, raw_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return value;
    }
    std::vector<uint32_t> take_breaks(uint32_t runs) {
        std::vector<uint32_t> breaks = {0};
        for (uint32_t i = 0; i < runs; ++i) breaks.push_back(breaks.back() + take<uint16_t>());
        return breaks;
    }

    std::span<const std::byte> raw_;
    size_t at_ = 0;
};

}  // namespace

uint32_t FacadeCatalog::add(const RunGrid& grid, double texel_metres) {
    assert(is_valid(grid) && texel_metres > 0);
    const std::vector<std::byte> raw = serialise(codec::facade::merge_equal_runs(grid));
    Stored stored{codec::bits::compress_frame(raw, kZstdLevel), static_cast<uint32_t>(raw.size()), texel_metres};
    const uint64_t hash = XXH3_64bits(stored.frame.data(), stored.frame.size());
    const auto [first, last] = by_hash_.equal_range(hash);
    for (auto same = first; same != last; ++same) {
        Stored& kept = maps_[same->second];
        if (kept.frame != stored.frame) continue;
        kept.texel_metres = std::min(kept.texel_metres, texel_metres);
        return same->second;
    }
    const auto index = static_cast<uint32_t>(maps_.size());
    stored.frame.shrink_to_fit();
    memory_bytes_ += stored.frame.size() + kMapOverheadBytes;
    maps_.push_back(std::move(stored));
    by_hash_.emplace(hash, index);
    return index;
}

RunGrid FacadeCatalog::map(uint32_t index) const {
    assert(index < maps_.size());
    const auto raw = codec::bits::decompress_frame(maps_[index].frame, maps_[index].raw_bytes);
    if (!raw) std::abort();  // our own bytes, in memory: only broken hardware gets here
    return MapReader(*raw).run();
}

}  // namespace citystream::tiles::city
