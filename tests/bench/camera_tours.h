// Camera paths over any city, from its directory alone: what street, roof and high fly-throughs see.
#pragma once

#include <string>
#include <vector>

#include "client/path/camera_path.h"
#include "tests/bench/sample_city.h"

namespace citystream::bench {

struct Tour {
    std::string name;  ///< "street", "roof", "high"
    client::CameraPath path;
};

/// Three straight flights through the middle of the city, from west to east, of `cameras` cameras each: 2 m above the
/// ground looking ahead, 40 m above it looking slightly down, and 400 m above it (a third of the city's
/// width in a small one) looking down by 30 degrees.
std::vector<Tour> tours_of(const SampleCity& city, int cameras = 24);

}  // namespace citystream::bench
