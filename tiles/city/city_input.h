// Opens city models of any supported format and streams their objects.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "codec/result.h"
#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

struct InputOptions {
    std::optional<std::string> lod;  ///< exact LoD to take ("2.2", "3"); default: the highest of each object
    std::function<void(uint64_t bytes_done, uint64_t bytes_total)> progress;
};

/// Reads files in the order given (CityJSON 1.0 / 1.1 / 2.0, CityJSONSeq, CityGML 2.0 / 3.0; by content, not by name;
/// also compressed with xz or gzip) into one city. Relative image paths resolve against the file's folder. Objects go
/// to `sink` in file order; ids that repeat across files are reported and kept. Several files must agree on the CRS.
/// Error: file cannot be opened, is no city model, is broken so early that nothing could be read, or sets disagree on
/// CRS. A file broken further on yields what came before, a defect that says where, and the error (the caller decides;
/// the builder exits 1).
Status read_city(const std::vector<std::string>& paths, const InputOptions& options, CityHeader& header,
                 CityCatalog& catalog, CityReport& report, const CitySink& sink);

}  // namespace citystream::tiles::city
