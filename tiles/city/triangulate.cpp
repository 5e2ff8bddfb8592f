#include "tiles/city/triangulate.h"

#include <GL/glu.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "tiles/city/edge_crossings.h"

namespace citystream::tiles::city {
namespace {

/// Below this area (a tenth of a millimetre squared) a polygon cannot be seen.
constexpr double kLeastArea = 1e-8;
/// Area over squared perimeter below which the points are on one line but for rounding.
constexpr double kLeastCompactness = 1e-11;
/// Two places closer than this are one (metres, in the plane).
constexpr double kTouch = 1e-6;

Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
double length(const Vec3& v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}
double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The plane of projection: the axis nearest to the normal is left out, the others keep the orientation.
struct Projection {
    int dropped = 2;
    bool swapped = false;

    explicit Projection(const Vec3& normal) {
        const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
        dropped = z >= x && z >= y ? 2 : (x >= y ? 0 : 1);
        const std::array<double, 3> n = {normal.x, normal.y, normal.z};
        swapped = n[dropped] < 0;
    }
    int first() const { return (dropped + (swapped ? 2 : 1)) % 3; }
    int second() const { return (dropped + (swapped ? 1 : 2)) % 3; }
    Vec2 operator()(const Vec3& p) const {
        const std::array<double, 3> c = {p.x, p.y, p.z};
        return {c[first()], c[second()]};
    }
};

/// What the tessellator's callbacks see as a vertex.
struct Node {
    std::array<GLdouble, 3> place{};  ///< projected, relative to the origin
    Vec3 offset;                      ///< in space, relative to the origin
    uint32_t corner = 0;
};

}  // namespace

Vec3 newell_normal(std::span<const Corner> ring) {
    Vec3 sum;
    const Vec3 origin = ring.front().position;
    for (size_t i = 0; i < ring.size(); ++i) {
        const Vec3 a = minus(ring[i].position, origin);
        const Vec3 b = minus(ring[(i + 1) % ring.size()].position, origin);
        sum.x += (a.y - b.y) * (a.z + b.z);
        sum.y += (a.z - b.z) * (a.x + b.x);
        sum.z += (a.x - b.x) * (a.y + b.y);
    }
    return sum;
}

struct Triangulator::State {
    GLUtesselator* tessellator = nullptr;
    std::vector<Corner>* corners = nullptr;
    std::vector<std::array<uint32_t, 3>>* triangles = nullptr;
    Vec3 origin;
    Projection projection{Vec3{}};
    std::vector<Node> nodes;  ///< of the rings; not resized while the tessellator holds pointers into it
    std::deque<Node> made;    ///< at crossings; addresses stay
    std::vector<Vec2> flat;
    std::array<uint32_t, 3> pending{};
    size_t pending_count = 0;
    bool crossed = false;
    bool failed = false;

    void add_vertex(uint32_t corner) {
        pending[pending_count++] = corner;
        if (pending_count < 3) return;
        pending_count = 0;
        if (pending[0] == pending[1] || pending[1] == pending[2] || pending[2] == pending[0]) return;
        triangles->push_back(pending);
    }

    /// The vertex where edges cross or rings touch: `sources` with `weights` around it (null where there is none).
    Node* combine(const GLdouble place[3], Node* const sources[4], const GLfloat weights[4]) {
        Node node;
        node.place = {place[0], place[1], 0};
        Vec2 texcoord;
        double total = 0;
        Node* twin = nullptr;
        for (int i = 0; i < 4; ++i) {
            if (sources[i] == nullptr) continue;
            const Node& source = *sources[i];
            const double weight = static_cast<double>(weights[i]);
            total += weight;
            const Corner& corner = (*corners)[source.corner];
            node.offset.x += weight * source.offset.x;
            node.offset.y += weight * source.offset.y;
            node.offset.z += weight * source.offset.z;
            texcoord.x += weight * corner.texcoord.x;
            texcoord.y += weight * corner.texcoord.y;
            const bool here = std::abs(source.place[0] - place[0]) + std::abs(source.place[1] - place[1]) < kTouch;
            if (here && twin == nullptr) twin = sources[i];
        }
        if (total > 0) {
            node.offset = {node.offset.x / total, node.offset.y / total, node.offset.z / total};
            texcoord = {texcoord.x / total, texcoord.y / total};
        }
        return keep(node, texcoord, twin);
    }

    Node* keep(Node node, Vec2 texcoord, Node* twin) {
        Vec3 position;
        if (twin != nullptr) {
            const Corner& corner = (*corners)[twin->corner];
            if (corner.texcoord.x == texcoord.x && corner.texcoord.y == texcoord.y) return twin;
            node.offset = twin->offset;
            position = corner.position;
        } else {
            crossed = true;
            std::array<double, 3> offset = {node.offset.x, node.offset.y, node.offset.z};
            offset[projection.first()] = node.place[0];
            offset[projection.second()] = node.place[1];
            node.offset = {offset[0], offset[1], offset[2]};
            position = {origin.x + offset[0], origin.y + offset[1], origin.z + offset[2]};
        }
        node.corner = static_cast<uint32_t>(corners->size());
        corners->push_back({position, texcoord});
        return &made.emplace_back(node);
    }

    void run(std::span<const uint32_t> ring_ends) {
        made.clear();
        pending_count = 0;
        crossed = failed = false;
        gluTessBeginPolygon(tessellator, this);
        gluTessNormal(tessellator, 0, 0, 1);
        uint32_t next = 0;
        for (const uint32_t end : ring_ends) {
            gluTessBeginContour(tessellator);
            for (; next < end; ++next) gluTessVertex(tessellator, nodes[next].place.data(), &nodes[next]);
            gluTessEndContour(tessellator);
        }
        gluTessEndPolygon(tessellator);
    }

    double triangle_area(size_t first_triangle) const {
        double sum = 0;
        for (size_t i = first_triangle; i < triangles->size(); ++i) {
            std::array<Vec2, 3> p;
            for (size_t k = 0; k < 3; ++k) p[k] = projection(minus((*corners)[(*triangles)[i][k]].position, origin));
            sum += std::abs(cross(p[0], p[1], p[2]));
        }
        return sum / 2;
    }

    double ring_area(uint32_t begin, uint32_t end) const {
        double sum = 0;
        for (uint32_t i = begin; i < end; ++i) {
            const Vec2& a = flat[i];
            const Vec2& b = flat[i + 1 == end ? begin : i + 1];
            sum += a.x * b.y - a.y * b.x;
        }
        return sum / 2;
    }

    /// Area that the rings enclose if they are properly nested.
    double expected_area(std::span<const uint32_t> ring_ends) const {
        double area = ring_area(0, ring_ends[0]);
        for (size_t i = 1; i < ring_ends.size(); ++i) area -= std::abs(ring_area(ring_ends[i - 1], ring_ends[i]));
        return area;
    }

    /// Triangles and convex quadrilaterals need no tessellator.
    bool split_simple() {
        if (flat.size() == 3) {
            triangles->push_back({0, 1, 2});
            return true;
        }
        if (flat.size() != 4) return false;
        for (size_t i = 0; i < 4; ++i) {
            if (cross(flat[i], flat[(i + 1) % 4], flat[(i + 2) % 4]) <= 0) return false;
        }
        const Vec3 across = minus(nodes[2].offset, nodes[0].offset), other = minus(nodes[3].offset, nodes[1].offset);
        if (length(across) <= length(other)) {
            triangles->push_back({0, 1, 2});
            triangles->push_back({0, 2, 3});
        } else {
            triangles->push_back({0, 1, 3});
            triangles->push_back({1, 2, 3});
        }
        return true;
    }

    void project() {
        flat.clear();
        nodes.clear();
        for (uint32_t i = 0; i < corners->size(); ++i) {
            const Vec3 offset = minus((*corners)[i].position, origin);
            const Vec2 place = projection(offset);
            flat.push_back(place);
            nodes.push_back({{place.x, place.y, 0}, offset, i});
        }
    }
};

namespace {

using Callback = void (*)();

double perimeter(std::span<const Corner> ring) {
    double sum = 0;
    for (size_t i = 0; i < ring.size(); ++i)
        sum += length(minus(ring[(i + 1) % ring.size()].position, ring[i].position));
    return sum;
}

}  // namespace

Triangulator::Triangulator() : state_(std::make_unique<State>()) {
    using Self = State;
    struct Callbacks {
        static void vertex(void* node, void* self) {
            static_cast<Self*>(self)->add_vertex(static_cast<Node*>(node)->corner);
        }
        static void combine(GLdouble place[3], void* sources[4], GLfloat weights[4], void** out, void* self) {
            std::array<Node*, 4> nodes{};
            for (int i = 0; i < 4; ++i) nodes[i] = static_cast<Node*>(sources[i]);
            *out = static_cast<Self*>(self)->combine(place, nodes.data(), weights);
        }
        static void error(GLenum, void* self) { static_cast<Self*>(self)->failed = true; }
        static void edge_flag(GLboolean, void*) {}  // being set makes the tessellator emit separate triangles only
    };
    state_->tessellator = gluNewTess();
    gluTessProperty(state_->tessellator, GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_ODD);
    gluTessCallback(state_->tessellator, GLU_TESS_VERTEX_DATA, reinterpret_cast<Callback>(&Callbacks::vertex));
    gluTessCallback(state_->tessellator, GLU_TESS_COMBINE_DATA, reinterpret_cast<Callback>(&Callbacks::combine));
    gluTessCallback(state_->tessellator, GLU_TESS_ERROR_DATA, reinterpret_cast<Callback>(&Callbacks::error));
    gluTessCallback(state_->tessellator, GLU_TESS_EDGE_FLAG_DATA, reinterpret_cast<Callback>(&Callbacks::edge_flag));
}

Triangulator::~Triangulator() {
    gluDeleteTess(state_->tessellator);
}

PolygonOutcome Triangulator::triangulate(std::vector<Corner>& corners, std::span<const uint32_t> ring_ends,
                                         std::vector<std::array<uint32_t, 3>>& triangles) {
    PolygonOutcome outcome;
    const std::span<const Corner> outer(corners.data(), ring_ends[0]);
    outcome.normal = newell_normal(outer);
    const double area = length(outcome.normal) / 2;
    const double around = perimeter(outer);
    if (!(area > kLeastArea) || area < kLeastCompactness * around * around) {
        outcome.fault = PolygonFault::kDegenerate;
        return outcome;
    }
    State& state = *state_;
    state.corners = &corners;
    state.triangles = &triangles;
    state.origin = corners[0].position;
    state.projection = Projection(outcome.normal);
    state.project();
    if (ring_ends.size() == 1 && state.split_simple()) return outcome;
    if (corners.size() > kMostCorners || too_many_crossings(state.flat, ring_ends)) {
        outcome.fault = PolygonFault::kTangled;
        return outcome;
    }
    const size_t first_triangle = triangles.size();
    state.run(ring_ends);
    if (state.failed || triangles.size() == first_triangle) {
        triangles.resize(first_triangle);
        outcome.fault = PolygonFault::kFailed;
        return outcome;
    }
    const double expected = state.expected_area(ring_ends);
    constexpr double kAreaTolerance = 1e-3;
    outcome.crosses_itself = state.crossed || std::abs(state.triangle_area(first_triangle) - expected) >
                                                  kAreaTolerance * state.ring_area(0, ring_ends[0]) + kLeastArea;
    return outcome;
}

}  // namespace citystream::tiles::city
