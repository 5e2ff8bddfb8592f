// Bidirectional texture functions of facades: how much of the light of each local direction a facade with relief turns
// to each view (Sun et al. 2011, section 5; B(x, e) = sum over d of b(u, e, d) L*(x, d)). Where relief is too far away
// to be ray cast, a wall's quad shows this instead.
//
// b(u, e, d): rays come along -e to a texel's area of the plane w = 0, and each that hits something counts the weight
// of direction d on the face that it hits (relief_weights) where the relief's mask leaves d free there (relief_mask.h),
// else 0; the mean over the rays that hit something. So the sum over d is that of a plain white wall, less what the
// relief hides. A ray that leaves through the facade's edge counts as what lies straight behind its place; one that
// leaves through an open texel hits nothing, and the texel's coverage says how many did not.
//
// What the rays hit has the materials of a palette, which is the placement's: beside b each texel and view has the
// share of each palette slot in all the light that is turned to the viewer. B is then the sum over d times the mean
// albedo by these shares: exact where light comes alike from all directions, and one BTF serves every palette at 80
// bytes a texel, where one b a slot takes 64 bytes a slot.
//
// As in the paper a view is a layer of 64 blocks of p x p texels, and texels are interpolated within their block alone.
// Here a texel's 64 directions lie together, as a pixel reads all of them, and blocks have mips. Views are interpolated
// on the sphere (SphereShares).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/radiance/btf_layout.h"
#include "codec/radiance/relief_mask.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// What a caller chooses.
struct BtfOptions {
    uint32_t patch = 16;        ///< texels of a block's side: 4, 8, 16, 32 or 64
    uint32_t views_across = 8;  ///< 4..16: views are the centres of so many squared cells (local_directions.h)
};

struct BtfShape {
    uint32_t patch_log2 = 4;
    uint32_t views_across = 8;
    bool has_coverage = false;  ///< the map has open texels

    uint32_t patch() const { return 1u << patch_log2; }
    uint32_t views() const { return views_across * views_across; }
    uint32_t mips() const { return patch_log2 + 1; }
    /// Of a view's texels; `mip` < mips().
    uint32_t first_texel(uint32_t mip) const;
    /// Of all mips, filled up to a multiple of four.
    uint32_t texels_per_view() const;
    uint64_t records() const { return uint64_t{views()} * texels_per_view(); }
    uint32_t records_word() const { return BTF_VIEW_TABLE + views() * BTF_DIRECTION_WORDS; }
    /// A record's first word; `texel`: first_texel(mip) + y * side + x.
    uint64_t record_word(uint32_t view, uint32_t texel) const;
    uint64_t coverage_word() const;  ///< 0 where there is none
    uint64_t words() const;
};

/// Bit s: some texel of the map that is not open has palette slot s; materials beyond the last slot count as it, as
/// they do where facades are drawn. O(cells).
uint32_t palette_slots(const facade::RunGrid& grid);

/// Error: options out of range. The largest shape has 28 million words, so words and texels are numbered in 32 bits.
Result<BtfShape> btf_shape(const BtfOptions& options, bool has_open);

/// The words before the records.
std::vector<uint32_t> btf_head(const BtfShape& shape, uint32_t slots, const FacadeScales& scales = kCentimetreTexels);

/// Makes a view's records: `words` are all of a BTF's of this shape, of a mask of the same map and scales, with its
/// head and no records yet. Calls for different views may run at once. O(texels times BTF_RAYS rays).
void make_btf_view(const facade::RunGrid& grid, const ReliefMaskView& mask, const BtfShape& shape, uint32_t view,
                   std::span<uint32_t> words);

/// All words, of a mask of the same map and scales. Error: as btf_shape, or a mask of another size. O(views times
/// texels times BTF_RAYS rays).
Result<std::vector<uint32_t>> make_btf(const facade::RunGrid& grid, const ReliefMaskView& mask,
                                       const BtfOptions& options = {});

/// Four of a square grid of directions around one, and how much each counts: shares are at least 0 and add up to 1, are
/// continuous, and at a direction of the grid it has all. They are Wachspress's coordinates in the plane that touches
/// the sphere, so that they bring the mean of the four to the direction itself. What is lower than the grid's lowest
/// ring is taken at the ring.
struct SphereShares {
    std::array<uint32_t, 4> cell{};
    std::array<float, 4> share{};
};

/// `table`: across * across unit vectors of 4 words each (btf_layout.h); `direction` of any length; one that is
/// none is taken upwards. Twin of sphere_shares in shaders/btf.glsl.
SphereShares sphere_shares(std::span<const uint32_t> table, uint32_t across, const std::array<float, 3>& direction);

/// Where a lookup reads: four texels of four views.
struct BtfPlace {
    std::array<uint32_t, 16> view{};
    std::array<uint32_t, 16> texel{};  ///< of the view
    std::array<float, 16> share{};     ///< they add up to 1
};

class BtfView {
  public:
    /// Of checked words, which outlive it. Error: what is wrong with words that are not a BTF.
    static Result<BtfView> create(std::span<const uint32_t> words);

    const BtfShape& shape() const { return shape_; }
    /// Bit s: palette slot s is used.
    uint32_t slots() const { return words_[BTF_WORD_SLOTS]; }
    uint32_t byte(uint32_t view, uint32_t texel, uint32_t direction) const;
    uint32_t slot_byte(uint32_t view, uint32_t texel, uint32_t slot) const;
    /// 1: all rays hit something.
    float coverage(uint32_t view, uint32_t texel) const;

    /// `at`: 0..1 of the map's width and height, in the plane w = 0; `to_viewer`: along (u, v, w), metres; `mip` beyond
    /// the last is the last.
    BtfPlace place(const std::array<float, 2>& at, const std::array<float, 3>& to_viewer, uint32_t mip = 0) const;
    float value(const BtfPlace& place, uint32_t direction) const;
    /// Of each palette slot in the light; they add up to 1, or all are 0 where nothing is hit.
    std::array<float, BTF_SLOTS> slot_shares(const BtfPlace& place) const;
    float coverage(const BtfPlace& place) const;
    /// What takes the place of the cosine for the sun: a flat wall's is dot(normal, to_sun).
    float sun_cosine(const BtfPlace& place, const std::array<float, 3>& to_sun) const;
    /// How much of a uniform sky's light is turned to the viewer, of what a plain wall without relief turns.
    float openness(const BtfPlace& place) const;

  private:
    BtfView(std::span<const uint32_t> words, const BtfShape& shape) : words_(words), shape_(shape) {}

    std::span<const uint32_t> words_;
    BtfShape shape_;
};

/// B(x, e) of one colour channel: `light`: of each local direction; `albedo`: of each palette slot.
double shade_btf(const BtfView& btf, const BtfPlace& place, std::span<const double, BTF_DIRECTIONS> light,
                 std::span<const double, BTF_SLOTS> albedo);

}  // namespace citystream::codec::radiance
