// What the readers of all formats share while they read the files of one city: where objects go, what was seen, what
// went wrong.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "codec/result.h"
#include "tiles/city/city_input.h"
#include "tiles/city/object_builder.h"
#include "tiles/city/surface_colours.h"

namespace citystream::tiles::city {

/// The ids seen so far, as 64-bit hashes (8 to 16 bytes each).
class IdRegister {
  public:
    /// False when the id was there before.
    bool add(std::string_view id);

  private:
    void insert(uint64_t hash);
    std::vector<uint64_t> slots_;  ///< 0 = free
    size_t used_ = 0;
};

class CityReading {
  public:
    CityReading(const InputOptions& options, CityHeader& header, CityCatalog& catalog, CityReport& report,
                const CitySink& sink);

    const InputOptions& options;
    CityHeader& header;
    CityReport& report;
    MaterialTable materials;
    ObjectBuilder builder;

    /// Sets the city's CRS, or fails when it is another one than that of an earlier file, or one in degrees.
    Status agree_on_crs(int32_t epsg, const std::string& file);
    /// Counts a top-level feature and reports an id that was there before.
    void see_feature(const std::string& id, const std::string& where);
    /// Finishes the builder's object and sends it; false when nothing came out of it.
    bool send();
    bool stopped() const { return stopped_; }

    void drop(const std::string& feature, const std::string& why, const std::string& where);
    void tell_progress(uint64_t bytes_of_this_file);
    void next_file(uint64_t bytes_of_the_last) { bytes_before_ += bytes_of_the_last; }
    void set_total(uint64_t bytes) { bytes_total_ = bytes; }

  private:
    const CitySink& sink_;
    IdRegister ids_;
    uint64_t bytes_before_ = 0, bytes_total_ = 0, bytes_told_ = 0;
    bool stopped_ = false;
};

}  // namespace citystream::tiles::city
