// Which local directions the relief of a facade leaves free: the meso scale near the camera (Sun et al. 2011 keep it in
// their BTFs; here a displacement map shades itself, and 64 directions are one u64 a texel).
//
// Facade space is that of codec/facade/facade_ray.h: u right, v up in texels of the map, w outwards in millimetres. A
// receiver on the wall has the frame (u, v, w) (frames.h), so local direction j of 8 x 8 (local_directions.h) is the
// same in both.
//
// Mask texels are squares of 2^log2_side texels of the map, the least with which there are at most
// RELIEF_MASK_MOST_TEXELS. A mask texel has up to RELIEF_MASK_MOST_SURFACES surfaces: depths of the relief in it, those
// with the most of its area, so that a cornice or a bar of less than a mask texel has its own light. Of each: from the
// middle of its largest piece, half a millimetre above the displacement, a ray to each direction; bit j is set where it
// meets nothing. What leaves through the facade's edges is free, and open texels see all. The device casts the same
// rays by shaders/relief_mask.comp.glsl, in float: some bits at grazing hits differ.
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
    uint64_t words(uint64_t surfaces) const {
        return RELIEF_MASK_TEXELS + texels() + surfaces * RELIEF_MASK_SURFACE_WORDS;
    }
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

/// A texel of the map from whose middle a surface's rays start.
struct ReliefStart {
    uint32_t x = 0, y = 0, label = 0;
};

struct ReliefSurfaces {
    ReliefMaskShape shape;
    std::vector<uint32_t> texels;     ///< words of the mask texels
    std::vector<ReliefStart> starts;  ///< of all surfaces
};

/// Of a mask texel the depths that cover the most come first, of equals the one further out; the first always, others
/// where they cover a thirty-second of it. O(cells + mask texels).
ReliefSurfaces relief_surfaces(const facade::RunGrid& grid);

/// All words, with starts in place of bits: what the device's pass begins with.
std::vector<uint32_t> relief_mask_starts(const ReliefSurfaces& surfaces,
                                         const FacadeScales& scales = kCentimetreTexels);

/// Casts the rays of `count` surfaces from `first` on: `words` are those of relief_mask_starts for the grid's surfaces,
/// of which theirs get their bits. Calls for different surfaces may run at once. 64 rays a surface.
void cast_relief_rays(const facade::RunGrid& grid, std::span<uint32_t> words, uint32_t first, uint32_t count);

/// All words. O(surfaces times the rays' cells).
std::vector<uint32_t> make_relief_mask(const facade::RunGrid& grid, const FacadeScales& scales = kCentimetreTexels);

/// Masks around a point of the relief, and how much each counts: shares add up to 1 with `open`, to which all
/// directions are free.
struct ReliefShares {
    std::array<uint64_t, 4> bits{};
    std::array<float, 4> share{};
    float open = 0;

    /// How free a direction is, 0..1.
    float free(uint32_t direction) const;
};

class ReliefMaskView {
  public:
    /// Of checked words, which outlive it. Error: what is wrong with words that are not a mask.
    static Result<ReliefMaskView> create(std::span<const uint32_t> words);

    const ReliefMaskShape& shape() const { return shape_; }
    FacadeScales scales() const;
    /// Of a mask texel, at least one; x < shape().across(), y < shape().up().
    uint32_t surfaces(uint32_t x, uint32_t y) const;
    /// `surface` < surfaces(x, y).
    uint64_t bits(uint32_t x, uint32_t y, uint32_t surface = 0) const;
    uint32_t label(uint32_t x, uint32_t y, uint32_t surface = 0) const;

    /// Of a point on the relief, facade space, where a ray hit a face of this normal; `label`: of the hit. The four
    /// mask texels around it are interpolated, of a reveal those on the side that it faces; of each the surface that is
    /// the point's own: as deep as a front, the one next below a point of a reveal. Only those count. Where no texel
    /// has one, the surface that is next in depth. From the foot of a reveal, where it is as free as what lies below,
    /// to its edge `open` grows from 0 to 1. Twin of relief_shares in shaders/relief_mask.glsl.
    ReliefShares shares(const std::array<float, 3>& at, uint32_t label, int axis, int sign) const;

  private:
    ReliefMaskView(std::span<const uint32_t> words, const ReliefMaskShape& shape) : words_(words), shape_(shape) {}
    const uint32_t* surface_words(uint32_t x, uint32_t y, uint32_t surface) const;
    /// Of a mask texel's surfaces the point's own, else the one next in depth.
    struct NextSurface {
        uint32_t surface = 0;
        bool is_own = false;
        float away = 0;  ///< millimetres
    };
    NextSurface next_surface(uint32_t x, uint32_t y, float depth, bool is_front) const;

    std::span<const uint32_t> words_;
    ReliefMaskShape shape_;
};

/// Sum over the directions of `light` times weight times how free it is: what `light` (a row's sum each, of one
/// channel) makes of irradiance at the point, in whole numbers' 2^-16 taken out.
double relief_irradiance(const ReliefShares& shares, uint32_t face, std::span<const double, RELIEF_DIRECTIONS> light);

}  // namespace citystream::codec::radiance
