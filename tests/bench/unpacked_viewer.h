// What a renderer without codecs does with the meshes of a city: float positions and normals, a colour, 32-bit indices,
// all of them vertex attributes that the hardware fetches. Fragments are shaded by the client's own mesh pass, so that
// frames differ in what vertices cost alone.
#pragma once

#include <memory>
#include <span>

#include "client/render/frame.h"
#include "client/select/camera.h"
#include "codec/mesh/mesh_tile.h"
#include "codec/result.h"

namespace citystream::bench {

struct UnpackedVertex {
    float position[3];  ///< metres from the tile's origin
    float normal[3];
    uint32_t colour;  ///< r | g << 8 | b << 16
    friend auto operator<=>(const UnpackedVertex&, const UnpackedVertex&) = default;
};
static_assert(sizeof(UnpackedVertex) == 28);

struct UnpackedTile {
    std::array<double, 3> origin{};  ///< metres
    std::vector<UnpackedVertex> vertices;
    std::vector<uint32_t> indices;
};

/// Corners that are alike in all are one vertex; images are grey.
UnpackedTile unpack(const codec::mesh::MeshTile& mesh, const std::array<double, 3>& origin);

class UnpackedViewer {
  public:
    virtual ~UnpackedViewer() = default;
    /// The device is the renderer's own default.
    static Result<std::unique_ptr<UnpackedViewer>> create(std::span<const UnpackedTile> tiles, uint32_t width,
                                                          uint32_t height);
    /// All tiles in their order, one draw each.
    virtual Result<client::FrameImage> draw(const client::Camera& camera, client::FrameTimings& timings) = 0;
    virtual uint64_t geometry_bytes() const = 0;  ///< of vertices and indices
    virtual bool on_processor() const = 0;        ///< a software device
};

}  // namespace citystream::bench
