#include "client/stream/chart_residency.h"

#include <algorithm>

#include "client/stream/dictionary_pieces.h"
#include "codec/atlas/shared_chart.h"

namespace citystream::client {

using codec::atlas::SharedChartUse;
using tiles::tileset::ChartRecord;

namespace {

/// Single levels that warnings name; a city whose charts are all bad shall not flood the terminal.
constexpr uint32_t kMostNamed = 20;
/// Of charts of which nothing is known, for their index cannot be had: that of tiles without an atlas.
constexpr uint32_t kUnknownColour = 0xb3b3b3;

}  // namespace

void ChartResidency::damaged(ChartPiece piece, const std::string& why) {
    cache_.drop_wire_step(cache_.at(chart_key(chart_of(piece))), chart_level_of(piece));
    if (!knowledge_.charts.note_damage(piece)) return;
    if (++given_up_ > kMostNamed) {
        warnings_.add("charts/levels: more levels are damaged");
        return;
    }
    warnings_.add("charts/levels: chart " + std::to_string(chart_of(piece)) + ", level " +
                  std::to_string(chart_level_of(piece)) + " is damaged (" + why + ", also on the second try); " +
                  (chart_level_of(piece) > 0 ? "it is drawn coarser" : "it is drawn in one colour"));
}

void ChartResidency::accept(ChartPiece from, ChartPiece to, std::span<const std::byte> bytes) {
    const ChartDictionary& dictionary = knowledge_.charts;
    uint64_t at = 0;
    for (ChartPiece piece = from; piece != to; piece = dictionary.next(piece)) {
        CachedLayer& entry = cache_.at(chart_key(chart_of(piece)));
        const auto part = bytes.subspan(at, dictionary.wire_bytes(piece));
        at += part.size();
        if ((entry.wire_held >> chart_level_of(piece) & 1) != 0) continue;
        if (!codec::atlas::chart_level_is_whole(part)) {
            damaged(piece, "checksum differs");
        } else {
            cache_.put_wire(entry, chart_level_of(piece), {part.begin(), part.end()}, decode_);
        }
    }
}

void ChartResidency::upload(std::span<const ChartPrefix> wanted) {
    const Stopwatch watch(counters_.decode_ms);
    for (const ChartPrefix& prefix : wanted) {
        CachedLayer* entry = cache_.find(chart_key(prefix.chart));
        if (entry == nullptr) continue;
        const uint32_t levels = std::min(prefix.levels, entry->wire_steps);
        if (levels > entry->store_steps) upload_prefix({prefix.chart, levels}, *entry);
    }
}

void ChartResidency::upload_prefix(const ChartPrefix& prefix, CachedLayer& entry) {
    const uint64_t before = entry.store_bytes;
    const uint64_t bytes = knowledge_.charts.decoded_bytes(prefix);
    if (!cache_.free_slots(cache_.slots_for(bytes) - cache_.slots_for(before))) return;
    const bool done =
        decode_ ? decode_to_store(prefix, entry) : cache_.append_zeros(entry, bytes - before, prefix.levels).ok();
    if (done) counters_.decoded_bytes += bytes - before;
}

bool ChartResidency::decode_to_store(const ChartPrefix& prefix, CachedLayer& entry) {
    const ChartDictionary& dictionary = knowledge_.charts;
    const ChartRecord& chart = dictionary.record(prefix.chart);
    const uint64_t decoded = dictionary.decoded_bytes(prefix);
    cache_.free_host(2 * decoded);
    const Scratch scratch(host_, 2 * decoded);
    std::vector<uint32_t> words;
    words.reserve(decoded / 4);
    for (uint32_t level = 0; level < prefix.levels; ++level) {
        const auto step =
            codec::atlas::decode_chart_level(entry.wire[level], chart.width, chart.height, chart.flags, level);
        if (!step) {
            damaged(chart_piece(prefix.chart, level), step.error().text());
            return false;
        }
        words.insert(words.end(), step->begin(), step->end());
    }
    const auto view = codec::atlas::shared_chart_view(words, chart.width, chart.height, chart.flags, prefix.levels);
    if (!view) {
        damaged(chart_piece(prefix.chart, first_bad_level(prefix, words)), view.error().text());
        return false;
    }
    const Status appended = cache_.append(entry, std::span(words).subspan(entry.store_bytes / 4), prefix.levels);
    if (!appended) warnings_.add("charts/levels: " + appended.error().text());
    return appended.ok();
}

/// The level after the longest prefix that is good.
uint32_t ChartResidency::first_bad_level(const ChartPrefix& prefix, std::span<const uint32_t> words) const {
    const ChartRecord& chart = knowledge_.charts.record(prefix.chart);
    uint32_t good = 0;
    for (uint32_t levels = 1; levels < prefix.levels; ++levels) {
        const auto part = words.first(knowledge_.charts.decoded_bytes({prefix.chart, levels}) / 4);
        if (!codec::atlas::shared_chart_view(part, chart.width, chart.height, chart.flags, levels)) break;
        good = levels;
    }
    return good;
}

bool ChartResidency::can_show(const SharedChartUse& use) {
    if (!knowledge_.charts.known()) return knowledge_.charts_broken;
    if (knowledge_.charts.usable_levels(use.number) == 0) return true;
    const CachedLayer* entry = cache_.find(chart_key(use.number));
    return entry != nullptr && entry->store_steps > 0;
}

SharedChartBinding ChartResidency::to_draw(const SharedChartUse& use, uint32_t levels) {
    SharedChartBinding binding;
    binding.chart_in_tile = use.chart_in_tile;
    binding.chart = use.number;
    binding.colour = kUnknownColour;
    if (!knowledge_.charts.known()) return binding;
    binding.colour = knowledge_.charts.colour(use.number);
    CachedLayer* entry = cache_.find(chart_key(use.number));
    if (entry == nullptr || entry->store_steps == 0 || levels == 0) return binding;
    cache_.mark_drawn(*entry);
    binding.layer = entry->id;
    binding.levels = std::min(levels, entry->store_steps);
    binding.finest_mip = knowledge_.charts.finest_mip({use.number, binding.levels});
    return binding;
}

}  // namespace citystream::client
