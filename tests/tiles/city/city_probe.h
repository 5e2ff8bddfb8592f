// Reads small city models written in a test, through the public door: files in
// a folder of its own.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tiles/city/city_input.h"

namespace citystream::tiles::city {

/// A folder that goes away with the object.
class TestFolder {
  public:
    TestFolder() {
        static std::atomic<int> count = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("citystream_city_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TestFolder() {
        std::error_code code;
        std::filesystem::remove_all(path_, code);
    }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;

    std::string write(const std::string& name, std::string_view bytes) const {
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return file.string();
    }
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

/// A city as read.
struct ReadCity {
    CityHeader header;
    CityCatalog catalog;
    CityReport report;
    std::vector<CityObject> objects;
    Status status = Done{};

    bool reports(std::string_view feature, std::string_view what) const {
        return std::any_of(report.defects.begin(), report.defects.end(), [&](const Defect& defect) {
            return defect.feature.find(feature) != std::string::npos && defect.what.find(what) != std::string::npos;
        });
    }
    bool drops(const std::string& feature) const {
        const auto& names = report.dropped_features;
        return std::find(names.begin(), names.end(), feature) != names.end();
    }
    const Material& material(size_t object, size_t triangle) const {
        return catalog.materials[objects.at(object).triangles.at(triangle).material];
    }
};

inline ReadCity read_files(const std::vector<std::string>& paths, const InputOptions& options = {}) {
    ReadCity city;
    city.status = read_city(paths, options, city.header, city.catalog, city.report, [&](CityObject&& object) {
        city.objects.push_back(std::move(object));
        return true;
    });
    return city;
}

inline ReadCity read_text(std::string_view text, const InputOptions& options = {}) {
    const TestFolder folder;
    return read_files({folder.write("city", text)}, options);
}

inline InputOptions with_lod(const std::string& lod) {
    InputOptions options;
    options.lod = lod;
    return options;
}

inline Vec3 triangle_normal(const CityObject& object, const Triangle& t) {
    const Vec3 &a = object.vertices[t.vertex[0]], &b = object.vertices[t.vertex[1]], &c = object.vertices[t.vertex[2]];
    const Vec3 u = {b.x - a.x, b.y - a.y, b.z - a.z}, v = {c.x - a.x, c.y - a.y, c.z - a.z};
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

inline double area_of(const CityObject& object) {
    double area = 0;
    for (const Triangle& t : object.triangles) {
        const Vec3 n = triangle_normal(object, t);
        area += std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z) / 2;
    }
    return area;
}

/// Enclosed volume when the triangles of a closed object face outwards;
/// negative when inwards.
inline double volume_of(const CityObject& object) {
    double volume = 0;
    for (const Triangle& t : object.triangles) {
        const Vec3 n = triangle_normal(object, t);
        const Vec3& a = object.vertices[t.vertex[0]];
        volume += (a.x * n.x + a.y * n.y + a.z * n.z) / 6;
    }
    return volume;
}

inline size_t count_surfaces(const CityObject& object, SurfaceKind kind) {
    return static_cast<size_t>(std::count_if(object.triangles.begin(), object.triangles.end(),
                                             [&](const Triangle& t) { return t.surface == kind; }));
}

}  // namespace citystream::tiles::city
