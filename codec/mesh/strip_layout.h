// Word layout of the strip stream of one mesh (its topology in GPU memory), shared by C++ and GLSL. All words are
// little-endian; strip_code.h beside this file makes, checks and decodes it.
//
// Header, then the Simple-9 words S, then INC (one bit a reference), then C (the steps, 1 or 2 bits a triangle by
// mode), bits from the least significant of each word up, every part starting at a word; unused bits are 0. So
//   words = 8 + |S| + ceil(|V| / 32) + ceil(|T| bits / 32)   with bits = 2 in mode 0 and 1 in mode 1.
//
// Steps: P = 0 (previous) takes the edge (v2, v0) of the triangle before, the triangle is (v0, v2, new); N = 1 (next)
// takes (v1, v2), the triangle is (v2, v1, new); R = 2 (restart) takes three references. 3 is refused. In mode 0 the
// first step is R. In mode 1 there is no R: the first triangle takes references 0..2 and its step is P (0), triangle
// i > 0 takes reference i + 2, so |V| = |T| + 2; restarts are triangles with two equal corners, which stay in the list.
// An empty mesh has |T| = |V| = |U| = |S| = 0.
//
// References: bit j of INC says that reference j is the next vertex not met so far: V[j] = I[j], the number of set bits
// before j. Otherwise V[j] = U[j - I[j]]. U[k] = U[k - 1] + unzigzag(code k) + prediction, U[-1] = 0, modulo 2^32.
// Simple-9: selector in bits 0..3, codes above it, least significant first; the last word is padded with codes 0, so
// only the first |U| codes count. Codes of 28 bits are the greatest, hence vertices <= 2^27.
#ifndef CITYSTREAM_CODEC_MESH_STRIP_LAYOUT_H
#define CITYSTREAM_CODEC_MESH_STRIP_LAYOUT_H

#define STRIP_MAGIC 0x31545343u /* "CST1" */

#define STRIP_WORD_MAGIC 0
#define STRIP_WORD_TRIANGLES 1  /* |T|, those with two equal corners included */
#define STRIP_WORD_REFERENCES 2 /* |V| */
#define STRIP_WORD_EXPLICIT 3   /* |U|, zeros of INC */
#define STRIP_WORD_CODE_WORDS 4 /* |S| */
#define STRIP_WORD_MODE 5       /* mode | prediction << 8 */
#define STRIP_WORD_VERTICES 6   /* every reference is less */
#define STRIP_WORD_ZERO 7
#define STRIP_HEADER_WORDS 8

#define STRIP_MODE_RESTARTS 0u    /* 2 bits a triangle */
#define STRIP_MODE_DEGENERATES 1u /* 1 bit a triangle */
#define STRIP_MODE_MASK 0xffu
#define STRIP_PREDICTION_BIT 8 /* prediction of a difference: 0 or 1 */

#define STRIP_STEP_PREVIOUS 0u
#define STRIP_STEP_NEXT 1u
#define STRIP_STEP_RESTART 2u

#define STRIP_MOST_VERTICES 0x08000000u  /* 2^27 */
#define STRIP_MOST_TRIANGLES 0x10000000u /* 2^28: |V| <= 3 |T| fits 32 bits, and so do bit addresses */

/* Simple-9, selectors 0..8. */
#define SIMPLE9_SELECTORS 9
#define SIMPLE9_SELECTOR_BITS 4
#define SIMPLE9_DATA_BITS 28

#endif
