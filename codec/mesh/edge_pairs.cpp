#include "codec/mesh/edge_pairs.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace citystream::codec::mesh {

namespace {

/// Item i goes to the list of vertex_of(i), kNoEdge to no list; every list is in the order of items.
template <typename VertexOf>
VertexCorners make_lists(uint32_t vertex_count, uint32_t item_count, VertexOf vertex_of) {
    VertexCorners lists;
    lists.begin.assign(size_t{vertex_count} + 1, 0);
    for (uint32_t i = 0; i < item_count; ++i) {
        if (vertex_of(i) != kNoEdge) ++lists.begin[vertex_of(i) + 1];
    }
    std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
    lists.items.resize(lists.begin.back());
    std::vector<uint32_t> end(lists.begin.begin(), lists.begin.end() - 1);
    for (uint32_t i = 0; i < item_count; ++i) {
        if (vertex_of(i) != kNoEdge) lists.items[end[vertex_of(i)]++] = i;
    }
    return lists;
}

/// Pairs the half-edges between two vertices: those of one direction, then those of the other, from `turn` on.
void pair_between(std::span<const uint32_t> edges, size_t turn, std::vector<uint32_t>& opposite) {
    for (size_t i = 0; i < turn && turn + i < edges.size(); ++i) {
        opposite[edges[i]] = edges[turn + i];
        opposite[edges[turn + i]] = edges[i];
    }
}

}  // namespace

std::vector<uint32_t> pair_edges(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count) {
    const auto from = [&](uint32_t edge) { return triangles[edge / 3][edge % 3]; };
    const auto to = [&](uint32_t edge) { return from(next_edge(edge)); };
    const auto lesser_end = [&](uint32_t edge) {
        const auto& [a, b, c] = triangles[edge / 3];
        return a == b || b == c || c == a ? kNoEdge : std::min(from(edge), to(edge));
    };
    const auto greater_end = [&](uint32_t edge) { return std::max(from(edge), to(edge)); };
    std::vector<uint32_t> opposite(3 * triangles.size(), kNoEdge);
    VertexCorners lists = make_lists(vertex_count, static_cast<uint32_t>(3 * triangles.size()), lesser_end);
    for (uint32_t vertex = 0; vertex < vertex_count; ++vertex) {
        const auto edges = std::span(lists.items).subspan(lists.begin[vertex], lists.of(vertex).size());
        const auto comes_in = [&](uint32_t edge) { return to(edge) == vertex; };
        std::sort(edges.begin(), edges.end(), [&](uint32_t a, uint32_t b) {
            return std::tuple(greater_end(a), comes_in(a), a) < std::tuple(greater_end(b), comes_in(b), b);
        });
        for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
            size_t turn = begin;
            for (; end < edges.size() && greater_end(edges[end]) == greater_end(edges[begin]); ++end)
                turn += comes_in(edges[end]) ? 0 : 1;
            pair_between(edges.subspan(begin, end - begin), turn - begin, opposite);
        }
    }
    return opposite;
}

VertexCorners corners_around(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count) {
    return make_lists(vertex_count, static_cast<uint32_t>(3 * triangles.size()),
                      [&](uint32_t corner) { return triangles[corner / 3][corner % 3]; });
}

}  // namespace citystream::codec::mesh
