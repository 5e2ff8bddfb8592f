// The entry charts/index: one zstd frame listing the charts of the city's chart dictionary and the sizes of their
// levels, whose places in charts/levels follow from their order.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::tileset {

inline constexpr uint32_t kMaxSharedCharts = uint32_t{1} << 24;
/// Charts whose levels lie side by side in charts/levels, coarsest level of all of them first.
inline constexpr uint32_t kChartsPerBlock = 64;

/// Sets begin of every level from the sizes, in the order of charts/levels; the end of the last one.
uint64_t place_chart_levels(std::span<ChartRecord> charts);

/// What a reader refuses in the records, or that all is well: sizes out of range, unknown flags, level counts other
/// than those of the size, levels no longer than a checksum, levels that together pass 4 GiB - 1.
Status check_charts(std::span<const ChartRecord> charts);

/// The frame; sets manifest.shared_chart_count, chart_index_* and chart_levels_bytes, and places the levels. Records
/// that check_charts refuses give a frame that no reader takes.
std::vector<std::byte> write_chart_index(std::span<ChartRecord> charts, Manifest& manifest);

/// For untrusted bytes: checks size, checksum, every record, and that the levels add up to manifest.chart_levels_bytes;
/// allocates about 150 bytes for each chart that the decompressed bytes hold.
Result<std::vector<ChartRecord>> parse_chart_index(std::span<const std::byte> frame, const Manifest& manifest);

}  // namespace citystream::tiles::tileset
