// Terminal symbols of the facade grammar: what stands in a bay (windows, doors, shops, balconies) and what dresses a
// wall (cornices, quoins, bands). Everything paints on a canvas; lengths in cm, displacements in mm. No element
// recesses the canvas's border as long as its rectangle keeps off it.
#pragma once

#include "tiles/city/generator_random.h"
#include "tiles/city/grammar.h"

namespace citystream::tiles::city::procedural {

struct WindowStyle {
    int width = 120, height = 150;
    int frame = 7;            ///< cm, border frame
    int mullions = 1;         ///< upright bars inside
    int transom_percent = 0;  ///< height of the cross bar in the opening; 0 = none
    int reveal_mm = 140;      ///< glass lies this deep
    int surround = 0;         ///< cm, raised border; 0 = none
    int surround_mm = 30;
    int lintel = 0;    ///< cm, height of the raised lintel; 0 = none
    int sill_mm = 70;  ///< how far the sill stands out; 0 = none
    bool shutters = false;
    bool bars = false;  ///< French balcony in front of the lower third
};

/// A window opening that fills `opening`. `blind` shows a curtain instead of glass.
void draw_window(Canvas& canvas, const Rect& opening, const WindowStyle& style, bool blind);

/// A house or staircase door with frame, panels and a step at its foot, on request a fanlight and a canopy.
void draw_door(Canvas& canvas, const Rect& opening, bool fanlight, bool canopy);

/// A wide sectional door (garage, hall) of horizontal panels about `panel` high, above a threshold.
void draw_sectional_door(Canvas& canvas, const Rect& opening, int panel);

/// A shop: stallriser, wide panes, sign board above, perhaps an awning. `bay` reaches from the foot to under the string
/// course.
void draw_shop(Canvas& canvas, const Rect& bay, bool door, bool awning);

/// A balcony slab with a parapet or bars before the bay; `bay.y0` is the floor's level.
void draw_balcony(Canvas& canvas, const Rect& bay, int depth_mm, bool bars);

/// A band across the rectangle made of `steps` fillets that stand out further and further upwards.
void draw_cornice(Canvas& canvas, const Rect& band, int steps, int reach_mm, Slot slot);

/// Alternating long and short corner stones at both ends of the rectangle.
void draw_quoins(Canvas& canvas, const Rect& wall, int course);

/// Raised courses with open joints (rustication) over the rectangle.
void draw_rustication(Canvas& canvas, const Rect& wall, int course, int relief_mm);

}  // namespace citystream::tiles::city::procedural
