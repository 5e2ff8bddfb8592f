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
#include "codec/mesh/surface_reader.h"

namespace citystream::codec::mesh {

namespace {

Error damaged(const bits::RangeDecoder& decoder, const char* what) {
    return {std::string("mesh geometry: ") + what, decoder.position()};
}

Status read_refinement(std::span<const std::byte> bytes, uint32_t bits, const SurfaceWalk& walk,
                       std::vector<GridPoint>& points, std::vector<Prism>& prisms) {
    bits::RangeDecoder decoder(bytes);
    if (!prisms.empty()) {
        Status planes = decode_prism_planes(decoder, prisms, bits);
        if (!planes) return planes;
    }
    PointRefinement refinement(bits);
    make_room(points, bits);
    for (uint32_t i = 0; i < points.size() && decoder.ok(); ++i) refinement.code(decoder, points, i, walk.origins()[i]);
    return decoder.finish();
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
        auto read = decode_prisms_within(decoder, left.points, left.triangles);
        if (!read) return read.error();
        prisms = std::move(*read);
    }
    SurfaceWalk walk(header.box.frame(left.points, left.triangles));
    const Status read = read_surface(decoder, walk);
    if (!read) return read.error();
    const Status finished = decoder.finish();
    if (!finished) return finished.error();
    GridMesh mesh{walk.points(), walk.triangles()};
    for (size_t s = 1; s < steps.size(); ++s) {
        const uint32_t bits = header.dropped[s - 1] - header.dropped[s];
        const Status refined = read_refinement(steps[s], bits, walk, mesh.points, prisms);
        if (!refined) return refined.error();
    }
    const uint32_t dropped = header.dropped[steps.size() - 1], coarser = header.dropped[0] - dropped;
    for (GridPoint& point : mesh.points) {
        for (size_t k = 0; k < 3; ++k) {
            const int64_t value = int64_t{point[k]} + (int64_t{header.box.low[k]} << coarser);
            point[k] = static_cast<int32_t>(value << dropped);
        }
    }
    if (prisms.empty()) return mesh;
    for (Prism& prism : prisms) prism = with_low_bits(std::move(prism), dropped);
    return join({std::move(prisms), std::move(mesh)});
}

}  // namespace citystream::codec::mesh
