#include "client/light/cube_picture.h"

#include <algorithm>
#include <array>

#include "client/light/sphere_resampling.h"

namespace citystream::client {

CubePicture::CubePicture(uint32_t side, std::span<const Place> places)
    : side_(side), places_(places.begin(), places.end()) {}

std::optional<CubePicture> CubePicture::of_size(uint32_t width, uint32_t height, CubeAxes axes) {
    struct Shape {
        uint32_t columns, rows;
        std::array<Place, codec::radiance::kCubeFaces> places;
    };
    static constexpr std::array<Shape, 4> kShapes = {{
        {6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}},
        {1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}},
        {4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}},
        {3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3, true}}}},
    }};
    // Seen from within, its x faces stand in each other's places, and up and down are half a turn on.
    static constexpr std::array<Shape, 1> kOpenExrShapes = {
        {{1, 6, {{{0, 1}, {0, 0}, {0, 2, true}, {0, 3, true}, {0, 4}, {0, 5}}}}}};
    const auto shapes = axes == CubeAxes::kOpenExr ? std::span<const Shape>(kOpenExrShapes) : kShapes;
    for (const Shape& shape : shapes) {
        const uint32_t side = width / shape.columns;
        if (side > 0 && width == side * shape.columns && height == side * shape.rows)
            return CubePicture(side, shape.places);
    }
    return std::nullopt;
}

void CubePicture::add_row(std::span<const Rgb> row) {
    const uint32_t face_row = row_ % side_;
    faces_.resize(CubeGrid{side_}.texels());
    for (size_t face = 0; face < places_.size(); ++face) {
        const Place& place = places_[face];
        if (place.row != row_ / side_) continue;
        const std::span<const Rgb> texels = row.subspan(size_t{place.column} * side_, side_);
        const auto to_row = [&](uint32_t r) {
            return faces_.begin() + static_cast<ptrdiff_t>((face * side_ + r) * side_);
        };
        if (place.upside_down)
            std::reverse_copy(texels.begin(), texels.end(), to_row(side_ - 1 - face_row));
        else
            std::copy(texels.begin(), texels.end(), to_row(face_row));
    }
    ++row_;
}

EnvironmentMap CubePicture::take(uint32_t greatest_width) {
    EnvironmentMap map;
    map.width = std::clamp(4 * side_, 8U, greatest_width);
    map.height = map.width / 2;
    map.texels = resample_sphere(CubeGrid{side_, true}, faces_, LatLongGrid{map.width, map.height});
    return map;
}

}  // namespace citystream::client
