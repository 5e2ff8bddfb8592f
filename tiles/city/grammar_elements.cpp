#include "tiles/city/grammar_elements.h"

#include <algorithm>

namespace citystream::tiles::city::procedural {
namespace {

constexpr int kSillHeight = 6;
constexpr int kBarWidth = 5;
constexpr int kThreshold = 4;  // keeps the wall's foot closed below doors

void draw_panes(Canvas& canvas, const Rect& inner, const WindowStyle& style, bool blind) {
    const Slot glass = blind ? Slot::kBlind : Slot::kGlass;
    canvas.fill(inner, -style.reveal_mm, glass);
    const int frame_mm = -style.reveal_mm + 40;
    const int bar = std::max(4, style.frame - 2);
    for (int i = 1; i <= style.mullions; ++i) {
        const int x = inner.x0 + inner.width() * i / (style.mullions + 1) - bar / 2;
        canvas.fill({x, inner.y0, x + bar, inner.y1}, frame_mm, Slot::kFrame);
    }
    if (style.transom_percent > 0) {
        const int y = inner.y0 + inner.height() * style.transom_percent / 100 - bar / 2;
        canvas.fill({inner.x0, y, inner.x1, y + bar}, frame_mm, Slot::kFrame);
    }
}

void draw_french_bars(Canvas& canvas, const Rect& opening) {
    const int top = opening.y0 + 95;
    const Rect field{opening.x0 - 4, opening.y0 + 8, opening.x1 + 4, top};
    for (const Rect& cell : repeat_x(field, 26))
        canvas.fill({cell.x0 + (cell.width() - 3) / 2, cell.y0, cell.x0 + (cell.width() - 3) / 2 + 3, cell.y1}, 60,
                    Slot::kRailing);
    canvas.fill({field.x0, opening.y0 + 8, field.x1, opening.y0 + 12}, 70, Slot::kRailing);
    canvas.fill({field.x0, top - 5, field.x1, top}, 80, Slot::kRailing);
}

}  // namespace

void draw_window(Canvas& canvas, const Rect& opening, const WindowStyle& style, bool blind) {
    if (style.shutters) {
        const int leaf = opening.width() / 2 - 4;
        for (const Rect& side : {Rect{opening.x0 - leaf - 4, opening.y0, opening.x0 - 4, opening.y1},
                                 Rect{opening.x1 + 4, opening.y0, opening.x1 + leaf + 4, opening.y1}}) {
            canvas.fill(side, 45, Slot::kShutter);
            canvas.fill(side.inset(7, 7, 7, side.height() / 2 + 3), 25, Slot::kShutter);
            canvas.fill(side.inset(7, side.height() / 2 + 3, 7, 7), 25, Slot::kShutter);
        }
    } else if (style.surround > 0) {
        canvas.fill(opening.inset(-style.surround), style.surround_mm, Slot::kQuoin);
    }
    if (style.lintel > 0) {
        const int reach = style.surround > 0 ? style.surround + 6 : 12;
        const int foot = opening.y1 + (style.surround > 0 ? style.surround : 0);
        canvas.fill({opening.x0 - reach, foot, opening.x1 + reach, foot + style.lintel}, style.surround_mm + 50,
                    Slot::kCornice);
    }
    canvas.fill(opening, -style.reveal_mm + 50, Slot::kFrame);
    draw_panes(canvas, opening.inset(style.frame), style, blind);
    if (style.sill_mm > 0)
        canvas.fill({opening.x0 - 6, opening.y0 - kSillHeight, opening.x1 + 6, opening.y0}, style.sill_mm, Slot::kSill);
    if (style.bars) draw_french_bars(canvas, opening);
}

void draw_door(Canvas& canvas, const Rect& opening, bool fanlight, bool canopy) {
    canvas.fill(opening.inset(-12, 0, -12, -12), 40, Slot::kQuoin);
    canvas.fill(opening, -120, Slot::kFrame);
    const int leaf_top = fanlight ? opening.y1 - 50 : opening.y1 - 7;
    const Rect leaf{opening.x0 + 7, opening.y0, opening.x1 - 7, leaf_top};
    canvas.fill(leaf, -160, Slot::kDoor);
    if (fanlight) canvas.fill({leaf.x0, leaf_top + 6, leaf.x1, opening.y1 - 7}, -180, Slot::kGlass);
    const int middle = leaf.y0 + leaf.height() / 2;
    canvas.fill({leaf.x0 + 14, leaf.y0 + 14, leaf.x1 - 14, middle - 7}, -180, Slot::kDoor);
    canvas.fill({leaf.x0 + 14, middle + 7, leaf.x1 - 14, leaf.y1 - 14}, -185, fanlight ? Slot::kDoor : Slot::kGlass);
    canvas.fill({leaf.x1 - 11, middle - 6, leaf.x1 - 7, middle + 6}, -110, Slot::kMetal);
    canvas.fill({opening.x0 - 15, opening.y0, opening.x1 + 15, opening.y0 + 15}, 300, Slot::kPlinth);
    if (canopy) canvas.fill({opening.x0 - 25, opening.y1 + 18, opening.x1 + 25, opening.y1 + 30}, 900, Slot::kCornice);
}

void draw_sectional_door(Canvas& canvas, const Rect& opening, int panel) {
    canvas.fill(opening.inset(-10, 0, -10, -10), 30, Slot::kFrame);
    canvas.fill(opening.inset(0, kThreshold, 0, 0), -150, Slot::kMetal);
    for (const Rect& part : repeat_y(opening.inset(0, kThreshold, 0, 0), panel))
        canvas.fill(part.inset(0, 2, 0, 2), -130, Slot::kDoor);
}

void draw_shop(Canvas& canvas, const Rect& bay, bool door, bool awning) {
    const std::vector<Rect> parts = split_y(bay, {{45, 0}, {0, 1}, {55, 0}});
    canvas.fill(bay, 20, Slot::kShopfront);
    const Rect panes = parts[1].inset(12, 0, 12, 8);
    canvas.fill(parts[0].inset(12, 0, 12, 0), 40, Slot::kPlinth);
    for (const Rect& pane : repeat_x(panes, 160)) {
        canvas.fill(pane, -100, Slot::kShopfront);
        canvas.fill(pane.inset(4, 5, 4, 5), -160, Slot::kGlass);
    }
    if (door) {
        const Rect opening = bay.centred(110, kThreshold, panes.y1 - bay.y0 - kThreshold);
        canvas.fill({opening.x0, bay.y0, opening.x1, opening.y0}, 0, Slot::kPlinth);
        canvas.fill(opening, -200, Slot::kShopfront);
        canvas.fill(opening.inset(9, 12, 9, 60), -230, Slot::kGlass);
        canvas.fill(opening.inset(9, opening.height() - 52, 9, 8), -230, Slot::kGlass);
    }
    canvas.fill(parts[2].inset(4, 3, 4, 5), 80, Slot::kSign);
    if (awning) {
        const int foot = parts[2].y0 - 6;
        canvas.fill({bay.x0 + 8, foot, bay.x1 - 8, foot + 9}, 1100, Slot::kSign);
        canvas.fill({bay.x0 + 8, foot + 9, bay.x1 - 8, foot + 18}, 750, Slot::kSign);
        canvas.fill({bay.x0 + 8, foot + 18, bay.x1 - 8, foot + 27}, 380, Slot::kSign);
    }
}

void draw_balcony(Canvas& canvas, const Rect& bay, int depth_mm, bool bars) {
    canvas.fill({bay.x0, bay.y0 - 18, bay.x1, bay.y0 + 2}, depth_mm, Slot::kBalcony);
    if (!bars) {
        canvas.fill({bay.x0, bay.y0 + 2, bay.x1, bay.y0 + 92}, depth_mm - 20, Slot::kRailing);
        canvas.fill({bay.x0, bay.y0 + 92, bay.x1, bay.y0 + 100}, depth_mm + 20, Slot::kBalcony);
        return;
    }
    const Rect field{bay.x0, bay.y0 + 2, bay.x1, bay.y0 + 94};
    for (const Rect& cell : repeat_x(field, 32)) {
        const int left = cell.x0 + (cell.width() - kBarWidth) / 2;
        canvas.fill({left, cell.y0, left + kBarWidth, cell.y1}, depth_mm - 30, Slot::kRailing);
    }
    canvas.fill({bay.x0, bay.y0 + 94, bay.x1, bay.y0 + 100}, depth_mm, Slot::kRailing);
}

void draw_cornice(Canvas& canvas, const Rect& band, int steps, int reach_mm, Slot slot) {
    for (int i = 0; i < steps; ++i)
        canvas.fill({band.x0, band.y0 + band.height() * i / steps, band.x1, band.y0 + band.height() * (i + 1) / steps},
                    reach_mm * (i + 1) / steps, slot);
}

void draw_quoins(Canvas& canvas, const Rect& wall, int course) {
    bool wide = true;
    for (const Rect& row : repeat_y(wall, course)) {
        const int reach = wide ? 46 : 30;
        canvas.fill({row.x0, row.y0, row.x0 + reach, row.y1}, 35, Slot::kQuoin);
        canvas.fill({row.x1 - reach, row.y0, row.x1, row.y1}, 35, Slot::kQuoin);
        wide = !wide;
    }
}

void draw_rustication(Canvas& canvas, const Rect& wall, int course, int relief_mm) {
    for (const Rect& row : repeat_y(wall, course)) canvas.fill(row.inset(0, 0, 0, 3), relief_mm, Slot::kPlinth);
}

}  // namespace citystream::tiles::city::procedural
