// Scans on the GPU (client/render/scan.h, shaders/scan_*.glsl): sizes, states and push constants, shared by C++ and
// GLSL. 4-byte members only, so both lay them out alike.
#ifndef CITYSTREAM_CLIENT_SCAN_LAYOUT_H
#define CITYSTREAM_CLIENT_SCAN_LAYOUT_H

#include "client/render/draw_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

#define SCAN_LANES 128 /* a workgroup: what every Vulkan device has */
#define SCAN_ITEMS 8   /* consecutive elements a lane, of scan.comp.glsl */
#define SCAN_BLOCK_ELEMENTS (SCAN_LANES * SCAN_ITEMS)
/* Blocks, hence workgroups, of one scan: what every Vulkan device dispatches. */
#define SCAN_MOST_BLOCKS 65535

/* State of a scan in memory: with look-back the ticket counter, then SCAN_STATE_WORDS a block, all zero at first; in
   passes SCAN_SUM_WORDS a block. The halves of a block's two words are published apart, each in its own word below the
   flag, so that no word's meaning depends on another's having arrived. */
#define SCAN_TICKET_WORDS 1
#define SCAN_STATE_WORDS 4
#define SCAN_SUM_WORDS 2
#define SCAN_FLAG_BIT 30
#define SCAN_FLAG_NONE 0u
#define SCAN_FLAG_TOTAL 1u  /* of the block alone */
#define SCAN_FLAG_PREFIX 2u /* of the block and all before it */
/* Predecessors that are looked at together. */
#define SCAN_WINDOW 32

/* Numbers of the specialization constants (all uint), behind those of draw_layout.h. */
#define SCAN_PHASE_CONSTANT 8
#define SCAN_PATIENCE_CONSTANT 9 /* looks at a predecessor that says nothing before its total is made here */
#define SCAN_SILENT_CONSTANT 10  /* n > 0: every n-th block publishes nothing (tests) */
#define SCAN_OPERATION_CONSTANT 11
#define SCAN_INCLUSIVE_CONSTANT 12
#define SCAN_ELEMENT_BITS_CONSTANT 13 /* 1, 2, 4, 8, 16, 32 */
#define SCAN_TRANSFORM_CONSTANT 14

#define SCAN_PHASE_LOOK_BACK 0u
#define SCAN_PHASE_REDUCE 1u
#define SCAN_PHASE_SUMS 2u
#define SCAN_PHASE_APPLY 3u
#define SCAN_OPERATION_SUM 0u
#define SCAN_OPERATION_MAXIMUM 1u
#define SCAN_TRANSFORM_NONE 0u
#define SCAN_TRANSFORM_UNZIGZAG 1u
#define SCAN_TRANSFORM_STRIP_LENGTH 2u /* new vertices of a strip code: 3 for a restart, else 1 */

/* Push constants of scan.comp.glsl. */
struct ScanConstants {
    uint elements[2];
    uint output_words[2];
    uint segments[2]; /* first elements of segments, ascending */
    uint state[2];
    uint count;
    uint segment_count;
    uint blocks;
    uint reserved;
};

#ifdef __cplusplus
static_assert(sizeof(ScanConstants) == 48);
}  // namespace citystream::client
#endif

#endif
