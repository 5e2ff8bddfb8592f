// What facades are painted of: courses of bricks, stones or panels, windows, curtain walls, balconies, shop fronts.
// Lengths are millimetres.
#pragma once

#include "tiles/city/generator_random.h"
#include "tiles/city/procedural_canvas.h"

namespace citystream::tiles::city::procedural {

/// What a wall is made of: units laid in courses on a ground of joints. A unit of width 0 is as wide as the picture.
struct Masonry {
    Rgb unit{}, joint{};
    int unit_mm = 0, course_mm = 0, joint_mm = 0;
    int shift = 0;      ///< of every other course, percent of a unit
    int variation = 0;  ///< of a unit's brightness, percent
    int odd = 0;        ///< percent of units that stand out
};

/// Courses over the whole picture, as many as come nearest to their size and repeat.
void lay_courses(PeriodicCanvas& canvas, const Masonry& masonry, uint64_t seed);

struct WindowStyle {
    int width = 0, height = 0;
    int frame = 70;              ///< of its four sides and bars
    int panes = 2, transom = 0;  ///< upright panes; height of an upper row, percent
    Rgb frame_colour{}, trim{}, shutter{}, glass{};
    int surround = 0;  ///< width of a frame of stone around it; 0: none
    bool sill = true;
    int shutters = 0;  ///< percent of windows that have them
    int curtains = 0;  ///< percent of windows with curtains or blinds
};

/// A window whose opening is `rect`; what differs from one to the next (curtains, reflections) comes from `random`.
void paint_window(PeriodicCanvas& canvas, const Rect& rect, const WindowStyle& style, Random random);

/// Glass alone, with what it mirrors and what hangs behind it.
void paint_glass(PeriodicCanvas& canvas, const Rect& rect, Rgb glass, int curtains, Random& random);

/// Slab and railing in front of what was painted before; `rect` is the balcony's front.
void paint_balcony(PeriodicCanvas& canvas, const Rect& rect, Rgb slab, Rgb railing, bool bars);

/// Panes of a whole storey between mullions, with a band of panels at its foot.
void paint_curtain_storey(PeriodicCanvas& canvas, const Rect& rect, int bays, const WindowStyle& style, Rgb panel,
                          Random random);

/// One bay of a ground floor with a shop: window, door or gate below, a sign above.
void paint_shop(PeriodicCanvas& canvas, const Rect& rect, const WindowStyle& style, Random random);

/// A door of wood or metal with a step and a light above it.
void paint_door(PeriodicCanvas& canvas, const Rect& rect, const WindowStyle& style, Random random);

/// Lighter (above 100) or darker.
Rgb scaled(Rgb colour, int percent);

}  // namespace citystream::tiles::city::procedural
