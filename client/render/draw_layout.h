// What the CPU tells the shaders about a frame and its tiles, shared by C++ and GLSL. 4-byte members only, so both lay
// them out alike.
#ifndef CITYSTREAM_CLIENT_DRAW_LAYOUT_H
#define CITYSTREAM_CLIENT_DRAW_LAYOUT_H

#ifdef __cplusplus
#include <cstdint>
namespace citystream::client {
using uint = uint32_t;
#endif

#define SLOT_WORDS_LOG2 8 /* 1 KiB slots */
/* Low bit of a layer reference: set, the rest is the address of the layer's first word and all its words follow;
   clear, it is the address of a page table (one 64-bit slot address every 2^SLOT_WORDS_LOG2 words). */
#define LAYER_REF_DIRECT 1u
/* Number of the specialization constant (bool): all layers of the draws are in one piece, read without asking. */
#define DIRECT_LAYERS_CONSTANT 0
/* (bool): the tile's atlas is in pages (codec/atlas/page_layout.h). */
#define PAGES_CONSTANT 1
/* (uint): how the vertex shader gets the frame of a page's chart, one of the following
 * (client/render/chart_transport.h). */
#define CHART_TRANSPORT_CONSTANT 2
#define CHART_TRANSPORT_TABLE 0
#define CHART_TRANSPORT_UNIFORM 1
#define CHART_TRANSPORT_ATTRIBUTE 2
#define CHART_TRANSPORT_PACKED 3
/* (bool): charts of the tile may have alpha; where it is filtered to less than one half, triangles are not drawn. */
#define ALPHA_TEST_CONSTANT 3
/* (float): how much walls are tinted, 0..1, and how fast tints change (shaders/facade_tint.glsl). */
#define FACADE_TINT_CONSTANT 4
#define TINTS_PER_METRE_CONSTANT 5
/* (uint): MeshDrawConstants::form of the ranges that are drawn, or any; strip code is drawn by pipelines that say so.
 */
#define MESH_FORM_CONSTANT 6
/* Of passes in frames with a light: it has a sun; the tile has a radiance layer. */
#define SUN_CONSTANT 7
#define RECEIVERS_CONSTANT 8
/* (bool): of the facade pass in such frames: relief is lit by local light (relief_draw_layout.h). */
#define RELIEF_LIGHT_CONSTANT 9
#define MESH_FORM_ANY 0xffffffffu

/* Of a frame. Directions are the camera's axes, scaled so that clip.xyw = row * p and clip.z = near_plane (reversed z,
 * infinite far plane). */
struct FrameConstants {
    float clip_x[3];
    float clip_y[3];
    float clip_w[3];
    float camera_fraction[3]; /* metres: from the camera's grid cell to the camera, 0..2^-10 */
    float near_plane;
    float tint; /* where in the palette of tint_layout.h the camera is */
};

/* Of a tile. References are 0 for layers that are not there. Positions relative to the camera are exact integers up to
   the last step: origin + position, in grid units. */
struct TileConstants {
    uint mesh[2];
    uint atlas[2];
    uint facade[2];
    uint facade_maps[2];    /* address of FacadeTableHead, FacadeMapEntry[] */
    int origin[3];          /* grid units from the camera's grid cell to the tile's origin */
    float atlas_finest_mip; /* that may be shown: at least the finest resident one, whatever the form of the atlas */
    /* The rule that positions are cut by (codec/mesh/precision.h), and bits that all of them drop at least. */
    uint distance_per_unit;
    uint least_dropped;
    /* Address of one SharedChartEntry for each chart of the tile; 0: it names no shared ones. Where the atlas is in
       pages, which name none: reference of the coordinate layer (CHART_TRANSPORT_ATTRIBUTE and _PACKED), or the chart
       of the draw (_UNIFORM): its packed coordinates, in their places' bits its page and flags; of a flat chart its
       colour and its flags. */
    uint shared_charts[2];
    /* Of the range that is drawn: address of its MeshDrawConstants, LitMeshDraw in a frame with a light
       (mesh_draw_layout.h). Of facades in such a frame: address of the tile's RadianceDraw (light_layout.h). */
    uint mesh_draw[2];
};

/* Of a chart of the tile that lies in the city's dictionary. */
struct SharedChartEntry {
    uint layer[2];    /* 0: not there */
    float finest_mip; /* that may be shown, at least the finest resident one */
    uint colour;      /* r | g << 8 | b << 16: what is shown instead */
};

/* Coordinate layers: CHART_TRANSPORT_ATTRIBUTE: four floats a corner, those of the chart frame
   (wrap_coordinate_layout.h) with the page, times COORDINATE_PAGE_STEP, in the first; of a flat chart its colour and
   three zeros. CHART_TRANSPORT_PACKED: COORDINATE_TRIANGLE_WORDS a triangle: flags and page as in the chart table, then
   packed coordinates u, v of its corners; of a flat chart its colour and 0. */
#define COORDINATE_PAGE_STEP 4096
#define COORDINATE_MOST_PAGES 4096 /* exact in a float */
#define COORDINATE_FRAME_WORDS 4
#define COORDINATE_TRIANGLE_WORDS 7

struct FacadeTableHead {
    uint keys[2];             /* address of one 64-bit key a sample of the picture: depth (float bits) << 32 | RGBA8 */
    uint width, height;       /* of the picture, in samples of the whole pass */
    uint map_of_placement[2]; /* address of one index of FacadeMapEntry[] a placement */
    uint samples;             /* most rays a sample of the picture */
    uint reserved;
};

struct FacadeMapEntry {
    uint layer[2];
    float finest[2]; /* texels: widths and heights of less are a hundredth of the map */
    uint is_opaque;
    uint reserved;
};

/* Push constants of the drawing passes: within the 128 bytes that every device has. */
struct DrawConstants {
    FrameConstants frame;
    TileConstants tile;
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
static_assert(sizeof(FrameConstants) == 56 && sizeof(TileConstants) == 72);
static_assert(sizeof(FacadeTableHead) == 32 && sizeof(FacadeMapEntry) == 24 && sizeof(DrawConstants) == 128 &&
              sizeof(FilterConstants) == 32 && sizeof(SharedChartEntry) == 16);
}  // namespace citystream::client
#endif

#endif
