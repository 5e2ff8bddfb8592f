// The triangles of a building as one wall sees them: in its frame, sorted into what a height field shows as fronts,
// what it shows as sides, and what it cannot show.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tiles/layers/relief_extraction_frame.h"

namespace citystream::tiles::layers::relief {

inline constexpr uint32_t kNone = UINT32_MAX;

enum class PartKind : uint8_t {
    kOutside,  ///< beyond the rectangle or the depth window, or shown by another wall already
    kSpeck,    ///< no area that could be seen
    kFlat,     ///< parallel to the wall, facing out
    kSide,     ///< perpendicular to the wall
    kOther     ///< slanted, or facing in
};

struct Part {
    uint32_t triangle = 0;             ///< of the object
    std::array<uint32_t, 3> vertex{};  ///< of the object
    uint32_t material = 0;
    uint32_t look = 0;       ///< material of the catalog that a relief shows for it
    bool patterned = false;  ///< its image is far from one colour, which no relief shows
    PartKind kind = PartKind::kOutside;
    bool ground = false;     ///< a floor: seen from below the ground
    uint32_t patch = kNone;  ///< of flat parts
    std::array<Point, 3> corner;
    Point normal;  ///< unit; zero for specks
    double area = 0;
    Point low, high;  ///< bounds
};

/// Flat parts of one material that hang together by their edges.
struct Patch {
    uint32_t material = 0;
    double depth = 0;      ///< mean w
    int32_t level_mm = 0;  ///< depth shown: one for all patches that differ by a few millimetres
    double area = 0;
    double error = 0;  ///< greatest distance of a corner from level_mm
    Point low, high;
    bool kept = false;  ///< stays mesh
};

struct FacadeParts {
    std::vector<Part> parts;  ///< of all triangles of the object that come near the wall
    std::vector<Patch> patches;
};

/// `taken`: triangles that are shown by another wall. O(triangles log triangles).
FacadeParts gather_parts(const city::CityObject& object, const WallFrame& frame, std::span<const uint8_t> taken,
                         double depth_behind, const ReliefExtractionOptions& options);

/// An edge of a flat part that borders no other part of its patch.
struct OutlineEdge {
    uint32_t patch = 0;
    Point from, to;
};
std::vector<OutlineEdge> outlines(const FacadeParts& facade);

}  // namespace citystream::tiles::layers::relief
