#include "client/select/selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "client/cache/decode_scratch.h"

namespace citystream::client {

using tiles::tileset::kLayerCount;
using tiles::tileset::Layer;
using tiles::tileset::StepRecord;
using tiles::tileset::TileRecord;

namespace {

/// Steps of the tolerance: four a doubling, up to 2^20 times what was asked for.
constexpr int kSteepest = 80, kDoubling = 4;
double raised(double tolerance, int k) {
    return tolerance * std::exp2(k / 4.0);
}

}  // namespace

bool fits(const SelectionCost& cost, const SelectionBudget& budget) {
    const uint64_t host = cost.wire_bytes + cost.layers * budget.host_bytes_per_layer + cost.largest_scratch;
    return cost.slots <= budget.slots && host <= budget.host_bytes;
}

void add_layer_cost(Layer layer, uint64_t wire, uint64_t decoded, uint64_t slot_bytes, SelectionCost& cost) {
    cost.wire_bytes += wire;
    ++cost.layers;
    cost.slots += (decoded + slot_bytes - 1) / slot_bytes;
    cost.largest_scratch = std::max(cost.largest_scratch, decode_scratch_bytes(layer, decoded));
}

bool can_be_drawn(const DirectoryCache& directory, const CityKnowledge& knowledge, NodeIndex index) {
    const DirectoryNode& node = directory.node(index);
    const TileKnowledge& known = knowledge.tiles[index];
    const auto& mesh = node.record->steps(Layer::kMesh);
    if (mesh.empty()) return true;
    const uint32_t mesh_steps = usable_steps(node, known, Layer::kMesh);
    if (mesh_steps == 0) return false;
    if (!node.record->steps(Layer::kAtlas).empty() && usable_steps(node, known, Layer::kAtlas) == 0) return false;
    if (mesh_steps == mesh.size() || node.parent == kNoNode) return true;
    return mesh[mesh_steps - 1].error <= directory.node(node.parent).record->geometric_error;
}

bool shows_alpha(const CityKnowledge& knowledge, const TileKnowledge& tile, uint32_t chart) {
    if (std::binary_search(tile.alpha_charts.begin(), tile.alpha_charts.end(), chart)) return true;
    const auto use = std::lower_bound(tile.charts.begin(), tile.charts.end(), chart,
                                      [](const auto& a, uint32_t b) { return a.chart_in_tile < b; });
    return use != tile.charts.end() && use->chart_in_tile == chart && knowledge.charts.known() &&
           knowledge.charts.has_alpha(use->number);
}

bool shows_alpha(const CityKnowledge& knowledge, const TileKnowledge& tile) {
    return !tile.alpha_charts.empty() || std::any_of(tile.charts.begin(), tile.charts.end(), [&](const auto& use) {
        return knowledge.charts.known() && knowledge.charts.has_alpha(use.number);
    });
}

bool has_usable_relief(const DirectoryCache& directory, const CityKnowledge& knowledge, NodeIndex index) {
    const DirectoryNode& node = directory.node(index);
    const TileKnowledge& known = knowledge.tiles[index];
    if (knowledge.facades_broken || usable_steps(node, known, Layer::kFacade) == 0) return false;
    const FacadeDictionary& dictionary = knowledge.dictionary;
    return std::all_of(known.facade_maps.begin(), known.facade_maps.end(),
                       [&](uint32_t map) { return map >= dictionary.size() || dictionary.has_usable_level(map); });
}

uint8_t shortest_prefix(const std::vector<StepRecord>& steps, uint32_t usable, double pixels_per_metre,
                        double tolerance) {
    for (uint32_t i = 0; i + 1 < usable; ++i) {
        if (steps[i].error * pixels_per_metre <= tolerance) return static_cast<uint8_t>(i + 1);
    }
    return static_cast<uint8_t>(usable);
}

uint64_t decoded_prefix_bytes(const std::vector<StepRecord>& steps, uint32_t count) {
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < count; ++i) bytes += steps[i].decoded_bytes;
    return bytes;
}

uint64_t wire_prefix_bytes(const std::vector<StepRecord>& steps, uint32_t count) {
    return count == 0 ? 0 : steps[count - 1].end;
}

uint64_t store_bytes(const DirectoryNode& node, const TileKnowledge& known, Layer layer, uint32_t steps) {
    const bool is_learnt = layer == Layer::kRadiance && steps > 0 && steps <= known.light_bytes.size();
    const uint32_t learnt = is_learnt ? known.light_bytes[steps - 1] : 0;
    return learnt > 0 ? learnt : decoded_prefix_bytes(node.record->steps(layer), steps);
}

void Selector::begin_camera(const Camera& camera, double tolerance) {
    camera_ = camera;
    relief_ratio_ = relief_.tolerance_pixels && tolerance > 0 ? *relief_.tolerance_pixels / tolerance : 1;
    texel_ratio_ = texel_tolerance_ && tolerance > 0 ? *texel_tolerance_ / tolerance : 1;
    position_ratio_ = position_tolerance_ && tolerance > 0 ? *position_tolerance_ / tolerance : kPositionShare;
    ++view_stamp_;
    views_.resize(directory_.nodes().size());
}

const Selector::View& Selector::view_of(NodeIndex index) {
    View& view = views_[index];
    if (view.stamp == view_stamp_) return view;
    const auto& bounds = directory_.node(index).record->bounds;
    view.stamp = view_stamp_;
    view.visible = camera_.sees(bounds, directory_.origin());
    view.hidden = false;
    if (!view.visible) return view;
    view.distance = std::max(camera_.distance_to(bounds, directory_.origin()), camera_.near_plane);
    view.pixels_per_metre = camera_.pixels_per_metre(view.distance);
    view.hidden = picture_ != nullptr && picture_->hides(bounds, directory_.origin());
    view.visible = !view.hidden;
    return view;
}

/// Selects for the part of the picture that `index` covers. False: some of it cannot be drawn from here and below; what
/// could be was added.
bool Selector::visit(NodeIndex index, Selection& out) {
    const View view = view_of(index);
    if (view.hidden) ++out.hidden;
    if (!view.visible) return true;
    if (view.distance > horizon_) {
        out.nearest_beyond = std::min(out.nearest_beyond, view.distance);
        return true;
    }
    const DirectoryNode& node = directory_.node(index);
    const bool good_enough = node.record->geometric_error * view.pixels_per_metre <= out.tolerance;
    if (good_enough || node.is_leaf() || node.broken_children != 0) {
        if (!can_be_drawn(directory_, knowledge_, index)) return false;
        take(index, view, out);
        return true;
    }
    if (node.unloaded_children != 0) {
        for (uint32_t i = 0; i < 4; ++i) {
            if ((node.unloaded_children >> i & 1) != 0) out.subtrees.push_back(node.record->address.child(i));
        }
        if (!can_be_drawn(directory_, knowledge_, index)) return false;
        take(index, view, out);
        return true;
    }
    const size_t mark = out.tiles.size(), refined_mark = out.refined.size();
    out.refined.push_back(index);
    const bool covered = visit_children(index, out);
    if (covered || !can_be_drawn(directory_, knowledge_, index)) return covered;
    out.tiles.resize(mark);  // REPLACE: the parent is drawn instead of all of its children
    out.refined.resize(refined_mark);
    take(index, view, out);
    return true;
}

bool Selector::visit_children(NodeIndex index, Selection& out) {
    bool covered = true;
    for (const NodeIndex child : directory_.node(index).children) {
        if (child != kNoNode) covered = visit(child, out) && covered;
    }
    return covered;
}

void Selector::take(NodeIndex index, const View& view, Selection& out) {
    const DirectoryNode& node = directory_.node(index);
    const TileKnowledge& known = knowledge_.tiles[index];
    SelectedTile tile;
    tile.node = index;
    tile.pixels_per_metre = view.pixels_per_metre;
    tile.steps[static_cast<size_t>(Layer::kMesh)] =
        mesh_prefix(node.record->steps(Layer::kMesh), usable_steps(node, known, Layer::kMesh),
                    granted_in(out.positions, node.record->bounds, directory_.manifest().origin));
    tile.steps[static_cast<size_t>(Layer::kAtlas)] =
        shortest_prefix(node.record->steps(Layer::kAtlas), usable_steps(node, known, Layer::kAtlas),
                        view.pixels_per_metre, out.texel_tolerance);
    const double relief_pixels = node.record->flat_facade_error * view.pixels_per_metre;
    if (with_relief_ && relief_pixels > out.tolerance * relief_ratio_ &&
        has_usable_relief(directory_, knowledge_, index)) {
        tile.pieces = distinct_pieces(placement_levels_of(index, out.tolerance));
        tile.steps[static_cast<size_t>(Layer::kFacade)] =
            shortest_prefix(node.record->steps(Layer::kFacade), usable_steps(node, known, Layer::kFacade),
                            view.pixels_per_metre, out.tolerance);
    }
    if (knowledge_.charts.known()) {
        for (const auto& use : known.charts) {
            const ChartPrefix prefix = knowledge_.charts.wanted(
                use, chart_pixels_per_metre(known, use.chart_in_tile, view), out.texel_tolerance);
            if (prefix.levels > 0) tile.charts.push_back(prefix);
        }
        merge_prefixes(tile.charts);
    }
    out.tiles.push_back(std::move(tile));
}

/// Where the chart is nearest; 0: it is not in the view. As the tile where that is not known.
double Selector::chart_pixels_per_metre(const TileKnowledge& known, uint32_t chart_in_tile, const View& view) const {
    if (!known.chart_boxes_known) return view.pixels_per_metre;
    const auto box = std::lower_bound(known.chart_boxes.begin(), known.chart_boxes.end(), chart_in_tile,
                                      [](const ChartBox& one, uint32_t chart) { return one.chart_in_tile < chart; });
    if (box == known.chart_boxes.end() || box->chart_in_tile != chart_in_tile) return 0;
    if (!camera_.sees(box->bounds, directory_.origin())) return 0;
    const double distance = camera_.distance_to(box->bounds, directory_.origin());
    return camera_.pixels_per_metre(std::max(distance, camera_.near_plane));
}

std::vector<PlacementLevel> Selector::placement_levels_of(NodeIndex node, double tolerance) const {
    return placement_levels(knowledge_.dictionary, camera_,
                            directory_.manifest().tile_origin(*directory_.node(node).record),
                            knowledge_.tiles[node].placements, {relief_.texel_share * tolerance, relief_.map_level});
}

void Selector::add_cost(const SelectedTile& tile, uint64_t slot_bytes, SelectionCost& cost) {
    const TileRecord& record = *directory_.node(tile.node).record;
    for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
        const uint32_t steps = tile.steps_of(layer);
        if (steps == 0) continue;
        add_layer_cost(layer, wire_prefix_bytes(record.steps(layer), steps),
                       decoded_prefix_bytes(record.steps(layer), steps), slot_bytes, cost);
    }
    if (tile.has_relief()) add_relief_cost(tile, slot_bytes, cost);
    add_chart_cost(tile, slot_bytes, cost);
}

/// A chart counts with the longest prefix that any tile wants of it: each tile adds what it wants beyond those before.
void Selector::add_chart_cost(const SelectedTile& tile, uint64_t slot_bytes, SelectionCost& cost) {
    const ChartDictionary& dictionary = knowledge_.charts;
    const auto slots = [&](uint64_t bytes) { return (bytes + slot_bytes - 1) / slot_bytes; };
    for (const ChartPrefix& wanted : tile.charts) {
        CountedChart& counted = chart_counted_[wanted.chart];
        if (counted.stamp != cost_stamp_) {
            counted = {cost_stamp_, {wanted.chart, 0}};
            ++cost.layers;
        }
        if (counted.prefix.levels >= wanted.levels) continue;
        const uint64_t decoded = dictionary.decoded_bytes(wanted);
        cost.slots += slots(decoded) - slots(dictionary.decoded_bytes(counted.prefix));
        cost.wire_bytes += dictionary.wire_bytes(wanted) - dictionary.wire_bytes(counted.prefix);
        cost.largest_scratch = std::max(cost.largest_scratch, decode_scratch_bytes(Layer::kAtlas, decoded));
        counted.prefix = wanted;
    }
}

/// Placements, and the levels of maps that were not counted yet.
void Selector::add_relief_cost(const SelectedTile& tile, uint64_t slot_bytes, SelectionCost& cost) {
    const auto& placements = directory_.node(tile.node).record->steps(Layer::kFacade);
    const uint32_t steps = tile.steps_of(Layer::kFacade);
    add_layer_cost(Layer::kFacade, wire_prefix_bytes(placements, steps), decoded_prefix_bytes(placements, steps),
                   slot_bytes, cost);
    for (const MapPiece piece : tile.pieces) {
        if (piece_seen_[piece] == cost_stamp_) continue;
        piece_seen_[piece] = cost_stamp_;
        add_layer_cost(Layer::kFacade, knowledge_.dictionary.wire_bytes(piece),
                       knowledge_.dictionary.resident_bytes(piece), slot_bytes, cost);
    }
}

void Selector::run(double tolerance, uint64_t slot_bytes, Selection& out) {
    out = {};
    out.tolerance = tolerance;
    out.texel_tolerance = tolerance * texel_ratio_;
    out.position_tolerance = tolerance * position_ratio_;
    out.positions = position_rule(camera_, out.position_tolerance);
    if (!directory_.nodes().empty()) visit(0, out);
    std::sort(out.subtrees.begin(), out.subtrees.end());
    out.subtrees.erase(std::unique(out.subtrees.begin(), out.subtrees.end()), out.subtrees.end());
    piece_seen_.resize(map_piece(static_cast<uint32_t>(knowledge_.dictionary.size()), 0));
    chart_counted_.resize(knowledge_.charts.size());
    ++cost_stamp_;
    for (const SelectedTile& tile : out.tiles) add_cost(tile, slot_bytes, out.cost);
}

Selection Selector::select(const Camera& camera, double tolerance, uint64_t slot_bytes) {
    begin_camera(camera, tolerance);
    Selection selection;
    run(tolerance, slot_bytes, selection);
    SelectionBudget unlimited;
    unlimited.slot_bytes = slot_bytes;
    add_light(tolerance, unlimited, selection);
    return selection;
}

/// The smallest k whose choice fits, kSteepest when none does; `out` is that choice. One after the other: a coarser
/// choice may cost more, and then what bisection finds would depend on how much of the dropped ones is known. What a
/// finer choice would cost is known when its subtrees are here: they are asked for, too.
int Selector::search(double tolerance, const SelectionBudget& budget, Selection& out) {
    std::vector<tiles::tileset::TileAddress> missing;
    for (int k = 0;; ++k) {
        run(raised(tolerance, k), budget.slot_bytes, out);
        out.fits = fits(out.cost, budget);
        missing.insert(missing.end(), out.subtrees.begin(), out.subtrees.end());
        if (!out.fits && k < kSteepest) continue;
        std::sort(missing.begin(), missing.end());
        missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
        out.subtrees = std::move(missing);
        return k;
    }
}

Selection Selector::select_within(const Camera& camera, double tolerance, const SelectionBudget& budget) {
    begin_camera(camera, tolerance);
    Selection selection = surfaces_within(tolerance, budget);
    add_light(tolerance, budget, selection);
    return selection;
}

/// All layers but light.
Selection Selector::surfaces_within(double tolerance, const SelectionBudget& budget) {
    Selection good;
    const int k = search(tolerance, budget, good);
    if (k > kDoubling || !good.fits) {
        Selection flat, full;
        with_relief_ = false;
        const int flat_k = search(tolerance, budget, flat);
        with_relief_ = true;
        if (flat.fits && k > flat_k + kDoubling) {
            run(raised(tolerance, flat_k), budget.slot_bytes, full);
            add_relief(budget, full, flat);
            return flat;
        }
    }
    if (!good.fits) drop_far_tiles(budget, good);
    return good;
}

/// Gives the tiles of `out`, which have no relief, that of `full`, the same choice with all relief: nearest first, as
/// much as fits.
void Selector::add_relief(const SelectionBudget& budget, const Selection& full, Selection& out) {
    std::vector<uint32_t> order(full.tiles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return full.tiles[a].pixels_per_metre > full.tiles[b].pixels_per_metre;
    });
    for (const uint32_t i : order) {
        if (!full.tiles[i].has_relief()) continue;
        // Pieces that a tile left out had counted count again, so each tile is tried on a count of its own.
        SelectionCost with = {};
        ++cost_stamp_;
        const SelectedTile flat = std::exchange(out.tiles[i], full.tiles[i]);
        for (const SelectedTile& tile : out.tiles) add_cost(tile, budget.slot_bytes, with);
        if (fits(with, budget)) {
            out.cost = with;
        } else {
            out.tiles[i] = flat;
            out.relief_left_out = true;
        }
    }
}

/// The last resort of a budget too small for even the coarsest tiles: nearest first, as many as fit.
void Selector::drop_far_tiles(const SelectionBudget& budget, Selection& out) {
    std::stable_sort(out.tiles.begin(), out.tiles.end(), [](const SelectedTile& a, const SelectedTile& b) {
        return a.pixels_per_metre > b.pixels_per_metre;
    });
    std::vector<SelectedTile> kept;
    ++cost_stamp_;
    out.cost = {};
    for (const SelectedTile& tile : out.tiles) {
        SelectionCost with = out.cost;
        add_cost(tile, budget.slot_bytes, with);
        if (!fits(with, budget)) break;
        out.cost = with;
        kept.push_back(tile);
    }
    out.tiles = std::move(kept);
    out.fits = false;
}

/// Every tile a little light before any has all: what has none is lit as if nothing stood around it.
void Selector::add_light(double tolerance, const SelectionBudget& budget, Selection& out) {
    if (!light_tolerance_) return;
    out.light_tolerance = tolerance > 0 ? *light_tolerance_ * (out.tolerance / tolerance) : *light_tolerance_;
    std::vector<uint32_t> order(out.tiles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return out.tiles[a].pixels_per_metre > out.tiles[b].pixels_per_metre;
    });
    std::vector<uint8_t> wanted;
    for (const SelectedTile& tile : out.tiles) {
        const DirectoryNode& node = directory_.node(tile.node);
        wanted.push_back(shortest_prefix(node.record->steps(Layer::kRadiance),
                                         usable_steps(node, knowledge_.tiles[tile.node], Layer::kRadiance), 1,
                                         out.light_tolerance));
    }
    for (const uint8_t most : {uint8_t{1}, std::numeric_limits<uint8_t>::max()}) {
        for (const uint32_t i : order) {
            if (!raise_light(out.tiles[i], std::min(most, wanted[i]), budget, out.cost)) out.light_left_out = true;
        }
    }
}

/// Gives a tile a longer prefix of light, and a cost what that takes more. False, and nothing changes: it does not fit.
bool Selector::raise_light(SelectedTile& tile, uint8_t steps, const SelectionBudget& budget,
                           SelectionCost& cost) const {
    uint8_t& held = tile.steps[static_cast<size_t>(Layer::kRadiance)];
    if (steps <= held) return true;
    const DirectoryNode& node = directory_.node(tile.node);
    const auto& all = node.record->steps(Layer::kRadiance);
    const auto slots = [&](uint32_t count) {
        const uint64_t bytes = store_bytes(node, knowledge_.tiles[tile.node], Layer::kRadiance, count);
        return (bytes + budget.slot_bytes - 1) / budget.slot_bytes;
    };
    SelectionCost with = cost;
    with.wire_bytes += wire_prefix_bytes(all, steps) - wire_prefix_bytes(all, held);
    with.slots = with.slots + slots(steps) - slots(held);
    with.layers += held == 0 ? 1 : 0;
    with.largest_scratch = std::max(
        with.largest_scratch, light_scratch_bytes(directory_.manifest().radiance_texels_across,
                                                  decoded_prefix_bytes(all, steps), wire_prefix_bytes(all, steps)));
    if (!fits(with, budget)) return false;
    cost = with;
    held = steps;
    return true;
}

}  // namespace citystream::client
