// The metadata class "tile" of the directory's schema: which properties it has and how they are stored. tileset.json
// declares them, the subtrees' property tables fill them; both read this list.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tiles/tileset/directory.h"

namespace citystream::tiles::tileset {

inline constexpr const char* kSchemaId = "citystream";
inline constexpr const char* kTileClass = "tile";
inline constexpr const char* kExtensionName = "CITYSTREAM_layers";
inline constexpr uint32_t kExtensionVersion = 7;
inline constexpr const char* kSubtreeTemplate = "subtrees/{level}/{x}/{y}.subtree";
std::string layer_template(Layer layer);  ///< "tiles/{level}/{x}/{y}.mesh"

inline constexpr uint32_t kMaxLevels = 24;
inline constexpr uint32_t kMaxSubtreeLevels = 8;
inline constexpr uint32_t kMaxRootSideLog2 = 32;
inline constexpr size_t kMaxSteps = 16;
inline constexpr uint64_t kMaxLayerWireBytes = 0xFFFFFFFE;  ///< what an archive entry can hold
inline constexpr uint64_t kMaxLayerDecodedBytes = uint64_t{1} << 30;
inline constexpr double kMaxCoordinate = 0x1p41;  ///< metres; centres of boxes are exact below

inline constexpr const char* kBoundingBox = "boundingBox";
inline constexpr const char* kGeometricError = "geometricError";
inline constexpr const char* kBaseHeight = "baseHeight";
inline constexpr const char* kFlatFacadeError = "flatFacadeError";
inline constexpr const char* kFacadeMaps = "facadeMaps";

/// The four columns of a layer's step table: "meshEnds", "meshDecodedBytes", "meshErrors", "meshChecksums".
enum class StepColumn : uint8_t { kEnds, kDecodedBytes, kErrors, kChecksums };
std::string step_property(Layer layer, StepColumn column);

/// One property of the class.
struct TileProperty {
    std::string id;
    const char* component_type;
    uint32_t fixed_count;  ///< 1: a scalar; more: an array of that length; 0: an array of any length
    bool required;         ///< step tables of a layer are left out of a subtree in which no tile has the layer
    const char* semantic;  ///< of the 3D Metadata Semantic Reference, or nullptr
    std::string description;
};
std::vector<TileProperty> tile_properties(const Manifest& manifest);

/// What breaks the rules of a step table, or nothing: at most 16 steps, ends grow and fit an archive entry, decoded
/// bytes are multiples of 4 and at most 1 GiB together, errors are finite, not negative and do not grow.
std::optional<std::string> step_table_defect(std::span<const StepRecord> steps);

/// The same bounds on the 2^-10 m grid, rounded outwards: what the directory stores, exact in its centre-and-half-axes
/// form.
Bounds on_grid(const Bounds& bounds);

}  // namespace citystream::tiles::tileset
