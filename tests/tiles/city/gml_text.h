// Pieces of CityGML for tests.
#pragma once

#include <string>

namespace citystream::tiles::city {

inline std::string gml_model(const std::string& members, const std::string& version = "2.0",
                             const std::string& srs = "EPSG:25832") {
    return R"(<?xml version="1.0"?><core:CityModel xmlns:core="http://www.opengis.net/citygml/)" + version +
           R"(" xmlns:gml="g" xmlns:bldg="b" xmlns:con="c" xmlns:app="a" xmlns:xlink="x" xmlns:tran="t" xmlns:dem="d" xmlns:veg="v" xmlns:gen="n">)" +
           R"(<gml:boundedBy><gml:Envelope srsName=")" + srs +
           R"("><gml:lowerCorner>0 0 0</gml:lowerCorner></gml:Envelope></gml:boundedBy>)" + members +
           "</core:CityModel>\n";
}

inline std::string gml_member(const std::string& object) {
    return "<core:cityObjectMember>" + object + "</core:cityObjectMember>\n";
}

inline std::string gml_building(const std::string& inside, const std::string& id = "B") {
    return gml_member("<bldg:Building gml:id=\"" + id + "\">" + inside + "</bldg:Building>");
}

inline std::string gml_ring(const std::string& points, const std::string& id = "") {
    return "<gml:LinearRing" + (id.empty() ? std::string() : " gml:id=\"" + id + "\"") + "><gml:posList>" + points +
           "</gml:posList></gml:LinearRing>";
}

inline std::string gml_polygon(const std::string& points, const std::string& id = "", const std::string& holes = "") {
    const std::string name = id.empty() ? std::string() : " gml:id=\"" + id + "\"",
                      ring = id.empty() ? std::string() : id + "_r";
    return "<gml:Polygon" + name + "><gml:exterior>" + gml_ring(points, ring) + "</gml:exterior>" + holes +
           "</gml:Polygon>";
}

inline std::string gml_surface_member(const std::string& polygon) {
    return "<gml:surfaceMember>" + polygon + "</gml:surfaceMember>";
}
inline std::string gml_reference(const std::string& id) {
    return "<gml:surfaceMember xlink:href=\"#" + id + "\"/>";
}

inline std::string gml_multi_surface(const std::string& property, const std::string& members) {
    return "<bldg:" + property + "><gml:MultiSurface>" + members + "</gml:MultiSurface></bldg:" + property + ">";
}

inline std::string gml_solid(const std::string& members, const std::string& property = "lod2Solid") {
    return "<bldg:" + property + "><gml:Solid><gml:exterior><gml:CompositeSurface>" + members +
           "</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:" + property + ">";
}

inline std::string gml_boundary(const std::string& type, const std::string& polygon, const std::string& more = "",
                                const std::string& lod = "2") {
    return "<bldg:boundedBy><bldg:" + type + ">" +
           gml_multi_surface("lod" + lod + "MultiSurface", gml_surface_member(polygon)) + more + "</bldg:" + type +
           "></bldg:boundedBy>";
}

/// Squares of 4 m, closed rings.
constexpr const char* kFloorPoints = "0 0 0 0 4 0 4 4 0 4 0 0 0 0 0";
constexpr const char* kRoofPoints = "0 0 4 4 0 4 4 4 4 0 4 4 0 0 4";
constexpr const char* kSouthPoints = "0 0 0 4 0 0 4 0 4 0 0 4 0 0 0";
constexpr const char* kEastPoints = "4 0 0 4 4 0 4 4 4 4 0 4 4 0 0";
constexpr const char* kNorthPoints = "4 4 0 0 4 0 0 4 4 4 4 4 4 4 0";
constexpr const char* kWestPoints = "0 4 0 0 0 0 0 0 4 0 4 4 0 4 0";

}  // namespace citystream::tiles::city
