// A binary glTF 2.0 file in memory: the parts that the reference renderer draws.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "codec/result.h"

namespace citystream::client {

/// Decoded image, 8-bit RGBA, row 0 is glTF's top row (v = 0).
struct GlbImage {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgba;
};

struct GlbMaterial {
    std::array<float, 3> srgb = {1, 1, 1};  ///< base colour factor, sRGB-encoded
    int32_t image = -1;
    float alpha_cutoff = 0;  ///< where the image's alpha is less, nothing is drawn (alphaMode MASK); 0: opaque
    bool repeat_u = true, repeat_v = true;
    std::array<float, 2> texcoord_scale = {1, 1}, texcoord_offset = {0, 0};  ///< KHR_texture_transform
};

/// Vertex of a primitive as it is uploaded: position (metres), normal, texture coordinate.
struct GlbVertex {
    float position[3];
    float normal[3];
    float texcoord[2];
};

/// Triangles; primitives that name the same accessors (relief in several palettes) share one.
struct GlbGeometry {
    std::vector<GlbVertex> vertices;
    std::vector<uint32_t> indices;
    std::array<float, 3> minimum{}, maximum{};
};

struct GlbPrimitive {
    uint32_t geometry = 0;
    uint32_t material = 0;
};

/// Column-major affine 3 x 4 transform to z-up metres relative to GlbScene::origin.
using GlbTransform = std::array<float, 12>;

/// A mesh and where it stands (one transform, or many through EXT_mesh_gpu_instancing).
struct GlbDraw {
    uint32_t mesh = 0;
    std::vector<GlbTransform> instances;
};

struct GlbScene {
    std::array<double, 3> origin{};  ///< asset.extras.citystream.origin: absolute metres that coordinates count from
    std::vector<GlbImage> images;
    std::vector<GlbMaterial> materials;  ///< the last one is the default material
    std::vector<GlbGeometry> geometries;
    std::vector<std::vector<GlbPrimitive>> meshes;
    std::vector<GlbDraw> draws;
};

/// Loads a .glb (triangles; POSITION, NORMAL, TEXCOORD_0; base colour; EXT_mesh_gpu_instancing; KHR_texture_transform).
/// Error: file cannot be read or is no glTF, an accessor lies outside its buffer, an image cannot be decoded.
Result<GlbScene> load_glb(const std::string& path);

}  // namespace citystream::client
