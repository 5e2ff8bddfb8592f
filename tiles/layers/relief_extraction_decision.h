// Which fronts become relief, and which triangles the relief then shows or hides.
//
// The relief of a set of fronts is the front-most of them in each cell; below it is solid. It is true where the sides
// that it draws between cells of different depth lie on sides of the model. A patch whose sides mostly do not (an
// awning, the bars of a railing, a bay with slanted cheeks) floats before what is behind it, or is closed by what the
// relief cannot show: it stays mesh, and what lies behind it takes its place. Repeated until all patches are true.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/layers/relief_extraction_cells.h"
#include "tiles/layers/relief_extraction_surroundings.h"

namespace citystream::tiles::layers::relief {

struct Decision {
    std::vector<uint32_t> top;      ///< for each cell the part that it shows, kNone: open
    std::vector<uint8_t> replaced;  ///< for each part: the relief shows or hides it
    std::vector<uint8_t> shown;     ///< for each part that is replaced: the relief shows it, at least partly
    std::vector<uint8_t> beside;    ///< for each part: the relief draws a side of its own where this one is
    double deepest = 0;             ///< metres: least depth of the relief
    double false_sides = 0;         ///< square metres of sides that the relief draws where the model has none
};

class Decider {
  public:
    /// All must outlive it; patches are marked as kept in `facade`.
    Decider(const CellGrid& grid, const LayerStack& stack, const Surroundings& surroundings, FacadeParts& facade,
            double tolerance);
    Decision decide();
    /// Depth of the relief at a place, kOpen where it has none. Valid after decide().
    static constexpr double kOpen = -1e300;
    double depth_at(double u, double v) const;
    uint32_t top_at(double u, double v) const;
    /// How far beside an edge of the model the relief's step may lie.
    double lateral() const { return lateral_; }

  private:
    struct Step;
    struct Blame {
        double drawn = 0, untrue = 0;
    };
    double depth_of(size_t cell) const;
    bool is_beyond(double u, double v) const;
    bool is_below(const Part& part, double level) const;
    void find_tops();
    bool keep_floating_patches();
    template <typename Use>
    void for_each_step(const Use& use) const;
    Step step_between(size_t first, size_t second) const;
    double untrue_area(const Step& step, double deepest, bool seen_only) const;
    double untrue_rim(double deepest) const;
    void judge_sides(Decision& decision) const;
    void find_beside(Decision& decision) const;
    void judge_others(Decision& decision) const;

    const CellGrid& grid_;
    const LayerStack& stack_;
    const Surroundings& surroundings_;
    FacadeParts& facade_;
    double tolerance_, lateral_;
    std::vector<uint32_t> top_;
};

/// Points spread over a part, at most about `spacing` metres apart.
std::vector<Point> sample_points(const Part& part, double spacing);

}  // namespace citystream::tiles::layers::relief
