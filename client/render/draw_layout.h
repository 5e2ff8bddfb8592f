// Records that the CPU writes for each frame and the shaders read by address, shared by C++ and GLSL. 4-byte members only, so both lay them out alike.
#ifndef CITYSTREAM_CLIENT_DRAW_LAYOUT_H
#define CITYSTREAM_CLIENT_DRAW_LAYOUT_H

#ifdef __cplusplus
#include <cstdint>
namespace citystream::client {
using uint = uint32_t;
#endif

#define SLOT_WORDS_LOG2 12 /* 16 KiB slots */
/* Low bit of a layer reference: set, the rest is the address of the layer's first word and all its words follow;
   clear, it is the address of a page table (one 64-bit slot address every 2^SLOT_WORDS_LOG2 words). */
#define LAYER_REF_DIRECT 1u
#define DRAW_MESH_STEPS 4
#define DRAW_HAS_ATLAS 1u

/* One a frame. Directions are the camera's axes, scaled so that clip.xyw = row * p and clip.z = near_plane (reversed z, infinite far plane). */
struct FrameRecord {
    float clip_x[3];
    float clip_y[3];
    float clip_w[3];
    float camera_fraction[3]; /* metres: from the camera's grid cell to the camera, 0..2^-10 */
    float near_plane;
    uint reserved;
};

/* One a tile. Positions relative to the camera are exact integers up to the last step: origin + position, in grid units. */
struct TileDrawRecord {
    uint mesh[2];
    uint atlas[2];
    uint facade[2];
    uint facade_maps[2]; /* address of FacadeMapEntry[facade_map_count], sorted by map */
    uint facade_map_count;
    uint flags;
    int origin[3];       /* grid units from the camera's grid cell to the tile's origin */
    uint atlas_finest_mip;
    uint mesh_steps;
    uint mesh_step_begin[DRAW_MESH_STEPS]; /* words */
    uint reserved;
};

struct FacadeMapEntry {
    uint map;
    uint reserved;
    uint layer[2];
};

/* Push constants of the drawing passes. */
struct DrawConstants {
    uint frame[2]; /* address of FrameRecord */
    uint tile[2];  /* address of TileDrawRecord */
};

/* Push constants of box_filter.comp.glsl. */
struct FilterConstants {
    uint source[2]; /* width * scale x height * scale pixels, RGBA8 */
    uint target[2];
    uint width;
    uint height;
    uint scale;
    uint reserved;
};

#ifdef __cplusplus
static_assert(sizeof(FrameRecord) == 56 && sizeof(TileDrawRecord) == 80);
static_assert(sizeof(FacadeMapEntry) == 16 && sizeof(DrawConstants) == 16 && sizeof(FilterConstants) == 32);
}  // namespace citystream::client
#endif

#endif
