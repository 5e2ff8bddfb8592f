// Light along the normal of a receiver, in integers: of the third and fourth light pass. Twin of codec/radiance/irradiance.h.
#ifndef CITYSTREAM_RADIANCE_NORMAL_GLSL
#define CITYSTREAM_RADIANCE_NORMAL_GLSL

#include "codec/radiance/receiver_layout.h"
#include "shaders/radiance_matrix.glsl"

// The class of a receiver: of those that have some the last whose first is not behind it.
uint class_of(uvec2 layer, RadianceJob job, uint receiver) {
    uint result = 0u;
    for (uint c = 0u; c < uint(RECEIVER_CLASSES); ++c) {
        uvec4 class_words = layer_words4(layer, (uint(RECEIVER_WORD_CLASSES) + c * uint(RECEIVER_CLASS_WORDS)) / 4u);
        if (class_words[RECEIVER_CLASS_ROWS] == 0u) continue;
        uint first = layer_word(layer, min(class_words[RECEIVER_CLASS_ROW_TABLE], job.irradiance_word) + uint(RECEIVER_ROW_FIRST));
        if (first <= receiver) result = c;
    }
    return result;
}

// Twin of WholeNormal: its vector along the axes, and its scale.
struct WholeNormal {
    ivec3 vector;
    uint scale;
};

// 2^44 / n by two divisions of 32 bits. n: 2^14..2^16 - 1.
uint quotient_of_2_44(uint n) {
    uint first = (1u << 28) / n;
    uint rest = (1u << 28) - first * n;
    return first << 16 | (rest << 16) / n;
}

// Nearest to the square root of a number below 2^31.
uint rounded_root(uint number) {
    uint root = 0u;
    for (uint bit = 1u << 15; bit != 0u; bit >>= 1) {
        uint more = root | bit;
        if (more * more <= number) root = more;
    }
    return root + (number - root * root > root ? 1u : 0u);
}

// Twin of whole_normal; `entry`: a receiver's word of the table.
WholeNormal whole_normal(uint surface_class, uint entry) {
    int own = int(surface_class / 2u);
    int one = RECEIVER_TILT_ONE;
    int a = int(entry << 8) >> 24;
    int b = int(entry) >> 24;
    WholeNormal result;
    result.vector[own] = surface_class % 2u == 0u ? one : -one;
    result.vector[(own + 1) % 3] = a;
    result.vector[(own + 2) % 3] = b;
    result.scale = rounded_root(quotient_of_2_44(uint(one * one + a * a + b * b)));
    return result;
}

// Twin of part_along: high * 2^32 + low.
void part_along(WholeNormal normal, ivec3 vector, out uint high, out uint low) {
    int signed_high = 0;
    low = 0u;
    for (int axis = 0; axis < 3; ++axis) {
        int more_high, more_low;
        imulExtended(normal.vector[axis], vector[axis], more_high, more_low);
        uint carry;
        low = uaddCarry(low, uint(more_low), carry);
        signed_high += more_high + int(carry);
    }
    if (signed_high < 0) {
        high = 0u;
        low = 0u;
        return;
    }
    // Below 2^40 times below 2^16.
    uint middle, lowest;
    umulExtended(low, normal.scale, middle, lowest);
    high = uint(signed_high) * normal.scale + middle;
    const int shift = IRRADIANCE_SCALE_BITS - IRRADIANCE_WEIGHT_BITS - LIGHT_VECTOR_SHIFT;
    low = lowest >> shift | high << 32 - shift;
    high >>= shift;
}

// Of a receiver of the job's layer.
WholeNormal receiver_normal(uvec2 layer, RadianceJob job, uint receiver) {
    return whole_normal(class_of(layer, job, receiver), layer_word(layer, job.irradiance_word - job.receivers + receiver));
}

#endif
