#include "tiles/layers/tile_surface.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace citystream::tiles::layers {
namespace {

using radiance::SurfaceTriangle;

static_assert(std::is_trivially_copyable_v<SurfaceTriangle>);

constexpr int64_t kLongest = int64_t{1} << 30;

bool is_measurable(const SurfaceTriangle& triangle) {
    quadtree::GridBox box;
    for (const GridPoint& corner : triangle.corners) box.add(corner);
    return box.hi.x - box.lo.x < kLongest && box.hi.y - box.lo.y < kLongest && box.hi.z - box.lo.z < kLongest;
}

void add(Surface& surface, const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    const SurfaceTriangle triangle{{a, b, c}};
    if (is_measurable(triangle)) surface.push_back(triangle);
}

}  // namespace

Surface surface_of(std::span<const quadtree::BuildObject> objects) {
    Surface surface;
    for (const quadtree::BuildObject& object : objects) {
        for (const quadtree::BuildTriangle& triangle : object.triangles) {
            const auto& [a, b, c] = triangle.vertex;
            add(surface, object.vertices[a], object.vertices[b], object.vertices[c]);
        }
        for (const quadtree::BuildFacade& facade : object.facades) {
            const auto corners = facade.corners();
            add(surface, corners[0], corners[1], corners[2]);
            add(surface, corners[0], corners[2], corners[3]);
        }
    }
    return surface;
}

quadtree::GridBox box_of(std::span<const SurfaceTriangle> surface) {
    quadtree::GridBox box;
    for (const SurfaceTriangle& triangle : surface) {
        for (const GridPoint& corner : triangle.corners) box.add(corner);
    }
    return box;
}

Result<quadtree::SpoolRange> append_surface(quadtree::SpoolFile& file, std::span<const SurfaceTriangle> surface) {
    return file.append(std::as_bytes(surface));
}

Result<Surface> read_surface(quadtree::SpoolFile& file, const quadtree::SpoolRange& range) {
    std::vector<std::byte> bytes;
    if (Status status = file.read(range, bytes); !status) return status.error();
    if (bytes.size() % sizeof(SurfaceTriangle) != 0) return Error{"temporary surface file is damaged"};
    Surface surface(bytes.size() / sizeof(SurfaceTriangle));
    if (!bytes.empty()) std::memcpy(surface.data(), bytes.data(), bytes.size());
    return surface;
}

}  // namespace citystream::tiles::layers
