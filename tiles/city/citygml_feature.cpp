#include "tiles/city/citygml_feature.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "tiles/city/number_text.h"
#include "tiles/city/surface_kinds.h"

namespace citystream::tiles::city {
namespace {

template <size_t N>
bool is_one_of(std::string_view name, const std::array<std::string_view, N>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_interior(std::string_view name) {
    constexpr std::array<std::string_view, 9> kNames = {"Room",
                                                        "BuildingRoom",
                                                        "IntBuildingInstallation",
                                                        "BuildingFurniture",
                                                        "IntBridgeInstallation",
                                                        "BridgeRoom",
                                                        "BridgeFurniture",
                                                        "HollowSpace",
                                                        "Storey"};
    return is_one_of(name, kNames);
}

bool is_polygon(std::string_view name) {
    constexpr std::array<std::string_view, 4> kNames = {"Polygon", "PolygonPatch", "Triangle", "Rectangle"};
    return is_one_of(name, kNames);
}

bool is_aggregate(std::string_view name) {
    constexpr std::array<std::string_view, 14> kNames = {"MultiSurface",
                                                         "CompositeSurface",
                                                         "OrientableSurface",
                                                         "MultiGeometry",
                                                         "MultiSolid",
                                                         "CompositeSolid",
                                                         "Solid",
                                                         "Shell",
                                                         "Surface",
                                                         "TriangulatedSurface",
                                                         "Tin",
                                                         "PolyhedralSurface",
                                                         "GeometricComplex",
                                                         "MultiPolygon"};
    return is_one_of(name, kNames);
}

bool is_member_property(std::string_view name) {
    constexpr std::array<std::string_view, 8> kNames = {"surfaceMember", "geometryMember", "solidMember",
                                                        "baseSurface",   "exterior",       "interior",
                                                        "polygonMember", "shellMember"};
    return is_one_of(name, kNames);
}

/// Thematic surfaces: a role of their own. The rest of the object types is transparent.
bool is_boundary(std::string_view name) {
    constexpr std::array<std::string_view, 5> kAreas = {"TrafficArea", "AuxiliaryTrafficArea", "Marking", "HoleSurface",
                                                        "TINRelief"};
    constexpr std::string_view kSuffix = "Surface";
    return is_one_of(name, kAreas) || (name.size() > kSuffix.size() && name.ends_with(kSuffix));
}

bool is_installation(std::string_view name) {
    return name.ends_with("Installation") || name.ends_with("ConstructiveElement") ||
           name.ends_with("ConstructionElement");
}

/// "lod2MultiSurface" -> 2; -1 when the name is none of these.
int lod_of_property(std::string_view name) {
    if (name.size() < 5 || !name.starts_with("lod") || name[3] < '0' || name[3] > '4') return -1;
    return name[3] - '0';
}

/// A property of a part itself, not of a surface or an installation of it.
bool is_fact_of_part(std::string_view name, const GmlPlace& place) {
    return place.part >= 0 && place.role == GmlRole::kBody && is_building_fact(name);
}

int32_t dimension_of(const XmlAttributes& attributes, int32_t inherited) {
    const std::string_view text = attributes["srsDimension"];
    int32_t value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return code == std::errc() && (value == 2 || value == 3) ? value : inherited;
}

}  // namespace

void GmlFeature::clear() {
    parts.clear();
    polygons.clear();
    rings.clear();
    nodes.clear();
    links.clear();
    shell_is_cavity.clear();
    points.clear();
}

void GmlFeatureParser::begin_feature() {
    feature_.clear();
    stack_.clear();
    numbers_.clear();
}

bool GmlFeatureParser::start(std::string_view name, const XmlAttributes& attributes, uint64_t line) {
    Level level = stack_.empty() ? Level{} : stack_.back();
    const bool top = stack_.empty();
    bool text = false;
    if (!level.skipped) {
        level.dimension = dimension_of(attributes, level.dimension);
        if (top || starts_part(name)) {
            start_part(name, attributes, line, level);
        } else if (name == "posList" || name == "pos" || name == "coordinates") {
            text = level.around == Around::kRing;
        } else if (!name.empty() && name[0] >= 'A' && name[0] <= 'Z') {
            if (!start_geometry(name, attributes, level)) start_object(name, attributes, line, level);
        } else {
            start_property(name, attributes, level);
            text = is_fact_of_part(name, level.place);
        }
    }
    stack_.push_back(level);
    return text;
}

bool GmlFeatureParser::starts_part(std::string_view name) const {
    constexpr std::array<std::string_view, 5> kParts = {"BuildingPart", "BridgePart", "TunnelPart", "Building",
                                                        "Bridge"};
    return is_one_of(name, kParts);
}

void GmlFeatureParser::start_part(std::string_view name, const XmlAttributes& attributes, uint64_t line, Level& level) {
    std::string id(attributes["id"]);
    if (id.empty()) id = std::string(name) + " at line " + std::to_string(line);
    level = {};
    level.place.part = static_cast<int32_t>(feature_.parts.size());
    feature_.parts.push_back({std::move(id), std::string(name), object_kind(name), line, {}});
}

void GmlFeatureParser::start_object(std::string_view name, const XmlAttributes&, uint64_t, Level& level) {
    GmlPlace& place = level.place;
    if (is_interior(name) || name == "ImplicitGeometry" || (is_boundary(name) && !surface_kind(name))) {
        ++unsupported_[std::string(name)];
        level.skipped = true;
    } else if (name == "Window" || name == "Door" || name == "WindowSurface" || name == "DoorSurface") {
        place.role = GmlRole::kOpening;
        place.kind = *surface_kind(name);
        place.lod = -1;
    } else if (is_installation(name)) {
        place.role = GmlRole::kInstallation;
        place.kind = SurfaceKind::kInstallation;
        place.lod = -1;
    } else if (is_boundary(name)) {
        const SurfaceKind kind = *surface_kind(name);
        const bool of_installation = place.role == GmlRole::kInstallation;
        if (!of_installation) place.role = GmlRole::kBoundary;
        if (!of_installation || kind != SurfaceKind::kUnknown) place.kind = kind;
        place.lod = -1;
    }
}

void GmlFeatureParser::add_node(const XmlAttributes& attributes, Level& level) {
    GmlNode node;
    node.id = attributes["id"];
    node.parent = level.place.node;
    node.turned_outside = level.place.turned;
    node.first_polygon = node.end_polygon = static_cast<uint32_t>(feature_.polygons.size());
    node.first_link = node.end_link = static_cast<uint32_t>(feature_.links.size());
    level.place.node = static_cast<int32_t>(feature_.nodes.size());
    feature_.nodes.push_back(std::move(node));
}

bool GmlFeatureParser::start_geometry(std::string_view name, const XmlAttributes& attributes, Level& level) {
    if (is_polygon(name)) {
        add_node(attributes, level);
        const auto ring = static_cast<uint32_t>(feature_.rings.size());
        feature_.polygons.push_back({level.place, ring, ring});
        level.around = Around::kPolygon;
        return true;
    }
    if (name == "LinearRing" || name == "Ring") {
        if (level.around != Around::kPolygon || feature_.polygons.empty()) return true;
        level.around = Around::kRing;
        const auto point = static_cast<uint32_t>(feature_.points.size());
        feature_.rings.push_back({point, point, std::string(attributes["id"])});
        numbers_.clear();
        return true;
    }
    if (!is_aggregate(name)) return false;
    add_node(attributes, level);
    level.around = name == "Solid" ? Around::kSolid : Around::kNone;
    if (name == "OrientableSurface" && attributes["orientation"] == "-") level.place.turned = !level.place.turned;
    return true;
}

void GmlFeatureParser::start_property(std::string_view name, const XmlAttributes& attributes, Level& level) {
    const int lod = lod_of_property(name);
    if (lod >= 0) level.place.lod = static_cast<int8_t>(lod);
    if (name == "tin" && level.place.lod < 0) level.place.lod = 1;
    if ((name == "exterior" || name == "interior") && level.around == Around::kSolid) {
        level.place.shell = static_cast<int32_t>(feature_.shell_is_cavity.size());
        feature_.shell_is_cavity.push_back(name == "interior" ? 1 : 0);
        level.around = Around::kNone;
    }
    const std::string_view href = attributes["href"];
    if (href.empty() || level.place.part < 0 || !(lod >= 0 || is_member_property(name))) return;
    const size_t hash = href.find('#');
    feature_.links.push_back({level.place, std::string(hash == std::string_view::npos ? href : href.substr(hash + 1))});
}

void GmlFeatureParser::add_points(const std::string& text) {
    const bool flat = stack_.back().dimension == 2;
    for_each_number(text, [&](double value) {
        numbers_.push_back(value);
        if (flat && numbers_.size() % 3 == 2) numbers_.push_back(0);
    });
}

void GmlFeatureParser::end_ring() {
    GmlRing& ring = feature_.rings.back();
    for (size_t i = 0; i + 2 < numbers_.size(); i += 3)
        feature_.points.push_back({numbers_[i], numbers_[i + 1], numbers_[i + 2]});
    // A number left over means that the whole list is out of step.
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (numbers_.size() % 3 != 0) feature_.points.push_back({kNone, kNone, kNone});
    ring.end_point = static_cast<uint32_t>(feature_.points.size());
    GmlPolygon& polygon = feature_.polygons.back();
    polygon.end_ring = static_cast<uint32_t>(feature_.rings.size());
    numbers_.clear();
}

void GmlFeatureParser::end(std::string_view name, const std::string& text) {
    const Level level = stack_.back();
    if (!level.skipped) {
        const bool coordinates = name == "posList" || name == "pos" || name == "coordinates";
        if (coordinates && level.around == Around::kRing) add_points(text);
        if (is_fact_of_part(name, level.place))
            note_building_fact(feature_.parts[static_cast<size_t>(level.place.part)].facts, name, text);
        if ((name == "LinearRing" || name == "Ring") && level.around == Around::kRing) end_ring();
        const int32_t outer = stack_.size() > 1 ? stack_[stack_.size() - 2].place.node : -1;
        if (level.place.node >= 0 && level.place.node != outer) {
            GmlNode& node = feature_.nodes[level.place.node];
            node.end_polygon = static_cast<uint32_t>(feature_.polygons.size());
            node.end_link = static_cast<uint32_t>(feature_.links.size());
        }
    }
    stack_.pop_back();
}

}  // namespace citystream::tiles::city
