// Detached and row houses, garages.
#include <algorithm>

#include "tiles/city/grammar_elements.h"
#include "tiles/city/grammar_styles.h"

namespace citystream::tiles::city::procedural {
namespace {

constexpr int kSillLevel = 90;
constexpr int kBlindPercent = 20;

struct HouseStyle {
    WindowStyle window;
    bool quoins, string_course, half_timbered, canopy;
};

HouseStyle house_style(Random style) {
    HouseStyle house{};
    house.window.width = 100 + 10 * style.below(4);
    house.window.height = 120 + 10 * style.below(3);
    house.window.mullions = style.between(1, 2);
    house.window.transom_percent = style.chance(40) ? 65 : 0;
    house.window.shutters = style.chance(40);
    house.window.surround = style.chance(50) ? 12 : 0;
    house.window.lintel = style.chance(35) ? 14 : 0;
    house.quoins = style.chance(30);
    house.string_course = style.chance(50);
    house.half_timbered = style.chance(25);
    house.canopy = style.chance(60);
    return house;
}

/// Half-timbering: posts at the bay borders, sill and head beams, all flush with the plaster but for a finger's
/// breadth.
void draw_timber(Canvas& canvas, const Rect& storey, const std::vector<Rect>& bays) {
    const int beam = 18;
    canvas.fill({storey.x0, storey.y0, storey.x1, storey.y0 + beam}, 25, Slot::kAccent);
    canvas.fill({storey.x0, storey.y1 - beam, storey.x1, storey.y1}, 25, Slot::kAccent);
    canvas.fill({storey.x0, storey.y0 + kSillLevel - 14, storey.x1, storey.y0 + kSillLevel - 2}, 20, Slot::kAccent);
    for (const Rect& bay : bays)
        canvas.fill({bay.x0 - beam / 2, storey.y0, bay.x0 + beam / 2, storey.y1}, 25, Slot::kAccent);
    canvas.fill({storey.x0, storey.y0, storey.x0 + beam, storey.y1}, 25, Slot::kAccent);
    canvas.fill({storey.x1 - beam, storey.y0, storey.x1, storey.y1}, 25, Slot::kAccent);
}

void draw_windows(Canvas& canvas, const std::vector<Rect>& bays, WindowStyle window, Random& detail) {
    for (const Rect& bay : bays) {
        WindowStyle here = window;
        here.width = std::min(window.width, bay.width() - 60);
        here.shutters = window.shutters && bay.width() >= 2 * here.width + 24;
        draw_window(canvas, bay.centred(here.width, kSillLevel, here.height), here, detail.chance(kBlindPercent));
    }
}

void draw_garden_door(Canvas& canvas, const Rect& bay, const WindowStyle& window) {
    WindowStyle door = window;
    door.width = std::min(220, bay.width() - 40);
    door.height = kSillLevel + window.height - 6;
    door.mullions = door.width > 150 ? 2 : 1;
    door.transom_percent = 0;
    door.shutters = false;
    door.sill_mm = 150;
    draw_window(canvas, bay.centred(door.width, 6, door.height), door, false);
}

void draw_plinth(Canvas& canvas, int height) {
    canvas.fill({0, 0, canvas.bounds().x1, height}, 30, Slot::kPlinth);
}

}  // namespace

std::vector<Rect> storey_rects(const Canvas& canvas, const Storeys& storeys) {
    std::vector<Rect> rects;
    int foot = 0;
    for (int floor = 0; floor < storeys.floors; ++floor) {
        const int head = foot + (floor == 0 ? storeys.ground_cm : storeys.floor_cm);
        rects.push_back({0, foot, canvas.bounds().x1, head});
        foot = head;
    }
    return rects;
}

void derive_house(Canvas& canvas, const FacadeSpec& spec, const Storeys& storeys, Random style, Random detail) {
    const HouseStyle house = house_style(style);
    const Rect wall = canvas.bounds();
    draw_plinth(canvas, 40);
    if (house.quoins) draw_quoins(canvas, wall.inset(0, 40, 0, storeys.top_cm), 45);
    const int bay_width = spec.role == FacadeRole::kFront ? 270 : spec.role == FacadeRole::kRear ? 310 : 420;
    const std::vector<Rect> storey = storey_rects(canvas, storeys);
    const size_t door_bay = static_cast<size_t>(detail.below(64));
    for (size_t floor = 0; floor < storey.size(); ++floor) {
        const std::vector<Rect> bays = repeat_x(storey[floor].inset(50, 0, 50, 0), bay_width);
        if (floor > 0 && house.half_timbered) draw_timber(canvas, storey[floor], bays);
        if (floor > 0 && house.string_course && !house.half_timbered)
            draw_cornice(canvas, {0, storey[floor].y0 - 10, wall.x1, storey[floor].y0 + 10}, 2, 60, Slot::kCornice);
        std::vector<Rect> windows;
        for (size_t i = 0; i < bays.size(); ++i) {
            const bool doors = floor == 0 && spec.role != FacadeRole::kSide && i == door_bay % bays.size();
            if (!doors)
                windows.push_back(bays[i]);
            else if (spec.role == FacadeRole::kFront)
                draw_door(canvas, bays[i].centred(115, 0, 225), false, house.canopy);
            else
                draw_garden_door(canvas, bays[i], house.window);
        }
        draw_windows(canvas, windows, house.window, detail);
        if (floor == 1 && spec.role == FacadeRole::kRear && style.chance(50))
            draw_balcony(canvas, bays[door_bay % bays.size()].inset(20, 0, 20, 0), 1100, true);
    }
    draw_cornice(canvas, {0, wall.y1 - storeys.top_cm, wall.x1, wall.y1}, 2, 90, Slot::kCornice);
}

void derive_row_house(Canvas& canvas, const FacadeSpec& spec, const Storeys& storeys, Random style, Random detail) {
    HouseStyle house = house_style(style);
    house.window.shutters = false;
    house.window.height += 30;
    const bool bay_window = style.chance(50);
    const Rect wall = canvas.bounds();
    draw_plinth(canvas, 50);
    const std::vector<Rect> storey = storey_rects(canvas, storeys);
    const bool door_left = spec.variant % 2 == 0;
    for (size_t floor = 0; floor < storey.size(); ++floor) {
        if (floor > 0)
            draw_cornice(canvas, {0, storey[floor].y0 - 8, wall.x1, storey[floor].y0 + 12}, 2, 70, Slot::kCornice);
        std::vector<Rect> bays =
            repeat_x(storey[floor].inset(35, 0, 35, 0), spec.role == FacadeRole::kSide ? 450 : 270);
        if (floor == 0 && spec.role == FacadeRole::kFront) {
            const size_t door = door_left ? 0 : bays.size() - 1;
            draw_door(canvas, bays[door].centred(105, 0, 255), true, house.canopy && !bay_window);
            bays.erase(bays.begin() + static_cast<std::ptrdiff_t>(door));
            if (bay_window) {
                for (const Rect& bay : bays) {
                    const Rect box = bay.inset(15, 0, 15, 0);
                    canvas.fill({box.x0, box.y0, box.x1, box.y1 - 20}, 600, Slot::kAccent);
                    canvas.fill({box.x0 - 6, box.y1 - 20, box.x1 + 6, box.y1 - 8}, 660, Slot::kCornice);
                    canvas.fill(box.inset(18, kSillLevel, 18, 45), 520, Slot::kFrame);
                    for (const Rect& pane : repeat_x(box.inset(20, kSillLevel + 2, 20, 47), 70))
                        canvas.fill(pane.inset(4), 480, Slot::kGlass);
                    canvas.fill(box.inset(10, kSillLevel - 7, 10, box.height() - kSillLevel), 650, Slot::kSill);
                }
                continue;
            }
        }
        if (floor == 0 && spec.role == FacadeRole::kRear) {
            draw_garden_door(canvas, bays.back(), house.window);
            bays.pop_back();
        }
        draw_windows(canvas, bays, house.window, detail);
    }
    draw_cornice(canvas, {0, wall.y1 - storeys.top_cm, wall.x1, wall.y1}, 3, 160, Slot::kCornice);
}

void derive_garage(Canvas& canvas) {
    const Rect wall = canvas.bounds();
    draw_sectional_door(canvas, wall.centred(wall.width() - 90, 0, 220), 44);
    canvas.fill({0, wall.y1 - 20, wall.x1, wall.y1}, 60, Slot::kMetal);
}

}  // namespace citystream::tiles::city::procedural
