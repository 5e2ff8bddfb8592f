// A tile whose atlas is in pages: what the tests of pages and of their transports draw.
#pragma once

#include <vector>

#include "codec/atlas/page_layer.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {

/// Pages of at most 64 texels a side, so that a few charts take several.
inline codec::atlas::PageOptions small_pages() {
    codec::atlas::PageOptions options;
    options.max_page_side = 64;
    return options;
}

/// As upload_tile, in pages, with the first `steps` of the atlas.
inline TileDraw upload_page_tile(LayerStore& store, const codec::mesh::MeshTile& mesh,
                                 std::span<const codec::atlas::ChartImage> charts,
                                 const codec::atlas::PageOptions& options = {}, size_t steps = 99) {
    TileDraw tile = upload_tile(store, mesh, {});
    const auto pages = codec::atlas::encode_pages(charts, options);
    if (!pages) {
        ADD_FAILURE() << pages.error().text();
        return tile;
    }
    steps = std::min(steps, pages->size());
    tile.atlas = upload(store, joined(*pages, steps));
    tile.atlas_form = codec::atlas::AtlasForm::kPages;
    tile.atlas_finest_mip = static_cast<uint32_t>(pages->size() - steps);
    return tile;
}

/// Charts that repeat both ways, one way and not at all, and flat ones.
inline std::vector<codec::atlas::ChartImage> mixed_charts() {
    std::vector<codec::atlas::ChartImage> charts = {test_chart(40, 24), test_chart(24, 24, false), test_chart(1, 1),
                                                    test_chart(16, 40), test_chart(12, 12, false)};
    charts[3].repeat_v = false;
    charts[2].rgb = {200, 40, 90};
    return charts;
}

/// Boxes in a grid whose sides show all of mixed_charts(), at places that are multiples of 1/512 repeat, some of them
/// several repeats from 0 where the chart repeats.
inline codec::mesh::MeshTile mixed_boxes(int count) {
    const std::vector<codec::atlas::ChartImage> charts = mixed_charts();
    Random random;
    codec::mesh::MeshTile all;
    for (int i = 0; i < count; ++i) {
        const int32_t x = i % 6 * 5, y = i / 6 * 5;
        codec::mesh::MeshTile box = cube_tile({x, y, 0}, {x + 3, y + 3, 2 + i % 5}, 1);
        for (size_t side = 0; side < 6; ++side) {
            const uint32_t chart = random.below(static_cast<uint32_t>(charts.size()));
            const int32_t along = charts[chart].repeat_u ? random.between(200, 2000) : 512;
            const int32_t up = charts[chart].repeat_v ? random.between(200, 2000) : 512;
            const int32_t from = charts[chart].repeat_u ? 512 * random.between(-3, 3) + random.between(0, 511) : 0;
            for (size_t corner = 4 * side; corner < 4 * side + 4; ++corner) {
                auto& texcoord = box.vertices[corner].texcoord;
                texcoord[0] = (from + (texcoord[0] != 0 ? along : 0)) * 128;
                texcoord[1] = (texcoord[1] != 0 ? up : 0) * 128;
            }
            box.triangle_chart[2 * side] = box.triangle_chart[2 * side + 1] = chart;
        }
        const auto first = static_cast<uint32_t>(all.vertices.size());
        all.vertices.insert(all.vertices.end(), box.vertices.begin(), box.vertices.end());
        for (const uint32_t corner : box.indices) all.indices.push_back(first + corner);
        all.triangle_chart.insert(all.triangle_chart.end(), box.triangle_chart.begin(), box.triangle_chart.end());
    }
    all.dressed_begin = static_cast<uint32_t>(all.triangle_chart.size());
    return all;
}

}  // namespace citystream::client::test
