// What draws of mesh layers need to know of the words before they run: mesh_draw_layout.h for each of their ranges.
// Read from a layer's head when it arrives, so that neither a frame nor a corner has to.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "client/cache/layer_store.h"
#include "client/render/mesh_draw_layout.h"

namespace citystream::client {

/// Of all ranges of a mesh layer: `words` are the layer's, from the first to its positions' bins at least. Words that
/// are no mesh layer, and ranges that are not in the words, have none. Any words will do: offsets are taken as they
/// are. O(ranges).
std::vector<MeshDrawConstants> mesh_draw_constants(std::span<const uint32_t> words);

/// By layer. Not thread safe.
class MeshDraws {
  public:
    /// The words that begin a layer, of any kind; once more replaces what was known.
    void learn(LayerId layer, std::span<const uint32_t> words);
    /// A mesh layer of which too few words were learnt.
    bool is_partial(LayerId layer) const;
    /// The layer's positions get other bits.
    void set_level(LayerId layer, uint32_t level);
    void forget(LayerId layer) { layers_.erase(layer); }
    /// All zero of a range that nobody knows.
    MeshDrawConstants of(LayerId layer, uint32_t range) const;

  private:
    struct Layer {
        std::vector<MeshDrawConstants> draws;
        bool is_partial = false;
    };
    std::map<LayerId, Layer> layers_;
};

}  // namespace citystream::client
