#include "tests/bench/mesh_peers.h"

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "codec/bits/bit_stream.h"
#include "codec/bits/zstd_frame.h"
#include "codec/mesh/mesh_triangles.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/step_choice.h"

namespace citystream::bench {

using codec::bits::compress_frame;
using codec::bits::decompress_frame;
using codec::mesh::MeshTile;

namespace {

/// Lowest texture coordinate of a chart, and how far its span is shifted to fit 16 bits: as the mesh layer does.
struct ChartSpan {
    std::array<int32_t, 2> low = {INT32_MAX, INT32_MAX}, high = {INT32_MIN, INT32_MIN};
    uint16_t code(size_t axis, int32_t value) const {
        const uint32_t bits = codec::bits::bits_for(static_cast<uint64_t>(int64_t{high[axis]} - low[axis]));
        return static_cast<uint16_t>((int64_t{value} - low[axis]) >> (bits > 16 ? bits - 16 : 0));
    }
};

MeshTile without_flat_triangles(const MeshTile& tile) {
    MeshTile kept = tile;
    kept.indices.clear();
    kept.triangle_chart.clear();
    kept.dressed_begin = 0;
    const auto same = [&](uint32_t a, uint32_t b) {
        return std::equal(tile.vertices[a].position, tile.vertices[a].position + 3, tile.vertices[b].position);
    };
    for (size_t t = 0; t < tile.triangle_chart.size(); ++t) {
        const uint32_t* corner = &tile.indices[3 * t];
        if (same(corner[0], corner[1]) || same(corner[1], corner[2]) || same(corner[2], corner[0])) continue;
        kept.indices.insert(kept.indices.end(), corner, corner + 3);
        kept.triangle_chart.push_back(tile.triangle_chart[t]);
        if (t < tile.dressed_begin) kept.dressed_begin = static_cast<uint32_t>(kept.triangle_chart.size());
    }
    return kept;
}

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
    return std::as_bytes(std::span<const T>(values));
}

void add_frame(Wire& wire, std::span<const std::byte> bytes) {
    wire.parts.push_back(compress_frame(bytes));
    wire.decoded_bytes.push_back(static_cast<uint32_t>(bytes.size()));
}

// Ours, as a city's archive holds it.

Wire encode_ours(const PeerMesh& mesh) {
    Wire wire;
    wire.charts = mesh.charts;
    codec::mesh::MeshWire layer = encode_best_steps(mesh.tile, {});
    wire.parts = std::move(layer.steps);
    const codec::mesh::ResidentMesh resident = make_resident(layer.content);
    for (uint32_t s = 0; s < wire.parts.size(); ++s)
        wire.decoded_bytes.push_back(static_cast<uint32_t>(4 * resident.added_words(s)));
    wire.bits_of = bits_by_part(layer.bits);
    return wire;
}

bool decode_ours(const Wire& wire, Resident& out) {
    const std::vector<std::span<const std::byte>> parts(wire.parts.begin(), wire.parts.end());
    const auto layer = codec::mesh::decode_mesh_layer(parts, wire.decoded_bytes, wire.charts);
    if (!layer) return false;
    out.words = layer->words();
    out.tile = codec::mesh::to_tile(layer->content);
    return true;
}

// Plain arrays, compressed.

Wire encode_raw(const PeerMesh& mesh) {
    Wire wire;
    add_frame(wire, bytes_of(mesh.raw));
    add_frame(wire, bytes_of(mesh.indices));
    return wire;
}

template <typename T>
bool decode_array(std::span<const std::byte> frame, uint32_t decoded_bytes, std::vector<T>& out) {
    const auto bytes = decompress_frame(frame, decoded_bytes);
    if (!bytes) return false;
    out.resize(bytes->size() / sizeof(T));
    std::memcpy(out.data(), bytes->data(), out.size() * sizeof(T));
    return true;
}

bool decode_raw(const Wire& wire, Resident& out) {
    return decode_array(wire.parts[0], wire.decoded_bytes[0], out.raw) &&
           decode_array(wire.parts[1], wire.decoded_bytes[1], out.indices);
}

Wire encode_packed(const PeerMesh& mesh) {
    Wire wire;
    add_frame(wire, bytes_of(mesh.vertices));
    add_frame(wire, bytes_of(mesh.indices));
    return wire;
}

bool decode_packed(const Wire& wire, Resident& out) {
    return decode_array(wire.parts[0], wire.decoded_bytes[0], out.vertices) &&
           decode_array(wire.parts[1], wire.decoded_bytes[1], out.indices);
}

// meshoptimizer: triangles and vertices in the order that its codecs like, then its codecs, then zstd.

Wire encode_meshoptimizer(const PeerMesh& mesh) {
    const size_t count = mesh.vertices.size();
    std::vector<uint32_t> indices(mesh.indices.size());
    std::vector<PeerVertex> vertices(count);
    meshopt_optimizeVertexCacheStrip(indices.data(), mesh.indices.data(), mesh.indices.size(), count);
    const size_t used = meshopt_optimizeVertexFetch(vertices.data(), indices.data(), indices.size(),
                                                    mesh.vertices.data(), count, sizeof(PeerVertex));
    std::vector<unsigned char> coded(meshopt_encodeVertexBufferBound(used, sizeof(PeerVertex)));
    coded.resize(meshopt_encodeVertexBuffer(coded.data(), coded.size(), vertices.data(), used, sizeof(PeerVertex)));
    std::vector<unsigned char> coded_indices(meshopt_encodeIndexBufferBound(indices.size(), used));
    coded_indices.resize(
        meshopt_encodeIndexBuffer(coded_indices.data(), coded_indices.size(), indices.data(), indices.size()));
    Wire wire;
    wire.vertices = static_cast<uint32_t>(used);
    wire.indices = static_cast<uint32_t>(indices.size());
    add_frame(wire, bytes_of(coded));
    add_frame(wire, bytes_of(coded_indices));
    return wire;
}

bool decode_meshoptimizer(const Wire& wire, Resident& out) {
    const auto coded = decompress_frame(wire.parts[0], wire.decoded_bytes[0]);
    const auto coded_indices = decompress_frame(wire.parts[1], wire.decoded_bytes[1]);
    if (!coded || !coded_indices) return false;
    out.vertices.resize(wire.vertices);
    out.indices.resize(wire.indices);
    return meshopt_decodeVertexBuffer(out.vertices.data(), wire.vertices, sizeof(PeerVertex),
                                      reinterpret_cast<const unsigned char*>(coded->data()), coded->size()) == 0 &&
           meshopt_decodeIndexBuffer(out.indices.data(), wire.indices,
                                     reinterpret_cast<const unsigned char*>(coded_indices->data()),
                                     coded_indices->size()) == 0;
}

// Draco at its highest compression level (-cl 10: speed 0), quantised to the same integers.

/// Attributes in the order in which they are added.
enum DracoAttribute { kDracoPosition, kDracoNormal, kDracoTexcoord, kDracoChart };
constexpr int kDracoNormalBits = 8, kDracoTexcoordBits = 16;

template <typename Fill>
void add_draco_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, int8_t components,
                         draco::DataType data_type, size_t count, Fill fill) {
    draco::GeometryAttribute attribute;
    const int64_t stride = components * draco::DataTypeLength(data_type);
    attribute.Init(type, nullptr, components, data_type, false, stride, 0);
    const int id = mesh.AddAttribute(attribute, true, static_cast<uint32_t>(count));
    for (uint32_t v = 0; v < count; ++v) {
        const auto value = fill(v);
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), value.data());
    }
}

void fill_draco_mesh(const PeerMesh& mesh, draco::Mesh& out) {
    const size_t count = mesh.vertices.size();
    out.set_num_points(static_cast<uint32_t>(count));
    out.SetNumFaces(mesh.indices.size() / 3);
    for (uint32_t f = 0; f < out.num_faces(); ++f) {
        draco::Mesh::Face face;
        for (size_t c = 0; c < 3; ++c) face[c] = draco::PointIndex(mesh.indices[3 * f + c]);
        out.SetFace(draco::FaceIndex(f), face);
    }
    const auto as_float = [](uint32_t value) { return static_cast<float>(value); };
    add_draco_attribute(out, draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, count, [&](uint32_t v) {
        const auto& p = mesh.vertices[v].position;
        return std::array{as_float(p[0]), as_float(p[1]), as_float(p[2])};
    });
    add_draco_attribute(out, draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32, count,
                        [&](uint32_t v) { return mesh.raw[v].normal; });
    add_draco_attribute(out, draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32, count, [&](uint32_t v) {
        const auto& t = mesh.vertices[v].texcoord;
        return std::array{as_float(t[0]), as_float(t[1])};
    });
    add_draco_attribute(out, draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT16, count,
                        [&](uint32_t v) { return std::array{mesh.vertices[v].chart}; });
    out.DeduplicateAttributeValues();
    out.DeduplicatePointIds();
}

Wire encode_draco(const PeerMesh& mesh) {
    draco::Mesh input;
    fill_draco_mesh(mesh, input);
    uint32_t extent = 1;
    for (const PeerVertex& vertex : mesh.vertices)
        extent = std::max(extent, *std::max_element(vertex.position.begin(), vertex.position.end()));
    const auto position_bits = static_cast<int>(codec::bits::bits_for(extent));
    const std::array<float, 3> zero = {};
    draco::ExpertEncoder encoder(input);
    encoder.SetSpeedOptions(0, 0);
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    // A range of 2^bits - 1 makes the quantisation step exactly one unit.
    const auto range = [](int bits) { return static_cast<float>((1 << bits) - 1); };
    encoder.SetAttributeExplicitQuantization(kDracoPosition, position_bits, 3, zero.data(), range(position_bits));
    encoder.SetAttributeQuantization(kDracoNormal, kDracoNormalBits);
    encoder.SetAttributeExplicitQuantization(kDracoTexcoord, kDracoTexcoordBits, 2, zero.data(),
                                             range(kDracoTexcoordBits));
    draco::EncoderBuffer buffer;
    Wire wire;
    if (!encoder.EncodeToBuffer(&buffer).ok()) return wire;
    const auto coded = std::as_bytes(std::span(buffer.data(), buffer.size()));
    wire.parts.emplace_back(coded.begin(), coded.end());
    return wire;
}

void read_draco_mesh(const draco::Mesh& mesh, Resident& out) {
    out.vertices.resize(mesh.num_points());
    for (uint32_t v = 0; v < mesh.num_points(); ++v) {
        const draco::PointIndex point(v);
        std::array<float, 3> position{}, normal{};
        std::array<float, 2> texcoord{};
        PeerVertex& vertex = out.vertices[v];
        mesh.attribute(kDracoPosition)->GetMappedValue(point, position.data());
        mesh.attribute(kDracoNormal)->GetMappedValue(point, normal.data());
        mesh.attribute(kDracoTexcoord)->GetMappedValue(point, texcoord.data());
        mesh.attribute(kDracoChart)->GetMappedValue(point, &vertex.chart);
        for (size_t c = 0; c < 3; ++c) vertex.position[c] = static_cast<uint32_t>(std::lround(position[c]));
        for (size_t c = 0; c < 2; ++c) vertex.texcoord[c] = static_cast<uint16_t>(std::lround(texcoord[c]));
        vertex.normal = static_cast<uint16_t>(codec::mesh::pack_octahedral16(normal.data()));
    }
    for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
        for (const draco::PointIndex& point : mesh.face(draco::FaceIndex(f))) out.indices.push_back(point.value());
    }
}

bool decode_draco(const Wire& wire, Resident& out) {
    if (wire.parts.empty()) return false;
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(wire.parts[0].data()), wire.parts[0].size());
    draco::Decoder decoder;
    const auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (!mesh.ok() || mesh.value()->num_attributes() != 4) return false;
    read_draco_mesh(*mesh.value(), out);
    return true;
}

template <typename CornerOf>
Triangles sorted_triangles(size_t count, CornerOf corner_of) {
    Triangles triangles;
    for (size_t t = 0; t < count; ++t) {
        std::array<Corner, 3> corners = {corner_of(3 * t), corner_of(3 * t + 1), corner_of(3 * t + 2)};
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        triangles.push_back(corners);
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

std::array<int32_t, 3> minimum_corner(const MeshTile& tile) {
    std::array<int32_t, 3> low = {INT32_MAX, INT32_MAX, INT32_MAX};
    for (const uint32_t index : tile.indices) {
        for (size_t c = 0; c < 3; ++c) low[c] = std::min(low[c], tile.vertices[index].position[c]);
    }
    return low;
}

Corner corner_from(const std::array<uint32_t, 3>& position, uint32_t chart) {
    return {position[0], position[1], position[2], chart};
}

}  // namespace

PeerMesh make_peer_mesh(const MeshTile& tile) {
    PeerMesh mesh;
    mesh.tile = without_flat_triangles(tile);
    const auto low = minimum_corner(mesh.tile);
    std::map<uint32_t, ChartSpan> spans;
    for (size_t corner = 0; corner < mesh.tile.indices.size(); ++corner) {
        const uint32_t chart = mesh.tile.triangle_chart[corner / 3];
        const auto& from = mesh.tile.vertices[mesh.tile.indices[corner]];
        mesh.charts = std::max(mesh.charts, chart + 1);
        ChartSpan& span = spans[chart];
        for (size_t c = 0; c < 2; ++c) {
            span.low[c] = std::min(span.low[c], from.texcoord[c]);
            span.high[c] = std::max(span.high[c], from.texcoord[c]);
        }
    }
    for (const auto& [chart, span] : spans) mesh.chart_names.push_back(chart);
    const auto number_of = [&names = mesh.chart_names](uint32_t chart) {
        return static_cast<uint16_t>(std::lower_bound(names.begin(), names.end(), chart) - names.begin());
    };
    std::map<PeerVertex, uint32_t> numbers;
    for (size_t corner = 0; corner < mesh.tile.indices.size(); ++corner) {
        const uint32_t chart = mesh.tile.triangle_chart[corner / 3];
        const auto& from = mesh.tile.vertices[mesh.tile.indices[corner]];
        PeerVertex vertex{};
        RawVertex raw{};
        vertex.chart = number_of(chart);
        raw.chart = chart;
        vertex.normal = static_cast<uint16_t>(codec::mesh::pack_octahedral16(from.normal));
        for (size_t c = 0; c < 3; ++c) {
            vertex.position[c] = static_cast<uint32_t>(from.position[c] - low[c]);
            raw.position[c] = static_cast<float>(vertex.position[c]) / 1024;
            raw.normal[c] = from.normal[c];
        }
        for (size_t c = 0; c < 2; ++c) {
            vertex.texcoord[c] = spans[chart].code(c, from.texcoord[c]);
            raw.texcoord[c] = static_cast<float>(from.texcoord[c]) / 65536;
        }
        const auto [at, added] = numbers.try_emplace(vertex, static_cast<uint32_t>(mesh.vertices.size()));
        mesh.indices.push_back(at->second);
        if (!added) continue;
        mesh.vertices.push_back(vertex);
        mesh.raw.push_back(raw);
    }
    return mesh;
}

uint64_t Wire::bytes() const {
    uint64_t sum = 0;
    for (const auto& part : parts) sum += part.size();
    return sum;
}

uint64_t Resident::bytes() const {
    const uint64_t index_bytes = vertices.size() <= 65536 && raw.size() <= 65536 ? 2 : 4;
    return words.size() * 4 + vertices.size() * sizeof(PeerVertex) + raw.size() * sizeof(RawVertex) +
           indices.size() * index_bytes;
}

std::vector<Representation> mesh_representations() {
    return {{"default", encode_ours, decode_ours},
            {"draco", encode_draco, decode_draco},
            {"meshopt", encode_meshoptimizer, decode_meshoptimizer},
            {"packed", encode_packed, decode_packed},
            {"raw", encode_raw, decode_raw}};
}

Triangles triangles_of(const PeerMesh& mesh) {
    return sorted_triangles(mesh.indices.size() / 3, [&](size_t corner) {
        return corner_from(mesh.vertices[mesh.indices[corner]].position, mesh.tile.triangle_chart[corner / 3]);
    });
}

Triangles triangles_of(const Resident& resident, const PeerMesh& of) {
    if (!resident.words.empty()) {
        const auto low = minimum_corner(of.tile);
        return sorted_triangles(resident.tile.triangle_chart.size(), [&](size_t corner) {
            const int32_t* p = resident.tile.vertices[resident.tile.indices[corner]].position;
            return corner_from({static_cast<uint32_t>(p[0] - low[0]), static_cast<uint32_t>(p[1] - low[1]),
                                static_cast<uint32_t>(p[2] - low[2])},
                               resident.tile.triangle_chart[corner / 3]);
        });
    }
    return sorted_triangles(resident.indices.size() / 3, [&](size_t corner) {
        const uint32_t index = resident.indices[corner];
        if (!resident.vertices.empty())
            return corner_from(resident.vertices[index].position, of.chart_names.at(resident.vertices[index].chart));
        std::array<uint32_t, 3> position{};
        for (size_t c = 0; c < 3; ++c)
            position[c] = static_cast<uint32_t>(std::lround(resident.raw[index].position[c] * 1024));
        return corner_from(position, resident.raw[index].chart);
    });
}

}  // namespace citystream::bench
