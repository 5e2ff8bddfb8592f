#include "tiles/layers/relief_extraction_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "codec/facade/facade_ray.h"

namespace citystream::tiles::layers::relief {
namespace {

constexpr double kPixelMetres = 0.1;
constexpr double kSameMetres = 0.06;  // along a ray: a side may stand a stair aside
constexpr double kSamePlaneMetres = 0.003;
constexpr int kSameColour = 20;         // levels of 255 of a channel
constexpr double kSameWay = 0.5;        // cosine between normals
constexpr double kEdgeOn = 0.02;        // parts thinner than this against the view are not drawn
constexpr double kStartMetres = 4;      // before the wall's plane
constexpr double kInsideTexels = 0.25;  // behind a side: bars of one texel exist
/// Degrees from the wall's normal: across, and from below.
constexpr std::array<std::array<double, 2>, 9> kDirections = {
    {{0, 0}, {-30, 10}, {30, 10}, {-55, 25}, {55, 25}, {-72, 12}, {72, 12}, {5, 50}, {-5, -35}}};

/// Places of the views' pixels within them, so that together they look at many places.
double offset_of(size_t view, double step) {
    constexpr double kFirst = 0.3719;  // models like whole decimetres: their edges are neither here nor there
    const double at = kFirst + static_cast<double>(view) * step;
    return at - std::floor(at);
}

bool shares_colour(const city::Material& a, const city::Material& b) {
    for (size_t k = 0; k < 3; ++k) {
        if (std::abs(int{a.rgb[k]} - int{b.rgb[k]}) > kSameColour) return false;
    }
    return true;
}

/// Along a row of pixels, the part between its sheared edges.
std::array<double, 2> row_span(const std::array<Point, 3>& corner, double v) {
    double left = 1e300, right = -1e300;
    for (size_t k = 0; k < 3; ++k) {
        const Point &p = corner[k], &q = corner[(k + 1) % 3];
        if (v < std::min(p.v, q.v) || v > std::max(p.v, q.v) || p.v == q.v) continue;
        const double u = p.u + (v - p.v) / (q.v - p.v) * (q.u - p.u);
        left = std::min(left, u);
        right = std::max(right, u);
    }
    return {left, right};
}

}  // namespace

/// Positive for a part that is seen from its front.
double WallViews::facing(const Direction& direction, uint32_t part) const {
    const Point& n = facade_.parts[part].normal;
    return n.w - direction.across * n.u - direction.up * n.v;
}

/// The front-most part; of two in one plane the one that faces the view, then the one of the smaller patch.
void WallViews::put(const Direction& direction, Seen& pixel, uint32_t part, double w) const {
    if (pixel.part != kNone && w < pixel.w - kSamePlaneMetres) return;
    if (pixel.part != kNone && w < pixel.w + kSamePlaneMetres) {
        const bool has_front = facing(direction, pixel.part) > 0, is_front = facing(direction, part) > 0;
        if (has_front != is_front ? has_front : area_of(pixel.part) <= area_of(part)) return;
    }
    pixel = {w, part};
}

double WallViews::area_of(uint32_t part) const {
    const Part& p = facade_.parts[part];
    return p.patch == kNone ? p.area : facade_.patches[p.patch].area;
}

void WallViews::draw_part(const Direction& direction, uint32_t index, std::vector<Seen>& picture) const {
    const Part& part = facade_.parts[index];
    const size_t view = static_cast<size_t>(&direction - directions_.data());
    const double front = facing(direction, index);
    if (std::abs(front) < kEdgeOn) return;
    std::array<Point, 3> corner;
    const double right = offset_of(view, std::numbers::phi), above = offset_of(view, std::numbers::sqrt2);
    for (size_t k = 0; k < 3; ++k) {
        const Point& p = part.corner[k];
        corner[k] = {(p.u + direction.across * p.w) / kPixelMetres - right,
                     (p.v + direction.up * p.w) / kPixelMetres - above, p.w};
    }
    const auto first = [](double at) { return static_cast<size_t>(std::max(0.0, std::ceil(at))); };
    const auto end = [](double at, size_t count) {
        return static_cast<size_t>(std::clamp(std::floor(at) + 1, 0.0, static_cast<double>(count)));
    };
    const Point& a = corner[0];
    const double by_u = -part.normal.u / front * kPixelMetres, by_v = -part.normal.v / front * kPixelMetres;
    const size_t last_row = end(std::max({corner[0].v, corner[1].v, corner[2].v}), rows_);
    for (size_t row = first(std::min({corner[0].v, corner[1].v, corner[2].v})); row < last_row; ++row) {
        const double v = static_cast<double>(row);
        const auto [from, to] = row_span(corner, v);
        if (!(from <= to)) continue;
        const size_t last = end(to, columns_);
        for (size_t column = first(from); column < last; ++column) {
            const double w = a.w + by_u * (static_cast<double>(column) - a.u) + by_v * (v - a.v);
            put(direction, picture[row * columns_ + column], index, w);
        }
    }
}

template <typename Use>
std::vector<WallViews::Seen> WallViews::draw(const Direction& direction, const Use& use) const {
    std::vector<Seen> picture(columns_ * rows_);
    for (uint32_t i = 0; i < facade_.parts.size(); ++i) {
        if (facade_.parts[i].kind != PartKind::kSpeck && use(i)) draw_part(direction, i, picture);
    }
    return picture;
}

WallViews::WallViews(const WallFrame& frame, const FacadeParts& facade, std::span<const uint8_t> taken,
                     const city::CityCatalog& catalog)
    : frame_(frame), facade_(facade), taken_(taken), catalog_(catalog) {
    columns_ = static_cast<size_t>(std::ceil(frame.width / kPixelMetres));
    rows_ = static_cast<size_t>(std::ceil(frame.height / kPixelMetres));
    for (const auto& [across, up] : kDirections) {
        const auto slope = [](double degrees) { return std::tan(degrees * std::numbers::pi / 180); };
        directions_.push_back({slope(across), slope(up)});
    }
    for (const Direction& direction : directions_) before_.push_back(draw(direction, [](uint32_t) { return true; }));
}

bool WallViews::is_alike(uint32_t index, uint32_t material, const Point& normal) const {
    const Part& part = facade_.parts[index];
    return !part.patterned && dot(part.normal, normal) >= kSameWay &&
           (part.look == material || shares_colour(catalog_.materials[part.look], catalog_.materials[material]));
}

bool WallViews::is_wrong(const Seen& before, const Seen& after, const Relief& relief) const {
    const bool shows_relief = shows(relief, after);
    if (shows_relief && before.part != kNone)
        return std::abs(before.w - relief.w) > kSameMetres || !is_alike(before.part, relief.material, relief.normal);
    if (shows_relief || before.part == kNone || after.part == kNone) return shows_relief || before.part != after.part;
    if (before.part == after.part) return false;
    const Part& part = facade_.parts[after.part];
    return std::abs(before.w - after.w) > kSameMetres || !is_alike(before.part, part.look, part.normal);
}

bool WallViews::shows(const Relief& relief, const Seen& after) {
    return relief.material != kNone && (after.part == kNone || relief.w > after.w - kSamePlaneMetres);
}

/// Whose relief a ray judges: what it meets, and what was there before unless that is now hidden.
std::array<uint32_t, 2> WallViews::blamed(const Seen& before, const Seen& after, const Relief& relief) const {
    const uint32_t was = before.part == kNone ? kNone : facade_.parts[before.part].patch;
    if (!shows(relief, after)) return {was, kNone};
    const bool hidden = relief.normal.w == 0 || before.part == kNone || relief.w > before.w + kSamePlaneMetres;
    return {relief.patch, hidden || was == relief.patch ? kNone : was};
}

ViewDifference WallViews::compare(const Decider& decider, const Decision& decision, const ReliefMap& map,
                                  const SlotTable& slots) const {
    ViewDifference sum;
    sum.patch_rays.assign(facade_.patches.size(), 0);
    sum.patch_wrong.assign(facade_.patches.size(), 0);
    const codec::facade::DepthRange depths = map.grid.depths();
    const double across = map.grid.width() / (map.right - map.left), up = map.grid.height() / (map.top - map.bottom);
    const auto cast = [&](const Direction& d, double u, double v) {
        const double from_u = u - d.across * kStartMetres, from_v = v - d.up * kStartMetres;
        const double origin[3] = {(from_u - map.left) * across, (from_v - map.bottom) * up, kStartMetres * 1000};
        const double way[3] = {d.across * across, d.up * up, -1000};
        const auto hit = codec::facade::cast_facade_ray(map.grid, depths, origin, way);
        Relief seen;
        if (!hit.hit) return seen;
        seen.w = kStartMetres - hit.t;
        seen.material = slots.palette.material[codec::facade::material_of(hit.label)];
        (hit.normal_axis == 0 ? seen.normal.u : hit.normal_axis == 1 ? seen.normal.v : seen.normal.w) = hit.normal_sign;
        const double in = kInsideTexels * std::min(1 / across, 1 / up);
        const uint32_t top =
            decider.top_at(from_u + d.across * hit.t - seen.normal.u * in, from_v + d.up * hit.t - seen.normal.v * in);
        if (top != kNone) seen.patch = facade_.parts[top].patch;
        return seen;
    };
    for (size_t view = 0; view < directions_.size(); ++view) {
        const Direction& d = directions_[view];
        const std::vector<Seen> kept =
            draw(d, [&](uint32_t i) { return decision.replaced[i] == 0 && taken_[facade_.parts[i].triangle] == 0; });
        for (size_t i = 0; i < kept.size(); ++i) {
            const Seen& before = before_[view][i];
            if (before.part != kNone && taken_[facade_.parts[before.part].triangle] != 0) continue;
            const double u = (static_cast<double>(i % columns_) + offset_of(view, std::numbers::phi)) * kPixelMetres;
            const double v = (static_cast<double>(i / columns_) + offset_of(view, std::numbers::sqrt2)) * kPixelMetres;
            const Relief relief = cast(d, u, v);
            const bool wrong = is_wrong(before, kept[i], relief);
            ++sum.rays;
            sum.wrong += wrong ? 1 : 0;
            for (const uint32_t patch : blamed(before, kept[i], relief)) {
                if (patch == kNone) continue;
                ++sum.patch_rays[patch];
                sum.patch_wrong[patch] += wrong ? 1 : 0;
            }
        }
    }
    return sum;
}

}  // namespace citystream::tiles::layers::relief
