#include "tiles/layers/inspect_facades.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "codec/facade/facade_form.h"
#include "codec/facade/facade_layout.h"
#include "codec/facade/facade_wire.h"
#include "codec/facade/grid_difference.h"
#include "tiles/tileset/facade_index.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::RunGrid;
using tileset::FacadeLevelRecord;
using tileset::FacadeMapRecord;

constexpr double kMetresPerMm = 0.001;
constexpr double kErrorRounding = 1e-6;

/// What is wrong with an expanded level, given its map's record.
std::optional<std::string> defect_of(const RunGrid& grid, const FacadeMapRecord& map, const FacadeLevelRecord& level) {
    if (grid.width() != map.width || grid.height() != map.height)
        return fmt::format("has {} x {} texels, the index says {} x {}", grid.width(), grid.height(), map.width,
                           map.height);
    const codec::facade::DepthRange depths = grid.depths();
    const bool exact = level.texel_cm == 1;
    const bool within = depths.min_mm >= map.depth_min_mm && depths.max_mm <= map.depth_max_mm;
    const bool equal = depths.min_mm == map.depth_min_mm && depths.max_mm == map.depth_max_mm;
    if (exact ? !equal : !within) return "has other depths than the index says";
    const bool slots = std::all_of(grid.labels.begin(), grid.labels.end(), [](uint32_t label) {
        return codec::facade::material_of(label) < FACADE_PALETTE_SLOTS;
    });
    return slots ? std::nullopt : std::optional<std::string>("names a material slot that no palette has");
}

/// Payloads of one map, level by level.
class MapPayloads {
  public:
    MapPayloads(std::span<const std::byte> entry, uint64_t begin, const FacadeMapRecord& map)
        : entry_(entry), begin_(begin), map_(map) {}

    bool inside() const { return map_.levels().back().end <= entry_.size(); }
    std::span<const std::byte> of(uint32_t level) const {
        const uint64_t begin = level == 0 ? begin_ : map_.level[level - 1].end;
        return entry_.subspan(begin, map_.level[level].end - begin);
    }

  private:
    std::span<const std::byte> entry_;
    uint64_t begin_;
    const FacadeMapRecord& map_;
};

class MapChecker {
  public:
    MapChecker(const MapPayloads& payloads, const FacadeMapRecord& map) : payloads_(payloads), map_(map) {}

    /// The first damage of the map.
    std::optional<std::string> run() {
        std::optional<RunGrid> exact;
        for (uint32_t i = map_.level_count; i-- > 0;) {
            const auto named = [&](const std::string& what) { return fmt::format("level {}: {}", i, what); };
            const auto wire = payloads_.of(i);
            const FacadeLevelRecord& level = map_.level[i];
            if (static_cast<uint32_t>(tileset::checksum_of(wire.data(), wire.size())) != level.checksum)
                return named("checksum differs");
            const auto words = codec::facade::expand_wire(wire, level.resident_bytes);
            if (!words) return named(words.error().text());
            auto grid = codec::facade::decode_form(*words);
            if (!grid) return named(grid.error().text());
            if (auto defect = defect_of(*grid, map_, level)) return named(*defect);
            if (exact && codec::facade::difference(*grid, *exact).displacement_mm * kMetresPerMm >
                             static_cast<double>(level.displacement_error) + kErrorRounding)
                return named("is further from the exact map than the index says");
            if (!exact) exact = std::move(grid).value();
        }
        return std::nullopt;
    }

  private:
    const MapPayloads& payloads_;
    const FacadeMapRecord& map_;
};

void add(nlohmann::json& sums, const char* key, uint64_t value) {
    nlohmann::json& sum = sums[key];
    sum = (sum.is_null() ? 0 : sum.get<uint64_t>()) + value;
}

void add_level(nlohmann::json& out, const FacadeLevelRecord& level, std::span<const std::byte> wire) {
    add(out, "wire_bytes", wire.size());
    add(out, "resident_bytes", level.resident_bytes);
    nlohmann::json& of_texel = out["levels"][fmt::format("{} cm", level.texel_cm)];
    add(of_texel, "maps", 1);
    add(of_texel, "wire_bytes", wire.size());
    add(of_texel, "resident_bytes", level.resident_bytes);
    nlohmann::json& greatest = of_texel["greatest_error_metres"];
    const auto error = static_cast<double>(level.displacement_error);
    greatest = greatest.is_null() ? error : std::max(greatest.get<double>(), error);
    const auto words = codec::facade::expand_wire(wire, level.resident_bytes);
    if (!words) return;
    const auto head = codec::facade::read_form_head(*words);
    if (!head) return;
    nlohmann::json& of_form = out["forms"][std::string(codec::facade::form_name(head->form))];
    add(of_form, "levels", 1);
    add(of_form, "wire_bytes", wire.size());
    add(of_form, "resident_bytes", level.resident_bytes);
}

}  // namespace

void check_facade_dictionary(const archive::ArchiveReader& reader, const tileset::Manifest& manifest,
                             const std::function<void(const std::string&, const std::string&)>& say) {
    const auto maps = tileset::parse_facade_index(reader.find(tileset::kFacadeIndexPath), manifest);
    if (!maps) return say(tileset::kFacadeIndexPath, maps.error().text());
    const auto bytes = reader.find(tileset::kFacadeMapsPath);
    uint64_t begin = 0;
    for (size_t i = 0; i < maps->size(); ++i) {
        const FacadeMapRecord& map = (*maps)[i];
        const MapPayloads payloads(bytes, begin, map);
        if (!payloads.inside()) return say(tileset::kFacadeMapsPath, fmt::format("map {} lies outside the entry", i));
        if (const auto damage = MapChecker(payloads, map).run())
            say(tileset::kFacadeMapsPath, fmt::format("map {}: {}", i, *damage));
        begin = map.levels().back().end;
    }
    if (begin != bytes.size()) say(tileset::kFacadeMapsPath, "bytes follow the last map");
}

Result<nlohmann::json> facade_dictionary_json(const archive::ArchiveReader& reader, const tileset::Manifest& manifest) {
    const auto maps = tileset::parse_facade_index(reader.find(tileset::kFacadeIndexPath), manifest);
    if (!maps) return maps.error();
    const auto bytes = reader.find(tileset::kFacadeMapsPath);
    nlohmann::json out = {{"maps", maps->size()},
                          {"made_up", manifest.facades_made_up},
                          {"index_bytes", manifest.facade_index_bytes},
                          {"wire_bytes", 0},
                          {"resident_bytes", 0},
                          {"levels", nlohmann::json::object()},
                          {"forms", nlohmann::json::object()}};
    uint64_t begin = 0;
    for (const FacadeMapRecord& map : *maps) {
        const MapPayloads payloads(bytes, begin, map);
        if (!payloads.inside()) return Error{std::string(tileset::kFacadeMapsPath) + ": is cut off"};
        for (uint32_t i = 0; i < map.level_count; ++i) add_level(out, map.level[i], payloads.of(i));
        begin = map.levels().back().end;
    }
    return out;
}

}  // namespace citystream::tiles::layers
