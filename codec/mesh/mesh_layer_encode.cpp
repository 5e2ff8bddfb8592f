#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>

#include "codec/bits/bit_stream.h"
#include "codec/grid.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_layout.h"
#include "codec/mesh/octahedral.h"

namespace citystream::codec::mesh {

namespace {

using bits::bits_for;
using bits::BitWriter;

constexpr uint32_t kTexcoordBits = 16;

/// Where the positions of a tile lie and how many low bits each step leaves out.
struct Precision {
    std::array<int32_t, 3> origin = {};
    uint32_t extent_bits = 0;  ///< of the largest distance from the origin
    uint32_t bits = 0;         ///< of the largest distance with the rounding added
    std::vector<uint32_t> dropped;
    uint32_t rounding = 0;  ///< halves of the units of all steps: added before the low bits are dropped, so that every
                            ///< step rounds to nearest
};

/// Texture coordinates of one atlas chart as 16-bit numbers.
struct ChartCode {
    std::array<int32_t, 2> base = {};
    std::array<uint32_t, 2> shift = {};
    std::array<uint32_t, 2> largest = {};  ///< code
    uint32_t chart_word = 0;
};

/// A vertex as it is written: equal codes are one vertex.
struct VertexCode {
    std::array<uint32_t, 3> position = {};  ///< from the origin, low bits of the last step already zero
    uint32_t normal = 0;
    uint32_t texcoord = 0;
    uint32_t chart = 0;
    friend bool operator==(const VertexCode&, const VertexCode&) = default;
};

struct VertexCodeHash {
    size_t operator()(const VertexCode& code) const {
        uint64_t hash = 0;
        for (const uint32_t part :
             {code.position[0], code.position[1], code.position[2], code.normal, code.texcoord, code.chart}) {
            hash = (hash ^ part) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 32;
        }
        return static_cast<size_t>(hash);
    }
};

struct WeldedMesh {
    std::vector<VertexCode> vertices;  ///< in order of first use
    std::vector<uint32_t> indices;
    std::vector<uint32_t> triangle_chart;  ///< index in the chart table
};

/// Low bits that lie far below the geometry's own error: the most whose unit is at most an eighth of it.
uint32_t finest_dropped_bits(float finest_error_metres) {
    const double units = static_cast<double>(finest_error_metres) / 8 * kGridUnitsPerMetre;
    uint32_t dropped = 0;
    while (dropped < kMaxCoordinateBits && std::ldexp(1.0, static_cast<int>(dropped) + 1) <= units) ++dropped;
    return dropped;
}

int32_t round_down(int32_t value, uint32_t low_bits) {
    return value >> low_bits << low_bits;
}

/// Origin, bits and rounding when step 0 leaves out `finest` + `more` bits and each later step three fewer.
Precision precision_at(const std::array<int32_t, 3>& low, const std::array<int32_t, 3>& high, uint32_t finest,
                       uint32_t more) {
    Precision precision;
    for (uint32_t refinements = more / 3 + 1; refinements-- > 0;) {
        const uint32_t dropped = finest + 3 * refinements;
        precision.dropped.push_back(dropped);
        if (dropped > 0) precision.rounding += 1u << (dropped - 1);
    }
    for (size_t c = 0; c < 3; ++c) {
        precision.origin[c] = round_down(low[c], finest + more);
        const auto extent = static_cast<uint64_t>(int64_t{high[c]} - precision.origin[c]);
        precision.extent_bits = std::max(precision.extent_bits, bits_for(extent));
        precision.bits = std::max(precision.bits, bits_for(extent + precision.rounding));
    }
    return precision;
}

Precision choose_precision(const MeshTile& tile, float finest_error_metres) {
    std::array<int32_t, 3> low = {};
    std::array<int32_t, 3> high = {};
    bool first = true;
    for (const uint32_t index : tile.indices) {
        for (size_t c = 0; c < 3; ++c) {
            const int32_t value = tile.vertices[index].position[c];
            low[c] = first ? value : std::min(low[c], value);
            high[c] = first ? value : std::max(high[c], value);
        }
        first = false;
    }
    const uint32_t finest = finest_dropped_bits(finest_error_metres);
    for (const uint32_t more : {6u, 3u, 0u}) {
        Precision precision = precision_at(low, high, finest, more);
        if (more > 0 && precision.extent_bits <= finest + more) continue;
        precision.bits = std::max(precision.bits, precision.dropped.front());
        assert(precision.bits <= kMaxCoordinateBits);
        return precision;
    }
    return {};
}

/// Base and shift of one axis of a chart whose coordinates span [low, high].
void fit_chart_axis(ChartCode& chart, size_t axis, int32_t low, int32_t high) {
    const auto range = static_cast<uint64_t>(int64_t{high} - low);
    const uint32_t bits = bits_for(range);
    chart.base[axis] = low;
    chart.shift[axis] = bits > kTexcoordBits ? bits - kTexcoordBits : 0;
    chart.largest[axis] = static_cast<uint32_t>(range >> chart.shift[axis]);
}

/// Nearest code of a texture coordinate; never one whose value lies past the chart's largest coordinate, so that it
/// stays an int32.
uint32_t quantise(const ChartCode& chart, size_t axis, int32_t texcoord) {
    const uint32_t shift = chart.shift[axis];
    const uint64_t half = shift > 0 ? uint64_t{1} << (shift - 1) : 0;
    const auto distance = static_cast<uint64_t>(int64_t{texcoord} - chart.base[axis]);
    return std::min(static_cast<uint32_t>((distance + half) >> shift), chart.largest[axis]);
}

/// One chart table entry for each chart word in use, in rising order; `entry_of` maps a chart word to its entry.
std::vector<ChartCode> make_chart_table(const MeshTile& tile, std::map<uint32_t, uint32_t>& entry_of) {
    struct Range {
        std::array<int32_t, 2> low, high;
    };
    std::map<uint32_t, Range> ranges;
    for (size_t corner = 0; corner < tile.indices.size(); ++corner) {
        const MeshVertex& vertex = tile.vertices[tile.indices[corner]];
        const std::array<int32_t, 2> texcoord = {vertex.texcoord[0], vertex.texcoord[1]};
        const auto [at, added] = ranges.try_emplace(tile.triangle_chart[corner / 3], Range{texcoord, texcoord});
        for (size_t c = 0; c < 2; ++c) {
            at->second.low[c] = std::min(at->second.low[c], texcoord[c]);
            at->second.high[c] = std::max(at->second.high[c], texcoord[c]);
        }
    }
    std::vector<ChartCode> table;
    for (const auto& [chart_word, range] : ranges) {
        ChartCode& chart = table.emplace_back();
        chart.chart_word = chart_word;
        for (size_t c = 0; c < 2; ++c) fit_chart_axis(chart, c, range.low[c], range.high[c]);
        entry_of[chart_word] = static_cast<uint32_t>(table.size() - 1);
    }
    return table;
}

VertexCode make_vertex_code(const MeshVertex& vertex, uint32_t packed_normal, const ChartCode& chart, uint32_t entry,
                            const Precision& precision) {
    VertexCode code;
    for (size_t c = 0; c < 3; ++c) {
        const auto distance = static_cast<uint64_t>(int64_t{vertex.position[c]} - precision.origin[c]);
        const uint32_t finest = precision.dropped.back();
        code.position[c] = static_cast<uint32_t>((distance + precision.rounding) >> finest << finest);
    }
    code.normal = packed_normal;
    for (size_t c = 0; c < 2; ++c) {
        code.texcoord |= quantise(chart, c, vertex.texcoord[c]) << (kTexcoordBits * c);
    }
    code.chart = entry;
    return code;
}

WeldedMesh weld(const MeshTile& tile, const Precision& precision, const std::vector<ChartCode>& charts,
                const std::map<uint32_t, uint32_t>& entry_of) {
    std::vector<uint32_t> normals(tile.vertices.size());
    std::transform(tile.vertices.begin(), tile.vertices.end(), normals.begin(),
                   [](const MeshVertex& vertex) { return pack_octahedral16(vertex.normal); });
    WeldedMesh welded;
    welded.indices.reserve(tile.indices.size());
    welded.triangle_chart.reserve(tile.triangle_chart.size());
    std::unordered_map<VertexCode, uint32_t, VertexCodeHash> known;
    known.reserve(tile.vertices.size());
    for (size_t corner = 0; corner < tile.indices.size(); ++corner) {
        if (corner % 3 == 0) welded.triangle_chart.push_back(entry_of.at(tile.triangle_chart[corner / 3]));
        const uint32_t entry = welded.triangle_chart.back();
        const uint32_t index = tile.indices[corner];
        const VertexCode code = make_vertex_code(tile.vertices[index], normals[index], charts[entry], entry, precision);
        const auto [at, added] = known.try_emplace(code, static_cast<uint32_t>(welded.vertices.size()));
        if (added) welded.vertices.push_back(code);
        welded.indices.push_back(at->second);
    }
    return welded;
}

void append(std::vector<uint32_t>& words, BitWriter& writer) {
    const std::vector<uint32_t> part = writer.finish();
    words.insert(words.end(), part.begin(), part.end());
}

void append_fields(std::vector<uint32_t>& words, const std::vector<uint32_t>& values, uint32_t width) {
    BitWriter writer;
    for (const uint32_t value : values) writer.put(value, width);
    append(words, writer);
}

/// Bits [low, low + width) of every coordinate.
void append_position_bits(std::vector<uint32_t>& words, const WeldedMesh& mesh, uint32_t low, uint32_t width) {
    BitWriter writer;
    for (const VertexCode& vertex : mesh.vertices) {
        for (const uint32_t coordinate : vertex.position) writer.put(coordinate >> low, width);
    }
    append(words, writer);
}

void append_chart_table(std::vector<uint32_t>& words, const std::vector<ChartCode>& charts) {
    for (const ChartCode& chart : charts) {
        words.insert(words.end(), {static_cast<uint32_t>(chart.base[0]), static_cast<uint32_t>(chart.base[1]),
                                   chart.shift[0] | chart.shift[1] << 8, chart.chart_word});
    }
}

std::vector<uint32_t> first_step(const WeldedMesh& mesh, const std::vector<ChartCode>& charts,
                                 const Precision& precision, uint32_t dressed_begin) {
    const uint32_t index_bits = mesh.indices.empty() ? 0 : std::max(1u, bits_for(mesh.vertices.size() - 1));
    const uint32_t chart_bits = charts.empty() ? 0 : bits_for(charts.size() - 1);
    const uint32_t dropped = precision.dropped.front();
    const uint32_t position_bits = precision.bits - dropped;

    std::vector<uint32_t> words(MESH_HEADER_WORDS, 0);
    words[MESH_WORD_MAGIC] = MESH_MAGIC;
    words[MESH_WORD_VERTEX_COUNT] = static_cast<uint32_t>(mesh.vertices.size());
    words[MESH_WORD_TRIANGLE_COUNT] = static_cast<uint32_t>(mesh.triangle_chart.size());
    words[MESH_WORD_DRESSED_BEGIN] = dressed_begin;
    for (size_t c = 0; c < 3; ++c) words[MESH_WORD_ORIGIN_X + c] = static_cast<uint32_t>(precision.origin[c]);
    words[MESH_WORD_WIDTHS] = index_bits | chart_bits << 8 | position_bits << 16 | dropped << 24;
    words[MESH_WORD_CHART_COUNT] = static_cast<uint32_t>(charts.size());

    const auto begin_part = [&words](size_t word) { words[word] = static_cast<uint32_t>(words.size()); };
    begin_part(MESH_WORD_CHART_TABLE);
    append_chart_table(words, charts);
    begin_part(MESH_WORD_INDICES);
    append_fields(words, mesh.indices, index_bits);
    begin_part(MESH_WORD_CHARTS);
    append_fields(words, mesh.triangle_chart, chart_bits);
    begin_part(MESH_WORD_NORMALS);
    BitWriter normals;
    for (const VertexCode& vertex : mesh.vertices) normals.put(vertex.normal, 16);
    append(words, normals);
    begin_part(MESH_WORD_TEXCOORDS);
    for (const VertexCode& vertex : mesh.vertices) words.push_back(vertex.texcoord);
    begin_part(MESH_WORD_POSITIONS);
    append_position_bits(words, mesh, dropped, position_bits);
    return words;
}

float step_error(float finest_error_metres, uint32_t dropped) {
    const double lost = std::numbers::sqrt3 * (std::ldexp(1.0, static_cast<int>(dropped)) - 1) * kMetresPerGridUnit;
    return static_cast<float>(static_cast<double>(finest_error_metres) + lost);
}

}  // namespace

LayerSteps encode_mesh(const MeshTile& tile, float finest_error_metres) {
    assert(tile.indices.size() == 3 * tile.triangle_chart.size());
    assert(tile.dressed_begin <= tile.triangle_chart.size());
    const Precision precision = choose_precision(tile, finest_error_metres);
    std::map<uint32_t, uint32_t> entry_of;
    const std::vector<ChartCode> charts = make_chart_table(tile, entry_of);
    const WeldedMesh mesh = weld(tile, precision, charts, entry_of);

    LayerSteps steps;
    steps.push_back({first_step(mesh, charts, precision, tile.dressed_begin),
                     step_error(finest_error_metres, precision.dropped.front())});
    for (size_t s = 1; s < precision.dropped.size(); ++s) {
        const uint32_t dropped = precision.dropped[s];
        const uint32_t width = precision.dropped[s - 1] - dropped;
        std::vector<uint32_t> words = {MESH_PLANES_MAGIC, width | dropped << 8};
        append_position_bits(words, mesh, dropped, width);
        steps.push_back({std::move(words), step_error(finest_error_metres, dropped)});
    }
    return steps;
}

}  // namespace citystream::codec::mesh
