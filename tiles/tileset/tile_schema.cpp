#include "tiles/tileset/tile_schema.h"

#include <fmt/format.h>

#include <cmath>

namespace citystream::tiles::tileset {
namespace {

const char* error_unit(Layer layer) {
    switch (layer) {
        case Layer::kAtlas:
            return "metres per texel";
        case Layer::kRadiance:
            return "relative radiance";
        default:
            return "metres";
    }
}

void append_step_properties(std::vector<TileProperty>& properties, Layer layer) {
    const std::string name = kLayerNames[static_cast<size_t>(layer)];
    const auto append = [&](StepColumn column, const char* type, std::string description) {
        properties.push_back({step_property(layer, column), type, 0, false, nullptr, std::move(description)});
    };
    append(StepColumn::kEnds, "UINT64",
           "Per step of the layer " + name + ": where it ends in the layer's entry, in bytes");
    append(StepColumn::kDecodedBytes, "UINT32", "Per step of the layer " + name + ": its decoded bytes");
    append(
        StepColumn::kErrors, "FLOAT32",
        fmt::format("Per step of the layer {}: error of the prefix that ends with it, in {}", name, error_unit(layer)));
    append(StepColumn::kChecksums, "UINT64", "Per step of the layer " + name + ": XXH3-64 of its bytes in the entry");
}

}  // namespace

std::string layer_template(Layer layer) {
    return std::string("tiles/{level}/{x}/{y}.") + kLayerNames[static_cast<size_t>(layer)];
}

std::string step_property(Layer layer, StepColumn column) {
    constexpr std::array<const char*, 4> kSuffixes = {"Ends", "DecodedBytes", "Errors", "Checksums"};
    return std::string(kLayerNames[static_cast<size_t>(layer)]) + kSuffixes[static_cast<size_t>(column)];
}

std::vector<TileProperty> tile_properties(const Manifest& manifest) {
    std::vector<TileProperty> properties = {
        {kBoundingBox, "FLOAT64", 12, true, "TILE_BOUNDING_BOX",
         "Box around the tile's contents and all tiles below it"},
        {kGeometricError, "FLOAT32", 1, true, "TILE_GEOMETRIC_ERROR",
         "Error in metres of the tile drawn with all its mesh steps"},
        {kBaseHeight, "INT64", 1, true, nullptr, "Height from which the tile's positions count, in units of 2^-10 m"},
    };
    if (manifest.has_layer[static_cast<size_t>(Layer::kFacade)]) {
        properties.push_back({kFlatFacadeError, "FLOAT32", 1, true, nullptr,
                              "Error in metres of drawing the tile's facades flat (greatest depth of relief)"});
        properties.push_back(
            {kFacadeMaps, "UINT32", 1, true, nullptr, "Distinct facade maps that the tile's facade layer uses"});
    }
    for (size_t i = 0; i < kLayerCount; ++i) {
        if (manifest.has_layer[i]) append_step_properties(properties, static_cast<Layer>(i));
    }
    return properties;
}

std::optional<std::string> step_table_defect(std::span<const StepRecord> steps) {
    if (steps.size() > kMaxSteps) return fmt::format("{} steps, at most {} are allowed", steps.size(), kMaxSteps);
    uint64_t end = 0;
    uint64_t decoded = 0;
    for (size_t i = 0; i < steps.size(); ++i) {
        const StepRecord& step = steps[i];
        if (step.end <= end) return fmt::format("step {} ends at {}, not after the one before", i, step.end);
        if (step.end > kMaxLayerWireBytes)
            return fmt::format("step {} ends at {}, beyond what an entry holds", i, step.end);
        if (step.decoded_bytes % 4 != 0)
            return fmt::format("step {} decodes to {} bytes, not whole words", i, step.decoded_bytes);
        if (!std::isfinite(step.error) || step.error < 0) return fmt::format("the error of step {} is not a size", i);
        if (i > 0 && step.error > steps[i - 1].error) return fmt::format("the error grows at step {}", i);
        end = step.end;
        decoded += step.decoded_bytes;
    }
    if (decoded > kMaxLayerDecodedBytes) return fmt::format("decodes to {} bytes, at most 1 GiB is allowed", decoded);
    return std::nullopt;
}

Bounds on_grid(const Bounds& bounds) {
    Bounds rounded;
    for (size_t axis = 0; axis < 3; ++axis) {
        rounded.min[axis] = std::floor(bounds.min[axis] * kGridUnitsPerMetre) * kMetresPerGridUnit;
        rounded.max[axis] = std::ceil(bounds.max[axis] * kGridUnitsPerMetre) * kMetresPerGridUnit;
    }
    return rounded;
}

}  // namespace citystream::tiles::tileset
