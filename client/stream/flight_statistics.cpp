#include "client/stream/flight_statistics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

namespace citystream::client {
namespace {

using Json = nlohmann::ordered_json;
using Measure = std::function<double(const FlightFrame&)>;

double milliseconds(double value) {
    return std::round(value * 1000) / 1000;
}

/// By name of the layer.
template <typename BytesOf>
Json layers_json(const BytesOf& bytes_of) {
    Json out;
    for (size_t layer = 0; layer < tiles::tileset::kLayerCount; ++layer) {
        out[std::string(tiles::tileset::kLayerNames[layer])] = bytes_of(layer);
    }
    return out;
}

/// All 0 and empty where no light was asked for.
Json frame_light_json(const FlightFrame& frame) {
    const StreamerFrame& s = frame.stream;
    const FlightLighting& l = frame.lighting;
    return {{"environment", l.environment},
            {"share", milliseconds(l.share)},
            {"rotation_degrees", l.rotation_degrees},
            {"hour", l.hour},
            {"exposure", l.exposure},
            {"number", l.number},
            {"tolerance_used", s.light_tolerance_used},
            {"tiles", s.light_tiles},
            {"inherited_tiles", s.light_inherited_tiles},
            {"layers", s.light_layers},
            {"casters", s.caster_tiles},
            {"decodes", s.light_decodes},
            {"decode_ms", milliseconds(s.light_decode_ms)},
            {"bytes", s.light_bytes},
            {"row_error", s.light_row_error},
            {"quarters_dropped", s.light_quarters_dropped},
            {"pass_tiles", frame.counts.radiance_tiles},
            {"pass_receivers", frame.counts.radiance_receivers},
            {"local_bytes", frame.counts.local_light_bytes},
            {"masks", frame.counts.relief_masks},
            {"mask_bytes", frame.counts.relief_mask_bytes},
            {"btfs", frame.counts.btfs},
            {"btf_bytes", frame.counts.btf_bytes},
            {"facades_cast", frame.counts.facades_cast},
            {"facades_by_btf", frame.counts.facades_by_btf},
            {"facades_by_mean", frame.counts.facades_by_mean}};
}

Json frame_json(const FlightFrame& frame) {
    const StreamerFrame& s = frame.stream;
    const FrameTimings& g = frame.timings;
    return {{"frame", frame.index},
            {"t", frame.t},
            {"ms",
             {{"total", milliseconds(frame.total_ms)},
              {"select", milliseconds(s.select_ms)},
              {"wait", milliseconds(s.wait_ms)},
              {"decode", milliseconds(s.decode_ms)},
              {"record", milliseconds(g.cpu_record_ms)},
              {"gpu_mesh", milliseconds(g.gpu_mesh_ms)},
              {"gpu_facade", milliseconds(g.gpu_facade_ms)},
              {"gpu_total", milliseconds(g.gpu_total_ms)},
              {"readback", milliseconds(g.readback_ms)}}},
            {"tiles",
             {{"drawn", s.tiles_drawn},
              {"wanted", s.tiles_wanted},
              {"missing", s.tiles_missing},
              {"hidden", s.tiles_hidden}}},
            {"requests", s.requests},
            {"bytes",
             {{"wire", s.wire_bytes},
              {"layers", layers_json([&](size_t layer) { return s.layer_bytes[layer]; })},
              {"decoded", s.decoded_bytes},
              {"gpu", s.gpu_bytes_used},
              {"host", s.host_bytes_used},
              {"host_held", s.host_bytes_held},
              {"host_reserved", s.host_bytes_reserved}}},
            {"facades",
             {{"relief_tiles", s.relief_tiles},
              {"flat_tiles", s.flat_tiles},
              {"maps", s.facade_maps},
              {"index_bytes", s.facade_index_bytes},
              {"map_bytes", s.facade_map_bytes},
              {"conversions", s.map_conversions},
              {"refused", s.map_conversions_refused},
              {"conversion_ms", milliseconds(s.map_conversion_ms)}}},
            {"charts",
             {{"shared", s.shared_charts}, {"index_bytes", s.chart_index_bytes}, {"level_bytes", s.chart_level_bytes}}},
            {"pages",
             {{"tiles", frame.counts.page_tiles},
              {"fallback_tiles", frame.counts.fallback_tiles},
              {"coordinate_bytes", frame.counts.coordinate_bytes},
              {"mesh_draws", frame.counts.mesh_draws}}},
            {"light", frame_light_json(frame)},
            {"cache", {{"hits", s.cache_hits}, {"misses", s.cache_misses}}},
            {"tolerance_used", s.tolerance_used},
            {"achieved_error_pixels", s.achieved_error_pixels},
            {"geometry_error_pixels", s.geometry_error_pixels},
            {"positions",
             {{"error_pixels", s.position_error_pixels},
              {"bits", milliseconds(s.position_bits)},
              {"full_bits", milliseconds(s.full_position_bits)}}},
            {"warnings", s.warnings.size()}};
}

Json spread(const std::vector<FlightFrame>& frames, const Measure& measure) {
    std::vector<double> values;
    values.reserve(frames.size());
    for (const FlightFrame& frame : frames) values.push_back(measure(frame));
    return {{"median", milliseconds(percentile(values, 50))},
            {"p90", milliseconds(percentile(values, 90))},
            {"p99", milliseconds(percentile(values, 99))},
            {"max", milliseconds(percentile(values, 100))}};
}

uint64_t sum(const std::vector<FlightFrame>& frames, const std::function<uint64_t(const FlightFrame&)>& count) {
    uint64_t total = 0;
    for (const FlightFrame& frame : frames) total += count(frame);
    return total;
}

/// Of a measure in its own type; 0 without frames.
template <typename Read>
auto most(const std::vector<FlightFrame>& frames, const Read& read) {
    decltype(read(frames.front())) value = 0;
    for (const FlightFrame& frame : frames) value = std::max(value, read(frame));
    return value;
}

Json description_json(const FlightDescription& d) {
    return {{"place", d.place},
            {"path", d.path},
            {"mode", d.mode},
            {"device", d.device},
            {"network", d.network},
            {"size", {d.width, d.height}},
            {"fps", d.frames_per_second},
            {"tolerance_pixels", d.tolerance_pixels},
            {"relief_tolerance_pixels", d.relief_tolerance_pixels},
            {"texel_tolerance_pixels", d.texel_tolerance_pixels},
            {"position_tolerance_pixels", d.position_tolerance_pixels},
            {"map_level", d.map_level},
            {"facade_renderer", d.facade_renderer},
            {"facade_samples", d.facade_samples},
            {"chart_transport", d.chart_transport},
            {"facade_tint", d.facade_tint},
            {"environment", d.environment},
            {"environment_path", d.environment_path},
            {"light_tolerance", d.light_tolerance},
            {"matrix", d.matrix},
            {"matrix_error", d.matrix_error},
            {"meso", d.meso},
            {"occlusion", d.occlusion},
            {"gpu_budget_bytes", d.gpu_budget_bytes},
            {"host_budget_bytes", d.host_budget_bytes}};
}

Json times_json(const std::vector<FlightFrame>& frames) {
    return {{"total", spread(frames, [](const FlightFrame& f) { return f.total_ms; })},
            {"select", spread(frames, [](const FlightFrame& f) { return f.stream.select_ms; })},
            {"wait", spread(frames, [](const FlightFrame& f) { return f.stream.wait_ms; })},
            {"decode", spread(frames, [](const FlightFrame& f) { return f.stream.decode_ms; })},
            {"record", spread(frames, [](const FlightFrame& f) { return f.timings.cpu_record_ms; })},
            {"gpu_mesh", spread(frames, [](const FlightFrame& f) { return f.timings.gpu_mesh_ms; })},
            {"gpu_facade", spread(frames, [](const FlightFrame& f) { return f.timings.gpu_facade_ms; })},
            {"gpu_total", spread(frames, [](const FlightFrame& f) { return f.timings.gpu_total_ms; })},
            {"readback", spread(frames, [](const FlightFrame& f) { return f.timings.readback_ms; })}};
}

/// Relief and the dictionary: all 0 and false where no relief was drawn.
Json facades_json(const std::vector<FlightFrame>& frames, const FlightTotals& totals) {
    std::array<uint64_t, codec::facade::kMostFacadeLevels> most{};
    for (const FlightFrame& frame : frames) {
        for (size_t level = 0; level < most.size(); ++level) {
            most[level] = std::max(most[level], frame.stream.facade_maps[level]);
        }
    }
    const uint64_t index = sum(frames, [](const FlightFrame& f) { return f.stream.facade_index_bytes; });
    const uint64_t maps = sum(frames, [](const FlightFrame& f) { return f.stream.facade_map_bytes; });
    double conversion_ms = 0;
    for (const FlightFrame& frame : frames) conversion_ms += frame.stream.map_conversion_ms;
    return {{"pipeline", totals.facade_pipeline},
            {"relief_tiles", sum(frames, [](const FlightFrame& f) { return f.stream.relief_tiles; })},
            {"flat_tiles", sum(frames, [](const FlightFrame& f) { return f.stream.flat_tiles; })},
            {"maps_most", most},
            {"dictionary_bytes", index + maps},
            {"index_bytes", index},
            {"map_bytes", maps},
            {"conversions", sum(frames, [](const FlightFrame& f) { return f.stream.map_conversions; })},
            {"refused", sum(frames, [](const FlightFrame& f) { return f.stream.map_conversions_refused; })},
            {"conversion_ms", milliseconds(conversion_ms)}};
}

/// The chart dictionary: all 0 where the city has none.
Json charts_json(const std::vector<FlightFrame>& frames) {
    const uint64_t index = sum(frames, [](const FlightFrame& f) { return f.stream.chart_index_bytes; });
    const uint64_t levels = sum(frames, [](const FlightFrame& f) { return f.stream.chart_level_bytes; });
    return {{"shared_most", most(frames, [](const FlightFrame& f) { return f.stream.shared_charts; })},
            {"dictionary_bytes", index + levels},
            {"index_bytes", index},
            {"level_bytes", levels}};
}

/// Tiles whose atlas is in pages, and what their transport took: 0 where there are none.
Json pages_json(const std::vector<FlightFrame>& frames) {
    return {{"tiles_most", most(frames, [](const FlightFrame& f) { return f.counts.page_tiles; })},
            {"fallback_tiles_most", most(frames, [](const FlightFrame& f) { return f.counts.fallback_tiles; })},
            {"coordinate_bytes_most", most(frames, [](const FlightFrame& f) { return f.counts.coordinate_bytes; })},
            {"mesh_draws", spread(frames, [](const FlightFrame& f) { return f.counts.mesh_draws; })}};
}

/// Light: all 0 and false where none was asked for.
Json light_json(const std::vector<FlightFrame>& frames, const FlightTotals& totals) {
    double decode_ms = 0;
    for (const FlightFrame& frame : frames) decode_ms += frame.stream.light_decode_ms;
    return {{"pipeline", totals.radiance_pipeline},
            {"tolerance_used_max", most(frames, [](const FlightFrame& f) { return f.stream.light_tolerance_used; })},
            {"tiles", spread(frames, [](const FlightFrame& f) { return static_cast<double>(f.stream.light_tiles); })},
            {"layers_most", most(frames, [](const FlightFrame& f) { return f.stream.light_layers; })},
            {"casters_most", most(frames, [](const FlightFrame& f) { return f.stream.caster_tiles; })},
            {"decodes", sum(frames, [](const FlightFrame& f) { return f.stream.light_decodes; })},
            {"decode_ms", milliseconds(decode_ms)},
            {"bytes_most", most(frames, [](const FlightFrame& f) { return f.stream.light_bytes; })},
            {"row_error_max", most(frames, [](const FlightFrame& f) { return f.stream.light_row_error; })},
            {"quarters_dropped", sum(frames, [](const FlightFrame& f) { return f.stream.light_quarters_dropped; })},
            {"pass_frames", sum(frames, [](const FlightFrame& f) { return f.counts.radiance_tiles > 0 ? 1 : 0; })},
            {"pass_tiles", sum(frames, [](const FlightFrame& f) { return f.counts.radiance_tiles; })},
            {"pass_receivers", sum(frames, [](const FlightFrame& f) { return f.counts.radiance_receivers; })},
            {"local_bytes_most", most(frames, [](const FlightFrame& f) { return f.counts.local_light_bytes; })},
            {"masks_most", most(frames, [](const FlightFrame& f) { return f.counts.relief_masks; })},
            {"mask_bytes_most", most(frames, [](const FlightFrame& f) { return f.counts.relief_mask_bytes; })},
            {"btfs_most", most(frames, [](const FlightFrame& f) { return f.counts.btfs; })},
            {"btf_bytes_most", most(frames, [](const FlightFrame& f) { return f.counts.btf_bytes; })},
            {"facades_cast", sum(frames, [](const FlightFrame& f) { return f.counts.facades_cast; })},
            {"facades_by_btf", sum(frames, [](const FlightFrame& f) { return f.counts.facades_by_btf; })},
            {"facades_by_mean", sum(frames, [](const FlightFrame& f) { return f.counts.facades_by_mean; })}};
}

/// How far vertices are off, and what of their coordinates is shown.
Json positions_json(const std::vector<FlightFrame>& frames) {
    return {{"error_pixels", spread(frames, [](const FlightFrame& f) { return f.stream.position_error_pixels; })},
            {"bits", spread(frames, [](const FlightFrame& f) { return f.stream.position_bits; })},
            {"full_bits", spread(frames, [](const FlightFrame& f) { return f.stream.full_position_bits; })}};
}

Json summary(const std::vector<FlightFrame>& frames, const std::vector<std::string>& warnings,
             const FlightTotals& totals) {
    const FetcherStatistics& net = totals.fetcher;
    return {
        {"frames", frames.size()},
        {"stopped_early", totals.stopped_early},
        {"ms", times_json(frames)},
        {"tiles_drawn", spread(frames, [](const FlightFrame& f) { return static_cast<double>(f.stream.tiles_drawn); })},
        {"tiles_missing", sum(frames, [](const FlightFrame& f) { return f.stream.tiles_missing; })},
        {"bytes",
         {{"wire", sum(frames, [](const FlightFrame& f) { return f.stream.wire_bytes; })},
          {"layers", layers_json([&](size_t layer) {
               return sum(frames, [layer](const FlightFrame& f) { return f.stream.layer_bytes[layer]; });
           })},
          {"decoded", sum(frames, [](const FlightFrame& f) { return f.stream.decoded_bytes; })},
          {"gpu_max", most(frames, [](const FlightFrame& f) { return f.stream.gpu_bytes_used; })},
          {"host_max", most(frames, [](const FlightFrame& f) { return f.stream.host_bytes_used; })},
          {"host_held_max", most(frames, [](const FlightFrame& f) { return f.stream.host_bytes_held; })},
          {"host_reserved_max", most(frames, [](const FlightFrame& f) { return f.stream.host_bytes_reserved; })},
          {"gpu_allocated", totals.gpu_bytes_allocated},
          {"frame_buffers", totals.frame_buffer_bytes}}},
        {"facades", facades_json(frames, totals)},
        {"charts", charts_json(frames)},
        {"pages", pages_json(frames)},
        {"light", light_json(frames, totals)},
        {"cache",
         {{"hits", sum(frames, [](const FlightFrame& f) { return f.stream.cache_hits; })},
          {"misses", sum(frames, [](const FlightFrame& f) { return f.stream.cache_misses; })}}},
        {"network",
         {{"requests", net.requests},
          {"retries", net.retries},
          {"failures", net.failures},
          {"cancelled", net.cancelled},
          {"body_bytes", net.body_bytes},
          {"header_bytes", net.header_bytes}}},
        {"tolerance_used_max", most(frames, [](const FlightFrame& f) { return f.stream.tolerance_used; })},
        {"achieved_error_pixels", spread(frames, [](const FlightFrame& f) { return f.stream.achieved_error_pixels; })},
        {"geometry_error_pixels", spread(frames, [](const FlightFrame& f) { return f.stream.geometry_error_pixels; })},
        {"positions", positions_json(frames)},
        {"validation_messages", totals.validation_messages},
        {"warnings", warnings.size()}};
}

}  // namespace

double percentile(std::vector<double> values, double rank) {
    if (values.empty()) return 0;
    const double place = std::ceil(rank / 100 * static_cast<double>(values.size()));
    const auto index = static_cast<size_t>(std::clamp(place - 1, 0.0, static_cast<double>(values.size() - 1)));
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
    return values[index];
}

void FlightStatistics::add(FlightFrame frame) {
    for (const std::string& warning : frame.stream.warnings) {
        if (std::find(warnings_.begin(), warnings_.end(), warning) == warnings_.end()) warnings_.push_back(warning);
    }
    frames_.push_back(std::move(frame));
}

uint64_t FlightStatistics::gpu_bytes_max() const {
    return most(frames_, [](const FlightFrame& f) { return f.stream.gpu_bytes_used; });
}

uint64_t FlightStatistics::host_bytes_max() const {
    return most(frames_, [](const FlightFrame& f) { return f.stream.host_bytes_used; });
}

std::string FlightStatistics::json(const FlightTotals& totals) const {
    Json document = {{"flight", description_json(description_)}, {"summary", summary(frames_, warnings_, totals)}};
    document["warnings"] = warnings_;
    Json list = Json::array();
    for (const FlightFrame& frame : frames_) list.push_back(frame_json(frame));
    document["frames"] = std::move(list);
    return document.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string FlightStatistics::summary_json(const FlightTotals& totals) const {
    Json document = {{"flight", description_json(description_)}, {"summary", summary(frames_, warnings_, totals)}};
    document["warnings"] = warnings_;
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace citystream::client
