// Any bytes as a CityGML file, compressed or not: errors and defects, but only sound objects.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/city_check.h"
#include "tiles/city/citygml_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    citystream::tiles::city::read_checked({reinterpret_cast<const char*>(data), size},
                                          &citystream::tiles::city::read_citygml);
    return 0;
}
