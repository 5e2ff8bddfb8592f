// What the server says about its cities: the HTML pages and /cities.json. Made once at start-up; they hold no scripts
// and load nothing from elsewhere.
#pragma once

#include <string>
#include <vector>

#include "server/archive_catalog.h"

namespace citystream::server {

/// The page at "/": a card for each city with its picture (when the archive has a preview.png), size and layers.
std::string index_page(const std::vector<City>& cities);

/// The page at "/NAME/": the same card, and how to fly through the city.
std::string city_page(const City& city);

/// {"cities": [{"name", "title", "tileset", "preview", "buildings", "triangles", "facades", "tiles", "levels",
/// "extent", "epsg", "archive_bytes", "layers": {"mesh": {"wire_bytes", "decoded_bytes"}, ...}}]}. `extent` is
/// [xmin,ymin,zmin,xmax,ymax,zmax] in metres of the CRS; `tileset` and `preview` are absolute paths
/// ("/NAME/tileset.json"; preview is null without a picture); layers lists only those the city has.
std::string cities_json(const std::vector<City>& cities);

/// "12.3 MB": decimal units, three significant digits.
std::string human_bytes(uint64_t bytes);

}  // namespace citystream::server
