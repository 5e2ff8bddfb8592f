#include "tests/bench/mesh_codecs.h"

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "codec/bits/zstd_frame.h"
#include "codec/chart_word.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_triangles.h"
#include "codec/mesh/mesh_wire.h"
#include "tests/bench/glb_mesh.h"
#include "tests/bench/meshopt_arrays.h"
#include "tests/codec/mesh/triangles_by_place.h"

namespace citystream::bench {

using codec::mesh::GridMesh;
using codec::mesh::GridPoint;
using codec::mesh::MeshTile;
using codec::mesh::MeshVertex;

namespace {

template <typename T>
CodedMesh::Part frame_of(const std::string& name, const std::vector<T>& values) {
    const auto bytes = std::as_bytes(std::span<const T>(values));
    return {name, codec::bits::compress_frame(bytes), static_cast<uint32_t>(bytes.size())};
}

template <typename T>
bool decode_array(const CodedMesh::Part& part, std::vector<T>& out) {
    const auto bytes = codec::bits::decompress_frame(part.bytes, part.decoded_bytes);
    if (!bytes) return false;
    out.resize(bytes->size() / sizeof(T));
    std::memcpy(out.data(), bytes->data(), out.size() * sizeof(T));
    return true;
}

/// Arrays as a renderer without a codec of its own keeps them: positions of 16 bits where they fit, short indices where
/// they do.
uint64_t plain_bytes(const GridMesh& mesh, uint32_t bits) {
    const uint64_t position = bits <= 16 ? 6 : 12, index = mesh.points.size() <= 65536 ? 2 : 4;
    return mesh.points.size() * position + mesh.triangles.size() * 3 * index;
}

// Ours: the mesh layer in one step, each triangle with its plane's normal and one colour for all.

MeshTile tile_of(const GridMesh& mesh) {
    MeshTile tile;
    for (const auto& triangle : mesh.triangles) {
        std::array<std::array<double, 3>, 2> edges{};
        const GridPoint& a = mesh.points[triangle[0]];
        for (size_t e = 0; e < 2; ++e) {
            for (size_t c = 0; c < 3; ++c) edges[e][c] = mesh.points[triangle[e + 1]][c] - a[c];
        }
        const auto& [u, v] = edges;
        const std::array<double, 3> normal = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                              u[0] * v[1] - u[1] * v[0]};
        for (const uint32_t index : triangle) {
            const GridPoint& p = mesh.points[index];
            tile.indices.push_back(static_cast<uint32_t>(tile.vertices.size()));
            MeshVertex vertex{{p[0], p[1], p[2]}, {}, {}};
            for (size_t c = 0; c < 3; ++c) vertex.normal[c] = static_cast<float>(normal[c]);
            tile.vertices.push_back(vertex);
        }
        tile.triangle_chart.push_back(CHART_WORD_UNTEXTURED);
    }
    tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
    return tile;
}

/// As encode_mesh_layer does it, with what is known of where bits go.
CodedMesh encode_ours(const QuantisedMesh& source, uint32_t bits) {
    codec::mesh::MeshContentOptions options;
    options.topology = codec::mesh::MeshTopology::kLocalStrips;
    options.most_steps = 1;
    const MeshTile tile = tile_of(source.mesh);
    auto wire = encode_mesh_wire(make_content(tile, options));
    CodedMesh coded;
    coded.bits = bits;
    const auto resident = static_cast<uint32_t>(4 * make_resident(wire.content).added_words(0));
    coded.parts.push_back({"layer", std::move(wire.steps[0]), resident});
    coded.bits_of = bits_by_part(wire.bits);
    return coded;
}

bool decode_ours(const CodedMesh& coded, GridMesh& out) {
    const std::span<const std::byte> step = coded.parts[0].bytes;
    const auto layer = codec::mesh::decode_mesh_layer({&step, 1}, {&coded.parts[0].decoded_bytes, 1}, 0);
    if (!layer) return false;
    for_each_triangle(layer->content, [&out](const codec::mesh::PlacedTriangle& triangle) {
        const auto first = static_cast<uint32_t>(out.points.size());
        out.points.insert(out.points.end(), triangle.places.begin(), triangle.places.end());
        out.triangles.push_back({first, first + 1, first + 2});
    });
    return true;
}

// Draco at its highest compression level (-cl 10: speed 0), quantised to the same integers.

CodedMesh encode_draco(const QuantisedMesh& source, uint32_t bits) {
    draco::Mesh mesh;
    mesh.set_num_points(static_cast<uint32_t>(source.mesh.points.size()));
    mesh.SetNumFaces(source.mesh.triangles.size());
    for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
        draco::Mesh::Face face;
        for (size_t c = 0; c < 3; ++c) face[c] = draco::PointIndex(source.mesh.triangles[f][c]);
        mesh.SetFace(draco::FaceIndex(f), face);
    }
    draco::GeometryAttribute attribute;
    attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float), 0);
    const int id = mesh.AddAttribute(attribute, true, mesh.num_points());
    for (uint32_t v = 0; v < mesh.num_points(); ++v) {
        std::array<float, 3> place{};
        for (size_t c = 0; c < 3; ++c) place[c] = static_cast<float>(source.mesh.points[v][c]);
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), place.data());
    }
    const std::array<float, 3> zero = {};
    draco::ExpertEncoder encoder(mesh);
    encoder.SetSpeedOptions(0, 0);
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    // A range of 2^bits - 1 makes the quantisation step exactly one unit.
    encoder.SetAttributeExplicitQuantization(0, static_cast<int>(bits), 3, zero.data(),
                                             static_cast<float>((1 << bits) - 1));
    draco::EncoderBuffer buffer;
    CodedMesh coded;
    coded.bits = bits;
    if (!encoder.EncodeToBuffer(&buffer).ok()) return coded;
    const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    coded.parts.push_back({"mesh", {bytes.begin(), bytes.end()}, 0});
    return coded;
}

bool decode_draco(const CodedMesh& coded, GridMesh& out) {
    if (coded.parts.empty()) return false;
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(coded.parts[0].bytes.data()), coded.parts[0].bytes.size());
    draco::Decoder decoder;
    const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok() || decoded.value()->num_attributes() != 1) return false;
    const draco::Mesh& mesh = *decoded.value();
    for (uint32_t v = 0; v < mesh.num_points(); ++v) {
        std::array<float, 3> place{};
        mesh.attribute(0)->GetMappedValue(draco::PointIndex(v), place.data());
        GridPoint point{};
        for (size_t c = 0; c < 3; ++c) point[c] = static_cast<int32_t>(std::lround(place[c]));
        out.points.push_back(point);
    }
    for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
        const auto& face = mesh.face(draco::FaceIndex(f));
        out.triangles.push_back({face[0].value(), face[1].value(), face[2].value()});
    }
    return true;
}

// meshoptimizer: vertices and indices in the order that it compresses best, each in a zstd frame.

using ShortRow = std::array<uint16_t, 4>;  ///< rows must be a multiple of 4 bytes: one coordinate to spare
using IntRow = std::array<uint32_t, 3>;

CodedMesh encode_meshopt(const QuantisedMesh& source, uint32_t bits) {
    const MeshoptArrays arrays =
        bits <= 16 ? encode_meshopt_arrays<ShortRow>(source.mesh) : encode_meshopt_arrays<IntRow>(source.mesh);
    CodedMesh result;
    result.parts = {frame_of("positions", arrays.vertices), frame_of("topology", arrays.indices)};
    result.points = static_cast<uint32_t>(arrays.vertex_count);
    result.indices = static_cast<uint32_t>(arrays.index_count);
    result.bits = bits;
    return result;
}

bool decode_meshopt(const CodedMesh& coded, GridMesh& out) {
    std::vector<unsigned char> vertices, indices;
    if (!decode_array(coded.parts[0], vertices) || !decode_array(coded.parts[1], indices)) return false;
    return coded.bits <= 16 ? decode_meshopt_arrays<ShortRow>(vertices, coded.points, indices, coded.indices, out)
                            : decode_meshopt_arrays<IntRow>(vertices, coded.points, indices, coded.indices, out);
}

// glTF: a whole .glb in a zstd frame.

CodedMesh encode_glb(const QuantisedMesh& source, uint32_t bits, GlbForm form) {
    CodedMesh coded;
    coded.bits = bits;
    coded.step = source.step;
    coded.parts.push_back(frame_of("file", write_glb(source.mesh, source.step, bits, form)));
    return coded;
}

bool decode_glb(const CodedMesh& coded, GridMesh& out) {
    std::vector<std::byte> file;
    return decode_array(coded.parts[0], file) && read_glb(file, coded.step, out);
}

}  // namespace

uint64_t CodedMesh::wire_bytes() const {
    uint64_t sum = 0;
    for (const Part& part : parts) sum += part.bytes.size();
    return sum;
}

PartBits bits_by_part(const codec::mesh::MeshWireBits& bits) {
    const codec::mesh::AttributeBits& attributes = bits.attributes;
    return {{"prisms", bits.prisms},
            {"positions", bits.positions + bits.refinement + bits.most_dropped},
            {"topology", bits.topology},
            {"normals", attributes.normals},
            {"attributes", bits.prism_colours + attributes.dressed + attributes.charts + attributes.texcoords}};
}

std::vector<MeshCodec> mesh_codecs() {
    const auto layer_bytes = [](const CodedMesh& coded, const GridMesh&) -> uint64_t {
        return coded.parts[0].decoded_bytes;
    };
    const auto plain_bytes = [](const CodedMesh& coded, const GridMesh& mesh) {
        return bench::plain_bytes(mesh, coded.bits);
    };
    const auto glb_of = [](GlbForm form) {
        return [form](const QuantisedMesh& source, uint32_t bits) { return encode_glb(source, bits, form); };
    };
    const auto raw_bytes = [](const CodedMesh&, const GridMesh& mesh) { return bench::plain_bytes(mesh, 32); };
    return {{"default", encode_ours, decode_ours, layer_bytes},
            {"draco", encode_draco, decode_draco, plain_bytes},
            {"meshopt", encode_meshopt, decode_meshopt, plain_bytes},
            {"glb-meshopt", glb_of(GlbForm::kMeshopt), decode_glb, plain_bytes},
            {"glb", glb_of(GlbForm::kFloats), decode_glb, raw_bytes}};
}

bool same_triangles(const GridMesh& a, const GridMesh& b) {
    return a.triangles.size() == b.triangles.size() && triangles_by_place(a) == triangles_by_place(b);
}

}  // namespace citystream::bench
