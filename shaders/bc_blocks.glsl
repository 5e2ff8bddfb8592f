// Texels of BC1, BC4 and BC3 blocks, 0..255 a channel. Twins of codec/atlas/bc1.h and bc4.h: same integers. Written in the common subset of GLSL and C++ with glm (see words.glsl); the CPU runs it in tests/shaders/bc_blocks_on_cpu.cpp.
#ifndef CITYSTREAM_BC_BLOCKS_GLSL
#define CITYSTREAM_BC_BLOCKS_GLSL

// A 5:6:5 colour with 8 bits a channel, ten bits apart: r | g << 10 | b << 20. Sums of three such colours still fit side by side.
uint expand_565(uint c) {
    uint high = (c >> 8 & 0xf8u) | (c & 0x7e0u) << 7 | (c & 0x1fu) << 23;
    return high | (high >> 5 & 0x00700007u) | (high >> 6 & 0x00000c00u);
}

// c0, c1, (2 c0 + c1 + 1) / 3, (c0 + 2 c1 + 1) / 3; block: endpoints, indices.
ivec3 bc1_texel(uvec2 block, uint i) {
    uint code = block.y >> (2u * i) & 3u;
    uint thirds = code < 2u ? code * 3u : code - 1u;
    uint sum = expand_565(block.x & 0xffffu) * (3u - thirds) + expand_565(block.x >> 16) * thirds + 0x00100401u;
    return ivec3(sum & 1023u, sum >> 10 & 1023u, sum >> 20) * 21846 >> 16;  // sum / 3, exact up to 766
}

// Bits 0..7 a0, 8..15 a1, then 3 bits a texel.
int bc4_texel(uvec2 block, uint i) {
    uint a0 = block.x & 0xffu;
    uint a1 = block.x >> 8 & 0xffu;
    uint bit = 16u + 3u * i;
    uint code = bit < 32u ? block.x >> bit : block.y >> (bit - 32u);
    if (bit == 31u) code |= block.y << 1;
    code &= 7u;
    if (code < 2u) return int(code == 0u ? a0 : a1);
    if (a0 > a1) return int(((8u - code) * a0 + (code - 1u) * a1 + 3u) / 7u);
    if (code >= 6u) return code == 6u ? 0 : 255;
    return int(((6u - code) * a0 + (code - 1u) * a1 + 2u) / 5u);
}

// Alpha's block, then the colour's.
ivec4 bc3_texel(uvec4 block, uint i) { return ivec4(bc1_texel(uvec2(block.z, block.w), i), bc4_texel(uvec2(block.x, block.y), i)); }

#endif
