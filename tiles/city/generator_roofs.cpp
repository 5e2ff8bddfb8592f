#include "tiles/city/generator_roofs.h"

#include <algorithm>

namespace citystream::tiles::city::procedural {
namespace {

/// Local coordinates of one roof to grid points.
class Place {
  public:
    explicit Place(const RoofBase& base) : base_(base) {}
    Point3 operator()(Units x, Units y, Units above) const { return lift(base_.frame.at(x, y), base_.level + above); }

  private:
    const RoofBase& base_;
};

}  // namespace

Units gable_roof(ObjectBuilder& object, const RoofBase& base, const RoofPitch& pitch, const RoofMaterials& materials) {
    const Place at(base);
    const Units w = base.width, d = base.depth, o = pitch.eaves;
    const Units ridge = (d / 2 + o) * pitch.rise / pitch.run;
    object.polygon({at(0, -o, 0), at(w, -o, 0), at(w, d / 2, ridge), at(0, d / 2, ridge)}, materials.roof,
                   SurfaceKind::kRoof);
    object.polygon({at(w, d + o, 0), at(0, d + o, 0), at(0, d / 2, ridge), at(w, d / 2, ridge)}, materials.roof,
                   SurfaceKind::kRoof);
    // Fans from the ridge through the walls' corners, so that no corner lies within a longer edge.
    object.polygon({at(0, d / 2, ridge), at(0, d + o, 0), at(0, d, 0), at(0, 0, 0), at(0, -o, 0)}, materials.wall,
                   SurfaceKind::kWall);
    object.polygon({at(w, d / 2, ridge), at(w, -o, 0), at(w, 0, 0), at(w, d, 0), at(w, d + o, 0)}, materials.wall,
                   SurfaceKind::kWall);
    object.polygon({at(0, -o, 0), at(0, 0, 0), at(w, 0, 0), at(w, -o, 0)}, materials.soffit, SurfaceKind::kRoof);
    object.polygon({at(0, d, 0), at(0, d + o, 0), at(w, d + o, 0), at(w, d, 0)}, materials.soffit, SurfaceKind::kRoof);
    return ridge;
}

Units hip_roof(ObjectBuilder& object, const RoofBase& base, const RoofPitch& pitch, const RoofMaterials& materials) {
    if (base.width < base.depth)
        return hip_roof(object, {base.frame.turned(base.width), base.depth, base.width, base.level}, pitch, materials);
    const Place at(base);
    const Units w = base.width, d = base.depth, o = pitch.eaves;
    const Units ridge = (d / 2 + o) * pitch.rise / pitch.run;
    const Point3 left = at(d / 2, d / 2, ridge), right = at(w - d / 2, d / 2, ridge);
    const std::array<Point3, 4> outer = {at(-o, -o, 0), at(w + o, -o, 0), at(w + o, d + o, 0), at(-o, d + o, 0)};
    const std::array<Point3, 4> inner = {at(0, 0, 0), at(w, 0, 0), at(w, d, 0), at(0, d, 0)};
    object.polygon({outer[0], outer[1], right, left}, materials.roof, SurfaceKind::kRoof);
    object.polygon({outer[1], outer[2], right}, materials.roof, SurfaceKind::kRoof);
    object.polygon({outer[2], outer[3], left, right}, materials.roof, SurfaceKind::kRoof);
    object.polygon({outer[3], outer[0], left}, materials.roof, SurfaceKind::kRoof);
    for (size_t i = 0; i < 4; ++i) {
        const size_t next = (i + 1) % 4;
        object.polygon({outer[i], inner[i], inner[next], outer[next]}, materials.soffit, SurfaceKind::kRoof);
    }
    return ridge;
}

void flat_roof(ObjectBuilder& object, const RoofBase& base, Units drop, const RoofMaterials& materials) {
    const Place at(base);
    const Units w = base.width, d = base.depth, t = kMetre / 4;
    const std::array<Point2, 4> outer = {{{0, 0}, {w, 0}, {w, d}, {0, d}}};
    const std::array<Point2, 4> inner = {{{t, t}, {w - t, t}, {w - t, d - t}, {t, d - t}}};
    const auto point = [&at](Point2 local, Units above) { return at(local.x, local.y, above); };
    for (size_t i = 0; i < 4; ++i) {
        const size_t next = (i + 1) % 4;
        object.polygon({point(outer[i], 0), point(outer[next], 0), point(inner[next], 0), point(inner[i], 0)},
                       materials.coping, SurfaceKind::kRoof);
        object.polygon({point(inner[next], -drop), point(inner[i], -drop), point(inner[i], 0), point(inner[next], 0)},
                       materials.coping, SurfaceKind::kRoof);
    }
    object.polygon({point(inner[0], -drop), point(inner[1], -drop), point(inner[2], -drop), point(inner[3], -drop)},
                   materials.roof, SurfaceKind::kRoof);
}

void sawtooth_roof(ObjectBuilder& object, const RoofBase& base, const RoofMaterials& materials) {
    const Place at(base);
    const Units d = base.depth, rise = 9 * kMetre / 4;
    const Units teeth = std::max<Units>(2, base.width / (8 * kMetre));
    for (Units i = 0; i < teeth; ++i) {
        const Units a = base.width * i / teeth, b = base.width * (i + 1) / teeth;
        object.polygon({at(a, 0, 0), at(b, 0, rise), at(b, d, rise), at(a, d, 0)}, materials.roof, SurfaceKind::kRoof);
        object.polygon({at(b, 0, 0), at(b, d, 0), at(b, d, rise), at(b, 0, rise)}, materials.glass,
                       SurfaceKind::kWindow);
        object.polygon({at(a, 0, 0), at(b, 0, 0), at(b, 0, rise)}, materials.wall, SurfaceKind::kWall);
        object.polygon({at(b, d, 0), at(a, d, 0), at(b, d, rise)}, materials.wall, SurfaceKind::kWall);
    }
}

void box(ObjectBuilder& object, const Frame& frame, Point2 low, Point2 high, Units foot, Units head, uint32_t walls,
         uint32_t top) {
    const std::array<Point2, 4> ring = {frame.at(low.x, low.y), frame.at(high.x, low.y), frame.at(high.x, high.y),
                                        frame.at(low.x, high.y)};
    for (size_t i = 0; i < 4; ++i) object.wall(ring[i], ring[(i + 1) % 4], foot, head, walls);
    object.polygon({lift(ring[0], head), lift(ring[1], head), lift(ring[2], head), lift(ring[3], head)}, top,
                   SurfaceKind::kRoof);
}

void dormer(ObjectBuilder& object, const RoofBase& base, const RoofPitch& pitch, Units x,
            const RoofMaterials& materials) {
    const Place at(base);
    const auto roof_at = [&pitch](Units y) { return (y + pitch.eaves) * pitch.rise / pitch.run; };
    const Units front = kMetre, foot = roof_at(front), head = foot + 3 * kMetre / 2;
    const Units back = head * pitch.run / pitch.rise - pitch.eaves;
    if (back >= base.depth / 2) return;
    const Units half = 7 * kMetre / 8, jamb = kMetre / 4;
    const auto panel = [&](Units left, Units right, uint32_t material, SurfaceKind surface) {
        object.polygon({at(left, front, foot), at(right, front, foot), at(right, front, head), at(left, front, head)},
                       material, surface);
    };
    panel(x - half, x - half + jamb, materials.soffit, SurfaceKind::kWall);
    panel(x - half + jamb, x + half - jamb, materials.glass, SurfaceKind::kWindow);
    panel(x + half - jamb, x + half, materials.soffit, SurfaceKind::kWall);
    object.polygon({at(x + half, front, foot), at(x + half, back, head), at(x + half, front, head)}, materials.roof,
                   SurfaceKind::kWall);
    object.polygon({at(x - half, front, foot), at(x - half, front, head), at(x - half, back, head)}, materials.roof,
                   SurfaceKind::kWall);
    object.polygon(
        {at(x - half, front, head), at(x + half, front, head), at(x + half, back, head), at(x - half, back, head)},
        materials.coping, SurfaceKind::kRoof);
}

}  // namespace citystream::tiles::city::procedural
