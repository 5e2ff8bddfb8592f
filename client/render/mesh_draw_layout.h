// What is the same for all corners of a range of a mesh layer (codec/mesh/RESIDENT.md), as one record that shaders read
// at an address in their push constants: a driver loads it once a draw, not once a corner. mesh_draws.h makes it.
// Shared by C++ and GLSL. 4-byte members only, so both lay them out alike.
#ifndef CITYSTREAM_CLIENT_MESH_DRAW_LAYOUT_H
#define CITYSTREAM_CLIENT_MESH_DRAW_LAYOUT_H

#include "client/render/light_layout.h"

#ifdef __cplusplus
#include <cstdint>
namespace citystream::client {
using uint = uint32_t;
#endif

/* RESIDENT_KIND_* | RESIDENT_FLAG_* << 8 of a range, and: */
#define MESH_FORM_BINS 0x10000u /* positions are in several bins */
/* Of prisms: positions have at most 16 bits, the number of a top and its colours at most 32 together. */
#define MESH_FORM_NARROW 0x20000u
/* Prisms are drawn by vertices that the triangles of a wall share (prism_indices.h), not by corners. */
#define MESH_FORM_SHARED 0x40000u

/* Offsets are in words from the start of the layer. */
struct MeshDrawConstants {
    uint form;
    /* Of all position words: what their coordinates count from, and the bits that they have and would have. Of the
       first bin, where there are several. */
    int origin[3];
    uint full_bits, level, least_level;
    uint bins, bins_at, positions_at; /* entries of the bins; the payload */
    uint first_position;              /* of the range: place in the buffer */
    uint first_triangle;
    uint topology, topology_triangles; /* of local strips: how many they have */
    uint faces;
    uint index_bits, face_bits;
    uint top_bits;          /* of a prism's number of its top, or of a point */
    uint points;            /* of a prism */
    uint prism_bits;        /* of the number of its top and its colours */
    uint triangles;         /* of a prism, at least 2 */
    uint triangles_inverse; /* 2^32 / triangles, rounded up */
    uint vertices;          /* of a prism that shares them, at least 2 */
    uint vertices_inverse;
    uint texcoord_bits[2];   /* of q_u and q_v */
    uint texcoord_shifts[2]; /* zeros below them */
    uint texcoords, normals, vertex_points;
    uint face_table, face_chart_bits, normal_bits;
    uint chart_table, colours_at;
    uint chart_frames; /* charts that have frames of their own, and come first */
    uint frame_at;     /* of all others */
    uint corners[2];   /* of a range of strip code: address of its decoded corners, a vertex number each */
};
#define MESH_DRAW_WORDS 40

/* The record of a draw in a frame with a light. */
struct LitMeshDraw {
    MeshDrawConstants draw;
    RadianceDraw radiance;
};

#ifdef __cplusplus
static_assert(sizeof(MeshDrawConstants) == 4 * MESH_DRAW_WORDS);
static_assert(sizeof(LitMeshDraw) == sizeof(MeshDrawConstants) + sizeof(RadianceDraw));
}  // namespace citystream::client
#endif

#endif
