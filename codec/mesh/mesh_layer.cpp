#include "codec/mesh/mesh_layer.h"

#include <string>

#include "codec/bits/bit_stream.h"
#include "codec/chart_word.h"
#include "codec/mesh/mesh_layout.h"
#include "codec/mesh/octahedral.h"

namespace citystream::codec::mesh {

namespace {

using bits::read_bits;
using bits::words_for;

/// The shader addresses bits with 32-bit numbers.
constexpr uint64_t kMaxWords = uint64_t{1} << 27;
constexpr uint32_t kMaxShift = 16;
constexpr int32_t kMaxOrigin = 1 << kMaxCoordinateBits;

uint32_t index_bits(std::span<const uint32_t> words) {
    return words[MESH_WORD_WIDTHS] & 255u;
}
uint32_t chart_bits(std::span<const uint32_t> words) {
    return words[MESH_WORD_WIDTHS] >> 8 & 255u;
}
uint32_t position_bits(std::span<const uint32_t> words) {
    return words[MESH_WORD_WIDTHS] >> 16 & 255u;
}
uint32_t first_dropped(std::span<const uint32_t> words) {
    return words[MESH_WORD_WIDTHS] >> 24;
}

Error error_at(std::string message, uint64_t word) {
    return Error{"mesh layer: " + std::move(message), word * 4};
}

Status check_step_words(std::span<const uint32_t> words, std::span<const uint32_t> step_words) {
    if (step_words.empty() || step_words.size() > MESH_MAX_STEPS) {
        return error_at(
            "has " + std::to_string(step_words.size()) + " steps, expected 1.." + std::to_string(MESH_MAX_STEPS), 0);
    }
    uint64_t sum = 0;
    for (const uint32_t count : step_words) sum += count;
    if (sum != words.size()) {
        return error_at(
            "steps of " + std::to_string(sum) + " words in all, but " + std::to_string(words.size()) + " are there",
            words.size());
    }
    if (words.size() > kMaxWords) return error_at("too large for 32-bit bit addresses", 0);
    if (step_words[0] < MESH_HEADER_WORDS) return error_at("step 0 is shorter than its header", step_words[0]);
    return Done{};
}

Status check_header(std::span<const uint32_t> words) {
    if (words[MESH_WORD_MAGIC] != MESH_MAGIC) return error_at("wrong magic", MESH_WORD_MAGIC);
    if (words[MESH_WORD_DRESSED_BEGIN] > words[MESH_WORD_TRIANGLE_COUNT]) {
        return error_at("the stand-ins begin after the last triangle", MESH_WORD_DRESSED_BEGIN);
    }
    for (uint32_t c = 0; c < 3; ++c) {
        const auto origin = static_cast<int32_t>(words[MESH_WORD_ORIGIN_X + c]);
        if (origin < -kMaxOrigin || origin > kMaxOrigin) return error_at("origin out of range", MESH_WORD_ORIGIN_X + c);
    }
    if (index_bits(words) > 32 || chart_bits(words) > 32) return error_at("field wider than 32 bits", MESH_WORD_WIDTHS);
    // Without bits behind them nothing would bound the number of triangles.
    if (words[MESH_WORD_TRIANGLE_COUNT] > 0 && index_bits(words) == 0) {
        return error_at("triangles without index bits", MESH_WORD_WIDTHS);
    }
    if (position_bits(words) + first_dropped(words) > kMaxCoordinateBits) {
        return error_at("positions of more than " + std::to_string(kMaxCoordinateBits) + " bits", MESH_WORD_WIDTHS);
    }
    return Done{};
}

/// Every part of step 0 lies between the header and the end of the step.
Status check_parts(std::span<const uint32_t> words, uint64_t end) {
    const uint64_t vertices = words[MESH_WORD_VERTEX_COUNT];
    const uint64_t triangles = words[MESH_WORD_TRIANGLE_COUNT];
    const struct {
        const char* name;
        uint32_t word;
        uint64_t size;
    } parts[] = {
        {"chart table", MESH_WORD_CHART_TABLE, uint64_t{words[MESH_WORD_CHART_COUNT]} * MESH_CHART_WORDS},
        {"indices", MESH_WORD_INDICES, words_for(3 * triangles, index_bits(words))},
        {"chart fields", MESH_WORD_CHARTS, words_for(triangles, chart_bits(words))},
        {"normals", MESH_WORD_NORMALS, words_for(vertices, 16)},
        {"texture coordinates", MESH_WORD_TEXCOORDS, vertices},
        {"positions", MESH_WORD_POSITIONS, words_for(3 * vertices, position_bits(words))},
    };
    for (const auto& part : parts) {
        const uint64_t begin = words[part.word];
        if (begin < MESH_HEADER_WORDS || begin > end || part.size > end - begin) {
            return error_at(std::string(part.name) + " reach outside step 0", part.word);
        }
    }
    return Done{};
}

Status check_chart_table(std::span<const uint32_t> words, uint32_t atlas_chart_count) {
    for (uint64_t chart = 0; chart < words[MESH_WORD_CHART_COUNT]; ++chart) {
        const uint64_t entry = words[MESH_WORD_CHART_TABLE] + chart * MESH_CHART_WORDS;
        const uint32_t shifts = words[entry + MESH_CHART_SHIFTS];
        if ((shifts & 255u) > kMaxShift || shifts >> 8 > kMaxShift) {
            return error_at("chart shift out of range", entry + MESH_CHART_SHIFTS);
        }
        if (!is_chart_word(words[entry + MESH_CHART_WORD], atlas_chart_count)) {
            return error_at("chart " + std::to_string(words[entry + MESH_CHART_WORD]) + " of an atlas of " +
                                std::to_string(atlas_chart_count),
                            entry + MESH_CHART_WORD);
        }
    }
    return Done{};
}

/// `count` fields, all below `limit`.
Status check_fields(std::span<const uint32_t> words, uint32_t offset_word, uint64_t count, uint32_t width,
                    uint64_t limit, const char* name) {
    uint64_t bit = uint64_t{words[offset_word]} * 32;
    for (uint64_t i = 0; i < count; ++i, bit += width) {
        const uint32_t value = read_bits(words, bit, width);
        if (value >= limit) {
            return error_at(
                std::string(name) + " " + std::to_string(value) + ", but there are only " + std::to_string(limit),
                bit / 32);
        }
    }
    return Done{};
}

Status check_first_step(std::span<const uint32_t> words, uint64_t end, uint32_t atlas_chart_count) {
    if (Status status = check_header(words); !status) return status;
    if (Status status = check_parts(words, end); !status) return status;
    if (Status status = check_chart_table(words, atlas_chart_count); !status) return status;
    const uint64_t triangles = words[MESH_WORD_TRIANGLE_COUNT];
    if (Status status = check_fields(words, MESH_WORD_INDICES, 3 * triangles, index_bits(words),
                                     words[MESH_WORD_VERTEX_COUNT], "vertex index");
        !status) {
        return status;
    }
    return check_fields(words, MESH_WORD_CHARTS, triangles, chart_bits(words), words[MESH_WORD_CHART_COUNT],
                        "chart index");
}

}  // namespace

Result<MeshLayerView> MeshLayerView::create(std::span<const uint32_t> words, std::span<const uint32_t> step_words,
                                            uint32_t atlas_chart_count) {
    if (const Status status = check_step_words(words, step_words); !status) return status.error();
    if (const Status status = check_first_step(words, step_words[0], atlas_chart_count); !status) return status.error();

    MeshLayerView view;
    view.words_ = words;
    view.plane_offset_[0] = words[MESH_WORD_POSITIONS];
    view.plane_bits_[0] = position_bits(words);
    view.dropped_ = first_dropped(words);
    view.steps_ = 1;
    uint64_t begin = step_words[0];
    for (; view.steps_ < step_words.size(); ++view.steps_) {
        const uint64_t count = step_words[view.steps_];
        if (count < MESH_PLANES_HEADER_WORDS) return error_at("bit planes without a header", begin);
        if (words[begin + MESH_PLANES_WORD_MAGIC] != MESH_PLANES_MAGIC)
            return error_at("wrong magic of bit planes", begin);
        const uint32_t widths = words[begin + MESH_PLANES_WORD_WIDTHS];
        const uint32_t plane_bits = widths & 255u;
        const uint32_t still_dropped = widths >> 8;
        if (plane_bits == 0 || plane_bits > view.dropped_ || still_dropped != view.dropped_ - plane_bits) {
            return error_at("bit planes do not continue the step before them", begin + MESH_PLANES_WORD_WIDTHS);
        }
        if (count != MESH_PLANES_HEADER_WORDS + words_for(3 * uint64_t{words[MESH_WORD_VERTEX_COUNT]}, plane_bits)) {
            return error_at("bit planes of another number of vertices", begin);
        }
        view.plane_offset_[view.steps_] = static_cast<uint32_t>(begin + MESH_PLANES_HEADER_WORDS);
        view.plane_bits_[view.steps_] = plane_bits;
        view.dropped_ = still_dropped;
        begin += count;
    }
    return view;
}

uint32_t MeshLayerView::vertex_count() const {
    return words_[MESH_WORD_VERTEX_COUNT];
}
uint32_t MeshLayerView::triangle_count() const {
    return words_[MESH_WORD_TRIANGLE_COUNT];
}
uint32_t MeshLayerView::dressed_begin() const {
    return words_[MESH_WORD_DRESSED_BEGIN];
}
uint32_t MeshLayerView::step_count() const {
    return steps_;
}

uint32_t MeshLayerView::index(uint32_t corner) const {
    const uint32_t width = index_bits(words_);
    return read_bits(words_, uint64_t{words_[MESH_WORD_INDICES]} * 32 + uint64_t{corner} * width, width);
}

uint32_t MeshLayerView::chart_entry(uint32_t triangle) const {
    const uint32_t width = chart_bits(words_);
    const uint32_t chart =
        read_bits(words_, uint64_t{words_[MESH_WORD_CHARTS]} * 32 + uint64_t{triangle} * width, width);
    return words_[MESH_WORD_CHART_TABLE] + chart * MESH_CHART_WORDS;
}

uint32_t MeshLayerView::chart_word(uint32_t triangle) const {
    return words_[chart_entry(triangle) + MESH_CHART_WORD];
}

void MeshLayerView::position(uint32_t vertex, int32_t out[3]) const {
    uint32_t known[3] = {};
    uint32_t rounding = 0;
    uint32_t dropped = dropped_;
    for (uint32_t s = steps_; s-- > 1;) {
        dropped += plane_bits_[s];
        rounding += 1u << (dropped - 1);
    }
    for (uint32_t s = 0; s < steps_; ++s) {
        const uint32_t width = plane_bits_[s];
        uint64_t bit = uint64_t{plane_offset_[s]} * 32 + uint64_t{vertex} * 3 * width;
        for (uint32_t& coordinate : known) {
            coordinate = coordinate << width | read_bits(words_, bit, width);
            bit += width;
        }
    }
    for (uint32_t c = 0; c < 3; ++c) {
        out[c] = static_cast<int32_t>(words_[MESH_WORD_ORIGIN_X + c] + (known[c] << dropped_) - rounding);
    }
}

uint32_t MeshLayerView::packed_normal(uint32_t vertex) const {
    return words_[words_[MESH_WORD_NORMALS] + vertex / 2] >> (16 * (vertex & 1u)) & 0xffffu;
}

void MeshLayerView::texcoord_base(uint32_t triangle, int32_t out[2]) const {
    const uint32_t entry = chart_entry(triangle);
    out[0] = static_cast<int32_t>(words_[entry + MESH_CHART_BASE_U]);
    out[1] = static_cast<int32_t>(words_[entry + MESH_CHART_BASE_V]);
}

void MeshLayerView::texcoord(uint32_t vertex, uint32_t triangle, int32_t out[2]) const {
    const uint32_t entry = chart_entry(triangle);
    const uint32_t q = words_[words_[MESH_WORD_TEXCOORDS] + vertex];
    const uint32_t shifts = words_[entry + MESH_CHART_SHIFTS];
    // Unsigned, as in the shader: hostile bases may wrap but never overflow.
    out[0] = static_cast<int32_t>(words_[entry + MESH_CHART_BASE_U] + ((q & 0xffffu) << (shifts & 255u)));
    out[1] = static_cast<int32_t>(words_[entry + MESH_CHART_BASE_V] + ((q >> 16) << (shifts >> 8)));
}

Result<MeshTile> decode_mesh(std::span<const uint32_t> words, std::span<const uint32_t> step_words,
                             uint32_t atlas_chart_count) {
    const Result<MeshLayerView> created = MeshLayerView::create(words, step_words, atlas_chart_count);
    if (!created) return created.error();
    const MeshLayerView& view = *created;

    MeshTile tile;
    tile.dressed_begin = view.dressed_begin();
    tile.vertices.resize(view.vertex_count());
    for (uint32_t v = 0; v < view.vertex_count(); ++v) {
        view.position(v, tile.vertices[v].position);
        unpack_octahedral16(view.packed_normal(v), tile.vertices[v].normal);
    }
    tile.indices.resize(3 * size_t{view.triangle_count()});
    tile.triangle_chart.resize(view.triangle_count());
    for (uint32_t t = 0; t < view.triangle_count(); ++t) {
        tile.triangle_chart[t] = view.chart_word(t);
        for (uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
            tile.indices[corner] = view.index(corner);
            view.texcoord(tile.indices[corner], t, tile.vertices[tile.indices[corner]].texcoord);
        }
    }
    return tile;
}

}  // namespace citystream::codec::mesh
