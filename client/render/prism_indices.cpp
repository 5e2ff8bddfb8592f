#include "client/render/prism_indices.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace citystream::client {

namespace {

constexpr uint32_t kWallCorners = 4;
constexpr std::array<uint32_t, 6> kWall = {0, 1, 2, 0, 2, 3};

}  // namespace

std::vector<uint32_t> prism_indices(uint32_t points, uint32_t triangles, uint32_t count) {
    std::vector<uint32_t> indices;
    indices.reserve(size_t{3} * triangles * count);
    uint32_t first = 0;
    for (uint32_t prism = 0; prism < count; ++prism) {
        for (uint32_t wall = 0; wall < points; ++wall, first += kWallCorners)
            for (const uint32_t corner : kWall) indices.push_back(first + corner);
        for (uint32_t corner = 0; corner < 3 * (triangles - 2 * points); ++corner) indices.push_back(first++);
    }
    return indices;
}

PrismIndices::~PrismIndices() {
    for (auto& [size, made] : made_) destroy_buffer(device_, made.buffer);
}

const PrismIndices::Made& PrismIndices::made_for(const MeshDrawConstants& draw, uint32_t most) {
    Made& made = made_[{draw.points, draw.triangles}];
    if (made.prisms != 0) return made;
    const uint32_t prisms = std::max(most / (3 * draw.triangles), 1u);
    const std::vector<uint32_t> indices = prism_indices(draw.points, draw.triangles, prisms);
    made.buffer = create_buffer(device_, sizeof indices[0] * indices.size(), BufferPlace::kUpload);
    made.prisms = prisms;
    std::memcpy(made.buffer.mapped, indices.data(), sizeof indices[0] * indices.size());
    bytes_ += made.buffer.bytes;
    return made;
}

uint32_t PrismIndices::record(VkCommandBuffer commands, const MeshDrawConstants& draw, uint32_t triangles,
                              uint32_t most) {
    if (draw.triangles == 0) return 0;
    const uint32_t prisms = triangles / draw.triangles;
    const Made& made = made_for(draw, most);
    vkCmdBindIndexBuffer(commands, made.buffer.handle, 0, VK_INDEX_TYPE_UINT32);
    uint32_t draws = 0;
    for (uint32_t first = 0; first < prisms; first += made.prisms, ++draws) {
        const uint32_t count = std::min(made.prisms, prisms - first);
        vkCmdDrawIndexed(commands, 3 * draw.triangles * count, 1, 0, static_cast<int32_t>(first * draw.vertices), 0);
    }
    return draws;
}

}  // namespace citystream::client
