#include "tests/bench/camera_tours.h"

#include <algorithm>

namespace citystream::bench {
namespace {

/// Lowest point of the smallest tile below a place (x, y relative to the city's origin).
double ground_at(const SampleCity& city, double x, double y) {
    double ground = city.manifest.extent.min[2], side = 1e300;
    for (const auto& subtree : city.subtrees) {
        for (const auto& tile : subtree.parsed.tiles) {
            const auto& b = tile.bounds;
            if (x < b.min[0] || x > b.max[0] || y < b.min[1] || y > b.max[1]) continue;
            if (city.manifest.side_metres(tile.address.level) >= side) continue;
            side = city.manifest.side_metres(tile.address.level);
            ground = b.min[2];
        }
    }
    return ground;
}

Tour make_tour(const SampleCity& city, const std::string& name, double above_ground, double pitch, int cameras) {
    const auto& extent = city.manifest.extent;
    Tour tour{name, {}};
    for (int i = 0; i < cameras; ++i) {
        const double along = 0.2 + 0.6 * i / std::max(1, cameras - 1);
        const double x = extent.min[0] + along * (extent.max[0] - extent.min[0]),
                     y = (extent.min[1] + extent.max[1]) / 2;
        client::CameraSample sample;
        sample.t = i;
        sample.x = to_metres(city.manifest.origin.x) + x;
        sample.y = to_metres(city.manifest.origin.y) + y;
        sample.z = ground_at(city, x, y) + above_ground;
        sample.yaw = 90;
        sample.pitch = pitch;
        tour.path.samples.push_back(sample);
    }
    return tour;
}

}  // namespace

std::vector<Tour> tours_of(const SampleCity& city, int cameras) {
    const auto& extent = city.manifest.extent;
    const double high = std::min(400.0, (extent.max[0] - extent.min[0]) / 3);
    return {make_tour(city, "street", 2, 0, cameras), make_tour(city, "roof", 40, -10, cameras),
            make_tour(city, "high", high, -30, cameras)};
}

}  // namespace citystream::bench
