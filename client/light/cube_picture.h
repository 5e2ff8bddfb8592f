// How the six faces of a cube lie in a picture: strips and crosses (environment_file.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "client/light/environment_map.h"

namespace citystream::client {

/// Whose axes a cube's faces have. OpenEXR's are right-handed, so that +x is to the left of +z.
enum class CubeAxes { kOpenGl, kOpenExr };

class CubePicture {
  public:
    /// The shape that a picture of this size can have, if any. OpenEXR's cubes are strips of 1:6.
    static std::optional<CubePicture> of_size(uint32_t width, uint32_t height, CubeAxes axes = CubeAxes::kOpenGl);

    uint32_t face_side() const { return side_; }
    /// Takes the next row of the picture, from the top: `width` texels.
    void add_row(std::span<const Rgb> row);
    /// After the last row: the faces as a map of latitude and longitude with 4 columns to a texel of a face's side, at
    /// most `greatest_width`.
    EnvironmentMap take(uint32_t greatest_width);

  private:
    struct Place {
        uint32_t column = 0, row = 0;  ///< in faces
        bool upside_down = false;
    };

    CubePicture(uint32_t side, std::span<const Place> places);
    uint32_t side_, row_ = 0;
    std::vector<Place> places_;  ///< of each face
    std::vector<Rgb> faces_;
};

}  // namespace citystream::client
