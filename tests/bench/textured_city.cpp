#include "tests/bench/textured_city.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "codec/grid.h"
#include "tiles/city/generator.h"

namespace citystream::bench {
namespace {

using tiles::city::CityObject;
using tiles::city::Triangle;

constexpr int32_t kTexcoordStep = 128;  // 1/512 repeat in mesh units
constexpr double kStepsOfRepeat = 512;

using Corner = std::array<int32_t, 8>;  // position, normal's bits, place: what makes corners one vertex

struct Builder {
    const TexturedCityOptions& options;
    TexturedCity city = {};
    tiles::city::CityCatalog catalog = {};
    std::vector<CityObject> objects = {};
    std::array<double, 3> low = {}, high = {};
    std::map<uint32_t, uint32_t> picture_of_material = {};
    std::map<std::pair<int64_t, int64_t>, size_t> tile_at = {};

    void read_objects();
    void measure();
    uint32_t picture(uint32_t material);
    void add(const CityObject& object);
    void add_run(const CityObject& object, std::span<const Triangle> triangles, CityTile& tile);
    CityTile& tile_of(const CityObject& object);
};

void Builder::read_objects() {
    tiles::city::GeneratorOptions generator;
    generator.buildings = options.buildings;
    generator.seed = options.seed;
    generator.textures = options.textures;
    tiles::city::CityHeader header;
    tiles::city::CityReport report;
    tiles::city::generate_city(generator, header, catalog, report, [this](CityObject&& object) {
        if (object.kind == tiles::city::ObjectKind::kBuilding && !object.triangles.empty())
            objects.push_back(std::move(object));
        return true;
    });
}

void Builder::measure() {
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const CityObject& object : objects) {
        for (const auto& vertex : object.vertices) {
            const std::array<double, 3> at = {vertex.x, vertex.y, vertex.z};
            for (size_t c = 0; c < 3; ++c) {
                low[c] = std::min(low[c], at[c]);
                high[c] = std::max(high[c], at[c]);
            }
        }
    }
    for (size_t c = 0; c < 3; ++c) {
        low[c] = std::floor(low[c]);
        city.size[c] = high[c] - low[c];
    }
}

uint32_t Builder::picture(uint32_t material) {
    const auto [found, fresh] = picture_of_material.try_emplace(material, static_cast<uint32_t>(city.pictures.size()));
    if (!fresh) return found->second;
    const tiles::city::Material& from = catalog.materials[material];
    codec::atlas::ChartImage image{1, 1, true, true, 0.05f, {from.rgb.begin(), from.rgb.end()}};
    if (from.image >= 0) {
        const auto drawn = catalog.images[static_cast<size_t>(from.image)].drawn();
        image = {drawn->width, drawn->height, from.repeat, from.repeat, 0.05f, drawn->rgb};
        while (std::max(image.width, image.height) > options.longest_side) image = codec::atlas::downsample(image);
    }
    city.pictures.push_back(std::move(image));
    return found->second;
}

CityTile& Builder::tile_of(const CityObject& object) {
    const auto& at = object.vertices[object.triangles[0].vertex[0]];
    const auto cell = [&](double metres, size_t axis) {
        return static_cast<int64_t>(std::floor((metres - low[axis]) / options.tile_metres));
    };
    const std::pair key(cell(at.x, 0), cell(at.y, 1));
    const auto [found, fresh] = tile_at.try_emplace(key, city.tiles.size());
    if (fresh) {
        city.tiles.emplace_back();
        city.tiles.back().origin = {static_cast<double>(key.first) * options.tile_metres,
                                    static_cast<double>(key.second) * options.tile_metres, 0};
    }
    return city.tiles[found->second];
}

std::array<float, 3> normal_of(const CityObject& object, const Triangle& triangle) {
    std::array<std::array<double, 3>, 3> at;
    for (size_t i = 0; i < 3; ++i) {
        const auto& vertex = object.vertices[triangle.vertex[i]];
        at[i] = {vertex.x, vertex.y, vertex.z};
    }
    std::array<double, 3> a, b;
    for (size_t c = 0; c < 3; ++c) {
        a[c] = at[1][c] - at[0][c];
        b[c] = at[2][c] - at[0][c];
    }
    const std::array<double, 3> n = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const double length = std::max(std::hypot(n[0], n[1], n[2]), 1e-12);
    return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length), static_cast<float>(n[2] / length)};
}

// Triangles of one picture, to both kinds of viewers; their corners are welded within the run.
void Builder::add_run(const CityObject& object, std::span<const Triangle> triangles, CityTile& tile) {
    const uint32_t shown = picture(triangles[0].material);
    const auto place = std::ranges::find(tile.pictures, shown);
    const auto chart = static_cast<uint32_t>(place - tile.pictures.begin());
    if (place == tile.pictures.end()) tile.pictures.push_back(shown);
    city.runs.push_back(
        {shown, static_cast<uint32_t>(city.indices.size()), 3 * static_cast<uint32_t>(triangles.size())});
    std::map<Corner, std::pair<uint32_t, uint32_t>> welded;  // to a vertex of the city and of the tile
    for (const Triangle& triangle : triangles) {
        const std::array<float, 3> normal = normal_of(object, triangle);
        for (size_t i = 0; i < 3; ++i) {
            const auto& vertex = object.vertices[triangle.vertex[i]];
            const std::array<double, 3> metres = {vertex.x - low[0], vertex.y - low[1], vertex.z - low[2]};
            codec::mesh::MeshVertex packed{};
            for (size_t c = 0; c < 3; ++c) {
                packed.position[c] = static_cast<int32_t>(to_grid(metres[c] - tile.origin[c]));
                packed.normal[c] = normal[c];
            }
            const std::array<double, 2> repeats = {triangle.texcoord[i].x, triangle.texcoord[i].y};
            for (size_t c = 0; c < 2; ++c)
                packed.texcoord[c] = static_cast<int32_t>(std::lround(repeats[c] * kStepsOfRepeat)) * kTexcoordStep;
            const auto bits = [](float value) { return static_cast<int32_t>(std::lround(value * 1e6f)); };
            const Corner key = {packed.position[0], packed.position[1], packed.position[2], bits(normal[0]),
                                bits(normal[1]),    bits(normal[2]),    packed.texcoord[0], packed.texcoord[1]};
            const auto [found, fresh] = welded.try_emplace(key, static_cast<uint32_t>(city.vertices.size()),
                                                           static_cast<uint32_t>(tile.mesh.vertices.size()));
            if (fresh) {
                tile.mesh.vertices.push_back(packed);
                PlainVertex plain{};
                for (size_t c = 0; c < 3; ++c) {
                    plain.position[c] = static_cast<float>(to_metres(packed.position[c]) + tile.origin[c]);
                    plain.normal[c] = normal[c];
                }
                for (size_t c = 0; c < 2; ++c) plain.texcoord[c] = static_cast<float>(packed.texcoord[c]) / 65536.0f;
                city.vertices.push_back(plain);
            }
            city.indices.push_back(found->second.first);
            tile.mesh.indices.push_back(found->second.second);
        }
        tile.mesh.triangle_chart.push_back(chart);
    }
}

// As exporters write a building: its triangles by material.
void Builder::add(const CityObject& object) {
    std::vector<Triangle> triangles = object.triangles;
    std::ranges::stable_sort(triangles, {}, &Triangle::material);
    CityTile& tile = tile_of(object);
    for (size_t begin = 0; begin < triangles.size();) {
        size_t end = begin + 1;
        while (end < triangles.size() && triangles[end].material == triangles[begin].material) ++end;
        add_run(object, std::span(triangles).subspan(begin, end - begin), tile);
        begin = end;
    }
    ++city.buildings;
}

}  // namespace

client::Camera TexturedCity::overview(uint32_t width, uint32_t height) const {
    const double reach = std::max(size[0], size[1]);
    client::CameraSample sample;
    sample.x = size[0] / 2;
    sample.y = size[1] / 2 - reach * 0.55;
    sample.z = reach * 1.1;
    sample.pitch = -std::atan2(1.1, 0.55) * 180 / std::numbers::pi;
    return client::Camera::from_sample(sample, width, height);
}

TexturedCity make_textured_city(const TexturedCityOptions& options) {
    Builder builder{options};
    builder.read_objects();
    builder.measure();
    for (const CityObject& object : builder.objects) builder.add(object);
    for (CityTile& tile : builder.city.tiles)
        tile.mesh.dressed_begin = static_cast<uint32_t>(tile.mesh.triangle_chart.size());
    return std::move(builder.city);
}

}  // namespace citystream::bench
