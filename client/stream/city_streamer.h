// From a camera to the tiles to draw: reads the directory, selects prefixes by the one rule, requests what is missing,
// keeps what fits the budgets.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/cache/layer_store.h"
#include "client/render/frame.h"
#include "client/select/camera.h"
#include "client/select/facade_dictionary.h"
#include "client/stream/fetcher.h"
#include "codec/facade/facade_form.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

class DirectoryPool;

struct StreamerOptions {
    double tolerance_pixels = 1.0;
    std::optional<double> texel_tolerance_pixels;     ///< of texels (Selector); empty: as all errors
    std::optional<double> position_tolerance_pixels;  ///< of positions; empty: kPositionShare of all errors
    /// Relative radiance that a receiver's light may be off. Empty: radiance layers are not wanted; nothing of them is
    /// requested, decoded or counted.
    std::optional<double> light_tolerance;
    uint64_t host_budget_bytes = 1ull << 30;  ///< wire bytes kept, decode buffers, directory: hard
    bool wait_for_selection =
        true;  ///< offline mode: update() returns when the frame has all it asked for (or it failed for good)
    /// What near surfaces hide is neither fetched nor drawn (client/select/depth_picture.h). Needs decoding; only in
    /// waiting mode, where a frame waits for what its camera's movement reveals.
    bool occlusion = true;
    bool decode = true;  ///< false (load client): bytes are counted and checked, not decoded
    /// Texels that may be larger than a pixel become finer with the distance and not all at once (mip_clamp.h).
    bool continuous_mips = true;
    ReliefOptions relief;
    std::optional<codec::facade::FacadeForm>
        facade_form;           ///< that the renderer reads (form_for); empty: maps stay as they arrive
    bool facade_boxes = true;  ///< with them: raw words for a renderer that steps through boxes
    uint32_t map_threads = 0;  ///< that expand and convert facade maps; 0: one a core
    codec::radiance::MatrixForm matrix_form = codec::radiance::MatrixForm::kBiclusters;  ///< of radiance layers
    double matrix_error = 0;               ///< that their rows may have (MatrixOptions::row_error)
    uint32_t light_threads = 0;            ///< that decode them (LightOptions)
    uint32_t max_requests_in_flight = 64;  ///< the rest waits in the streamer, where each update orders it anew
    std::shared_ptr<DirectoryPool>
        directory_pool;  ///< share parsed directories among many streamers of one city; null: one of its own
    const std::atomic<bool>* stop = nullptr;  ///< set by a signal handler: an update that waits returns early
};

/// Counters of one update and running totals of the whole flight (see fly's --stats page in README for each field's
/// meaning).
struct StreamerFrame {
    uint64_t tiles_drawn = 0;   ///< tiles in the returned list
    uint64_t tiles_wanted = 0;  ///< tiles that the one rule chose
    uint64_t tiles_hidden = 0;  ///< tiles in the view's frustum that it left out with all below, as others hide them
    uint64_t tiles_missing =
        0;  ///< chosen tiles that are not drawn as chosen: an ancestor, descendants or nothing stands in for them
    uint64_t requests = 0, wire_bytes = 0, decoded_bytes = 0;         ///< of this update
    uint64_t cache_hits = 0, cache_misses = 0;                        ///< layer prefixes found resident / not
    uint64_t relief_tiles = 0, flat_tiles = 0;                        ///< drawn tiles with facades: ray cast, or flat
    std::array<uint64_t, tiles::tileset::kLayerCount> layer_bytes{};  ///< of wire_bytes: layers of tiles
    std::array<uint64_t, codec::facade::kMostFacadeLevels> facade_maps{};  ///< in the store after it, by level
    uint64_t facade_index_bytes = 0, facade_map_bytes = 0;                 ///< of wire_bytes: the dictionary
    uint64_t shared_charts = 0;                                            ///< in the store after it
    uint64_t chart_index_bytes = 0, chart_level_bytes = 0;                 ///< of wire_bytes: the chart dictionary
    uint64_t map_conversions = 0, map_conversions_refused = 0;             ///< to the renderer's form, or not to it
    double map_conversion_ms = 0;                                          ///< all cores together
    uint64_t light_tiles = 0;                                              ///< drawn with a radiance layer of their own
    uint64_t light_inherited_tiles = 0;                                    ///< with that of an ancestor
    uint64_t light_layers = 0;                                             ///< radiance layers in the store after it
    uint64_t light_bytes = 0;                                              ///< that they take there
    uint64_t light_decodes = 0;                                            ///< prefixes of them
    double light_decode_ms = 0;                                            ///< all cores together
    double light_row_error = 0;                                            ///< of the worst row decoded
    uint64_t light_quarters_dropped = 0;                                   ///< of the matrices decoded
    uint64_t caster_tiles = 0;                                             ///< in casters()
    double light_tolerance_used = 0;                                       ///< relative radiance; 0: no light is wanted
    uint64_t gpu_bytes_used = 0;                                           ///< slots in use, in bytes
    uint64_t host_bytes_used = 0;      ///< highest value during this update: held and reserved
    uint64_t host_bytes_held = 0;      ///< its highest part that is really held
    uint64_t host_bytes_reserved = 0;  ///< its highest part that requests under way may bring at most
    double tolerance_used = 0;         ///< pixels: grows above the option when a budget does not hold the selection
    double achieved_error_pixels = 0;  ///< largest projected error of what is drawn: the next two together
    double geometry_error_pixels = 0;  ///< its largest part that is the geometry's own
    double position_error_pixels = 0;  ///< its largest part that comes from bits of positions left out
    double position_bits = 0;          ///< of a coordinate, of the steps shown: average of triangles drawn
    double full_position_bits = 0;     ///< the same with nothing left out
    double select_ms = 0, wait_ms = 0, decode_ms = 0;
    std::vector<std::string> warnings;  ///< damaged or missing tiles, new in this update
    /// Of wire_bytes: all that pictures take, tiles' own and shared ones with their index.
    uint64_t atlas_bytes() const {
        return layer_bytes[static_cast<size_t>(tiles::tileset::Layer::kAtlas)] + chart_index_bytes + chart_level_bytes;
    }
};

class CityStreamer {
  public:
    /// Reads tileset.json and the root subtree through the fetcher. Both outlive the streamer.
    static Result<std::unique_ptr<CityStreamer>> open(Fetcher& fetcher, LayerStore& store,
                                                      const StreamerOptions& options);
    virtual ~CityStreamer() = default;
    virtual const tiles::tileset::Manifest& manifest() const = 0;
    /// Advances to a camera; the result stays valid until the next call.
    virtual const std::vector<TileDraw>& update(const Camera& camera, StreamerFrame& frame) = 0;
    /// Of updates from here on: a unit vector to the sun whose shadows are drawn. Nothing, as in the beginning, or one
    /// that is not above the horizon: no tile out of view is asked for.
    virtual void set_sun(std::optional<std::array<double, 3>> to_sun) = 0;
    /// Of the last update: tiles that are not drawn and whose shadows can fall into the view, with their meshes alone.
    /// What the budgets do not hold beside the view is left out.
    virtual const std::vector<TileDraw>& casters() const = 0;
    virtual void set_tolerance(double pixels) = 0;
};

}  // namespace citystream::client
