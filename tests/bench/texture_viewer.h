// What a viewer without an atlas does: a BC1 texture with all its mips and the hardware's trilinear sampler for each
// picture, vertex and index buffers of floats, and a descriptor set bound before each draw. Everything is resident, and
// nothing is culled. Commands are recorded anew for every frame, as ours are.
#pragma once

#include <memory>

#include "client/render/frame.h"
#include "codec/result.h"
#include "tests/bench/textured_city.h"

namespace citystream::bench {

enum class TextureOrder {
    kByBuilding,  ///< as the thesis's "VBO without atlas": a bind and a draw for each run
    kByPicture,   ///< all buildings' triangles sorted by picture beforehand: one draw a picture
};

class TextureViewer {
  public:
    virtual ~TextureViewer() = default;
    /// The device is the renderer's own default.
    static Result<std::unique_ptr<TextureViewer>> create(const TexturedCity& city, TextureOrder order, uint32_t width,
                                                         uint32_t height);
    /// The camera's position counts from the city's corner.
    virtual Result<client::FrameImage> draw(const client::Camera& camera) = 0;
    virtual uint32_t draws() const = 0;           ///< of a frame
    virtual uint64_t texture_bytes() const = 0;   ///< memory of the images
    virtual uint64_t geometry_bytes() const = 0;  ///< of vertices and indices
};

}  // namespace citystream::bench
