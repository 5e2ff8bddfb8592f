// Push constants of the viewer without an atlas, shared by C++ and GLSL.
#ifndef CITYSTREAM_BENCH_TEXTURE_VIEWER_LAYOUT_H
#define CITYSTREAM_BENCH_TEXTURE_VIEWER_LAYOUT_H

#ifdef __cplusplus
namespace citystream::bench {
#endif

struct PlainConstants {
    float clip_x[3]; /* as FrameConstants */
    float clip_y[3];
    float clip_w[3];
    float near_plane;
    float corner[3]; /* metres from the camera to the city's corner */
};

#ifdef __cplusplus
static_assert(sizeof(PlainConstants) == 52);
}  // namespace citystream::bench
#endif

#endif
