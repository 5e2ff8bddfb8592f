#include "tiles/city/city_model.h"

#include <algorithm>
#include <utility>

namespace citystream::tiles::city {

std::shared_ptr<const Image> ImageSource::drawn() const {
    if (pixels || !make) return pixels;
    return std::make_shared<const Image>(make());
}

uint32_t CityCatalog::add_material(const Material& material) {
    const auto found = std::find(materials.begin(), materials.end(), material);
    if (found != materials.end()) return static_cast<uint32_t>(found - materials.begin());
    materials.push_back(material);
    return static_cast<uint32_t>(materials.size() - 1);
}

void CityReport::add(Defect defect) {
    ++defect_count;
    if (defect.dropped_feature) dropped_features.push_back(defect.feature);
    if (defects.size() < kMaxDefects) defects.push_back(std::move(defect));
}

}  // namespace citystream::tiles::city
