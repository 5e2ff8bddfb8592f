#include <algorithm>
#include <cassert>

#include "codec/bits/range_coder.h"
#include "codec/mesh/geometry_header.h"
#include "codec/mesh/geometry_wire.h"
#include "codec/mesh/point_refinement.h"
#include "codec/mesh/prism_code.h"
#include "codec/mesh/prism_planes.h"
#include "codec/mesh/prisms.h"
#include "codec/mesh/surface_writer.h"

namespace citystream::codec::mesh {

namespace {

void refine(GeometrySteps& steps, std::span<const uint32_t> dropped, const SurfaceWriter& writer,
            const WeldedSurface& mesh, const std::vector<Prism>& prisms, std::span<const HiddenLattice> lattices) {
    std::vector<GridPoint> points = writer.walk().points();
    for (size_t s = 1; s < dropped.size(); ++s) {
        bits::RangeEncoder coder;
        const uint32_t bits = dropped[s - 1] - dropped[s];
        if (!prisms.empty()) encode_prism_planes(coder, prisms, lattices, bits, dropped[s]);
        PointRefinement refinement(bits);
        make_room(points, bits);
        for (uint32_t i = 0; i < points.size(); ++i) {
            GridPoint place = mesh.points[writer.points()[i]];
            for (int32_t& coordinate : place) coordinate >>= dropped[s];
            refinement.code(coder, points, i, writer.walk().origins()[i], place);
        }
        steps.position_bits += coder.cost();
        steps.steps.push_back(coder.finish());
    }
}

GeometrySteps encode_parts(const GridMesh& mesh, const std::vector<Prism>& prisms, std::span<const uint32_t> dropped) {
    const WeldedSurface welded(mesh);
    GeometryHeader header;
    header.steps = static_cast<uint32_t>(dropped.size());
    std::copy(dropped.begin(), dropped.end(), header.dropped.begin());
    header.box = box_of(welded, dropped[0]);
    header.has_prisms = !prisms.empty();
    bits::RangeEncoder coder;
    code_header(coder, header);
    const double before = coder.cost();
    std::vector<Prism> in_order;
    PrismTree tree;
    if (header.has_prisms) in_order = encode_prisms(coder, prisms, dropped[0], &tree);
    GeometrySteps result;
    result.prism_bits = coder.cost() - before;
    SurfaceWriter writer(welded, header.box, dropped[0]);
    writer.write(coder);
    result.position_bits = writer.walk().position_bits();
    result.steps.push_back(coder.finish());
    refine(result, dropped, writer, welded, in_order, tree.lattices);
    return result;
}

size_t bytes_of(const GeometrySteps& steps) {
    size_t sum = 0;
    for (const auto& step : steps.steps) sum += step.size();
    return sum;
}

}  // namespace

GeometrySteps encode_geometry(const GridMesh& mesh, std::span<const uint32_t> dropped) {
    assert(!dropped.empty() && dropped.size() <= kMostGeometrySteps && dropped[0] <= kMostDroppedBits);
    const PrismSplit split = split_prisms(mesh);
    if (split.prisms.empty()) return encode_parts(mesh, {}, dropped);
    GeometrySteps parts = encode_parts(split.remainder, split.prisms, dropped);
    // Prisms share no points with what stands beside them. Where much does, the walk over everything may be shorter.
    if (split.remainder.triangles.size() < mesh.triangles.size() / 4) return parts;
    GeometrySteps whole = encode_parts(mesh, {}, dropped);
    return bytes_of(whole) < bytes_of(parts) ? whole : parts;
}

}  // namespace citystream::codec::mesh
