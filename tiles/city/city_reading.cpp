#include "tiles/city/city_reading.h"

#include <algorithm>
#include <utility>

#include "tiles/city/crs_name.h"

namespace citystream::tiles::city {

bool IdRegister::add(std::string_view id) {
    uint64_t hash = 0xCBF29CE484222325u;  // FNV-1a, then mixed
    for (const char c : id) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
    hash = (hash ^ (hash >> 31)) * 0x9E3779B97F4A7C15u;
    if (hash == 0) hash = 1;
    if (2 * (used_ + 1) > slots_.size()) {
        constexpr size_t kFirstSize = 1024;
        const std::vector<uint64_t> old =
            std::exchange(slots_, std::vector<uint64_t>(std::max(kFirstSize, 2 * slots_.size())));
        used_ = 0;
        for (const uint64_t h : old) {
            if (h != 0) insert(h);
        }
    }
    const size_t before = used_;
    insert(hash);
    return used_ > before;
}

void IdRegister::insert(uint64_t hash) {
    size_t slot = static_cast<size_t>(hash >> 7) & (slots_.size() - 1);
    while (slots_[slot] != 0) {
        if (slots_[slot] == hash) return;
        slot = (slot + 1) & (slots_.size() - 1);
    }
    slots_[slot] = hash;
    ++used_;
}

CityReading::CityReading(const InputOptions& input_options, CityHeader& city_header, CityCatalog& catalog,
                         CityReport& city_report, const CitySink& sink)
    : options(input_options),
      header(city_header),
      report(city_report),
      materials(catalog, city_report),
      builder(materials, city_report),
      sink_(sink) {}

Status CityReading::agree_on_crs(int32_t epsg, const std::string& file) {
    if (epsg == 0) return Done{};
    if (is_geographic(epsg)) {
        return Error{file + ": its coordinates are degrees (EPSG:" + std::to_string(epsg) +
                     "); reproject it to a CRS in metres first"};
    }
    if (header.epsg == 0) header.epsg = epsg;
    if (header.epsg == epsg) return Done{};
    return Error{file + ": its CRS is EPSG:" + std::to_string(epsg) +
                 ", but that of the files before is EPSG:" + std::to_string(header.epsg)};
}

void CityReading::see_feature(const std::string& id, const std::string& where) {
    ++report.features_read;
    if (!ids_.add(id)) report.add({.feature = id, .what = "id was there before; both are kept", .where = where});
}

bool CityReading::send() {
    std::optional<CityObject> object = builder.finish();
    if (!object) return false;
    ++report.objects_emitted;
    report.triangles_emitted += object->triangles.size();
    if (!sink_(std::move(*object))) stopped_ = true;
    return true;
}

void CityReading::drop(const std::string& feature, const std::string& why, const std::string& where) {
    report.add({.feature = feature, .what = why, .where = where, .dropped_feature = true});
}

void CityReading::tell_progress(uint64_t bytes_of_this_file) {
    const uint64_t done = std::min(bytes_before_ + bytes_of_this_file, bytes_total_);
    if (!options.progress || done == bytes_told_) return;
    bytes_told_ = done;
    options.progress(done, bytes_total_);
}

}  // namespace citystream::tiles::city
