// What lights the relief of a tile's facades, shared by C++ and GLSL. 4-byte members only, so both lay them out alike.
#ifndef CITYSTREAM_CLIENT_RELIEF_DRAW_LAYOUT_H
#define CITYSTREAM_CLIENT_RELIEF_DRAW_LAYOUT_H

#include "client/render/light_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

/* Of a tile whose walls have local light (codec/radiance/local_light.h): begins as the record of every tile with
   facades does. One ReliefDrawEntry for each of the tile's maps follows. */
struct ReliefDraw {
    RadianceDraw radiance;
    uint local[2];        /* reference (draw_layout.h) of the words of local light */
    uint local_receivers; /* that have such words */
    uint reserved;
};

/* References; 0: the map has none. */
struct ReliefDrawEntry {
    uint mask[2]; /* of codec/radiance/relief_mask.h */
    uint btf[2];  /* of codec/radiance/btf.h */
};

/* How relief is drawn follows from how many pixels of the picture a texel of its BTF's finest mip covers: with
   RELIEF_CAST_PIXELS or more it is cast, with half as many its BTF is shown, and between them a blend of the two.
   Walls of RELIEF_WALL_PIXELS pixels or more are shown by their BTF, those of half as many by their mean colour. */
#define RELIEF_CAST_PIXELS 2.0
#define RELIEF_WALL_PIXELS 8.0

#ifdef __cplusplus
static_assert(sizeof(ReliefDraw) == 48 && sizeof(ReliefDrawEntry) == 16);
}  // namespace citystream::client
#endif

#endif
