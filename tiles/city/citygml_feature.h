// One top-level CityGML feature, gathered from its elements: parts, surfaces with their roles and LoDs, references
// between them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tiles/city/city_model.h"
#include "tiles/city/xml_stream.h"

namespace citystream::tiles::city {

/// What a surface is to its part.
enum class GmlRole : uint8_t { kBody, kBoundary, kOpening, kInstallation };

/// A city object that becomes one CityObject: the feature itself, or one of its parts.
struct GmlPart {
    std::string id, type;
    ObjectKind kind = ObjectKind::kOther;
    uint64_t line = 0;
    BuildingFacts facts;
};

/// Where in the feature an element stands. -1: nowhere of that sort.
struct GmlPlace {
    int32_t part = -1;
    int32_t node = -1;   ///< innermost geometry with an id of its own
    int32_t shell = -1;  ///< of a solid
    int8_t lod = -1;
    GmlRole role = GmlRole::kBody;
    SurfaceKind kind = SurfaceKind::kUnknown;
    bool turned = false;  ///< an odd number of OrientableSurfaces with "-" around it
};

struct GmlRing {
    uint32_t first_point = 0, end_point = 0;
    std::string id;
};

struct GmlPolygon {
    GmlPlace place;
    uint32_t first_ring = 0, end_ring = 0;
};

/// A reference to a geometry by id, standing for it.
struct GmlLink {
    GmlPlace place;
    std::string target;
};

/// A geometry element: its polygons and links are contiguous.
struct GmlNode {
    std::string id;
    int32_t parent = -1;
    bool turned_outside = false;  ///< GmlPlace::turned just outside of it
    uint32_t first_polygon = 0, end_polygon = 0;
    uint32_t first_link = 0, end_link = 0;
};

struct GmlFeature {
    std::vector<GmlPart> parts;  ///< the feature itself first
    std::vector<GmlPolygon> polygons;
    std::vector<GmlRing> rings;
    std::vector<GmlNode> nodes;
    std::vector<GmlLink> links;
    std::vector<uint8_t> shell_is_cavity;
    std::vector<Vec3> points;

    void clear();
    /// Rough measure of what it holds, to stop hostile files.
    size_t weight() const {
        return points.size() + 4 * (rings.size() + polygons.size() + nodes.size() + links.size() + parts.size());
    }
};

/// Fills a GmlFeature from the elements inside (and including) the feature's own element.
class GmlFeatureParser {
  public:
    static constexpr size_t kMostWeight = size_t{1} << 25;

    explicit GmlFeatureParser(GmlFeature& feature) : feature_(feature) {}

    void begin_feature();
    /// True: the text of this element is wanted at end().
    bool start(std::string_view name, const XmlAttributes& attributes, uint64_t line);
    void end(std::string_view name, const std::string& text);
    bool inside() const { return !stack_.empty(); }
    bool too_large() const { return feature_.weight() > kMostWeight; }

    /// What was met and is not drawn, with counts, over all features.
    const std::map<std::string, uint64_t>& unsupported() const { return unsupported_; }

  private:
    enum class Around : uint8_t { kNone, kSolid, kPolygon, kRing };
    struct Level {
        GmlPlace place;
        Around around = Around::kNone;
        int32_t dimension = 3;
        bool skipped = false;
    };

    void start_object(std::string_view name, const XmlAttributes& attributes, uint64_t line, Level& level);
    bool start_geometry(std::string_view name, const XmlAttributes& attributes, Level& level);
    void start_property(std::string_view name, const XmlAttributes& attributes, Level& level);
    bool starts_part(std::string_view name) const;
    void start_part(std::string_view name, const XmlAttributes& attributes, uint64_t line, Level& level);
    void add_node(const XmlAttributes& attributes, Level& level);
    void end_ring();
    void add_points(const std::string& text);

    GmlFeature& feature_;
    std::vector<Level> stack_;
    std::vector<double> numbers_;  ///< of the ring in hand
    std::map<std::string, uint64_t> unsupported_;
};

}  // namespace citystream::tiles::city
