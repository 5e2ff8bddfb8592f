// Apartment houses of a perimeter block: three eras, shops or flats on the ground floor.
#include <algorithm>

#include "tiles/city/grammar_elements.h"
#include "tiles/city/grammar_styles.h"

namespace citystream::tiles::city::procedural {
namespace {

constexpr int kBlindPercent = 22;

struct ApartmentStyle {
    ApartmentEra era;
    WindowStyle window;
    int sill_level, bay_width;
    bool oriel, balconies, solid_parapet, pilasters, panels, awnings;
};

ApartmentStyle ornate(Random& style) {
    ApartmentStyle look{};
    look.window.width = 110 + 10 * style.below(3);
    look.window.height = 190 + 10 * style.below(3);
    look.window.transom_percent = 68;
    look.window.surround = 16;
    look.window.lintel = 18;
    look.window.reveal_mm = 180;
    look.sill_level = 75;
    look.bay_width = 250 + 20 * style.below(3);
    look.oriel = style.chance(50);
    look.pilasters = style.chance(40);
    look.balconies = style.chance(50);
    return look;
}

ApartmentStyle plain(Random& style) {
    ApartmentStyle look{};
    look.window.width = 140 + 20 * style.below(3);
    look.window.height = 130 + 10 * style.below(2);
    look.window.surround = style.chance(40) ? 8 : 0;
    look.window.reveal_mm = 110;
    look.sill_level = 85;
    look.bay_width = 300 + 20 * style.below(3);
    look.balconies = style.chance(60);
    look.solid_parapet = true;
    look.panels = style.chance(40);
    return look;
}

ApartmentStyle modern(Random& style) {
    ApartmentStyle look{};
    look.window.width = 180 + 20 * style.below(3);
    look.window.height = 220;
    look.window.mullions = style.between(1, 2);
    look.window.reveal_mm = 200;
    look.window.bars = true;
    look.window.sill_mm = 30;
    look.sill_level = 15;
    look.bay_width = 340 + 20 * style.below(3);
    look.balconies = style.chance(75);
    look.solid_parapet = style.chance(40);
    look.panels = style.chance(60);
    return look;
}

ApartmentStyle apartment_style(const FacadeSpec& spec, Random style) {
    const ApartmentEra era = apartment_era(spec.variant);
    ApartmentStyle look = era == ApartmentEra::kOrnate  ? ornate(style)
                          : era == ApartmentEra::kPlain ? plain(style)
                                                        : modern(style);
    look.era = era;
    look.awnings = style.chance(50);
    if (spec.role != FacadeRole::kFront) {
        look.oriel = look.pilasters = false;
        look.window.surround = look.window.lintel = 0;
        look.solid_parapet = false;
    }
    return look;
}

void derive_ground(Canvas& canvas, const FacadeSpec& spec, const ApartmentStyle& look, const Rect& storey,
                   const std::vector<Rect>& bays, Random& detail) {
    const size_t door = bays.size() / 2;
    if (look.era == ApartmentEra::kOrnate && spec.role == FacadeRole::kFront)
        draw_rustication(canvas, storey.inset(0, 50, 0, 20), 40, 30);
    canvas.fill({storey.x0, 0, storey.x1, 50}, 50, Slot::kPlinth);
    for (size_t i = 0; i < bays.size(); ++i) {
        if (i == door) {
            draw_door(canvas, bays[i].centred(spec.role == FacadeRole::kFront ? 150 : 110, 0, 270),
                      spec.role == FacadeRole::kFront, look.era != ApartmentEra::kOrnate);
        } else if (spec.shop && spec.role == FacadeRole::kFront) {
            // Neighbouring bays on one side of the door make one shop.
            const size_t end = i < door ? door : bays.size();
            const Rect shop{bays[i].x0, storey.y0, bays[end - 1].x1, storey.y1 - 22};
            draw_shop(canvas, shop.inset(12, 0, 12, 0), true, look.awnings && detail.chance(60));
            i = end - 1;
        } else {
            WindowStyle window = look.window;
            window.bars = false;
            const int sill = std::max(90, look.sill_level + 15);
            window.height = std::min(window.height, storey.height() - sill - 60);
            window.lintel = 0;
            draw_window(canvas, bays[i].centred(window.width, sill, window.height), window,
                        detail.chance(kBlindPercent));
        }
    }
}

/// A box that stands out over `bay` on the floors between the rectangles' foot and head, with a window each floor.
void draw_oriel_floor(Canvas& canvas, const Rect& bay, const ApartmentStyle& look, bool blind) {
    const int reach = 700;
    const Rect box{bay.x0 + 10, bay.y0, bay.x1 - 10, bay.y1};
    canvas.fill(box, reach, Slot::kAccent);
    canvas.fill({box.x0 - 5, box.y0 - 6, box.x1 + 5, box.y0 + 14}, reach + 60, Slot::kCornice);
    const Rect opening =
        bay.centred(std::min(look.window.width + 50, box.width() - 40), look.sill_level, look.window.height);
    canvas.fill(opening, reach - 60, Slot::kFrame);
    for (const Rect& pane : repeat_x(opening.inset(3), 60))
        for (const Rect& part : split_y(pane, {{0, 2}, {0, 1}}))
            canvas.fill(part.inset(3), reach - 110, blind ? Slot::kBlind : Slot::kGlass);
    canvas.fill({opening.x0 - 6, opening.y0 - 7, opening.x1 + 6, opening.y0}, reach + 50, Slot::kSill);
}

void derive_floor(Canvas& canvas, const FacadeSpec& spec, const ApartmentStyle& look, const Rect& storey, size_t floor,
                  const std::vector<Rect>& bays, Random& detail) {
    const bool front = spec.role == FacadeRole::kFront;
    if (front && look.era == ApartmentEra::kOrnate && (floor == 1 || floor + 1 == spec.floors))
        draw_cornice(canvas, {storey.x0, storey.y0 - 14, storey.x1, storey.y0 + 14}, 2, 130, Slot::kCornice);
    else if (front && look.era == ApartmentEra::kModern)
        canvas.fill({storey.x0, storey.y0 - 10, storey.x1, storey.y0 + 10}, 40, Slot::kCornice);
    const size_t centre = bays.size() / 2;
    for (size_t i = 0; i < bays.size(); ++i) {
        const Rect bay{bays[i].x0, storey.y0, bays[i].x1, storey.y1};
        const bool blind = detail.chance(kBlindPercent);
        if (look.oriel && floor < spec.floors &&
            (i == centre || (bays.size() > 4 && (i == 1 || i + 2 == bays.size())))) {
            if (i != centre || bays.size() <= 4) {
                draw_oriel_floor(canvas, bay, look, blind);
                continue;
            }
        }
        // Balconies stand in columns: at the ends of a front, over the door of a rear.
        const bool column = front ? (i % 3 == 1 || bays.size() <= 3) && i != centre : i % 2 == 0;
        const bool balcony = look.balconies && column;
        WindowStyle window = look.window;
        int sill = look.sill_level;
        if (balcony) {
            window.height += sill - 8;
            sill = 8;
            window.bars = false;
            window.sill_mm = 0;
        }
        if (look.panels && front)
            canvas.fill({bay.x0 + 14, bay.y0 + 12, bay.x1 - 14, bay.y0 + sill + look.window.height / 2}, 20,
                        Slot::kAccent);
        draw_window(canvas, bay.centred(window.width, sill, window.height), window, blind);
        if (balcony) draw_balcony(canvas, bay.inset(10, 0, 10, 0), front ? 1000 : 1200, !look.solid_parapet);
    }
}

void derive_top(Canvas& canvas, const FacadeSpec& spec, const ApartmentStyle& look, const Rect& top) {
    if (spec.role != FacadeRole::kFront) {
        canvas.fill({top.x0, top.y1 - 20, top.x1, top.y1}, 60, Slot::kCornice);
        return;
    }
    if (look.era != ApartmentEra::kOrnate) {
        canvas.fill({top.x0, top.y0, top.x1, top.y0 + 12}, 60, Slot::kCornice);
        canvas.fill({top.x0, top.y1 - 12, top.x1, top.y1}, 100, Slot::kMetal);
        return;
    }
    canvas.fill({top.x0, top.y0, top.x1, top.y0 + 10}, 70, Slot::kCornice);
    draw_cornice(canvas, {top.x0, top.y1 - 42, top.x1, top.y1}, 3, 420, Slot::kCornice);
    for (const Rect& cell : repeat_x({top.x0, top.y1 - 62, top.x1, top.y1 - 42}, 70))
        canvas.fill(cell.centred(18, 0, 20), 240, Slot::kQuoin);
}

}  // namespace

void derive_apartment(Canvas& canvas, const FacadeSpec& spec, const Storeys& storeys, Random style, Random detail) {
    const ApartmentStyle look = apartment_style(spec, style);
    const std::vector<Rect> storey = storey_rects(canvas, storeys);
    const Rect wall = canvas.bounds();
    const Rect top{0, storey.back().y1, wall.x1, wall.y1};
    const std::vector<Rect> bays = repeat_x(wall.inset(45, 0, 45, 0), look.bay_width);
    if (look.era == ApartmentEra::kOrnate && spec.role == FacadeRole::kFront) {
        if (look.pilasters) {
            for (size_t i = 1; i < bays.size(); ++i)
                canvas.fill({bays[i].x0 - 16, storeys.ground_cm, bays[i].x0 + 16, top.y0}, 60, Slot::kQuoin);
        }
        draw_quoins(canvas, {0, storeys.ground_cm, wall.x1, top.y0}, 70);
    }
    derive_ground(canvas, spec, look, storey.front(), bays, detail);
    for (size_t floor = 1; floor < storey.size(); ++floor)
        derive_floor(canvas, spec, look, storey[floor], floor, bays, detail);
    derive_top(canvas, spec, look, top);
}

}  // namespace citystream::tiles::city::procedural
