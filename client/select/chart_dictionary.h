// What a client knows of the city's chart dictionary: where each level of each chart lies, and how many of them can be
// had. And the rule that chooses how many are wanted. Unlike the levels of facade maps, each of which is a map of its
// own (facade_dictionary.h), the levels of a chart add up: a chart is a layer in steps, and what is shown is a prefix.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/atlas_layout.h"
#include "tiles/tileset/chart_index.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

/// One level of one chart: what is fetched as a unit. Numbers grow as payloads follow each other in the levels entry:
/// block of charts, level, chart in its block.
using ChartPiece = uint32_t;
static_assert(tiles::tileset::kChartsPerBlock == 64 && codec::atlas::kMostChartLevels == 8, "6 and 3 bits of a piece");
constexpr ChartPiece chart_piece(uint32_t chart, uint32_t level) {
    return chart >> 6 << 9 | level << 6 | (chart & 63);
}
constexpr uint32_t chart_of(ChartPiece piece) {
    return piece >> 9 << 6 | (piece & 63);
}
constexpr uint32_t chart_level_of(ChartPiece piece) {
    return piece >> 6 & 7;
}

/// The first levels of a chart.
struct ChartPrefix {
    uint32_t chart = 0;
    uint32_t levels = 0;
    friend bool operator==(const ChartPrefix&, const ChartPrefix&) = default;
};

/// Each chart once, with the longest of its prefixes; sorted by chart.
void merge_prefixes(std::vector<ChartPrefix>& prefixes);

/// Of a chart in merged prefixes: 0 where it is not among them.
uint32_t levels_in(std::span<const ChartPrefix> merged, uint32_t chart);

class ChartDictionary {
  public:
    using SharedCharts = std::shared_ptr<const std::vector<tiles::tileset::ChartRecord>>;
    /// Takes the chart index, which others may share; all levels count as usable.
    void learn(SharedCharts charts);
    void learn(std::vector<tiles::tileset::ChartRecord> charts);
    bool known() const { return size() > 0; }
    size_t size() const { return charts_->size(); }
    const tiles::tileset::ChartRecord& record(uint32_t chart) const { return (*charts_)[chart]; }
    bool has_alpha(uint32_t chart) const { return (record(chart).flags & ATLAS_CHART_ALPHA) != 0; }
    /// r | g << 8 | b << 16: shown where the chart cannot be had.
    uint32_t colour(uint32_t chart) const;

    /// In the levels entry.
    uint64_t begin(ChartPiece piece) const { return record(chart_of(piece)).level[chart_level_of(piece)].begin; }
    uint64_t end(ChartPiece piece) const { return record(chart_of(piece)).level[chart_level_of(piece)].end(); }
    uint64_t wire_bytes(ChartPiece piece) const { return end(piece) - begin(piece); }
    /// The piece whose payload follows; after the last one a piece of no chart.
    ChartPiece next(ChartPiece piece) const;

    uint32_t step_words(uint32_t chart, uint32_t level) const;
    uint64_t wire_bytes(const ChartPrefix& prefix) const;
    uint64_t decoded_bytes(const ChartPrefix& prefix) const;
    /// The finest mip that a prefix holds. Precondition: levels > 0.
    uint32_t finest_mip(const ChartPrefix& prefix) const;

    /// Levels that can be had: those before the first one that is missing or damaged.
    uint32_t usable_levels(uint32_t chart) const;
    bool usable(ChartPiece piece) const { return chart_level_of(piece) < usable_levels(chart_of(piece)); }
    /// A level that could not be fetched, and can be again.
    void set_missing(ChartPiece piece, bool missing);
    /// A level whose payload came damaged. True: for the second time, it is given up for good.
    bool note_damage(ChartPiece piece);

    /// The shortest prefix whose texels project to at most `tolerance` pixels where the chart is shown as `use` says,
    /// else all levels that can be had: the rule that steps of tiles follow. No levels: the chart cannot be had at all.
    ChartPrefix wanted(const codec::atlas::SharedChartUse& use, double pixels_per_metre, double tolerance) const;
    /// Metres: a texel of what a prefix holds, where the chart is shown as `use` says. Precondition: levels > 0.
    double texel_error(const codec::atlas::SharedChartUse& use, uint32_t levels) const;

    uint64_t host_bytes() const;
    /// Grows whenever a choice made before may be another one now.
    uint64_t changes() const { return changes_; }

  private:
    bool exists(ChartPiece piece) const;

    SharedCharts charts_ = std::make_shared<const std::vector<tiles::tileset::ChartRecord>>();
    struct Trouble {
        uint8_t missing = 0, damaged_once = 0, damaged_twice = 0;  ///< a bit a level
    };
    std::vector<Trouble> trouble_;  ///< by chart
    uint64_t changes_ = 0;
};

}  // namespace citystream::client
