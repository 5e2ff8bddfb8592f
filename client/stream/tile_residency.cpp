#include "client/stream/tile_residency.h"

#include <algorithm>
#include <unordered_map>

#include "client/cache/decode_scratch.h"
#include "client/stream/chart_boxes.h"
#include "codec/mesh/mesh_layer.h"

namespace citystream::client {

using tiles::tileset::checksum_of;
using tiles::tileset::kLayerCount;
using tiles::tileset::Layer;
using tiles::tileset::StepRecord;
using tiles::tileset::TileRecord;

namespace {

constexpr uint32_t kAllSteps = TileKnowledge::kAllSteps;

uint64_t step_begin(const std::vector<StepRecord>& steps, uint32_t step) {
    return step == 0 ? 0 : steps[step - 1].end;
}

const char* consequence_of_damage(Layer layer, uint32_t step) {
    if (layer == Layer::kFacade) return "its facades are drawn flat";
    if (layer == Layer::kRadiance) return step > 0 ? "its light is coarser" : "its light is the sky's, without shadows";
    return step > 0 ? "the tile is drawn coarser" : "the tile is drawn from its parent";
}

}  // namespace

uint64_t TileResidency::bytes_per_tile() {
    return sizeof(Facts) + sizeof(TileKnowledge);
}

void TileResidency::grow() {
    const size_t before = facts_.size();
    const size_t count = directory_.nodes().size();
    facts_.resize(count);
    knowledge_.tiles.resize(count);
    host_.fixed += (count - before) * bytes_per_tile();
    host_.note_peak();
}

void TileResidency::damaged(CachedLayer& entry, NodeIndex node, Layer layer, uint32_t step, const std::string& why) {
    cache_.drop_wire_from(entry, step);
    if (entry.store_steps > step) cache_.drop_store(entry);
    if (++entry.damages < 2) return;
    uint8_t& usable = knowledge_.tiles[node].usable_steps[static_cast<size_t>(layer)];
    usable = static_cast<uint8_t>(std::min<uint32_t>(usable, step));
    warnings_.add(layer_path(layer, directory_.node(node).record->address) + ": step " + std::to_string(step) +
                  " is damaged (" + why + ", also on the second try); " + consequence_of_damage(layer, step));
}

void TileResidency::accept_layer(NodeIndex node, Layer layer, uint32_t from, uint32_t to,
                                 std::span<const std::byte> bytes) {
    CachedLayer& entry = cache_.at(layer_key(node, layer));
    if (entry.wire_steps != from) return;  // dropped meanwhile: a later step alone is of no use
    const auto& steps = directory_.node(node).record->steps(layer);
    const bool keep = decode_ || layer == Layer::kFacade;
    uint64_t at = 0;
    for (uint32_t i = from; i < to; ++i) {
        const uint64_t size = steps[i].end - step_begin(steps, i);
        const auto part = bytes.subspan(at, size);
        at += size;
        if (checksum_of(part.data(), part.size()) != steps[i].checksum) {
            damaged(entry, node, layer, i, "checksum differs");
            return;
        }
        if (layer == Layer::kAtlas && i == 0 && !learn_shared_charts(node, part)) return;
        if (layer == Layer::kMesh && i == 0) learn_chart_boxes(node, part);
        cache_.add_wire(entry, {part.begin(), part.end()}, keep);
    }
    if (layer == Layer::kFacade && entry.wire_steps == steps.size()) learn_facade_maps(node);
}

/// Limits of what its layers name, as far as its atlas is here.
NameLimits TileResidency::limits_of(NodeIndex node) const {
    const auto& manifest = directory_.manifest();
    return {facts_[node].chart_count, static_cast<uint32_t>(manifest.facade_map_count), manifest.shared_chart_count};
}

/// Which shared charts a tile shows, and which of its own have alpha, is known as soon as the first step of its atlas
/// is here: the budget counts them, and a client that does not decode asks for them, too. False: the step is damaged.
bool TileResidency::learn_shared_charts(NodeIndex node, std::span<const std::byte> first_step) {
    TileKnowledge& known = knowledge_.tiles[node];
    if (known.charts_known || !names_charts(directory_.manifest())) return true;
    const std::span<const StepRecord> step = std::span(directory_.node(node).record->steps(Layer::kAtlas)).first(1);
    const Scratch scratch(host_, first_step.size() + 2 * step[0].decoded_bytes);
    const Stopwatch watch(counters_.decode_ms);
    const std::vector<std::vector<std::byte>> wire = {{first_step.begin(), first_step.end()}};
    DecodedPrefix prefix;
    LayerFacts facts;
    DecodeFailure failure;
    if (!decode_layer(Layer::kAtlas, wire, step, limits_of(node), prefix, facts, failure)) {
        damaged(cache_.at(layer_key(node, Layer::kAtlas)), node, Layer::kAtlas, 0, failure.message);
        return false;
    }
    known.charts = std::move(facts.atlas.shared_charts);
    known.alpha_charts = std::move(facts.atlas.alpha_charts);
    known.charts_known = true;
    host_.fixed += known.charts.size() * sizeof(known.charts[0]) + known.alpha_charts.size() * sizeof(uint32_t);
    host_.note_peak();
    return true;
}

/// How near each chart of a tile is: what a chart has to show depends on that, not on how near the tile is. From the
/// first step alone, so that a choice does not depend on what else is here. A damaged step says nothing (and is noticed
/// when it is drawn).
void TileResidency::learn_chart_boxes(NodeIndex node, std::span<const std::byte> first_step) {
    TileKnowledge& known = knowledge_.tiles[node];
    if (known.chart_boxes_known || !learns_chart_boxes(directory_, node)) return;
    const std::span<const StepRecord> step = std::span(directory_.node(node).record->steps(Layer::kMesh)).first(1);
    const Scratch scratch(host_, first_step.size() + decode_scratch_bytes(Layer::kMesh, step[0].decoded_bytes));
    const Stopwatch watch(counters_.decode_ms);
    const std::vector<std::vector<std::byte>> wire = {{first_step.begin(), first_step.end()}};
    const auto mesh = decode_mesh_content(wire, step);
    if (!mesh) return;
    known.chart_boxes = chart_boxes_of(*mesh, 1, tile_corner(directory_, node), double{step[0].error});
    known.chart_boxes_known = true;
    host_.fixed += known.chart_boxes.size() * sizeof(ChartBox);
    host_.note_peak();
}

/// Which facades a tile has is known as soon as its placements are here, before anything is drawn: the budget counts
/// them.
void TileResidency::learn_facade_maps(NodeIndex node) {
    TileKnowledge& known = knowledge_.tiles[node];
    if (known.facade_maps_known) return;
    CachedLayer& entry = cache_.at(layer_key(node, Layer::kFacade));
    const auto& steps = directory_.node(node).record->steps(Layer::kFacade);
    const Scratch scratch(host_, 2 * decoded_prefix_bytes(steps, entry.wire_steps));
    const Stopwatch watch(counters_.decode_ms);
    DecodedPrefix prefix;
    LayerFacts facts;
    DecodeFailure failure;
    NameLimits limits = limits_of(node);
    limits.charts = kAnyChart;  // the atlas may not be here yet
    if (!decode_layer(Layer::kFacade, entry.wire, steps, limits, prefix, facts, failure)) {
        damaged(entry, node, Layer::kFacade, failure.step, failure.message);
        return;
    }
    known.facade_maps = std::move(facts.facade_maps);
    known.placements = std::move(facts.placements);
    known.facade_maps_known = true;
    host_.fixed +=
        known.facade_maps.size() * sizeof(known.facade_maps[0]) + known.placements.size() * sizeof(known.placements[0]);
    host_.note_peak();
}

void TileResidency::upload(const SelectedTile& wanted) {
    for (const Layer layer : {Layer::kAtlas, Layer::kMesh, Layer::kFacade}) {
        upload_layer(wanted, layer);
    }
}

void TileResidency::upload_layer(const SelectedTile& tile, Layer layer) {
    const NodeIndex node = tile.node;
    const uint32_t wanted = tile.steps_of(layer);
    if (wanted == 0) return;
    CachedLayer* entry = cache_.find(layer_key(node, layer));
    if (entry == nullptr) return;
    const uint32_t steps = std::min(wanted, entry->wire_steps);
    if (steps <= entry->store_steps) return;
    const TileRecord& record = *directory_.node(node).record;
    const bool waits_for_charts = layer != Layer::kAtlas && tile.steps_of(Layer::kAtlas) > 0;
    if (decode_ && waits_for_charts && !facts_[node].charts_known) return;
    const uint64_t bytes = decoded_prefix_bytes(record.steps(layer), steps);
    if (!cache_.free_slots(cache_.slots_for(bytes) - cache_.slots_for(entry->store_bytes))) return;
    const Stopwatch watch(counters_.decode_ms);
    const uint64_t before = entry->store_bytes;
    const bool done = !decode_                ? cache_.append_zeros(*entry, bytes - before, steps).ok()
                      : layer == Layer::kMesh ? decode_mesh_to_store(*entry, node, steps)
                                              : decode_to_store(*entry, node, layer, steps);
    if (done) counters_.decoded_bytes += bytes - before;
}

/// A mesh that is there gets the bits that it lacks, merged by the store; where that has no room for both at a time the
/// mesh comes anew.
Status TileResidency::store_mesh(CachedLayer& entry, const codec::mesh::MeshLayer& mesh, uint64_t bytes) {
    if (entry.store_steps > 0) {
        const auto planes = mesh.resident.planes(entry.store_steps, mesh.steps);
        const auto begin = static_cast<uint32_t>(mesh.resident.words.size());
        const uint32_t level = mesh.resident.levels[mesh.steps - 1];
        if (cache_.free_slots(cache_.slots_for(bytes)) && cache_.refine(entry, begin, planes, level, bytes, mesh.steps))
            return Done{};
        cache_.drop_store(entry);
    }
    return cache_.append(entry, mesh.words(), mesh.steps);
}

bool TileResidency::decode_mesh_to_store(CachedLayer& entry, NodeIndex node, uint32_t steps) {
    const auto& all = directory_.node(node).record->steps(Layer::kMesh);
    const uint64_t scratch_bytes = decode_scratch_bytes(Layer::kMesh, decoded_prefix_bytes(all, steps));
    cache_.free_host(scratch_bytes);
    const Scratch scratch(host_, scratch_bytes);
    codec::mesh::MeshLayer mesh;
    DecodeFailure failure;
    if (!decode_mesh(entry.wire, std::span(all).first(steps), facts_[node].chart_count, mesh, failure)) {
        damaged(entry, node, Layer::kMesh, failure.step, failure.message);
        return false;
    }
    const Status stored = store_mesh(entry, mesh, decoded_prefix_bytes(all, steps));
    if (!stored) {
        warnings_.add(layer_path(Layer::kMesh, directory_.node(node).record->address) + ": " + stored.error().text());
        return false;
    }
    facts_[node].mesh_ranges = mesh.resident.ranges;
    return true;
}

bool TileResidency::decode_to_store(CachedLayer& entry, NodeIndex node, Layer layer, uint32_t steps) {
    const auto& all = directory_.node(node).record->steps(layer);
    const std::span<const StepRecord> wanted = std::span(all).first(steps);
    const uint64_t decoded = decoded_prefix_bytes(all, steps);
    cache_.free_host(2 * decoded);
    const Scratch scratch(host_, 2 * decoded);
    DecodedPrefix prefix;
    LayerFacts facts;
    DecodeFailure failure;
    if (!decode_layer(layer, entry.wire, wanted, limits_of(node), prefix, facts, failure)) {
        damaged(entry, node, layer, failure.step, failure.message);
        return false;
    }
    const Status appended = cache_.append(entry, std::span(prefix.words).subspan(entry.store_bytes / 4), steps);
    if (!appended) {
        warnings_.add(layer_path(layer, directory_.node(node).record->address) + ": " + appended.error().text());
        return false;
    }
    if (layer == Layer::kAtlas) remember_atlas(node, steps, facts);
    return true;
}

void TileResidency::remember_atlas(NodeIndex node, uint32_t steps, const LayerFacts& facts) {
    Facts& known = facts_[node];
    if (!known.charts_known) {
        // A mesh that came without the atlas may name charts that this one does not have: it is read once more.
        CachedLayer* mesh = cache_.find(layer_key(node, Layer::kMesh));
        if (mesh != nullptr) cache_.drop_store(*mesh);
    }
    known.charts_known = true;
    known.atlas_form = facts.atlas.form;
    known.chart_count = facts.atlas.chart_count;
    known.coarsest_step_mip = facts.atlas.finest_mip + steps - 1;
}

bool TileResidency::drawable(NodeIndex node) {
    const TileRecord& record = *directory_.node(node).record;
    for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
        if (record.steps(layer).empty()) {
            if (layer == Layer::kMesh) return true;
            continue;
        }
        const CachedLayer* entry = cache_.find(layer_key(node, layer));
        if (entry == nullptr || entry->store_steps == 0) return false;
    }
    const auto& charts = knowledge_.tiles[node].charts;
    return std::all_of(charts.begin(), charts.end(), [&](const auto& use) { return charts_.can_show(use); });
}

bool TileResidency::add_relief(NodeIndex node, std::span<const PlacementLevel> levels, TileDraw& out) {
    CachedLayer* entry = cache_.find(layer_key(node, Layer::kFacade));
    if (entry == nullptr || entry->store_steps == 0 || !knowledge_.tiles[node].facade_maps_known) return false;
    std::unordered_map<CachedLayer*, uint32_t> used;
    std::vector<FacadeMapBinding> maps;
    std::vector<uint32_t> map_of_placement;
    for (const PlacementLevel& level : levels) {
        CachedLayer* held = level.piece == kNoPiece ? nullptr : maps_.to_draw(level.piece);
        if (held == nullptr) return false;
        const auto [place, added] = used.try_emplace(held, static_cast<uint32_t>(maps.size()));
        if (added) {
            const MapPiece piece = piece_of(held->key);
            maps.push_back({map_of(piece), held->id, level_of(piece)});
        }
        map_of_placement.push_back(place->second);
    }
    for (const auto& [held, index] : used) cache_.mark_drawn(*held);
    cache_.mark_drawn(*entry);
    out.facade = entry->id;
    out.facade_maps = std::move(maps);
    out.map_of_placement = std::move(map_of_placement);
    return true;
}

void TileResidency::add_atlas(NodeIndex node, CachedLayer& atlas, const SelectedTile* chosen, TileDraw& out) {
    const Facts& facts = facts_[node];
    cache_.mark_drawn(atlas);
    out.atlas = atlas.id;
    out.atlas_form = facts.atlas_form;
    out.chart_count = facts.chart_count;
    out.alpha_test = shows_alpha(knowledge_, knowledge_.tiles[node]);
    const uint32_t wanted = chosen != nullptr ? std::max<uint32_t>(1, chosen->steps_of(Layer::kAtlas)) : kAllSteps;
    out.atlas_finest_mip = facts.coarsest_step_mip - (std::min(wanted, atlas.store_steps) - 1);
    for (const auto& use : knowledge_.tiles[node].charts) {
        const uint32_t levels = chosen != nullptr ? chosen->chart_levels(use.number) : codec::atlas::kMostChartLevels;
        out.shared_charts.push_back(charts_.to_draw(use, levels));
    }
}

TileDraw TileResidency::draw_of(NodeIndex node, CachedLayer& mesh, uint32_t steps) {
    const TileRecord& record = *directory_.node(node).record;
    const GridPoint origin = directory_.manifest().tile_origin(record);
    TileDraw out;
    out.address = record.address;
    out.origin = {to_metres(origin.x), to_metres(origin.y), to_metres(origin.z)};
    cache_.mark_drawn(mesh);
    out.mesh = mesh.id;
    out.mesh_steps = std::min(steps, mesh.store_steps);
    out.mesh_ranges = facts_[node].mesh_ranges;
    return out;
}

std::optional<TileDraw> TileResidency::draw_mesh(NodeIndex node, uint32_t steps) {
    CachedLayer* mesh = cache_.find(layer_key(node, Layer::kMesh));
    if (mesh == nullptr || mesh->store_steps == 0) return std::nullopt;
    return draw_of(node, *mesh, steps);
}

TileDraw TileResidency::draw(NodeIndex node, const SelectedTile* chosen) {
    TileDraw out = draw_of(node, cache_.at(layer_key(node, Layer::kMesh)),
                           chosen != nullptr ? chosen->steps_of(Layer::kMesh) : kAllSteps);
    CachedLayer* atlas = cache_.find(layer_key(node, Layer::kAtlas));
    if (atlas != nullptr && atlas->store_steps > 0) add_atlas(node, *atlas, chosen, out);
    return out;
}

}  // namespace citystream::client
