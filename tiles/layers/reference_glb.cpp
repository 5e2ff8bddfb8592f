#include "tiles/layers/reference_glb.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <unordered_map>

#include "tiles/layers/glb_file.h"
#include "tiles/layers/relief_mesh.h"
#include "tiles/quadtree/spool_file.h"

namespace citystream::tiles::layers {
namespace {

using nlohmann::json;

constexpr double kCellMetres = 256;
constexpr uint32_t kVertexTarget = 34962;
constexpr int kRepeat = 10497, kClamp = 33071, kLinear = 9729, kMipmapped = 9987;

/// One triangle corner as the file holds it.
struct Corner {
    std::array<float, 3> position{}, normal{};
    std::array<float, 2> texcoord{};
    /// Bit by bit: corners that compare equal and differ (0 and -0) stay apart.
    std::array<uint64_t, 4> bits() const { return std::bit_cast<std::array<uint64_t, 4>>(*this); }
    bool operator==(const Corner& o) const { return bits() == o.bits(); }
};
static_assert(sizeof(Corner) == 32);

struct CornerHash {
    size_t operator()(const Corner& corner) const {
        uint64_t h = 0;
        for (const uint64_t word : corner.bits()) h = (h ^ word) * 0x9e3779b97f4a7c15ULL, h ^= h >> 29;
        return h;
    }
};

/// Triangles of one material in one cell, welded.
struct Batch {
    std::vector<Corner> corners;
    std::vector<uint32_t> indices;
    std::unordered_map<Corner, uint32_t, CornerHash> known;

    void add(const Corner& corner) {
        const auto [found, is_new] = known.try_emplace(corner, static_cast<uint32_t>(corners.size()));
        if (is_new) corners.push_back(corner);
        indices.push_back(found->second);
    }
};

/// Triangle as spooled: absolute metres.
struct SpooledTriangle {
    std::array<city::Vec3, 3> position;
    std::array<city::Vec2, 3> texcoord;
    uint32_t material = 0, padding = 0;
};

struct SpooledPart {
    int32_t cell_x = 0, cell_y = 0;
    quadtree::SpoolRange range;
};

/// Shifts whole repeats away, so that floats keep their precision far from the texture's origin.
std::array<double, 2> whole_repeats(const std::array<city::Vec2, 3>& t) {
    return {std::floor(std::min({t[0].x, t[1].x, t[2].x})), std::floor(std::min({t[0].y, t[1].y, t[2].y}))};
}

class Writer final : public ReferenceWriter {
  public:
    Writer(std::unique_ptr<GlbFile> file, std::unique_ptr<quadtree::SpoolFile> spool, std::string folder)
        : file_(std::move(file)), spool_(std::move(spool)), folder_(std::move(folder)) {}

    Status add(const city::CityObject& object) override {
        std::map<std::array<int32_t, 2>, std::vector<SpooledTriangle>> cells;
        for (const city::Triangle& triangle : object.triangles) {
            SpooledTriangle spooled;
            for (size_t k = 0; k < 3; ++k) {
                spooled.position[k] = object.vertices[triangle.vertex[k]];
                spooled.texcoord[k] = triangle.texcoord[k];
            }
            spooled.material = triangle.material;
            const auto cell = [](double metres) { return static_cast<int32_t>(std::floor(metres / kCellMetres)); };
            cells[{cell(spooled.position[0].x), cell(spooled.position[0].y)}].push_back(spooled);
        }
        for (const auto& [cell, triangles] : cells) {
            auto range = spool_->append(std::as_bytes(std::span(triangles)));
            if (!range) return range.error();
            parts_.push_back({cell[0], cell[1], *range});
        }
        for (const city::FacadeWall& wall : object.facades) walls_[{wall.map, wall.palette}].push_back(wall);
        return Done{};
    }

    Status finish(const city::CityCatalog& catalog, FacadePainter& facades, const quadtree::GridBox& extent,
                  const GridPoint& origin) override {
        catalog_ = &catalog;
        origin_ = {to_metres(origin.x), to_metres(origin.y),
                   std::floor((to_metres(extent.lo.z) + to_metres(extent.hi.z)) / 2)};
        json& out = file_->json();
        out["asset"] = {{"version", "2.0"},
                        {"generator", "citystream-build"},
                        {"extras", {{"citystream", {{"origin", {origin_.x, origin_.y, origin_.z}}}}}}};
        // z up to glTF's y up: a quarter turn about x, backwards.
        const double half = std::sqrt(0.5);
        file_->add("nodes", {{"name", "city, z up"}, {"rotation", {-half, 0.0, 0.0, half}}});
        if (Status status = write_cells(); !status) return status;
        if (Status status = write_walls(facades); !status) return status;
        if (!children_.empty()) out["nodes"][0]["children"] = children_;
        out["scenes"] = {{{"nodes", {0}}}};
        out["scene"] = 0;
        if (!extensions_.empty()) {
            out["extensionsUsed"] = extensions_;
            if (extensions_.count("EXT_mesh_gpu_instancing") != 0)
                out["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
        }
        return file_->finish();
    }

  private:
    Status write_cells() {
        std::stable_sort(parts_.begin(), parts_.end(), [](const SpooledPart& a, const SpooledPart& b) {
            return std::array{a.cell_y, a.cell_x} < std::array{b.cell_y, b.cell_x};
        });
        for (size_t begin = 0, end = 0; begin < parts_.size(); begin = end) {
            std::vector<std::byte> bytes;
            for (end = begin; end < parts_.size() && parts_[end].cell_x == parts_[begin].cell_x &&
                              parts_[end].cell_y == parts_[begin].cell_y;
                 ++end) {
                if (Status status = spool_->read(parts_[end].range, bytes); !status) return status;
            }
            std::vector<SpooledTriangle> triangles(bytes.size() / sizeof(SpooledTriangle));
            std::memcpy(static_cast<void*>(triangles.data()), bytes.data(), triangles.size() * sizeof(SpooledTriangle));
            bytes = {};
            if (Status status = write_cell(parts_[begin], triangles); !status) return status;
        }
        return Done{};
    }

    Status write_cell(const SpooledPart& cell, const std::vector<SpooledTriangle>& triangles) {
        const city::Vec3 corner{cell.cell_x * kCellMetres, cell.cell_y * kCellMetres, origin_.z};
        std::map<uint32_t, Batch> batches;
        for (const SpooledTriangle& triangle : triangles) add_triangle(batches[triangle.material], triangle, corner);
        json primitives = json::array();
        for (const auto& [material, batch] : batches) {
            if (batch.indices.empty()) continue;
            auto primitive = write_batch(batch, material);
            if (!primitive) return primitive.error();
            primitives.push_back(std::move(primitive).value());
        }
        if (primitives.empty()) return Done{};
        const uint32_t mesh = file_->add("meshes", {{"primitives", std::move(primitives)}});
        children_.push_back(
            file_->add("nodes", {{"mesh", mesh}, {"translation", {corner.x - origin_.x, corner.y - origin_.y, 0.0}}}));
        return Done{};
    }

    static void add_triangle(Batch& batch, const SpooledTriangle& triangle, const city::Vec3& corner) {
        const auto& p = triangle.position;
        const double ux = p[1].x - p[0].x, uy = p[1].y - p[0].y, uz = p[1].z - p[0].z;
        const double vx = p[2].x - p[0].x, vy = p[2].y - p[0].y, vz = p[2].z - p[0].z;
        const std::array<double, 3> n = {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
        const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (length <= 0) return;
        const auto shift = whole_repeats(triangle.texcoord);
        for (size_t k = 0; k < 3; ++k) {
            Corner out;
            out.position = {static_cast<float>(p[k].x - corner.x), static_cast<float>(p[k].y - corner.y),
                            static_cast<float>(p[k].z - corner.z)};
            out.normal = {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length),
                          static_cast<float>(n[2] / length)};
            out.texcoord = {static_cast<float>(triangle.texcoord[k].x - shift[0]),
                            static_cast<float>(1 - (triangle.texcoord[k].y - shift[1]))};
            batch.add(out);
        }
    }

    Result<json> write_batch(const Batch& batch, uint32_t material) {
        std::vector<float> positions, normals, texcoords;
        for (const Corner& corner : batch.corners) {
            positions.insert(positions.end(), corner.position.begin(), corner.position.end());
            normals.insert(normals.end(), corner.normal.begin(), corner.normal.end());
            texcoords.insert(texcoords.end(), corner.texcoord.begin(), corner.texcoord.end());
        }
        return write_primitive(positions, normals, texcoords, batch.indices, gltf_material(material, 0));
    }

    Result<json> write_primitive(std::span<const float> positions, std::span<const float> normals,
                                 std::span<const float> texcoords, std::span<const uint32_t> indices,
                                 uint32_t material) {
        const auto p = file_->add_floats(positions, 3, true, kVertexTarget);
        if (!p) return p.error();
        const auto n = file_->add_floats(normals, 3, false, kVertexTarget);
        if (!n) return n.error();
        const auto t = file_->add_floats(texcoords, 2, false, kVertexTarget);
        if (!t) return t.error();
        const auto i = file_->add_indices(indices);
        if (!i) return i.error();
        return json{{"attributes", {{"POSITION", *p}, {"NORMAL", *n}, {"TEXCOORD_0", *t}}},
                    {"indices", *i},
                    {"material", material}};
    }

    /// glTF material of a catalog material; with metres_per_repeat > 0 the texture coordinates are metres.
    uint32_t gltf_material(uint32_t material, float metres_per_repeat) {
        const auto key = std::pair(material, metres_per_repeat);
        if (const auto found = materials_.find(key); found != materials_.end()) return found->second;
        const city::Material& m = catalog_->materials[material];
        json pbr = {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
        const int64_t image = m.image < 0 ? -1 : gltf_image(static_cast<uint32_t>(m.image));
        if (image < 0) {
            pbr["baseColorFactor"] = {srgb_to_linear(m.rgb[0]), srgb_to_linear(m.rgb[1]), srgb_to_linear(m.rgb[2]),
                                      1.0};
        } else {
            pbr["baseColorTexture"] = {
                {"index", gltf_texture(static_cast<uint32_t>(image), m.repeat || metres_per_repeat > 0)}};
            if (metres_per_repeat > 0) {
                const double scale = 1.0 / static_cast<double>(metres_per_repeat);
                pbr["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {{"scale", {scale, scale}}};
                extensions_.insert("KHR_texture_transform");
            }
        }
        json out = {{"pbrMetallicRoughness", std::move(pbr)}, {"doubleSided", true}};
        // Relief, whose coordinates are metres, is solid.
        if (image >= 0 && metres_per_repeat <= 0 && masked_.count(static_cast<uint32_t>(m.image)) != 0) {
            out["alphaMode"] = "MASK";
            out["alphaCutoff"] = 0.5;
        }
        return materials_[key] = file_->add("materials", std::move(out));
    }

    uint32_t gltf_texture(uint32_t image, bool repeat) {
        const auto key = std::pair(image, repeat);
        if (const auto found = textures_.find(key); found != textures_.end()) return found->second;
        const int wrap = repeat ? kRepeat : kClamp;
        if (samplers_.count(repeat) == 0) {
            samplers_[repeat] = file_->add(
                "samplers", {{"magFilter", kLinear}, {"minFilter", kMipmapped}, {"wrapS", wrap}, {"wrapT", wrap}});
        }
        return textures_[key] = file_->add("textures", {{"source", image}, {"sampler", samplers_[repeat]}});
    }

    /// Index of the glTF image, or -1 when it cannot be read.
    int64_t gltf_image(uint32_t image) {
        if (const auto found = images_.find(image); found != images_.end()) return found->second;
        images_[image] = -1;
        std::string bytes = image_file(image);
        if (bytes.empty()) return -1;
        const bool png = bytes.starts_with("\x89PNG");
        const auto view = file_->add_view(std::as_bytes(std::span(bytes)), 0);
        if (!view) return -1;
        return images_[image] =
                   file_->add("images", {{"bufferView", *view}, {"mimeType", png ? "image/png" : "image/jpeg"}});
    }

    /// The image's own bytes when they are PNG or JPEG that can be decoded, else PNG made of its pixels. Where it has
    /// alpha, too: viewers filter the colours of what is not there with those of what is.
    std::string image_file(uint32_t image) {
        const city::ImageSource& source = catalog_->images[image];
        if (const auto drawn = source.drawn())
            return encode_png({drawn->width, drawn->height, false, false, 0, drawn->rgb});
        const auto decoded = decode_image(source.path);
        if (!decoded) return {};
        if (!decoded->alpha.empty()) {
            masked_.insert(image);
            return encode_png(*decoded);
        }
        std::ifstream file(source.path, std::ios::binary);
        std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
        if (bytes.starts_with("\x89PNG") || bytes.starts_with("\xff\xd8\xff")) return bytes;
        return encode_png(*decoded);
    }

    std::string encode_png(const ChartImage& image) const {
        const std::string path = folder_ + "/reference.png";
        auto output = OIIO::ImageOutput::create(path);
        const size_t channels = image.alpha.empty() ? 3 : 4;
        OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), static_cast<int>(channels),
                             OIIO::TypeDesc::UINT8);
        spec.attribute("oiio:UnassociatedAlpha", 1);
        if (!output || !output->open(path, spec)) return {};
        std::vector<uint8_t> row(channels * image.width);
        for (uint32_t y = 0; y < image.height; ++y) {
            const size_t first = size_t{image.width} * (image.height - 1 - y);
            for (size_t x = 0; x < image.width; ++x) {
                std::copy_n(&image.rgb[3 * (first + x)], 3, &row[channels * x]);
                if (channels == 4) row[4 * x + 3] = image.alpha[first + x];
            }
            if (!output->write_scanline(static_cast<int>(y), 0, OIIO::TypeDesc::UINT8, row.data())) return {};
        }
        output->close();
        std::ifstream file(path, std::ios::binary);
        return {(std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>()};
    }

    Status write_walls(FacadePainter& facades) {
        std::map<uint32_t, std::map<uint32_t, json>> reliefs;  // by map: one primitive without material for each slot
        for (const auto& [key, walls] : walls_) {
            const auto& [map, palette] = key;
            if (reliefs.count(map) == 0) {
                auto relief = write_relief(map);
                if (!relief) return relief.error();
                reliefs[map] = std::move(relief).value();
            }
            json primitives = json::array();
            for (const auto& [slot, primitive] : reliefs[map]) {
                const uint32_t material = catalog_->palettes[palette].material[slot];
                const float repeat = catalog_->materials[material].metres_per_repeat;
                json own = primitive;
                own["material"] = gltf_material(material, repeat > 0 ? repeat : 1.0F);
                primitives.push_back(std::move(own));
            }
            const uint32_t mesh = file_->add("meshes", {{"primitives", std::move(primitives)}});
            if (Status status = write_instances(mesh, walls, facades.facts(map)); !status) return status;
        }
        return Done{};
    }

    Result<std::map<uint32_t, json>> write_relief(uint32_t map) {
        std::map<uint32_t, json> primitives;
        for (const auto& [slot, part] : make_relief(catalog_->facade_maps.map(map))) {
            const auto floats = [](const auto& list) {
                return std::span(list.data()->data(), list.size() * list.data()->size());
            };
            auto primitive =
                write_primitive(floats(part.positions), floats(part.normals), floats(part.texcoords), part.indices, 0);
            if (!primitive) return primitive.error();
            primitives[slot] = std::move(primitive).value();
        }
        return primitives;
    }

    Status write_instances(uint32_t mesh, const std::vector<city::FacadeWall>& walls, const FacadeFacts& facts) {
        std::vector<float> translations, rotations, scales;
        const auto put = [](std::vector<float>& list, std::initializer_list<double> values) {
            for (double value : values) list.push_back(static_cast<float>(value));
        };
        for (const city::FacadeWall& wall : walls) {
            put(translations,
                {wall.lower_left.x - origin_.x, wall.lower_left.y - origin_.y, wall.lower_left.z - origin_.z});
            // A quarter turn about x stands the map up (its y becomes z), then a turn about z lays its x along the
            // wall.
            const double half = std::atan2(wall.along.y, wall.along.x) / 2, s = std::sqrt(0.5);
            put(rotations, {std::cos(half) * s, std::sin(half) * s, std::sin(half) * s, std::cos(half) * s});
            put(scales,
                {std::hypot(wall.along.x, wall.along.y) / facts.width_metres, wall.height / facts.height_metres, 1});
        }
        const auto t = file_->add_floats(translations, 3, false, 0);
        if (!t) return t.error();
        const auto r = file_->add_floats(rotations, 4, false, 0);
        if (!r) return r.error();
        const auto s = file_->add_floats(scales, 3, false, 0);
        if (!s) return s.error();
        extensions_.insert("EXT_mesh_gpu_instancing");
        json attributes = {{"TRANSLATION", *t}, {"ROTATION", *r}, {"SCALE", *s}};
        children_.push_back(file_->add(
            "nodes",
            {{"mesh", mesh}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", std::move(attributes)}}}}}}));
        return Done{};
    }

    std::unique_ptr<GlbFile> file_;
    std::unique_ptr<quadtree::SpoolFile> spool_;
    std::string folder_;
    const city::CityCatalog* catalog_ = nullptr;
    city::Vec3 origin_;
    std::vector<SpooledPart> parts_;
    std::map<std::pair<uint32_t, uint32_t>, std::vector<city::FacadeWall>> walls_;  // by map, palette
    std::map<std::pair<uint32_t, float>, uint32_t> materials_;
    std::map<std::pair<uint32_t, bool>, uint32_t> textures_;
    std::map<bool, uint32_t> samplers_;
    std::map<uint32_t, int64_t> images_;
    std::set<uint32_t> masked_;  // images of the catalog with alpha
    std::set<std::string> extensions_;
    std::vector<uint32_t> children_;
};

}  // namespace

Result<std::unique_ptr<ReferenceWriter>> ReferenceWriter::create(const std::string& path, const std::string& folder) {
    auto file = GlbFile::create(path, folder);
    if (!file) return file.error();
    auto spool = quadtree::SpoolFile::create(folder + "/reference");
    if (!spool) return spool.error();
    return std::unique_ptr<ReferenceWriter>(new Writer(std::move(file).value(), std::move(spool).value(), folder));
}

}  // namespace citystream::tiles::layers
