#include "tiles/city/procedural_wall_parts.h"

#include <algorithm>
#include <array>

namespace citystream::tiles::city::procedural {
namespace {

constexpr int kShade = 100;  ///< opacity of the shadow that an edge throws

/// `parts` panes side by side with bars of `bar` between them.
template <typename Paint>
void each_pane(const Rect& rect, int parts, int bar, Paint paint) {
    for (int i = 0; i < parts; ++i) {
        const int x0 = rect.x0 + (rect.width() + bar) * i / parts,
                  x1 = rect.x0 + (rect.width() + bar) * (i + 1) / parts;
        paint(Rect{x0, rect.y0, x1 - bar, rect.y1});
    }
}

void paint_bars(PeriodicCanvas& canvas, const Rect& rect, Rgb colour) {
    constexpr int kPitch = 120, kBar = 25, kRail = 50;
    for (int x = rect.x0; x + kBar <= rect.x1; x += kPitch) canvas.fill({x, rect.y0, x + kBar, rect.y1}, colour);
    canvas.fill({rect.x0, rect.y1 - kRail, rect.x1, rect.y1}, colour);
    canvas.fill({rect.x0, rect.y0, rect.x1, rect.y0 + kRail}, colour);
}

Rgb sign_colour(Random& random) {
    constexpr std::array<Rgb, 8> kSigns = {{{168, 36, 32},
                                            {28, 74, 130},
                                            {30, 98, 62},
                                            {214, 168, 44},
                                            {44, 44, 48},
                                            {232, 228, 220},
                                            {206, 98, 30},
                                            {96, 44, 104}}};
    return kSigns[static_cast<size_t>(random.below(8))];
}

}  // namespace

Rgb scaled(Rgb colour, int percent) {
    for (uint8_t& channel : colour) channel = static_cast<uint8_t>(std::clamp(channel * percent / 100, 0, 255));
    return colour;
}

void lay_courses(PeriodicCanvas& canvas, const Masonry& masonry, uint64_t seed) {
    const int width = canvas.width_mm(), height = canvas.height_mm();
    // An even number of courses, so that the shifted ones come out even where the picture repeats.
    const int courses = std::max(2, (height / masonry.course_mm + 1) / 2 * 2);
    const int units = masonry.unit_mm == 0 ? 1 : std::max(1, (width + masonry.unit_mm / 2) / masonry.unit_mm);
    const int half = masonry.joint_mm / 2, rest = masonry.joint_mm - half;
    for (int j = 0; j < courses; ++j) {
        const int shift = j % 2 * masonry.shift * (width / units) / 100;
        for (int i = 0; i < units; ++i) {
            Random random(hash(seed, i, j));
            int percent = 100 + (random.between(-100, 100) + random.between(-100, 100)) * masonry.variation / 200;
            if (random.chance(masonry.odd)) percent = percent * random.between(62, 84) / 100;
            const int upright = units > 1 || masonry.unit_mm > 0 ? 1 : 0;
            canvas.fill({width * i / units + shift + half * upright, height * j / courses + half,
                         width * (i + 1) / units + shift - rest * upright, height * (j + 1) / courses - rest},
                        scaled(masonry.unit, percent));
        }
    }
}

void paint_glass(PeriodicCanvas& canvas, const Rect& rect, Rgb glass, int curtains, Random& random) {
    const int mirrored = random.between(85, 200);
    canvas.fill(rect, scaled(glass, random.between(65, 110)), scaled(glass, mirrored), 256);
    if (random.chance(3)) canvas.fill(rect, {238, 206, 140}, 150);
    if (!random.chance(curtains)) return;
    const Rgb cloth = scaled({226, 220, 208}, random.between(70, 104));
    const int width = rect.width(), height = rect.height();
    switch (random.below(3)) {
        case 0:
            canvas.fill({rect.x0, rect.y1 - height * random.between(15, 90) / 100, rect.x1, rect.y1}, cloth, 225);
            return;
        case 1:
            canvas.fill({rect.x0, rect.y0, rect.x0 + width * random.between(15, 40) / 100, rect.y1}, cloth, 200);
            canvas.fill({rect.x1 - width * random.between(15, 40) / 100, rect.y0, rect.x1, rect.y1}, cloth, 200);
            return;
        default:
            canvas.fill(rect, cloth, random.between(60, 170));
    }
}

void paint_window(PeriodicCanvas& canvas, const Rect& rect, const WindowStyle& style, Random random) {
    if (style.surround > 0) {
        canvas.darken(rect.inset(-style.surround).inset(30, -30, -30, 30), kShade / 2);
        canvas.fill(rect.inset(-style.surround), style.trim);
    }
    if (random.chance(style.shutters)) {
        const int leaf = rect.width() / 2;
        for (const int x : {rect.x0 - leaf, rect.x1}) {
            canvas.fill({x, rect.y0, x + leaf, rect.y1}, style.shutter);
            for (int y = rect.y0 + 80; y + 40 < rect.y1; y += 160)
                canvas.darken({x + 50, y, x + leaf - 50, y + 45}, kShade);
        }
    }
    canvas.fill(rect, style.frame_colour);
    const Rect inside = rect.inset(style.frame);
    const int upper = inside.height() * style.transom / 100;
    const auto glass = [&](const Rect& pane) { paint_glass(canvas, pane, style.glass, 0, random); };
    each_pane({inside.x0, inside.y0, inside.x1, inside.y1 - (upper > 0 ? upper + style.frame / 2 : 0)}, style.panes,
              style.frame, glass);
    if (upper > 0) each_pane({inside.x0, inside.y1 - upper, inside.x1, inside.y1}, style.panes, style.frame, glass);
    // Curtains hang behind all panes alike.
    Random behind(random.next());
    if (behind.chance(style.curtains)) {
        const int drop = inside.height() * behind.between(10, 100) / 100;
        const Rgb cloth = scaled({226, 220, 208}, behind.between(68, 104));
        const int opacity = behind.between(110, 235);
        each_pane(inside, style.panes, style.frame, [&](const Rect& pane) {
            canvas.fill({pane.x0, pane.y1 - drop, pane.x1, pane.y1}, cloth, opacity);
        });
        if (upper > 0)
            canvas.fill({rect.x0, inside.y1 - upper - style.frame / 2, rect.x1, inside.y1 - upper}, style.frame_colour);
    }
    canvas.darken({rect.x0, rect.y1 - 110, rect.x1, rect.y1}, kShade);
    canvas.darken({rect.x0, rect.y0, rect.x0 + 70, rect.y1}, kShade / 2);
    if (!style.sill) return;
    canvas.darken({rect.x0 - 60, rect.y0 - 190, rect.x1 + 90, rect.y0 - 70}, kShade * 3 / 4);
    canvas.fill({rect.x0 - 70, rect.y0 - 80, rect.x1 + 70, rect.y0}, style.trim);
}

void paint_balcony(PeriodicCanvas& canvas, const Rect& rect, Rgb slab, Rgb railing, bool bars) {
    constexpr int kSlab = 190;
    canvas.darken({rect.x0 + 60, rect.y0 - 620, rect.x1 + 120, rect.y0}, kShade);
    if (bars) {
        canvas.darken({rect.x0, rect.y0 + kSlab, rect.x1, rect.y1}, kShade / 3);
        paint_bars(canvas, {rect.x0, rect.y0 + kSlab, rect.x1, rect.y1}, railing);
    } else {
        canvas.fill({rect.x0, rect.y0 + kSlab, rect.x1, rect.y1}, scaled(railing, 90), railing, 256);
    }
    canvas.fill({rect.x0, rect.y0, rect.x1, rect.y0 + kSlab}, slab);
}

void paint_curtain_storey(PeriodicCanvas& canvas, const Rect& rect, int bays, const WindowStyle& style, Rgb panel,
                          Random random) {
    canvas.fill(rect, style.frame_colour);
    const int foot = rect.y0 + rect.height() * style.transom / 100;
    for (int i = 0; i < bays; ++i) {
        const int x0 = rect.x0 + rect.width() * i / bays + style.frame / 2,
                  x1 = rect.x0 + rect.width() * (i + 1) / bays - style.frame / 2;
        if (style.transom > 0)
            canvas.fill({x0, rect.y0 + style.frame / 2, x1, foot - style.frame / 2},
                        scaled(panel, random.between(94, 106)));
        paint_glass(canvas, {x0, foot + style.frame / 2, x1, rect.y1 - style.frame / 2}, style.glass, style.curtains,
                    random);
        canvas.darken({x0, rect.y1 - style.frame / 2 - 60, x1, rect.y1 - style.frame / 2}, kShade / 2);
    }
}

void paint_door(PeriodicCanvas& canvas, const Rect& rect, const WindowStyle& style, Random random) {
    canvas.fill(rect.inset(-120, 0, -120, -120), style.trim);
    const Rgb leaf = scaled(style.shutter, random.between(75, 120));
    canvas.fill(rect, leaf);
    const int light = rect.height() * random.between(0, 25) / 100;
    if (light > 200)
        paint_glass(canvas, {rect.x0 + 80, rect.y1 - light, rect.x1 - 80, rect.y1 - 80}, style.glass, 30, random);
    const int panels = random.between(1, 3), top = rect.y1 - std::max(light, 200) - 60;
    for (int i = 0; i < panels; ++i) {
        const int y0 = rect.y0 + 150 + (top - rect.y0 - 150) * i / panels,
                  y1 = rect.y0 + 150 + (top - rect.y0 - 150) * (i + 1) / panels - 90;
        canvas.darken({rect.x0 + 130, y0, rect.x1 - 130, y1}, kShade / 2);
        canvas.fill({rect.x0 + 160, y0, rect.x1 - 130, y1 - 30}, scaled(leaf, 108));
    }
    canvas.darken({rect.x0, rect.y1 - 120, rect.x1, rect.y1}, kShade);
    canvas.fill({rect.x0 - 200, rect.y0 - 10, rect.x1 + 200, rect.y0 + 130}, {150, 148, 142});
}

void paint_shop(PeriodicCanvas& canvas, const Rect& rect, const WindowStyle& style, Random random) {
    const int sign = rect.height() * random.between(14, 22) / 100, pier = rect.width() * random.between(4, 9) / 100;
    const Rect front{rect.x0 + pier, rect.y0 + random.between(0, 5) * 100, rect.x1 - pier, rect.y1 - sign - 250};
    if (random.chance(14)) {  // a roller shutter that is down
        canvas.fill(front, scaled({168, 170, 172}, random.between(80, 110)));
        for (int y = front.y0; y + 60 < front.y1; y += 130) canvas.darken({front.x0, y, front.x1, y + 45}, kShade / 2);
    } else {
        canvas.fill(front, style.frame_colour);
        const int panes = random.between(2, 4), door = random.below(panes);
        int pane = 0;
        each_pane(front.inset(style.frame), panes, style.frame, [&](const Rect& at) {
            paint_glass(canvas, at, style.glass, 15, random);
            if (pane++ == door) {
                canvas.darken({at.x0, front.y0, at.x1, front.y0 + 2200}, kShade / 2);
                canvas.fill({at.x1 - 140, front.y0 + 900, at.x1 - 100, front.y0 + 1300}, {210, 206, 190});
                return;
            }
            const int goods = at.height() * random.between(10, 45) / 100;
            canvas.fill({at.x0, at.y0, at.x1, at.y0 + goods}, sign_colour(random), 120);
        });
        canvas.darken({front.x0, front.y1 - 260, front.x1, front.y1}, kShade);
    }
    if (!random.chance(78)) return;
    const Rgb board = sign_colour(random);
    const Rect at{rect.x0 + pier, front.y1 + 60, rect.x1 - pier, front.y1 + 60 + sign};
    canvas.fill(at, board);
    const bool dark = board[0] + board[1] + board[2] < 380;
    const int letters = random.between(5, 12), from = at.x0 + at.width() / 5, letter = at.width() * 3 / 5 / letters;
    for (int i = 0; i < letters; ++i) {
        const int x = from + i * letter, y = at.y0 + sign * random.between(24, 34) / 100;
        canvas.fill({x, y, x + letter * random.between(45, 78) / 100, at.y1 - sign * random.between(20, 34) / 100},
                    dark ? Rgb{236, 234, 226} : Rgb{40, 38, 40}, 215);
    }
}

}  // namespace citystream::tiles::city::procedural
