// The colours that tinted walls take in turn, shared by C++ and GLSL, which say what TINT(red, green, blue) is: sRGB
// 0..1, plasters and bricks, each near those beside it.
#ifndef CITYSTREAM_CODEC_TINT_LAYOUT_H
#define CITYSTREAM_CODEC_TINT_LAYOUT_H

#define TINT_COLOURS 24
// clang-format off
#define TINT_PALETTE \
    TINT(0.93, 0.87, 0.74), TINT(0.90, 0.80, 0.62), TINT(0.85, 0.70, 0.52), TINT(0.80, 0.60, 0.46), \
    TINT(0.76, 0.52, 0.42), TINT(0.80, 0.62, 0.56), TINT(0.87, 0.74, 0.68), TINT(0.92, 0.83, 0.78), \
    TINT(0.90, 0.88, 0.84), TINT(0.82, 0.82, 0.80), TINT(0.72, 0.74, 0.75), TINT(0.64, 0.68, 0.72), \
    TINT(0.70, 0.76, 0.80), TINT(0.78, 0.84, 0.86), TINT(0.80, 0.86, 0.82), TINT(0.72, 0.79, 0.72), \
    TINT(0.66, 0.72, 0.60), TINT(0.74, 0.76, 0.60), TINT(0.84, 0.83, 0.66), TINT(0.90, 0.88, 0.72), \
    TINT(0.94, 0.92, 0.82), TINT(0.88, 0.83, 0.74), TINT(0.80, 0.74, 0.66), TINT(0.87, 0.81, 0.71)
// clang-format on

#endif
