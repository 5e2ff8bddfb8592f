// A house with a facade in a made-up tile with a baked radiance layer.
#pragma once

#include "tests/client/render/facade_scene.h"
#include "tests/client/render/lit_scene.h"

namespace citystream::client::test {

/// A house of 6 x 6 x 4 m, whose wall at y = 0 is a facade, on ground with a tower beside it.
struct House {
    LitTile tile;
    FacadeScene scene;
};

inline House make_house(LayerStore& store, const codec::facade::RunGrid& grid = window_facade(),
                        const std::vector<codec::atlas::ChartImage>& charts = test_charts()) {
    namespace box = tiles::radiance::test;
    static const LitTile kTile = [] {
        Surface surface = box::ground(-16, -16, 16, 16);
        box::add(surface, box::tower(3, 3, 6, 4));
        box::add(surface, box::tower(-5, -3, 4, 9));
        return lit_tile(surface, {}, {0, 0, 0});
    }();
    House house;
    house.tile = kTile;
    const Wall wall;
    house.scene = facade_scene(store, FacadeRenderer::kPatch, grid, std::span(&wall, 1), charts);
    // The wall's triangles come last: they stand in for it.
    Surface ordered;
    for (const bool dressed : {false, true}) {
        for (const auto& triangle : kTile.surface) {
            const bool is_wall = box::unit_normal(triangle)[1] < -0.9 && triangle.corners[0].y == 0;
            if (is_wall == dressed) ordered.push_back(triangle);
        }
    }
    codec::mesh::MeshTile mesh = mesh_of(ordered, kTile.origin);
    mesh.dressed_begin -= 2;
    const TileDraw drawn = upload_tile(store, mesh, {});
    house.scene.tile.mesh = drawn.mesh;
    house.scene.tile.mesh_steps = drawn.mesh_steps;
    house.scene.tile.mesh_ranges = drawn.mesh_ranges;
    house.scene.tile.radiance = upload(store, kTile.words);
    return house;
}

/// The house's tile lit by the same receivers, counted from another tile's origin.
inline TileDraw inheriting_tile(LayerStore& store, const House& house) {
    const int32_t spacing = 1 << kLitSpacingLog2;
    const LitTile ancestor = lit_tile(house.tile.surface, {}, {-5 * spacing, -7 * spacing, -2 * spacing});
    TileDraw tile = house.scene.tile;
    tile.radiance = upload(store, ancestor.words);
    tile.radiance_offset = {5 * spacing, 7 * spacing, 2 * spacing};
    return tile;
}

}  // namespace citystream::client::test
