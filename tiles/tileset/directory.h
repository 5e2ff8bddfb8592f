// The directory of a city in memory: manifest, tile records with step tables, facade and chart dictionary index.
// tileset_json.h and subtree.h hold its 3D Tiles 1.1 form. FORMAT.md beside this file lists every entry of an archive.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "codec/atlas/shared_chart.h"
#include "codec/facade/facade_levels.h"
#include "codec/grid.h"

namespace citystream::tiles::tileset {

enum class Layer : uint8_t { kMesh, kFacade, kAtlas, kRadiance };
inline constexpr size_t kLayerCount = 4;
inline constexpr std::array<const char*, kLayerCount> kLayerNames = {"mesh", "facade", "atlas", "radiance"};

/// Implicit quadtree coordinates: level 0 is the root; x east, y north. The tile's square starts at origin + (x, y) *
/// side(level).
struct TileAddress {
    uint32_t level = 0, x = 0, y = 0;
    friend auto operator<=>(const TileAddress&, const TileAddress&) = default;
    TileAddress child(uint32_t i) const { return {level + 1, 2 * x + (i & 1), 2 * y + (i >> 1)}; }
    TileAddress parent() const { return {level - 1, x / 2, y / 2}; }
};

/// One step of a layer, as the directory lists it.
struct StepRecord {
    uint64_t end = 0;  ///< wire bytes of the prefix that ends with this step (offset of its end in the layer's entry)
    uint32_t decoded_bytes = 0;  ///< of this step alone; a multiple of 4
    float error = 0;             ///< of the prefix; see codec/layer_steps.h for the unit
    uint64_t checksum = 0;       ///< XXH3-64 of this step's wire bytes
    friend bool operator==(const StepRecord&, const StepRecord&) = default;
};

/// Axis-aligned bounds in metres, relative to Manifest::origin (x, y) and absolute in z.
struct Bounds {
    std::array<double, 3> min{}, max{};
    friend bool operator==(const Bounds&, const Bounds&) = default;
};

struct TileRecord {
    TileAddress address;
    Bounds bounds;              ///< of the tile's content and of all tiles below it
    float geometric_error = 0;  ///< metres: error of the tile drawn with all its mesh steps
    float flat_facade_error =
        0;  ///< metres: error of drawing its facades flat (twice the greatest relief depth); 0 without facades
    int64_t base_height = 0;                                  ///< grid units: z that tile-relative positions count from
    uint32_t facade_maps = 0;                                 ///< distinct dictionary maps its facade layer uses
    std::array<std::vector<StepRecord>, kLayerCount> layers;  ///< empty = the tile has no such layer
    friend bool operator==(const TileRecord&, const TileRecord&) = default;

    const std::vector<StepRecord>& steps(Layer layer) const { return layers[static_cast<size_t>(layer)]; }
    std::vector<StepRecord>& steps(Layer layer) { return layers[static_cast<size_t>(layer)]; }
};

/// One level of a facade map: a payload in the maps entry (codec/facade/facade_wire.h).
struct FacadeLevelRecord {
    uint64_t end = 0;              ///< in the maps entry; it begins where the level before ends, or the map before
    uint32_t resident_bytes = 0;   ///< expanded; a multiple of 4
    uint32_t checksum = 0;         ///< low half of XXH3-64 of the payload
    uint16_t texel_cm = 1;         ///< what is smaller may be missing; 1: exact
    float displacement_error = 0;  ///< metres: greatest difference from the exact map
    friend bool operator==(const FacadeLevelRecord&, const FacadeLevelRecord&) = default;
};

/// One facade map of the dictionary, coarse to fine.
struct FacadeMapRecord {
    uint16_t width = 0, height = 0;  ///< texels of 1 cm
    int16_t depth_min_mm = 0, depth_max_mm = 0;
    uint32_t level_count = 0;  ///< 1..kMostFacadeLevels
    std::array<FacadeLevelRecord, codec::facade::kMostFacadeLevels> level{};
    std::span<const FacadeLevelRecord> levels() const { return {level.data(), level_count}; }
    friend bool operator==(const FacadeMapRecord&, const FacadeMapRecord&) = default;
};

/// One level of a shared chart: a payload in the levels entry (codec/atlas/shared_chart.h).
struct ChartLevelRecord {
    uint64_t begin = 0;
    uint32_t bytes = 0;
    uint64_t end() const { return begin + bytes; }
    friend bool operator==(const ChartLevelRecord&, const ChartLevelRecord&) = default;
};

/// One chart of the city's chart dictionary, coarse to fine.
struct ChartRecord {
    uint16_t width = 0, height = 0;   ///< texels of the finest mip, 1..8192
    uint8_t flags = 0;                ///< ATLAS_CHART_REPEAT_U, _V, ATLAS_CHART_ALPHA
    std::array<uint8_t, 3> colour{};  ///< sRGB mean: what is shown while it cannot be had
    uint32_t level_count = 0;         ///< codec::atlas::atlas_step_count(width, height, flags)
    std::array<ChartLevelRecord, codec::atlas::kMostChartLevels> level{};
    std::span<const ChartLevelRecord> levels() const { return {level.data(), level_count}; }
    friend bool operator==(const ChartRecord&, const ChartRecord&) = default;
};

struct Manifest {
    std::string title;
    int32_t epsg = 0;
    GridPoint origin;  ///< grid units, absolute: minimum corner of the root square (x, y multiples of 128 m); z = 0
    uint32_t root_side_log2 = 7;  ///< the root square's side is 2^this metres
    uint32_t levels = 1;          ///< available levels of the quadtree
    uint32_t subtree_levels = 4;
    Bounds extent;                    ///< of the city, relative to origin in x, y
    double root_geometric_error = 0;  ///< metres: error of drawing nothing
    uint64_t buildings = 0, triangles = 0, facades = 0, tiles = 0;
    uint64_t greatest_subtree_bytes = 0;  ///< no subtree file is larger; 0: not known (archives written before it was)
    std::array<bool, kLayerCount> has_layer{};
    std::array<uint64_t, kLayerCount> wire_bytes{}, decoded_bytes{};
    uint64_t facade_map_count = 0;
    bool facades_made_up = false;     ///< facades are inventions on walls of a real city (--dress)
    uint64_t facade_index_bytes = 0;  ///< of the entry facades/index (one zstd frame)
    uint64_t facade_index_decoded_bytes = 0;
    uint64_t facade_index_checksum = 0;
    bool pages_or_alpha = false;      ///< a tile's atlas is in pages, or a chart has alpha
    uint64_t shared_chart_count = 0;  ///< 0: no tile names a shared chart, and there are no entries charts/
    uint64_t chart_index_bytes = 0;   ///< of the entry charts/index (one zstd frame)
    uint64_t chart_index_decoded_bytes = 0;
    uint64_t chart_index_checksum = 0;
    uint64_t chart_levels_bytes = 0;  ///< of the entry charts/levels
    /// Of the layer radiance, where the city has it: texels on a side of the source cube (1..64), local directions on a
    /// side (1..32), spacing of the leaves' lattices in metres (1..64).
    uint32_t radiance_texels_across = 32, radiance_local_across = 8, radiance_lattice_metres = 4;
    std::string build_options;  ///< what the builder was asked for, for people
    friend bool operator==(const Manifest&, const Manifest&) = default;

    double side_metres(uint32_t level) const {
        return static_cast<double>(int64_t{1} << root_side_log2) / static_cast<double>(int64_t{1} << level);
    }
    /// Absolute grid position of a tile's minimum corner; z is the record's base height.
    GridPoint tile_origin(const TileRecord& record) const;
};

/// Entry names. Paths are relative to tileset.json.
std::string layer_path(Layer layer, TileAddress address);  ///< "tiles/{level}/{x}/{y}.mesh"
std::string subtree_path(TileAddress subtree_root);        ///< "subtrees/{level}/{x}/{y}.subtree"
inline constexpr const char* kTilesetPath = "tileset.json";
inline constexpr const char* kFacadeIndexPath = "facades/index";
inline constexpr const char* kFacadeMapsPath = "facades/maps";
inline constexpr const char* kChartIndexPath = "charts/index";
inline constexpr const char* kChartLevelsPath = "charts/levels";
inline constexpr const char* kPreviewPath = "preview.png";

/// XXH3-64 as used by every checksum of the directory.
uint64_t checksum_of(const void* bytes, size_t size);

}  // namespace citystream::tiles::tileset
