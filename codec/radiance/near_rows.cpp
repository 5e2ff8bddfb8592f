#include "codec/radiance/near_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace citystream::codec::radiance {

namespace {

constexpr double kUnitsInGreatest = 256;
constexpr size_t kMostCandidates = 256;
constexpr uint32_t kNone = ~0u;

using Entries = std::vector<uint32_t>;  // of a row: texel << 8 | quarters, texels rising

uint32_t units_of(const RowBound& bound, uint32_t entry) {
    return bound.weights[entry >> 8] * (entry & 0xff);
}

/// Rows that are taken for one.
struct Group {
    Entries entries;      ///< what all of them have
    uint32_t units = 0;   ///< of the entries
    uint32_t missed = 0;  ///< units that one of its rows has more, the most
    uint32_t rows = 0;
    uint64_t quarters = 0;  ///< that its rows have more, all together
};

class RowGroups {
  public:
    RowGroups(uint32_t local_count, const RowBound& bound) : bound_(bound), of_local_(local_count) {}

    std::vector<Group> groups;

    /// The group that takes a row in.
    uint32_t add(const Entries& row, uint32_t local) {
        uint32_t units = 0;
        for (const uint32_t entry : row) units += units_of(bound_, entry);
        std::vector<uint32_t>& near = of_local_[local];
        uint32_t best = kNone, least = kNone;
        for (size_t i = near.size(); i-- > near.size() - std::min(near.size(), kMostCandidates);) {
            const uint32_t cost = cost_of(row, units, groups[near[i]], least);
            if (cost >= least) continue;
            least = cost;
            best = near[i];
        }
        if (best == kNone) {
            best = static_cast<uint32_t>(groups.size());
            near.push_back(best);
            groups.push_back({row, units, 0, 0, 0});
        }
        join(row, units, groups[best]);
        return best;
    }

  private:
    /// Units that a row and a group lose to each other; kNone: more than they may, or `limit` or more.
    uint32_t cost_of(const Entries& row, uint32_t row_units, const Group& group, uint32_t limit) const {
        const uint32_t row_may = bound_.most, group_may = bound_.most - group.missed;
        // What they have in common is no more than either.
        if (row_units > group.units + row_may || group.units > row_units + group_may) return kNone;
        uint32_t row_loses = 0, group_loses = 0;
        for (size_t x = 0, y = 0; x < row.size() || y < group.entries.size();) {
            const uint32_t a = x < row.size() ? row[x] : kNone, b = y < group.entries.size() ? group.entries[y] : kNone;
            if (a >> 8 == b >> 8) {
                const uint32_t more = units_of(bound_, std::max(a, b)) - units_of(bound_, std::min(a, b));
                (a > b ? row_loses : group_loses) += more;
                ++x, ++y;
            } else if (a < b) {
                row_loses += units_of(bound_, a);
                ++x;
            } else {
                group_loses += units_of(bound_, b);
                ++y;
            }
            if (row_loses > row_may || group_loses > group_may || row_loses + group_loses >= limit) return kNone;
        }
        return row_loses + group_loses;
    }

    void join(const Entries& row, uint32_t row_units, Group& group) {
        Entries common;
        const auto quarters_of = [](const Entries& entries) {
            return std::accumulate(entries.begin(), entries.end(), uint64_t{0},
                                   [](uint64_t sum, uint32_t entry) { return sum + (entry & 0xff); });
        };
        for (size_t x = 0, y = 0; x < row.size() && y < group.entries.size();) {
            const uint32_t a = row[x], b = group.entries[y];
            if (a >> 8 == b >> 8) common.push_back(std::min(a, b));
            x += a >> 8 <= b >> 8 ? 1 : 0;
            y += b >> 8 <= a >> 8 ? 1 : 0;
        }
        uint32_t units = 0;
        for (const uint32_t entry : common) units += units_of(bound_, entry);
        group.quarters +=
            group.rows * (quarters_of(group.entries) - quarters_of(common)) + quarters_of(row) - quarters_of(common);
        group.missed = std::max(group.missed + group.units - units, row_units - units);
        group.units = units;
        group.entries = std::move(common);
        ++group.rows;
    }

    const RowBound& bound_;
    std::vector<std::vector<uint32_t>> of_local_;  ///< groups that began with a row of each local direction
};

/// Of each row.
std::vector<uint32_t> first_users(const DistinctRows& distinct, uint32_t local_count) {
    std::vector<uint32_t> locals(distinct.rows.rows(), 0);
    for (size_t i = distinct.row_of.size(); i-- > 0;)
        locals[distinct.row_of[i]] = static_cast<uint32_t>(i) % local_count;
    return locals;
}

}  // namespace

RowBound row_bound(uint32_t side, uint32_t local_count, double row_error) {
    RowBound bound;
    std::vector<double> solid_angles;
    for (uint32_t k = 0; k < texel_count(side); ++k) solid_angles.push_back(cell_solid_angle(side, k));
    const double unit = *std::max_element(solid_angles.begin(), solid_angles.end()) * kQuarter / kUnitsInGreatest;
    for (const double solid_angle : solid_angles)
        bound.weights.push_back(static_cast<uint32_t>(std::ceil(solid_angle * kQuarter / unit)));
    bound.unit = unit * local_count / (2 * std::numbers::pi);
    bound.most = row_error > 0 ? static_cast<uint32_t>(std::min(row_error, 1.0) / bound.unit) : 0;
    return bound;
}

NearRows merge_near_rows(const DistinctRows& distinct, uint32_t local_count, const RowBound& bound) {
    const std::vector<uint32_t> locals = first_users(distinct, local_count);
    const Transfer& rows = distinct.rows;
    RowGroups merged(local_count, bound);
    std::vector<uint32_t> group_of;
    Entries row;
    for (uint32_t j = 0; j < rows.rows(); ++j) {
        row.clear();
        for (uint32_t i = rows.row_begin[j]; i < rows.row_begin[j + 1]; ++i)
            row.push_back(uint32_t{rows.column[i]} << 8 | static_cast<uint32_t>(rows.quarters[i]));
        group_of.push_back(merged.add(row, locals[j]));
    }
    NearRows near;
    Transfer& fewer = near.distinct.rows;
    fewer = {rows.columns, {0}, {}, {}};
    for (const Group& group : merged.groups) {
        for (const uint32_t entry : group.entries) {
            fewer.column.push_back(static_cast<uint16_t>(entry >> 8));
            fewer.quarters.push_back(static_cast<int8_t>(entry & 0xff));
        }
        fewer.row_begin.push_back(static_cast<uint32_t>(fewer.column.size()));
        near.missed.push_back(group.missed);
        near.quarters += group.quarters;
    }
    for (const uint32_t j : distinct.row_of) near.distinct.row_of.push_back(group_of[j]);
    return near;
}

}  // namespace citystream::codec::radiance
