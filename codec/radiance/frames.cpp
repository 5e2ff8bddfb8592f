#include "codec/radiance/frames.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "codec/mesh/octahedral.h"
#include "codec/radiance/series_angle.h"
#include "codec/vector.h"

namespace citystream::codec::radiance {

namespace {

Vector combined(const Vector& a, double of_a, const Vector& b, double of_b) {
    return {a[0] * of_a + b[0] * of_b, a[1] * of_a + b[1] * of_b, a[2] * of_a + b[2] * of_b};
}

Vector normalised(const Vector& v) {
    const double length = std::sqrt(dot(v, v));
    return {v[0] / length, v[1] / length, v[2] / length};
}

constexpr uint32_t kNormalCodeBits = 2 * kFrameNormalBits, kTurnMask = kFrameTurns - 1, kMirrorBit = 31;

Vector normal_of(uint32_t code) {
    const auto n = mesh::unfold_octahedral(code & ((1u << kNormalCodeBits) - 1), kFrameNormalBits);
    return normalised({static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])});
}

/// The tangent of turn 0.
Vector level_tangent(const Vector& normal) {
    if (normal[0] == 0 && normal[1] == 0) return {1, 0, 0};
    return normalised({-normal[1], normal[0], 0});
}

GridDirection rounded(const Vector& v) {
    GridDirection grid{};
    for (size_t i = 0; i < 3; ++i) grid[i] = static_cast<int32_t>(std::floor(v[i] * kFrameOne + 0.5));
    return grid;
}

}  // namespace

std::array<int64_t, 3> Frame::to_local(const GridDirection& world) const {
    std::array<int64_t, 3> local{};
    for (size_t i = 0; i < 3; ++i) {
        for (size_t k = 0; k < 3; ++k) local[i] += int64_t{axes[i][k]} * world[k];
    }
    return local;
}

bool Frame::sees(const GridDirection& world) const {
    return to_local(world)[2] > 0;
}

uint32_t pack_frame(const Vector& normal) {
    return static_cast<uint32_t>(mesh::pack_octahedral({normal[0], normal[1], normal[2]}, kFrameNormalBits));
}

uint32_t pack_frame(const Vector& normal, const Vector& tangent, bool mirrored) {
    const uint32_t code = pack_frame(normal);
    const Vector n = normal_of(code), x = level_tangent(n), y = cross(n, x);
    const double along = dot(tangent, x), across = dot(tangent, y);
    uint32_t turn = 0;
    if (std::isfinite(along) && std::isfinite(across) && along * along + across * across > 1e-12) {
        const double turns = std::atan2(across, along) / (2 * kPi) * kFrameTurns;
        turn = static_cast<uint32_t>(static_cast<int32_t>(std::floor(turns + 0.5))) & kTurnMask;
    }
    return code | turn << kNormalCodeBits | (mirrored ? 1u << kMirrorBit : 0);
}

Frame unpack_frame(uint32_t code) {
    const Vector z = normal_of(code), level = level_tangent(z);
    const AngleParts turn = angle_parts((code >> kNormalCodeBits & kTurnMask) * (2 * kPi / kFrameTurns));
    const Vector x = combined(level, turn.cosine, cross(z, level), turn.sine);
    const Vector y = combined(cross(z, x), code >> kMirrorBit != 0 ? -1 : 1, x, 0);
    return {{rounded(x), rounded(y), rounded(z)}};
}

double yaw_angle(uint32_t bucket) {
    return bucket % kYawBuckets * (kPi / 2 / kYawBuckets);
}

uint32_t common_yaw(std::span<const std::array<double, 2>> edges) {
    std::vector<double> length(kYawBuckets, 0);
    for (const auto& [x, y] : edges) {
        const double edge_length = std::sqrt(x * x + y * y);
        if (!std::isfinite(edge_length) || edge_length == 0) continue;
        const double buckets = std::atan2(y, x) / (kPi / 2 / kYawBuckets);
        length[static_cast<uint32_t>(static_cast<int32_t>(std::floor(buckets + 0.5))) % kYawBuckets] += edge_length;
    }
    return static_cast<uint32_t>(std::max_element(length.begin(), length.end()) - length.begin());
}

Vector turned(const Vector& direction, double angle) {
    const AngleParts turn = angle_parts(angle);
    return {direction[0] * turn.cosine - direction[1] * turn.sine,
            direction[0] * turn.sine + direction[1] * turn.cosine, direction[2]};
}

}  // namespace citystream::codec::radiance
