// Constants of the one lighting model, shared by the Vulkan shaders, the GLES reference and C++.
// All colour arithmetic is on sRGB-encoded values (no transfer function): texel * (ambient + sun * max(0, n.l)),
// clamped.
#ifndef CITYSTREAM_CLIENT_LIGHTING_LAYOUT_H
#define CITYSTREAM_CLIENT_LIGHTING_LAYOUT_H

#define LIGHT_AMBIENT 0.55
#define LIGHT_SUN 0.5
/* Unit vector towards the sun (x east, y north, z up): (0.48, -0.64, 0.6). */
#define LIGHT_SUN_X 0.48
#define LIGHT_SUN_Y (-0.64)
#define LIGHT_SUN_Z 0.6
/* Background (sky), sRGB 0..1. */
#define SKY_R 0.62
#define SKY_G 0.74
#define SKY_B 0.88

#endif
