#include "tiles/city/citygml_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_set>
#include <utility>

namespace citystream::tiles::city {
namespace {

/// References that lead to references: no sane model goes deeper.
constexpr int kMostHops = 4;

std::string lod_text(int lod) {
    return lod < 0 ? std::string("?") : std::to_string(lod);
}

}  // namespace

void GmlDrawer::draw(const GmlFeature& feature, const GmlAppearance& own, const GmlAppearance& model) {
    feature_ = &feature;
    own_ = &own;
    model_ = &model;
    const GmlPart& top = feature.parts.front();
    reading_.see_feature(top.id, fmt::format("{}: line {}", file_, top.line));
    collect_uses();
    bool any = false;
    for (int32_t part = 0; part < static_cast<int32_t>(feature.parts.size()) && !reading_.stopped(); ++part) {
        any = draw_part(part) || any;
    }
    if (any && top.kind == ObjectKind::kBuilding) ++reading_.report.buildings_emitted;
    const bool blamed = !reading_.report.dropped_features.empty() && reading_.report.dropped_features.back() == top.id;
    if (!any && !blamed && !reading_.stopped() && top.type != "CityObjectGroup") {
        reading_.drop(top.id, fmt::format("{} has no geometry that can be drawn", top.type),
                      fmt::format("{}: line {}", file_, top.line));
    }
}

void GmlDrawer::collect_uses() {
    uses_.clear();
    node_by_id_.clear();
    unresolved_ = 0;
    for (int32_t i = 0; i < static_cast<int32_t>(feature_->nodes.size()); ++i) {
        if (!feature_->nodes[i].id.empty()) node_by_id_.try_emplace(feature_->nodes[i].id, i);
    }
    for (uint32_t i = 0; i < feature_->polygons.size(); ++i) uses_.push_back({i, feature_->polygons[i].place});
    constexpr size_t kFreeUses = 1024;
    most_uses_ = 8 * (feature_->polygons.size() + feature_->links.size()) + kFreeUses;
    resolved_ = 0;
    for (const GmlLink& link : feature_->links) resolve(link, link.place, kMostHops);
    std::stable_sort(uses_.begin(), uses_.end(),
                     [](const Use& a, const Use& b) { return a.place.part < b.place.part; });
}

void GmlDrawer::resolve(const GmlLink& link, GmlPlace place, int depth) {
    const auto found = node_by_id_.find(link.target);
    if (found == node_by_id_.end() || depth == 0 || uses_.size() > most_uses_ || ++resolved_ > most_uses_) {
        ++unresolved_;
        return;
    }
    const GmlNode& node = feature_->nodes[found->second];
    const bool turned = place.turned;
    for (uint32_t i = node.first_polygon; i < node.end_polygon && uses_.size() <= most_uses_; ++i) {
        place.turned = turned != (feature_->polygons[i].place.turned != node.turned_outside);
        uses_.push_back({i, place});
    }
    for (uint32_t i = node.first_link; i < node.end_link; ++i) {
        if (&feature_->links[i] == &link) continue;
        place.turned = turned != (feature_->links[i].place.turned != node.turned_outside);
        resolve(feature_->links[i], place, depth - 1);
    }
}

double GmlDrawer::area_of(const std::vector<Use>& uses) const {
    double area = 0;
    std::vector<Corner> ring;
    for (const Use& use : uses) {
        const GmlPolygon& polygon = feature_->polygons[use.polygon];
        if (polygon.first_ring == polygon.end_ring) continue;
        const GmlRing& outer = feature_->rings[polygon.first_ring];
        ring.clear();
        for (uint32_t i = outer.first_point; i < outer.end_point; ++i) ring.push_back({feature_->points[i], {}});
        if (ring.empty()) continue;
        const Vec3 n = newell_normal(ring);
        const double twice = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        if (std::isfinite(twice)) area += twice / 2;
    }
    return area;
}

/// Openings or installations: at the highest LoD up to `lod`, else at the lowest above it (never above a LoD that was
/// asked for).
void GmlDrawer::take_sub_objects(const std::vector<const Use*>& uses, GmlRole role, int lod,
                                 std::vector<Use>& out) const {
    int best = -2, lowest_above = std::numeric_limits<int>::max();
    for (const Use* use : uses) {
        if (use->place.role != role) continue;
        if (use->place.lod <= lod)
            best = std::max<int>(best, use->place.lod);
        else
            lowest_above = std::min<int>(lowest_above, use->place.lod);
    }
    const bool exact = reading_.options.lod.has_value();
    const int take = best > -2 ? best : (exact ? -2 : lowest_above);
    for (const Use* use : uses) {
        if (use->place.role == role && use->place.lod == take) out.push_back(*use);
    }
}

std::vector<GmlDrawer::Use> GmlDrawer::chosen_uses(int32_t part, std::string& lods) const {
    std::vector<const Use*> all;
    std::set<int> main_lods, other_lods;
    const auto before = [](const Use& use, int32_t wanted) { return use.place.part < wanted; };
    for (auto at = std::lower_bound(uses_.begin(), uses_.end(), part, before);
         at != uses_.end() && at->place.part == part; ++at) {
        const Use& use = *at;
        all.push_back(&use);
        const bool main = use.place.role == GmlRole::kBody || use.place.role == GmlRole::kBoundary;
        (main ? main_lods : other_lods).insert(use.place.lod);
    }
    const std::set<int>& candidates = main_lods.empty() ? other_lods : main_lods;
    for (const int lod : candidates) lods += (lods.empty() ? "" : ", ") + lod_text(lod);
    if (candidates.empty()) return {};
    int lod = *candidates.rbegin();
    if (reading_.options.lod) {
        const auto wanted = std::find_if(candidates.begin(), candidates.end(),
                                         [&](int candidate) { return lod_text(candidate) == *reading_.options.lod; });
        if (wanted == candidates.end()) return {};
        lod = *wanted;
    }
    std::vector<Use> body, chosen;
    for (const Use* use : all) {
        if (use->place.lod != lod) continue;
        if (use->place.role == GmlRole::kBody) body.push_back(*use);
        if (use->place.role == GmlRole::kBoundary) chosen.push_back(*use);
    }
    constexpr double kLeastCover = 0.5;
    if (chosen.empty() || area_of(chosen) < kLeastCover * area_of(body)) {
        chosen = std::move(body);
    } else {
        take_sub_objects(all, GmlRole::kOpening, lod, chosen);
        // The solid adds no surfaces, but its shells tell inside from outside.
        std::unordered_set<uint32_t> drawn;
        for (const Use& use : chosen) drawn.insert(use.polygon);
        for (const Use& use : body) {
            if (drawn.contains(use.polygon) && use.place.shell >= 0) chosen.push_back(use);
        }
    }
    take_sub_objects(all, GmlRole::kInstallation, lod, chosen);
    return chosen;
}

/// Draws each polygon once: with the meaning of its most telling use and, when a solid uses it, within the solid's
/// shell.
void GmlDrawer::draw_uses(const std::vector<Use>& uses) {
    const auto rank = [](const Use& use) { return use.place.role == GmlRole::kBody ? 0 : 1; };
    std::unordered_map<uint32_t, size_t> first;  // polygon -> index in `once`
    std::vector<Use> once;
    for (const Use& use : uses) {
        const auto [entry, is_new] = first.try_emplace(use.polygon, once.size());
        if (is_new) {
            once.push_back(use);
            continue;
        }
        Use& kept = once[entry->second];
        if (rank(use) > rank(kept)) {
            kept.place.role = use.place.role;
            kept.place.kind = use.place.kind;
        }
        if (kept.place.shell < 0 && use.place.shell >= 0) {
            kept.place.shell = use.place.shell;
            kept.place.turned = use.place.turned;
        }
    }
    std::stable_sort(once.begin(), once.end(),
                     [](const Use& a, const Use& b) { return a.place.shell < b.place.shell; });
    for (size_t i = 0; i < once.size();) {
        const int32_t shell = once[i].place.shell;
        if (shell >= 0) reading_.builder.begin_shell();
        for (; i < once.size() && once[i].place.shell == shell; ++i) draw_polygon(once[i]);
        if (shell >= 0) reading_.builder.end_shell(feature_->shell_is_cavity[shell] != 0);
    }
}

GmlAppearance::RingLook GmlDrawer::look_of(const std::string& ring_id) const {
    if (ring_id.empty()) return {};
    const auto look = own_->look_of(ring_id);
    return look.texture != nullptr ? look : model_->look_of(ring_id);
}

SurfaceStyle GmlDrawer::style_of(const Use& use, const GmlTexture* texture) {
    SurfaceStyle style;
    style.kind = use.place.kind;
    std::optional<std::array<uint8_t, 3>> colour;
    for (int32_t node = feature_->polygons[use.polygon].place.node; node >= 0 && !colour;
         node = feature_->nodes[node].parent) {
        const std::string& id = feature_->nodes[node].id;
        if (id.empty()) continue;
        colour = own_->colour_of(id);
        if (!colour) colour = model_->colour_of(id);
    }
    if (texture != nullptr) {
        const auto fallback = colour.value_or(default_colour(reading_.builder.kind(), style.kind));
        style.material =
            reading_.materials.textured(file_, texture->uri, texture->repeat, fallback, reading_.builder.id());
        style.textured = style.material.has_value();
    }
    if (!style.material && colour) style.material = reading_.materials.flat(*colour);
    return style;
}

/// Points of a ring, with texture coordinates where there is one for each point; false when there is not.
bool GmlDrawer::add_ring(const GmlRing& ring, const GmlAppearance::RingLook& look) {
    const uint32_t count = ring.end_point - ring.first_point;
    // Coordinates may leave out the closing point.
    const bool matches = look.texture != nullptr && (look.count == count || look.count + 1 == count);
    for (uint32_t i = 0; i < count; ++i) {
        reading_.builder.add_point(feature_->points[ring.first_point + i],
                                   matches ? look.texcoords[i < look.count ? i : 0] : Vec2{});
    }
    reading_.builder.end_ring();
    return matches;
}

void GmlDrawer::draw_polygon(const Use& use) {
    const GmlPolygon& polygon = feature_->polygons[use.polygon];
    const GmlTexture* texture = nullptr;
    bool textured = true;
    reading_.builder.begin_surface();
    for (uint32_t i = polygon.first_ring; i < polygon.end_ring; ++i) {
        const GmlRing& ring = feature_->rings[i];
        const auto look = look_of(ring.id);
        if (i == polygon.first_ring) texture = look.texture;
        const bool matches = add_ring(ring, look);
        textured = textured && matches;
    }
    if (texture != nullptr && !textured) ++mismatched_textures_;
    reading_.builder.end_surface(style_of(use, textured ? texture : nullptr), use.place.turned);
}

bool GmlDrawer::draw_part(int32_t part) {
    const GmlPart& object = feature_->parts[part];
    const std::string where = fmt::format("{}: line {}", file_, object.line);
    std::string lods;
    const std::vector<Use> chosen = chosen_uses(part, lods);
    if (chosen.empty()) {
        if (reading_.options.lod && !lods.empty()) {
            reading_.drop(object.id, fmt::format("no geometry of LoD {} (has {})", *reading_.options.lod, lods), where);
        }
        return false;
    }
    mismatched_textures_ = 0;
    reading_.builder.begin(object.id, object.kind, where);
    BuildingFacts facts = object.facts;
    facts.inherit(feature_->parts[0].facts);
    reading_.builder.set_facts(facts);
    draw_uses(chosen);
    if (part == 0 && unresolved_ > 0)
        reading_.builder.report(fmt::format("{} reference(s) to surfaces that are not in the feature", unresolved_));
    if (mismatched_textures_ > 0) {
        reading_.builder.report(
            fmt::format("{} surface(s) without their texture: not one coordinate per point", mismatched_textures_));
    }
    if (reading_.send()) return true;
    reading_.drop(object.id, fmt::format("{}: none of its surfaces can be drawn", object.type), where);
    return false;
}

}  // namespace citystream::tiles::city
