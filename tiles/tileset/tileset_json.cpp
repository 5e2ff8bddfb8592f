#include "tiles/tileset/tileset_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "codec/radiance/local_directions.h"
#include "codec/radiance/source_directions.h"
#include "tiles/tileset/chart_index.h"
#include "tiles/tileset/json_fields.h"
#include "tiles/tileset/tile_schema.h"

namespace citystream::tiles::tileset {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr int64_t kMaxOriginUnits = int64_t{1} << 50;
constexpr int64_t kOriginStepUnits = int64_t{128} << kGridBits;
constexpr double kMaxError = 1e12;
constexpr uint64_t kMaxTotal = UINT64_MAX;
constexpr uint32_t kMostLatticeMetres = 64;
constexpr std::array<const char*, kLayerCount> kErrorUnits = {"metre", "metre", "metrePerTexel", "relativeRadiance"};

// The root square with the city's extent of heights, as 3D Tiles writes boxes: centre, then three half axes, in the
// CRS.
std::array<double, 12> root_box(const Manifest& manifest) {
    const double half = manifest.side_metres(0) / 2;
    const Bounds extent = on_grid(manifest.extent);
    const double centre_z = (extent.min[2] + extent.max[2]) / 2;
    return {to_metres(manifest.origin.x) + half,
            to_metres(manifest.origin.y) + half,
            centre_z,
            half,
            0,
            0,
            0,
            half,
            0,
            0,
            0,
            (extent.max[2] - extent.min[2]) / 2};
}

OrderedJson property_json(const TileProperty& property) {
    OrderedJson json;
    json["description"] = property.description;
    json["type"] = "SCALAR";
    json["componentType"] = property.component_type;
    if (property.fixed_count != 1) json["array"] = true;
    if (property.fixed_count > 1) json["count"] = property.fixed_count;
    if (property.required) json["required"] = true;
    if (property.semantic != nullptr) json["semantic"] = property.semantic;
    return json;
}

OrderedJson schema_json(const Manifest& manifest) {
    OrderedJson properties;
    for (const TileProperty& property : tile_properties(manifest)) properties[property.id] = property_json(property);
    OrderedJson schema;
    schema["id"] = kSchemaId;
    schema["name"] = "citystream tile directory";
    schema["version"] = "1.0.0";
    schema["classes"][kTileClass] = {{"description", "A tile: its bounds and the step tables of its layers"},
                                     {"properties", std::move(properties)}};
    return schema;
}

OrderedJson root_json(const Manifest& manifest) {
    OrderedJson root;
    root["boundingVolume"]["box"] = root_box(manifest);
    root["geometricError"] = manifest.root_geometric_error;
    root["refine"] = "REPLACE";
    root["implicitTiling"] = {{"subdivisionScheme", "QUADTREE"},
                              {"subtreeLevels", manifest.subtree_levels},
                              {"availableLevels", manifest.levels},
                              {"subtrees", {{"uri", kSubtreeTemplate}}}};
    return root;
}

OrderedJson layers_json(const Manifest& manifest) {
    OrderedJson layers = OrderedJson::object();
    for (size_t i = 0; i < kLayerCount; ++i) {
        if (!manifest.has_layer[i]) continue;
        OrderedJson layer;
        layer["uri"] = layer_template(static_cast<Layer>(i));
        layer["errorUnit"] = kErrorUnits[i];
        layer["wireBytes"] = exact_integer(manifest.wire_bytes[i]);
        layer["decodedBytes"] = exact_integer(manifest.decoded_bytes[i]);
        if (static_cast<Layer>(i) == Layer::kRadiance) {
            layer["texelsAcross"] = manifest.radiance_texels_across;
            layer["localAcross"] = manifest.radiance_local_across;
            layer["latticeMetres"] = manifest.radiance_lattice_metres;
        }
        layers[kLayerNames[i]] = std::move(layer);
    }
    return layers;
}

OrderedJson facade_json(const Manifest& manifest) {
    OrderedJson facades;
    facades["count"] = exact_integer(manifest.facade_map_count);
    facades["madeUp"] = manifest.facades_made_up;
    facades["indexUri"] = kFacadeIndexPath;
    facades["indexBytes"] = exact_integer(manifest.facade_index_bytes);
    facades["indexDecodedBytes"] = exact_integer(manifest.facade_index_decoded_bytes);
    facades["indexChecksum"] = hex16(manifest.facade_index_checksum);
    facades["mapsUri"] = kFacadeMapsPath;
    return facades;
}

OrderedJson charts_json(const Manifest& manifest) {
    OrderedJson charts;
    charts["count"] = exact_integer(manifest.shared_chart_count);
    charts["indexUri"] = kChartIndexPath;
    charts["indexBytes"] = exact_integer(manifest.chart_index_bytes);
    charts["indexDecodedBytes"] = exact_integer(manifest.chart_index_decoded_bytes);
    charts["indexChecksum"] = hex16(manifest.chart_index_checksum);
    charts["levelsUri"] = kChartLevelsPath;
    charts["levelsBytes"] = exact_integer(manifest.chart_levels_bytes);
    return charts;
}

OrderedJson extension_json(const Manifest& manifest) {
    OrderedJson extension;
    extension["version"] = kExtensionVersion;
    extension["pagesOrAlpha"] = manifest.pages_or_alpha;
    extension["title"] = manifest.title;
    extension["epsg"] = manifest.epsg;
    extension["gridBits"] = kGridBits;
    extension["origin"] = {{"x", exact_integer(manifest.origin.x)}, {"y", exact_integer(manifest.origin.y)}};
    extension["rootSideLog2"] = manifest.root_side_log2;
    extension["extent"] = {{"min", manifest.extent.min}, {"max", manifest.extent.max}};
    extension["totals"] = {{"buildings", exact_integer(manifest.buildings)},
                           {"triangles", exact_integer(manifest.triangles)},
                           {"facades", exact_integer(manifest.facades)},
                           {"tiles", exact_integer(manifest.tiles)}};
    if (manifest.greatest_subtree_bytes > 0) {
        extension["greatestSubtreeBytes"] = exact_integer(manifest.greatest_subtree_bytes);
    }
    extension["layers"] = layers_json(manifest);
    extension["facadeDictionary"] = facade_json(manifest);
    if (manifest.shared_chart_count > 0) extension["chartDictionary"] = charts_json(manifest);
    extension["buildOptions"] = manifest.build_options;
    return extension;
}

void read_tiling(const JsonFields& root, Manifest& manifest) {
    root.require(root.text("refine") == "REPLACE", "refine", "is not REPLACE");
    const JsonFields tiling = root.object("implicitTiling");
    tiling.require(tiling.text("subdivisionScheme") == "QUADTREE", "subdivisionScheme", "is not QUADTREE");
    manifest.levels = static_cast<uint32_t>(tiling.integer("availableLevels", 1, kMaxLevels));
    manifest.subtree_levels = static_cast<uint32_t>(tiling.integer("subtreeLevels", 1, kMaxSubtreeLevels));
    const JsonFields subtrees = tiling.object("subtrees");
    subtrees.require(subtrees.text("uri") == kSubtreeTemplate, "uri", "is not \"subtrees/{level}/{x}/{y}.subtree\"");
}

void read_space(const JsonFields& extension, Manifest& manifest) {
    manifest.epsg = static_cast<int32_t>(extension.integer("epsg", 0, INT32_MAX));
    extension.integer("gridBits", kGridBits, kGridBits);
    const JsonFields origin = extension.object("origin");
    manifest.origin.x = origin.integer("x", -kMaxOriginUnits, kMaxOriginUnits);
    manifest.origin.y = origin.integer("y", -kMaxOriginUnits, kMaxOriginUnits);
    origin.require(manifest.origin.x % kOriginStepUnits == 0, "x", "is not a multiple of 128 m");
    origin.require(manifest.origin.y % kOriginStepUnits == 0, "y", "is not a multiple of 128 m");
    manifest.root_side_log2 = static_cast<uint32_t>(extension.integer("rootSideLog2", 0, kMaxRootSideLog2));
    extension.require(manifest.levels <= manifest.root_side_log2 + kGridBits + 1, "rootSideLog2",
                      "is too small for the number of levels: tiles would be smaller than the grid");
    const JsonFields extent = extension.object("extent");
    extent.numbers("min", -kMaxCoordinate, kMaxCoordinate, manifest.extent.min);
    extent.numbers("max", -kMaxCoordinate, kMaxCoordinate, manifest.extent.max);
    for (size_t axis = 0; axis < 3; ++axis) {
        extent.require(manifest.extent.min[axis] <= manifest.extent.max[axis], "min", "is above max");
    }
}

void read_facades(const JsonFields& facades, Manifest& manifest) {
    manifest.facade_map_count = facades.count("count", kMaxTotal);
    manifest.facades_made_up = facades.flag("madeUp");
    manifest.facade_index_bytes = facades.count("indexBytes", kMaxTotal);
    manifest.facade_index_decoded_bytes = facades.count("indexDecodedBytes", kMaxTotal);
    manifest.facade_index_checksum = facades.hex("indexChecksum");
    facades.require(facades.text("indexUri") == kFacadeIndexPath, "indexUri", "is not \"facades/index\"");
    facades.require(facades.text("mapsUri") == kFacadeMapsPath, "mapsUri", "is not \"facades/maps\"");
}

void read_charts(const JsonFields& charts, Manifest& manifest) {
    manifest.shared_chart_count = charts.count("count", kMaxSharedCharts);
    charts.require(manifest.shared_chart_count > 0, "count", "is 0");
    manifest.chart_index_bytes = charts.count("indexBytes", kMaxTotal);
    manifest.chart_index_decoded_bytes = charts.count("indexDecodedBytes", kMaxTotal);
    manifest.chart_index_checksum = charts.hex("indexChecksum");
    manifest.chart_levels_bytes = charts.count("levelsBytes", kMaxLayerWireBytes);
    charts.require(charts.text("indexUri") == kChartIndexPath, "indexUri", "is not \"charts/index\"");
    charts.require(charts.text("levelsUri") == kChartLevelsPath, "levelsUri", "is not \"charts/levels\"");
}

void read_radiance(const JsonFields& layer, Manifest& manifest) {
    const auto read = [&layer](const char* key, uint32_t most) {
        return static_cast<uint32_t>(layer.integer(key, 1, most));
    };
    manifest.radiance_texels_across = read("texelsAcross", codec::radiance::kMostCubeSide);
    manifest.radiance_local_across = read("localAcross", codec::radiance::kMostLocalSide);
    manifest.radiance_lattice_metres = read("latticeMetres", kMostLatticeMetres);
}

void read_contents(const JsonFields& extension, Manifest& manifest) {
    const JsonFields totals = extension.object("totals");
    manifest.buildings = totals.count("buildings", kMaxTotal);
    manifest.triangles = totals.count("triangles", kMaxTotal);
    manifest.facades = totals.count("facades", kMaxTotal);
    manifest.tiles = totals.count("tiles", kMaxTotal);
    if (extension.has("greatestSubtreeBytes")) {
        manifest.greatest_subtree_bytes = extension.count("greatestSubtreeBytes", kMaxTotal);
    }
    const JsonFields layers = extension.object("layers");
    for (size_t i = 0; i < kLayerCount; ++i) {
        manifest.has_layer[i] = layers.has(kLayerNames[i]);
        if (!manifest.has_layer[i]) continue;
        const JsonFields layer = layers.object(kLayerNames[i]);
        layer.require(layer.text("uri") == layer_template(static_cast<Layer>(i)), "uri",
                      "is not the template of this version");
        manifest.wire_bytes[i] = layer.count("wireBytes", kMaxTotal);
        manifest.decoded_bytes[i] = layer.count("decodedBytes", kMaxTotal);
        if (static_cast<Layer>(i) == Layer::kRadiance) read_radiance(layer, manifest);
    }
    read_facades(extension.object("facadeDictionary"), manifest);
    if (extension.has("chartDictionary")) read_charts(extension.object("chartDictionary"), manifest);
}

// Viewers without the extension see only the box; it must say the same.
void check_box(const JsonFields& root, const Manifest& manifest) {
    std::array<double, 12> box{};
    const JsonFields volume = root.object("boundingVolume");
    volume.numbers("box", -kMaxCoordinate, kMaxCoordinate, box);
    volume.require(box == root_box(manifest), "box", "does not match the origin, side and extent of CITYSTREAM_layers");
}

}  // namespace

std::string write_tileset_json(const Manifest& manifest) {
    OrderedJson tileset;
    tileset["asset"] = {{"version", "1.1"}, {"generator", "citystream"}};
    tileset["extensionsUsed"] = {kExtensionName};
    tileset["geometricError"] = manifest.root_geometric_error;
    tileset["schema"] = schema_json(manifest);
    tileset["root"] = root_json(manifest);
    tileset["extensions"][kExtensionName] = extension_json(manifest);
    return tileset.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

Result<Manifest> parse_tileset_json(std::span<const std::byte> bytes) {
    const char* begin = reinterpret_cast<const char*>(bytes.data());
    const Json json = Json::parse(begin, begin + bytes.size(), nullptr, false);
    if (json.is_discarded()) return Error{"tileset.json: not valid JSON (cut off or damaged)"};
    std::optional<Error> error;
    Manifest manifest;
    const JsonFields document(json, "", error);
    const JsonFields asset = document.object("asset");
    asset.require(asset.text("version") == "1.1", "version", "is not \"1.1\"");
    manifest.root_geometric_error = document.number("geometricError", 0, kMaxError);
    const JsonFields root = document.object("root");
    read_tiling(root, manifest);
    const JsonFields extension = document.object("extensions").object(kExtensionName);
    extension.integer("version", kExtensionVersion, kExtensionVersion);
    manifest.pages_or_alpha = extension.flag("pagesOrAlpha");
    manifest.title = extension.text("title");
    manifest.build_options = extension.text("buildOptions");
    read_space(extension, manifest);
    read_contents(extension, manifest);
    if (!error) check_box(root, manifest);
    if (error) return Error{"tileset.json: " + error->message};
    return manifest;
}

}  // namespace citystream::tiles::tileset
