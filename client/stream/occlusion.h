// What near tiles hide of a view: makes the selector choose near to far, each time past what the tiles chosen before
// hide (client/README.md, "What is hidden").
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "client/select/depth_picture.h"
#include "client/select/selection.h"
#include "client/stream/occluders.h"
#include "client/stream/tile_residency.h"

namespace citystream::client {

class Occlusion {
  public:
    Occlusion(const DirectoryCache& directory, CityKnowledge& knowledge, LayerCache& cache, HostMemory& host,
              TileResidency& residency, Selector& selector)
        : directory_(directory),
          knowledge_(knowledge),
          cache_(cache),
          residency_(residency),
          selector_(selector),
          occluders_(directory, knowledge, cache, host) {}

    /// Once a frame.
    void begin_update() { occluders_.begin_update(); }
    /// A picture of nothing, and a near horizon. Not for tolerances of several pixels, which would leave little of
    /// anything that hides: then as look_everywhere().
    void begin(const Camera& camera, double tolerance_pixels);
    /// The chosen tiles, which are all here, hide some of those farther away, and the horizon recedes. False: nothing
    /// lies beyond it.
    bool look_farther(const Selection& selection);
    /// For views of which not all is here: nothing may be left out, as what would hide it may not be drawn.
    void look_everywhere();
    /// Whether something may have been left out.
    bool is_on() const { return horizon_ < std::numeric_limits<double>::infinity(); }

  private:
    void draw(const SelectedTile& tile, double tolerance);
    void draw_relief(NodeIndex node, const TileDraw& draw);

    const DirectoryCache& directory_;
    CityKnowledge& knowledge_;
    LayerCache& cache_;
    TileResidency& residency_;
    Selector& selector_;
    Occluders occluders_;
    DepthPicture picture_;
    double horizon_ = std::numeric_limits<double>::infinity();  ///< metres
    std::vector<uint8_t> drawn_;                                ///< by node: to the picture
};

}  // namespace citystream::client
