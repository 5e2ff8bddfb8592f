// Which local directions the relief of a facade leaves free: the meso scale near the camera (Sun et al. 2011 keep it in
// their BTFs; here a displacement map shades itself, and 64 directions are one u64 a texel).
//
// Facade space is that of codec/facade/facade_ray.h: u right, v up in texels of the map, w outwards in millimetres. A
// receiver on the wall has the frame (u, v, w) (frames.h), so local direction j of 8 x 8 (local_directions.h) is the
// same in both.
//
// Mask texels are squares of 2^log2_side texels of the map, the least with which there are at most
// RELIEF_MASK_MOST_TEXELS. Of each: from the middle of the map's texel in its middle, half a millimetre above the
// displacement, a ray to each direction; bit j is set where it meets nothing. What leaves through the facade's edges is
// free, and open texels see all. The device makes the same words by shaders/relief_mask.comp.glsl, in float: some bits
// at grazing hits differ.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/radiance/relief_mask_layout.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// Texels of a map a metre of wall, along u and v: finite and greater than 0.
using FacadeScales = std::array<float, 2>;
inline constexpr FacadeScales kCentimetreTexels = {100, 100};

struct ReliefMaskShape {
    uint32_t width = 0, height = 0;  ///< of the map, its texels
    uint32_t log2_side = 0;          ///< of a mask texel

    uint32_t across() const { return ((width - 1) >> log2_side) + 1; }
    uint32_t up() const { return ((height - 1) >> log2_side) + 1; }
    uint32_t texels() const { return across() * up(); }
    uint32_t words() const { return RELIEF_MASK_TEXELS + texels() * RELIEF_MASK_TEXEL_WORDS; }
    /// The map's texel from whose middle the rays of mask texel x or y start; `size`: width or height.
    uint32_t middle(uint32_t i, uint32_t size) const;
};

/// `width`, `height`: 1..kMaxFacadeSide.
ReliefMaskShape relief_mask_shape(uint32_t width, uint32_t height);

/// Of each face and direction: the cosine to the face's normal, at least 0, averaged over what is nearest to the
/// direction, in 2^-16. Those of RELIEF_FACE_FRONT are irradiance_weights(8): the sum of weights times a receiver's
/// rows is its irradiance. About 15 ms, once.
using ReliefWeights = std::array<std::array<uint32_t, RELIEF_DIRECTIONS>, RELIEF_FACES>;
const ReliefWeights& relief_weights();

/// The face of a hit's normal: `axis` 0 u, 1 v, 2 w.
constexpr uint32_t relief_face(int axis, int sign) {
    if (axis == 2) return RELIEF_FACE_FRONT;
    return (axis == 0 ? RELIEF_FACE_RIGHT : RELIEF_FACE_UPPER) + (sign < 0 ? 1 : 0);
}

/// The words before the mask texels: RELIEF_MASK_TEXELS of them.
std::vector<uint32_t> relief_mask_head(const ReliefMaskShape& shape, const FacadeScales& scales = kCentimetreTexels);

/// All words. O(mask texels times the rays' cells): 64 rays a mask texel.
std::vector<uint32_t> make_relief_mask(const facade::RunGrid& grid, const FacadeScales& scales = kCentimetreTexels);

/// Masks around a point of the relief, and how much each counts: shares add up to 1.
struct ReliefShares {
    std::array<uint64_t, 4> bits{};
    std::array<float, 4> share{};

    /// How free a direction is, 0..1.
    float free(uint32_t direction) const;
};

class ReliefMaskView {
  public:
    /// Of checked words, which outlive it. Error: what is wrong with words that are not a mask.
    static Result<ReliefMaskView> create(std::span<const uint32_t> words);

    const ReliefMaskShape& shape() const { return shape_; }
    FacadeScales scales() const;
    /// x < shape().across(), y < shape().up().
    uint64_t bits(uint32_t x, uint32_t y) const;
    uint32_t label(uint32_t x, uint32_t y) const;

    /// Of a point on the relief, facade space, where a ray hit a face of this normal; `label`: of the hit. The four
    /// mask texels around it are interpolated, of a reveal those on the side that it faces; but only those count that
    /// lie on the point's own surface: as deep as a front, deeper than a point of a reveal. Where none does, the one
    /// that is next in depth. Twin of relief_shares in shaders/relief_mask.glsl.
    ReliefShares shares(const std::array<float, 3>& at, uint32_t label, int axis, int sign) const;

  private:
    ReliefMaskView(std::span<const uint32_t> words, const ReliefMaskShape& shape) : words_(words), shape_(shape) {}

    std::span<const uint32_t> words_;
    ReliefMaskShape shape_;
};

/// Sum over the directions of `light` times weight times how free it is: what `light` (a row's sum each, of one
/// channel) makes of irradiance at the point, in whole numbers' 2^-16 taken out.
double relief_irradiance(const ReliefShares& shares, uint32_t face, std::span<const double, RELIEF_DIRECTIONS> light);

}  // namespace citystream::codec::radiance
