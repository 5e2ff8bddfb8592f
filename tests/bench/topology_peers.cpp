#include "tests/bench/topology_peers.h"

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "codec/bits/bit_stream.h"
#include "codec/bits/simple9.h"
#include "codec/bits/zstd_frame.h"
#include "codec/mesh/strip_code.h"
#include "codec/mesh/strip_layout.h"

namespace citystream::bench {

using codec::bits::compress_frame;
using codec::bits::decompress_frame;
using codec::bits::frame_content_size;

namespace {

using Bytes = std::vector<std::byte>;

Result<Bytes> unpack_frame(std::span<const std::byte> frame) {
    return decompress_frame(frame, static_cast<size_t>(frame_content_size(frame)));
}

template <typename T>
std::vector<T> values_of(std::span<const std::byte> bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

// Ours.

Bytes encode_ours(const TriangleList& triangles, uint32_t vertices) {
    const auto code = codec::mesh::encode_strips(triangles, vertices);
    return code.ok() ? compress_frame(std::as_bytes(std::span(code->words))) : Bytes{};
}

bool decode_ours(std::span<const std::byte> bytes, TriangleList& out) {
    const auto raw = unpack_frame(bytes);
    if (!raw) return false;
    auto triangles = codec::mesh::decode_strips(values_of<uint32_t>(*raw));
    if (!triangles) return false;
    out = std::move(*triangles);
    return true;
}

// meshoptimizer: triangles and vertices in the order that its codec likes best. Two counts, then the coded indices.

Bytes encode_meshoptimizer(const TriangleList& triangles, uint32_t vertices) {
    const size_t count = 3 * triangles.size();
    std::vector<uint32_t> indices(count), remap(vertices);
    meshopt_optimizeVertexCacheStrip(indices.data(), triangles.data()->data(), count, vertices);
    const size_t used = meshopt_optimizeVertexFetchRemap(remap.data(), indices.data(), count, vertices);
    meshopt_remapIndexBuffer(indices.data(), indices.data(), count, remap.data());
    std::vector<unsigned char> coded(sizeof(uint32_t) + meshopt_encodeIndexBufferBound(count, used));
    const auto index_count = static_cast<uint32_t>(count);
    std::memcpy(coded.data(), &index_count, sizeof(index_count));
    coded.resize(sizeof(uint32_t) + meshopt_encodeIndexBuffer(coded.data() + sizeof(uint32_t),
                                                              coded.size() - sizeof(uint32_t), indices.data(), count));
    return compress_frame(std::as_bytes(std::span(coded)));
}

bool decode_meshoptimizer(std::span<const std::byte> bytes, TriangleList& out) {
    const auto raw = unpack_frame(bytes);
    if (!raw || raw->size() < sizeof(uint32_t)) return false;
    uint32_t count = 0;
    std::memcpy(&count, raw->data(), sizeof(count));
    out.resize(count / 3);
    return meshopt_decodeIndexBuffer(out.data(), count, sizeof(uint32_t),
                                     reinterpret_cast<const unsigned char*>(raw->data()) + sizeof(uint32_t),
                                     raw->size() - sizeof(uint32_t)) == 0;
}

// Draco. Every vertex has a position value of its own, so that the connectivity is that of the vertices; the values are
// equal.

Bytes encode_draco(const TriangleList& triangles, uint32_t vertices) {
    draco::Mesh mesh;
    mesh.set_num_points(vertices);
    mesh.SetNumFaces(triangles.size());
    for (uint32_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        mesh.SetFace(draco::FaceIndex(t), {draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
    }
    draco::GeometryAttribute attribute;
    attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_INT32, false, 3 * sizeof(int32_t), 0);
    const int id = mesh.AddAttribute(attribute, true, vertices);
    const std::array<int32_t, 3> origin = {};
    for (uint32_t v = 0; v < vertices; ++v)
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), origin.data());
    draco::ExpertEncoder encoder(mesh);
    encoder.SetSpeedOptions(0, 0);
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeToBuffer(&buffer).ok()) return {};
    const auto coded = std::as_bytes(std::span(buffer.data(), buffer.size()));
    return {coded.begin(), coded.end()};
}

bool decode_draco(std::span<const std::byte> bytes, TriangleList& out) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::Decoder decoder;
    const auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (!mesh.ok()) return false;
    out.resize(mesh.value()->num_faces());
    for (uint32_t t = 0; t < out.size(); ++t) {
        const auto& face = mesh.value()->face(draco::FaceIndex(t));
        for (size_t c = 0; c < 3; ++c) out[t][c] = face[c].value();
    }
    return true;
}

Bytes encode_raw(const TriangleList& triangles, uint32_t) {
    return compress_frame(std::as_bytes(std::span(triangles)));
}

bool decode_raw(std::span<const std::byte> bytes, TriangleList& out) {
    const auto raw = unpack_frame(bytes);
    if (!raw) return false;
    out = values_of<std::array<uint32_t, 3>>(*raw);
    return true;
}

/// Words of `data_bits` bits that hold the codes in order, fewest possible: a word has some count of codes, each with
/// as many bits as that leaves.
uint64_t fewest_words(std::span<const uint32_t> codes, uint32_t data_bits, std::span<const uint32_t> counts) {
    std::vector<uint64_t> words(codes.size() + 1, 0);
    for (size_t i = codes.size(); i-- > 0;) {
        words[i] = ~uint64_t{0};
        for (const uint32_t count : counts) {
            const auto part = codes.subspan(i, std::min<size_t>(count, codes.size() - i));
            const uint32_t width = std::min(32u, data_bits / count);
            const bool fits = std::all_of(part.begin(), part.end(), [width](uint32_t code) {
                return static_cast<uint32_t>(std::bit_width(code)) <= width;
            });
            if (fits) words[i] = std::min(words[i], words[i + part.size()] + 1);
        }
    }
    return words[0];
}

uint64_t greedy_simple9_words(std::span<const uint32_t> codes) {
    uint64_t words = 0;
    for (size_t i = 0; i < codes.size(); ++words) {
        for (uint32_t selector = 0; selector < codec::bits::kSimple9Selectors; ++selector) {
            const auto part =
                codes.subspan(i, std::min<size_t>(codec::bits::kSimple9Counts[selector], codes.size() - i));
            const bool fits = std::all_of(part.begin(), part.end(), [selector](uint32_t code) {
                return code >> codec::bits::kSimple9Widths[selector] == 0;
            });
            if (!fits) continue;
            i += part.size();
            break;
        }
    }
    return words;
}

}  // namespace

std::vector<TopologyPeer> topology_peers() {
    return {{"citystream strip code + zstd -19", encode_ours, decode_ours},
            {"meshoptimizer 0.18 index codec + zstd -19", encode_meshoptimizer, decode_meshoptimizer},
            {"Draco 1.5.5 Edgebreaker -cl 10", encode_draco, decode_draco},
            {"32-bit indices + zstd -19", encode_raw, decode_raw}};
}

uint64_t meshlet_bytes(const TriangleList& triangles, uint32_t vertices) {
    constexpr size_t kVertices = 64, kTriangles = 124;
    const size_t count = 3 * triangles.size();
    std::vector<uint32_t> indices(count);
    meshopt_optimizeVertexCache(indices.data(), triangles.data()->data(), count, vertices);
    std::vector<meshopt_Meshlet> meshlets(meshopt_buildMeshletsBound(count, kVertices, kTriangles));
    std::vector<uint32_t> numbers(meshlets.size() * kVertices);
    std::vector<unsigned char> triples(meshlets.size() * kTriangles * 3);
    meshlets.resize(meshopt_buildMeshletsScan(meshlets.data(), numbers.data(), triples.data(), indices.data(), count,
                                              vertices, kVertices, kTriangles));
    uint64_t bytes = meshlets.size() * sizeof(meshopt_Meshlet);
    for (const auto& meshlet : meshlets)
        bytes += meshlet.vertex_count * sizeof(uint32_t) + ((meshlet.triangle_count * 3 + 3) & ~3u);
    return bytes;
}

WordCodeBits word_code_bits(std::span<const uint32_t> strip_words) {
    const auto header = codec::mesh::read_strip_header(strip_words);
    if (!header) return {};
    const auto codes = codec::bits::unpack_simple9(strip_words.subspan(header->codes_at, header->code_words),
                                                   header->explicit_references);
    constexpr uint32_t k32[] = {32, 16, 10, 8, 6, 5, 4, 3, 2, 1};
    constexpr uint32_t k60[] = {60, 30, 20, 15, 12, 10, 8, 7, 6, 5, 4, 3, 2, 1};
    WordCodeBits bits;
    bits.simple9 = 32 * uint64_t{header->code_words};
    bits.simple9_greedy = 32 * greedy_simple9_words(codes);
    bits.separate_selectors = 36 * fewest_words(codes, 32, k32);
    bits.words_of_64 = 64 * fewest_words(codes, 60, k60);
    bits.fixed_width =
        uint64_t{header->explicit_references} * codec::bits::bits_for(std::max(header->vertices, 1u) - 1);
    return bits;
}

uint64_t chunked_bits(const TriangleList& triangles, uint32_t vertices, uint32_t chunk) {
    const auto code = codec::mesh::encode_strips(triangles, vertices, {STRIP_MODE_RESTARTS, {}, {}});
    if (!code) return 0;
    const auto header = codec::mesh::read_strip_header(code->words);
    // A restart has two references more: a bit each that says they are old, and a number of full width, for nothing
    // that a chunk's own thread knows predicts them; and where each chunk's codes begin.
    const uint64_t width = codec::bits::bits_for(std::max(header->vertices, 1u) - 1);
    return 32 * code->words.size() + header->triangles / chunk * (2 * (1 + width) + 32);
}

}  // namespace citystream::bench
