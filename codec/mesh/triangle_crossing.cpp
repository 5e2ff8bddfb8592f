#include "codec/mesh/triangle_crossing.h"

#include <cstddef>
#include <cstdint>

namespace citystream::codec::mesh {
namespace {

using Wide = __int128;
using WideVector = std::array<Wide, 3>;

WideVector difference(const GridPoint& a, const GridPoint& b) {
    return {Wide{a[0]} - b[0], Wide{a[1]} - b[1], Wide{a[2]} - b[2]};
}

WideVector cross(const WideVector& a, const WideVector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

WideVector normal_of(const GridTriangle& t) {
    return cross(difference(t[1], t[0]), difference(t[2], t[0]));
}

int sign(Wide value) {
    return value > 0 ? 1 : value < 0 ? -1 : 0;
}

/// On which side of the plane through a, b, c the point d lies.
int side(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
    const WideVector n = cross(difference(b, a), difference(c, a)), to = difference(d, a);
    return sign(n[0] * to[0] + n[1] * to[1] + n[2] * to[2]);
}

/// A segment that is not in the triangle's plane.
bool segment_meets(const GridPoint& p, const GridPoint& q, const GridTriangle& t) {
    const int at_p = side(t[0], t[1], t[2], p), at_q = side(t[0], t[1], t[2], q);
    if (at_p * at_q > 0 || (at_p == 0 && at_q == 0)) return false;
    const int around[3] = {side(p, q, t[0], t[1]), side(p, q, t[1], t[2]), side(p, q, t[2], t[0])};
    const bool left = around[0] >= 0 && around[1] >= 0 && around[2] >= 0;
    const bool right = around[0] <= 0 && around[1] <= 0 && around[2] <= 0;
    return left || right;
}

/// Twice the signed area along an axis.
int turn(const GridPoint& a, const GridPoint& b, const GridPoint& c, size_t axis) {
    return sign(cross(difference(b, a), difference(c, a))[axis]);
}

/// In one plane, seen along an axis that is not in it: whether an edge of `a` has all of `b` strictly outside.
bool edge_separates(const GridTriangle& a, const GridTriangle& b, size_t axis) {
    const int inside = turn(a[0], a[1], a[2], axis);
    for (size_t i = 0; i < 3; ++i) {
        bool all_outside = true;
        for (const GridPoint& point : b) all_outside &= turn(a[i], a[(i + 1) % 3], point, axis) * inside < 0;
        if (all_outside) return true;
    }
    return false;
}

bool coplanar_meet(const GridTriangle& a, const GridTriangle& b, const WideVector& normal) {
    size_t axis = 0;
    while (normal[axis] == 0) ++axis;
    return !edge_separates(a, b, axis) && !edge_separates(b, a, axis);
}

}  // namespace

bool has_area(const GridTriangle& triangle) {
    return normal_of(triangle) != WideVector{};
}

bool triangles_meet(const GridTriangle& a, const GridTriangle& b) {
    const WideVector normal = normal_of(a);
    if (normal == WideVector{} || !has_area(b)) return false;
    bool coplanar = true;
    for (const GridPoint& point : b) coplanar &= side(a[0], a[1], a[2], point) == 0;
    if (coplanar) return coplanar_meet(a, b, normal);
    for (size_t i = 0; i < 3; ++i) {
        if (segment_meets(a[i], a[(i + 1) % 3], b) || segment_meets(b[i], b[(i + 1) % 3], a)) return true;
    }
    return false;
}

}  // namespace citystream::codec::mesh
