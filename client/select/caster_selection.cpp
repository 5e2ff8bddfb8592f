#include "client/select/caster_selection.h"

#include <algorithm>

namespace citystream::client {

using tiles::tileset::Layer;

namespace {

class CasterWalk {
  public:
    CasterWalk(const DirectoryCache& directory, const CityKnowledge& knowledge, const CasterQuestion& question,
               CasterChoice& out)
        : directory_(directory),
          knowledge_(knowledge),
          question_(question),
          volume_(question.camera, question.limits),
          out_(out) {}

    void visit(NodeIndex index);

  private:
    void take(NodeIndex index, double pixels_per_metre);

    const DirectoryCache& directory_;
    const CityKnowledge& knowledge_;
    const CasterQuestion& question_;
    CasterVolume volume_;
    CasterChoice& out_;
};

void CasterWalk::visit(NodeIndex index) {
    if (question_.drawn(index)) return;
    const DirectoryNode& node = directory_.node(index);
    const auto& bounds = node.record->bounds;
    if (!volume_.meets(bounds, directory_.origin())) return;
    const double distance = std::max(volume_.shadow_distance(bounds, directory_.origin()), question_.camera.near_plane);
    const double pixels_per_metre = question_.camera.pixels_per_metre(distance);
    // A parent of tiles that are drawn would cast their shadows twice, and onto them.
    const bool refined = question_.refined(index);
    const bool good_enough = node.record->geometric_error * pixels_per_metre <= kCasterTolerance * question_.tolerance;
    if (!refined && (good_enough || node.is_leaf() || node.broken_children != 0)) {
        take(index, pixels_per_metre);
        return;
    }
    for (uint32_t i = 0; i < 4; ++i) {
        if ((node.unloaded_children >> i & 1) != 0) out_.subtrees.push_back(node.record->address.child(i));
    }
    if (!refined && node.unloaded_children != 0) {
        take(index, pixels_per_metre);
        return;
    }
    for (const NodeIndex child : node.children) {
        if (child != kNoNode) visit(child);
    }
}

void CasterWalk::take(NodeIndex index, double pixels_per_metre) {
    const DirectoryNode& node = directory_.node(index);
    SelectedTile tile;
    tile.node = index;
    tile.pixels_per_metre = pixels_per_metre;
    const uint8_t steps =
        mesh_prefix(node.record->steps(Layer::kMesh), usable_steps(node, knowledge_.tiles[index], Layer::kMesh),
                    granted_in(out_.positions, node.record->bounds, directory_.manifest().origin));
    if (steps == 0) return;
    tile.steps[static_cast<size_t>(Layer::kMesh)] = steps;
    out_.tiles.push_back(std::move(tile));
}

}  // namespace

CasterChoice choose_casters(const DirectoryCache& directory, const CityKnowledge& knowledge,
                            const CasterQuestion& question, const SelectionBudget& budget, SelectionCost& cost) {
    CasterChoice out;
    out.positions = position_rule(question.camera, kCasterTolerance * question.position_tolerance);
    if (directory.nodes().empty()) return out;
    CasterWalk(directory, knowledge, question, out).visit(0);
    std::stable_sort(out.tiles.begin(), out.tiles.end(), [](const SelectedTile& a, const SelectedTile& b) {
        return a.pixels_per_metre > b.pixels_per_metre;
    });
    std::erase_if(out.tiles, [&](const SelectedTile& tile) {
        const auto& steps = directory.node(tile.node).record->steps(Layer::kMesh);
        const uint32_t count = tile.steps_of(Layer::kMesh);
        SelectionCost with = cost;
        add_layer_cost(Layer::kMesh, wire_prefix_bytes(steps, count), decoded_prefix_bytes(steps, count),
                       budget.slot_bytes, with);
        if (!fits(with, budget)) {
            out.left_out = true;
            return true;
        }
        cost = with;
        return false;
    });
    return out;
}

}  // namespace citystream::client
