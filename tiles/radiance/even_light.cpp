#include "tiles/radiance/even_light.h"

#include <array>
#include <cmath>

#include "codec/radiance/source_directions.h"

namespace citystream::tiles::radiance {

namespace {

constexpr uint32_t kSide = 5;  ///< cells of the cube whose middles are the directions
constexpr uint32_t kWordBits = 64, kWords = (codec::radiance::cube_cells(kSide) + kWordBits - 1) / kWordBits;

}  // namespace

EvenLight::EvenLight(const std::array<double, 3>& normal) : normal_(normal) {
    double sum = 0;
    for (uint32_t cell = 0; cell < codec::radiance::cube_cells(kSide); ++cell) {
        const auto grid = codec::radiance::cell_direction(kSide, cell);
        const RayDirection direction = ray_direction(grid);
        const double cosine = normal[0] * direction[0] + normal[1] * direction[1] + normal[2] * direction[2];
        if (cosine <= 0) continue;
        const double weight = cosine * codec::radiance::cell_solid_angle(kSide, cell);
        sum += weight;
        // Below the ground there is nothing: what a foundation sees there is no light.
        if (direction[2] <= 0) continue;
        directions_.push_back(direction);
        weights_.push_back(weight);
    }
    for (double& weight : weights_) weight /= sum;
}

double EvenLight::at(const OccluderScene& scene, const GridPoint& point) const {
    std::array<uint64_t, kWords> blocked{};
    scene.blocked(lifted(point, normal_), directions_, blocked);
    double light = 0;
    for (size_t i = 0; i < directions_.size(); ++i) {
        if ((blocked[i / kWordBits] >> i % kWordBits & 1) == 0) light += weights_[i];
    }
    return light;
}

}  // namespace citystream::tiles::radiance
