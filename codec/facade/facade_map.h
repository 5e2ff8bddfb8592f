// Facade maps: displacement D and material M of one facade at 1 cm texels, kept as a palette-packed matrix over the
// grid of distinct runs (columns and rows are cut where a neighbour differs), exact on every input.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::facade {

/// The matrices as images: row 0 is the bottom of the wall, texel = row * width + column, 1 cm a texel.
struct FacadeImage {
    uint32_t width = 0, height = 0;        ///< texels, 1..8192
    std::vector<int16_t> displacement_mm;  ///< outwards positive
    std::vector<uint8_t> material;         ///< slot 0..15
    friend bool operator==(const FacadeImage&, const FacadeImage&) = default;
};

/// Encodes to the words of facade_layout.h. Fails (with a reason) on sizes out of range, matrices of another size,
/// materials > 15, or more than 65,535 distinct (D, M) pairs. Time: O(width * height), a few passes. The words are at
/// most 8 + 2 * 4,097 + 65,535 + width * height / 2.
Result<std::vector<uint32_t>> encode_facade_map(const FacadeImage& image);

/// A checked view; the accessors and the shader cannot read outside the words afterwards. Creation is O(cells); the
/// view borrows the words.
class FacadeMapView {
  public:
    static Result<FacadeMapView> create(std::span<const uint32_t> words);
    uint32_t width() const;
    uint32_t height() const;
    uint32_t columns() const;  ///< of cells
    uint32_t rows() const;
    int32_t depth_min_mm() const;
    int32_t depth_max_mm() const;
    uint32_t x_break(uint32_t i) const;  ///< 0..columns()
    uint32_t y_break(uint32_t i) const;
    uint32_t label(uint32_t column, uint32_t row) const;  ///< the label word: int16 mm | slot << 16

  private:
    std::span<const uint32_t> words_;
};

/// Both matrices back. Allocates 3 bytes a texel, at most 192 MiB whatever the bytes are (one run can legally cover
/// 8,192 x 8,192 texels).
Result<FacadeImage> decode_facade_map(std::span<const uint32_t> words);

/// First hit of a ray with the relief, in double: the reference of the shader. Coordinates: u right, v up in texels
/// (centimetres / stretch), w outwards in millimetres. The volume is 0 <= u <= width, 0 <= v <= height, depth_min <= w
/// <= depth_max; what lies below D is solid. A ray that comes in through an edge of the facade below D hits there; one
/// that leaves through an edge misses; one that starts in the solid hits at t = 0; one from behind hits the back at w =
/// depth_min. A step between two cells is hit from the lower one and takes the label of the higher one. Through a
/// corner the ray goes by way of the cell next in u. At most columns + rows + 2 steps. Directions of any length (t is
/// in units of it); not finite: no hit.
struct FacadeRayHit {
    bool hit = false;
    double t = 0;  ///< along the direction given
    uint32_t label = 0;
    int normal_axis = 2;  ///< 0: u, 1: v, 2: w
    int normal_sign = 1;
};
FacadeRayHit cast_facade_ray(const FacadeMapView& map, const double origin[3], const double direction[3]);

}  // namespace citystream::codec::facade
