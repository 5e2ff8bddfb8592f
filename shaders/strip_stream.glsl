// The strip streams of a batch of meshes (codec/mesh/strip_layout.h) as words to scan, and the operators that scan them: the notes' T9 on the words of the
// streams rather than on single codes. What a pair of words is, by kind of stream:
//   codes       the codes of the words before, the sum of their differences: after it, the last explicit reference
//   increments  the set bits before; the second is unused
//   steps       the references that the steps before take; the kept reference Q of the last step that changes it, 4 added and counted from the first
//               reference taken; 0 where no step does
// The top bit of the first says that a mesh begins. Words that lie never lead outside the mesh's own part of any memory: all that is read or written
// through a number from the stream is clamped.
#ifndef CITYSTREAM_STRIP_STREAM_GLSL
#define CITYSTREAM_STRIP_STREAM_GLSL

#include "client/render/strip_decoder_layout.h"
#include "shaders/scan_look_back.glsl"
#include "shaders/words.glsl"

#define STRIP_HEAD 0x80000000u

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer StripRecords { StripRecord record[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) buffer StripWords { uint word[]; };
layout(push_constant) uniform Constants { StripConstants constants; };

// Of the words that the workgroup is at.
uint strip_kind = STRIP_KIND_CODES;

uvec2 scan_combine(uvec2 left, uvec2 right) {
    if ((right.x & STRIP_HEAD) != 0u) return right;
    if (strip_kind != STRIP_KIND_STEPS) return left + right;
    return uvec2(left.x + right.x, right.y != 0u ? right.y + (left.x & ~STRIP_HEAD) : left.y);
}

uint strip_first(uint mesh, uint kind) { return StripRecords(layer_reference(constants.records)).record[mesh].first[kind]; }

// The last mesh of low .. high whose words of the kind begin at `word` or before: those that have none are passed over.
uint strip_mesh_between(uint low, uint high, uint word) {
    while (low < high) {
        uint middle = (low + high + 1u) / 2u;
        if (strip_first(middle, strip_kind) <= word) low = middle;
        else high = middle - 1u;
    }
    return low;
}

shared uint strip_end_meshes[2];

// The mesh of the lane's word. All lanes call it.
uint strip_mesh(uint block_first, uint word) {
    if (constants.record_count == 1u) return 0u;
    uint lane = scan_lane();
    uint last = min(block_first + SCAN_LANES, constants.words[strip_kind]) - 1u;
    if (lane < 2u) strip_end_meshes[lane] = strip_mesh_between(0u, constants.record_count - 1u, lane == 0u ? block_first : last);
    barrier();
    uint mesh = strip_mesh_between(strip_end_meshes[0], strip_end_meshes[1], min(word, last));
    barrier();
    return mesh;
}

const uint kSimple9Widths[SIMPLE9_SELECTORS] = uint[](1u, 2u, 3u, 4u, 5u, 7u, 9u, 14u, 28u);
const uint kSimple9Counts[SIMPLE9_SELECTORS] = uint[](28u, 14u, 9u, 7u, 5u, 4u, 3u, 2u, 1u);

// Selectors that do not exist are read as the last.
uint simple9_selector(uint word) { return min(word & (1u << SIMPLE9_SELECTOR_BITS) - 1u, SIMPLE9_SELECTORS - 1u); }

// Of the code whose lowest bit is bit `shift` of the word.
uint strip_difference(uint word, uint shift, uint width, uint prediction) {
    uint code = word >> shift & (1u << width) - 1u;
    return (code >> 1 ^ -(code & 1u)) + prediction;
}

// The codes of a word, and the sum of their differences.
uvec2 strip_codes_value(uint word, uint prediction) {
    uint selector = simple9_selector(word);
    uint width = kSimple9Widths[selector];
    uint sum = 0u;
    for (uint shift = SIMPLE9_SELECTOR_BITS; shift + width <= 32u; shift += width) sum += strip_difference(word, shift, width, prediction);
    return uvec2(kSimple9Counts[selector], sum);
}

// A word of steps; masks have a bit at the first bit of each step.
struct StripSteps {
    uint bits;           // of a step
    uint word;
    uint switches;       // the step is another than the one before
    uint restarts;
    uint after_restart;  // the step is P and the one before R
    uint taken_before;   // references that the mesh's first triangle takes beyond its step's
};

// `before`: the step before the word's first; of a mesh's first that step itself.
StripSteps strip_steps(uint word, uint before, bool first, uint mode) {
    if (mode == STRIP_MODE_DEGENERATES) return StripSteps(1u, word, word ^ (word << 1 | before), 0u, 0u, first ? 2u : 0u);
    uint changed = word ^ (word << 2 | before);
    uint restarts = word >> 1 & 0x55555555u;
    uint previous_restarts = restarts << 2 | before >> 1;
    return StripSteps(2u, word, (changed | changed >> 1) & 0x55555555u, restarts, previous_restarts & ~(word | restarts) & 0x55555555u, 0u);
}

// The word's bits up to step `place`.
uint strip_mask(StripSteps steps, uint place) { return ~0u >> (31u - place * steps.bits); }

// References that the word's steps up to `place` take.
uint strip_taken(StripSteps steps, uint place) {
    return steps.taken_before + place + 1u + 2u * bitCount(steps.restarts & strip_mask(steps, place));
}

// The second word of the pair of the steps up to `place`.
uint strip_kept(StripSteps steps, uint place) {
    uint switches = steps.switches & strip_mask(steps, place);
    if (switches == 0u) return 0u;
    uint last = uint(findMSB(switches));
    return strip_taken(steps, last / steps.bits) + 1u - (steps.after_restart >> last & 1u);
}

uint strip_mode(StripRecord mesh) { return mesh.mode & STRIP_MODE_MASK; }
uint strip_steps_log2(StripRecord mesh) { return strip_mode(mesh) == STRIP_MODE_DEGENERATES ? 5u : 4u; }

// The step before word `at` of the mesh, whose own word is `word`.
uint strip_step_before(StripRecord mesh, uint at, uint word) {
    uint bits = strip_mode(mesh) == STRIP_MODE_DEGENERATES ? 1u : 2u;
    if (at == 0u) return word & (1u << bits) - 1u;
    return layer_word(layer_reference(mesh.layer), mesh.part_at[STRIP_KIND_STEPS] + at - 1u) >> (32u - bits);
}

uvec2 strip_steps_value(StripRecord mesh, uint at, uint word) {
    StripSteps steps = strip_steps(word, strip_step_before(mesh, at, word), at == 0u, strip_mode(mesh));
    uint log2 = strip_steps_log2(mesh);
    uint last = min(1u << log2, mesh.triangles - (at << log2)) - 1u;
    return uvec2(strip_taken(steps, last), strip_kept(steps, last));
}

// What the lane's word of block `block` of the kind adds; (0, 0) behind the last. All lanes call it.
uvec2 strip_load(uint block, out uint mesh, out uint at, out uint word) {
    uint block_first = block * SCAN_LANES;
    uint place = block_first + scan_lane();
    mesh = strip_mesh(block_first, place);
    at = 0u;
    word = 0u;
    if (place >= constants.words[strip_kind]) return uvec2(0u);
    StripRecord record = StripRecords(layer_reference(constants.records)).record[mesh];
    at = place - record.first[strip_kind];
    word = layer_word(layer_reference(record.layer), record.part_at[strip_kind] + at);
    uvec2 value = strip_kind == STRIP_KIND_CODES        ? strip_codes_value(word, record.mode >> STRIP_PREDICTION_BIT)
                  : strip_kind == STRIP_KIND_INCREMENTS ? uvec2(bitCount(word), 0u)
                                                        : strip_steps_value(record, at, word);
    return at == 0u ? value | uvec2(STRIP_HEAD, 0u) : value;
}

#endif
