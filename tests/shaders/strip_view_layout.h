// Push constants of strip_view.*.glsl, shared by C++ and GLSL.
#ifndef CITYSTREAM_TESTS_STRIP_VIEW_LAYOUT_H
#define CITYSTREAM_TESTS_STRIP_VIEW_LAYOUT_H

#include "client/render/draw_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

struct StripViewConstants {
    float clip[4][4]; /* rows: clip coordinates of (x, y, z, 1) in steps of the grid */
    uint vertices[2]; /* address of two words a vertex: x | y << 16, z */
};

#ifdef __cplusplus
static_assert(sizeof(StripViewConstants) == 72);
}  // namespace citystream::client
#endif

#endif
