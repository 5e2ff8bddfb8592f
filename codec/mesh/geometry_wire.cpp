#include "codec/mesh/geometry_wire.h"

#include <cassert>
#include <string>
#include <utility>

#include "codec/bits/range_coder.h"
#include "codec/mesh/geometry_header.h"
#include "codec/mesh/point_refinement.h"
#include "codec/mesh/prism_code.h"
#include "codec/mesh/prism_planes.h"
#include "codec/mesh/prisms.h"
#include "codec/mesh/surface_walk.h"

namespace citystream::codec::mesh {

namespace {

Error damaged(const bits::RangeDecoder& decoder, const char* what) {
    return {std::string("mesh geometry: ") + what, decoder.position()};
}

Status read_piece(bits::RangeDecoder& decoder, SurfaceWalk& walk) {
    if (!walk.code_start(decoder)) return damaged(decoder, "the first triangle of a piece is none");
    for (uint32_t gate = walk.gate(); gate != MeshBorder::kNone; gate = walk.gate()) {
        if (!walk.code_gate(decoder, gate)) return damaged(decoder, "there is no such triangle, or too many");
        if (!decoder.ok()) return damaged(decoder, "ends too early");
    }
    return Done{};
}

Status read_surface(bits::RangeDecoder& decoder, SurfaceWalk& walk) {
    while (walk.code_more(decoder)) {
        Status piece = read_piece(decoder, walk);
        if (!piece) return piece;
    }
    while (walk.code_more(decoder)) {
        if (!walk.code_flat(decoder) || !decoder.ok())
            return damaged(decoder, "a flat triangle is none, or ends early");
    }
    return decoder.finish();
}

Status read_refinement(std::span<const std::byte> bytes, uint32_t bits, const SurfaceWalk& walk,
                       std::vector<GridPoint>& points, std::vector<Prism>& prisms) {
    bits::RangeDecoder decoder(bytes);
    if (!prisms.empty()) {
        Status planes = decode_prism_planes(decoder, prisms, bits);
        if (!planes) return planes;
    }
    PointRefinement refinement(bits);
    for (uint32_t i = 0; i < points.size() && decoder.ok(); ++i) refinement.code(decoder, points, i, walk.origins()[i]);
    return decoder.finish();
}

/// Prisms within the limits; what they take is taken off.
Result<std::vector<Prism>> read_prisms(bits::RangeDecoder& decoder, GeometryLimits& limits) {
    auto prisms = decode_prisms(decoder, {limits.points});
    if (!prisms) return prisms;
    uint64_t points = 0, triangles = 0;
    for (const Prism& prism : *prisms) {
        points += 2 * prism.walls.size();
        triangles += 2 * prism.walls.size() + prism.top_triangles.size() + prism.floor_triangles.size();
    }
    if (points > limits.points || triangles > limits.triangles)
        return damaged(decoder, "more prisms than there is room for");
    limits.points -= static_cast<uint32_t>(points);
    limits.triangles -= static_cast<uint32_t>(triangles);
    return prisms;
}

/// Puts the bits that are missing back as 0.
void spread(Prism& prism, uint32_t dropped) {
    const auto spread_one = [dropped](int32_t& value) { value = static_cast<int32_t>(int64_t{value} << dropped); };
    spread_one(prism.base);
    spread_one(prism.top);
    for (PrismWall& wall : prism.walls) spread_one(wall.base);
    for (Ring& ring : prism.rings) {
        for (auto& point : ring.points) {
            for (int32_t& coordinate : point) spread_one(coordinate);
        }
    }
}

}  // namespace

Result<GridMesh> decode_geometry(std::span<const std::span<const std::byte>> steps, const GeometryLimits& limits) {
    assert(!steps.empty());
    bits::RangeDecoder decoder(steps[0]);
    GeometryHeader header;
    if (!code_header(decoder, header) || !decoder.ok()) return damaged(decoder, "no header of a known version");
    if (steps.size() > header.steps) return Error{"mesh geometry: more steps than the first one announces"};
    GeometryLimits left = limits;
    std::vector<Prism> prisms;
    if (header.has_prisms) {
        auto read = read_prisms(decoder, left);
        if (!read) return read.error();
        prisms = std::move(*read);
    }
    SurfaceWalk walk(header.frame(left));
    const Status read = read_surface(decoder, walk);
    if (!read) return read.error();
    GridMesh mesh{walk.points(), walk.triangles()};
    for (size_t s = 1; s < steps.size(); ++s) {
        const uint32_t bits = header.dropped[s - 1] - header.dropped[s];
        const Status refined = read_refinement(steps[s], bits, walk, mesh.points, prisms);
        if (!refined) return refined.error();
    }
    const uint32_t dropped = header.dropped[steps.size() - 1], coarser = header.dropped[0] - dropped;
    for (GridPoint& point : mesh.points) {
        for (size_t k = 0; k < 3; ++k) {
            const int64_t value = int64_t{point[k]} + (int64_t{header.low[k]} << coarser);
            point[k] = static_cast<int32_t>(value << dropped);
        }
    }
    if (prisms.empty()) return mesh;
    for (Prism& prism : prisms) spread(prism, dropped);
    return join({std::move(prisms), std::move(mesh)});
}

}  // namespace citystream::codec::mesh
