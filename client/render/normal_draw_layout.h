// Push constants of twin_normal.{vert,frag}.glsl, shared by C++ and GLSL: passes that tests draw unit vectors with, as
// vertices of 64 or 192 bits and as texels of a G-buffer (Meyer 2012, sections 4.8.7 and 4.10).
#ifndef CITYSTREAM_CLIENT_NORMAL_DRAW_LAYOUT_H
#define CITYSTREAM_CLIENT_NORMAL_DRAW_LAYOUT_H

#include "client/render/draw_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

/* What is drawn: two views of the unit sphere side by side, from +z and from -z, each as wide as high; or triangles
 * over all of the picture. */
#define NORMAL_DRAW_EXACT 0  /* one triangle; the direction follows from the place of the fragment */
#define NORMAL_DRAW_FLOATS 1 /* triangles, 6 floats a vertex: position, normal */
#define NORMAL_DRAW_PACKED 2 /* 2 words: position 3 x 16 bits over -1..1, octahedral normal 2 x 8 bits from bit 48 */
#define NORMAL_DRAW_FLOAT_WORDS 6
#define NORMAL_DRAW_PACKED_WORDS 2

/* What a fragment writes to RGBA8 (bits): light, or an octahedral code of 8 (in RG) or 16 (RGBA) bits a parameter. */
#define NORMAL_DRAW_LIGHT 0

struct NormalDraw {
    uint vertices[2]; /* address */
    uint kind;
    uint bits;
    uint nearest; /* range quantisation instead of domain quantisation */
    uint height;  /* pixels */
};

#ifdef __cplusplus
static_assert(sizeof(NormalDraw) == 24);
}  // namespace citystream::client
#endif

#endif
