#include "codec/mesh/corner_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"

namespace citystream::codec::mesh {
namespace {

struct NormalMesh {
    GridMesh mesh;
    std::vector<uint64_t> codes;  ///< 3 a triangle
};

int32_t grid(double metres) {
    return static_cast<int32_t>(std::lround(metres * 1024));
}

/// A sphere with the normals that it has, or with those of its triangles' planes.
NormalMesh sphere(uint32_t bits, bool flat) {
    constexpr uint32_t kRings = 40, kSectors = 80;
    NormalMesh result;
    std::vector<Direction> directions;
    for (uint32_t ring = 0; ring <= kRings; ++ring) {
        for (uint32_t sector = 0; sector < kSectors; ++sector) {
            const double polar = std::numbers::pi * ring / kRings, longitude = 2 * std::numbers::pi * sector / kSectors;
            const Direction n = {std::sin(polar) * std::cos(longitude), std::sin(polar) * std::sin(longitude),
                                 std::cos(polar)};
            directions.push_back(n);
            result.mesh.points.push_back({grid(30 * n[0]), grid(30 * n[1]), grid(30 * n[2])});
        }
    }
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        result.mesh.triangles.push_back({a, b, c});
        Direction plane = {0, 0, 0};
        for (const uint32_t v : {a, b, c}) {
            for (size_t i = 0; i < 3; ++i) plane[i] += directions[v][i];
        }
        for (const uint32_t v : {a, b, c}) result.codes.push_back(pack_octahedral(flat ? plane : directions[v], bits));
    };
    for (uint32_t ring = 0; ring < kRings; ++ring) {
        for (uint32_t sector = 0; sector < kSectors; ++sector) {
            const uint32_t a = ring * kSectors + sector, b = ring * kSectors + (sector + 1) % kSectors;
            add(a, a + kSectors, b + kSectors);
            add(a, b + kSectors, b);
        }
    }
    return result;
}

/// Boxes, each corner with the normal of its face.
NormalMesh boxes(uint32_t bits, uint32_t count) {
    NormalMesh result;
    std::mt19937 random(4);
    for (uint32_t i = 0; i < count; ++i) {
        const auto base = static_cast<uint32_t>(result.mesh.points.size());
        const std::array<int32_t, 3> low = {static_cast<int32_t>(random() % 100000),
                                            static_cast<int32_t>(random() % 100000), 0};
        const int32_t size = 1000 + static_cast<int32_t>(random() % 20000);
        for (uint32_t v = 0; v < 8; ++v) {
            const auto along = [&](uint32_t axis) { return low[axis] + ((v >> axis & 1) != 0 ? size : 0); };
            result.mesh.points.push_back({along(0), along(1), along(2)});
        }
        for (uint32_t axis = 0; axis < 3; ++axis) {
            const uint32_t u = 1U << (axis + 1) % 3, v = 1U << (axis + 2) % 3;
            for (const uint32_t side : {0U, 1U}) {
                const uint32_t at = base + (side << axis);
                Direction normal = {0, 0, 0};
                normal[axis] = side != 0 ? 1 : -1;
                const uint32_t second = side != 0 ? u : v, third = side != 0 ? v : u;
                result.mesh.triangles.push_back({at, at + second, at + u + v});
                result.mesh.triangles.push_back({at, at + u + v, at + third});
                result.codes.insert(result.codes.end(), 6, pack_octahedral(normal, bits));
            }
        }
    }
    return result;
}

/// Any triangles, degenerate ones and unused points among them, and any codes.
NormalMesh noise(std::mt19937_64& random, uint32_t triangles) {
    NormalMesh result;
    for (uint32_t i = 0; i < triangles + 3; ++i) {
        const auto place = [&] { return static_cast<int32_t>(random() % (1U << 31)) - (1 << 30); };
        result.mesh.points.push_back({place(), place(), place()});
    }
    for (uint32_t i = 0; i < triangles; ++i) {
        const auto vertex = [&] { return static_cast<uint32_t>(random() % (triangles / 2 + 1)); };
        result.mesh.triangles.push_back({vertex(), vertex(), vertex()});
        for (int c = 0; c < 3; ++c) result.codes.push_back(random());
    }
    return result;
}

std::vector<uint64_t> canonical(std::vector<uint64_t> codes, uint32_t bits) {
    for (uint64_t& code : codes) code = canonical_octahedral(code, bits);
    return codes;
}

/// Bytes that the normals take, having come back.
size_t round_trip(const NormalMesh& normals, uint32_t bits) {
    const std::vector<std::byte> bytes = encode_corner_normals(normals.mesh, normals.codes, bits);
    const auto back = decode_corner_normals(normals.mesh, bits, bytes);
    EXPECT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(*back, canonical(normals.codes, bits));
    return bytes.size();
}

double bits_a_triangle(const NormalMesh& normals, size_t bytes) {
    return 8.0 * static_cast<double>(bytes) / static_cast<double>(normals.mesh.triangles.size());
}

TEST(CornerNormals, OfFlatFacesCostNextToNothing) {
    for (const uint32_t bits : {8U, 12U, 16U}) {
        const NormalMesh city = boxes(bits, 500);
        EXPECT_LT(bits_a_triangle(city, round_trip(city, bits)), 0.02) << bits;
    }
}

TEST(CornerNormals, OfSmoothSurfacesCostLessThanHalfABitATriangle) {
    const NormalMesh smooth = sphere(8, false);
    EXPECT_LT(bits_a_triangle(smooth, round_trip(smooth, 8)), 0.4);
    round_trip(sphere(8, true), 8);
    round_trip(sphere(24, false), 24);
}

TEST(CornerNormals, OfAnyTrianglesAndCodesComeBack) {
    std::mt19937_64 random(9);
    for (const uint32_t bits : {2U, 3U, 8U, 16U, kMostCornerNormalBits}) {
        for (const uint32_t triangles : {0U, 1U, 2U, 300U}) round_trip(noise(random, triangles), bits);
    }
}

TEST(CornerNormals, OfAFanOfAThousandDifferentNormalsComeBack) {
    std::mt19937_64 random(2);
    NormalMesh fan;
    fan.mesh.points.push_back({0, 0, 0});
    for (uint32_t i = 0; i < 1000; ++i) {
        fan.mesh.points.push_back({static_cast<int32_t>(i), 1000, static_cast<int32_t>(i * i)});
        if (i == 0) continue;
        fan.mesh.triangles.push_back({0, i, i + 1});
        for (int c = 0; c < 3; ++c) fan.codes.push_back(random());
    }
    round_trip(fan, 12);
}

TEST(CornerNormals, SameInputSameBytes) {
    const NormalMesh smooth = sphere(12, false);
    EXPECT_EQ(encode_corner_normals(smooth.mesh, smooth.codes, 12),
              encode_corner_normals(smooth.mesh, smooth.codes, 12));
}

TEST(CornerNormals, TruncatedAndDamagedBytesAreErrorsOrCodes) {
    const NormalMesh city = boxes(8, 3);
    NormalMesh mixed = city;
    std::mt19937_64 random(6);
    for (size_t i = 0; i < mixed.codes.size(); i += 5) mixed.codes[i] = random() & 0xffff;
    const std::vector<std::byte> bytes = encode_corner_normals(mixed.mesh, mixed.codes, 8);
    const auto expect_codes = [&](std::span<const std::byte> damaged) {
        const auto back = decode_corner_normals(mixed.mesh, 8, damaged);
        if (!back) return;
        ASSERT_EQ(back->size(), mixed.codes.size());
        ASSERT_EQ(*back, canonical(*back, 8));
    };
    for (size_t length = 0; length < bytes.size(); ++length) expect_codes(std::span(bytes).first(length));
    for (int i = 0; i < 10000; ++i) {
        std::vector<std::byte> damaged = bytes;
        for (uint64_t k = random() % 4 + 1; k > 0; --k)
            damaged[random() % damaged.size()] = static_cast<std::byte>(random());
        if (i % 3 == 0) damaged.resize(random() % (damaged.size() + 8));
        expect_codes(damaged);
    }
    std::vector<std::byte> longer = bytes;
    longer.resize(bytes.size() + 20);
    EXPECT_FALSE(decode_corner_normals(mixed.mesh, 8, longer).ok());
}

}  // namespace
}  // namespace citystream::codec::mesh
