// One CityJSON geometry -> surfaces of the object in the builder.
#pragma once

#include <simdjson.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tiles/city/city_reading.h"
#include "tiles/city/cityjson_appearance.h"

namespace citystream::tiles::city {

/// What geometries refer to: of the document, or of the feature in a sequence. A coordinate that is no number is NaN.
struct JsonPools {
    std::vector<Vec3> vertices;
    JsonAppearance appearance;
};

/// Geometry templates with their own vertices and the document's appearance.
struct JsonTemplates {
    std::vector<simdjson::dom::element> geometries;
    JsonPools pools;
};

/// The "lod" of a geometry as text; 2 and 2.0 are "2". Of a GeometryInstance that of its template. Empty when it has
/// none.
std::string lod_of(simdjson::dom::element geometry, const JsonTemplates& templates);

/// Adds the geometries of one object to reading.builder (begun by the caller).
class JsonGeometryReader {
  public:
    JsonGeometryReader(CityReading& reading, const std::string& file, const JsonTemplates& templates)
        : reading_(reading), file_(file), templates_(templates) {}

    /// `unnamed` is the kind of surfaces without semantics.
    void add(simdjson::dom::element geometry, const JsonPools& pools, SurfaceKind unnamed);
    /// Reports what add() skipped since the last call.
    void report_skipped();

  private:
    using Element = std::optional<simdjson::dom::element>;

    /// What is attached to a level of the boundaries: indices, or arrays nested alike.
    struct Attached {
        Element semantics, material, texture;
    };
    /// Goes through an attached array in step with the boundaries; a lone value holds for all of them.
    class Cursor;

    void add_instance(simdjson::dom::element instance, const JsonPools& pools, SurfaceKind unnamed);
    void add_boundaries(simdjson::dom::element geometry, const JsonPools& pools, SurfaceKind unnamed);
    void add_level(simdjson::dom::array boundaries, const Attached& attached, int levels_above_surfaces);
    void add_surface(simdjson::dom::array rings, const Attached& attached);
    bool add_points(simdjson::dom::array ring);
    bool ring_texture(const Element& texture, size_t points, std::optional<uint64_t>& image);
    SurfaceStyle style_of(const Attached& attached, const std::optional<uint64_t>& image);
    void read_semantics(simdjson::dom::element geometry, Attached& attached);

    CityReading& reading_;
    const std::string& file_;
    const JsonTemplates& templates_;

    // Of the geometry in hand:
    const JsonPools* pools_ = nullptr;
    SurfaceKind unnamed_ = SurfaceKind::kUnknown;
    std::vector<SurfaceKind> semantic_kinds_;
    std::optional<std::array<double, 16>> matrix_;  ///< of an instance, row by row
    Vec3 anchor_;
    bool mirrored_ = false;
    std::vector<Vec2> ring_texcoords_;  ///< of the ring in hand, empty without texture

    uint64_t bad_indices_ = 0, bad_textures_ = 0, bad_structures_ = 0, not_drawable_ = 0;
};

}  // namespace citystream::tiles::city
