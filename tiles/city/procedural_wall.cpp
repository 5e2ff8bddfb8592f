#include "tiles/city/procedural_wall.h"

#include <algorithm>
#include <array>
#include <utility>

#include "tiles/city/generator_random.h"
#include "tiles/city/procedural_wall_parts.h"

namespace citystream::tiles::city::procedural {
namespace {

enum class Build : uint8_t { kBrick, kPlaster, kAshlar, kRubble, kPanel, kTiles, kSiding, kSheet };

/// Colours of a family and what its walls are made of, the likelier the more often named.
struct Family {
    std::array<Rgb, 4> colours;
    std::array<Build, 4> builds;
};

constexpr std::array<Family, kWallFamilies> kFamilies = {{
    {{{{150, 72, 54}, {168, 84, 60}, {132, 62, 52}, {176, 104, 82}}},
     {Build::kBrick, Build::kBrick, Build::kBrick, Build::kTiles}},
    {{{{196, 160, 108}, {214, 178, 122}, {222, 190, 132}, {188, 150, 104}}},
     {Build::kBrick, Build::kPlaster, Build::kAshlar, Build::kPlaster}},
    {{{{236, 230, 216}, {228, 224, 214}, {240, 236, 228}, {222, 214, 198}}},
     {Build::kPlaster, Build::kPlaster, Build::kTiles, Build::kSiding}},
    {{{{178, 176, 172}, {158, 156, 152}, {196, 194, 190}, {138, 138, 136}}},
     {Build::kPanel, Build::kPanel, Build::kAshlar, Build::kRubble}},
    {{{{202, 190, 168}, {210, 196, 166}, {190, 176, 150}, {216, 204, 182}}},
     {Build::kAshlar, Build::kAshlar, Build::kPlaster, Build::kPanel}},
    {{{{214, 160, 128}, {196, 208, 190}, {190, 203, 214}, {226, 196, 188}}},
     {Build::kPlaster, Build::kPlaster, Build::kSiding, Build::kTiles}},
    {{{{112, 84, 66}, {96, 74, 62}, {130, 98, 72}, {104, 78, 70}}},
     {Build::kBrick, Build::kSiding, Build::kRubble, Build::kTiles}},
    {{{{150, 164, 176}, {124, 140, 156}, {172, 182, 188}, {106, 120, 132}}},
     {Build::kSheet, Build::kPanel, Build::kSheet, Build::kTiles}},
}};

Rgb jittered(Rgb colour, int reach, Random& random) {
    const int brightness = random.between(-reach, reach);
    for (uint8_t& channel : colour)
        channel =
            static_cast<uint8_t>(std::clamp(channel + brightness + random.between(-reach / 2, reach / 2), 8, 250));
    return colour;
}

/// A photograph's size: some as cameras and cutters leave them, the rest anyhow.
void choose_size(WallTexture& texture, Random& random) {
    constexpr std::array<std::array<uint16_t, 2>, 6> kSizes = {
        {{512, 512}, {512, 512}, {500, 375}, {512, 384}, {400, 300}, {400, 400}}};
    const auto draw = static_cast<size_t>(random.below(9));
    texture.width = draw < 6 ? kSizes[draw][0] : static_cast<uint16_t>(random.between(380, 680));
    texture.height = draw < 6 ? kSizes[draw][1] : static_cast<uint16_t>(random.between(320, 600));
    if (texture.use == WallUse::kHouseDoor || texture.use == WallUse::kShop)
        texture.height = static_cast<uint16_t>(texture.height * 2 / 5);
}

struct Grid {
    int bays, bay_mm, storeys, storey_mm;
};

Grid choose_grid(WallUse use, Random& random) {
    switch (use) {
        case WallUse::kHouse:
            return {random.between(3, 5), random.between(20, 32) * 100, random.between(2, 3),
                    random.between(27, 30) * 100};
        case WallUse::kApartment:
            return {random.between(4, 7), random.between(20, 36) * 100, random.between(3, 5),
                    random.between(27, 36) * 100};
        case WallUse::kTower:
            return {random.between(5, 10), random.between(13, 34) * 100, random.between(3, 6),
                    random.between(34, 38) * 100};
        case WallUse::kHall:
            return {random.between(2, 4), random.between(40, 80) * 100, 1, random.between(60, 90) * 100};
        case WallUse::kHouseDoor:
            return {random.between(2, 4), random.between(26, 38) * 100, 1, random.between(27, 32) * 100};
        case WallUse::kShop:
            return {random.between(2, 5), random.between(32, 60) * 100, 1, random.between(33, 44) * 100};
        case WallUse::kPlain:
            break;
    }
    const int side = random.between(40, 100) * 100;
    return {1, side, 1, side};
}

Masonry brick(Rgb colour, Random& random) {
    return {colour,
            scaled({176, 166, 152}, random.between(70, 110)),
            random.between(21, 29) * 10,
            random.between(65, 85),
            12,
            50,
            random.between(8, 22),
            random.between(0, 12)};
}

Masonry plaster(Rgb colour, Random& random) {
    return {colour, scaled(colour, 96), 0, random.between(15, 60) * 100, random.chance(40) ? 25 : 0, 0, 2, 0};
}

Masonry ashlar(Rgb colour, Random& random) {
    return {colour,
            scaled(colour, random.between(68, 88)),
            random.between(50, 95) * 10,
            random.between(28, 48) * 10,
            random.between(10, 22),
            50,
            random.between(4, 11),
            4};
}

Masonry rubble(Rgb colour, Random& random) {
    return {colour,
            scaled(colour, random.between(105, 125)),
            random.between(28, 55) * 10,
            random.between(16, 30) * 10,
            30,
            random.between(30, 60),
            20,
            14};
}

Masonry panel(Rgb colour, Random& random) {
    return {colour,
            scaled(colour, random.between(45, 75)),
            random.between(12, 36) * 100,
            random.between(9, 30) * 100,
            random.between(15, 40),
            0,
            random.between(2, 7),
            2};
}

Masonry tiles(Rgb colour, Random& random) {
    return {colour,
            scaled(colour, random.between(72, 120)),
            random.between(10, 30) * 10,
            random.between(6, 15) * 10,
            12,
            random.chance(50) ? 0 : 50,
            random.between(6, 16),
            5};
}

Masonry siding(Rgb colour, Random& random) {
    return {colour,
            scaled(colour, random.between(55, 75)),
            random.between(20, 40) * 100,
            random.between(12, 22) * 10,
            22,
            43,
            random.between(3, 9),
            3};
}

Masonry sheet(Rgb colour, Random& random) {
    return {colour, scaled(colour, random.between(60, 80)), random.between(25, 60) * 10, 6000, 30, 0, 3, 0};
}

Masonry masonry_of(Build build, Rgb colour, Random& random) {
    switch (build) {
        case Build::kBrick:
            return brick(colour, random);
        case Build::kPlaster:
            return plaster(colour, random);
        case Build::kAshlar:
            return ashlar(colour, random);
        case Build::kRubble:
            return rubble(colour, random);
        case Build::kPanel:
            return panel(colour, random);
        case Build::kTiles:
            return tiles(colour, random);
        case Build::kSiding:
            return siding(colour, random);
        case Build::kSheet:
            return sheet(colour, random);
    }
    return {};
}

WindowStyle window_style(const WallTexture& texture, int bay_mm, int storey_mm, Random& random) {
    constexpr std::array<Rgb, 5> kFrames = {
        {{232, 230, 224}, {232, 230, 224}, {62, 60, 60}, {110, 78, 54}, {150, 154, 158}}};
    constexpr std::array<Rgb, 6> kLeaves = {
        {{92, 48, 32}, {42, 74, 58}, {122, 34, 34}, {44, 58, 92}, {70, 70, 74}, {168, 120, 62}}};
    constexpr std::array<Rgb, 4> kGlass = {{{66, 80, 94}, {58, 74, 82}, {82, 90, 96}, {60, 84, 104}}};
    WindowStyle style;
    style.width = bay_mm * random.between(34, 58) / 100;
    style.height = storey_mm * random.between(42, 60) / 100;
    style.frame = random.between(50, 90);
    style.panes = style.width < 900 ? 1 : style.width > 1900 ? random.between(3, 4) : random.between(1, 2);
    style.transom = random.chance(35) ? random.between(22, 34) : 0;
    style.frame_colour = jittered(kFrames[static_cast<size_t>(random.below(5))], 10, random);
    style.trim =
        random.chance(50) ? scaled(texture.colour, random.between(70, 90)) : jittered({220, 214, 202}, 14, random);
    style.shutter = jittered(kLeaves[static_cast<size_t>(random.below(6))], 12, random);
    style.glass = jittered(kGlass[static_cast<size_t>(random.below(4))], 10, random);
    style.surround = random.chance(40) ? random.between(80, 200) : 0;
    style.sill = random.chance(80);
    const bool home = texture.use == WallUse::kHouse || texture.use == WallUse::kApartment;
    style.shutters = home && style.width * 2 + 200 < bay_mm && random.chance(30) ? random.between(70, 100) : 0;
    style.curtains = random.between(15, 75);
    return style;
}

/// One drawing.
class Drawing {
  public:
    explicit Drawing(const WallTexture& texture)
        : texture_(texture),
          random_(texture.seed),
          family_(kFamilies[texture.family]),
          bay_(texture.width_mm / texture.bays),
          storey_(texture.height_mm / texture.storeys),
          masonry_(masonry_of(build(), texture.colour, random_)),
          style_(window_style(texture, bay_, storey_, random_)),
          canvas_(texture.width, texture.height, texture.width_mm, texture.height_mm, masonry_.joint) {}

    Image draw() && {
        lay_courses(canvas_, masonry_, random_.next());
        switch (texture_.use) {
            case WallUse::kHouse:
            case WallUse::kApartment:
                draw_window_rows();
                break;
            case WallUse::kTower:
                draw_tower();
                break;
            case WallUse::kHall:
                draw_hall();
                break;
            case WallUse::kHouseDoor:
            case WallUse::kShop:
                draw_ground_floor();
                break;
            case WallUse::kPlain:
                draw_pipes();
                break;
        }
        const bool smooth = masonry_.unit_mm == 0;
        canvas_.weather({random_.between(smooth ? 12 : 6, smooth ? 34 : 26), random_.between(0, 26),
                         random_.between(4, 20), random_.next()});
        return std::move(canvas_).finish();
    }

  private:
    Build build() {
        if (texture_.use == WallUse::kHall) return random_.chance(70) ? Build::kSheet : Build::kPanel;
        return family_.builds[static_cast<size_t>(random_.below(4))];
    }

    Rect cell(int bay, int storey) const {
        return {texture_.width_mm * bay / texture_.bays, texture_.height_mm * storey / texture_.storeys,
                texture_.width_mm * (bay + 1) / texture_.bays, texture_.height_mm * (storey + 1) / texture_.storeys};
    }

    void draw_window_rows() {
        const int sill = std::min((storey_ - style_.height) * random_.between(35, 60) / 100, 1000);
        const bool band = random_.chance(35), pilasters = random_.chance(18), bars = random_.chance(60);
        const int balconies = texture_.use == WallUse::kApartment && random_.chance(45) ? random_.between(2, 3) : 0;
        const int wide = random_.chance(25) ? random_.between(0, texture_.bays - 1) : -1;
        const uint64_t windows = random_.next();
        const Rgb railing = bars ? scaled(style_.shutter, 70) : jittered({206, 204, 200}, 20, random_);
        for (int storey = 0; storey < texture_.storeys; ++storey) {
            const Rect row{0, cell(0, storey).y0, texture_.width_mm, cell(0, storey).y1};
            if (band) {
                canvas_.darken({row.x0, row.y0 - 170, row.x1, row.y0}, 70);
                canvas_.fill({row.x0, row.y0, row.x1, row.y0 + 210}, style_.trim);
            }
            for (int bay = 0; bay < texture_.bays; ++bay) {
                const Rect at = cell(bay, storey);
                const bool door = balconies > 0 && bay % balconies == 0;
                const int width = bay == wide ? std::min(style_.width * 3 / 2, bay_ - 300) : style_.width;
                const Rect window =
                    door ? at.centred(width, 200, sill + style_.height - 200) : at.centred(width, sill, style_.height);
                paint_window(canvas_, window, style_, Random(hash(windows, bay, storey)));
                if (door)
                    paint_balcony(canvas_, at.centred(std::min(bay_ - 120, style_.width + 1300), 0, 1150),
                                  scaled(style_.trim, 92), railing, bars);
            }
        }
        if (!pilasters) return;
        for (int bay = 0; bay < texture_.bays; ++bay) {
            const int x = cell(bay, 0).x0;
            canvas_.darken({x + 120, 0, x + 220, texture_.height_mm}, 60);
            canvas_.fill({x - 130, 0, x + 130, texture_.height_mm}, scaled(texture_.colour, 106));
        }
    }

    void draw_tower() {
        const int kind = random_.below(3);  // all glass, ribbons of glass, windows between piers
        WindowStyle style = style_;
        style.glass = scaled(style.glass, random_.between(85, 150));
        style.transom = kind == 0 ? random_.between(0, 1) * random_.between(15, 30) : random_.between(32, 48);
        const Rgb panel = kind == 0 ? scaled(style.glass, random_.between(70, 130)) : texture_.colour;
        const uint64_t storeys = random_.next();
        const int pier = kind == 2 ? bay_ * random_.between(14, 30) / 100 : 0;
        for (int storey = 0; storey < texture_.storeys; ++storey) {
            const Rect row{0, cell(0, storey).y0, texture_.width_mm, cell(0, storey).y1};
            Random random(hash(storeys, storey));
            if (kind == 1) {  // the parapet keeps the wall's own material
                const int foot = row.y0 + row.height() * style.transom / 100;
                WindowStyle glass = style;
                glass.transom = 0;
                paint_curtain_storey(canvas_, {row.x0, foot, row.x1, row.y1}, texture_.bays, glass, panel, random);
            } else {
                paint_curtain_storey(canvas_, row, texture_.bays, style, panel, random);
            }
        }
        for (int bay = 0; pier > 0 && bay < texture_.bays; ++bay) {
            const int x = cell(bay, 0).x0;
            canvas_.darken({x + pier / 2, 0, x + pier / 2 + 150, texture_.height_mm}, 90);
            canvas_.fill({x - pier / 2, 0, x + pier / 2, texture_.height_mm}, scaled(texture_.colour, 104));
        }
    }

    void draw_hall() {
        const int height = storey_ * random_.between(12, 24) / 100, foot = storey_ * random_.between(58, 72) / 100;
        const int plinth = random_.chance(50) ? random_.between(4, 12) * 100 : 0;
        const uint64_t bays = random_.next();
        if (plinth > 0) canvas_.fill({0, 0, texture_.width_mm, plinth}, {146, 144, 140});
        const int gates = random_.chance(55) ? random_.between(2, 3) : 0;
        for (int bay = 0; bay < texture_.bays; ++bay) {
            const Rect at = cell(bay, 0);
            Random random(hash(bays, bay));
            WindowStyle style = style_;
            style.panes = std::max(2, bay_ / 1500);
            style.curtains = style.shutters = style.surround = 0;
            paint_window(canvas_, at.inset(bay_ / 12, 0, bay_ / 12, 0).centred(bay_ * 5 / 6, foot, height), style,
                         random);
            if (gates == 0 || bay % gates != 0) continue;
            const Rect gate = at.centred(bay_ / 2, 0, storey_ / 2);
            canvas_.fill(gate.inset(-100, 0, -100, -100), scaled(texture_.colour, 60));
            canvas_.fill(gate, scaled(style_.shutter, 115));
            for (int y = gate.y0; y + 200 < gate.y1; y += 480) canvas_.darken({gate.x0, y, gate.x1, y + 40}, 90);
        }
    }

    void draw_ground_floor() {
        const bool shops = texture_.use == WallUse::kShop;
        const int door = random_.below(texture_.bays);
        const uint64_t bays = random_.next();
        WindowStyle style = style_;
        if (shops) style.frame = std::max(60, style.frame);
        const int plinth = random_.between(2, 5) * 100;
        canvas_.fill({0, 0, texture_.width_mm, plinth}, scaled(texture_.colour, 74));
        for (int bay = 0; bay < texture_.bays; ++bay) {
            const Rect at = cell(bay, 0);
            const Random random(hash(bays, bay));
            if (bay == door) {
                paint_door(canvas_, at.centred(shops ? 1300 : 1000, 0, std::min(2150, storey_ * 3 / 4)), style, random);
            } else if (shops) {
                paint_shop(canvas_, at, style, random);
            } else {
                paint_window(canvas_,
                             at.centred(style.width, std::min(900, storey_ - style.height - 300), style.height), style,
                             random);
            }
        }
        if (!shops) return;
        canvas_.fill({0, texture_.height_mm - 200, texture_.width_mm, texture_.height_mm}, style.trim);
        canvas_.darken({0, texture_.height_mm - 330, texture_.width_mm, texture_.height_mm - 200}, 80);
    }

    /// A bare wall has a rain pipe or the mark of one, now and then.
    void draw_pipes() {
        if (!random_.chance(35)) return;
        const int x = random_.below(texture_.width_mm);
        canvas_.darken({x + 90, 0, x + 170, texture_.height_mm}, 70);
        canvas_.fill({x, 0, x + 100, texture_.height_mm}, scaled(texture_.colour, random_.between(55, 85)));
    }

    const WallTexture& texture_;
    Random random_;
    const Family& family_;
    int bay_, storey_;
    Masonry masonry_;
    WindowStyle style_;
    PeriodicCanvas canvas_;
};

}  // namespace

WallTexture describe_wall(WallUse use, uint32_t number, uint64_t city_seed) {
    Random random(hash(city_seed, static_cast<int64_t>(use), number, 29));
    WallTexture texture;
    texture.use = use;
    texture.family = static_cast<uint8_t>(number % kWallFamilies);
    choose_size(texture, random);
    const Grid grid = choose_grid(use, random);
    texture.bays = static_cast<uint8_t>(grid.bays);
    texture.storeys = static_cast<uint8_t>(grid.storeys);
    texture.width_mm = grid.bays * grid.bay_mm;
    texture.height_mm = grid.storeys * grid.storey_mm;
    texture.colour = jittered(kFamilies[texture.family].colours[static_cast<size_t>(random.below(4))], 16, random);
    texture.seed = random.next();
    return texture;
}

Image draw_wall(const WallTexture& texture) {
    return Drawing(texture).draw();
}

}  // namespace citystream::tiles::city::procedural
