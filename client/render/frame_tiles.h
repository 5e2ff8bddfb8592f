// Makes what a frame draws (drawn_frame.h) from its tiles, and writes the tables that their constants refer to
// (frame_constants.h) into a mapped buffer. Nothing may be in flight when tables are written. Not thread safe.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "client/render/coordinate_layers.h"
#include "client/render/drawn_frame.h"
#include "client/render/facade_map_facts.h"
#include "client/render/facade_renderer.h"
#include "client/render/frame_constants.h"
#include "client/render/frame_lighting.h"
#include "client/render/relief_light.h"
#include "client/render/strip_ranges.h"

namespace citystream::client {

class FrameTiles {
  public:
    /// What tables are made from; all of it outlives them.
    struct Sources {
        const Device* device = nullptr;
        SlotPool* pool = nullptr;
        StripRanges* strips = nullptr;
        CoordinateLayers* coordinates = nullptr;
    };
    FrameTiles(const Sources& sources, FacadeRenderer renderer, const codec::atlas::FacadeTint& tint)
        : sources_(sources), renderer_(renderer), tint_(tint) {}
    ~FrameTiles() { destroy_buffer(*sources_.device, tables_); }
    FrameTiles(const FrameTiles&) = delete;
    FrameTiles& operator=(const FrameTiles&) = delete;

    /// The words that begin a layer: of a facade map its facts are remembered.
    void learn(LayerId layer, std::span<const uint32_t> words);
    /// A facade map of which too few words were learnt.
    bool is_partial(LayerId layer) const {
        return layer < map_facts_.size() && map_facts_[layer].form != 0 && map_facts_[layer].size[0] == 0;
    }

    /// Of facade maps, by layer.
    std::span<const FacadeMapFacts> map_facts() const { return map_facts_; }

    /// `tiles` outlive the frame. `lighting`: where the kind is kLit; `relief`: with light on relief, or null. `head`:
    /// begins every tile's facade table. Strip code is added to the sources' strips, which begin a frame; `counts`
    /// begin anew. Error: what FrameTables and StripRanges report.
    Result<DrawnFrame> write(const Camera& camera, std::span<const TileDraw> tiles, FrameKind kind,
                             const FrameLighting* lighting, const ReliefLight* relief, const FacadeTableHead& head,
                             FrameCounts& counts);
    uint64_t bytes() const { return tables_.bytes; }

  private:
    uint32_t casters_of(const TileDraw& tile) const;
    Result<DrawnTile> add(FrameTables& tables, const TileDraw& tile, const CameraCell& cell, FrameKind kind,
                          const FrameLighting* lighting, const ReliefLight* relief, FrameCounts& counts);
    void reserve(uint64_t words);

    Sources sources_;
    FacadeRenderer renderer_;
    codec::atlas::FacadeTint tint_;
    std::vector<FacadeMapFacts> map_facts_;  ///< by layer
    Buffer tables_;
};

}  // namespace citystream::client
