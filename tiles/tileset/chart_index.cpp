#include "tiles/tileset/chart_index.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/mip_plan.h"
#include "codec/bits/zstd_frame.h"
#include "tiles/tileset/index_columns.h"

namespace citystream::tiles::tileset {
namespace {

using codec::atlas::kGreatestChartSide;

constexpr int kLevel = 19;
constexpr size_t kChartBytes = 8, kLevelBytes = 4;  // FORMAT.md has the columns
// Sizes of levels hardly repeat, so an honest index is at most some times larger than its frame.
constexpr uint64_t kMaxRatio = 256;
constexpr uint64_t kFreeBytes = uint64_t{1} << 20;
constexpr uint32_t kFlags = codec::atlas::kSharedChartFlags;

Error defect(std::string_view what) {
    return {fmt::format("{}: {}", kChartIndexPath, what)};
}

bool size_fits(const ChartRecord& chart) {
    return chart.width >= 1 && chart.width <= kGreatestChartSide && chart.height >= 1 &&
           chart.height <= kGreatestChartSide;
}

/// Calls visit(chart, level) for every level in the order of charts/levels.
template <typename Chart, typename Visit>
void visit_levels(std::span<Chart> charts, Visit visit) {
    for (size_t begin = 0; begin < charts.size(); begin += kChartsPerBlock) {
        const auto block = charts.subspan(begin, std::min<size_t>(kChartsPerBlock, charts.size() - begin));
        for (uint32_t level = 0; level < codec::atlas::kMostChartLevels; ++level) {
            for (Chart& chart : block) {
                if (level < chart.level_count) visit(chart, level);
            }
        }
    }
}

/// All levels of all charts, in the order of the columns.
template <typename Chart>
auto levels_of(std::span<Chart> charts) {
    std::vector<decltype(&charts[0].level[0])> levels;
    for (Chart& chart : charts) {
        for (uint32_t i = 0; i < chart.level_count; ++i) levels.push_back(&chart.level[i]);
    }
    return levels;
}

std::vector<std::byte> write_columns(std::span<const ChartRecord> charts) {
    ColumnWriter columns;
    const size_t count = charts.size();
    columns.add(count, 2, [&](size_t i) { return charts[i].width; });
    columns.add(count, 2, [&](size_t i) { return charts[i].height; });
    columns.add(count, 1, [&](size_t i) { return charts[i].flags; });
    for (size_t c = 0; c < 3; ++c) columns.add(count, 1, [&](size_t i) { return charts[i].colour[c]; });
    const auto levels = levels_of(charts);
    columns.add(levels.size(), kLevelBytes, [&](size_t i) { return levels[i]->bytes; });
    return columns.take();
}

/// Fails where sizes are out of range or their levels do not add up to those that the bytes hold.
Result<std::vector<ChartRecord>> read_columns(std::span<const std::byte> raw, size_t count) {
    std::vector<ChartRecord> charts(count);
    ColumnReader columns(raw);
    columns.read(count, 2, [&](size_t i, uint32_t value) { charts[i].width = static_cast<uint16_t>(value); });
    columns.read(count, 2, [&](size_t i, uint32_t value) { charts[i].height = static_cast<uint16_t>(value); });
    columns.read(count, 1, [&](size_t i, uint32_t value) { charts[i].flags = static_cast<uint8_t>(value); });
    for (size_t c = 0; c < 3; ++c)
        columns.read(count, 1, [&](size_t i, uint32_t value) { charts[i].colour[c] = static_cast<uint8_t>(value); });
    uint64_t sum = 0;
    for (size_t i = 0; i < count; ++i) {
        if (!size_fits(charts[i]))
            return defect(fmt::format("chart {} has {} x {} texels", i, charts[i].width, charts[i].height));
        const uint32_t levels = codec::atlas::atlas_step_count(charts[i].width, charts[i].height, charts[i].flags);
        if (levels > codec::atlas::kMostChartLevels)
            return defect(fmt::format("chart {} has {} x {} texels with alpha", i, charts[i].width, charts[i].height));
        charts[i].level_count = levels;
        sum += charts[i].level_count;
    }
    if (sum != (raw.size() - count * kChartBytes) / kLevelBytes)
        return defect("the levels of its charts do not add up to those that follow");
    const auto levels = levels_of(std::span(charts));
    columns.read(levels.size(), kLevelBytes, [&](size_t i, uint32_t value) { levels[i]->bytes = value; });
    return charts;
}

Status check_chart(const ChartRecord& chart, size_t at) {
    const auto wrong = [at](const char* what) { return defect(fmt::format("chart {} {}", at, what)); };
    if (!size_fits(chart)) return wrong("has a size out of range");
    if ((chart.flags & ~kFlags) != 0) return wrong("has unknown flags");
    if (chart.level_count != codec::atlas::atlas_step_count(chart.width, chart.height, chart.flags))
        return wrong("has another number of levels than its size asks for");
    for (const ChartLevelRecord& level : chart.levels()) {
        if (level.bytes <= codec::atlas::kChartChecksumBytes) return wrong("has a level without contents");
    }
    return Done{};
}

}  // namespace

uint64_t place_chart_levels(std::span<ChartRecord> charts) {
    uint64_t end = 0;
    visit_levels(charts, [&end](ChartRecord& chart, uint32_t level) {
        chart.level[level].begin = end;
        end = chart.level[level].end();
    });
    return end;
}

Status check_charts(std::span<const ChartRecord> charts) {
    if (charts.size() > kMaxSharedCharts) return defect(fmt::format("{} charts are too many", charts.size()));
    uint64_t bytes = 0;
    for (size_t i = 0; i < charts.size(); ++i) {
        if (Status status = check_chart(charts[i], i); !status) return status;
        for (const ChartLevelRecord& level : charts[i].levels()) bytes += level.bytes;
    }
    if (bytes >= UINT32_MAX) return defect("its levels pass 4 GiB");
    return Done{};
}

std::vector<std::byte> write_chart_index(std::span<ChartRecord> charts, Manifest& manifest) {
    const std::vector<std::byte> raw = write_columns(charts);
    std::vector<std::byte> frame = codec::bits::compress_frame(raw, kLevel);
    manifest.shared_chart_count = charts.size();
    manifest.chart_index_bytes = frame.size();
    manifest.chart_index_decoded_bytes = raw.size();
    manifest.chart_index_checksum = checksum_of(frame.data(), frame.size());
    manifest.chart_levels_bytes = place_chart_levels(charts);
    return frame;
}

Result<std::vector<ChartRecord>> parse_chart_index(std::span<const std::byte> frame, const Manifest& manifest) {
    if (frame.size() != manifest.chart_index_bytes) {
        return defect(fmt::format("has {} bytes, tileset.json says {}", frame.size(), manifest.chart_index_bytes));
    }
    const uint64_t count = manifest.shared_chart_count, decoded = manifest.chart_index_decoded_bytes;
    if (count > kMaxSharedCharts || decoded < count * kChartBytes ||
        (decoded - count * kChartBytes) % kLevelBytes != 0 || decoded > kFreeBytes + kMaxRatio * frame.size()) {
        return defect(fmt::format("cannot list {} charts in {} bytes", count, decoded));
    }
    if (checksum_of(frame.data(), frame.size()) != manifest.chart_index_checksum)
        return defect("its checksum is wrong");
    const auto raw = codec::bits::decompress_frame(frame, decoded);
    if (!raw) return defect(raw.error().text());
    auto charts = read_columns(*raw, count);
    if (!charts) return charts.error();
    if (Status status = check_charts(*charts); !status) return status.error();
    if (place_chart_levels(*charts) != manifest.chart_levels_bytes)
        return defect("its levels do not add up to what tileset.json says");
    return charts;
}

}  // namespace citystream::tiles::tileset
