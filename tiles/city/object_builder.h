// Collects the polygons of one city object, repairs them, and makes the CityObject. What both readers feed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tiles/city/city_model.h"
#include "tiles/city/surface_colours.h"
#include "tiles/city/triangulate.h"
#include "tiles/city/vertex_welder.h"

namespace citystream::tiles::city {

/// How a surface is to look. Without material it gets the default colour of its kind.
struct SurfaceStyle {
    std::optional<uint32_t> material;
    SurfaceKind kind = SurfaceKind::kUnknown;
    bool textured = false;  ///< the material has an image, the points have texture coordinates
};

/// Call order: begin, then surfaces (begin_surface, rings of points, end_surface), optionally between begin_shell and
/// end_shell, then finish.
///
/// Repairs, each reported once per object with its id and a count: repeated neighbouring points are dropped; holes of
/// fewer than three points are skipped; shells of solids that are inside out, or whose surfaces disagree, are turned
/// (shell_orientation.h). A last point that closes its ring is dropped without a word. Skipped and reported: surfaces
/// with fewer than three distinct points, without area, with coordinates that are no finite number or beyond
/// kMostMetres, or that the tessellator cannot split. Surfaces that cross themselves are split by the odd-even rule and
/// reported. Surfaces of buildings without semantics are told apart by their normal: up is roof, down at the foot is
/// ground, else wall.
class ObjectBuilder {
  public:
    static constexpr double kMostMetres = 1e9;
    /// Of one object; instances of a large template could otherwise fill the memory.
    static constexpr size_t kMostTriangles = size_t{1} << 23;

    ObjectBuilder(MaterialTable& materials, CityReport& report) : materials_(materials), report_(report) {}

    void begin(std::string id, ObjectKind kind, std::string where);
    void set_facts(const BuildingFacts& facts) { object_.facts = facts; }

    void begin_surface() {
        corners_.clear();
        ring_ends_.clear();
    }
    void add_point(const Vec3& position, const Vec2& texcoord = {}) { corners_.push_back({position, texcoord}); }
    void end_ring() { ring_ends_.push_back(static_cast<uint32_t>(corners_.size())); }
    /// Turns the surface round before it is used (references with orientation "-").
    void end_surface(const SurfaceStyle& style, bool turned = false);

    /// Surfaces until end_shell bound a volume: from outside, or (`cavity`) a hole inside it.
    void begin_shell() { shell_begin_ = object_.triangles.size(); }
    void end_shell(bool cavity);

    /// A defect of the object in hand.
    void report(const std::string& what);
    const std::string& id() const { return object_.id; }
    ObjectKind kind() const { return object_.kind; }

    /// The object, or nothing when no triangle came out of it (the caller reports that).
    std::optional<CityObject> finish();

  private:
    bool coordinates_are_sane() const;
    void drop_repeated_points();
    bool keep_real_rings();
    void turn_surface();
    void add_triangles(const SurfaceStyle& style);
    void infer_kinds();
    void report_counts();

    MaterialTable& materials_;
    CityReport& report_;
    Triangulator triangulator_;
    VertexWelder welder_;
    CityObject object_;
    std::string where_;
    std::vector<Corner> corners_, kept_;
    std::vector<uint32_t> ring_ends_;
    std::vector<std::array<uint32_t, 3>> triangles_;
    size_t shell_begin_ = 0;

    struct Counts {
        uint64_t repeated_points = 0, short_holes = 0, short_rings = 0, degenerate = 0, wild = 0, crossing = 0,
                 tangled = 0, failed = 0, turned_shells = 0, straightened_shells = 0, beyond_limit = 0;
    };
    Counts counts_;
};

}  // namespace citystream::tiles::city
