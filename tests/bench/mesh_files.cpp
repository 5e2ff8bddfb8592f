#include "tests/bench/mesh_files.h"

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
// IOManager's readers register themselves from this header.
#include <OpenMesh/Core/IO/IOInstances.hh>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>

#include "tiles/city/city_input.h"
#include "tiles/city/generator.h"
#include "tiles/city/text_source.h"

namespace citystream::bench {

namespace {

using namespace tiles;

/// Takes what OpenMesh's readers find as it is: a mesh of OpenMesh would leave out what is not manifold.
class TriangleCollector : public OpenMesh::IO::BaseImporter {
  public:
    explicit TriangleCollector(SourceMesh& mesh) : mesh_(mesh) {}
    OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3f& point) override {
        return add_vertex(OpenMesh::Vec3d(point));
    }
    OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3d& point) override {
        mesh_.points.push_back({point[0], point[1], point[2]});
        return OpenMesh::VertexHandle(static_cast<int>(mesh_.points.size() - 1));
    }
    OpenMesh::VertexHandle add_vertex() override { return add_vertex(OpenMesh::Vec3d(0, 0, 0)); }
    OpenMesh::FaceHandle add_face(const VHandles& corners) override {
        const auto corner = [&](size_t i) { return static_cast<uint32_t>(corners[i].idx()); };
        for (size_t i = 2; i < corners.size(); ++i) mesh_.triangles.push_back({corner(0), corner(i - 1), corner(i)});
        return OpenMesh::FaceHandle(faces_++);
    }
    void set_point(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3f& point) override {
        mesh_.points[static_cast<size_t>(vertex.idx())] = {point[0], point[1], point[2]};
    }
    size_t n_vertices() const override { return mesh_.points.size(); }
    size_t n_faces() const override { return static_cast<size_t>(faces_); }
    size_t n_edges() const override { return 0; }

    OpenMesh::HalfedgeHandle add_edge(OpenMesh::VertexHandle, OpenMesh::VertexHandle) override {
        return OpenMesh::HalfedgeHandle();
    }
    OpenMesh::FaceHandle add_face(OpenMesh::HalfedgeHandle) override { return OpenMesh::FaceHandle(); }
    void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle,
                            const std::vector<OpenMesh::Vec2f>&) override {}
    void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle,
                            const std::vector<OpenMesh::Vec3f>&) override {}
    void set_face_texindex(OpenMesh::FaceHandle, int) override {}
    void set_halfedge(OpenMesh::VertexHandle, OpenMesh::HalfedgeHandle) override {}
    void set_normal(OpenMesh::VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_normal(OpenMesh::VertexHandle, const OpenMesh::Vec3d&) override {}
    void set_color(OpenMesh::VertexHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(OpenMesh::VertexHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(OpenMesh::VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_color(OpenMesh::VertexHandle, const OpenMesh::Vec4f&) override {}
    void set_texcoord(OpenMesh::VertexHandle, const OpenMesh::Vec2f&) override {}
    void set_status(OpenMesh::VertexHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_next(OpenMesh::HalfedgeHandle, OpenMesh::HalfedgeHandle) override {}
    void set_face(OpenMesh::HalfedgeHandle, OpenMesh::FaceHandle) override {}
    void request_face_texcoords2D() override {}
    void set_texcoord(OpenMesh::HalfedgeHandle, const OpenMesh::Vec2f&) override {}
    void set_texcoord(OpenMesh::VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_texcoord(OpenMesh::HalfedgeHandle, const OpenMesh::Vec3f&) override {}
    void set_status(OpenMesh::HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3f&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4f&) override {}
    void set_status(OpenMesh::EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_normal(OpenMesh::FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_normal(OpenMesh::FaceHandle, const OpenMesh::Vec3d&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec4f&) override {}
    void set_status(OpenMesh::FaceHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void add_texture_information(int, std::string) override {}

  private:
    SourceMesh& mesh_;
    int faces_ = 0;
};

Result<std::string> whole_text(const std::string& path) {
    auto source = city::TextSource::open(path);
    if (!source) return source.error();
    std::string text;
    std::vector<char> chunk(1 << 20);
    for (;;) {
        const auto read = source->read(chunk);
        if (!read) return read.error();
        if (*read == 0) return text;
        text.append(chunk.data(), *read);
    }
}

/// A binary STL is 50 bytes a triangle after 84 that end with the number of triangles; a stream has to be told.
bool is_binary_stl(const std::string& text) {
    uint32_t triangles = 0;
    if (text.size() < 84) return false;
    std::memcpy(&triangles, text.data() + 80, sizeof triangles);
    return text.size() == 84 + uint64_t{50} * triangles;
}

Result<SourceMesh> read_plain_mesh(const std::string& path, const std::string& extension) {
    auto text = whole_text(path);
    if (!text) return text.error();
    SourceMesh mesh;
    TriangleCollector collector(mesh);
    std::istringstream stream(*text, std::ios::binary);
    OpenMesh::IO::Options options;
    const bool binary_stl = extension == "stl" && is_binary_stl(*text);
    if (binary_stl) options += OpenMesh::IO::Options::Binary;
    if (!OpenMesh::IO::IOManager().read(stream, binary_stl ? "stlb" : extension, collector, options))
        return Error{path + ": cannot be read as " + extension};
    return mesh;
}

std::vector<std::string> models_below(const std::string& path) {
    if (!std::filesystem::is_directory(path)) return {path};
    std::vector<std::string> models;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
        const std::string name = entry.path().filename().string();
        const auto has = [&name](const char* part) { return name.find(part) != std::string::npos; };
        if (has(".xml") || has(".gml") || has(".json")) models.push_back(entry.path().string());
    }
    std::sort(models.begin(), models.end());
    return models;
}

/// Terrain has surfaces of this kind, too.
bool is_floor(const city::CityObject& object, const city::Triangle& triangle) {
    return object.kind == city::ObjectKind::kBuilding && triangle.surface == city::SurfaceKind::kGround;
}

city::CitySink collector_of(SourceMesh& mesh) {
    return [&mesh](city::CityObject&& object) {
        using Kind = city::ObjectKind;
        constexpr Kind kGroundKinds[] = {Kind::kTerrain, Kind::kLandUse, Kind::kRoad, Kind::kWater};
        mesh.has_ground |= std::ranges::find(kGroundKinds, object.kind) != std::end(kGroundKinds);
        const auto first = static_cast<uint32_t>(mesh.points.size());
        for (const auto& v : object.vertices) mesh.points.push_back({v.x, v.y, v.z});
        for (const auto& t : object.triangles) {
            if (is_floor(object, t)) continue;
            mesh.triangles.push_back({first + t.vertex[0], first + t.vertex[1], first + t.vertex[2]});
        }
        return true;
    };
}

Result<SourceMesh> read_city_mesh(const std::string& path) {
    SourceMesh mesh;
    city::CityHeader header;
    city::CityCatalog catalog;
    city::CityReport report;
    const Status status = city::read_city(models_below(path), {}, header, catalog, report, collector_of(mesh));
    if (!status) return status.error();
    mesh.buildings = report.buildings_emitted;
    return mesh;
}

std::string plain_extension(const std::string& path) {
    std::filesystem::path name(path);
    if (name.extension() == ".xz") name = name.stem();
    std::string extension = name.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return tolower(c); });
    const bool plain = extension == ".obj" || extension == ".ply" || extension == ".stl";
    return plain ? extension.substr(1) : "";
}

}  // namespace

SourceMesh generated_mesh(uint32_t buildings, uint64_t seed) {
    SourceMesh mesh;
    city::GeneratorOptions options;
    options.buildings = buildings;
    options.seed = seed;
    city::CityHeader header;
    city::CityCatalog catalog;
    city::CityReport report;
    city::generate_city(options, header, catalog, report, collector_of(mesh));
    mesh.buildings = report.buildings_emitted;
    return mesh;
}

Result<SourceMesh> read_mesh_file(const std::string& path) {
    const std::string extension = plain_extension(path);
    auto mesh = extension.empty() ? read_city_mesh(path) : read_plain_mesh(path, extension);
    if (mesh && mesh->triangles.empty()) return Error{path + ": has no triangle"};
    return mesh;
}

QuantisedMesh quantise(const SourceMesh& source, uint32_t bits) {
    std::array<double, 3> low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const auto& triangle : source.triangles) {
        for (const uint32_t v : triangle) {
            for (size_t c = 0; c < 3; ++c) {
                low[c] = std::min(low[c], source.points[v][c]);
                high[c] = std::max(high[c], source.points[v][c]);
            }
        }
    }
    QuantisedMesh result;
    const double side = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    result.step = side > 0 ? side / ((1 << bits) - 1) : 1;
    const auto place_of = [&](uint32_t v) {
        codec::mesh::GridPoint place{};
        double squared = 0;
        for (size_t c = 0; c < 3; ++c) {
            const double exact = (source.points[v][c] - low[c]) / result.step;
            place[c] = static_cast<int32_t>(std::lround(exact));
            squared += (exact - place[c]) * (exact - place[c]);
        }
        result.max_error = std::max(result.max_error, std::sqrt(squared) * result.step);
        return place;
    };
    std::map<codec::mesh::GridPoint, uint32_t> welded;
    const auto vertex_at = [&](const codec::mesh::GridPoint& place) {
        const auto [at, fresh] = welded.try_emplace(place, static_cast<uint32_t>(welded.size()));
        if (fresh) result.mesh.points.push_back(place);
        return at->second;
    };
    for (const auto& t : source.triangles) {
        const auto a = place_of(t[0]), b = place_of(t[1]), c = place_of(t[2]);
        if (a == b || b == c || c == a) continue;
        const uint32_t first = vertex_at(a), second = vertex_at(b);
        result.mesh.triangles.push_back({first, second, vertex_at(c)});
    }
    return result;
}

}  // namespace citystream::bench
