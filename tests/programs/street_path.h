// A camera path down into a generated city.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>

#include "tiles/city/generator_layout.h"

namespace citystream::tests {

/// From the sky, `height` metres up and `along` a main street from its middle, to that middle, in three cameras a
/// second apart.
inline std::string path_to_street(uint64_t seed, uint32_t buildings, double along, double height) {
    using namespace tiles::city::procedural;
    const CityPlan plan(seed, buildings);
    const auto x = plan.line(Axis::kX, 0).axis;
    std::string path = "t,x,y,z,yaw,pitch,fov\n";
    int t = 0;
    for (const auto& [there, up, pitch] : {std::array{along, height, -25.0}, {-80.0, 28.0, -12.0}, {-40.0, 1.7, 2.0}}) {
        const double ground = static_cast<double>(plan.ground(x, static_cast<int64_t>(there * kMetre))) / kMetre;
        path += fmt::format("{},{},{},{},10,{},60\n", t++, static_cast<double>(x) / kMetre, there, ground + up, pitch);
    }
    return path;
}

}  // namespace citystream::tests
