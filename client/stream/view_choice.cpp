#include "client/stream/view_choice.h"

#include <algorithm>
#include <utility>

#include "client/render/shadow_cascades.h"

namespace citystream::client {

using tiles::tileset::kLayerCount;
using tiles::tileset::Layer;

namespace {

/// The root's light may take this part of the store.
constexpr uint64_t kStandInLightShare = 8;

/// Of the root when it stands in for a view: the whole mesh, for its first step alone looks like nothing.
uint8_t stand_in_steps(const tiles::tileset::TileRecord& root, Layer layer) {
    const size_t steps = root.steps(layer).size();
    return static_cast<uint8_t>(layer == Layer::kMesh ? steps : std::min<size_t>(1, steps));
}

}  // namespace

uint64_t ViewChoice::grow() {
    const uint64_t grown = (directory_.nodes().size() - marks_.size()) * sizeof(Mark);
    marks_.resize(directory_.nodes().size());
    return grown;
}

bool ViewChoice::is_caster(NodeIndex node) const {
    return std::any_of(casters_.tiles.begin(), casters_.tiles.end(),
                       [&](const SelectedTile& tile) { return tile.node == node; });
}

void ViewChoice::choose_casters(const Camera& camera, const std::array<double, 3>& to_sun) {
    const auto& city = directory_.node(0).record->bounds;
    CasterQuestion question;
    question.camera = camera;
    question.limits = {to_sun, kCascadeEnds.back(), kCasterReach, city.min[2], city.max[2]};
    question.tolerance = selection_.tolerance;
    question.position_tolerance = selection_.position_tolerance;
    question.drawn = [this](NodeIndex node) { return is_selected(node); };
    question.refined = [this](NodeIndex node) { return is_refined(node); };
    casters_ = client::choose_casters(directory_, knowledge_, question, selection_budget(), selection_.cost);
    // The root that stands in for a view is here with more steps.
    std::erase_if(casters_.tiles, [&](const SelectedTile& tile) { return wanted_tile(tile.node) != nullptr; });
    for (const SelectedTile& tile : casters_.tiles) cache_.need(cache_.at(layer_key(tile.node, Layer::kMesh)));
    if (casters_.left_out) {
        warnings_.add("the budgets do not hold all that casts shadows from out of this view; some shadows are missing");
    }
}

/// In realtime mode without the root's room.
SelectionBudget ViewChoice::selection_budget() const {
    SelectionBudget budget;
    budget.slot_bytes = store_.slot_bytes();
    budget.slots = store_.slot_count();
    budget.host_bytes = host_.budget > host_.fixed ? host_.budget - host_.fixed : 0;
    budget.host_bytes_per_layer = kCachedLayerBytes;
    if (!options_.wait_for_selection && !directory_.nodes().empty()) {
        const auto& root = *directory_.node(0).record;
        const SelectedTile tile = stand_in();
        uint64_t reserve = 0;
        for (const Layer layer : {Layer::kMesh, Layer::kAtlas, Layer::kRadiance}) {
            reserve += store_.slots_for(decoded_prefix_bytes(root.steps(layer), tile.steps_of(layer)));
        }
        for (const ChartPrefix& chart : tile.charts) {
            reserve += store_.slots_for(knowledge_.charts.decoded_bytes(chart));
        }
        budget.slots -= std::min(budget.slots, reserve);
    }
    return budget;
}

void ViewChoice::choose(const Camera& camera) {
    casters_ = {};
    selection_ = selector_.select_within(camera, options_.tolerance_pixels, selection_budget());
    needed_ = selection_.tiles;
    ++serial_;
    for (const SelectedTile& tile : selection_.tiles) marks_[tile.node].selected = serial_;
    for (const NodeIndex node : selection_.refined) marks_[node].refined = serial_;
    if (!options_.wait_for_selection) pin_root();
    needed_charts_.clear();
    for (const SelectedTile& tile : needed_) {
        needed_charts_.insert(needed_charts_.end(), tile.charts.begin(), tile.charts.end());
    }
    merge_prefixes(needed_charts_);
    for (uint32_t i = 0; i < needed_.size(); ++i) {
        marks_[needed_[i].node].needed = serial_;
        marks_[needed_[i].node].position = i;
    }
    mark_needed();
}

void ViewChoice::warn_of_budgets() {
    if (selection_.relief_left_out) {
        warnings_.add("the budgets do not hold all relief of this view; that of far tiles is drawn flat");
    }
    if (selection_.light_left_out) {
        warnings_.add(
            "the budgets do not hold all light of this view; that of far tiles is coarser, or the sky's without "
            "shadows");
    }
    if (!selection_.fits) {
        warnings_.add("the budgets do not hold even the coarsest tiles of this view; far tiles are left out");
    }
}

/// In realtime mode the root stays resident with its coarsest textures and light, so that there is always something to
/// fall back to.
void ViewChoice::pin_root() {
    if (directory_.nodes().empty() || is_selected(0) || !can_be_drawn(directory_, knowledge_, 0)) return;
    needed_.push_back(stand_in());
    needed_.back().pixels_per_metre = selector_.visible(0) ? selector_.pixels_per_metre(0) : 0;
}

/// The root with as much of it as it takes to fall back to.
SelectedTile ViewChoice::stand_in() const {
    SelectedTile root;
    root.node = 0;
    for (const Layer layer : {Layer::kMesh, Layer::kAtlas}) {
        root.steps[static_cast<size_t>(layer)] = std::min(stand_in_steps(*directory_.node(0).record, layer),
                                                          knowledge_.tiles[0].usable_steps[static_cast<size_t>(layer)]);
    }
    root.steps[static_cast<size_t>(Layer::kRadiance)] = stand_in_light();
    if (!knowledge_.charts.known()) return root;
    for (const auto& use : knowledge_.tiles[0].charts) {
        if (knowledge_.charts.usable_levels(use.number) > 0) root.charts.push_back({use.number, 1});
    }
    merge_prefixes(root.charts);
    return root;
}

/// Steps of the root's light, by which all tiles are lit that neither have their own yet nor a nearer ancestor's.
uint8_t ViewChoice::stand_in_light() const {
    const auto& steps = directory_.node(0).record->steps(Layer::kRadiance);
    if (!options_.light_tolerance || steps.empty()) return 0;
    const bool is_small = store_.slots_for(steps[0].decoded_bytes) <= store_.slot_count() / kStandInLightShare;
    return is_small ? std::min<uint8_t>(1, knowledge_.tiles[0].usable_steps[static_cast<size_t>(Layer::kRadiance)]) : 0;
}

void ViewChoice::mark_needed() {
    cache_.begin_selection();
    for (const SelectedTile& tile : needed_) {
        for (size_t layer = 0; layer < kLayerCount; ++layer) {
            if (tile.steps[layer] > 0) cache_.need(cache_.at(layer_key(tile.node, static_cast<Layer>(layer))));
        }
        for (const MapPiece piece : tile.pieces) cache_.need(cache_.at(map_key(piece)));
    }
    for (const ChartPrefix& chart : needed_charts_) cache_.need(cache_.at(chart_key(chart.chart)));
}

void ViewChoice::count_hits(StreamerFrame& frame) {
    for (const SelectedTile& tile : needed_) {
        if (std::exchange(marks_[tile.node].counted, update_) == update_) continue;
        for (size_t layer = 0; layer < kLayerCount; ++layer) {
            if (tile.steps[layer] == 0) continue;
            const CachedLayer& entry = cache_.at(layer_key(tile.node, static_cast<Layer>(layer)));
            const bool here = std::max(entry.store_steps, entry.wire_steps) >= tile.steps[layer];
            ++(here ? frame.cache_hits : frame.cache_misses);
        }
    }
}

}  // namespace citystream::client
