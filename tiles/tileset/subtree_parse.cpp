#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tiles/tileset/json_fields.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/subtree_order.h"
#include "tiles/tileset/tile_schema.h"

namespace citystream::tiles::tileset {
namespace {

using Bytes = std::span<const std::byte>;
using Json = nlohmann::json;

constexpr size_t kHeaderBytes = 24;
constexpr int64_t kMaxBaseHeight = int64_t{1} << 50;

template <typename T>
T get(Bytes bytes, size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

struct Chunks {
    Json json;
    Bytes binary;
};

Result<Chunks> split(Bytes bytes) {
    if (bytes.size() < kHeaderBytes) return Error{"shorter than its header", bytes.size()};
    if (std::memcmp(bytes.data(), "subt", 4) != 0) return Error{"does not begin with \"subt\"", 0};
    if (const auto version = get<uint32_t>(bytes, 4); version != 1)
        return Error{fmt::format("version {} is not 1", version), 4};
    const auto json_bytes = get<uint64_t>(bytes, 8);
    const auto binary_bytes = get<uint64_t>(bytes, 16);
    const uint64_t payload = bytes.size() - kHeaderBytes;
    if (json_bytes % 8 != 0 || binary_bytes % 8 != 0) return Error{"chunks are not padded to 8 bytes", 8};
    if (json_bytes > payload || binary_bytes != payload - json_bytes) {
        return Error{fmt::format("chunks of {} and {} bytes in a file of {}", json_bytes, binary_bytes, bytes.size()),
                     8};
    }
    const char* text = reinterpret_cast<const char*>(bytes.data()) + kHeaderBytes;
    Chunks chunks;
    chunks.json = Json::parse(text, text + json_bytes, nullptr, false);
    if (chunks.json.is_discarded()) return Error{"its JSON is not valid", kHeaderBytes};
    chunks.binary = bytes.subspan(kHeaderBytes + json_bytes);
    return chunks;
}

// Reads one subtree; the first defect is kept in error_ and everything read after it is void.
class SubtreeReader {
  public:
    SubtreeReader(const Chunks& chunks, TileAddress root, const Manifest& manifest)
        : manifest_(manifest), binary_(chunks.binary), document_(chunks.json, "", error_) {
        subtree_.root = root;
    }

    Result<Subtree> read() {
        read_views();
        if (!error_) read_tiles();
        if (!error_) read_children();
        if (!error_) read_table();
        if (error_) return *error_;
        return std::move(subtree_);
    }

  private:
    void fail(std::string message) {
        if (!error_) error_ = Error{std::move(message)};
    }

    void read_views() {
        if (!document_.has("buffers") && !document_.has("bufferViews")) return;
        const Json& buffers = document_.array("buffers");
        if (buffers.size() != 1) return document_.fail("buffers", "must be the one internal buffer");
        const JsonFields buffer(buffers[0], "buffers.0", error_);
        if (buffer.has("uri")) return buffer.fail("uri", "is not supported: subtrees hold their own buffer");
        const uint64_t length = buffer.count("byteLength", binary_.size());
        for (const Json& json : document_.array("bufferViews")) {
            const JsonFields view(json, fmt::format("bufferViews.{}", views_.size()), error_);
            view.count("buffer", 0);
            const uint64_t offset = view.count("byteOffset", length);
            const uint64_t bytes = view.count("byteLength", length - offset);
            view.require(offset % 8 == 0, "byteOffset", "is not a multiple of 8");
            view.require(bytes > 0, "byteLength", "is 0");
            if (error_) return;
            views_.push_back(binary_.subspan(offset, bytes));
        }
    }

    // The view that a field names, which must have exactly that many bytes.
    Bytes view(const JsonFields& fields, std::string_view key, uint64_t bytes) {
        const uint64_t index = fields.count(key, UINT32_MAX);
        if (index >= views_.size()) {
            fields.fail(key, "names no buffer view");
            return {};
        }
        const Bytes found = views_[index];
        if (found.size() != bytes) {
            fields.fail(key, fmt::format("names a buffer view of {} bytes where {} are needed", found.size(), bytes));
            return {};
        }
        return found;
    }

    std::vector<bool> availability(std::string_view key, size_t bits) {
        const JsonFields fields = document_.object(key);
        std::vector<bool> available(bits);
        if (fields.has("constant") == fields.has("bitstream")) {
            document_.fail(key, "must have either a constant or a bitstream");
            return available;
        }
        if (fields.has("constant")) {
            available.assign(bits, fields.integer("constant", 0, 1) == 1);
        } else {
            const Bytes stream = view(fields, "bitstream", (bits + 7) / 8);
            if (error_) return available;
            for (size_t i = 0; i < bits; ++i)
                available[i] = (std::to_integer<unsigned>(stream[i / 8]) >> (i % 8) & 1) != 0;
            const bool clean = bits % 8 == 0 || std::to_integer<unsigned>(stream.back()) >> (bits % 8) == 0;
            fields.require(clean, "bitstream", "has bits set after its end");
        }
        const auto count = static_cast<uint64_t>(std::count(available.begin(), available.end(), true));
        if (fields.has("availableCount")) {
            fields.require(fields.count("availableCount", bits) == count, "availableCount",
                           "does not count the bits that are set");
        }
        return available;
    }

    void read_tiles() {
        const std::vector<bool> available =
            availability("tileAvailability", subtree_tile_bits(manifest_.subtree_levels));
        if (error_) return;
        if (!available[0]) return fail("tileAvailability: the subtree's own root is not available");
        for (uint32_t depth = 0; depth < manifest_.subtree_levels; ++depth) {
            for (uint32_t morton = 0; morton < (1U << (2 * depth)); ++morton) {
                if (!available[subtree_tile_bits(depth) + morton]) continue;
                const TileAddress tile = tile_at(subtree_.root, depth, morton);
                if (tile.level >= manifest_.levels) return fail_at(tile, "lies below the last available level");
                if (depth > 0 && !available[subtree_tile_bits(depth - 1) + morton / 4]) {
                    return fail_at(tile, "is available but its parent is not");
                }
                subtree_.tiles.emplace_back().address = tile;
            }
        }
        bottom_available_.assign(available.end() - (ptrdiff_t{1} << (2 * (manifest_.subtree_levels - 1))),
                                 available.end());
    }

    void read_children() {
        const std::vector<bool> available =
            availability("childSubtreeAvailability", child_subtree_bits(manifest_.subtree_levels));
        if (error_) return;
        for (uint32_t morton = 0; morton < available.size(); ++morton) {
            if (!available[morton]) continue;
            const TileAddress child = tile_at(subtree_.root, manifest_.subtree_levels, morton);
            if (child.level >= manifest_.levels) return fail_at(child, "lies below the last available level");
            if (!bottom_available_[morton / 4])
                return fail_at(child, "is the root of a subtree but its parent is not available");
            subtree_.child_subtrees.push_back(child);
        }
    }

    void fail_at(TileAddress tile, std::string_view what) {
        fail(fmt::format("tile {}/{}/{} {}", tile.level, tile.x, tile.y, what));
    }

    void read_table() {
        const Json& tables = document_.array("propertyTables");
        const uint64_t index = document_.count("tileMetadata", UINT32_MAX);
        if (error_) return;
        if (index >= tables.size()) return document_.fail("tileMetadata", "names no property table");
        const JsonFields table(tables[index], fmt::format("propertyTables.{}", index), error_);
        table.require(table.text("class") == kTileClass, "class", "is not \"tile\"");
        table.require(table.count("count", UINT32_MAX) == subtree_.tiles.size(), "count",
                      "is not the number of available tiles");
        const JsonFields properties = table.object("properties");
        if (!error_) read_bounds(properties);
        if (!error_) read_scalars(properties);
        for (size_t i = 0; i < kLayerCount && !error_; ++i) {
            const auto layer = static_cast<Layer>(i);
            if (manifest_.has_layer[i] && properties.has(step_property(layer, StepColumn::kEnds)))
                read_steps(properties, layer);
        }
    }

    template <typename T>
    std::vector<T> values(const JsonFields& properties, const std::string& id, size_t count) {
        const Bytes bytes = view(properties.object(id), "values", count * sizeof(T));
        if (error_) return {};
        std::vector<T> result(count);
        if (count > 0) std::memcpy(result.data(), bytes.data(), bytes.size());
        return result;
    }

    void read_bounds(const JsonFields& properties) {
        const std::array<double, 3> origin = {to_metres(manifest_.origin.x), to_metres(manifest_.origin.y), 0.0};
        const auto boxes = values<double>(properties, kBoundingBox, subtree_.tiles.size() * 12);
        for (size_t i = 0; i < subtree_.tiles.size() && !error_; ++i) {
            const double* box = &boxes[i * 12];
            for (size_t axis = 0; axis < 3; ++axis) {
                const double half = box[3 + axis * 4];
                subtree_.tiles[i].bounds.min[axis] = box[axis] - half - origin[axis];
                subtree_.tiles[i].bounds.max[axis] = box[axis] + half - origin[axis];
            }
            if (!is_upright(box))
                fail_at(subtree_.tiles[i].address, "has a bounding box that is not upright and finite");
        }
    }

    static bool is_upright(const double* box) {
        for (size_t i = 0; i < 12; ++i) {
            const bool on_diagonal = i >= 3 && (i - 3) % 4 == 0;
            if (!(std::abs(box[i]) <= kMaxCoordinate)) return false;
            if (on_diagonal ? box[i] < 0 : i >= 3 && box[i] != 0) return false;
        }
        return true;
    }

    void read_scalars(const JsonFields& properties) {
        const size_t count = subtree_.tiles.size();
        const bool facades = manifest_.has_layer[static_cast<size_t>(Layer::kFacade)];
        const auto errors = values<float>(properties, kGeometricError, count);
        const auto heights = values<int64_t>(properties, kBaseHeight, count);
        const auto flat_errors =
            facades ? values<float>(properties, kFlatFacadeError, count) : std::vector<float>(count);
        const auto maps = facades ? values<uint32_t>(properties, kFacadeMaps, count) : std::vector<uint32_t>(count);
        if (error_) return;
        const auto is_size = [](float value) { return std::isfinite(value) && value >= 0; };
        for (size_t i = 0; i < count; ++i) {
            TileRecord& record = subtree_.tiles[i];
            if (!is_size(errors[i])) return fail_at(record.address, "has a geometric error that is not a size");
            if (!is_size(flat_errors[i])) return fail_at(record.address, "has a flat facade error that is not a size");
            if (heights[i] < -kMaxBaseHeight || heights[i] > kMaxBaseHeight) {
                return fail_at(record.address, "has a base height that is out of range");
            }
            record.geometric_error = errors[i];
            record.base_height = heights[i];
            record.flat_facade_error = flat_errors[i];
            record.facade_maps = maps[i];
        }
    }

    // Offsets of a variable-length array: one more than tiles, from 0, never falling, by at most kMaxSteps.
    std::vector<uint32_t> offsets(const JsonFields& property) {
        const std::string type = property.has("arrayOffsetType") ? property.text("arrayOffsetType") : "UINT32";
        const size_t width = type == "UINT8"    ? 1
                             : type == "UINT16" ? 2
                             : type == "UINT32" ? 4
                             : type == "UINT64" ? 8
                                                : 0;
        if (width == 0) property.fail("arrayOffsetType", "is not an unsigned integer type");
        const size_t count = subtree_.tiles.size() + 1;
        const Bytes bytes = view(property, "arrayOffsets", count * width);
        if (error_) return {};
        std::vector<uint32_t> result(count);
        uint64_t before = 0;
        for (size_t i = 0; i < count; ++i) {
            uint64_t offset = 0;
            std::memcpy(&offset, bytes.data() + i * width, width);
            const uint64_t limit = i == 0 ? 0 : before + kMaxSteps;
            if (offset < before || offset > limit) {
                property.fail("arrayOffsets", fmt::format("has a value out of order at {}", i));
                return {};
            }
            result[i] = static_cast<uint32_t>(offset);
            before = offset;
        }
        return result;
    }

    template <typename T>
    std::vector<T> step_values(const JsonFields& properties, Layer layer, StepColumn column,
                               const std::vector<uint32_t>& expected) {
        const std::string id = step_property(layer, column);
        const std::vector<uint32_t> own = offsets(properties.object(id));
        if (!error_ && own != expected)
            properties.fail(id, "does not have as many values as the layer's other columns");
        return error_ ? std::vector<T>{} : values<T>(properties, id, own.back());
    }

    void read_steps(const JsonFields& properties, Layer layer) {
        const std::vector<uint32_t> starts = offsets(properties.object(step_property(layer, StepColumn::kEnds)));
        if (error_) return;
        const auto ends = step_values<uint64_t>(properties, layer, StepColumn::kEnds, starts);
        const auto decoded = step_values<uint32_t>(properties, layer, StepColumn::kDecodedBytes, starts);
        const auto errors = step_values<float>(properties, layer, StepColumn::kErrors, starts);
        const auto checksums = step_values<uint64_t>(properties, layer, StepColumn::kChecksums, starts);
        if (error_) return;
        for (size_t i = 0; i < subtree_.tiles.size(); ++i) {
            TileRecord& record = subtree_.tiles[i];
            std::vector<StepRecord>& steps = record.steps(layer);
            for (uint32_t at = starts[i]; at < starts[i + 1]; ++at) {
                steps.push_back({ends[at], decoded[at], errors[at], checksums[at]});
            }
            if (const auto defect = step_table_defect(steps)) {
                return fail_at(record.address,
                               fmt::format("layer {}: {}", kLayerNames[static_cast<size_t>(layer)], *defect));
            }
        }
    }

    const Manifest& manifest_;
    Bytes binary_;
    std::optional<Error> error_;
    JsonFields document_;
    std::vector<Bytes> views_;
    std::vector<bool> bottom_available_;
    Subtree subtree_;
};

std::optional<std::string> root_defect(TileAddress root, const Manifest& manifest) {
    if (manifest.subtree_levels < 1 || manifest.subtree_levels > kMaxSubtreeLevels)
        return "the manifest's subtree levels are out of range";
    if (manifest.levels > kMaxLevels || root.level >= manifest.levels) return "its level does not exist";
    if (root.level % manifest.subtree_levels != 0) return "no subtree begins at its level";
    if (root.x >> root.level != 0 || root.y >> root.level != 0) return "it lies outside the root square";
    return std::nullopt;
}

}  // namespace

Result<Subtree> parse_subtree(Bytes bytes, TileAddress root, const Manifest& manifest) {
    const std::string name = subtree_path(root);
    if (const auto defect = root_defect(root, manifest)) return Error{name + ": " + *defect};
    const auto chunks = split(bytes);
    if (!chunks) return Error{name + ": " + chunks.error().message, chunks.error().offset};
    auto subtree = SubtreeReader(*chunks, root, manifest).read();
    if (!subtree) return Error{name + ": " + subtree.error().message, subtree.error().offset};
    return subtree;
}

}  // namespace citystream::tiles::tileset
