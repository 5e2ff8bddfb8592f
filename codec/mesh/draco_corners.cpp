#include "codec/mesh/draco_corners.h"

#include <draco/compression/expert_encode.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/mesh/mesh.h>

#include <cstring>
#include <exception>
#include <memory>
#include <string>

namespace citystream::codec::mesh {

namespace {

/// Attributes in the order in which they are added, which is that of their unique ids.
enum : uint32_t { kPlace, kTexcoord, kNormal, kFace, kAttributes };
constexpr std::array<uint8_t, kAttributes> kComponents = {3, 2, 2, 1};
constexpr draco::GeometryAttribute::Type type_of(uint32_t attribute) {
    return attribute == kPlace ? draco::GeometryAttribute::POSITION : draco::GeometryAttribute::GENERIC;
}

template <typename IntegersOf>
void add_attribute(draco::Mesh& mesh, uint32_t attribute, std::span<const DracoCorner> corners, IntegersOf of) {
    draco::GeometryAttribute form;
    const auto components = static_cast<int8_t>(kComponents[attribute]);
    form.Init(type_of(attribute), nullptr, components, draco::DT_INT32, false, components * int64_t{4}, 0);
    const int id = mesh.AddAttribute(form, true, static_cast<uint32_t>(corners.size()));
    for (uint32_t c = 0; c < corners.size(); ++c)
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(c), of(corners[c]));
}

void fill(draco::Mesh& mesh, std::span<const DracoCorner> corners) {
    mesh.set_num_points(static_cast<uint32_t>(corners.size()));
    mesh.SetNumFaces(corners.size() / 3);
    for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
        draco::Mesh::Face face;
        for (uint32_t c = 0; c < 3; ++c) face[c] = draco::PointIndex(3 * f + c);
        mesh.SetFace(draco::FaceIndex(f), face);
    }
    add_attribute(mesh, kPlace, corners, [](const DracoCorner& corner) { return corner.place.data(); });
    add_attribute(mesh, kTexcoord, corners, [](const DracoCorner& corner) { return corner.texcoord.data(); });
    add_attribute(mesh, kNormal, corners, [](const DracoCorner& corner) { return corner.normal.data(); });
    add_attribute(mesh, kFace, corners, [](const DracoCorner& corner) { return &corner.face; });
    mesh.DeduplicateAttributeValues();
    mesh.DeduplicatePointIds();
}

Error damaged(const std::string& what) {
    return Error{"Draco mesh: " + what, 0};
}

/// What libdraco makes room for before it looks at any data.
struct Claims {
    DracoMethod method = DracoMethod::kEdgebreaker;
    uint64_t faces = 0, points = 0, attribute_groups = 0;
};

/// Reads the beginning of the bytes as Draco's bitstream 2.2 has it.
class ClaimReader {
  public:
    explicit ClaimReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::optional<Claims> read() {
        constexpr std::array<uint8_t, 8> kBegin = {'D', 'R', 'A', 'C', 'O', 2, 2, draco::TRIANGULAR_MESH};
        for (const uint8_t expected : kBegin) {
            if (byte() != expected) return std::nullopt;
        }
        const uint8_t method = byte();
        const bool has_metadata = byte() != 0 || byte() != 0;
        if (has_metadata) return std::nullopt;
        Claims claims;
        if (method == draco::MESH_EDGEBREAKER_ENCODING) {
            byte();  // how the traversal is coded: checked by libdraco
            claims.points = varint();
            claims.faces = varint();
            claims.attribute_groups = byte();
        } else if (method == draco::MESH_SEQUENTIAL_ENCODING) {
            claims.method = DracoMethod::kSequential;
            claims.faces = varint();
            claims.points = varint();
        } else {
            return std::nullopt;
        }
        return whole_ ? std::optional(claims) : std::nullopt;
    }

  private:
    uint8_t byte() {
        whole_ = whole_ && at_ < bytes_.size();
        return whole_ ? static_cast<uint8_t>(bytes_[at_++]) : uint8_t{0};
    }
    uint64_t varint() {
        uint64_t value = 0;
        for (uint32_t shift = 0; shift < 35; shift += 7) {
            const uint8_t part = byte();
            value |= static_cast<uint64_t>(part & 127u) << shift;
            if (part < 128) return value;
        }
        whole_ = false;
        return value;
    }

    std::span<const std::byte> bytes_;
    size_t at_ = 0;
    bool whole_ = true;
};

bool has_our_attributes(const draco::PointCloud& mesh) {
    if (mesh.num_attributes() != static_cast<int32_t>(kAttributes)) return false;
    for (uint32_t a = 0; a < kAttributes; ++a) {
        const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(a);
        if (attribute == nullptr || attribute->attribute_type() != type_of(a) ||
            attribute->data_type() != draco::DT_INT32 || attribute->num_components() != kComponents[a])
            return false;
    }
    return true;
}

/// A decoder of libdraco that stops when the attributes it is told of are others, before it makes room for them.
template <typename Decoder>
class OurDecoder final : public Decoder {
  protected:
    bool DecodeAllAttributes() override {
        return has_our_attributes(*this->point_cloud()) && Decoder::DecodeAllAttributes();
    }
};

template <typename Decoder>
bool decode_with(std::span<const std::byte> bytes, draco::Mesh& mesh) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return OurDecoder<Decoder>().Decode(draco::DecoderOptions(), &buffer, &mesh).ok();
}

bool decode_mesh_of(DracoMethod method, std::span<const std::byte> bytes, draco::Mesh& mesh) {
    try {
        return method == DracoMethod::kEdgebreaker ? decode_with<draco::MeshEdgebreakerDecoder>(bytes, mesh)
                                                   : decode_with<draco::MeshSequentialDecoder>(bytes, mesh);
    } catch (const std::exception&) {
        return false;  // libdraco reports damage by status, but its containers throw
    }
}

/// A value of a corner; false where an index leads outside.
bool read_value(const draco::Mesh& mesh, uint32_t id, draco::PointIndex point, int32_t* out) {
    const draco::PointAttribute& attribute = *mesh.GetAttributeByUniqueId(id);
    if (!attribute.is_mapping_identity() && point.value() >= attribute.indices_map_size()) return false;
    const draco::AttributeValueIndex value = attribute.mapped_index(point);
    if (value.value() >= attribute.size()) return false;
    attribute.GetValue(value, out);
    return true;
}

bool read_corner(const draco::Mesh& mesh, draco::PointIndex point, DracoCorner& corner) {
    return point.value() < mesh.num_points() && read_value(mesh, kPlace, point, corner.place.data()) &&
           read_value(mesh, kTexcoord, point, corner.texcoord.data()) &&
           read_value(mesh, kNormal, point, corner.normal.data()) && read_value(mesh, kFace, point, &corner.face);
}

}  // namespace

std::optional<std::vector<std::byte>> encode_draco_corners(std::span<const DracoCorner> corners, DracoMethod method) {
    draco::Mesh mesh;
    fill(mesh, corners);
    draco::ExpertEncoder encoder(mesh);
    encoder.SetSpeedOptions(0, 0);
    encoder.SetEncodingMethod(method == DracoMethod::kEdgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                                                  : draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeToBuffer(&buffer).ok()) return std::nullopt;
    const auto coded = std::as_bytes(std::span(buffer.data(), buffer.size()));
    return std::vector<std::byte>(coded.begin(), coded.end());
}

Result<std::vector<DracoCorner>> decode_draco_corners(std::span<const std::byte> bytes, uint32_t triangles) {
    const auto claims = ClaimReader(bytes).read();
    if (!claims) return damaged("no mesh of bitstream 2.2");
    if (claims->faces != triangles || claims->points > uint64_t{3} * triangles ||
        claims->attribute_groups > kAttributes)
        return damaged("claims other counts than its layer");
    draco::Mesh mesh;
    if (!decode_mesh_of(claims->method, bytes, mesh)) return damaged("libdraco cannot read it");
    if (mesh.num_faces() != triangles || !has_our_attributes(mesh)) return damaged("holds something else");
    std::vector<DracoCorner> corners;
    corners.reserve(size_t{3} * triangles);
    for (uint32_t f = 0; f < triangles; ++f) {
        for (const draco::PointIndex& point : mesh.face(draco::FaceIndex(f))) {
            if (!read_corner(mesh, point, corners.emplace_back())) return damaged("an index leads outside");
        }
    }
    return corners;
}

}  // namespace citystream::codec::mesh
