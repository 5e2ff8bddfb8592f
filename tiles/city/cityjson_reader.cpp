#include "tiles/city/cityjson_reader.h"

#include <fmt/format.h>
#include <simdjson.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "tiles/city/cityjson_geometry.h"
#include "tiles/city/crs_name.h"
#include "tiles/city/json_fault.h"
#include "tiles/city/surface_kinds.h"

namespace citystream::tiles::city {
namespace {

using simdjson::dom::array;
using simdjson::dom::element;
using simdjson::dom::object;

struct Transform {
    Vec3 scale = {1, 1, 1}, translate;
};

std::optional<Vec3> vec3_of(element value) {
    array numbers;
    if (value.get(numbers)) return std::nullopt;
    std::array<double, 3> v{};
    size_t count = 0;
    for (const element number : numbers) {
        if (count == v.size() || number.get(v[count])) return std::nullopt;
        ++count;
    }
    return count == v.size() ? std::optional(Vec3{v[0], v[1], v[2]}) : std::nullopt;
}

void read_vertices(element parent, const char* key, const Transform& transform, std::vector<Vec3>& out) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    out.clear();
    array list;
    if (parent[key].get(list)) return;
    for (const element entry : list) {
        const Vec3 v = vec3_of(entry).value_or(Vec3{kNone, kNone, kNone});
        out.push_back({v.x * transform.scale.x + transform.translate.x, v.y * transform.scale.y + transform.translate.y,
                       v.z * transform.scale.z + transform.translate.z});
    }
}

double lod_number(const std::string& lod) {
    return lod.empty() ? -1 : std::strtod(lod.c_str(), nullptr);
}

/// One member of "CityObjects".
struct Member {
    std::string_view id, type;
    element value;
    std::optional<std::string_view> parent;
    bool has_geometry = false;
};

/// Attributes of an object as facts; of a list its first entry.
BuildingFacts own_facts(element value) {
    BuildingFacts facts;
    object attributes;
    if (value["attributes"].get(attributes)) return facts;
    for (const auto field : attributes) {
        if (!is_building_fact(field.key)) continue;
        element said = field.value;
        array list;
        if (!said.get(list) && list.begin() != list.end()) said = *list.begin();
        std::string_view text;
        int64_t number = 0;
        double real = 0;
        if (!said.get(text)) {
            note_building_fact(facts, field.key, text);
        } else if (!said.get(number)) {
            note_building_fact(facts, field.key, std::to_string(number));
        } else if (!said.get(real)) {
            note_building_fact(facts, field.key, fmt::format("{}", real));
        }
    }
    return facts;
}

class CityJsonReader {
  public:
    CityJsonReader(TextSource& source, CityReading& reading)
        : lines_(source), source_(source), reading_(reading), geometry_reader_(reading, source.name(), templates_) {}

    Status read() {
        std::string first;
        const auto any = next_filled_line(first);
        if (!any) return any.error();
        if (!*any) return Error{file() + ": empty, no city model"};
        std::string second;
        if (parses(first)) {
            const auto more = next_filled_line(second);
            if (!more) return more.error();
            if (*more) return read_sequence(first, second);
            return read_document(first);
        }
        first += '\n';
        if (auto status = lines_.rest(first); !status) return status;
        return read_document(first);
    }

  private:
    const std::string& file() const { return source_.name(); }

    Result<bool> next_filled_line(std::string& line) {
        while (true) {
            auto more = lines_.next(line);
            if (!more || !*more) return more;
            if (lines_.line_number() == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
            if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
            line_ = lines_.line_number();
            byte_ = lines_.line_offset();
            return true;
        }
    }

    bool parses(std::string& text) {
        text.reserve(text.size() + simdjson::SIMDJSON_PADDING);
        element root;
        return !feature_parser_.parse(text.data(), text.size(), false).get(root);
    }

    Result<element> parse(simdjson::dom::parser& parser, std::string& text) {
        text.reserve(text.size() + simdjson::SIMDJSON_PADDING);
        element root;
        if (const auto code = parser.parse(text.data(), text.size(), false).get(root)) {
            return json_fault(text, file(), line_, byte_, simdjson::error_message(code));
        }
        return root;
    }

    std::string place(const Member& member) const {
        if (in_sequence_) return fmt::format("{}: line {}", file(), line_);
        return fmt::format("{}: CityObjects/{}", file(), member.id);
    }

    Status read_document(std::string& text) {
        line_ = 1;
        byte_ = 0;
        if (auto status = read_header(text); !status) return status;
        return read_objects(header_, header_pools_);
    }

    Status read_sequence(std::string& first, std::string& line) {
        in_sequence_ = true;
        const uint64_t line_two = std::exchange(line_, 1);
        const uint64_t byte_two = std::exchange(byte_, 0);
        if (auto status = read_header(first); !status) return status;
        if (auto status = read_objects(header_, header_pools_); !status) return status;
        line_ = line_two;
        byte_ = byte_two;
        while (!reading_.stopped()) {
            if (auto status = read_feature_line(line); !status) return status;
            reading_.tell_progress(source_.stored_bytes_done());
            const auto more = next_filled_line(line);
            if (!more) return more.error();
            if (!*more) break;
        }
        return Done{};
    }

    Status read_feature_line(std::string& line) {
        const auto root = parse(feature_parser_, line);
        if (!root) return root.error();
        std::string_view type;
        if ((*root)["type"].get(type)) type = {};
        if (type == "CityJSON") {  // several sequences one after another
            if (auto status = read_header(line); !status) return status;
            return read_objects(header_, header_pools_);
        }
        if (type != "CityJSONFeature")
            return Error{fmt::format("{}: line {}: is no CityJSONFeature", file(), line_), byte_};
        read_vertices(*root, "vertices", transform_, feature_pools_.vertices);
        element appearance;
        const bool own_appearance = !(*root)["appearance"].get(appearance);
        if (own_appearance)
            feature_pools_.appearance.read(appearance);
        else if (feature_had_appearance_)
            feature_pools_.appearance = header_pools_.appearance;
        feature_had_appearance_ = own_appearance;
        return read_objects(*root, feature_pools_);
    }

    /// The document, or the first line of a sequence. Its text stays: templates point into it.
    Status read_header(std::string& text) {
        header_text_.swap(text);
        const auto root = parse(header_parser_, header_text_);
        if (!root) return root.error();
        header_ = *root;
        std::string_view type, version, name;
        if (header_["type"].get(type) || type != "CityJSON") {
            return Error{fmt::format("{}: line {}: JSON, but no CityJSON", file(), line_), byte_};
        }
        if (header_["version"].get(version)) version = "missing";
        if (!version.starts_with("1.0") && !version.starts_with("1.1") && !version.starts_with("2.0")) {
            return Error{
                fmt::format("{}: CityJSON version {} is not supported (1.0, 1.1 and 2.0 are)", file(), version), byte_};
        }
        if (!header_["metadata"]["referenceSystem"].get(name)) {
            if (auto status = reading_.agree_on_crs(epsg_of(name), file()); !status) return status;
        }
        if (reading_.header.title.empty() && !header_["metadata"]["title"].get(name)) reading_.header.title = name;
        read_pools();
        return Done{};
    }

    void read_pools() {
        transform_ = {};
        element value;
        if (!header_["transform"].get(value)) {
            element part;
            if (!value["scale"].get(part)) transform_.scale = vec3_of(part).value_or(Vec3{1, 1, 1});
            if (!value["translate"].get(part)) transform_.translate = vec3_of(part).value_or(Vec3{});
        }
        header_pools_ = {};
        if (!header_["appearance"].get(value)) header_pools_.appearance.read(value);
        read_vertices(header_, "vertices", transform_, header_pools_.vertices);
        feature_pools_.appearance = header_pools_.appearance;
        feature_had_appearance_ = false;
        templates_ = {};
        array list;
        if (header_["geometry-templates"]["templates"].get(list)) return;
        for (const element geometry : list) templates_.geometries.push_back(geometry);
        templates_.pools.appearance = header_pools_.appearance;
        read_vertices(header_["geometry-templates"].value(), "vertices-templates", Transform{},
                      templates_.pools.vertices);
    }

    std::vector<Member>& collect_members(object objects) {
        members_.clear();
        by_id_.clear();
        for (const auto field : objects) {
            Member member{.id = field.key, .type = {}, .value = field.value, .parent = {}};
            if (member.value["type"].get(member.type)) member.type = "?";
            array list;
            std::string_view parent;
            if (!member.value["parents"].get(list) && list.begin() != list.end() && !(*list.begin()).get(parent)) {
                member.parent = parent;
            }
            member.has_geometry = !member.value["geometry"].get(list) && list.begin() != list.end();
            by_id_.emplace(member.id, members_.size());
            members_.push_back(member);
        }
        return members_;
    }

    /// Index of the top-level object above `index` (itself when its parents are absent or run in a circle).
    size_t root_of(size_t index) const {
        constexpr int kMostLevels = 32;
        size_t at = index;
        for (int level = 0; level < kMostLevels; ++level) {
            if (!members_[at].parent) return at;
            const auto above = by_id_.find(*members_[at].parent);
            if (above == by_id_.end()) return at;
            at = above->second;
        }
        return index;
    }

    Status read_objects(element root, const JsonPools& pools) {
        object objects;
        if (root["CityObjects"].get(objects)) {
            return Error{fmt::format("{}: line {}: has no CityObjects", file(), line_), byte_};
        }
        collect_members(objects);
        std::vector<uint8_t> drawn(members_.size(), 0), has_geometry(members_.size(), 0);
        for (size_t i = 0; i < members_.size() && !reading_.stopped(); ++i) {
            const size_t top = root_of(i);
            if (top == i) reading_.see_feature(std::string(members_[i].id), place(members_[i]));
            if (!members_[i].has_geometry) continue;
            has_geometry[top] = 1;
            if (read_member(members_[i], pools)) drawn[top] = 1;
        }
        if (reading_.stopped()) return Done{};
        for (size_t i = 0; i < members_.size(); ++i) {
            if (root_of(i) != i) continue;
            const Member& member = members_[i];
            if (drawn[i] != 0 && object_kind(member.type) == ObjectKind::kBuilding) ++reading_.report.buildings_emitted;
            if (has_geometry[i] == 0 && member.type != "CityObjectGroup") {
                reading_.drop(std::string(member.id), fmt::format("{} has no geometry", member.type), place(member));
            }
        }
        return Done{};
    }

    /// What is said of an object, or else of the building that it is a part of.
    BuildingFacts facts_of(const Member& member) const {
        BuildingFacts facts = own_facts(member.value);
        const size_t top = root_of(by_id_.at(member.id));
        if (members_[top].id != member.id) facts.inherit(own_facts(members_[top].value));
        return facts;
    }

    /// The geometries to take: those of the LoD asked for, else of the highest.
    std::vector<element> chosen_geometries(const Member& member, std::string& lods) const {
        array list;
        std::vector<element> chosen;
        if (member.value["geometry"].get(list)) return chosen;
        double best = -2;
        for (const element geometry : list) {
            const std::string lod = lod_of(geometry, templates_);
            if (reading_.options.lod) {
                lods += (lods.empty() ? "" : ", ") + lod;
                if (lod == *reading_.options.lod) chosen.push_back(geometry);
                continue;
            }
            const double number = lod_number(lod);
            if (number > best) chosen.clear();
            if (number >= best) chosen.push_back(geometry);
            best = std::max(best, number);
        }
        return chosen;
    }

    bool read_member(const Member& member, const JsonPools& pools) {
        std::string lods;
        const std::vector<element> chosen = chosen_geometries(member, lods);
        const std::string id(member.id);
        if (chosen.empty()) {
            const std::string why = reading_.options.lod
                                        ? fmt::format("no geometry of LoD {} (has {})", *reading_.options.lod, lods)
                                        : std::string("no usable geometry");
            reading_.drop(id, why, place(member));
            return false;
        }
        const bool installation = member.type == "BuildingInstallation";
        reading_.builder.begin(id, object_kind(member.type), place(member));
        reading_.builder.set_facts(facts_of(member));
        for (const element geometry : chosen) {
            geometry_reader_.add(geometry, pools, installation ? SurfaceKind::kInstallation : SurfaceKind::kUnknown);
        }
        geometry_reader_.report_skipped();
        if (reading_.send()) return true;
        reading_.drop(id, fmt::format("{}: none of its surfaces can be drawn", member.type), place(member));
        return false;
    }

    LineReader lines_;
    TextSource& source_;
    CityReading& reading_;
    JsonTemplates templates_;
    JsonGeometryReader geometry_reader_;

    simdjson::dom::parser header_parser_, feature_parser_;
    std::string header_text_;
    element header_;
    Transform transform_;
    JsonPools header_pools_, feature_pools_;
    bool feature_had_appearance_ = false;

    std::vector<Member> members_;
    std::unordered_map<std::string_view, size_t> by_id_;

    bool in_sequence_ = false;
    uint64_t line_ = 1, byte_ = 0;  ///< of the JSON text in hand
};

}  // namespace

Status read_cityjson(TextSource& source, CityReading& reading) {
    return CityJsonReader(source, reading).read();
}

}  // namespace citystream::tiles::city
