// Push constants of the passes that make relief masks and BTFs (relief_mask.comp.glsl, btf.comp.glsl,
// btf_mip.comp.glsl), shared by C++ and GLSL. 4-byte members only.
#ifndef CITYSTREAM_CLIENT_RELIEF_PASSES_LAYOUT_H
#define CITYSTREAM_CLIENT_RELIEF_PASSES_LAYOUT_H

#include "client/render/draw_layout.h"
#include "codec/radiance/btf_layout.h"
#include "codec/radiance/relief_mask_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

/* A workgroup makes one surface of a mask, a thread a direction. */
#define RELIEF_MASK_GROUP RELIEF_DIRECTIONS

/* A workgroup makes four texels of a BTF: a thread a ray of each, then a thread four directions of each. */
#define BTF_GROUP_TEXELS 4
#define BTF_GROUP 64 /* BTF_GROUP_TEXELS * BTF_RAYS, and BTF_GROUP_TEXELS * BTF_RECORD_SLOTS */

/* Workgroups in one row of a dispatch; more go into further rows (65,535 is what every device has). */
#define RELIEF_PASS_ROW_GROUPS 32768

struct ReliefMaskPassConstants {
    uint map[2];     /* references as in TileConstants */
    uint mask[2];    /* with starts in place of bits */
    uint first_word; /* of the first surface that is made */
    uint surfaces;
};

struct BtfPassConstants {
    uint map[2]; /* references */
    uint mask[2];
    uint btf[2]; /* reference of words in one piece, whose head is there */
    uint mip;    /* of btf_mip: the one to make, from the finer one */
    uint groups; /* of the dispatch */
    uint first_group;
    uint reserved;
};

#ifdef __cplusplus
static_assert(BTF_GROUP == BTF_GROUP_TEXELS * BTF_RAYS && BTF_GROUP == BTF_GROUP_TEXELS * BTF_RECORD_SLOTS);
static_assert(sizeof(ReliefMaskPassConstants) == 24 && sizeof(BtfPassConstants) == 40);
}  // namespace citystream::client
#endif

#endif
