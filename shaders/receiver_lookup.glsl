// Which receivers light a point of a tile's surface (codec/radiance/RECEIVERS.md). Twin of ReceiverTableView::shares in codec/radiance/receiver_table.h:
// same names, same floats. Written in the common subset of GLSL and C++ (words.glsl).
#ifndef CITYSTREAM_RECEIVER_LOOKUP_GLSL
#define CITYSTREAM_RECEIVER_LOOKUP_GLSL

#include "codec/radiance/receiver_layout.h"
#include "shaders/words.glsl"

const uint kNoReceiver = 0xffffffffu;

// Of the four columns around a point: first (0, 0), then (1, 0), (0, 1) and (1, 1). Weights add up to 1, and are 0 where a column has no receiver that
// serves; or none was found: the light of the open sky.
struct ReceiverShares {
    bool found;
    bool own_surface;
    vec3 normal;  // of one that stands in, any length
    uvec4 receiver;
    vec4 weight;
};

// A point seen along a class: own axis, then the column's. Depths in spacings / 64.
struct ReceiverQuestion {
    uint surface_class;
    vec3 normal;
    float square;  // of the normal's length
    vec2 place;    // spacings
    float depth;   // at column (0, 0)
    vec2 slope;
    bool loose;
    float tolerance;
    uvec4 rows;    // RECEIVER_CLASS_*
    uint entries;  // offset
};

struct ReceiverChoice {
    uint receiver;
    float off;
};

// Of the four columns around a point.
struct ReceiverColumns {
    uvec4 first;
    uvec4 end;
};

// The header is read in groups of four words: the first, and one for each class.
uvec4 receiver_class(uvec2 layer, uint surface_class) {
    return layer_words4(layer, (uint(RECEIVER_WORD_CLASSES) + surface_class * uint(RECEIVER_CLASS_WORDS)) / 4u);
}

bool receiver_takes(ReceiverQuestion question, uint word) {
    float a = float(int(word << 8) >> 24);
    float b = float(int(word) >> 24);
    float one = question.surface_class % 2u == 0u ? float(RECEIVER_TILT_ONE) : -float(RECEIVER_TILT_ONE);
    float cosine = one * question.normal.x + a * question.normal.y + b * question.normal.z;
    float lengths = question.square * (one * one + a * a + b * b);
    bool near = cosine > 0.0 && cosine * cosine > float(RECEIVER_COSINE_SQUARED) * lengths;
    return question.loose ? cosine >= 0.0 : near;
}

// What a receiver that is not turned as the surface is costs, in units of depth.
float receiver_turned(ReceiverQuestion question, uint word) {
    float a = float(int(word << 8) >> 24);
    float b = float(int(word) >> 24);
    float one = question.surface_class % 2u == 0u ? float(RECEIVER_TILT_ONE) : -float(RECEIVER_TILT_ONE);
    float cosine = one * question.normal.x + a * question.normal.y + b * question.normal.z;
    float lengths = question.square * (one * one + a * a + b * b);
    return float(RECEIVER_TURNED) * (1.0 - cosine * abs(cosine) / lengths);
}

// Of a receiver, in the world's axes.
vec3 receiver_normal(uint surface_class, uint word) {
    int own = int(surface_class / 2u);
    vec3 normal = vec3(0.0, 0.0, 0.0);
    normal[own] = surface_class % 2u == 0u ? float(RECEIVER_TILT_ONE) : -float(RECEIVER_TILT_ONE);
    normal[(own + 1) % 3] = float(int(word << 8) >> 24);
    normal[(own + 2) % 3] = float(int(word) >> 24);
    return normal;
}

bool receiver_within_columns(ReceiverQuestion question) {
    return abs(question.place.x) < float(RECEIVER_MOST_COLUMN) && abs(question.place.y) < float(RECEIVER_MOST_COLUMN);
}

// Columns (i, j) and its three neighbours. Begins of three columns lie in two words.
ReceiverColumns receiver_columns(uvec2 layer, uvec4 rows, int i, int j) {
    ReceiverColumns result;
    result.first = uvec4(0u, 0u, 0u, 0u);
    result.end = uvec4(0u, 0u, 0u, 0u);
    for (int k = 0; k < 4; k += 2) {
        uint row = uint(j + k / 2) - rows[RECEIVER_CLASS_FIRST_ROW];
        if (row >= rows[RECEIVER_CLASS_ROWS]) continue;
        uint at = rows[RECEIVER_CLASS_ROW_TABLE] + row * uint(RECEIVER_ROW_WORDS);
        uint columns = layer_word(layer, at + uint(RECEIVER_ROW_COLUMNS));
        if (columns >> 16 == 0u) continue;
        uint begins = layer_word(layer, at + uint(RECEIVER_ROW_BEGINS));
        uint first = layer_word(layer, at + uint(RECEIVER_ROW_FIRST));
        int place = i - (int(columns << 16) >> 16);
        int last = int(columns >> 16);
        uint left = uint(clamp(place, 0, last));
        uint middle = uint(clamp(place + 1, 0, last));
        uint right = uint(clamp(place + 2, 0, last));
        uint left_word = layer_word(layer, begins + left / 2u);
        uint right_word = layer_word(layer, begins + right / 2u);
        uint middle_word = middle / 2u == left / 2u ? left_word : right_word;
        uint between = first + (middle_word >> middle % 2u * 16u & 0xffffu);
        result.first[k] = first + (left_word >> left % 2u * 16u & 0xffffu);
        result.end[k] = between;
        result.first[k + 1] = between;
        result.end[k + 1] = first + (right_word >> right % 2u * 16u & 0xffffu);
    }
    return result;
}

// `loose`: of another surface, see receiver_shares.
ReceiverQuestion receiver_question(uvec2 layer, uvec4 header, uint surface_class, bool loose, vec3 point, vec3 normal) {
    int own = int(surface_class / 2u);
    int a = (own + 1) % 3;
    int b = (own + 2) % 3;
    ReceiverQuestion result;
    result.rows = receiver_class(layer, surface_class);
    result.entries = header[RECEIVER_WORD_ENTRIES];
    float spacing = float(1u << header[RECEIVER_WORD_SPACING]);
    float base = float(int(result.rows[RECEIVER_CLASS_DEPTH]));
    float units = float(1u << RECEIVER_DEPTH_BITS);
    result.surface_class = surface_class;
    result.normal = vec3(normal[own], normal[a], normal[b]);
    result.square = result.normal.x * result.normal.x + result.normal.y * result.normal.y + result.normal.z * result.normal.z;
    result.place = vec2(point[a] / spacing, point[b] / spacing);
    result.depth = (point[own] - base) / spacing * units;
    result.slope = vec2(0.0, 0.0);
    if (!loose) {
        result.slope = vec2(-result.normal.y / result.normal.x * units, -result.normal.z / result.normal.x * units);
        result.depth -= result.slope.x * result.place.x + result.slope.y * result.place.y;
    }
    result.loose = loose;
    result.tolerance = loose ? float(RECEIVER_LOOSE_TOLERANCE) : float(RECEIVER_TOLERANCE);
    return result;
}

// Of a column's receivers; it has one or more. Each round reads one: by halving while there are many, then one after the other.
ReceiverChoice receiver_best(uvec2 layer, ReceiverQuestion question, uint first, uint end, float depth) {
    ReceiverChoice result;
    result.receiver = kNoReceiver;
    result.off = question.tolerance;
    uint high = end;
    bool goes_on = true;
    do {
        bool halves = first + uint(RECEIVER_FEW) < high;
        uint at = halves ? first + (high - first) / 2u : first;
        uint word = layer_word(layer, question.entries + at);
        float stored = float(word & 0xffffu);
        float above = stored - depth;
        float off = abs(above);
        bool shallow = stored < depth - question.tolerance;
        bool nearer = result.receiver == kNoReceiver ? off <= result.off : off < result.off;
        bool serves = !halves && !shallow && above <= question.tolerance && nearer && receiver_takes(question, word);
        result.receiver = serves ? at : result.receiver;
        result.off = serves ? off : result.off;
        high = halves && !shallow ? at : high;
        first = halves && !shallow ? first : at + 1u;
        goes_on = first < end && (halves || above <= question.tolerance);
    } while (goes_on);
    return result;
}

// `point`: grid units from the tile's origin. `normal`: of the surface, any length. The first round asks for receivers of the point's own surface; where
// there are none, six more ask each class for another surface's nearest, for surfaces too small for the lattice. One body of the loop for both:
// software drivers go through all that a branch leaves out.
ReceiverShares receiver_shares(uvec2 layer, vec3 point, vec3 normal) {
    uvec4 header = layer_words4(layer, 0u);
    vec3 size = abs(normal);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    uint own_class = 2u * uint(axis) + (normal[axis] < 0.0 ? 1u : 0u);
    ReceiverShares result;
    result.found = false;
    result.own_surface = true;
    result.normal = vec3(0.0, 0.0, 0.0);
    result.receiver = uvec4(0u, 0u, 0u, 0u);
    result.weight = vec4(0.0, 0.0, 0.0, 0.0);
    float sum = 0.0;
    ReceiverChoice nearest;
    nearest.receiver = kNoReceiver;
    nearest.off = 0.0;
    uint round = 0u;
    do {
        bool loose = round > 0u;
        ReceiverQuestion question = receiver_question(layer, header, loose ? round - 1u : own_class, loose, point, normal);
        ++round;
        bool looks_down = loose && question.surface_class == uint(RECEIVER_DOWNWARDS) && own_class != uint(RECEIVER_DOWNWARDS);
        if (looks_down || !receiver_within_columns(question)) continue;
        vec2 low = vec2(floor(question.place.x), floor(question.place.y));
        ReceiverColumns columns = receiver_columns(layer, question.rows, int(low.x), int(low.y));
        for (int k = 0; k < 4; ++k) {
            float right = question.place.x - low.x;
            float upper = question.place.y - low.y;
            float weight = (k % 2 == 1 ? right : 1.0 - right) * (k / 2 == 1 ? upper : 1.0 - upper);
            if (columns.first[k] >= columns.end[k] || !(loose || weight > 0.0)) continue;
            float depth = question.depth + question.slope.x * float(int(low.x) + k % 2) + question.slope.y * float(int(low.y) + k / 2);
            ReceiverChoice choice = receiver_best(layer, question, columns.first[k], columns.end[k], depth);
            if (choice.receiver == kNoReceiver) continue;
            if (loose) {
                uint word = layer_word(layer, question.entries + choice.receiver);
                choice.off += receiver_turned(question, word);
                if (nearest.receiver != kNoReceiver && !(choice.off < nearest.off)) continue;
                nearest = choice;
                result.normal = receiver_normal(question.surface_class, word);
            } else {
                result.found = true;
                result.receiver[k] = choice.receiver;
                result.weight[k] = weight;
                sum += weight;
            }
        }
    } while (!result.found && round <= uint(RECEIVER_CLASSES));
    if (result.found) {
        for (int k = 0; k < 4; ++k) result.weight[k] /= sum;
        return result;
    }
    result.own_surface = false;
    result.found = nearest.receiver != kNoReceiver;
    result.receiver.x = result.found ? nearest.receiver : 0u;
    result.weight.x = result.found ? 1.0 : 0.0;
    return result;
}

#endif
