// A city as a stream of objects: what every reader and the generator produce and the builder consumes.
// Coordinates are metres in the input's projected CRS (double, z up). Nothing here holds a whole city: objects go one
// by one through a CitySink; only the catalog (materials, images by reference, facade maps) is shared.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "codec/facade/facade_layout.h"
#include "tiles/city/building_facts.h"
#include "tiles/city/facade_catalog.h"

namespace citystream::tiles::city {

struct Vec2 {
    double x = 0, y = 0;
};
struct Vec3 {
    double x = 0, y = 0, z = 0;
};

enum class ObjectKind : uint8_t {
    kBuilding,
    kTerrain,
    kLandUse,
    kRoad,
    kWater,
    kVegetation,
    kBridge,
    kFurniture,
    kOther
};
enum class SurfaceKind : uint8_t { kUnknown, kWall, kRoof, kGround, kWindow, kDoor, kInstallation };

/// An image in memory: 8-bit RGB, sRGB-encoded, row 0 is the bottom (v = 0).
struct Image {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgb;
};

/// Where an image comes from: the first of `pixels`, `make` and `path` that is set. Decoded or made when it is needed.
struct ImageSource {
    std::string path = {};                     ///< file to decode with OpenImageIO
    std::shared_ptr<const Image> pixels = {};  ///< procedural images that are few and small
    std::function<Image()> make = {};          ///< draws the image anew at every call: equal pixels, from any thread

    /// `pixels`, or what `make` draws now; nothing where a file holds the image.
    std::shared_ptr<const Image> drawn() const;
};

/// A flat colour, or an image whose texture coordinates are given per corner (in repeats of the whole image).
struct Material {
    std::array<uint8_t, 3> rgb = {200, 200, 200};  ///< sRGB; used alone when image < 0 or the image cannot be read
    int32_t image = -1;                            ///< index in CityCatalog::images
    bool repeat = true;                            ///< wrap outside 0..1, else clamp
    float metres_per_repeat = 0;                   ///< for planar mapping on facades; 0 = unknown
    friend bool operator==(const Material&, const Material&) = default;
};

/// Material slots 0..15 of a facade map, each a material of the catalog.
struct FacadePalette {
    std::array<uint32_t, FACADE_PALETTE_SLOTS> material{};
    friend bool operator==(const FacadePalette&, const FacadePalette&) = default;
};

struct CityCatalog {
    std::vector<Material> materials;
    std::vector<ImageSource> images;
    FacadeCatalog facade_maps;  ///< their materials are slots 0..15 of a palette
    std::vector<FacadePalette> palettes;

    /// Index of an equal material, appended when new.
    uint32_t add_material(const Material& material);
};

struct Triangle {
    std::array<uint32_t, 3> vertex{};  ///< in CityObject::vertices, counter-clockwise from outside
    std::array<Vec2, 3> texcoord{};    ///< repeats of the material's image; v upwards. Zero without image
    uint32_t material = 0;
    SurfaceKind surface = SurfaceKind::kUnknown;
};

/// A flat rectangular wall that carries a facade map. It is not among the triangles: builder and reference make its
/// geometry.
struct FacadeWall {
    Vec3 lower_left;    ///< seen from outside
    Vec2 along;         ///< metres, to the lower right corner; the outward normal is (along.y, -along.x)
    double height = 0;  ///< metres; the map is stretched over |along| x height
    uint32_t map = 0;
    uint32_t palette = 0;
};

struct CityObject {
    std::string id;
    ObjectKind kind = ObjectKind::kOther;
    BuildingFacts facts;         ///< of buildings, where the input says them
    std::vector<Vec3> vertices;  ///< welded: equal positions once
    std::vector<Triangle> triangles;
    std::vector<FacadeWall> facades;
};

/// A defect of the input that was repaired or skipped; never silent.
struct Defect {
    std::string feature;           ///< id, or file name when none
    std::string what;              ///< "ring of 2 points skipped", "image missing: roof.jpg", ...
    std::string where;             ///< file and line, byte or path in the document
    bool dropped_feature = false;  ///< the whole feature is absent from the city
};

struct CityReport {
    uint64_t features_read = 0;  ///< top-level features seen
    uint64_t objects_emitted = 0;
    uint64_t buildings_emitted =
        0;  ///< top-level buildings with geometry (a Building with its BuildingParts counts once)
    uint64_t triangles_emitted = 0;
    std::vector<Defect> defects;  ///< at most kMaxDefects kept in full; defect_count counts all
    uint64_t defect_count = 0;
    std::vector<std::string> dropped_features;  ///< ids of every feature that is absent, never truncated
    static constexpr size_t kMaxDefects = 10000;
    void add(Defect defect);
};

/// What is known of the city as a whole once its header has been read.
struct CityHeader {
    int32_t epsg = 0;  ///< horizontal (or compound) CRS; 0 = unknown
    std::string title;
};

/// Takes one object; returns false to stop reading.
using CitySink = std::function<bool(CityObject&&)>;

}  // namespace citystream::tiles::city
