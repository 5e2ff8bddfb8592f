// From light to a picture's values, shared by the shaders (tone.glsl) and C++ (tone.h): radiance times exposure, each
// channel along a curve that is straight up to TONE_LINEAR and bends towards 1 above it, then sRGB (IEC 61966-2-1).
//
// With k = TONE_LINEAR and t = (x - k) / (1 - k): tone(x) = k + (1 - k) t / (1 + t). It grows everywhere and has no
// kink; a white surface under a light that exposure makes 1 keeps a texture's colours up to 60 % grey as they are;
// bright colours turn towards white, the sun's disc is white.
#ifndef CITYSTREAM_CLIENT_TONE_LAYOUT_H
#define CITYSTREAM_CLIENT_TONE_LAYOUT_H

#define TONE_LINEAR 0.6
#define TONE_MOST 1e6 /* brighter is taken as this */

#define SRGB_LINEAR_END 0.0031308 /* linear value where the straight part ends */
#define SRGB_ENCODED_END 0.04045
#define SRGB_SLOPE 12.92
#define SRGB_OFFSET 0.055
#define SRGB_EXPONENT 2.4

#endif
