// Corners of mesh layers as they lie in GPU memory (codec/mesh/RESIDENT.md). Twin of ResidentMeshView in codec/mesh/mesh_resident.h: same integers.
#ifndef CITYSTREAM_MESH_CORNER_GLSL
#define CITYSTREAM_MESH_CORNER_GLSL

#include "codec/chart_word_layout.h"
#include "codec/mesh/mesh_resident_layout.h"
#include "shaders/local_strips.glsl"
#include "shaders/octahedral.glsl"
#include "shaders/precision_fetch.glsl"

struct MeshCorner {
    ivec3 position;  // grid units from the tile's corner and base height
    ivec3 normal;    // any length but 0
    uint chart_entry;
    uint texcoord;  // q_u | q_v << 16
};

// What the frame grants: see PositionView.
struct MeshView {
    ivec3 from_camera;  // grid units from the camera's cell to the tile's corner
    uint distance_per_unit;
    uint least_dropped;
};

// Of the pipeline: kind and flags of all ranges that it draws (draw_layout.h).
layout(constant_id = MESH_FORM_CONSTANT) const uint kMeshForm = MESH_FORM_ANY;

// Whether the pipeline draws no images.
bool mesh_form_is_flat() { return kMeshForm != MESH_FORM_ANY && (kMeshForm >> 8 & RESIDENT_FLAG_TEXCOORDS) == 0u; }

// Words of the layer's range that is drawn.
struct MeshRange {
    uint at, flags;
    uint points;  // of a prism; else bits of q_u | of q_v << 8
    uint first_position;
};

uint mesh_range_word(uvec2 mesh, MeshRange range, uint word) { return layer_word(mesh, range.at + word); }

MeshRange mesh_range(uvec2 mesh, uint index) {
    uint at = uint(RESIDENT_HEADER_WORDS) + index * uint(RESIDENT_RANGE_WORDS);
    uint kind = layer_word(mesh, at + uint(RESIDENT_RANGE_KIND));
    return MeshRange(at, kMeshForm == MESH_FORM_ANY ? kind & 0xffffu : kMeshForm, kind >> 16, layer_word(mesh, at + uint(RESIDENT_RANGE_FIRST_POSITION)));
}

uint mesh_kind(MeshRange range) { return range.flags & 255u; }
bool mesh_has(MeshRange range, uint flag) { return (range.flags >> 8 & flag) != 0u; }

// Where position words lie: those of one bin.
struct MeshPositions {
    uint base, bit;  // of the first word asked for
    uint level, least_level, full_bits;
};

MeshPositions mesh_positions(uvec2 mesh, uint place) {
    uint at = layer_word(mesh, uint(RESIDENT_WORD_POSITIONS));
    uint shape = layer_word(mesh, at + uint(PRECISION_WORD_SHAPE));
    uint bins = shape & 255u;
    uint entries = at + uint(PRECISION_WORD_BINS);
    uint bin = 0u;
    if (bins > 1u) {
        for (uint step = uint(PRECISION_MOST_BINS) / 2u; step > 0u; step >>= 1) {
            uint next = bin + step;
            if (next < bins && (layer_word(mesh, entries + uint(PRECISION_BIN_WORDS) * next) & ((1u << PRECISION_BIN_LEVEL_SHIFT) - 1u)) <= place)
                bin = next;
        }
    }
    uint entry = layer_word(mesh, entries + uint(PRECISION_BIN_WORDS) * bin);
    uint first_bit = layer_word(mesh, entries + uint(PRECISION_BIN_WORDS) * bin + 1u);
    uint least = entry >> PRECISION_BIN_LEVEL_SHIFT;
    uint level = max(shape >> 24, least);
    uint within = place - (entry & ((1u << PRECISION_BIN_LEVEL_SHIFT) - 1u));
    return MeshPositions(entries + uint(PRECISION_BIN_WORDS) * bins, first_bit + within * level, level, least, shape >> 16 & 255u);
}

uint mesh_dropped(MeshPositions positions, uint wanted) {
    return max(min(wanted, positions.full_bits - positions.least_level), positions.full_bits - positions.level);
}

// `words`: as the buffer has them, level bits each.
ivec3 mesh_shown(uvec2 mesh, MeshPositions positions, uvec3 words, MeshView view) {
    ivec3 origin = ivec3(layer_word(mesh, uint(RESIDENT_WORD_ORIGIN_X)), layer_word(mesh, uint(RESIDENT_WORD_ORIGIN_Y)),
                         layer_word(mesh, uint(RESIDENT_WORD_ORIGIN_Z)));
    uvec3 known = words << positions.full_bits - positions.level;
    uint granted = precision_dropped(view.from_camera + origin, known, uint(RESIDENT_CELL_BITS), view.distance_per_unit);
    uint dropped = mesh_dropped(positions, max(granted, view.least_dropped));
    return origin + ivec3((known >> dropped << dropped) + precision_reading_offset(PRECISION_READ_THIRDS, dropped));
}

bool mesh_has_own_frames(uvec2 mesh) {
    return layer_word(mesh, uint(RESIDENT_WORD_FRAME + RESIDENT_FRAME_SHIFTS)) == RESIDENT_FRAMES_OF_THEIR_OWN;
}

// Words of an image's frame: RESIDENT_FRAME_*.
uint mesh_frame(uvec2 mesh, uint chart_entry) {
    return mesh_has_own_frames(mesh) ? chart_entry + uint(RESIDENT_CHART_FRAME) : uint(RESIDENT_WORD_FRAME);
}

uint mesh_chart_entry(uvec2 mesh, uint chart) {
    uint frames = mesh_has_own_frames(mesh) ? min(chart, layer_word(mesh, uint(RESIDENT_WORD_IMAGES))) : 0u;
    return layer_word(mesh, uint(RESIDENT_WORD_CHART_TABLE)) + chart + frames * uint(RESIDENT_FRAME_WORDS);
}

uint mesh_colour_entry(uvec2 mesh, uint colour) { return mesh_chart_entry(mesh, layer_word(mesh, uint(RESIDENT_WORD_IMAGES)) + colour); }

// A point of a prism's loop, as the buffer has it, in three loads. All words of prisms are in the first bin. Nothing behind the word that it ends in
// is touched.
uvec2 mesh_prism_point(uvec2 mesh, MeshPositions record, uint point) {
    uint level = record.level;
    uint bit = record.bit + (RESIDENT_PRISM_POINTS + 2u * point) * level;
    uint first = level == 0u ? 0u : record.base + (bit >> 5);
    uint last = level == 0u ? 0u : record.base + (bit + 2u * level - 1u >> 5);
    uint second = layer_word(mesh, min(first + 1u, last));
    uint low = read_across(layer_word(mesh, first), second, bit & 31u);
    uint high = read_across(second, layer_word(mesh, last), bit & 31u);
    return uvec2(low, read_across(low, high, level)) & precision_low_bits(level);
}

// Horizontal, across the edge from p to q, points as the step on show has them.
ivec3 mesh_wall_normal(MeshPositions record, uvec2 p, uvec2 q, MeshView view) {
    uint missing = record.full_bits - record.level;
    uint dropped = mesh_dropped(record, view.least_dropped);
    ivec2 along = ivec2((q << missing >> dropped << dropped) - (p << missing >> dropped << dropped));
    return along == ivec2(0) ? ivec3(1, 0, 0) : ivec3(along.y, -along.x, 0);
}

MeshCorner mesh_prism_corner(uvec2 mesh, MeshRange range, uint corner, MeshView view) {
    uint n = range.points;
    bool floors = mesh_has(range, RESIDENT_FLAG_FLOORS);
    bool wall_bases = mesh_has(range, RESIDENT_FLAG_WALL_BASES);
    uint each = 2u * n + (n - 2u) * (floors ? 2u : 1u);
    uint triangle = corner / 3u;
    uint k = corner - 3u * triangle;
    uint prism = triangle / each;
    triangle -= prism * each;

    uint bits = mesh_range_word(mesh, range, uint(RESIDENT_RANGE_BITS));
    uint index_bits = bits & 255u;
    uint face_bits = bits >> 8 & 255u;
    uint top_bits = bits >> 16 & 255u;
    uint faces = mesh_range_word(mesh, range, uint(RESIDENT_RANGE_FACES));
    uint field = prism * (top_bits + (floors ? 3u : 2u) * face_bits);

    bool is_wall = triangle < 2u * n;
    bool is_floor = triangle >= 3u * n - 2u;
    uint wall = triangle >> 1;
    uint next = wall + 1u == n ? 0u : wall + 1u;
    uint point = wall;
    uint height;
    bool is_ahead = false;  // the corner is at the edge's end
    if (is_wall) {
        bool second = (triangle & 1u) != 0u;
        is_ahead = second ? k == 1u : k >= 1u;
        uint base = wall_bases ? RESIDENT_PRISM_POINTS + 2u * n + wall : RESIDENT_PRISM_BASE;
        height = (second ? k >= 1u : k == 2u) ? RESIDENT_PRISM_TOP : base;
    } else {
        uint row = read_bits(mesh, faces, field, top_bits) * (n - 2u) + triangle - (is_floor ? 3u * n - 2u : 2u * n);
        point = read_bits(mesh, mesh_range_word(mesh, range, uint(RESIDENT_RANGE_TOPOLOGY)), (3u * row + (is_floor ? 2u - k : k)) * index_bits, index_bits);
        height = is_floor ? RESIDENT_PRISM_BASE : RESIDENT_PRISM_TOP;
    }
    MeshPositions record = mesh_positions(mesh, range.first_position + prism * (2u + (wall_bases ? 3u : 2u) * n));
    uvec2 p = mesh_prism_point(mesh, record, point);
    uvec2 q = mesh_prism_point(mesh, record, is_wall ? next : point);
    uint z = read_bits(mesh, record.base, record.bit + height * record.level, record.level);
    MeshCorner result;
    result.position = mesh_shown(mesh, record, uvec3(is_ahead ? q : p, z), view);
    result.normal = is_wall ? mesh_wall_normal(record, p, q, view) : ivec3(0, 0, is_floor ? -1 : 1);
    uint part = is_wall ? 0u : is_floor ? 2u : 1u;
    result.chart_entry = mesh_colour_entry(mesh, read_bits(mesh, faces, field + top_bits + part * face_bits, face_bits));
    result.texcoord = 0u;
    return result;
}

uint mesh_face(uvec2 mesh, MeshRange range, uint triangle, uint face_bits) {
    uint faces = mesh_range_word(mesh, range, uint(RESIDENT_RANGE_FACES));
    if (!mesh_has(range, RESIDENT_FLAG_RUNS)) return read_bits(mesh, faces, triangle * face_bits, face_bits);
    uint run = faces + (triangle >> 5) * uint(RESIDENT_RUN_WORDS);
    uint begun = layer_word(mesh, run + uint(RESIDENT_RUN_BEGINS)) & ((2u << (triangle & 31u)) - 1u);
    return layer_word(mesh, run + uint(RESIDENT_RUN_FACE)) + uint(bitCount(begun));
}

// q_u | q_v << 16. `zeros`: bits below them that are not stored.
uint mesh_packed_texcoord(uvec2 mesh, MeshRange range, uint vertex, uint zeros) {
    uvec2 bits = uvec2(range.points & 255u, range.points >> 8);
    uint all = bits.x + bits.y;
    uint both = read_bits(mesh, mesh_range_word(mesh, range, uint(RESIDENT_RANGE_TEXCOORDS)), vertex * all, all);
    uint low = both & ((1u << bits.x) - 1u);
    return low << (zeros & 15u) | both >> bits.x << (zeros >> 4) << 16;
}

// `vertex`: of the range. The triangle is that of `corner`.
MeshCorner mesh_surface_corner(uvec2 mesh, MeshRange range, uint corner, uint vertex, MeshView view) {
    uint range_bits = mesh_range_word(mesh, range, uint(RESIDENT_RANGE_BITS));
    uint point = vertex;
    if (mesh_has(range, RESIDENT_FLAG_POINTS)) {
        uint point_bits = range_bits >> 16 & 255u;
        point = read_bits(mesh, mesh_range_word(mesh, range, uint(RESIDENT_RANGE_POINTS)), vertex * point_bits, point_bits);
    }
    MeshPositions positions = mesh_positions(mesh, range.first_position + 3u * point);
    MeshCorner result;
    result.position = mesh_shown(mesh, positions, precision_fields(mesh, positions.base, positions.bit, uvec3(positions.level)), view);

    uint face = mesh_face(mesh, range, corner / 3u, range_bits >> 8 & 255u);
    uint bits = layer_word(mesh, uint(RESIDENT_WORD_BITS));
    uint normal_bits = bits & 255u;
    uint codes;
    uint code_bit;
    if (mesh_has(range, RESIDENT_FLAG_NORMALS)) {
        result.chart_entry = mesh_has(range, RESIDENT_FLAG_TEXCOORDS) ? mesh_chart_entry(mesh, face) : mesh_colour_entry(mesh, face);
        codes = mesh_range_word(mesh, range, uint(RESIDENT_RANGE_NORMALS));
        code_bit = vertex * 2u * normal_bits;
    } else {
        uint chart_bits = bits >> 8;
        codes = layer_word(mesh, uint(RESIDENT_WORD_FACE_TABLE));
        code_bit = face * (chart_bits + 2u * normal_bits);
        result.chart_entry = mesh_chart_entry(mesh, read_bits(mesh, codes, code_bit, chart_bits));
        code_bit += chart_bits;
    }
    uint code = read_bits(mesh, codes, code_bit, 2u * normal_bits);
    result.normal = unfold_octahedral(uvec2(code, code >> normal_bits) & ((1u << normal_bits) - 1u), normal_bits);
    result.texcoord = mesh_has(range, RESIDENT_FLAG_TEXCOORDS) ? mesh_packed_texcoord(mesh, range, vertex, range_bits >> 24) : 0u;
    return result;
}

// Of a range whose topology lies in the layer.
uint mesh_vertex(uvec2 mesh, MeshRange range, uint corner) {
    uint topology = mesh_range_word(mesh, range, uint(RESIDENT_RANGE_TOPOLOGY));
    if (mesh_kind(range) == uint(RESIDENT_KIND_LOCAL_STRIPS)) {
        uint triangle = corner / 3u;
        LocalGroup group = local_group(mesh, topology, triangle >> LOCAL_STRIPS_GROUP_SHIFT);
        uvec3 references = local_references(group, triangle & uint(LOCAL_STRIPS_GROUP_TRIANGLES - 1));
        return local_vertex(mesh, group, references[corner - 3u * triangle]);
    }
    uint bits = mesh_range_word(mesh, range, uint(RESIDENT_RANGE_BITS)) & 255u;
    return read_bits(mesh, topology, corner * bits, bits);
}

// Corner (3 * triangle + 0..2) of a range of any kind but strip code.
MeshCorner mesh_corner(uvec2 mesh, uint range, uint corner, ivec3 from_camera, uint distance_per_unit, uint least_dropped) {
    MeshRange drawn = mesh_range(mesh, range);
    MeshView view = MeshView(from_camera, distance_per_unit, least_dropped);
    if (mesh_kind(drawn) == uint(RESIDENT_KIND_PRISMS)) return mesh_prism_corner(mesh, drawn, corner, view);
    return mesh_surface_corner(mesh, drawn, corner, mesh_vertex(mesh, drawn, corner), view);
}

// Corner of a range of strip code, whose vertex the strip decoder has found.
MeshCorner mesh_corner_of_vertex(uvec2 mesh, uint range, uint corner, uint vertex, ivec3 from_camera, uint distance_per_unit, uint least_dropped) {
    return mesh_surface_corner(mesh, mesh_range(mesh, range), corner, vertex, MeshView(from_camera, distance_per_unit, least_dropped));
}

bool mesh_shows_colour(uvec2 mesh, uint chart_entry) { return (layer_word(mesh, chart_entry + uint(RESIDENT_CHART_WORD)) & CHART_WORD_COLOUR) != 0u; }

// 2^-16 repeats of the chart's image; 0 for a colour.
ivec2 mesh_texcoord(uvec2 mesh, uint chart_entry, uint texcoord) {
    if (mesh_shows_colour(mesh, chart_entry)) return ivec2(0);
    uint frame = mesh_frame(mesh, chart_entry);
    uint shifts = layer_word(mesh, frame + uint(RESIDENT_FRAME_SHIFTS));
    return ivec2(layer_word(mesh, frame + uint(RESIDENT_FRAME_BASE_U)) + ((texcoord & 0xffffu) << (shifts & 255u)),
                 layer_word(mesh, frame + uint(RESIDENT_FRAME_BASE_V)) + ((texcoord >> 16) << (shifts >> 8)));
}

// The same in repeats. Whole repeats along an axis that repeats are left out, the same for all corners of the chart in this mesh: floats keep
// their bits for the fraction.
vec2 mesh_place(uvec2 mesh, uint chart_entry, uint texcoord, bvec2 axis_repeats) {
    if (mesh_shows_colour(mesh, chart_entry)) return vec2(0.0);
    uint frame = mesh_frame(mesh, chart_entry);
    ivec2 base = ivec2(layer_word(mesh, frame + uint(RESIDENT_FRAME_BASE_U)), layer_word(mesh, frame + uint(RESIDENT_FRAME_BASE_V)));
    ivec2 left_out = ivec2(axis_repeats.x ? base.x & ~0xffff : 0, axis_repeats.y ? base.y & ~0xffff : 0);
    return vec2(mesh_texcoord(mesh, chart_entry, texcoord) - left_out) * (1.0 / 65536.0);
}

#endif
