// What is seen of a wall before and after its relief took the place of triangles: parallel views from the street, from
// both sides, below and above. The relief is cast by the codec's double reference, triangles are drawn along the view.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tiles/layers/relief_extraction_decision.h"
#include "tiles/layers/relief_extraction_map.h"

namespace citystream::tiles::layers::relief {

/// Rays through the wall's rectangle. One is wrong where before and after see surfaces of another colour, facing
/// another way, or apart, or one of them sees none.
struct ViewDifference {
    uint64_t rays = 0, wrong = 0;
    /// By patch: rays that see it before or after, and of these the wrong ones.
    std::vector<uint32_t> patch_rays, patch_wrong;
    double wrong_share() const { return rays == 0 ? 0 : static_cast<double>(wrong) / static_cast<double>(rays); }
};

class WallViews {
  public:
    /// Draws the views before. All must outlive it. Parts that `taken` says another wall's relief shows are not
    /// compared. O(pixels of the parts).
    WallViews(const WallFrame& frame, const FacadeParts& facade, std::span<const uint8_t> taken,
              const city::CityCatalog& catalog);

    /// `decider` has just decided. O(pixels of the parts and steps of the rays).
    ViewDifference compare(const Decider& decider, const Decision& decision, const ReliefMap& map,
                           const SlotTable& slots) const;

  private:
    /// A ray goes by u = U - across * w, v = V - up * w as w falls.
    struct Direction {
        double across = 0, up = 0;
    };
    struct Seen {
        double w = 0;
        uint32_t part = kNone;
    };
    /// What the relief shows along a ray.
    struct Relief {
        double w = 0;
        uint32_t material = kNone;  ///< kNone: nothing
        uint32_t patch = kNone;
        Point normal;
    };
    template <typename Use>
    std::vector<Seen> draw(const Direction& direction, const Use& use) const;
    void draw_part(const Direction& direction, uint32_t part, std::vector<Seen>& picture) const;
    double facing(const Direction& direction, uint32_t part) const;
    double area_of(uint32_t part) const;
    void put(const Direction& direction, Seen& pixel, uint32_t part, double w) const;
    static bool shows(const Relief& relief, const Seen& after);
    std::array<uint32_t, 2> blamed(const Seen& before, const Seen& after, const Relief& relief) const;
    bool is_wrong(const Seen& before, const Seen& after, const Relief& relief) const;
    bool is_alike(uint32_t part, uint32_t material, const Point& normal) const;

    const WallFrame& frame_;
    const FacadeParts& facade_;
    std::span<const uint8_t> taken_;
    const city::CityCatalog& catalog_;
    std::vector<Direction> directions_;
    size_t columns_ = 0, rows_ = 0;
    std::vector<std::vector<Seen>> before_;
};

}  // namespace citystream::tiles::layers::relief
