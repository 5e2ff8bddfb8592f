// The one rule: for every visible tile and layer the shortest prefix, and for every facade the coarsest level of its
// map, whose error, projected to the screen, is below the tolerance; and for every shared chart the shortest prefix.
// Which tiles there are is a matter of the geometry's own error, how many steps of their meshes one of positions
// (position_rule.h).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "client/select/camera.h"
#include "client/select/city_knowledge.h"
#include "client/select/depth_picture.h"
#include "client/select/placement_levels.h"
#include "client/select/position_rule.h"

namespace citystream::client {

/// A tile to draw, and how many steps of each layer.
struct SelectedTile {
    NodeIndex node = kNoNode;
    double pixels_per_metre = 0;  ///< at the nearest point of its bounds
    std::array<uint8_t, tiles::tileset::kLayerCount> steps{};
    std::vector<MapPiece> pieces;     ///< levels of facade maps that its placements want: sorted, distinct
    std::vector<ChartPrefix> charts;  ///< of shared charts: sorted, distinct
    bool has_relief() const { return steps_of(tiles::tileset::Layer::kFacade) > 0; }
    uint32_t chart_levels(uint32_t chart) const { return levels_in(charts, chart); }
    uint8_t steps_of(tiles::tileset::Layer layer) const { return steps[static_cast<size_t>(layer)]; }
};

/// What a selection needs, known before any request from the step tables.
struct SelectionCost {
    uint64_t slots = 0;       ///< of the layer store: every layer rounded up, every known level of a facade map and
                              ///< every known shared chart once
    uint64_t wire_bytes = 0;  ///< of all selected prefixes, maps and charts
    uint64_t layers = 0;      ///< number of them
    uint64_t largest_scratch = 0;  ///< bytes: the most that decoding a single prefix takes (decode_scratch.h)
};

struct Selection {
    double tolerance = 0;             ///< pixels: what the tiles were chosen with
    double texel_tolerance = 0;       ///< pixels: the same of texels
    double position_tolerance = 0;    ///< pixels: the same of positions
    PositionRule positions;           ///< that follows from it
    double light_tolerance = 0;       ///< relative radiance: the same of light; 0: none is wanted
    std::vector<SelectedTile> tiles;  ///< depth first: neighbours in the tree are neighbours here
    std::vector<NodeIndex> refined;   ///< tiles whose children were looked at instead, also where none of those shows
    std::vector<tiles::tileset::TileAddress> subtrees;  ///< not loaded yet, but needed to refine
    SelectionCost cost;
    bool relief_left_out = false;  ///< relief of some tiles is drawn flat, for the budgets do not hold it
    bool light_left_out = false;   ///< some tiles have less light than they want, or none, for the same reason
    /// Metres to the nearest tile that was left out as it lies beyond the selector's horizon; infinite: none was.
    double nearest_beyond = std::numeric_limits<double>::infinity();
    uint64_t hidden = 0;  ///< tiles of the directory's walk that lie behind the depth picture, with all below
    bool fits = true;     ///< false: even the coarsest choice breaks a budget, and far tiles were left out
};

/// Limits of a selection. Wire bytes of all that is selected are kept in host memory beside `largest_scratch`.
struct SelectionBudget {
    uint64_t slot_bytes = 1;
    uint64_t slots = ~uint64_t{0};
    uint64_t host_bytes = ~uint64_t{0};
    uint64_t host_bytes_per_layer = 0;  ///< book-keeping of a layer, beside its wire bytes
};

bool fits(const SelectionCost& cost, const SelectionBudget& budget);

/// Adds a prefix of a layer (not of light) of so many bytes.
void add_layer_cost(tiles::tileset::Layer layer, uint64_t wire, uint64_t decoded, uint64_t slot_bytes,
                    SelectionCost& cost);

/// Share of the tolerance that positions take where nothing else is asked for: five bits more a coordinate than with
/// all of it, and edges stay where they are.
inline constexpr double kPositionShare = 1.0 / 32;

/// Walks the directory for cameras. Results depend on its arguments only; the object holds scratch memory (one thread
/// at a time).
class Selector {
  public:
    /// `texel_tolerance`: pixels that texels of atlases and shared charts may project to, at the tolerance that is
    /// asked for; when that is raised for the budgets, so is this. Empty: as all errors. It changes what is taken of a
    /// tile, not which tiles: inner tiles have no finer texels than their own error allows. `position_tolerance`: the
    /// same of the pixels that a vertex may be off its place (position_rule.h); empty: kPositionShare of all errors.
    /// `light_tolerance`: relative radiance that a receiver may be off, whatever its distance, raised like the others;
    /// empty: no radiance layer is wanted.
    Selector(const DirectoryCache& directory, const CityKnowledge& knowledge, const ReliefOptions& relief = {},
             std::optional<double> texel_tolerance = {}, std::optional<double> position_tolerance = {},
             std::optional<double> light_tolerance = {})
        : directory_(directory),
          knowledge_(knowledge),
          relief_(relief),
          texel_tolerance_(texel_tolerance),
          position_tolerance_(position_tolerance),
          light_tolerance_(light_tolerance) {}

    /// The rule at exactly this tolerance, whatever it costs. O(visible tiles and their ancestors).
    Selection select(const Camera& camera, double tolerance, uint64_t slot_bytes);

    /// The rule at the smallest tolerance tolerance * 2^(k/4), k = 0, 1, ..., whose cost fits. Where relief alone would
    /// more than double the tolerance, it is left flat instead, nearest tiles served first: maps that were converted
    /// for a renderer can be a thousand times larger than the rest. Light never raises it: it gets what the rest leaves
    /// of the budget, and where that is too little first one step a tile, then all that a tile wants, nearest first.
    Selection select_within(const Camera& camera, double tolerance, const SelectionBudget& budget);

    /// From now on: tiles that the picture hides (null: none does) are not visible, and those that are farther away
    /// than `horizon` metres are left out. The picture is that of the cameras asked for, and may grow between choices.
    void look_past(const DepthPicture* picture, double horizon) {
        picture_ = picture;
        horizon_ = horizon;
    }

    /// Of the camera of the last selection, for any node of the directory.
    bool visible(NodeIndex node) { return view_of(node).visible; }
    double pixels_per_metre(NodeIndex node) { return view_of(node).pixels_per_metre; }  ///< of a visible node
    double distance(NodeIndex node) {
        return view_of(node).distance;
    }  ///< metres to the nearest point of a visible node
    /// Where a chart of a visible node is nearest.
    double chart_pixels_per_metre(NodeIndex node, uint32_t chart_in_tile) {
        return chart_pixels_per_metre(knowledge_.tiles[node], chart_in_tile, view_of(node));
    }
    /// Of any node whose placements are known: the level that each of them wants at a tolerance.
    std::vector<PlacementLevel> placement_levels_of(NodeIndex node, double tolerance) const;

  private:
    struct View {
        uint64_t stamp = 0;
        bool visible = false, hidden = false;
        double distance = 0, pixels_per_metre = 0;  ///< metres to the nearest point
    };
    const View& view_of(NodeIndex node);
    bool visit(NodeIndex node, Selection& out);
    bool visit_children(NodeIndex node, Selection& out);
    void take(NodeIndex node, const View& view, Selection& out);
    double chart_pixels_per_metre(const TileKnowledge& known, uint32_t chart_in_tile, const View& view) const;
    void begin_camera(const Camera& camera, double tolerance);
    void run(double tolerance, uint64_t slot_bytes, Selection& out);
    int search(double tolerance, const SelectionBudget& budget, Selection& out);
    Selection surfaces_within(double tolerance, const SelectionBudget& budget);
    void add_cost(const SelectedTile& tile, uint64_t slot_bytes, SelectionCost& cost);
    void add_relief_cost(const SelectedTile& tile, uint64_t slot_bytes, SelectionCost& cost);
    void add_chart_cost(const SelectedTile& tile, uint64_t slot_bytes, SelectionCost& cost);
    void add_relief(const SelectionBudget& budget, const Selection& full, Selection& out);
    void drop_far_tiles(const SelectionBudget& budget, Selection& out);
    void add_light(double tolerance, const SelectionBudget& budget, Selection& out);
    bool raise_light(SelectedTile& tile, uint8_t steps, const SelectionBudget& budget, SelectionCost& cost) const;

    const DirectoryCache& directory_;
    const CityKnowledge& knowledge_;
    ReliefOptions relief_;
    bool with_relief_ = true;  ///< false while the choice without any relief is searched
    std::optional<double> texel_tolerance_, position_tolerance_, light_tolerance_;
    double relief_ratio_ = 1;                      ///< tolerance of flat relief / tolerance: they are raised together
    double texel_ratio_ = 1, position_ratio_ = 1;  ///< the same of texels, and of positions
    Camera camera_;
    const DepthPicture* picture_ = nullptr;
    double horizon_ = std::numeric_limits<double>::infinity();
    std::vector<View> views_;           ///< by node, valid where stamp == view_stamp_
    std::vector<uint64_t> piece_seen_;  ///< by piece of the dictionary: cost_stamp_ when counted
    struct CountedChart {
        uint64_t stamp = 0;
        ChartPrefix prefix;
    };
    std::vector<CountedChart> chart_counted_;  ///< by chart of the dictionary, valid where stamp == cost_stamp_
    uint64_t view_stamp_ = 0, cost_stamp_ = 0;
};

/// Shortest prefix (number of steps, at least 1) whose error in metres projects to at most `tolerance` pixels, else all
/// `usable` steps.
uint8_t shortest_prefix(const std::vector<tiles::tileset::StepRecord>& steps, uint32_t usable, double pixels_per_metre,
                        double tolerance);

/// Decoded bytes of the first `count` steps.
uint64_t decoded_prefix_bytes(const std::vector<tiles::tileset::StepRecord>& steps, uint32_t count);

/// Wire bytes of the first `count` steps.
uint64_t wire_prefix_bytes(const std::vector<tiles::tileset::StepRecord>& steps, uint32_t count);

}  // namespace citystream::client
