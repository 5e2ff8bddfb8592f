// Office towers (stacked sections) and industrial halls.
#include <algorithm>

#include "tiles/city/grammar_elements.h"
#include "tiles/city/grammar_styles.h"

namespace citystream::tiles::city::procedural {
namespace {

enum class Cladding : uint8_t { kCurtainWall, kRibbons, kGrid };

void derive_curtain_floor(Canvas& canvas, const Rect& storey, int module, int spandrel, Random& detail) {
    canvas.fill({storey.x0, storey.y0, storey.x1, storey.y0 + spandrel}, 0, Slot::kAccent);
    const std::vector<Rect> modules = repeat_x(storey, module);
    for (const Rect& cell : modules) {
        const Rect pane{cell.x0 + 3, storey.y0 + spandrel + 3, cell.x1 - 3, storey.y1 - 3};
        canvas.fill(pane, -60, detail.chance(12) ? Slot::kBlind : Slot::kGlass);
    }
    canvas.fill({storey.x0, storey.y0 + spandrel - 3, storey.x1, storey.y0 + spandrel + 3}, 40, Slot::kFrame);
    canvas.fill({storey.x0, storey.y1 - 3, storey.x1, storey.y1}, 40, Slot::kFrame);
}

void draw_fins(Canvas& canvas, const Rect& field, int module, int reach_mm) {
    const std::vector<Rect> modules = repeat_x(field, module);
    for (const Rect& cell : modules)
        canvas.fill({cell.x0 - 3, field.y0, cell.x0 + 3, field.y1}, reach_mm, Slot::kFrame);
    canvas.fill({field.x1 - 3, field.y0, field.x1, field.y1}, reach_mm, Slot::kFrame);
}

void derive_ribbon_floor(Canvas& canvas, const Rect& storey, int module, Random& detail) {
    const Rect ribbon = storey.inset(60, 100, 60, 60);
    canvas.fill({storey.x0, storey.y0 + 30, storey.x1, ribbon.y0 - 12}, 50, Slot::kAccent);
    canvas.fill(ribbon, -180, Slot::kFrame);
    for (const Rect& pane : repeat_x(ribbon, module))
        canvas.fill(pane.inset(4, 6, 4, 6), -230, detail.chance(15) ? Slot::kBlind : Slot::kGlass);
    canvas.fill({ribbon.x0, ribbon.y0 - 8, ribbon.x1, ribbon.y0}, 90, Slot::kSill);
}

void derive_grid_floor(Canvas& canvas, const Rect& storey, int module, Random& detail) {
    for (const Rect& cell : repeat_x(storey.inset(30, 0, 30, 0), module)) {
        const Rect opening = cell.inset(28, 55, 28, 35);
        canvas.fill(opening.inset(-10), -40, Slot::kAccent);
        canvas.fill(opening, -160, Slot::kFrame);
        const Slot glass = detail.chance(15) ? Slot::kBlind : Slot::kGlass;
        for (const Rect& pane : split_x(opening.inset(5), {{0, 2}, {5, 0}, {0, 1}}))
            if (pane.width() > 5) canvas.fill(pane, -210, glass);
    }
    canvas.fill({storey.x0, storey.y0 - 12, storey.x1, storey.y0 + 12}, 60, Slot::kWall);
}

/// The two lowest storeys: columns, tall glass, entrances with a canopy.
void derive_lobby(Canvas& canvas, const Rect& lobby, bool front) {
    canvas.fill(lobby, 80, Slot::kPlinth);
    const std::vector<Rect> bays = repeat_x(lobby.inset(40, 0, 40, 0), 500);
    for (size_t i = 0; i < bays.size(); ++i) {
        const Rect opening = bays[i].inset(45, 30, 45, 70);
        canvas.fill(opening, -120, Slot::kShopfront);
        for (const Rect& column : repeat_x(opening, 140))
            for (const Rect& pane : repeat_y(column, 220)) canvas.fill(pane.inset(4), -200, Slot::kGlass);
        if (front && i == bays.size() / 2) {
            const Rect door = bays[i].centred(260, 8, 260);
            canvas.fill(door.inset(-10, 0, -10, -10), -40, Slot::kMetal);
            for (const Rect& leaf : repeat_x(door, 130)) canvas.fill(leaf.inset(6), -230, Slot::kGlass);
            canvas.fill({door.x0 - 60, door.y1 + 20, door.x1 + 60, door.y1 + 50}, 1200, Slot::kMetal);
            canvas.fill({door.x0 - 30, door.y1 + 60, door.x1 + 30, door.y1 + 110}, 120, Slot::kSign);
        }
    }
    draw_cornice(canvas, {lobby.x0, lobby.y1 - 40, lobby.x1, lobby.y1}, 2, 200, Slot::kCornice);
}

}  // namespace

void derive_tower(Canvas& canvas, const FacadeSpec& spec, const Storeys& storeys, Random style, Random detail) {
    const auto cladding = static_cast<Cladding>(spec.variant % 3);
    const int module = cladding == Cladding::kGrid ? 300 : 150 + 25 * style.below(3);
    const int spandrel = 70 + 10 * style.below(4);
    const int fin_mm = 80 + 40 * style.below(4);
    const std::vector<Rect> storey = storey_rects(canvas, storeys);
    const Rect wall = canvas.bounds();
    const size_t first = spec.section == FacadeSection::kBase ? 2 : 0;
    const Rect field{0, first > 0 ? storey[1].y1 : 0, wall.x1, storey.back().y1};
    for (size_t floor = first; floor < storey.size(); ++floor) {
        switch (cladding) {
            case Cladding::kCurtainWall:
                derive_curtain_floor(canvas, storey[floor], module, spandrel, detail);
                break;
            case Cladding::kRibbons:
                derive_ribbon_floor(canvas, storey[floor], module, detail);
                break;
            case Cladding::kGrid:
                derive_grid_floor(canvas, storey[floor], module, detail);
                break;
        }
    }
    if (cladding == Cladding::kCurtainWall) draw_fins(canvas, field, module, fin_mm);
    if (first > 0) derive_lobby(canvas, {0, 0, wall.x1, storey[1].y1}, spec.role == FacadeRole::kFront);
    if (spec.section == FacadeSection::kTop) {
        const Rect crown{0, storey.back().y1, wall.x1, wall.y1};
        canvas.fill(crown, 40, Slot::kAccent);
        canvas.fill({0, crown.y0, wall.x1, crown.y0 + 20}, 150, Slot::kCornice);
        canvas.fill({0, crown.y1 - 25, wall.x1, crown.y1}, 200, Slot::kMetal);
    }
}

void derive_hall(Canvas& canvas, const FacadeSpec& spec, Random style, Random detail) {
    const Rect wall = canvas.bounds();
    const int pier = 600 + 100 * style.below(3);
    const bool piers = style.chance(60);
    canvas.fill({0, 0, wall.x1, 80}, 60, Slot::kPlinth);
    const std::vector<Rect> bays = repeat_x(wall, pier);
    const size_t office = static_cast<size_t>(detail.below(static_cast<int>(bays.size())));
    for (size_t i = 0; i < bays.size(); ++i) {
        const Rect& bay = bays[i];
        if (spec.role == FacadeRole::kFront && i == office) {
            draw_door(canvas, bay.centred(110, 0, 220), false, true);
        } else if (spec.role == FacadeRole::kFront && (i + office) % 2 == 1) {
            draw_sectional_door(canvas, bay.centred(400, 0, 420), 60);
            canvas.fill(bay.centred(470, 440, 14), 1000, Slot::kMetal);
        }
        const Rect ribbon = bay.inset(50, wall.height() - 145, 50, 60);
        canvas.fill(ribbon, -60, Slot::kFrame);
        for (const Rect& pane : repeat_x(ribbon.inset(4), 120)) canvas.fill(pane.inset(3), -110, Slot::kGlass);
        if (piers && i > 0) canvas.fill({bay.x0 - 20, 0, bay.x0 + 20, wall.y1}, 120, Slot::kQuoin);
    }
    if (spec.role == FacadeRole::kFront)
        canvas.fill({wall.x1 / 2 - 250, wall.y1 - 46, wall.x1 / 2 + 250, wall.y1 - 14}, 140, Slot::kSign);
    canvas.fill({0, wall.y1 - 12, wall.x1, wall.y1}, 160, Slot::kMetal);
}

}  // namespace citystream::tiles::city::procedural
