#include <algorithm>
#include <cassert>

#include "codec/bits/range_coder.h"
#include "codec/mesh/geometry_header.h"
#include "codec/mesh/geometry_wire.h"
#include "codec/mesh/open_triangles.h"
#include "codec/mesh/point_refinement.h"
#include "codec/mesh/prism_code.h"
#include "codec/mesh/prism_planes.h"
#include "codec/mesh/prisms.h"
#include "codec/mesh/surface_walk.h"

namespace citystream::codec::mesh {

namespace {

constexpr uint32_t kNone = MeshBorder::kNone;
using Triangle = std::array<uint32_t, 3>;

/// The mesh with one point for each place, and the triangles with equal corners set apart.
struct WeldedMesh {
    std::vector<GridPoint> points;
    std::vector<Triangle> triangles, flat;
};

WeldedMesh weld(const GridMesh& mesh) {
    std::vector<uint32_t> order(mesh.points.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](uint32_t i, uint32_t j) {
        return mesh.points[i] != mesh.points[j] ? mesh.points[i] < mesh.points[j] : i < j;
    });
    std::vector<uint32_t> welded(mesh.points.size());
    WeldedMesh result;
    for (const uint32_t i : order) {
        if (result.points.empty() || result.points.back() != mesh.points[i]) result.points.push_back(mesh.points[i]);
        welded[i] = static_cast<uint32_t>(result.points.size() - 1);
    }
    for (const Triangle& t : mesh.triangles) {
        const Triangle u = {welded[t[0]], welded[t[1]], welded[t[2]]};
        const bool flat = u[0] == u[1] || u[1] == u[2] || u[2] == u[0];
        (flat ? result.flat : result.triangles).push_back(u);
    }
    return result;
}

GeometryHeader header_of(const WeldedMesh& mesh, std::span<const uint32_t> dropped) {
    GeometryHeader header;
    header.steps = static_cast<uint32_t>(dropped.size());
    std::copy(dropped.begin(), dropped.end(), header.dropped.begin());
    bool first = true;
    uint64_t reach = 0, triangles = 0;
    GridPoint high{};
    for (const auto* list : {&mesh.triangles, &mesh.flat}) {
        for (const Triangle& t : *list) {
            for (const uint32_t v : t) {
                for (size_t k = 0; k < 3; ++k) {
                    const int32_t value = mesh.points[v][k] >> dropped[0];
                    header.low[k] = first ? value : std::min(header.low[k], value);
                    high[k] = first ? value : std::max(high[k], value);
                }
                first = false;
            }
            reach += distance_between(mesh.points[t[0]], mesh.points[t[1]]);
            ++triangles;
        }
    }
    for (size_t k = 0; k < 3; ++k) header.extent[k] = high[k] - header.low[k];
    // Cubes of about one and a half edges: the 27 around a place hold what is near it and not much more.
    const uint64_t side = triangles > 0 ? reach * 3 / (2 * triangles) >> dropped[0] : 0;
    header.cell_bits = std::clamp(size_class(side), 1u, kMostCellBits);
    return header;
}

/// Drives the walk over a given mesh.
class Writer {
  public:
    Writer(const WeldedMesh& mesh, const GeometryHeader& header)
        : mesh_(mesh), header_(header), open_(mesh.triangles), walk_(header.frame({~0u, ~0u})) {
        walked_.assign(mesh.points.size(), kNone);
    }
    void write(bits::RangeEncoder& coder);
    const SurfaceWalk& walk() const { return walk_; }
    /// The mesh's points in the order of the walk.
    const std::vector<uint32_t>& order() const { return order_; }

  private:
    WalkCorner corner_at(uint32_t vertex);
    uint32_t triangle_beyond(const MeshBorder::Gate& gate, uint32_t& apex) const;
    uint32_t known_corners(const Triangle& t) const;
    uint32_t triangle_at_known_point();
    void write_piece(bits::RangeEncoder& coder, Triangle first, uint32_t index);

    const WeldedMesh& mesh_;
    const GeometryHeader& header_;
    OpenTriangles open_;
    SurfaceWalk walk_;
    std::vector<uint32_t> walked_, order_;
    size_t complete_ = 0;  ///< points at the front of order_ that no open triangle has
};

WalkCorner Writer::corner_at(uint32_t vertex) {
    if (walked_[vertex] != kNone) return {Beyond::kKnown, walked_[vertex], {}};
    walked_[vertex] = static_cast<uint32_t>(order_.size());
    order_.push_back(vertex);
    WalkCorner corner{Beyond::kNew, 0, {}};
    for (size_t k = 0; k < 3; ++k) corner.place[k] = (mesh_.points[vertex][k] >> header_.dropped[0]) - header_.low[k];
    return corner;
}

/// Of several open triangles that fit a gate the one that is cheapest to say.
uint32_t Writer::triangle_beyond(const MeshBorder::Gate& gate, uint32_t& apex) const {
    const MeshBorder& border = walk_.border();
    const uint32_t after = border.gate(gate.next).to, before = border.gate(gate.previous).from;
    uint32_t best = kNone;
    int best_worth = -1;
    open_.each_with_edge(order_[gate.to], order_[gate.from], [&](uint32_t triangle, uint32_t opposite) {
        const uint32_t index = walked_[opposite];
        const int worth = index == kNone ? 1 : index == after || index == before ? 2 : 0;
        if (worth <= best_worth) return;
        best_worth = worth;
        best = triangle;
        apex = opposite;
    });
    return best;
}

uint32_t Writer::known_corners(const Triangle& t) const {
    uint32_t known = 0;
    for (const uint32_t v : t) known += walked_[v] != kNone ? 1 : 0;
    return known;
}

/// An open triangle at the first point of the walk that has any: of its triangles the one with most known corners.
uint32_t Writer::triangle_at_known_point() {
    for (; complete_ < order_.size(); ++complete_) {
        uint32_t best = kNone, most = 0;
        open_.each_with_corner(order_[complete_], [&](uint32_t triangle) {
            const uint32_t known = known_corners(mesh_.triangles[triangle]);
            if (known <= most) return;
            most = known;
            best = triangle;
        });
        if (best != kNone) return best;
    }
    return kNone;
}

void Writer::write_piece(bits::RangeEncoder& coder, Triangle first, uint32_t index) {
    [[maybe_unused]] bool written =
        walk_.code_start(coder, {corner_at(first[0]), corner_at(first[1]), corner_at(first[2])});
    open_.close(index);
    for (uint32_t gate = walk_.gate(); gate != kNone; gate = walk_.gate()) {
        uint32_t apex = 0;
        const uint32_t triangle = triangle_beyond(walk_.border().gate(gate), apex);
        if (triangle == kNone) {
            written = walk_.code_gate(coder, gate) && written;
        } else {
            open_.close(triangle);
            written = walk_.code_gate(coder, gate, corner_at(apex)) && written;
        }
    }
    assert(written);
}

void Writer::write(bits::RangeEncoder& coder) {
    for (uint32_t t = 0; t < mesh_.triangles.size();) {
        const uint32_t at_known = triangle_at_known_point();
        if (at_known == kNone && !open_.is_open(t)) {
            ++t;
            continue;
        }
        const uint32_t next = at_known != kNone ? at_known : t;
        Triangle first = mesh_.triangles[next];
        if (at_known != kNone) {
            while (first[0] != order_[complete_]) std::rotate(first.begin(), first.begin() + 1, first.end());
        }
        walk_.code_more(coder, true);
        write_piece(coder, first, next);
    }
    walk_.code_more(coder, false);
    for (const Triangle& t : mesh_.flat) {
        walk_.code_more(coder, true);
        const std::array corners = {corner_at(t[0]), corner_at(t[1]), corner_at(t[2])};
        walk_.code_flat(coder, corners);
    }
    walk_.code_more(coder, false);
}

void refine(GeometrySteps& steps, std::span<const uint32_t> dropped, const Writer& writer, const WeldedMesh& mesh,
            const std::vector<Prism>& prisms) {
    std::vector<GridPoint> points = writer.walk().points();
    for (size_t s = 1; s < dropped.size(); ++s) {
        bits::RangeEncoder coder;
        const uint32_t bits = dropped[s - 1] - dropped[s];
        if (!prisms.empty()) encode_prism_planes(coder, prisms, bits, dropped[s]);
        PointRefinement refinement(bits);
        for (uint32_t i = 0; i < points.size(); ++i) {
            GridPoint place = mesh.points[writer.order()[i]];
            for (int32_t& coordinate : place) coordinate >>= dropped[s];
            refinement.code(coder, points, i, writer.walk().origins()[i], place);
        }
        steps.position_bits += coder.cost();
        steps.steps.push_back(coder.finish());
    }
}

GeometrySteps encode_parts(const GridMesh& mesh, const std::vector<Prism>& prisms, std::span<const uint32_t> dropped) {
    const WeldedMesh welded = weld(mesh);
    GeometryHeader header = header_of(welded, dropped);
    header.has_prisms = !prisms.empty();
    bits::RangeEncoder coder;
    code_header(coder, header);
    const double before = coder.cost();
    std::vector<Prism> in_order;
    if (header.has_prisms) in_order = encode_prisms(coder, prisms, dropped[0]);
    GeometrySteps result;
    result.prism_bits = coder.cost() - before;
    Writer writer(welded, header);
    writer.write(coder);
    result.position_bits = writer.walk().position_bits();
    result.steps.push_back(coder.finish());
    refine(result, dropped, writer, welded, in_order);
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
