#include "codec/facade/quotient_parts.h"

#include <algorithm>
#include <cassert>
#include <unordered_map>

namespace citystream::codec::facade {

namespace {

uint64_t mixed(uint64_t hash, uint32_t value) {
    hash = (hash ^ value) * 0x9e3779b97f4a7c15u;
    return hash ^ hash >> 32;
}

struct Classes {
    std::vector<uint32_t> of;      ///< class of each line
    std::vector<uint32_t> sample;  ///< first line of each class
};

/// Numbers lines by first use; equal(a, b) settles what the hashes leave open.
template <typename Equal>
Classes classes_of(const std::vector<uint64_t>& hashes, Equal equal) {
    Classes classes;
    std::unordered_map<uint64_t, std::vector<uint32_t>> known;
    for (uint32_t line = 0; line < hashes.size(); ++line) {
        std::vector<uint32_t>& candidates = known[hashes[line]];
        const auto same = std::find_if(candidates.begin(), candidates.end(),
                                       [&](uint32_t c) { return equal(classes.sample[c], line); });
        if (same != candidates.end()) {
            classes.of.push_back(*same);
            continue;
        }
        candidates.push_back(static_cast<uint32_t>(classes.sample.size()));
        classes.of.push_back(candidates.back());
        classes.sample.push_back(line);
    }
    return classes;
}

}  // namespace

QuotientParts make_quotient(const RunGrid& grid) {
    assert(is_valid(grid));
    const uint32_t columns = grid.columns(), rows = grid.rows();
    std::vector<uint64_t> hashes(rows, 0);
    for (uint32_t r = 0; r < rows; ++r) {
        for (uint32_t c = 0; c < columns; ++c) hashes[r] = mixed(hashes[r], grid.label(c, r));
    }
    const Classes y = classes_of(hashes, [&](uint32_t a, uint32_t b) {
        const auto row = [&](uint32_t r) { return grid.labels.begin() + static_cast<ptrdiff_t>(size_t{r} * columns); };
        return std::equal(row(a), row(a) + columns, row(b));
    });
    hashes.assign(columns, 0);
    for (const uint32_t r : y.sample) {
        for (uint32_t c = 0; c < columns; ++c) hashes[c] = mixed(hashes[c], grid.label(c, r));
    }
    const Classes x = classes_of(hashes, [&](uint32_t a, uint32_t b) {
        return std::all_of(y.sample.begin(), y.sample.end(),
                           [&](uint32_t r) { return grid.label(a, r) == grid.label(b, r); });
    });
    QuotientParts parts{grid.x_breaks, grid.y_breaks, x.of, y.of, 0, 0, {}};
    parts.columns = static_cast<uint32_t>(x.sample.size());
    parts.rows = static_cast<uint32_t>(y.sample.size());
    parts.labels.reserve(size_t{parts.columns} * parts.rows);
    for (const uint32_t r : y.sample) {
        for (const uint32_t c : x.sample) parts.labels.push_back(grid.label(c, r));
    }
    return parts;
}

RunGrid expand_quotient(const QuotientParts& parts) {
    RunGrid grid{parts.x_breaks, parts.y_breaks, {}};
    grid.labels.reserve(parts.x_classes.size() * parts.y_classes.size());
    for (const uint32_t row : parts.y_classes) {
        for (const uint32_t column : parts.x_classes) grid.labels.push_back(parts.label(column, row));
    }
    return grid;
}

}  // namespace citystream::codec::facade
