// The split grammar's ground: rectangles that are cut into smaller ones, and the canvas that keeps displacement and
// material of a facade. Lengths are centimetres = texels, y upwards from the foot of the wall; displacement is
// millimetres, outwards positive.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::tiles::city::procedural {

/// Material slots of a generated facade map; a palette gives each a material.
enum class Slot : uint8_t {
    kWall,
    kPlinth,
    kFrame,
    kGlass,
    kDoor,
    kSill,
    kBalcony,
    kRailing,
    kCornice,
    kShopfront,
    kQuoin,
    kShutter,
    kSign,
    kAccent,
    kMetal,
    kBlind,  ///< glass with a curtain or blind behind it
};

struct Rect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool empty() const { return x1 <= x0 || y1 <= y0; }
    /// Smaller by the margins given (negative: larger).
    Rect inset(int left, int bottom, int right, int top) const {
        return {x0 + left, y0 + bottom, x1 - right, y1 - top};
    }
    Rect inset(int margin) const { return inset(margin, margin, margin, margin); }
    /// width x height, centred in x, `bottom` above this rectangle's foot.
    Rect centred(int width, int bottom, int height) const;
};

/// One part of a split: `size` cm, or, when `flex` > 0, that many shares of what the fixed parts leave.
struct Part {
    int size = 0;
    int flex = 0;
};

/// Cuts into parts from left to right (split_x) or from the foot upwards (split_y). The last flexible part takes the
/// rounding.
std::vector<Rect> split_x(const Rect& rect, std::initializer_list<Part> parts);
std::vector<Rect> split_y(const Rect& rect, std::initializer_list<Part> parts);

/// Cuts into equal parts, as many as bring each nearest to `target` cm; at least one.
std::vector<Rect> repeat_x(const Rect& rect, int target);
std::vector<Rect> repeat_y(const Rect& rect, int target);

/// A facade under construction: rectangles painted one over the other.
class Canvas {
  public:
    Canvas(int width, int height);
    Rect bounds() const { return {0, 0, width_, height_}; }
    /// The part of `rect` inside the canvas gets this displacement and slot; what was there is forgotten.
    void fill(const Rect& rect, int displacement_mm, Slot slot);
    /// The relief, once everything is painted, on its coarsest grid. O(fills x cells), whatever the texels.
    codec::facade::RunGrid relief() const;

  private:
    struct Fill {
        Rect rect;
        int16_t displacement_mm;
        Slot slot;
    };
    int width_, height_;
    std::vector<Fill> fills_;
};

}  // namespace citystream::tiles::city::procedural
