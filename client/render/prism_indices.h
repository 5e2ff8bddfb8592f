// Indices that draw the prisms of a range by vertices that the two triangles of a wall share, so that a vertex shader
// runs for four corners of a wall, not six. Vertices of a prism of n points: of each wall the corners p0, q0, q1, p1
// (codec/mesh/RESIDENT.md), then three of each triangle of the top and of the floor. Vertex numbers of the prisms of a
// range follow each other.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "client/render/buffer.h"
#include "client/render/mesh_draw_layout.h"

namespace citystream::client {

/// Of the triangles of `count` prisms, in their order: walls have 2 * `points` of them.
std::vector<uint32_t> prism_indices(uint32_t points, uint32_t triangles, uint32_t count);

/// Index buffers by the sizes of prisms, made when first drawn. Errors: VulkanError.
class PrismIndices {
  public:
    explicit PrismIndices(const Device& device) : device_(device) {}
    PrismIndices(const PrismIndices&) = delete;
    PrismIndices& operator=(const PrismIndices&) = delete;
    ~PrismIndices();

    /// Draws so many triangles of the range; of `most` indices a draw, or a prism's. Returns the number of draws. A
    /// record of zeros draws nothing.
    uint32_t record(VkCommandBuffer commands, const MeshDrawConstants& draw, uint32_t triangles, uint32_t most);
    uint64_t bytes() const { return bytes_; }

  private:
    struct Made {
        Buffer buffer;
        uint32_t prisms = 0;
    };
    const Made& made_for(const MeshDrawConstants& draw, uint32_t most);

    const Device& device_;
    std::map<std::pair<uint32_t, uint32_t>, Made> made_;  ///< by points and triangles
    uint64_t bytes_ = 0;
};

}  // namespace citystream::client
