#include "client/render/mesh_draws.h"

#include <algorithm>

#include "codec/mesh/local_strips_layout.h"
#include "codec/mesh/mesh_resident_layout.h"
#include "codec/mesh/precision_layout.h"

namespace citystream::client {

namespace {

using Words = std::span<const uint32_t>;

uint32_t word_at(Words words, uint64_t index) {
    return index < words.size() ? words[index] : 0;
}

void set_level(MeshDrawConstants& draw, uint32_t level) {
    draw.level = std::max(level, draw.least_level);
    const bool is_narrow = (draw.form & 255) == RESIDENT_KIND_PRISMS && draw.level <= 16 && draw.prism_bits <= 32;
    draw.form &= ~(MESH_FORM_BINS | MESH_FORM_NARROW);
    draw.form |= (draw.bins > 1 ? MESH_FORM_BINS : 0) | (is_narrow ? MESH_FORM_NARROW : 0);
}

void read_positions(Words words, MeshDrawConstants& draw) {
    for (size_t axis = 0; axis < 3; ++axis)
        draw.origin[axis] = static_cast<int32_t>(words[RESIDENT_WORD_ORIGIN_X + axis]);
    const uint32_t at = words[RESIDENT_WORD_POSITIONS];
    const uint32_t shape = word_at(words, uint64_t{at} + PRECISION_WORD_SHAPE);
    draw.full_bits = shape >> 16 & 255;
    draw.bins = shape & 255;
    draw.bins_at = at + PRECISION_WORD_BINS;
    draw.positions_at = draw.bins_at + PRECISION_BIN_WORDS * draw.bins;
    draw.least_level = word_at(words, uint64_t{at} + PRECISION_WORD_BINS) >> PRECISION_BIN_LEVEL_SHIFT;
    draw.level = std::max(shape >> 24, draw.least_level);
}

void read_charts(Words words, MeshDrawConstants& draw) {
    const uint32_t images = words[RESIDENT_WORD_IMAGES];
    const bool own_frames = words[RESIDENT_WORD_FRAME + RESIDENT_FRAME_SHIFTS] == RESIDENT_FRAMES_OF_THEIR_OWN;
    draw.chart_frames = own_frames ? images : 0;
    draw.frame_at = RESIDENT_WORD_FRAME;
    draw.chart_table = words[RESIDENT_WORD_CHART_TABLE];
    draw.colours_at = draw.chart_table + images + RESIDENT_FRAME_WORDS * draw.chart_frames;
    draw.face_table = words[RESIDENT_WORD_FACE_TABLE];
    draw.face_chart_bits = words[RESIDENT_WORD_BITS] >> 8;
    draw.normal_bits = words[RESIDENT_WORD_BITS] & 255;
}

/// 2^32 / number, rounded up.
uint32_t inverse_of(uint32_t number) {
    return static_cast<uint32_t>(((uint64_t{1} << 32) - 1) / number + 1);
}

/// `range`: its words.
void read_range(Words words, Words range, MeshDrawConstants& draw) {
    const uint32_t kind = range[RESIDENT_RANGE_KIND], bits = range[RESIDENT_RANGE_BITS];
    draw.form = kind & 0xffff;
    draw.first_position = range[RESIDENT_RANGE_FIRST_POSITION];
    draw.first_triangle = range[RESIDENT_RANGE_FIRST_TRIANGLE];
    draw.topology = range[RESIDENT_RANGE_TOPOLOGY];
    draw.topology_triangles = word_at(words, uint64_t{draw.topology} + LOCAL_STRIPS_WORD_TRIANGLES);
    draw.faces = range[RESIDENT_RANGE_FACES];
    draw.index_bits = bits & 255;
    draw.face_bits = bits >> 8 & 255;
    draw.top_bits = bits >> 16 & 255;
    for (uint32_t c = 0; c < 2; ++c) {
        draw.texcoord_bits[c] = kind >> (16 + 8 * c) & 255;
        draw.texcoord_shifts[c] = bits >> (24 + 4 * c) & 15;
    }
    draw.texcoords = range[RESIDENT_RANGE_TEXCOORDS];
    draw.normals = range[RESIDENT_RANGE_NORMALS];
    draw.vertex_points = range[RESIDENT_RANGE_POINTS];
    draw.points = kind >> 16;
    const uint32_t caps = (kind >> 8 & RESIDENT_FLAG_FLOORS) != 0 ? 2 : 1;
    draw.prism_bits = draw.top_bits + (1 + caps) * draw.face_bits;
    draw.triangles = std::max(2 * draw.points + (std::max(draw.points, 2u) - 2) * caps, 2u);
    draw.triangles_inverse = inverse_of(draw.triangles);
    draw.vertices = std::max(4 * draw.points + 3 * (std::max(draw.points, 2u) - 2) * caps, 2u);
    draw.vertices_inverse = inverse_of(draw.vertices);
    set_level(draw, draw.level);
}

/// Whether the words go on to where the draws can be known.
bool reach_positions(Words words) {
    if (words.size() < RESIDENT_HEADER_WORDS) return false;
    const uint64_t at = words[RESIDENT_WORD_POSITIONS];
    const uint64_t tables = RESIDENT_HEADER_WORDS + uint64_t{words[RESIDENT_WORD_RANGES]} * RESIDENT_RANGE_WORDS;
    return tables <= words.size() && at + PRECISION_WORD_BINS + PRECISION_BIN_WORDS <= words.size();
}

}  // namespace

std::vector<MeshDrawConstants> mesh_draw_constants(Words words) {
    std::vector<MeshDrawConstants> draws;
    if (words.size() < RESIDENT_HEADER_WORDS || words[RESIDENT_WORD_MAGIC] != RESIDENT_MAGIC) return draws;
    MeshDrawConstants all{};
    read_positions(words, all);
    read_charts(words, all);
    const uint64_t ranges = (words.size() - RESIDENT_HEADER_WORDS) / RESIDENT_RANGE_WORDS;
    for (uint64_t i = 0; i < std::min<uint64_t>(ranges, words[RESIDENT_WORD_RANGES]); ++i) {
        draws.push_back(all);
        read_range(words, words.subspan(RESIDENT_HEADER_WORDS + i * RESIDENT_RANGE_WORDS, RESIDENT_RANGE_WORDS),
                   draws.back());
    }
    return draws;
}

void MeshDraws::learn(LayerId layer, Words words) {
    layers_.erase(layer);
    if (words.empty() || words[0] != RESIDENT_MAGIC) return;
    layers_.insert({layer, {mesh_draw_constants(words), !reach_positions(words)}});
}

bool MeshDraws::is_partial(LayerId layer) const {
    const auto found = layers_.find(layer);
    return found != layers_.end() && found->second.is_partial;
}

void MeshDraws::set_level(LayerId layer, uint32_t level) {
    const auto found = layers_.find(layer);
    if (found == layers_.end()) return;
    for (MeshDrawConstants& draw : found->second.draws) client::set_level(draw, level);
}

MeshDrawConstants MeshDraws::of(LayerId layer, uint32_t range) const {
    const auto found = layers_.find(layer);
    if (found == layers_.end() || range >= found->second.draws.size()) return {};
    return found->second.draws[range];
}

}  // namespace citystream::client
