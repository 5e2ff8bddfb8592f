#include "codec/mesh/octahedral.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace citystream::codec::mesh {

namespace {

constexpr int32_t kSide = 127;

int32_t sign_of(int32_t value) {
    return value < 0 ? -1 : 1;
}
double sign_of(double value) {
    return value < 0 ? -1.0 : 1.0;
}

uint32_t pack_lattice(int32_t u, int32_t v) {
    return static_cast<uint32_t>(u + kSide) | static_cast<uint32_t>(v + kSide) << 8;
}

/// Cosine between the direction that a code stands for and `n` (any length): only compared, so n need not be unit.
double closeness(uint32_t packed, const double n[3]) {
    int32_t d[3];
    unfold_octahedral16(packed, d);
    const double length = std::sqrt(static_cast<double>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    return (d[0] * n[0] + d[1] * n[1] + d[2] * n[2]) / length;
}

/// Scales to largest component 1, so that squares neither overflow nor vanish. False for zero and non-finite vectors.
bool scaled(const float normal[3], double out[3]) {
    double largest = 0;
    for (int i = 0; i < 3; ++i) {
        if (!std::isfinite(normal[i])) return false;
        largest = std::max(largest, std::abs(static_cast<double>(normal[i])));
    }
    if (largest == 0) return false;
    for (int i = 0; i < 3; ++i) out[i] = static_cast<double>(normal[i]) / largest;
    return true;
}

}  // namespace

uint32_t pack_octahedral16(const float normal[3]) {
    double n[3];
    if (!scaled(normal, n)) return pack_lattice(0, 0);
    const double l1 = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
    double u = n[0] / l1;
    double v = n[1] / l1;
    if (n[2] < 0) {
        const double folded = sign_of(u) * (1 - std::abs(v));
        v = sign_of(v) * (1 - std::abs(u));
        u = folded;
    }
    const auto low_u = static_cast<int32_t>(std::floor(u * kSide));
    const auto low_v = static_cast<int32_t>(std::floor(v * kSide));
    uint32_t best = 0;
    double best_closeness = -2;
    for (int corner = 0; corner < 4; ++corner) {
        const uint32_t candidate = pack_lattice(std::clamp(low_u + (corner & 1), -kSide, kSide),
                                                std::clamp(low_v + (corner >> 1), -kSide, kSide));
        const double candidate_closeness = closeness(candidate, n);
        if (candidate_closeness > best_closeness) {
            best = candidate;
            best_closeness = candidate_closeness;
        }
    }
    return best;
}

void unfold_octahedral16(uint32_t packed, int32_t out[3]) {
    const int32_t u = std::min(static_cast<int32_t>(packed & 255u) - kSide, kSide);
    const int32_t v = std::min(static_cast<int32_t>((packed >> 8) & 255u) - kSide, kSide);
    const int32_t z = kSide - std::abs(u) - std::abs(v);
    out[0] = z < 0 ? sign_of(u) * (kSide - std::abs(v)) : u;
    out[1] = z < 0 ? sign_of(v) * (kSide - std::abs(u)) : v;
    out[2] = z;
}

void unpack_octahedral16(uint32_t packed, float out[3]) {
    int32_t d[3];
    unfold_octahedral16(packed, d);
    const float length = std::sqrt(static_cast<float>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(d[i]) / length;
}

}  // namespace citystream::codec::mesh
