#include "tiles/layers/inspect_charts.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <span>

#include "codec/atlas/shared_chart.h"
#include "tiles/tileset/chart_index.h"

namespace citystream::tiles::layers {
namespace {

using tileset::ChartRecord;

/// The first damage of a chart.
std::optional<std::string> damage_of(const ChartRecord& chart, std::span<const std::byte> entry) {
    std::vector<uint32_t> words;
    for (uint32_t i = 0; i < chart.level_count; ++i) {
        const tileset::ChartLevelRecord& level = chart.level[i];
        if (level.end() > entry.size()) return fmt::format("level {} lies outside the entry", i);
        const auto own = codec::atlas::decode_chart_level(entry.subspan(level.begin, level.bytes), chart.width,
                                                          chart.height, chart.flags, i);
        if (!own) return fmt::format("level {}: {}", i, own.error().text());
        words.insert(words.end(), own->begin(), own->end());
    }
    const auto view = codec::atlas::shared_chart_view(words, chart.width, chart.height, chart.flags, chart.level_count);
    return view ? std::nullopt : std::optional<std::string>(view.error().text());
}

}  // namespace

void check_chart_dictionary(const archive::ArchiveReader& reader, const tileset::Manifest& manifest,
                            const std::function<void(const std::string&, const std::string&)>& say) {
    if (manifest.shared_chart_count == 0) return;
    const auto charts = tileset::parse_chart_index(reader.find(tileset::kChartIndexPath), manifest);
    if (!charts) return say(tileset::kChartIndexPath, charts.error().text());
    const auto entry = reader.find(tileset::kChartLevelsPath);
    if (entry.size() != manifest.chart_levels_bytes) {
        say(tileset::kChartLevelsPath,
            fmt::format("has {} bytes, tileset.json says {}", entry.size(), manifest.chart_levels_bytes));
    }
    for (size_t i = 0; i < charts->size(); ++i) {
        if (const auto damage = damage_of((*charts)[i], entry))
            say(tileset::kChartLevelsPath, fmt::format("chart {}: {}", i, *damage));
    }
}

Result<nlohmann::json> chart_dictionary_json(const archive::ArchiveReader& reader, const tileset::Manifest& manifest) {
    const auto charts = tileset::parse_chart_index(reader.find(tileset::kChartIndexPath), manifest);
    if (!charts) return charts.error();
    struct Sum {
        uint64_t charts = 0, wire = 0, resident = 0;
    };
    std::array<Sum, codec::atlas::kMostChartLevels> sums;
    Sum all;
    uint64_t texels = 0;
    for (const ChartRecord& chart : *charts) {
        texels += uint64_t{chart.width} * chart.height;
        for (uint32_t i = 0; i < chart.level_count; ++i) {
            const uint64_t resident =
                sizeof(uint32_t) * uint64_t{codec::atlas::atlas_step_words(chart.width, chart.height, chart.flags, i)};
            for (Sum* sum : {&sums[i], &all}) {
                ++sum->charts;
                sum->wire += chart.level[i].bytes;
                sum->resident += resident;
            }
        }
    }
    nlohmann::json levels = nlohmann::json::array();
    for (const Sum& sum : sums) {
        if (sum.charts > 0)
            levels.push_back({{"charts", sum.charts}, {"wire_bytes", sum.wire}, {"resident_bytes", sum.resident}});
    }
    return nlohmann::json{{"charts", charts->size()}, {"index_bytes", manifest.chart_index_bytes},
                          {"wire_bytes", all.wire},   {"resident_bytes", all.resident},
                          {"texels", texels},         {"levels", std::move(levels)}};
}

}  // namespace citystream::tiles::layers
