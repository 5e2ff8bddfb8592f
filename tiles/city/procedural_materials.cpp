#include "tiles/city/procedural_materials.h"

#include <memory>
#include <utility>

#include "tiles/city/generator_random.h"
#include "tiles/city/grammar.h"
#include "tiles/city/procedural_texture.h"

namespace citystream::tiles::city::procedural {
namespace {

/// Adds materials to a catalog, one image each.
class Painter {
  public:
    Painter(CityCatalog& catalog, uint64_t seed) : catalog_(catalog), seed_(seed) {}

    uint32_t flat(Rgb rgb) {
        Material material;
        material.rgb = rgb;
        material.metres_per_repeat = 1;
        return catalog_.add_material(material);
    }
    uint32_t textured(Image image, float metres) {
        Material material;
        material.rgb = mean(image);
        material.image = static_cast<int32_t>(catalog_.images.size());
        material.metres_per_repeat = metres;
        catalog_.images.push_back({{}, std::make_shared<const Image>(std::move(image))});
        return catalog_.add_material(material);
    }
    uint32_t plaster(Rgb rgb) { return textured(plaster_texture(rgb, 12, next_seed()), 4); }
    uint32_t brick(Rgb rgb, Rgb joint) { return textured(brick_texture(rgb, joint, 8, 32, next_seed()), 2); }
    uint32_t concrete(Rgb rgb) { return textured(slab_texture(rgb, darker(rgb), 2, 2, false, next_seed()), 4); }
    uint32_t stone(Rgb rgb) { return textured(slab_texture(rgb, darker(rgb), 4, 8, true, next_seed()), 3); }
    uint32_t cladding(Rgb rgb) { return textured(sheet_texture(rgb, 16, next_seed()), 4); }
    uint64_t next_seed() { return hash(seed_, ++drawn_); }

  private:
    static Rgb darker(Rgb rgb) {
        for (uint8_t& channel : rgb) channel = static_cast<uint8_t>(channel * 4 / 5);
        return rgb;
    }
    static Rgb mean(const Image& image) {
        std::array<uint64_t, 3> sum{};
        for (size_t i = 0; i < image.rgb.size(); ++i) sum[i % 3] += image.rgb[i];
        const uint64_t texels = image.rgb.size() / 3;
        return {static_cast<uint8_t>(sum[0] / texels), static_cast<uint8_t>(sum[1] / texels),
                static_cast<uint8_t>(sum[2] / texels)};
    }

    CityCatalog& catalog_;
    uint64_t seed_;
    int64_t drawn_ = 0;
};

/// The colours that most palettes share.
struct Trim {
    uint32_t glass, blind, white, dark, metal, stone, wood;
};

FacadePalette palette_of(const Trim& trim, uint32_t wall, uint32_t plinth, uint32_t frame, uint32_t door,
                         uint32_t accent) {
    FacadePalette palette;
    const auto set = [&palette](Slot slot, uint32_t material) {
        palette.material[static_cast<size_t>(slot)] = material;
    };
    set(Slot::kWall, wall);
    set(Slot::kPlinth, plinth);
    set(Slot::kFrame, frame);
    set(Slot::kGlass, trim.glass);
    set(Slot::kDoor, door);
    set(Slot::kSill, trim.stone);
    set(Slot::kBalcony, trim.stone);
    set(Slot::kRailing, trim.dark);
    set(Slot::kCornice, trim.white);
    set(Slot::kShopfront, trim.dark);
    set(Slot::kQuoin, trim.stone);
    set(Slot::kShutter, door);
    set(Slot::kSign, door);
    set(Slot::kAccent, accent);
    set(Slot::kMetal, trim.metal);
    set(Slot::kBlind, trim.blind);
    return palette;
}

struct Walls {
    std::vector<uint32_t> plasters, bricks, stones, concretes, claddings;
};

Walls make_walls(Painter& painter) {
    Walls walls;
    for (Rgb rgb : {Rgb{236, 230, 216}, Rgb{229, 205, 158}, Rgb{214, 160, 128}, Rgb{196, 208, 190}, Rgb{190, 203, 214},
                    Rgb{222, 186, 150}, Rgb{200, 196, 188}})
        walls.plasters.push_back(painter.plaster(rgb));
    walls.bricks = {painter.brick({150, 72, 54}, {176, 164, 150}), painter.brick({196, 160, 108}, {190, 180, 164}),
                    painter.brick({104, 70, 60}, {140, 132, 124})};
    walls.stones = {painter.stone({202, 190, 168}), painter.stone({150, 146, 140})};
    walls.concretes = {painter.concrete({178, 176, 172}), painter.concrete({206, 202, 194})};
    walls.claddings = {painter.cladding({188, 194, 198}), painter.cladding({96, 122, 146}),
                       painter.cladding({206, 198, 176})};
    return walls;
}

void add_palettes(CityCatalog& catalog, Painter& painter, const Walls& walls, MaterialSet& set) {
    const Trim trim{painter.flat({58, 74, 88}), painter.flat({176, 168, 150}), painter.flat({232, 228, 220}),
                    painter.flat({52, 54, 58}), painter.flat({128, 132, 136}), painter.flat({196, 190, 178}),
                    painter.flat({108, 70, 42})};
    const std::array<uint32_t, 6> doors = {painter.flat({92, 48, 32}),  painter.flat({42, 74, 58}),
                                           painter.flat({122, 34, 34}), painter.flat({44, 58, 92}),
                                           painter.flat({70, 70, 74}),  painter.flat({168, 120, 62})};
    const std::array<uint32_t, 3> beams = {trim.wood, painter.flat({66, 48, 38}), painter.flat({134, 60, 46})};
    const auto add = [&catalog](std::vector<uint32_t>& list, const FacadePalette& palette) {
        list.push_back(static_cast<uint32_t>(catalog.palettes.size()));
        catalog.palettes.push_back(palette);
    };
    std::vector<uint32_t> dressed = walls.plasters;
    dressed.insert(dressed.end(), walls.bricks.begin(), walls.bricks.end());
    for (size_t i = 0; i < dressed.size(); ++i) {
        const uint32_t plinth = walls.stones[i % 2];
        add(set.house_palettes, palette_of(trim, dressed[i], plinth, i % 4 == 3 ? trim.wood : trim.white,
                                           doors[i % doors.size()], beams[i % 3]));
        add(set.apartment_palettes, palette_of(trim, dressed[i], plinth, i % 3 == 2 ? trim.dark : trim.white,
                                               doors[(i + 2) % doors.size()], dressed[(i + 3) % dressed.size()]));
    }
    add(set.apartment_palettes, palette_of(trim, walls.stones[0], walls.stones[1], trim.white, doors[1], dressed[0]));
    add(set.apartment_palettes,
        palette_of(trim, walls.stones[1], walls.stones[1], trim.white, doors[3], walls.stones[0]));
    const std::array<uint32_t, 3> spandrels = {painter.flat({74, 92, 108}), painter.flat({112, 104, 92}),
                                               painter.flat({150, 160, 164})};
    for (size_t i = 0; i < 8; ++i) {
        const uint32_t wall = i % 4 < 2 ? walls.concretes[i % 2] : i % 4 == 2 ? walls.stones[0] : walls.bricks[i / 4];
        add(set.tower_palettes, palette_of(trim, wall, walls.stones[i / 2 % 2], i % 2 == 0 ? trim.metal : trim.dark,
                                           doors[i % doors.size()], spandrels[i % 3]));
    }
    for (size_t i = 0; i < 6; ++i) {
        const uint32_t wall = i < 3 ? walls.claddings[i] : i == 3 ? walls.bricks[0] : walls.concretes[i % 2];
        add(set.hall_palettes,
            palette_of(trim, wall, walls.concretes[0], trim.dark, doors[(i + 3) % doors.size()], spandrels[i % 3]));
    }
}

}  // namespace

MaterialSet make_materials(CityCatalog& catalog, uint64_t seed) {
    Painter painter(catalog, seed);
    MaterialSet set;
    const Walls walls = make_walls(painter);
    add_palettes(catalog, painter, walls, set);
    for (Rgb rgb : {Rgb{158, 82, 58}, Rgb{120, 66, 52}, Rgb{92, 96, 104}, Rgb{176, 104, 70}})
        set.pitched_roofs.push_back(painter.textured(tile_texture(rgb, 8, 8, painter.next_seed()), 2.5F));
    set.flat_roof = painter.textured(ground_texture({128, 126, 122}, 18, 12, painter.next_seed()), 4);
    set.metal_roof = painter.textured(sheet_texture({150, 156, 160}, 8, painter.next_seed()), 4);
    set.coping = painter.flat({150, 150, 148});
    set.soffit = painter.flat({206, 198, 184});
    set.chimney = walls.bricks[0];
    set.machinery = walls.claddings[0];
    set.road = painter.textured(road_texture(2, painter.next_seed()), 7);
    set.main_road = painter.textured(road_texture(4, painter.next_seed()), 15);
    set.asphalt = painter.textured(ground_texture({92, 92, 95}, 14, 10, painter.next_seed()), 4);
    set.crossing = painter.textured(crossing_texture(painter.next_seed()), 8);
    set.pavement = painter.textured(slab_texture({168, 164, 156}, {142, 138, 130}, 8, 8, true, painter.next_seed()), 4);
    set.plaza = painter.textured(slab_texture({188, 176, 158}, {160, 150, 136}, 4, 4, false, painter.next_seed()), 4);
    set.lawn = painter.textured(ground_texture({104, 132, 70}, 34, 20, painter.next_seed()), 5);
    set.meadow = painter.textured(ground_texture({132, 142, 84}, 30, 34, painter.next_seed()), 6);
    set.yard = painter.textured(slab_texture({150, 148, 144}, {136, 134, 130}, 2, 2, false, painter.next_seed()), 8);
    set.bark = painter.flat({86, 66, 50});
    set.foliage = {painter.flat({72, 104, 50}), painter.flat({92, 120, 56}), painter.flat({58, 88, 54})};
    return set;
}

}  // namespace citystream::tiles::city::procedural
