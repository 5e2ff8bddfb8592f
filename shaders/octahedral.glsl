// Octahedral unit vectors: twin of codec/mesh/octahedral.h and octahedral_hemisphere.h, same integers. A code is (u, v), both biased by the
// lattice's side S = 2^(bits - 1) - 1; bits (a parameter) is 2..32 where codes are read, 2..22 where they are written:
// beyond, the floats that go in are coarser than the lattice.
#ifndef CITYSTREAM_OCTAHEDRAL_GLSL
#define CITYSTREAM_OCTAHEDRAL_GLSL

int octahedral_side(uint bits) { return int((1u << (bits - 1u)) - 1u); }

// -S..S: the value that is not written reads as S.
ivec2 centred_code(uvec2 code, int side) { return ivec2(min(code, uvec2(2u * uint(side))) - uvec2(side)); }

// On the octahedron |x| + |y| + |z| = S, not normalised.
ivec3 unfold_octahedral(uvec2 code, uint bits) {
    int side = octahedral_side(bits);
    ivec2 p = centred_code(code, side);
    ivec2 beside = side - abs(p);
    int z = beside.x - abs(p.y);
    if (z >= 0) return ivec3(p, z);
    return ivec3((p.x < 0 ? -1 : 1) * beside.y, (p.y < 0 ? -1 : 1) * beside.x, z);
}

ivec3 unfold_octahedral16(uint code) { return unfold_octahedral(uvec2(code, code >> 8) & 255u, 8u); }

// z >= 0, on the octahedron |x| + |y| + |z| = 2S. Bits up to 31.
ivec3 unfold_hemisphere(uvec2 code, uint bits) {
    int side = octahedral_side(bits);
    ivec2 p = centred_code(code, side);
    return ivec3(p.x + p.y, p.y - p.x, 2 * (side - max(abs(p.x), abs(p.y))));
}

// Unit vector. One factor for all components: what a device rounds in it changes the length, not the direction.
vec3 unit_direction(vec3 d) { return d * inversesqrt(dot(d, d)); }
vec3 unit_direction(ivec3 d) { return unit_direction(vec3(d)); }

// Of filtered places -1..1 in the chart of the upper half (places of codes: (code - S) / S).
vec3 hemisphere_direction(vec2 p) {
    return unit_direction(vec3(p.x + p.y, p.y - p.x, 2.0 - 2.0 * max(abs(p.x), abs(p.y))));
}

// Places -1..1 of a direction. Lengths are 10^-30..10^30; zero is +z.
vec2 octahedral_place(vec3 n) {
    float l1 = abs(n.x) + abs(n.y) + abs(n.z);
    if (!(l1 > 0.0)) return vec2(0.0);
    vec2 p = n.xy / l1;
    if (n.z >= 0.0) return p;
    return vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0) * (1.0 - abs(p.yx));
}
vec2 hemisphere_place(vec3 n) {
    float l1 = abs(n.x) + abs(n.y) + max(n.z, 0.0);
    return l1 > 0.0 ? vec2(n.x - n.y, n.x + n.y) / l1 : vec2(0.0);
}

// Domain quantisation: each parameter to the nearest.
uvec2 round_place(vec2 place, uint bits) {
    int side = octahedral_side(bits);
    return uvec2(clamp(ivec2(floor(place * float(side) + 0.5)), -side, side) + side);
}
uvec2 pack_octahedral_rounded(vec3 n, uint bits) { return round_place(octahedral_place(n), bits); }
uvec2 pack_hemisphere_rounded(vec3 n, uint bits) { return round_place(hemisphere_place(n), bits); }

// Range quantisation: the nearest of the four enclosing lattice points.
uvec2 pack_octahedral(vec3 n, uint bits) {
    int side = octahedral_side(bits);
    vec2 place = octahedral_place(n);
    vec3 unit = unit_direction(n / (abs(n.x) + abs(n.y) + abs(n.z)));
    ivec2 low = ivec2(floor(place * float(side)));
    uvec2 best = round_place(place, bits);  // where there is no direction
    float least = 4.0;
    for (int corner = 0; corner < 4; ++corner) {
        uvec2 code = uvec2(clamp(low + ivec2(corner & 1, corner >> 1), -side, side) + side);
        vec3 chord = unit_direction(unfold_octahedral(code, bits)) - unit;
        float far = dot(chord, chord);
        if (far < least) {
            least = far;
            best = code;
        }
    }
    return best;
}

#endif
