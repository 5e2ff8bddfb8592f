// Word layout of a mesh's topology as local strips, shared by C++ and GLSL: the three vertices of any triangle from a
// bounded number of words. local_strips.h beside this file makes, checks and decodes it.
//
// Header, then 2 words a block of 16 groups, then 2 words a group of 64 triangles, then the payloads of the groups, one
// after the other. A payload: 2 words of steps (bit t: triangle t of the group is N, else P); 2 words of restarts (bit
// t), only if the group has any after its first triangle, which always is one and whose bit is 0; one bit a reference:
// it is the next new vertex; a field of `width` bits for every other reference. Bits from the least significant of each
// word up; the bits of references and the fields begin at a word each; unused bits are 0. A restart takes three
// references, every other triangle one; steps mean what they mean in strip_layout.h, and are 0 for restarts.
//
// Reference j of a group, with n new ones before it, is vertex base + n if it is new. Else it has field f, number
// k = j - n: with two frames and the top bit of f set it is base + n - 1 - (the other bits), else it is
// low + slope k + (the other bits), modulo 2^27, the slope being 0, 1 or -1.
#ifndef CITYSTREAM_CODEC_MESH_LOCAL_STRIPS_LAYOUT_H
#define CITYSTREAM_CODEC_MESH_LOCAL_STRIPS_LAYOUT_H

#define LOCAL_STRIPS_MAGIC 0x31534c43u /* "CLS1" */

#define LOCAL_STRIPS_WORD_MAGIC 0
#define LOCAL_STRIPS_WORD_TRIANGLES 1
#define LOCAL_STRIPS_WORD_VERTICES 2 /* every reference is less */
#define LOCAL_STRIPS_WORD_WORDS 3    /* all words, these included */
#define LOCAL_STRIPS_HEADER_WORDS 4

#define LOCAL_STRIPS_GROUP_SHIFT 6 /* 64 triangles a group */
#define LOCAL_STRIPS_GROUP_TRIANGLES 64
#define LOCAL_STRIPS_BLOCK_SHIFT 4 /* 16 groups a block */
#define LOCAL_STRIPS_BLOCK_GROUPS 16

/* Block: new vertices before it; word at which its first payload begins. */
#define LOCAL_STRIPS_BLOCK_BASE 0
#define LOCAL_STRIPS_BLOCK_PAYLOAD 1
#define LOCAL_STRIPS_BLOCK_WORDS 2

/* Group, word 0: new vertices since the block's beginning (12) | words of payload since then (12) | width of a field,
 * 0..27 (5) | slope: 0, 1, 2 for -1 (2) | there are restarts (1). Word 1: low (27) | two frames (1). */
#define LOCAL_STRIPS_GROUP_WORDS 2
#define LOCAL_STRIPS_SINCE_MASK 0xfffu
#define LOCAL_STRIPS_PAYLOAD_BIT 12
#define LOCAL_STRIPS_WIDTH_BIT 24
#define LOCAL_STRIPS_WIDTH_MASK 31u
#define LOCAL_STRIPS_SLOPE_BIT 29
#define LOCAL_STRIPS_SLOPE_MASK 3u
#define LOCAL_STRIPS_SLOPE_DOWN 2u
#define LOCAL_STRIPS_RESTARTS_BIT 31
#define LOCAL_STRIPS_FRAMES_BIT 27 /* of word 1 */

#define LOCAL_STRIPS_MOST_VERTICES 0x08000000u /* 2^27 */
#define LOCAL_STRIPS_VERTEX_MASK 0x07ffffffu
#define LOCAL_STRIPS_MOST_TRIANGLES 0x08000000u
#define LOCAL_STRIPS_MOST_WIDTH 27u

#endif
