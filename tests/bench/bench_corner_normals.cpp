// Claim: normals of corners, coded apart from points that are welded by position, against Draco and meshoptimizer.
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>

#include "codec/bits/zstd_frame.h"
#include "codec/mesh/corner_normals.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/mesh_files.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::mesh;

constexpr const char* kClaim =
    "Normals of a mesh's corners as a modelling tool writes them: of each corner those of the triangles round its "
    "point whose planes\n"
    "turn from its own by no more than the crease angle, weighted by angle; 0 degrees: flat faces. turned_degrees: "
    "normals that do not\n"
    "follow from the triangles, each point's turned by as much on average. Octahedral codes of 8 + 8 and 10 + 10 bits; "
    "positions of 16.\n"
    "bits_a_triangle: of the normals alone, in our code, in Draco (-cl 10: the mesh with "
    "normals less the\n"
    "mesh without, so the points that normals split count too) and in meshoptimizer's vertex codec + zstd -19 (of one "
    "normal for each\n"
    "different pair of point and normal). FILEs are meshes (OBJ, PLY, STL) or city models.";

/// The longest side in 2^16 steps; normals are made from positions of 2^20.
constexpr uint32_t kFineBits = 20, kDropped = 4, kPositionBits = kFineBits - kDropped;

double in_radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

Direction difference(const GridPoint& to, const GridPoint& from) {
    return {static_cast<double>(to[0] - from[0]), static_cast<double>(to[1] - from[1]),
            static_cast<double>(to[2] - from[2])};
}

Direction plane_of(const GridMesh& mesh, size_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const Direction e = difference(mesh.points[b], mesh.points[a]), f = difference(mesh.points[c], mesh.points[a]);
    return unit_direction({e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]});
}

double corner_angle(const GridMesh& mesh, size_t triangle, size_t corner) {
    const auto& vertices = mesh.triangles[triangle];
    const GridPoint& at = mesh.points[vertices[corner]];
    return angle_between(difference(mesh.points[vertices[(corner + 1) % 3]], at),
                         difference(mesh.points[vertices[(corner + 2) % 3]], at));
}

struct Style {
    double crease_degrees = 0, turned_degrees = 0;
};

/// One vector a point, as long as its normals are turned in radians.
std::vector<Direction> turns_of(const GridMesh& mesh, double degrees) {
    std::mt19937_64 random(1);
    // The two parts across the normal are as long as the turn; their mean length is 1.25 deviations.
    std::normal_distribution<double> gauss(0, in_radians(degrees) / 1.25);
    std::vector<Direction> turns;
    for (size_t i = 0; i < mesh.points.size(); ++i) {
        turns.push_back({0, 0, 0});
        if (degrees == 0) continue;
        for (double& c : turns.back()) c = gauss(random);
    }
    return turns;
}

/// One code a corner.
std::vector<uint64_t> normals_of(const GridMesh& mesh, const Style& style, uint32_t bits) {
    const std::vector<Direction> turns = turns_of(mesh, style.turned_degrees);
    std::vector<Direction> planes;
    std::vector<std::vector<uint32_t>> corners_of(mesh.points.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        planes.push_back(plane_of(mesh, t));
        for (uint32_t c = 0; c < 3; ++c) corners_of[mesh.triangles[t][c]].push_back(3 * t + c);
    }
    const double least_cosine = std::cos(in_radians(style.crease_degrees)) - 1e-9;
    std::vector<uint64_t> codes;
    for (uint32_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner) {
        const Direction& own = planes[corner / 3];
        Direction sum = {0, 0, 0};
        const uint32_t point = mesh.triangles[corner / 3][corner % 3];
        for (const uint32_t other : corners_of[point]) {
            const Direction& plane = planes[other / 3];
            if (plane[0] * own[0] + plane[1] * own[1] + plane[2] * own[2] < least_cosine) continue;
            const double angle = corner_angle(mesh, other / 3, other % 3);
            for (size_t c = 0; c < 3; ++c) sum[c] += angle * plane[c];
        }
        Direction normal = unit_direction(style.crease_degrees == 0 ? own : sum);
        for (size_t c = 0; c < 3; ++c) normal[c] += turns[point][c];
        codes.push_back(canonical_octahedral(pack_octahedral(normal, bits), bits));
    }
    return codes;
}

uint64_t draco_bytes(const GridMesh& mesh, const std::vector<uint64_t>* codes, uint32_t bits) {
    const auto corners = static_cast<uint32_t>(3 * mesh.triangles.size());
    draco::Mesh out;
    out.set_num_points(corners);
    out.SetNumFaces(mesh.triangles.size());
    for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
        out.SetFace(draco::FaceIndex(f),
                    {draco::PointIndex(3 * f), draco::PointIndex(3 * f + 1), draco::PointIndex(3 * f + 2)});
    }
    const auto add = [&](draco::GeometryAttribute::Type type, const auto& value_of) {
        draco::GeometryAttribute attribute;
        attribute.Init(type, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float), 0);
        const int id = out.AddAttribute(attribute, true, corners);
        for (uint32_t i = 0; i < corners; ++i) {
            const std::array<float, 3> value = value_of(i);
            out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), value.data());
        }
    };
    add(draco::GeometryAttribute::POSITION, [&](uint32_t i) {
        const GridPoint& p = mesh.points[mesh.triangles[i / 3][i % 3]];
        return std::array{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    });
    if (codes != nullptr) {
        add(draco::GeometryAttribute::NORMAL, [&](uint32_t i) { return unpack_octahedral_float((*codes)[i], bits); });
    }
    out.DeduplicateAttributeValues();
    out.DeduplicatePointIds();
    draco::ExpertEncoder encoder(out);
    encoder.SetSpeedOptions(0, 0);
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    const std::array<float, 3> zero = {};
    encoder.SetAttributeExplicitQuantization(0, kPositionBits, 3, zero.data(), (1U << kPositionBits) - 1);
    if (codes != nullptr) encoder.SetAttributeQuantization(1, static_cast<int>(bits));
    draco::EncoderBuffer buffer;
    return encoder.EncodeToBuffer(&buffer).ok() ? buffer.size() : 0;
}

uint64_t meshoptimizer_bytes(const GridMesh& mesh, const std::vector<uint64_t>& codes, uint32_t bits) {
    std::map<std::pair<uint32_t, uint64_t>, bool> met;
    std::vector<std::array<uint16_t, 2>> vertices;
    for (size_t i = 0; i < codes.size(); ++i) {
        if (!met.insert({{mesh.triangles[i / 3][i % 3], codes[i]}, true}).second) continue;
        const uint64_t mask = (1U << bits) - 1;
        vertices.push_back({static_cast<uint16_t>(codes[i] & mask), static_cast<uint16_t>(codes[i] >> bits & mask)});
    }
    std::vector<unsigned char> coded(meshopt_encodeVertexBufferBound(vertices.size(), sizeof vertices[0]));
    coded.resize(
        meshopt_encodeVertexBuffer(coded.data(), coded.size(), vertices.data(), vertices.size(), sizeof vertices[0]));
    return codec::bits::compress_frame(std::as_bytes(std::span(coded))).size();
}

void measure(const std::string& name, const GridMesh& fine, BenchProgram& program) {
    GridMesh mesh = fine;
    for (GridPoint& point : mesh.points) {
        for (int32_t& c : point) c >>= kDropped;
    }
    const auto triangles = static_cast<double>(mesh.triangles.size());
    const auto a_triangle = [&](uint64_t bytes) { return rounded(8 * static_cast<double>(bytes) / triangles); };
    const uint64_t draco_without = draco_bytes(mesh, nullptr, 0);
    for (const Style& style : {Style{0, 0}, Style{30, 0}, Style{180, 0}, Style{180, 2}}) {
        for (const uint32_t bits : {8U, 10U}) {
            const std::vector<uint64_t> codes = normals_of(fine, style, bits);
            const std::vector<std::byte> ours = encode_corner_normals(mesh, codes, bits);
            const auto back = decode_corner_normals(mesh, bits, ours);
            program.check(back.ok() && *back == codes, name + ": normals come back");
            const uint64_t draco = draco_bytes(mesh, &codes, bits) - draco_without;
            const uint64_t meshoptimizer = meshoptimizer_bytes(mesh, codes, bits);
            program.print({{"file", name},
                           {"triangles", mesh.triangles.size()},
                           {"crease_degrees", style.crease_degrees},
                           {"turned_degrees", style.turned_degrees},
                           {"bits", 2 * bits},
                           {"bytes", ours.size()},
                           {"bits_a_triangle", a_triangle(ours.size())},
                           {"draco_bits_a_triangle", a_triangle(draco)},
                           {"meshoptimizer_bits_a_triangle", a_triangle(meshoptimizer)}});
        }
    }
}

std::vector<std::string> shared_meshes() {
    std::vector<std::string> files;
    std::error_code error;
    for (const auto& entry :
         std::filesystem::directory_iterator(CITYSTREAM_SOURCE_DIR "/../shared/data/meshes", error)) {
        if (entry.path().extension() == ".xz") files.push_back(entry.path().string());
    }
    std::ranges::sort(files);
    return files;
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_corner_normals", kClaim, "mesh.obj", false});
    BenchOptions options;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    if (options.files.empty()) options.files = shared_meshes();
    if (options.files.empty()) program.print_skipped("../shared/data/meshes is not there");
    for (const std::string& file : options.files) {
        const Result<SourceMesh> source = read_mesh_file(file);
        if (!program.check(source.ok(), file + " is read")) continue;
        measure(std::filesystem::path(file).filename().string(), quantise(*source, kFineBits).mesh, program);
    }
    return program.exit_code();
}
