// A picture that repeats in both directions, painted by rectangles in millimetres with smooth edges (a photograph has
// no stairs), then weathered. Integer arithmetic: the same texels on every machine. What falls over an edge comes in at
// the opposite one.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/city/grammar.h"
#include "tiles/city/procedural_texture.h"

namespace citystream::tiles::city::procedural {

/// Brightness changes over a whole picture; strengths in 256ths of a texel's own brightness.
struct Weather {
    int blotches = 0;  ///< soft stains of about a metre
    int streaks = 0;   ///< what rain leaves: narrow and upright
    int grain = 0;     ///< of single texels, as a camera's noise
    uint64_t seed = 0;
};

class PeriodicCanvas {
  public:
    /// `width` x `height` texels (1..4096 each) that show width_mm x height_mm (1..100,000 each).
    PeriodicCanvas(uint32_t width, uint32_t height, int width_mm, int height_mm, Rgb ground);

    int width_mm() const { return width_mm_; }
    int height_mm() const { return height_mm_; }

    /// Millimetres from the lower left corner; at most one period is painted. Opacity 0..256. O(texels touched).
    void fill(const Rect& mm, Rgb colour, int opacity = 256) { fill(mm, colour, colour, opacity); }
    /// The same, from one colour at the foot to another at the head.
    void fill(const Rect& mm, Rgb foot, Rgb head, int opacity);
    void darken(const Rect& mm, int opacity) { fill(mm, {0, 0, 0}, opacity); }

    /// O(texels).
    void weather(const Weather& weather);

    Image finish() &&;

  private:
    Image image_;
    int width_mm_, height_mm_;
};

}  // namespace citystream::tiles::city::procedural
