#include "codec/radiance/distinct_row_set.h"

#include <algorithm>
#include <string_view>

namespace citystream::codec::radiance {

namespace {

template <typename T>
uint64_t hash_of(std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

bool DistinctRowSet::is_row(uint32_t row, std::span<const uint16_t> columns, std::span<const int8_t> quarters) const {
    const Transfer& rows = distinct_.rows;
    const uint32_t begin = rows.row_begin[row];
    return rows.row_begin[row + 1] - begin == columns.size() &&
           std::equal(columns.begin(), columns.end(), rows.column.begin() + begin) &&
           std::equal(quarters.begin(), quarters.end(), rows.quarters.begin() + begin);
}

void DistinctRowSet::add(std::span<const uint16_t> columns, std::span<const int8_t> quarters) {
    constexpr uint64_t kFactor = 0x9e3779b97f4a7c15u;
    const uint64_t hash = hash_of(columns) * kFactor ^ hash_of(quarters);
    const auto [first, last] = places_.equal_range(hash);
    const auto known =
        std::find_if(first, last, [&](const auto& place) { return is_row(place.second, columns, quarters); });
    Transfer& rows = distinct_.rows;
    distinct_.row_of.push_back(known != last ? known->second : rows.rows());
    if (known != last) return;
    places_.emplace(hash, rows.rows());
    rows.column.insert(rows.column.end(), columns.begin(), columns.end());
    rows.quarters.insert(rows.quarters.end(), quarters.begin(), quarters.end());
    rows.row_begin.push_back(static_cast<uint32_t>(rows.column.size()));
}

}  // namespace citystream::codec::radiance
