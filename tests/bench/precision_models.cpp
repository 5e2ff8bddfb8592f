#include "tests/bench/precision_models.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace citystream::bench {
namespace {

using codec::mesh::GridPoint;
using Vector = std::array<double, 3>;

const double kSmoothCosine = std::cos(35 * M_PI / 180);

Vector scaled_to_unit(Vector v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (double& x : v) x = length > 0 ? x / length : 0;
    return v;
}

/// As long as twice the triangle's area.
Vector area_normal(const codec::mesh::GridMesh& mesh, const std::array<uint32_t, 3>& t) {
    Vector a{}, b{};
    for (size_t c = 0; c < 3; ++c) {
        a[c] = static_cast<double>(mesh.points[t[1]][c]) - mesh.points[t[0]][c];
        b[c] = static_cast<double>(mesh.points[t[2]][c]) - mesh.points[t[0]][c];
    }
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Three normals a triangle.
std::vector<std::array<float, 3>> corner_normals_of(const codec::mesh::GridMesh& mesh) {
    std::vector<Vector> areas, units;
    std::vector<std::vector<uint32_t>> around(mesh.points.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        areas.push_back(area_normal(mesh, mesh.triangles[t]));
        units.push_back(scaled_to_unit(areas.back()));
        for (const uint32_t v : mesh.triangles[t]) around[v].push_back(t);
    }
    std::vector<std::array<float, 3>> normals;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const uint32_t v : mesh.triangles[t]) {
            Vector sum = areas[t];
            for (const uint32_t other : around[v]) {
                if (other == t || dot(units[t], units[other]) < kSmoothCosine) continue;
                for (size_t c = 0; c < 3; ++c) sum[c] += areas[other][c];
            }
            const Vector n = scaled_to_unit(sum);
            normals.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
        }
    }
    return normals;
}

void measure_box(const codec::mesh::GridMesh& mesh, PrecisionModel& model, GridPoint& low) {
    low = mesh.points[0];
    GridPoint high = low;
    for (const GridPoint& point : mesh.points) {
        for (size_t c = 0; c < 3; ++c) {
            low[c] = std::min(low[c], point[c]);
            high[c] = std::max(high[c], point[c]);
        }
    }
    for (size_t c = 0; c < 3; ++c) {
        model.centre[c] = (static_cast<double>(low[c]) + high[c]) / 2;
        model.extent = std::max(model.extent, static_cast<double>(high[c]) - low[c]);
    }
}

}  // namespace

std::vector<double> PrecisionPart::corner_normals() const {
    std::vector<double> values;
    for (const auto& triangle : triangles) {
        for (const uint32_t v : triangle) {
            for (size_t c = 0; c < 3; ++c) values.push_back(static_cast<double>(normals[3 * v + c]));
        }
    }
    return values;
}

uint64_t PrecisionModel::vertices() const {
    uint64_t count = 0;
    for (const PrecisionPart& part : parts) count += part.points.size();
    return count;
}

PrecisionModel precision_model(const std::string& name, const codec::mesh::GridMesh& mesh, size_t triangles_a_part) {
    PrecisionModel model;
    model.name = name;
    GridPoint low{};
    measure_box(mesh, model, low);
    model.ground = low[2];
    // A surface goes through about the square of the cells along a side.
    const double parts =
        std::max(1.0, static_cast<double>(mesh.triangles.size()) / static_cast<double>(triangles_a_part));
    const double cell = (model.extent + 1) / std::ceil(std::sqrt(parts));
    const auto normals = corner_normals_of(mesh);
    std::map<GridPoint, uint32_t> part_of_cell;
    std::vector<std::map<std::pair<GridPoint, std::array<float, 3>>, uint32_t>> vertices;
    std::map<GridPoint, std::pair<uint32_t, bool>> seen;  // first part with the place, whether there are more
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        GridPoint key{};
        for (size_t c = 0; c < 3; ++c)
            key[c] = static_cast<int32_t>((static_cast<double>(mesh.points[mesh.triangles[t][0]][c]) - low[c]) / cell);
        const auto [entry, fresh] = part_of_cell.insert({key, static_cast<uint32_t>(model.parts.size())});
        if (fresh) {
            model.parts.emplace_back();
            vertices.emplace_back();
        }
        PrecisionPart& part = model.parts[entry->second];
        std::array<uint32_t, 3> triangle{};
        for (size_t i = 0; i < 3; ++i) {
            const GridPoint& point = mesh.points[mesh.triangles[t][i]];
            const auto& normal = normals[3 * t + i];
            const auto [vertex, is_new] =
                vertices[entry->second].insert({{point, normal}, static_cast<uint32_t>(part.points.size())});
            if (is_new) {
                part.points.push_back(point);
                part.normals.insert(part.normals.end(), normal.begin(), normal.end());
            }
            triangle[i] = vertex->second;
            auto& place = seen.insert({point, {entry->second, false}}).first->second;
            place.second |= place.first != entry->second;
        }
        part.triangles.push_back(triangle);
    }
    for (PrecisionPart& part : model.parts) {
        for (const GridPoint& point : part.points) part.on_border.push_back(seen.at(point).second ? 1 : 0);
    }
    return model;
}

PackedPart pack_part(const PrecisionPart& part, std::span<const uint32_t> most_dropped, uint32_t common_dropped,
                     codec::mesh::Reconstruction reading) {
    PackedPart packed;
    packed.positions = most_dropped.empty()
                           ? codec::mesh::adaptive_positions(part.points, common_dropped, reading)
                           : codec::mesh::constrained_positions(part.points, most_dropped, common_dropped, reading);
    const auto& order = packed.positions.order;
    std::vector<uint32_t> place(order.size());
    for (uint32_t i = 0; i < order.size(); ++i) {
        place[order[i]] = i;
        for (size_t c = 0; c < 3; ++c) packed.normals.push_back(part.normals[3 * order[i] + c]);
    }
    for (const auto& triangle : part.triangles)
        for (const uint32_t v : triangle) packed.indices.push_back(place[v]);
    packed.low.fill(~0u);
    for (size_t i = 0; i < packed.positions.words.size(); ++i) {
        packed.low[i % 3] = std::min(packed.low[i % 3], packed.positions.words[i]);
        packed.high[i % 3] = std::max(packed.high[i % 3], packed.positions.words[i]);
    }
    return packed;
}

}  // namespace citystream::bench
