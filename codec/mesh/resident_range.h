// One range of a mesh layer in GPU memory, read word by word: what the view and its check share. Twin of the range's
// part of shaders/mesh_corner.glsl.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "codec/bits/bit_stream.h"
#include "codec/mesh/mesh_resident_layout.h"

namespace citystream::codec::mesh {

struct ResidentRange {
    std::span<const uint32_t> words;  ///< of the layer
    uint32_t kind = 0, flags = 0;
    uint32_t points = 0;                                        ///< of a prism
    std::array<uint32_t, 2> texcoord_bits{}, texcoord_zeros{};  ///< of q_u and q_v
    uint32_t triangles = 0, first_triangle = 0;
    uint32_t vertices = 0;  ///< or prisms
    uint32_t first_position = 0;
    uint32_t topology = 0, topology_words = 0;
    uint32_t index_bits = 0, face_bits = 0;
    uint32_t top_bits = 0;  ///< or of a point
    uint32_t faces = 0, texcoords = 0, normals = 0, points_of_vertices = 0;

    /// Precondition: the table of ranges is in the words.
    ResidentRange(std::span<const uint32_t> layer, uint32_t index) : words(layer) {
        const auto range = layer.subspan(RESIDENT_HEADER_WORDS + size_t{index} * RESIDENT_RANGE_WORDS);
        kind = range[RESIDENT_RANGE_KIND] & 255;
        flags = range[RESIDENT_RANGE_KIND] >> 8 & 255;
        const uint32_t sizes = range[RESIDENT_RANGE_KIND] >> 16, zeros = range[RESIDENT_RANGE_BITS] >> 24;
        points = kind == RESIDENT_KIND_PRISMS ? sizes : 0;
        if (kind != RESIDENT_KIND_PRISMS) texcoord_bits = {sizes & 255, sizes >> 8};
        texcoord_zeros = {zeros & 15, zeros >> 4};
        triangles = range[RESIDENT_RANGE_TRIANGLES];
        first_triangle = range[RESIDENT_RANGE_FIRST_TRIANGLE];
        vertices = range[RESIDENT_RANGE_VERTICES];
        first_position = range[RESIDENT_RANGE_FIRST_POSITION];
        topology = range[RESIDENT_RANGE_TOPOLOGY];
        topology_words = range[RESIDENT_RANGE_TOPOLOGY_WORDS];
        index_bits = range[RESIDENT_RANGE_BITS] & 255;
        face_bits = range[RESIDENT_RANGE_BITS] >> 8 & 255;
        top_bits = range[RESIDENT_RANGE_BITS] >> 16 & 255;
        faces = range[RESIDENT_RANGE_FACES];
        texcoords = range[RESIDENT_RANGE_TEXCOORDS];
        normals = range[RESIDENT_RANGE_NORMALS];
        points_of_vertices = range[RESIDENT_RANGE_POINTS];
    }

    bool has(uint32_t flag) const { return (flags & flag) != 0; }
    uint32_t field(uint32_t offset, uint64_t bit, uint32_t bits) const {
        return bits == 0 ? 0 : bits::read_bits(words.subspan(offset), bit, bits);
    }
    /// Triangles of a prism, position words of a prism, colours that it has.
    uint64_t prism_triangles() const {
        return 2 * uint64_t{points} + (points - 2) * (has(RESIDENT_FLAG_FLOORS) ? 2u : 1u);
    }
    uint64_t record_words() const { return 2 + uint64_t{has(RESIDENT_FLAG_WALL_BASES) ? 3u : 2u} * points; }
    uint32_t prism_colours() const { return has(RESIDENT_FLAG_FLOORS) ? 3 : 2; }
    uint32_t prism_field_bits() const { return top_bits + prism_colours() * face_bits; }
    /// Bits of a triangulation.
    uint64_t row_bits() const { return uint64_t{points - 2} * 3 * index_bits; }
    uint32_t prism_top(uint32_t prism) const { return field(faces, uint64_t{prism} * prism_field_bits(), top_bits); }
    /// 0: walls, 1: top, 2: floor.
    uint32_t prism_colour(uint32_t prism, uint32_t part) const {
        return field(faces, uint64_t{prism} * prism_field_bits() + top_bits + part * face_bits, face_bits);
    }
    uint32_t row_corner(uint32_t row, uint32_t triangle, uint32_t k) const {
        return field(topology, row * row_bits() + (uint64_t{3} * triangle + k) * index_bits, index_bits);
    }
    uint32_t index(uint64_t corner) const { return field(topology, corner * index_bits, index_bits); }
    uint32_t point(uint32_t vertex) const {
        if (!has(RESIDENT_FLAG_POINTS)) return vertex;
        return field(points_of_vertices, uint64_t{vertex} * top_bits, top_bits);
    }
    /// q_u | q_v << 16.
    uint32_t texcoord(uint32_t vertex) const {
        const auto [u, v] = texcoord_bits;
        const uint64_t bit = uint64_t{vertex} * (u + v);
        return field(texcoords, bit, u) << texcoord_zeros[0] | field(texcoords, bit + u, v) << texcoord_zeros[1] << 16;
    }
    uint32_t face(uint32_t triangle) const {
        if (!has(RESIDENT_FLAG_RUNS)) return field(faces, uint64_t{triangle} * face_bits, face_bits);
        const auto run = words.subspan(faces + size_t{triangle / 32} * RESIDENT_RUN_WORDS, RESIDENT_RUN_WORDS);
        const uint32_t begun = run[RESIDENT_RUN_BEGINS] & ((2u << (triangle & 31)) - 1);
        return run[RESIDENT_RUN_FACE] + static_cast<uint32_t>(std::popcount(begun));
    }
    std::span<const uint32_t> topology_span() const { return words.subspan(topology, topology_words); }
};

}  // namespace citystream::codec::mesh
