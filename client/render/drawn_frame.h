// What a frame draws: its tiles, front to back, with what the shaders are told of each. frame_tiles.h makes it,
// frame_passes.h the pipelines that it needs, frame_recorder.h the commands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "client/render/chart_coordinates.h"
#include "client/render/frame.h"
#include "client/render/light_layout.h"
#include "client/render/mesh_draw_layout.h"
#include "client/render/pipelines.h"

namespace citystream::client {

/// A picture, lit by its light or not, or one of the sun's shadow maps.
enum class FrameKind { kPicture, kLit, kShadow };

inline bool has_facades(const TileDraw& tile) {
    return tile.facade != kNoLayer && !tile.map_of_placement.empty();
}

struct DrawnTile {
    const TileDraw* tile = nullptr;
    TileConstants constants{};
    RadianceDraw radiance{};  ///< in a lit frame
    uint32_t casters = 0;     ///< one bit each: those that its placements' maps need
    bool relief = false;      ///< its facades are lit by local light
    PassVariant mesh;
    const std::vector<ChartRun>* runs = nullptr;  ///< one draw each; null: one for all triangles
    size_t first_strip = 0;                       ///< of StripRanges: its first range of strip code

    /// Of one of its ranges. Runs begin at any triangle: their prisms share no vertices.
    PassVariant mesh_of(const MeshDrawConstants& range) const {
        PassVariant variant = mesh;
        variant.mesh_form = range.form & ~(RESIDENT_FLAG_DRESSED << 8);
        if ((range.form & 255) == RESIDENT_KIND_PRISMS && runs == nullptr) variant.mesh_form |= MESH_FORM_SHARED;
        return variant;
    }
    PassVariant facade() const {
        PassVariant variant = mesh;
        variant.transport = {};
        variant.alpha_test = false;
        variant.mesh_form = MESH_FORM_ANY;
        variant.relief = relief;
        return variant;
    }
    PassVariant occluder() const { return {mesh.reading, {}, {}, false, {}}; }
    uint32_t placements() const { return static_cast<uint32_t>(tile->map_of_placement.size()); }
};

struct DrawnFrame {
    FrameKind kind = FrameKind::kPicture;
    FrameConstants constants{};
    FacadeTableHead facades{};  ///< of each tile's facade table
    std::vector<DrawnTile> tiles;

    bool has_facades() const {
        for (const DrawnTile& drawn : tiles) {
            if (drawn.casters != 0) return true;
        }
        return false;
    }
    uint64_t mesh_ranges() const {
        uint64_t ranges = 0;
        for (const DrawnTile& drawn : tiles) ranges += drawn.tile->mesh_ranges.size();
        return ranges;
    }
};

}  // namespace citystream::client
