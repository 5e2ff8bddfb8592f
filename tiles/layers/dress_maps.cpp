#include "tiles/layers/dress_maps.h"

#include <algorithm>

#include "tiles/city/generator_random.h"
#include "tiles/city/grammar_elements.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::RunGrid;
using namespace city::procedural;

/// Texels along the border where nothing is deeper than the wall: more than half a texel of the coarser levels that
/// are seen from near (16 cm), which drop what is thinner and would leave a slit at the corners of houses.
constexpr uint32_t kClosedMargin = 9;
constexpr int kStackFloors = 8;  // storeys of the facade that bases and shafts are cut from

uint32_t label_of(int displacement_mm, Slot slot) {
    return codec::facade::make_label(displacement_mm, static_cast<uint32_t>(slot));
}

/// Rows from `bottom` to `top`, texels.
RunGrid cut_rows(const RunGrid& grid, uint32_t bottom, uint32_t top) {
    RunGrid cut;
    cut.x_breaks = grid.x_breaks;
    cut.y_breaks.push_back(0);
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        const uint32_t low = std::max(grid.y_breaks[row], bottom), high = std::min(grid.y_breaks[row + 1], top);
        if (low >= high) continue;
        cut.y_breaks.push_back(high - bottom);
        const auto first = grid.labels.begin() + static_cast<std::ptrdiff_t>(size_t{row} * grid.columns());
        cut.labels.insert(cut.labels.end(), first, first + grid.columns());
    }
    return codec::facade::merge_equal_runs(cut);
}

/// Plain wall and a coping on top.
RunGrid add_parapet(RunGrid grid, uint32_t height) {
    constexpr uint32_t kCoping = 10;
    const uint32_t foot = grid.height();
    const size_t columns = grid.columns();
    grid.y_breaks.insert(grid.y_breaks.end(), {foot + height - kCoping, foot + height});
    grid.labels.insert(grid.labels.end(), columns, label_of(0, Slot::kWall));
    grid.labels.insert(grid.labels.end(), columns, label_of(60, Slot::kCornice));
    return codec::facade::merge_equal_runs(grid);
}

/// Breaks of an axis with the margins' inner edges among them.
std::vector<uint32_t> with_margins(const std::vector<uint32_t>& breaks) {
    std::vector<uint32_t> out(breaks);
    out.insert(out.end(), {kClosedMargin, breaks.back() - kClosedMargin});
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

/// Where a grid is cut anew: the old cell of each new one, and the side it is a margin of.
struct MarginCell {
    uint32_t cell = 0, border = 0;  ///< old cells; `border` the outermost on the near side
    bool margin = false;
};
std::vector<MarginCell> margin_cells(const std::vector<uint32_t>& old_breaks, const std::vector<uint32_t>& breaks) {
    std::vector<MarginCell> cells;
    MarginCell at;
    const auto last = static_cast<uint32_t>(old_breaks.size() - 2);
    for (size_t i = 0; i + 1 < breaks.size(); ++i) {
        if (breaks[i] >= old_breaks[at.cell + 1]) ++at.cell;
        const bool low = breaks[i] < kClosedMargin;
        at.margin = low || breaks[i] + kClosedMargin >= breaks.back();
        at.border = low ? 0 : last;
        cells.push_back(at);
    }
    return cells;
}

/// What lies deeper than the wall within kClosedMargin of the border is covered by what is at the border.
RunGrid close_border(const RunGrid& grid) {
    RunGrid closed{with_margins(grid.x_breaks), with_margins(grid.y_breaks), {}};
    const auto columns = margin_cells(grid.x_breaks, closed.x_breaks);
    const auto rows = margin_cells(grid.y_breaks, closed.y_breaks);
    const auto deep = [](uint32_t label) { return codec::facade::displacement_of(label) < 0; };
    for (const MarginCell& row : rows) {
        for (const MarginCell& column : columns) {
            uint32_t label = grid.label(column.cell, row.cell);
            if (deep(label) && column.margin) label = grid.label(column.border, row.cell);
            if (deep(label) && row.margin) label = grid.label(column.margin ? column.border : column.cell, row.border);
            if (deep(label) && (column.margin || row.margin)) label = label_of(0, Slot::kFrame);
            closed.labels.push_back(label);
        }
    }
    return codec::facade::merge_equal_runs(closed);
}

RunGrid with_extra(RunGrid grid, int extra_cm) {
    if (extra_cm > 0) return add_parapet(std::move(grid), static_cast<uint32_t>(extra_cm));
    if (extra_cm < 0) return cut_rows(grid, 0, grid.height() - static_cast<uint32_t>(-extra_cm));
    return grid;
}

FacadeSpec grammar_spec(const DressMapSpec& spec) {
    FacadeSpec facade;
    facade.use = spec.use;
    facade.role = spec.role;
    facade.variant = spec.variant;
    facade.floors = spec.floors;
    facade.shop = spec.shop;
    facade.width_cm = static_cast<uint16_t>(spec.width_cm());
    return facade;
}

/// Office towers have sections of their own.
RunGrid derive_tower_piece(const DressMapSpec& spec, uint64_t seed) {
    FacadeSpec facade = grammar_spec(spec);
    constexpr int kLobbyFloors = 3;
    switch (spec.piece) {
        case FacadePiece::kGround:
            facade.section = spec.floors >= kLobbyFloors ? FacadeSection::kBase : FacadeSection::kWhole;
            break;
        case FacadePiece::kBase:
            facade.section = FacadeSection::kBase;
            break;
        case FacadePiece::kShaft:
            facade.section = FacadeSection::kShaft;
            break;
        case FacadePiece::kUpper:
            facade.section = FacadeSection::kTop;
            break;
    }
    if (facade.section != FacadeSection::kBase) facade.role = FacadeRole::kFront;
    return with_extra(derive_facade(facade, seed), spec.extra_cm);
}

/// Storeys cut from the facade of a higher house, so that no door and no cornice comes along where none belongs.
RunGrid derive_storeys(const DressMapSpec& spec, uint64_t seed) {
    const DressStoreys storeys = dress_storeys(spec.use, spec.variant);
    const auto ground = static_cast<uint32_t>(storeys.ground), floor = static_cast<uint32_t>(storeys.floor);
    FacadeSpec facade = grammar_spec(spec);
    switch (spec.piece) {
        case FacadePiece::kGround:
            return with_extra(derive_facade(facade, seed), spec.extra_cm);
        case FacadePiece::kUpper: {
            facade.floors = static_cast<uint8_t>(spec.floors + 2);
            const RunGrid whole = derive_facade(facade, seed);
            return with_extra(cut_rows(whole, ground + floor, whole.height()), spec.extra_cm);
        }
        case FacadePiece::kBase:
            facade.floors = kStackFloors;
            return cut_rows(derive_facade(facade, seed), 0, ground + 3 * floor);
        case FacadePiece::kShaft:
            facade.floors = kStackFloors;
            return cut_rows(derive_facade(facade, seed), ground + floor, ground + 5 * floor);
    }
    return {};
}

/// Windows of stairs and bathrooms in a plain side.
struct SideStyle {
    WindowStyle window;
    int bay = 0, share = 0;
};
SideStyle side_style(const DressMapSpec& spec, uint64_t seed) {
    Random random(hash(seed, static_cast<int64_t>(spec.use), spec.variant, 23));
    SideStyle style;
    style.window.width = 70 + 10 * random.below(4);
    style.window.height = 90 + 10 * random.below(4);
    style.window.mullions = random.below(2);
    style.window.reveal_mm = 110;
    style.bay = 260 + 20 * random.below(4);
    style.share = 55 + 5 * random.below(6);
    return style;
}

/// A side that few look at: plain wall, some small windows, a coping. Any height.
RunGrid derive_side(const DressMapSpec& spec, uint64_t seed) {
    const int width = spec.width_cm(), height = map_height_cm(spec);
    const DressStoreys storeys = dress_storeys(spec.use, spec.variant);
    const SideStyle style = side_style(spec, seed);
    Random detail(hash(seed, static_cast<int64_t>(spec.piece) * 64 + spec.floors, width * 4096 + spec.extra_cm,
                       static_cast<int64_t>(spec.use) * 16 + spec.variant));
    Canvas canvas(width, height);
    const bool ground = spec.piece == FacadePiece::kGround || spec.piece == FacadePiece::kBase;
    if (ground) canvas.fill({0, 0, width, 40}, 30, Slot::kPlinth);
    constexpr int kSill = 95, kAboveWindow = 30, kBesideWindow = 40, kBlindPercent = 30;
    const bool windows = spec.use != FacadeUse::kGarage;
    int foot = 0;
    for (int floor = 0; windows && floor < spec.floors; ++floor) {
        const Rect storey{0, foot, width, foot + (floor == 0 && ground ? storeys.ground : storeys.floor)};
        for (const Rect& bay : repeat_x(storey.inset(20, 0, 20, 0), style.bay)) {
            WindowStyle window = style.window;
            window.width = std::min(window.width, bay.width() - kBesideWindow);
            window.height = std::min(window.height, std::min(storey.y1, height) - storey.y0 - kSill - kAboveWindow);
            const bool drawn = detail.chance(style.share), blind = detail.chance(kBlindPercent);
            if (drawn && window.width >= 40 && window.height >= 50)
                draw_window(canvas, bay.centred(window.width, kSill, window.height), window, blind);
        }
        foot = storey.y1;
    }
    if (spec.piece == FacadePiece::kGround || spec.piece == FacadePiece::kUpper)
        canvas.fill({0, height - 12, width, height}, 60, Slot::kCornice);
    return canvas.relief();
}

uint64_t packed(const DressMapSpec& spec) {
    uint64_t key = static_cast<uint64_t>(spec.use);
    key = key << 2 | static_cast<uint64_t>(spec.role);
    key = key << 2 | static_cast<uint64_t>(spec.piece);
    key = key << 8 | spec.variant;
    key = key << 8 | spec.floors;
    key = key << 16 | static_cast<uint16_t>(spec.extra_cm);
    key = key << 8 | spec.width_class;
    return key << 1 | (spec.shop ? 1U : 0U);
}

}  // namespace

RunGrid derive_dress_map(const DressMapSpec& spec, uint64_t seed) {
    if (spec.use == FacadeUse::kTower) return close_border(derive_tower_piece(spec, seed));
    const bool plain =
        spec.role == FacadeRole::kSide || (spec.use == FacadeUse::kGarage && spec.role != FacadeRole::kFront);
    return close_border(plain && spec.use != FacadeUse::kHall ? derive_side(spec, seed) : derive_storeys(spec, seed));
}

const MaterialSet& DressMaps::materials() {
    if (!materials_) materials_ = make_materials(catalog_, seed_);
    return *materials_;
}

uint32_t DressMaps::map_of(const DressMapSpec& spec) {
    const auto [entry, is_new] = maps_.try_emplace(packed(spec), 0);
    if (is_new) entry->second = catalog_.facade_maps.add(derive_dress_map(spec, seed_));
    return entry->second;
}

uint32_t DressMaps::palette_of(const BuildingStyle& style) {
    const MaterialSet& set = materials();
    const std::vector<uint32_t>& palettes = style.use == FacadeUse::kApartment ? set.apartment_palettes
                                            : style.use == FacadeUse::kTower   ? set.tower_palettes
                                            : style.use == FacadeUse::kHall    ? set.hall_palettes
                                                                               : set.house_palettes;
    return palettes[style.palette_draw % palettes.size()];
}

uint32_t DressMaps::wall_material(uint32_t palette) {
    const auto [entry, is_new] = wall_materials_.try_emplace(palette, 0);
    if (is_new) {
        const uint32_t wall = catalog_.palettes[palette].material[static_cast<size_t>(Slot::kWall)];
        entry->second = catalog_.add_material(city::Material{.rgb = catalog_.materials[wall].rgb});
    }
    return entry->second;
}

}  // namespace citystream::tiles::layers
