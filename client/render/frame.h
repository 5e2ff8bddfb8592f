// What one frame is made of: the seam between the streamer and the renderers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "client/cache/layer_store.h"
#include "codec/atlas/atlas_form.h"
#include "codec/mesh/mesh_resident.h"
#include "codec/mesh/precision.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

/// One level of a facade map that a tile draw uses: `map` is the dictionary index that placements name.
struct FacadeMapBinding {
    uint32_t map = 0;
    LayerId layer = kNoLayer;
    uint32_t level = 0;  ///< of the map, 0 the coarsest
};

/// A chart of a tile that lies in the city's dictionary.
struct SharedChartBinding {
    uint32_t chart_in_tile = 0;
    uint32_t chart = 0;        ///< number in the dictionary
    LayerId layer = kNoLayer;  ///< kNoLayer: `colour` is shown
    uint32_t finest_mip = 0;   ///< that its levels hold
    uint32_t levels = 0;       ///< that hold it
    uint32_t colour = 0;       ///< r | g << 8 | b << 16
    float least_mip = 0;       ///< no finer one is shown (client/select/mip_clamp.h)
};

/// One tile to draw, with the prefixes that are resident.
struct TileDraw {
    tiles::tileset::TileAddress address;  ///< for who counts what is drawn
    std::array<double, 3> origin{};       ///< metres, absolute: what tile-relative positions count from
    LayerId mesh = kNoLayer;
    uint32_t mesh_steps = 0;                          ///< on show
    std::vector<codec::mesh::MeshRange> mesh_ranges;  ///< of its triangles; dressed ones are not drawn with facades
    /// What the frame grants each vertex by its distance, the same for all tiles, and what is left out of this tile at
    /// least: what the step that was chosen drops, though finer ones may be here (client/select/position_rule.h).
    codec::mesh::DropRule drop_rule{~0U, 0};  ///< grants nothing
    uint32_t mesh_least_dropped = 0;
    LayerId atlas = kNoLayer;  ///< kNoLayer: flat grey
    codec::atlas::AtlasForm atlas_form = codec::atlas::AtlasForm::kCharts;
    uint32_t atlas_finest_mip = 0;                  ///< that is resident
    float atlas_least_mip = 0;                      ///< no finer one of its own charts is shown (mip_clamp.h)
    uint32_t chart_count = 0;                       ///< of the atlas; where it names shared charts
    std::vector<SharedChartBinding> shared_charts;  ///< all that the atlas names
    bool alpha_test = false;                        ///< some chart that triangles show has alpha
    LayerId facade = kNoLayer;  ///< when set, dressed triangles are not drawn; placements are ray cast instead
    std::vector<FacadeMapBinding> facade_maps;
    std::vector<uint32_t> map_of_placement;  ///< index in facade_maps, of every placement of the layer
    LayerId radiance = kNoLayer;             ///< checked words (RadianceLayerView); where a light is set
    /// Grid units: the tile's origin from that of the tile whose receivers these are, itself or an ancestor.
    std::array<int32_t, 3> radiance_offset{};
};

/// 8-bit RGBA, top row first.
struct FrameImage {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgba;
};

/// What a frame drew. Tiles whose atlas is in pages, those of them that could not take the transport asked for, and the
/// memory of all coordinates that transports made (chart_transport.h).
struct FrameCounts {
    uint32_t mesh_draws = 0, page_tiles = 0, fallback_tiles = 0;
    uint64_t coordinate_bytes = 0;
    uint32_t strip_rounds = 0;             ///< one where all strip code that is drawn fits its memory
    uint64_t decoded_strip_triangles = 0;  ///< that the frame missed
    uint32_t radiance_tiles = 0;           ///< whose light passes ran
    uint64_t radiance_receivers = 0;       ///< of those tiles
    /// Of relief that is lit by local light (RendererOptions::meso): the masks and BTFs that are there, the memory of
    /// these and of local light, and facades by how they are drawn, at the middle of each.
    uint64_t relief_masks = 0, relief_mask_bytes = 0, btfs = 0, btf_bytes = 0, local_light_bytes = 0;
    uint64_t facades_cast = 0, facades_by_btf = 0, facades_by_mean = 0;
};

/// Time by stage in milliseconds; GPU stages from timestamps.
struct FrameTimings {
    double gpu_mesh_ms = 0, gpu_facade_ms = 0, gpu_total_ms = 0, cpu_record_ms = 0, readback_ms = 0;
    /// In frames with a light: its passes, which the mesh stage has in it; the sun's shadow maps before the frame,
    /// which no other time has, by the host's clock.
    double gpu_light_ms = 0, shadow_ms = 0;
};

}  // namespace citystream::client
