#include "codec/mesh/surface_writer.h"

#include <algorithm>
#include <cassert>

namespace citystream::codec::mesh {

namespace {

constexpr uint32_t kNone = MeshBorder::kNone;

}  // namespace

WeldedSurface::WeldedSurface(const GridMesh& mesh) : point_of(mesh.points.size()) {
    std::vector<uint32_t> order(mesh.points.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](uint32_t i, uint32_t j) {
        return mesh.points[i] != mesh.points[j] ? mesh.points[i] < mesh.points[j] : i < j;
    });
    for (const uint32_t i : order) {
        if (points.empty() || points.back() != mesh.points[i]) points.push_back(mesh.points[i]);
        point_of[i] = static_cast<uint32_t>(points.size() - 1);
    }
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& t = mesh.triangles[i];
        const std::array<uint32_t, 3> u = {point_of[t[0]], point_of[t[1]], point_of[t[2]]};
        const bool is_flat = u[0] == u[1] || u[1] == u[2] || u[2] == u[0];
        (is_flat ? flat : triangles).push_back(u);
        (is_flat ? flat_source : triangle_source).push_back(i);
    }
}

SurfaceBox box_of(const WeldedSurface& mesh, uint32_t dropped) {
    SurfaceBox box;
    bool first = true;
    uint64_t reach = 0, triangles = 0;
    GridPoint high{};
    for (const auto* list : {&mesh.triangles, &mesh.flat}) {
        for (const auto& t : *list) {
            for (const uint32_t v : t) {
                for (size_t k = 0; k < 3; ++k) {
                    const int32_t value = mesh.points[v][k] >> dropped;
                    box.low[k] = first ? value : std::min(box.low[k], value);
                    high[k] = first ? value : std::max(high[k], value);
                }
                first = false;
            }
            reach += distance_between(mesh.points[t[0]], mesh.points[t[1]]);
            ++triangles;
        }
    }
    for (size_t k = 0; k < 3; ++k) box.extent[k] = high[k] - box.low[k];
    // Cubes of about one and a half edges: the 27 around a place hold what is near it and not much more.
    const uint64_t side = triangles > 0 ? reach * 3 / (2 * triangles) >> dropped : 0;
    box.cell_bits = std::clamp(size_class(side), 1u, kMostCellBits);
    return box;
}

SurfaceWriter::SurfaceWriter(const WeldedSurface& mesh, const SurfaceBox& box, uint32_t dropped)
    : mesh_(mesh), box_(box), dropped_(dropped), open_(mesh.triangles), walk_(box.frame(~0u, ~0u)) {
    walked_.assign(mesh.points.size(), kNone);
}

WalkCorner SurfaceWriter::corner_at(uint32_t vertex) {
    if (walked_[vertex] != kNone) return {Beyond::kKnown, walked_[vertex], {}};
    walked_[vertex] = static_cast<uint32_t>(points_.size());
    points_.push_back(vertex);
    WalkCorner corner{Beyond::kNew, 0, {}};
    for (size_t k = 0; k < 3; ++k) corner.place[k] = (mesh_.points[vertex][k] >> dropped_) - box_.low[k];
    return corner;
}

/// Of several open triangles that fit a gate the one that is cheapest to say.
uint32_t SurfaceWriter::triangle_beyond(const MeshBorder::Gate& gate, uint32_t& apex) const {
    const MeshBorder& border = walk_.border();
    const uint32_t after = border.gate(gate.next).to, before = border.gate(gate.previous).from;
    uint32_t best = kNone;
    int best_worth = -1;
    open_.each_with_edge(points_[gate.to], points_[gate.from], [&](uint32_t triangle, uint32_t opposite) {
        const uint32_t index = walked_[opposite];
        const int worth = index == kNone ? 1 : index == after || index == before ? 2 : 0;
        if (worth <= best_worth) return;
        best_worth = worth;
        best = triangle;
        apex = opposite;
    });
    return best;
}

uint32_t SurfaceWriter::known_corners(const Triangle& t) const {
    uint32_t known = 0;
    for (const uint32_t v : t) known += walked_[v] != kNone ? 1 : 0;
    return known;
}

/// An open triangle at the first point of the walk that has any: of its triangles the one with most known corners.
uint32_t SurfaceWriter::triangle_at_known_point() {
    for (; complete_ < points_.size(); ++complete_) {
        uint32_t best = kNone, most = 0;
        open_.each_with_corner(points_[complete_], [&](uint32_t triangle) {
            const uint32_t known = known_corners(mesh_.triangles[triangle]);
            if (known <= most) return;
            most = known;
            best = triangle;
        });
        if (best != kNone) return best;
    }
    return kNone;
}

void SurfaceWriter::take(uint32_t triangle) {
    open_.close(triangle);
    triangles_.push_back(mesh_.triangle_source[triangle]);
}

void SurfaceWriter::write_piece(bits::RangeEncoder& coder, Triangle first, uint32_t index) {
    [[maybe_unused]] bool written =
        walk_.code_start(coder, {corner_at(first[0]), corner_at(first[1]), corner_at(first[2])});
    take(index);
    for (uint32_t gate = walk_.gate(); gate != kNone; gate = walk_.gate()) {
        uint32_t apex = 0;
        const uint32_t triangle = triangle_beyond(walk_.border().gate(gate), apex);
        if (triangle == kNone) {
            written = walk_.code_gate(coder, gate) && written;
        } else {
            take(triangle);
            written = walk_.code_gate(coder, gate, corner_at(apex)) && written;
        }
    }
    assert(written);
}

void SurfaceWriter::write(bits::RangeEncoder& coder) {
    for (uint32_t t = 0; t < mesh_.triangles.size();) {
        const uint32_t at_known = triangle_at_known_point();
        if (at_known == kNone && !open_.is_open(t)) {
            ++t;
            continue;
        }
        const uint32_t next = at_known != kNone ? at_known : t;
        Triangle first = mesh_.triangles[next];
        if (at_known != kNone) {
            while (first[0] != points_[complete_]) std::rotate(first.begin(), first.begin() + 1, first.end());
        }
        walk_.code_more(coder, true);
        write_piece(coder, first, next);
    }
    walk_.code_more(coder, false);
    for (size_t i = 0; i < mesh_.flat.size(); ++i) {
        const Triangle& t = mesh_.flat[i];
        walk_.code_more(coder, true);
        const std::array corners = {corner_at(t[0]), corner_at(t[1]), corner_at(t[2])};
        walk_.code_flat(coder, corners);
        triangles_.push_back(mesh_.flat_source[i]);
    }
    walk_.code_more(coder, false);
}

}  // namespace citystream::codec::mesh
