// What the generator's stream holds, all of it.
#pragma once

#include <vector>

#include "tiles/city/generator.h"

namespace citystream::tiles::city {

struct GeneratedCity {
    CityHeader header;
    CityCatalog catalog;
    CityReport report;
    std::vector<CityObject> objects;
};

inline GeneratedCity generated_city(const GeneratorOptions& options) {
    GeneratedCity city;
    generate_city(options, city.header, city.catalog, city.report, [&city](CityObject&& object) {
        city.objects.push_back(std::move(object));
        return true;
    });
    return city;
}

}  // namespace citystream::tiles::city
