// A frame's light as shaders read it, where one is set (frame_light.h), shared by C++ and GLSL. 4-byte members only, so
// both lay them out alike. Linear Rec. 709; "shown" values have the exposure in them, so that tone.glsl takes them.
#ifndef CITYSTREAM_CLIENT_LIGHT_LAYOUT_H
#define CITYSTREAM_CLIENT_LIGHT_LAYOUT_H

#ifdef __cplusplus
#include <cstdint>
namespace citystream::client {
using uint = uint32_t;
#endif

#define AMBIENT_TERMS 9
#define SHADOW_CASCADES 4

/* One of the sun's shadow maps. Texel (i, j) is word j * shadow_side + i of it: a float, 0 farthest from the sun. */
struct ShadowCascade {
    /* Rows (x, y, z, 1): from metres, counted from the camera, to texels, texels and depth. */
    float column[4];
    float row[4];
    float depth[4];
    float texel_metres;
    uint depths[2]; /* address */
    uint reserved;
};

struct LightConstants {
    /* Of the open sky on a surface with unit normal (x, y, z), shown, for white: red, green and blue of each term 1, x,
       y, z, xy, yz, zx, zz, xx - yy. */
    float ambient[3 * AMBIENT_TERMS];
    float sky[3]; /* from values of irradiance words to shown light of a white surface */
    float sun[3]; /* shown, of a white surface that faces it; 0: there is none */
    float to_sun[3];
    float disc[3];     /* shown radiance of the sun's disc */
    float disc_radius; /* of the disc, on the unit sphere */
    /* The environment (map_texels.h), latitude by longitude. */
    uint map[2]; /* address */
    uint map_width, map_height;
    float map_scale; /* to shown radiance */
    uint cascades;   /* 0: nothing shades the sun */
    uint shadow_side;
    uint reserved;
    ShadowCascade cascade[SHADOW_CASCADES]; /* nearest first, each within the next */
};

/* What a tile's surfaces are lit by. */
struct RadianceDraw {
    uint layer[2]; /* reference (draw_layout.h) of the words of codec/radiance/radiance_layer.h; 0: none */
    uint light[2]; /* address of the frame's LightConstants */
    int offset[3]; /* grid units: the tile's origin from that of the tile whose words they are */
    uint reserved;
};

/* Push constants of the sky pass: the rows of FrameConstants, and the light. */
struct SkyConstants {
    float clip_x[3];
    float clip_y[3];
    float clip_w[3];
    float pixel; /* height of a pixel at view distance 1 */
    uint light[2];
};

#ifdef __cplusplus
static_assert(sizeof(ShadowCascade) == 64 && sizeof(RadianceDraw) == 32 && sizeof(SkyConstants) == 48);
static_assert(sizeof(LightConstants) == 4 * (3 * AMBIENT_TERMS + 21) + 64 * SHADOW_CASCADES);
}  // namespace citystream::client
#endif

#endif
