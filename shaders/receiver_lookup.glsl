// Which receivers light a point of a tile's surface (codec/radiance/RECEIVERS.md). Twin of ReceiverTableView::shares in codec/radiance/receiver_table.h:
// same names, same floats. Written in the common subset of GLSL and C++ (words.glsl).
#ifndef CITYSTREAM_RECEIVER_LOOKUP_GLSL
#define CITYSTREAM_RECEIVER_LOOKUP_GLSL

#include "codec/radiance/receiver_layout.h"
#include "shaders/words.glsl"

const uint kNoReceiver = 0xffffffffu;

// Weights add up to 1, or count is 0: the light of the open sky.
struct ReceiverShares {
    uint count;
    bool own_surface;
    uvec4 receiver;
    vec4 weight;
};

// A point seen along a class: own axis, then the column's. Depths in spacings / 64.
struct ReceiverQuestion {
    uint surface_class;
    vec3 normal;
    vec2 place;   // spacings
    float depth;  // at column (0, 0)
    vec2 slope;
    bool loose;
    uvec4 rows;    // RECEIVER_CLASS_*
    uint entries;  // offset
};

struct ReceiverChoice {
    uint receiver;
    float off;
};

// The header is read in groups of four words: the first, and one for each class.
uvec4 receiver_class(uvec2 layer, uint surface_class) {
    return layer_words4(layer, (uint(RECEIVER_WORD_CLASSES) + surface_class * uint(RECEIVER_CLASS_WORDS)) / 4u);
}

float receiver_tolerance(ReceiverQuestion question) {
    return question.loose ? float(RECEIVER_LOOSE_TOLERANCE) : float(RECEIVER_TOLERANCE);
}

bool receiver_takes(ReceiverQuestion question, uint word) {
    float a = float(int(word << 8) >> 24);
    float b = float(int(word) >> 24);
    float one = question.surface_class % 2u == 0u ? float(RECEIVER_TILT_ONE) : -float(RECEIVER_TILT_ONE);
    float cosine = one * question.normal.x + a * question.normal.y + b * question.normal.z;
    float lengths = (question.normal.x * question.normal.x + question.normal.y * question.normal.y + question.normal.z * question.normal.z) *
                    (one * one + a * a + b * b);
    if (question.loose) return cosine >= 0.0 || cosine * cosine < float(RECEIVER_LOOSE_COSINE_SQUARED) * lengths;
    return cosine > 0.0 && cosine * cosine > float(RECEIVER_COSINE_SQUARED) * lengths;
}

bool receiver_within_columns(ReceiverQuestion question) {
    return abs(question.place.x) < float(RECEIVER_MOST_COLUMN) && abs(question.place.y) < float(RECEIVER_MOST_COLUMN);
}

// First and end of a column's receivers.
uvec2 receiver_column(uvec2 layer, uvec4 rows, int i, int j) {
    uint row = uint(j) - rows[RECEIVER_CLASS_FIRST_ROW];
    if (row >= rows[RECEIVER_CLASS_ROWS]) return uvec2(0u, 0u);
    uint at = rows[RECEIVER_CLASS_ROW_TABLE] + row * uint(RECEIVER_ROW_WORDS);
    uint columns = layer_word(layer, at + uint(RECEIVER_ROW_COLUMNS));
    uint place = uint(i) - uint(int(columns << 16) >> 16);
    if (place >= columns >> 16) return uvec2(0u, 0u);
    uint begins = layer_word(layer, at + uint(RECEIVER_ROW_BEGINS));
    uint first = layer_word(layer, at + uint(RECEIVER_ROW_FIRST));
    uint begin = layer_word(layer, begins + place / 2u) >> place % 2u * 16u & 0xffffu;
    uint end = layer_word(layer, begins + (place + 1u) / 2u) >> (place + 1u) % 2u * 16u & 0xffffu;
    return uvec2(first + begin, first + end);
}

ReceiverQuestion receiver_question(uvec2 layer, uint surface_class, vec3 point, vec3 normal) {
    int own = int(surface_class / 2u);
    int a = (own + 1) % 3;
    int b = (own + 2) % 3;
    uvec4 header = layer_words4(layer, 0u);
    ReceiverQuestion result;
    result.rows = receiver_class(layer, surface_class);
    result.entries = header[RECEIVER_WORD_ENTRIES];
    float spacing = float(1u << header[RECEIVER_WORD_SPACING]);
    float base = float(int(result.rows[RECEIVER_CLASS_DEPTH]));
    result.surface_class = surface_class;
    result.normal = vec3(normal[own], normal[a], normal[b]);
    result.place = vec2(point[a] / spacing, point[b] / spacing);
    result.depth = (point[own] - base) / spacing * float(1u << RECEIVER_DEPTH_BITS);
    result.slope = vec2(0.0, 0.0);
    result.loose = false;
    return result;
}

ReceiverChoice receiver_best(uvec2 layer, ReceiverQuestion question, int i, int j) {
    uvec2 column = receiver_column(layer, question.rows, i, j);
    uint entries = question.entries;
    float tolerance = receiver_tolerance(question);
    float depth = question.depth + question.slope.x * float(i) + question.slope.y * float(j);
    uint first = column.x;
    uint high = column.y;
    while (first < high) {  // the first that is not too deep
        uint middle = first + (high - first) / 2u;
        if (float(layer_word(layer, entries + middle) & 0xffffu) < depth - tolerance) {
            first = middle + 1u;
        } else {
            high = middle;
        }
    }
    ReceiverChoice result;
    result.receiver = kNoReceiver;
    result.off = tolerance;
    for (uint receiver = first; receiver < column.y; ++receiver) {
        uint word = layer_word(layer, entries + receiver);
        float above = float(word & 0xffffu) - depth;
        if (!(above <= tolerance)) break;
        float off = abs(above);
        bool nearer = result.receiver == kNoReceiver ? off <= result.off : off < result.off;
        if (nearer && receiver_takes(question, word)) {
            result.receiver = receiver;
            result.off = off;
        }
    }
    return result;
}

ReceiverShares no_receiver_shares() {
    ReceiverShares result;
    result.count = 0u;
    result.own_surface = true;
    result.receiver = uvec4(0u, 0u, 0u, 0u);
    result.weight = vec4(0.0, 0.0, 0.0, 0.0);
    return result;
}

ReceiverShares receiver_shares_of(uvec2 layer, ReceiverQuestion question) {
    ReceiverShares result = no_receiver_shares();
    if (!receiver_within_columns(question)) return result;
    vec2 low = vec2(floor(question.place.x), floor(question.place.y));
    float sum = 0.0;
    for (int k = 0; k < 4; ++k) {
        float right = question.place.x - low.x;
        float upper = question.place.y - low.y;
        float weight = (k % 2 == 1 ? right : 1.0 - right) * (k / 2 == 1 ? upper : 1.0 - upper);
        if (!(weight > 0.0)) continue;
        ReceiverChoice choice = receiver_best(layer, question, int(low.x) + k % 2, int(low.y) + k / 2);
        if (choice.receiver == kNoReceiver) continue;
        result.receiver[int(result.count)] = choice.receiver;
        result.weight[int(result.count)] = weight;
        ++result.count;
        sum += weight;
    }
    for (int k = 0; k < int(result.count); ++k) result.weight[k] /= sum;
    return result;
}

// `point`: grid units from the tile's origin. `normal`: of the surface, any length.
ReceiverShares receiver_shares(uvec2 layer, vec3 point, vec3 normal) {
    vec3 size = abs(normal);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    ReceiverQuestion own = receiver_question(layer, 2u * uint(axis) + (normal[axis] < 0.0 ? 1u : 0u), point, normal);
    float units = float(1u << RECEIVER_DEPTH_BITS);
    own.slope = vec2(-own.normal.y / own.normal.x * units, -own.normal.z / own.normal.x * units);
    own.depth -= own.slope.x * own.place.x + own.slope.y * own.place.y;
    ReceiverShares result = receiver_shares_of(layer, own);
    // Another surface's nearest receiver, for surfaces too small for the lattice. A loop of no rounds, not a branch: software drivers go through all
    // that a branch leaves out.
    uint columns = result.count > 0u ? 0u : 4u * uint(RECEIVER_CLASSES);
    ReceiverChoice nearest;
    nearest.receiver = kNoReceiver;
    nearest.off = 0.0;
    for (uint i = 0u; i < columns; ++i) {
        ReceiverQuestion loose = receiver_question(layer, i / 4u, point, normal);
        loose.loose = true;
        if (!receiver_within_columns(loose)) continue;
        ReceiverChoice choice =
            receiver_best(layer, loose, int(floor(loose.place.x)) + int(i % 2u), int(floor(loose.place.y)) + int(i / 2u % 2u));
        if (choice.receiver == kNoReceiver) continue;
        if (nearest.receiver == kNoReceiver || choice.off < nearest.off) nearest = choice;
    }
    if (columns == 0u) return result;
    result.own_surface = false;
    if (nearest.receiver == kNoReceiver) return result;
    result.count = 1u;
    result.receiver.x = nearest.receiver;
    result.weight.x = 1.0;
    return result;
}

#endif
