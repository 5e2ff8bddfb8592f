#include "tiles/city/vertex_welder.h"

#include <algorithm>
#include <bit>

namespace citystream::tiles::city {
namespace {

constexpr size_t kFirstSize = 64;

size_t hash_of(const Vec3& p) {
    constexpr uint64_t kA = 0x9E3779B97F4A7C15u, kB = 0xC2B2AE3D27D4EB4Fu, kC = 0x165667B19E3779F9u;
    uint64_t h = std::bit_cast<uint64_t>(p.x) * kA;
    h = std::rotl(h, 31) ^ (std::bit_cast<uint64_t>(p.y) * kB);
    h = std::rotl(h, 29) ^ (std::bit_cast<uint64_t>(p.z) * kC);
    h = (h ^ (h >> 32)) * kA;
    return static_cast<size_t>(h ^ (h >> 29));
}

bool same(const Vec3& a, const Vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

}  // namespace

void VertexWelder::clear() {
    constexpr size_t kKeptSize = 4096;
    if (slots_.size() > kKeptSize) slots_.resize(kKeptSize);
    std::fill(slots_.begin(), slots_.end(), 0u);
    used_ = 0;
}

void VertexWelder::grow(const std::vector<Vec3>& vertices) {
    const size_t size = std::max(kFirstSize, slots_.size() * 2);
    slots_.assign(size, 0u);
    for (uint32_t i = 0; i < vertices.size(); ++i) {
        size_t slot = hash_of(vertices[i]) & (size - 1);
        while (slots_[slot] != 0) slot = (slot + 1) & (size - 1);
        slots_[slot] = i + 1;
    }
}

uint32_t VertexWelder::index_of(std::vector<Vec3>& vertices, const Vec3& position) {
    if (2 * (used_ + 1) > slots_.size()) grow(vertices);
    const Vec3 p = {position.x + 0.0, position.y + 0.0, position.z + 0.0};  // -0 becomes 0
    size_t slot = hash_of(p) & (slots_.size() - 1);
    while (slots_[slot] != 0) {
        if (same(vertices[slots_[slot] - 1], p)) return slots_[slot] - 1;
        slot = (slot + 1) & (slots_.size() - 1);
    }
    vertices.push_back(p);
    slots_[slot] = static_cast<uint32_t>(vertices.size());
    ++used_;
    return static_cast<uint32_t>(vertices.size() - 1);
}

}  // namespace citystream::tiles::city
