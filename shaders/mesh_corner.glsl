// Corners of mesh layers as they lie in GPU memory (codec/mesh/RESIDENT.md). Twin of ResidentMeshView in codec/mesh/mesh_resident.h: same integers.
#ifndef CITYSTREAM_MESH_CORNER_GLSL
#define CITYSTREAM_MESH_CORNER_GLSL

#include "client/render/mesh_draw_layout.h"
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

// Of the pipeline: form of all ranges that it draws (draw_layout.h).
layout(constant_id = MESH_FORM_CONSTANT) const uint kMeshForm = MESH_FORM_ANY;

// Whether the pipeline draws no images.
bool mesh_form_is_flat() { return kMeshForm != MESH_FORM_ANY && (kMeshForm >> 8 & RESIDENT_FLAG_TEXCOORDS) == 0u; }

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer MeshDrawRecord { MeshDrawConstants draw; };

uint mesh_form(MeshDrawConstants draw) { return kMeshForm == MESH_FORM_ANY ? draw.form : kMeshForm; }
uint mesh_kind(MeshDrawConstants draw) { return mesh_form(draw) & 255u; }
bool mesh_has(MeshDrawConstants draw, uint flag) { return (mesh_form(draw) >> 8 & flag) != 0u; }

// Where position words lie: those of one bin.
struct MeshPositions {
    uint bit;  // of the first word asked for, from the payload's beginning
    uint level, least_level;
};

// `place`: in the buffer, of the first bin.
MeshPositions mesh_first_bin(MeshDrawConstants draw, uint place) { return MeshPositions(place * draw.level, draw.level, draw.least_level); }

uint mesh_bin_begin(uint entry) { return entry & (1u << PRECISION_BIN_LEVEL_SHIFT) - 1u; }

MeshPositions mesh_positions(uvec2 mesh, MeshDrawConstants draw, uint place) {
    if ((mesh_form(draw) & MESH_FORM_BINS) == 0u) return mesh_first_bin(draw, place);
    uint bin = 0u;
    for (uint step = uint(PRECISION_MOST_BINS) / 2u; step > 0u; step >>= 1) {
        uint next = bin + step;
        if (next < draw.bins && mesh_bin_begin(layer_word(mesh, draw.bins_at + uint(PRECISION_BIN_WORDS) * next)) <= place) bin = next;
    }
    uint entry = layer_word(mesh, draw.bins_at + uint(PRECISION_BIN_WORDS) * bin);
    uint first_bit = layer_word(mesh, draw.bins_at + uint(PRECISION_BIN_WORDS) * bin + 1u);
    uint least = entry >> PRECISION_BIN_LEVEL_SHIFT;
    uint level = max(draw.level, least);
    return MeshPositions(first_bit + (place - mesh_bin_begin(entry)) * level, level, least);
}

uint mesh_dropped(MeshDrawConstants draw, MeshPositions positions, uint wanted) {
    return max(min(wanted, draw.full_bits - positions.least_level), draw.full_bits - positions.level);
}

// `words`: as the buffer has them, level bits each.
ivec3 mesh_shown(MeshDrawConstants draw, MeshPositions positions, uvec3 words, MeshView view) {
    ivec3 origin = ivec3(draw.origin[0], draw.origin[1], draw.origin[2]);
    uvec3 known = words << draw.full_bits - positions.level;
    uint granted = precision_dropped(view.from_camera + origin, known, uint(RESIDENT_CELL_BITS), view.distance_per_unit);
    uint dropped = mesh_dropped(draw, positions, max(granted, view.least_dropped));
    return origin + ivec3((known >> dropped << dropped) + precision_reading_offset(PRECISION_READ_THIRDS, dropped));
}

uint mesh_chart_entry(MeshDrawConstants draw, uint chart) { return draw.chart_table + chart + min(chart, draw.chart_frames) * uint(RESIDENT_FRAME_WORDS); }

// Two fields, one after the other, of 0..31 and 0..32 bits, in three loads; behind the second there are bits of what follows. Nothing behind the word that
// it ends in is touched.
uvec2 mesh_two_fields(uvec2 mesh, uint base, uint bit, uint first_bits, uint second_bits) {
    uint bits = first_bits + second_bits;
    uint first = bits == 0u ? 0u : base + (bit >> 5);
    uint last = bits == 0u ? 0u : base + (bit + bits - 1u >> 5);
    uint second = layer_word(mesh, min(first + 1u, last));
    uint low = read_across(layer_word(mesh, first), second, bit & 31u);
    uint high = read_across(second, layer_word(mesh, last), bit & 31u);
    return uvec2(low & precision_low_bits(first_bits), read_across(low, high, first_bits));
}

// A point of a prism's loop, as the buffer has it. All words of prisms are in the first bin.
uvec2 mesh_prism_point(uvec2 mesh, MeshDrawConstants draw, MeshPositions record, uint point) {
    uint level = record.level;
    uint bit = record.bit + (RESIDENT_PRISM_POINTS + 2u * point) * level;
    if ((mesh_form(draw) & MESH_FORM_NARROW) == 0u) return mesh_two_fields(mesh, draw.positions_at, bit, level, level) & precision_low_bits(level);
    uint both = read_bits(mesh, draw.positions_at, bit, 2u * level);
    return uvec2(both & precision_low_bits(level), both >> level);
}

// Horizontal, across the edge from p to q, points as the step on show has them.
ivec3 mesh_wall_normal(MeshDrawConstants draw, MeshPositions record, uvec2 p, uvec2 q, MeshView view) {
    uint missing = draw.full_bits - record.level;
    uint dropped = mesh_dropped(draw, record, view.least_dropped);
    ivec2 along = ivec2((q << missing >> dropped << dropped) - (p << missing >> dropped << dropped));
    return along == ivec2(0) ? ivec3(1, 0, 0) : ivec3(along.y, -along.x, 0);
}

// number / divisor without a division: the product may be one too large.
uint mesh_quotient(uint number, uint divisor, uint inverse) {
    uint quotient, low;
    umulExtended(number, inverse, quotient, low);
    return quotient * divisor > number ? quotient - 1u : quotient;
}

// Of a prism of the range: a triangle of it, and its corner k.
struct MeshPrismCorner {
    uint prism, triangle, k;
};

MeshPrismCorner mesh_prism_of_corner(MeshDrawConstants draw, uint corner) {
    uint triangle = corner / 3u;
    uint prism = mesh_quotient(triangle, draw.triangles, draw.triangles_inverse);
    return MeshPrismCorner(prism, triangle - prism * draw.triangles, corner - 3u * triangle);
}

// Of a vertex where the triangles of walls share them (client/render/prism_indices.h).
MeshPrismCorner mesh_prism_of_shared(MeshDrawConstants draw, uint vertex) {
    uint prism = mesh_quotient(vertex, draw.vertices, draw.vertices_inverse);
    uint within = vertex - prism * draw.vertices;
    uint of_wall = within & 3u;
    if (within < 4u * draw.points) return MeshPrismCorner(prism, (within >> 2) * 2u + (of_wall == 3u ? 1u : 0u), of_wall == 3u ? 2u : of_wall);
    uint corner = within - 4u * draw.points;
    return MeshPrismCorner(prism, 2u * draw.points + corner / 3u, corner % 3u);
}

// What a prism has besides positions: number of its top, and a colour (0: walls, 1: top, 2: floor).
uvec2 mesh_prism_fields(uvec2 mesh, MeshDrawConstants draw, uint prism, uint part) {
    uint at = prism * draw.prism_bits;
    uint colour_at = draw.top_bits + part * draw.face_bits;
    if ((mesh_form(draw) & MESH_FORM_NARROW) == 0u)
        return uvec2(read_bits(mesh, draw.faces, at, draw.top_bits), read_bits(mesh, draw.faces, at + colour_at, draw.face_bits));
    uint fields = read_bits(mesh, draw.faces, at, draw.prism_bits);
    return uvec2(bitfieldExtract(fields, 0, int(draw.top_bits)), bitfieldExtract(fields, int(colour_at), int(draw.face_bits)));
}

MeshCorner mesh_prism_corner(uvec2 mesh, MeshDrawConstants draw, MeshPrismCorner corner, MeshView view) {
    uint n = draw.points;
    bool wall_bases = mesh_has(draw, RESIDENT_FLAG_WALL_BASES);
    uint triangle = corner.triangle;
    uint k = corner.k;

    bool is_wall = triangle < 2u * n;
    bool is_floor = triangle >= 3u * n - 2u;
    uvec2 fields = mesh_prism_fields(mesh, draw, corner.prism, is_wall ? 0u : is_floor ? 2u : 1u);
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
        uint row = fields.x * (n - 2u) + triangle - (is_floor ? 3u * n - 2u : 2u * n);
        point = read_bits(mesh, draw.topology, (3u * row + (is_floor ? 2u - k : k)) * draw.index_bits, draw.index_bits);
        height = is_floor ? RESIDENT_PRISM_BASE : RESIDENT_PRISM_TOP;
    }
    MeshPositions record = mesh_first_bin(draw, draw.first_position + corner.prism * (2u + (wall_bases ? 3u : 2u) * n));
    uvec2 p = mesh_prism_point(mesh, draw, record, point);
    uvec2 q = mesh_prism_point(mesh, draw, record, is_wall ? next : point);
    uint z = read_bits(mesh, draw.positions_at, record.bit + height * record.level, record.level);
    MeshCorner result;
    result.position = mesh_shown(draw, record, uvec3(is_ahead ? q : p, z), view);
    result.normal = is_wall ? mesh_wall_normal(draw, record, p, q, view) : ivec3(0, 0, is_floor ? -1 : 1);
    result.chart_entry = draw.colours_at + fields.y;
    result.texcoord = 0u;
    return result;
}

uint mesh_face(uvec2 mesh, MeshDrawConstants draw, uint triangle) {
    if (!mesh_has(draw, RESIDENT_FLAG_RUNS)) return read_bits(mesh, draw.faces, triangle * draw.face_bits, draw.face_bits);
    uint run = draw.faces + (triangle >> 5) * uint(RESIDENT_RUN_WORDS);
    uint begun = layer_word(mesh, run + uint(RESIDENT_RUN_BEGINS)) & ((2u << (triangle & 31u)) - 1u);
    return layer_word(mesh, run + uint(RESIDENT_RUN_FACE)) + uint(bitCount(begun));
}

// q_u | q_v << 16.
uint mesh_packed_texcoord(uvec2 mesh, MeshDrawConstants draw, uint vertex) {
    uint all = draw.texcoord_bits[0] + draw.texcoord_bits[1];
    uint both = read_bits(mesh, draw.texcoords, vertex * all, all);
    uint low = both & ((1u << draw.texcoord_bits[0]) - 1u);
    return low << draw.texcoord_shifts[0] | both >> draw.texcoord_bits[0] << draw.texcoord_shifts[1] << 16;
}

// Of chart and normal, of which a vertex may have its own.
void mesh_show_face(uvec2 mesh, MeshDrawConstants draw, uint face, uint vertex, inout MeshCorner corner) {
    uint code_bits = 2u * draw.normal_bits;
    uint code;
    if (mesh_has(draw, RESIDENT_FLAG_NORMALS)) {
        corner.chart_entry = mesh_has(draw, RESIDENT_FLAG_TEXCOORDS) ? mesh_chart_entry(draw, face) : draw.colours_at + face;
        code = read_bits(mesh, draw.normals, vertex * code_bits, code_bits);
    } else {
        uint chart_bits = draw.face_chart_bits;
        uvec2 fields = mesh_two_fields(mesh, draw.face_table, face * (chart_bits + code_bits), chart_bits, code_bits);
        corner.chart_entry = mesh_chart_entry(draw, fields.x);
        code = fields.y;
    }
    corner.normal = unfold_octahedral(uvec2(code, code >> draw.normal_bits) & ((1u << draw.normal_bits) - 1u), draw.normal_bits);
}

// `vertex`: of the range. The triangle is that of `corner`.
MeshCorner mesh_surface_corner(uvec2 mesh, MeshDrawConstants draw, uint corner, uint vertex, MeshView view) {
    uint point = vertex;
    if (mesh_has(draw, RESIDENT_FLAG_POINTS)) point = read_bits(mesh, draw.vertex_points, vertex * draw.top_bits, draw.top_bits);
    MeshPositions positions = mesh_positions(mesh, draw, draw.first_position + 3u * point);
    MeshCorner result;
    result.position = mesh_shown(draw, positions, precision_fields(mesh, draw.positions_at, positions.bit, uvec3(positions.level)), view);
    mesh_show_face(mesh, draw, mesh_face(mesh, draw, corner / 3u), vertex, result);
    result.texcoord = mesh_has(draw, RESIDENT_FLAG_TEXCOORDS) ? mesh_packed_texcoord(mesh, draw, vertex) : 0u;
    return result;
}

// Of a range whose topology lies in the layer.
uint mesh_vertex(uvec2 mesh, MeshDrawConstants draw, uint corner) {
    if (mesh_kind(draw) == uint(RESIDENT_KIND_LOCAL_STRIPS)) {
        uint triangle = corner / 3u;
        LocalGroup group = local_group(mesh, draw.topology, draw.topology_triangles, triangle >> LOCAL_STRIPS_GROUP_SHIFT);
        uvec3 references = local_references(group, triangle & uint(LOCAL_STRIPS_GROUP_TRIANGLES - 1));
        return local_vertex(mesh, group, references[corner - 3u * triangle]);
    }
    return read_bits(mesh, draw.topology, corner * draw.index_bits, draw.index_bits);
}

// Corner (3 * triangle + 0..2) of a range of any kind but strip code.
MeshCorner mesh_corner(uvec2 mesh, MeshDrawConstants draw, uint corner, MeshView view) {
    if (mesh_kind(draw) == uint(RESIDENT_KIND_PRISMS)) return mesh_prism_corner(mesh, draw, mesh_prism_of_corner(draw, corner), view);
    return mesh_surface_corner(mesh, draw, corner, mesh_vertex(mesh, draw, corner), view);
}

// Words of an image's frame: RESIDENT_FRAME_*.
uint mesh_frame(MeshDrawConstants draw, uint chart_entry) { return draw.chart_frames > 0u ? chart_entry + uint(RESIDENT_CHART_FRAME) : draw.frame_at; }

bool mesh_shows_colour(uvec2 mesh, uint chart_entry) { return (layer_word(mesh, chart_entry + uint(RESIDENT_CHART_WORD)) & CHART_WORD_COLOUR) != 0u; }

// 2^-16 repeats of the chart's image; 0 for a colour.
ivec2 mesh_texcoord(uvec2 mesh, MeshDrawConstants draw, MeshCorner corner) {
    if (mesh_shows_colour(mesh, corner.chart_entry)) return ivec2(0);
    uint frame = mesh_frame(draw, corner.chart_entry);
    uint shifts = layer_word(mesh, frame + uint(RESIDENT_FRAME_SHIFTS));
    return ivec2(layer_word(mesh, frame + uint(RESIDENT_FRAME_BASE_U)) + ((corner.texcoord & 0xffffu) << (shifts & 255u)),
                 layer_word(mesh, frame + uint(RESIDENT_FRAME_BASE_V)) + ((corner.texcoord >> 16) << (shifts >> 8)));
}

// The same in repeats. Whole repeats along an axis that repeats are left out, the same for all corners of the chart in this mesh: floats keep
// their bits for the fraction.
vec2 mesh_place(uvec2 mesh, MeshDrawConstants draw, MeshCorner corner, bvec2 axis_repeats) {
    if (mesh_shows_colour(mesh, corner.chart_entry)) return vec2(0.0);
    uint frame = mesh_frame(draw, corner.chart_entry);
    ivec2 base = ivec2(layer_word(mesh, frame + uint(RESIDENT_FRAME_BASE_U)), layer_word(mesh, frame + uint(RESIDENT_FRAME_BASE_V)));
    ivec2 left_out = ivec2(axis_repeats.x ? base.x & ~0xffff : 0, axis_repeats.y ? base.y & ~0xffff : 0);
    return vec2(mesh_texcoord(mesh, draw, corner) - left_out) * (1.0 / 65536.0);
}

#endif
