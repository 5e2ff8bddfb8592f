#include "client/select/chart_dictionary.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "codec/atlas/shared_chart.h"

namespace citystream::client {

using codec::atlas::SharedChartUse;
using tiles::tileset::ChartRecord;

namespace {

uint8_t bit_of(ChartPiece piece) {
    return static_cast<uint8_t>(1u << chart_level_of(piece));
}

}  // namespace

void merge_prefixes(std::vector<ChartPrefix>& prefixes) {
    std::sort(prefixes.begin(), prefixes.end(), [](const ChartPrefix& a, const ChartPrefix& b) {
        return a.chart != b.chart ? a.chart < b.chart : a.levels > b.levels;
    });
    const auto same = [](const ChartPrefix& a, const ChartPrefix& b) { return a.chart == b.chart; };
    prefixes.erase(std::unique(prefixes.begin(), prefixes.end(), same), prefixes.end());
}

uint32_t levels_in(std::span<const ChartPrefix> merged, uint32_t chart) {
    const auto at = std::lower_bound(merged.begin(), merged.end(), chart,
                                     [](const ChartPrefix& prefix, uint32_t wanted) { return prefix.chart < wanted; });
    return at != merged.end() && at->chart == chart ? at->levels : 0;
}

void ChartDictionary::learn(std::vector<ChartRecord> charts) {
    learn(std::make_shared<const std::vector<ChartRecord>>(std::move(charts)));
}

void ChartDictionary::learn(SharedCharts charts) {
    charts_ = std::move(charts);
    trouble_.assign(size(), {});
    ++changes_;
}

uint32_t ChartDictionary::colour(uint32_t chart) const {
    const auto& rgb = record(chart).colour;
    return rgb[0] | uint32_t{rgb[1]} << 8 | uint32_t{rgb[2]} << 16;
}

bool ChartDictionary::exists(ChartPiece piece) const {
    return chart_of(piece) < size() && chart_level_of(piece) < record(chart_of(piece)).level_count;
}

ChartPiece ChartDictionary::next(ChartPiece piece) const {
    const auto end = chart_piece(static_cast<uint32_t>((size() + 63) / 64 * 64), 0);
    do ++piece;
    while (piece < end && !exists(piece));
    return piece;
}

uint32_t ChartDictionary::step_words(uint32_t chart, uint32_t level) const {
    return codec::atlas::atlas_step_words(record(chart).width, record(chart).height, record(chart).flags, level);
}

uint64_t ChartDictionary::wire_bytes(const ChartPrefix& prefix) const {
    uint64_t bytes = 0;
    for (uint32_t level = 0; level < prefix.levels; ++level) bytes += record(prefix.chart).level[level].bytes;
    return bytes;
}

uint64_t ChartDictionary::decoded_bytes(const ChartPrefix& prefix) const {
    uint64_t bytes = 0;
    for (uint32_t level = 0; level < prefix.levels; ++level) bytes += uint64_t{4} * step_words(prefix.chart, level);
    return bytes;
}

uint32_t ChartDictionary::finest_mip(const ChartPrefix& prefix) const {
    return record(prefix.chart).level_count -
           prefix.levels;  // each level after the first is one mip, the last is mip 0
}

uint32_t ChartDictionary::usable_levels(uint32_t chart) const {
    const Trouble& trouble = trouble_[chart];
    const auto good = static_cast<uint32_t>(std::countr_zero(uint32_t{trouble.missing} | trouble.damaged_twice));
    return std::min(good, record(chart).level_count);
}

void ChartDictionary::set_missing(ChartPiece piece, bool missing) {
    uint8_t& bits = trouble_[chart_of(piece)].missing;
    bits = static_cast<uint8_t>(missing ? bits | bit_of(piece) : bits & ~bit_of(piece));
    ++changes_;
}

bool ChartDictionary::note_damage(ChartPiece piece) {
    Trouble& trouble = trouble_[chart_of(piece)];
    if ((trouble.damaged_once & bit_of(piece)) == 0) {
        trouble.damaged_once = static_cast<uint8_t>(trouble.damaged_once | bit_of(piece));
        return false;
    }
    trouble.damaged_twice = static_cast<uint8_t>(trouble.damaged_twice | bit_of(piece));
    ++changes_;
    return true;
}

double ChartDictionary::texel_error(const SharedChartUse& use, uint32_t levels) const {
    return std::ldexp(double{use.metres_per_texel}, static_cast<int>(finest_mip({use.number, levels})));
}

ChartPrefix ChartDictionary::wanted(const SharedChartUse& use, double pixels_per_metre, double tolerance) const {
    const uint32_t usable = usable_levels(use.number);
    for (uint32_t levels = 1; levels < usable; ++levels) {
        if (texel_error(use, levels) * pixels_per_metre <= tolerance) return {use.number, levels};
    }
    return {use.number, usable};
}

uint64_t ChartDictionary::host_bytes() const {
    return size() * (sizeof(ChartRecord) + sizeof(Trouble));
}

}  // namespace citystream::client
