// The large surfaces of tiles that are near: what hides the rest of the city (client/select/depth_picture.h). None of
// those that show charts with alpha: one can see through them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "client/cache/host_memory.h"
#include "client/cache/layer_cache.h"
#include "client/select/city_knowledge.h"
#include "client/select/depth_picture.h"
#include "codec/mesh/mesh_content.h"

namespace citystream::client {

/// Triangles of less area hide nothing worth their memory; of a tile with more than kMostOccluders the largest are
/// kept.
inline constexpr double kLeastOccluderMetres2 = 0.25;
inline constexpr uint32_t kMostOccluders = 8192;

/// Keeps those of tiles that were asked for lately. One thread.
class Occluders {
  public:
    Occluders(const DirectoryCache& directory, const CityKnowledge& knowledge, LayerCache& cache, HostMemory& host)
        : directory_(directory), knowledge_(knowledge), cache_(cache), host_(host) {}

    /// Forgets tiles that none of the last kKeptUpdates updates has drawn.
    void begin_update();
    /// Adds the triangles of a tile drawn with `steps` steps of its mesh to a picture; its dressed ones only where it
    /// is drawn flat. Decodes the mesh from its wire bytes the first time. Nothing is added where those, or host memory
    /// for the triangles, are not there.
    void draw(NodeIndex node, uint32_t steps, bool flat, DepthPicture& picture);

  private:
    static constexpr uint64_t kKeptUpdates = 30;
    struct Surfaces {
        std::vector<std::array<int32_t, 9>> triangles;  ///< tile-relative grid units
        uint32_t dressed_begin = 0;                     ///< the first of the dressed ones
        uint32_t steps = 0;                             ///< of the mesh that they are from
        uint64_t drawn_by = 0;
        uint64_t bytes() const { return sizeof(Surfaces) + 64 + triangles.size() * sizeof(triangles[0]); }
    };
    Surfaces* surfaces_of(NodeIndex node, uint32_t steps);
    void take_large(const codec::mesh::MeshContent& mesh, uint32_t steps, NodeIndex node, bool dressed,
                    std::vector<std::array<int32_t, 9>>& out) const;

    const DirectoryCache& directory_;
    const CityKnowledge& knowledge_;
    LayerCache& cache_;
    HostMemory& host_;
    std::map<NodeIndex, Surfaces> tiles_;
    uint64_t update_ = 0;
};

/// Adds the back of a facade's relief: whoever looks at that through an opaque map sees relief before it.
/// `origin`: of the tile; `depth` metres behind the wall.
void draw_back_of(const codec::facade::Placement& wall, const GridPoint& origin, double depth, DepthPicture& picture);

}  // namespace citystream::client
