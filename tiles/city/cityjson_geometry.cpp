#include "tiles/city/cityjson_geometry.h"

#include <fmt/format.h>

#include <cmath>

#include "tiles/city/surface_kinds.h"

namespace citystream::tiles::city {
namespace {

using simdjson::dom::array;
using simdjson::dom::element;

/// Levels of nesting above the surfaces: 0 for a list of surfaces, 1 for shells of them, 2 for solids.
std::optional<int> levels_above_surfaces(std::string_view type) {
    if (type == "MultiSurface" || type == "CompositeSurface") return 0;
    if (type == "Solid") return 1;
    if (type == "MultiSolid" || type == "CompositeSolid") return 2;
    return std::nullopt;
}

std::optional<element> member(element parent, std::string_view key) {
    element value;
    if (parent[key].get(value) || value.is_null()) return std::nullopt;
    return value;
}

std::optional<uint64_t> index_in(const std::optional<element>& value) {
    uint64_t index = 0;
    if (!value || value->get(index)) return std::nullopt;
    return index;
}

std::string number_text(element value) {
    std::string_view text;
    if (!value.get(text)) return std::string(text);
    double number = 0;
    if (!value.get(number)) return fmt::format("{:g}", number);
    return {};
}

double determinant(const std::array<double, 16>& m) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

Vec3 placed(const std::array<double, 16>& m, const Vec3& p, const Vec3& anchor) {
    return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3] + anchor.x,
            m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7] + anchor.y,
            m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11] + anchor.z};
}

std::optional<std::array<double, 16>> matrix_of(element instance) {
    array numbers;
    if (instance["transformationMatrix"].get(numbers)) return std::nullopt;
    std::array<double, 16> matrix{};
    size_t count = 0;
    for (const element number : numbers) {
        if (count == matrix.size() || number.get(matrix[count])) return std::nullopt;
        ++count;
    }
    return count == matrix.size() ? std::optional(matrix) : std::nullopt;
}

}  // namespace

std::string lod_of(element geometry, const JsonTemplates& templates) {
    std::string_view type;
    if (!geometry["type"].get(type) && type == "GeometryInstance") {
        const auto index = index_in(member(geometry, "template"));
        if (!index || *index >= templates.geometries.size()) return {};
        geometry = templates.geometries[*index];
    }
    const auto lod = member(geometry, "lod");
    return lod ? number_text(*lod) : std::string();
}

class JsonGeometryReader::Cursor {
  public:
    explicit Cursor(const Element& attached) {
        if (!attached) return;
        array list;
        if (attached->get(list)) {
            lone_ = attached;
        } else {
            next_ = list.begin();
            end_ = list.end();
            is_list_ = true;
        }
    }
    Element next() {
        if (!is_list_) return lone_;
        if (next_ == end_) return std::nullopt;
        const element value = *next_;
        ++next_;
        return value.is_null() ? Element() : Element(value);
    }

  private:
    Element lone_;
    array::iterator next_, end_;
    bool is_list_ = false;
};

void JsonGeometryReader::add(element geometry, const JsonPools& pools, SurfaceKind unnamed) {
    matrix_.reset();
    mirrored_ = false;
    anchor_ = {};
    std::string_view type;
    if (!geometry["type"].get(type) && type == "GeometryInstance") {
        add_instance(geometry, pools, unnamed);
    } else {
        add_boundaries(geometry, pools, unnamed);
    }
}

void JsonGeometryReader::add_instance(element instance, const JsonPools& pools, SurfaceKind unnamed) {
    const auto index = index_in(member(instance, "template"));
    array boundaries;
    if (!index || *index >= templates_.geometries.size() || instance["boundaries"].get(boundaries)) {
        ++bad_indices_;
        return;
    }
    uint64_t vertex = 0;
    if (boundaries.begin() == boundaries.end() || (*boundaries.begin()).get(vertex) ||
        vertex >= pools.vertices.size()) {
        ++bad_indices_;
        return;
    }
    matrix_ = matrix_of(instance);
    if (!matrix_) {
        ++bad_structures_;
        return;
    }
    mirrored_ = determinant(*matrix_) < 0;
    anchor_ = pools.vertices[vertex];
    add_boundaries(templates_.geometries[*index], templates_.pools, unnamed);
}

void JsonGeometryReader::read_semantics(element geometry, Attached& attached) {
    semantic_kinds_.clear();
    const auto semantics = member(geometry, "semantics");
    array surfaces;
    if (!semantics || (*semantics)["surfaces"].get(surfaces)) return;
    for (const element surface : surfaces) {
        std::string_view type;
        if (surface["type"].get(type)) type = {};
        const SurfaceKind kind = surface_kind(type).value_or(SurfaceKind::kUnknown);
        semantic_kinds_.push_back(kind == SurfaceKind::kUnknown ? unnamed_ : kind);
    }
    attached.semantics = member(*semantics, "values");
}

void JsonGeometryReader::add_boundaries(element geometry, const JsonPools& pools, SurfaceKind unnamed) {
    std::string_view type;
    if (geometry["type"].get(type)) type = {};
    const auto levels = levels_above_surfaces(type);
    array boundaries;
    if (!levels) {
        ++not_drawable_;
        return;
    }
    if (geometry["boundaries"].get(boundaries)) {
        ++bad_structures_;
        return;
    }
    pools_ = &pools;
    unnamed_ = unnamed;
    Attached attached;
    read_semantics(geometry, attached);
    if (const auto themes = member(geometry, "material")) {
        if (const auto theme = theme_of(*themes, pools.appearance.material_theme)) {
            attached.material = member(*theme, "values");
            if (!attached.material) attached.material = member(*theme, "value");
        }
    }
    if (const auto themes = member(geometry, "texture")) {
        if (const auto theme = theme_of(*themes, pools.appearance.texture_theme))
            attached.texture = member(*theme, "values");
    }
    add_level(boundaries, attached, *levels);
}

void JsonGeometryReader::add_level(array boundaries, const Attached& attached, int levels) {
    Cursor semantics(attached.semantics), material(attached.material), texture(attached.texture);
    bool cavity = false;
    for (const element child : boundaries) {
        const Attached below = {semantics.next(), material.next(), texture.next()};
        array items;
        if (child.get(items)) {
            ++bad_structures_;
        } else if (levels == 0) {
            add_surface(items, below);
        } else if (levels == 1) {
            reading_.builder.begin_shell();
            add_level(items, below, 0);
            reading_.builder.end_shell(cavity);
        } else {
            add_level(items, below, levels - 1);
        }
        cavity = levels == 1;  // shells after the first one are cavities
    }
}

void JsonGeometryReader::add_surface(array rings, const Attached& attached) {
    ObjectBuilder& builder = reading_.builder;
    Cursor textures(attached.texture);
    std::optional<uint64_t> image;
    bool textured = attached.texture.has_value(), first = true;
    builder.begin_surface();
    for (const element ring : rings) {
        array indices;
        if (ring.get(indices)) {
            ++bad_structures_;
            return;
        }
        std::optional<uint64_t> ring_image;
        if (textured) textured = ring_texture(textures.next(), indices.size(), ring_image);
        if (first) image = ring_image;
        if (ring_image != image) {
            textured = false;
            ++bad_textures_;
        }
        if (!textured) ring_texcoords_.clear();
        if (!add_points(indices)) {
            ++bad_indices_;
            return;
        }
        builder.end_ring();
        first = false;
    }
    builder.end_surface(style_of(attached, textured ? image : std::nullopt), mirrored_);
}

/// Texture coordinates of a ring of `points` points; false when it has no texture.
bool JsonGeometryReader::ring_texture(const Element& texture, size_t points, std::optional<uint64_t>& image) {
    array numbers;
    if (!texture || texture->get(numbers)) return false;
    ring_texcoords_.clear();
    bool first = true;
    for (const element number : numbers) {
        if (first && number.is_null()) return false;
        uint64_t index = 0;
        const size_t size = first ? pools_->appearance.textures.size() : pools_->appearance.texcoords.size();
        if (number.get(index) || index >= size) {
            ++bad_textures_;
            return false;
        }
        if (first)
            image = index;
        else
            ring_texcoords_.push_back(pools_->appearance.texcoords[index]);
        first = false;
    }
    if (first) return false;
    if (ring_texcoords_.size() == points) return true;
    ++bad_textures_;
    return false;
}

bool JsonGeometryReader::add_points(array ring) {
    size_t count = 0;
    for (const element number : ring) {
        uint64_t index = 0;
        if (number.get(index) || index >= pools_->vertices.size()) return false;
        Vec3 position = pools_->vertices[index];
        if (matrix_) position = placed(*matrix_, position, anchor_);
        reading_.builder.add_point(position, count < ring_texcoords_.size() ? ring_texcoords_[count] : Vec2{});
        ++count;
    }
    return true;
}

SurfaceStyle JsonGeometryReader::style_of(const Attached& attached, const std::optional<uint64_t>& image) {
    SurfaceStyle style;
    style.kind = unnamed_;
    if (const auto index = index_in(attached.semantics); index && *index < semantic_kinds_.size()) {
        style.kind = semantic_kinds_[*index];
    }
    std::optional<std::array<uint8_t, 3>> colour;
    const JsonAppearance& appearance = pools_->appearance;
    if (const auto index = index_in(attached.material)) {
        if (*index < appearance.materials.size())
            colour = appearance.materials[*index];
        else
            ++bad_textures_;
    }
    if (image) {
        const JsonTexture& texture = appearance.textures[*image];
        const auto fallback = colour.value_or(default_colour(reading_.builder.kind(), style.kind));
        style.material =
            reading_.materials.textured(file_, texture.image, texture.repeat, fallback, reading_.builder.id());
        style.textured = style.material.has_value();
    }
    if (!style.material && colour) style.material = reading_.materials.flat(*colour);
    return style;
}

void JsonGeometryReader::report_skipped() {
    const auto say = [&](uint64_t& count, const char* what) {
        if (count > 0) reading_.builder.report(std::to_string(count) + what);
        count = 0;
    };
    say(bad_indices_, " surface(s) or instance(s) skipped: vertex or template index out of range");
    say(bad_structures_, " geometry part(s) skipped: not structured as its type says");
    say(bad_textures_, " texture or material reference(s) ignored: index out of range or not one coordinate per point");
    say(not_drawable_, " geometry(s) not drawable: points, lines or unknown type");
}

}  // namespace citystream::tiles::city
