#include <algorithm>
#include <cassert>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tiles/tileset/subtree.h"
#include "tiles/tileset/subtree_order.h"
#include "tiles/tileset/tile_schema.h"

namespace citystream::tiles::tileset {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Records = std::vector<const TileRecord*>;

constexpr size_t kAlignment = 8;
constexpr size_t kHeaderBytes = 24;

template <typename T>
void put(std::vector<std::byte>& out, T value) {
    const size_t at = out.size();
    out.resize(at + sizeof value);
    std::memcpy(out.data() + at, &value, sizeof value);
}

void pad(std::vector<std::byte>& out, std::byte with) {
    while (out.size() % kAlignment != 0) out.push_back(with);
}

// The binary chunk and the buffer views into it.
class BinaryChunk {
  public:
    size_t add(std::span<const std::byte> view) {
        pad(bytes_, std::byte{0});
        views_.push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", view.size()}});
        bytes_.insert(bytes_.end(), view.begin(), view.end());
        return views_.size() - 1;
    }
    template <typename T>
    size_t add(const std::vector<T>& values) {
        return add(std::as_bytes(std::span(values)));
    }
    const std::vector<std::byte>& bytes() const { return bytes_; }
    const OrderedJson& views() const { return views_; }

  private:
    std::vector<std::byte> bytes_;
    OrderedJson views_ = OrderedJson::array();
};

OrderedJson availability(const std::vector<bool>& bits, BinaryChunk& chunk) {
    const auto available = std::count(bits.begin(), bits.end(), true);
    if (available == 0) return {{"constant", 0}};
    if (available == static_cast<ptrdiff_t>(bits.size())) return {{"constant", 1}};
    std::vector<uint8_t> bytes((bits.size() + 7) / 8);
    for (size_t i = 0; i < bits.size(); ++i) {
        if (bits[i]) bytes[i / 8] = static_cast<uint8_t>(bytes[i / 8] | (1U << (i % 8)));
    }
    return {{"bitstream", chunk.add(bytes)}, {"availableCount", available}};
}

std::vector<double> boxes(const Records& records, const Manifest& manifest) {
    const std::array<double, 3> origin = {to_metres(manifest.origin.x), to_metres(manifest.origin.y), 0.0};
    std::vector<double> values;
    values.reserve(records.size() * 12);
    for (const TileRecord* record : records) {
        const Bounds bounds = on_grid(record->bounds);
        for (size_t axis = 0; axis < 3; ++axis) {
            values.push_back(origin[axis] + (bounds.min[axis] + bounds.max[axis]) / 2);
        }
        for (size_t row = 0; row < 3; ++row) {
            for (size_t axis = 0; axis < 3; ++axis) {
                values.push_back(row == axis ? (bounds.max[axis] - bounds.min[axis]) / 2 : 0.0);
            }
        }
    }
    return values;
}

template <typename Of>
auto column(const Records& records, Of of) {
    std::vector<std::decay_t<decltype(of(*records.front()))>> values;
    values.reserve(records.size());
    for (const TileRecord* record : records) values.push_back(of(*record));
    return values;
}

template <typename Of>
auto step_column(const Records& records, Layer layer, Of of) {
    std::vector<std::decay_t<decltype(of(StepRecord{}))>> values;
    for (const TileRecord* record : records) {
        for (const StepRecord& step : record->steps(layer)) values.push_back(of(step));
    }
    return values;
}

// The four arrays of a layer have the same lengths and share one view of offsets. A layer that no tile here has is left
// out: views of 0 bytes are not allowed.
void add_step_table(OrderedJson& properties, const Records& records, Layer layer, BinaryChunk& chunk) {
    std::vector<uint32_t> offsets = {0};
    for (const TileRecord* record : records) {
        assert(!step_table_defect(record->steps(layer)));
        offsets.push_back(offsets.back() + static_cast<uint32_t>(record->steps(layer).size()));
    }
    if (offsets.back() == 0) return;
    const size_t offsets_view = chunk.add(offsets);
    const auto add = [&](StepColumn which, const auto& values) {
        properties[step_property(layer, which)] = {
            {"values", chunk.add(values)}, {"arrayOffsets", offsets_view}, {"arrayOffsetType", "UINT32"}};
    };
    add(StepColumn::kEnds, step_column(records, layer, [](const StepRecord& step) { return step.end; }));
    add(StepColumn::kDecodedBytes,
        step_column(records, layer, [](const StepRecord& step) { return step.decoded_bytes; }));
    add(StepColumn::kErrors, step_column(records, layer, [](const StepRecord& step) { return step.error; }));
    add(StepColumn::kChecksums, step_column(records, layer, [](const StepRecord& step) { return step.checksum; }));
}

OrderedJson property_table(const Records& records, const Manifest& manifest, BinaryChunk& chunk) {
    OrderedJson properties;
    const auto add = [&](const char* id, const auto& values) { properties[id] = {{"values", chunk.add(values)}}; };
    add(kBoundingBox, boxes(records, manifest));
    add(kGeometricError, column(records, [](const TileRecord& record) { return record.geometric_error; }));
    add(kBaseHeight, column(records, [](const TileRecord& record) { return record.base_height; }));
    if (manifest.has_layer[static_cast<size_t>(Layer::kFacade)]) {
        add(kFlatFacadeError, column(records, [](const TileRecord& record) { return record.flat_facade_error; }));
        add(kFacadeMaps, column(records, [](const TileRecord& record) { return record.facade_maps; }));
    }
    for (size_t i = 0; i < kLayerCount; ++i) {
        if (manifest.has_layer[i]) add_step_table(properties, records, static_cast<Layer>(i), chunk);
    }
    return {{"class", kTileClass}, {"count", records.size()}, {"properties", std::move(properties)}};
}

Records in_order(const Subtree& subtree) {
    Records records;
    records.reserve(subtree.tiles.size());
    for (const TileRecord& record : subtree.tiles) records.push_back(&record);
    std::sort(records.begin(), records.end(), [&](const TileRecord* a, const TileRecord* b) {
        return tile_bit(subtree.root, a->address) < tile_bit(subtree.root, b->address);
    });
    return records;
}

std::vector<std::byte> assemble(const OrderedJson& json, const std::vector<std::byte>& binary) {
    std::string text = json.dump();
    text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
    std::vector<std::byte> file;
    file.reserve(kHeaderBytes + text.size() + binary.size() + kAlignment);
    for (const char c : {'s', 'u', 'b', 't'}) file.push_back(static_cast<std::byte>(c));
    put<uint32_t>(file, 1);
    put<uint64_t>(file, text.size());
    put<uint64_t>(file, (binary.size() + kAlignment - 1) / kAlignment * kAlignment);
    for (const char c : text) file.push_back(static_cast<std::byte>(c));
    file.insert(file.end(), binary.begin(), binary.end());
    pad(file, std::byte{0});
    return file;
}

}  // namespace

std::vector<std::byte> write_subtree(const Subtree& subtree, const Manifest& manifest) {
    assert(!subtree.tiles.empty());
    std::vector<bool> tile_bits(subtree_tile_bits(manifest.subtree_levels));
    for (const TileRecord& record : subtree.tiles) tile_bits.at(tile_bit(subtree.root, record.address)) = true;
    std::vector<bool> child_bits(child_subtree_bits(manifest.subtree_levels));
    for (const TileAddress child : subtree.child_subtrees) child_bits.at(local_morton(subtree.root, child)) = true;

    BinaryChunk chunk;
    OrderedJson json;
    const OrderedJson tile_availability = availability(tile_bits, chunk);
    const OrderedJson child_availability = availability(child_bits, chunk);
    OrderedJson table = property_table(in_order(subtree), manifest, chunk);
    json["buffers"] = OrderedJson::array({{{"byteLength", chunk.bytes().size()}}});
    json["bufferViews"] = chunk.views();
    json["propertyTables"] = OrderedJson::array({std::move(table)});
    json["tileAvailability"] = tile_availability;
    json["childSubtreeAvailability"] = child_availability;
    json["tileMetadata"] = 0;
    return assemble(json, chunk.bytes());
}

}  // namespace citystream::tiles::tileset
