// Push constants of the twin_*.comp.glsl passes, shared by C++ and GLSL. They decode one layer on the GPU with the
// includes that draw it, so that tests can compare every integer with the CPU's decoder.
#ifndef CITYSTREAM_CLIENT_TWIN_LAYOUT_H
#define CITYSTREAM_CLIENT_TWIN_LAYOUT_H

#include "client/render/draw_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

#define TWIN_GROUP 64
#define TWIN_CORNER_WORDS \
    10 /* a corner of a resident mesh: position xyz, normal xyz, chart entry, texture word, texture coordinate uv */
#define TWIN_CORNER_INPUT_WORDS \
    5 /* from the camera's cell to the tile's corner xyz, distance a unit, least dropped bits */
#define TWIN_PRECISION_WORDS 8 /* a vertex: its words xyz, bit level, shown position xyz, unused */
#define TWIN_PRECISION_INPUT_WORDS                                                                               \
    9 /* origin of the grid xyz, the same from the camera's cell, common dropped bits, distance a unit, reading; \
         texture coordinates: base uv, unused, shifts uv */
#define TWIN_RAY_WORDS 6 /* origin, direction (float bits) */
#define TWIN_WRAP_INPUT_WORDS \
    6 /* packed coordinate uv, border | u clamps << 8 | v clamps << 9, a place uv and a level (float bits) */
#define TWIN_WRAP_WORDS 8         /* float bits: frame, packed place uv, texel uv of the place of the input */
#define TWIN_NORMAL_INPUT_WORDS 5 /* code u, v; direction xyz (float bits) */
#define TWIN_NORMAL_WORDS                                                                                         \
    16 /* unfolded xyz, unit vector xyz (float bits), unfolded hemisphere xyz; codes of the direction: octahedron \
          rounded u, v and nearest u, v, hemisphere u, v; unused */
#define TWIN_RELIEF_INPUT_WORDS 5 /* point (float bits), label, axis | sign > 0 << 8 */
#define TWIN_RELIEF_WORDS 128     /* float bits: how free each of 64 directions is, its weight */
#define TWIN_BTF_INPUT_WORDS 9    /* place uv, to the viewer, to the sun (float bits), mip */
#define TWIN_BTF_WORDS 84 /* 64 values, 16 slots' shares, coverage, sun's cosine (float bits); slots; openness */
#define TWIN_HIT_WORDS 4  /* hit, t (float bits), label, axis | sign > 0 << 8 */

struct TwinConstants {
    uint layer[2]; /* reference as in TileConstants */
    uint input_words[2];
    uint output_words[2];
    uint count;  /* corners, texels, places or rays */
    uint first;  /* atlas: chart; precision: components; normals: bits a parameter */
    uint second; /* atlas: mip */
    uint reserved;
    uint draw[2]; /* resident mesh: address of the range's MeshDrawConstants */
};

/* Of twin_precision_view, which draws a precision buffer with Blinn-Phong shading: pictures to compare levels by. */
struct TwinViewConstants {
    FrameConstants frame;
    uint buffer_words[2]; /* reference as in TileConstants: three components */
    uint normals[2];      /* address of three floats a vertex */
    int from_camera[3];   /* grid units from the camera's grid cell to the origin of the buffer's grid */
    uint common_dropped;
    uint distance_per_unit;
    uint reading;
    float shininess;
};

/* Of twin_mesh_view, which draws a range of a mesh layer. */
struct TwinMeshViewConstants {
    FrameConstants frame;
    uint mesh[2];       /* reference as in TileConstants */
    int from_camera[3]; /* grid units from the camera's grid cell to the tile's corner */
    uint distance_per_unit;
    uint least_dropped;
    uint draw[2]; /* address of the range's MeshDrawConstants */
};

#ifdef __cplusplus
static_assert(sizeof(TwinConstants) == 48 && sizeof(TwinViewConstants) == 100 && sizeof(TwinMeshViewConstants) == 92);
}  // namespace citystream::client
#endif

#endif
