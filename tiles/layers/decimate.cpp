#include "tiles/layers/decimate.h"

// QuadricT.hh uses what these two declare without including them.
#include <OpenMesh/Core/Geometry/VectorT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Utils/vector_traits.hh>

#include <OpenMesh/Core/Geometry/QuadricT.hh>

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>

#include "tiles/layers/surface_distance.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::BuildTriangle;

struct Traits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
    VertexAttributes(OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::Normal);
    EdgeAttributes(OpenMesh::Attributes::Status);
    HalfedgeAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::PrevHalfedge);
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

/// What a mesh vertex stands for: a position with one paint and one texture coordinate, so that seams become borders.
struct Wedge {
    uint32_t vertex = 0, paint = 0;
    std::array<int64_t, 2> texcoord{};
    auto operator<=>(const Wedge&) const = default;
};

struct WedgeMesh {
    Mesh mesh;
    std::vector<Wedge> wedges;  // by vertex of the mesh
};

/// OpenMesh writes to stderr when a face does not fit; that is expected here and dealt with.
void silence_openmesh() {
    static const bool done = [] {
        omerr().disable();
        return true;
    }();
    (void)done;
}

void build(const BuildObject& object, WedgeMesh& out) {
    const GridPoint origin = object.box().lo;
    std::map<Wedge, Mesh::VertexHandle> known;
    const auto add_wedge = [&](const Wedge wedge) {
        const GridPoint& p = object.vertices[wedge.vertex];
        out.wedges.push_back(wedge);
        return out.mesh.add_vertex({to_metres(p.x - origin.x), to_metres(p.y - origin.y), to_metres(p.z - origin.z)});
    };
    for (const BuildTriangle& triangle : object.triangles) {
        std::array<Mesh::VertexHandle, 3> corners;
        for (size_t k = 0; k < 3; ++k) {
            const Wedge wedge{triangle.vertex[k], triangle.paint, triangle.texcoord[k]};
            const auto [found, is_new] = known.try_emplace(wedge);
            if (is_new) found->second = add_wedge(wedge);
            corners[k] = found->second;
        }
        if (out.mesh.add_face(corners[0], corners[1], corners[2]).is_valid()) continue;
        // Three faces at one edge, or two fans at one vertex: this face stands alone, and as a border it stays as it
        // is.
        for (size_t k = 0; k < 3; ++k) corners[k] = add_wedge(out.wedges[static_cast<size_t>(corners[k].idx())]);
        out.mesh.add_face(corners[0], corners[1], corners[2]);
    }
}

void take_back(const WedgeMesh& simplified, BuildObject& object) {
    std::vector<BuildTriangle> triangles;
    for (const auto face : simplified.mesh.faces()) {
        if (simplified.mesh.status(face).deleted()) continue;
        BuildTriangle triangle;
        size_t k = 0;
        for (const auto vertex : simplified.mesh.fv_range(face)) {
            const Wedge& wedge = simplified.wedges[static_cast<size_t>(vertex.idx())];
            triangle.vertex[k] = wedge.vertex;
            triangle.texcoord[k] = wedge.texcoord;
            triangle.paint = wedge.paint;
            ++k;
        }
        triangles.push_back(triangle);
    }
    object.triangles = std::move(triangles);
    std::vector<uint32_t> renumbered(object.vertices.size(), UINT32_MAX);
    std::vector<GridPoint> used;
    for (BuildTriangle& triangle : object.triangles) {
        for (uint32_t& vertex : triangle.vertex) {
            if (renumbered[vertex] == UINT32_MAX) {
                renumbered[vertex] = static_cast<uint32_t>(used.size());
                used.push_back(object.vertices[vertex]);
            }
            vertex = renumbered[vertex];
        }
    }
    object.vertices = std::move(used);
}

constexpr double kLeastNormalCosine = 0.5;  // a collapse turns no triangle by more than 60 degrees

/// Half-edge collapses in the order of their quadric error. Every removed point stays attached to the face that is
/// nearest to it, and no collapse may leave one farther than the limit from the surface: that is the distance reported.
class Collapser {
  public:
    Collapser(Mesh& mesh, double limit)
        : mesh_(mesh),
          limit_(limit),
          quadrics_(mesh.n_vertices()),
          versions_(mesh.n_vertices()),
          points_(mesh.n_faces()) {
        for (const auto face : mesh_.faces()) add_face_quadric(face);
        for (const auto vertex : mesh_.vertices()) push(vertex);
    }

    /// Greatest distance of a removed point from the result, metres; negative when nothing was collapsed.
    double run() {
        double reached = -1;
        while (!queue_.empty()) {
            const Candidate next = queue_.top();
            queue_.pop();
            const auto from = mesh_.vertex_handle(static_cast<uint32_t>(next.vertex));
            if (mesh_.status(from).deleted() || versions_[next.vertex] != next.version) continue;
            const double distance = collapse(from, mesh_.halfedge_handle(static_cast<uint32_t>(next.halfedge)));
            reached = std::max(reached, distance);
        }
        return reached;
    }

  private:
    using Quadric = OpenMesh::Geometry::Quadricd;
    struct Candidate {
        double cost = 0;
        size_t vertex = 0, halfedge = 0;
        uint32_t version = 0;
        bool operator<(const Candidate& o) const { return cost != o.cost ? cost > o.cost : vertex > o.vertex; }
    };

    Point3 point(Mesh::VertexHandle v) const { return {mesh_.point(v)[0], mesh_.point(v)[1], mesh_.point(v)[2]}; }

    Triangle3 triangle(Mesh::FaceHandle face, Mesh::VertexHandle moved, Mesh::VertexHandle to) const {
        Triangle3 out{};
        size_t k = 0;
        for (const auto vertex : mesh_.fv_range(face))
            out[k++] = point(vertex == moved ? to : Mesh::VertexHandle(vertex));
        return out;
    }

    void add_face_quadric(Mesh::FaceHandle face) {
        const OpenMesh::Vec3d n = mesh_.calc_face_normal(face);
        const auto first = *mesh_.cfv_iter(face);
        const Quadric plane(n[0], n[1], n[2], -(n | mesh_.point(first)));
        for (const auto vertex : mesh_.fv_range(face)) quadrics_[static_cast<size_t>(vertex.idx())] += plane;
    }

    /// Queues the cheapest collapse of a vertex that may move.
    void push(Mesh::VertexHandle vertex) {
        const auto at = static_cast<size_t>(vertex.idx());
        ++versions_[at];
        if (mesh_.status(vertex).deleted() || mesh_.status(vertex).locked()) return;
        Candidate best;
        bool found = false;
        for (const auto halfedge : mesh_.voh_range(vertex)) {
            Quadric sum = quadrics_[at];
            const auto to = mesh_.to_vertex_handle(halfedge);
            sum += quadrics_[static_cast<size_t>(to.idx())];
            const double cost = sum(mesh_.point(to));
            if ((found && cost >= best.cost) || !mesh_.is_collapse_ok(halfedge) || turns_a_face(vertex, to)) continue;
            best = {cost, at, static_cast<size_t>(halfedge.idx()), versions_[at]};
            found = true;
        }
        if (found && best.cost <= limit_ * limit_ * 16) queue_.push(best);
    }

    static OpenMesh::Vec3d normal(const Triangle3& t) {
        const OpenMesh::Vec3d a(t[0][0], t[0][1], t[0][2]), b(t[1][0], t[1][1], t[1][2]), c(t[2][0], t[2][1], t[2][2]);
        return (b - a) % (c - a);
    }

    bool turns_a_face(Mesh::VertexHandle from, Mesh::VertexHandle to) const {
        for (const auto face : mesh_.vf_range(from)) {
            if (has(face, to)) continue;
            const OpenMesh::Vec3d before = normal(triangle(face, from, from)), after = normal(triangle(face, from, to));
            if ((before | after) < kLeastNormalCosine * before.norm() * after.norm() || after.norm() <= 0) return true;
        }
        return false;
    }

    bool has(Mesh::FaceHandle face, Mesh::VertexHandle vertex) const {
        for (const auto corner : mesh_.fv_range(face)) {
            if (corner == vertex) return true;
        }
        return false;
    }

    /// Collapses when the points stay near enough; returns their greatest distance, or -1.
    double collapse(Mesh::VertexHandle from, Mesh::HalfedgeHandle halfedge) {
        const auto to = mesh_.to_vertex_handle(halfedge);
        if (!mesh_.is_collapse_ok(halfedge) || turns_a_face(from, to)) return -1;
        std::vector<Mesh::FaceHandle> kept;
        std::vector<Triangle3> after;
        std::vector<Point3> points = {point(from)};
        std::vector<Mesh::VertexHandle> ring;
        for (const auto face : mesh_.vf_range(from)) {
            const auto& attached = points_[static_cast<size_t>(face.idx())];
            points.insert(points.end(), attached.begin(), attached.end());
            if (has(face, to)) continue;
            kept.push_back(face);
            after.push_back(triangle(face, from, to));
        }
        for (const auto neighbour : mesh_.vv_range(from)) ring.push_back(neighbour);
        std::vector<size_t> nearest(points.size());
        double worst = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            double best = 1e300;
            for (size_t t = 0; t < after.size(); ++t) {
                const double d = squared_distance(points[i], after[t]);
                if (d < best) {
                    best = d;
                    nearest[i] = t;
                }
            }
            worst = std::max(worst, best);
            if (worst > limit_ * limit_) return -1;
        }
        quadrics_[static_cast<size_t>(to.idx())] += quadrics_[static_cast<size_t>(from.idx())];
        mesh_.collapse(halfedge);
        for (const auto face : kept) points_[static_cast<size_t>(face.idx())].clear();
        for (size_t i = 0; i < points.size(); ++i)
            points_[static_cast<size_t>(kept[nearest[i]].idx())].push_back(points[i]);
        for (const auto neighbour : ring) push(neighbour);
        return std::sqrt(worst);
    }

    Mesh& mesh_;
    double limit_;
    std::vector<Quadric> quadrics_;
    std::vector<uint32_t> versions_;
    std::vector<std::vector<Point3>> points_;  // removed ones, by face
    std::priority_queue<Candidate> queue_;
};

}  // namespace

void decimate(BuildObject& object, double allowed) {
    if (allowed <= 0) return;
    silence_openmesh();
    WedgeMesh simplified;
    build(object, simplified);
    Mesh& mesh = simplified.mesh;
    for (const auto vertex : mesh.vertices()) {
        if (mesh.is_boundary(vertex)) mesh.status(vertex).set_locked(true);
    }
    const double reached = Collapser(mesh, allowed).run();
    if (reached < 0) return;
    take_back(simplified, object);
    object.error += static_cast<float>(reached);
}

}  // namespace citystream::tiles::layers
