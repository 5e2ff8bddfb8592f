// What every city object that a reader emits must satisfy, for the fuzz targets of the readers.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tiles/city/city_reading.h"
#include "tiles/city/text_source.h"

namespace citystream::tiles::city {

inline bool is_sound(const CityObject& object, const CityCatalog& catalog) {
    for (const Vec3& v : object.vertices) {
        if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
    }
    for (const Triangle& triangle : object.triangles) {
        if (triangle.material >= catalog.materials.size()) return false;
        for (size_t k = 0; k < 3; ++k) {
            if (triangle.vertex[k] >= object.vertices.size()) return false;
            if (!std::isfinite(triangle.texcoord[k].x) || !std::isfinite(triangle.texcoord[k].y)) return false;
        }
    }
    return !object.triangles.empty();
}

/// Reads `bytes` with `read` and aborts when an object is not sound or an error does not name the file.
inline void read_checked(std::string_view bytes, Status (*read)(TextSource&, CityReading&)) {
    CityHeader header;
    CityCatalog catalog;
    CityReport report;
    const InputOptions options;
    const CitySink sink = [&](CityObject&& object) {
        if (!is_sound(object, catalog)) std::abort();
        return true;
    };
    CityReading reading(options, header, catalog, report, sink);
    auto source = TextSource::from_memory("input", bytes);
    if (!source) return;
    const auto status = read(*source, reading);
    if (!status && status.error().message.find("input") == std::string::npos) std::abort();
}

}  // namespace citystream::tiles::city
