// What of each tile is here: takes received bytes in (checked), brings prefixes to the store, says what can be drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/cache/layer_cache.h"
#include "client/render/frame.h"
#include "client/select/city_knowledge.h"
#include "client/select/selection.h"
#include "client/stream/chart_residency.h"
#include "client/stream/layer_decoder.h"
#include "client/stream/map_residency.h"
#include "client/stream/residency_counters.h"
#include "client/stream/warnings.h"

namespace citystream::client {

/// One thread. A layer is a prefix of steps; a step is accepted when its checksum is right and enters the store when
/// the codec has checked it. Bytes that fail either are dropped: the first time they are asked for again, the second
/// time the prefix before them is all there is.
class TileResidency {
  public:
    TileResidency(const DirectoryCache& directory, CityKnowledge& knowledge, LayerCache& cache, HostMemory& host,
                  MapResidency& maps, ChartResidency& charts, Warnings& warnings, ResidencyCounters& counters,
                  bool decode)
        : directory_(directory),
          knowledge_(knowledge),
          cache_(cache),
          host_(host),
          maps_(maps),
          charts_(charts),
          warnings_(warnings),
          counters_(counters),
          decode_(decode) {}

    /// Host memory for what is learnt of a tile of the directory.
    static uint64_t bytes_per_tile();
    /// Follows the directory's growth.
    void grow();

    /// Takes the bytes of steps [from, to) of a layer.
    void accept_layer(NodeIndex node, tiles::tileset::Layer layer, uint32_t from, uint32_t to,
                      std::span<const std::byte> bytes);

    /// Brings what is received of the tile's wanted prefixes to the store, but light (light_residency.h); atlas first,
    /// for it knows the charts. A mesh that is wanted without its atlas is not checked against it before that comes.
    void upload(const SelectedTile& wanted);

    /// A step of a layer turned out to be bad.
    void damaged(CachedLayer& layer, NodeIndex node, tiles::tileset::Layer kind, uint32_t step, const std::string& why);

    /// Mesh and atlas have at least their first steps in the store, and its shared charts something to show (a tile
    /// without mesh has nothing to draw).
    bool drawable(NodeIndex node);
    bool has_mesh(NodeIndex node) const {
        return !directory_.node(node).record->steps(tiles::tileset::Layer::kMesh).empty();
    }
    /// The tile with the steps of mesh, atlas and shared charts that `chosen` has (null: all of them), or fewer where
    /// fewer are in the store. Marks its layers as drawn.
    TileDraw draw(NodeIndex node, const SelectedTile* chosen);
    /// The first `steps` steps of its mesh alone, or fewer where fewer are in the store. Nothing: none are. Marks it as
    /// drawn.
    std::optional<TileDraw> draw_mesh(NodeIndex node, uint32_t steps);
    /// Adds its facades to a draw, each with the level of its map that comes next to the wanted one (`levels`: by
    /// placement), and marks what they need as drawn. False, and nothing is added: its placements or all levels of a
    /// map of them are not in the store.
    bool add_relief(NodeIndex node, std::span<const PlacementLevel> levels, TileDraw& out);

  private:
    struct Facts {
        bool charts_known = false;
        codec::atlas::AtlasForm atlas_form = codec::atlas::AtlasForm::kCharts;
        uint32_t chart_count = kAnyChart;
        uint32_t coarsest_step_mip = 0;  ///< finest mip of the atlas' first step
        std::vector<codec::mesh::MeshRange> mesh_ranges;
    };
    NameLimits limits_of(NodeIndex node) const;
    void learn_facade_maps(NodeIndex node);
    bool learn_shared_charts(NodeIndex node, std::span<const std::byte> first_step);
    void learn_chart_boxes(NodeIndex node, std::span<const std::byte> first_step);
    void add_atlas(NodeIndex node, CachedLayer& atlas, const SelectedTile* chosen, TileDraw& out);
    void upload_layer(const SelectedTile& tile, tiles::tileset::Layer layer);
    bool decode_to_store(CachedLayer& entry, NodeIndex node, tiles::tileset::Layer layer, uint32_t steps);
    bool decode_mesh_to_store(CachedLayer& entry, NodeIndex node, uint32_t steps);
    Status store_mesh(CachedLayer& entry, const codec::mesh::MeshLayer& mesh, uint64_t bytes);
    void remember_atlas(NodeIndex node, uint32_t steps, const LayerFacts& facts);
    TileDraw draw_of(NodeIndex node, CachedLayer& mesh, uint32_t steps);

    const DirectoryCache& directory_;
    CityKnowledge& knowledge_;
    LayerCache& cache_;
    HostMemory& host_;
    MapResidency& maps_;
    ChartResidency& charts_;
    Warnings& warnings_;
    ResidencyCounters& counters_;
    bool decode_;
    std::vector<Facts> facts_;
};

}  // namespace citystream::client
