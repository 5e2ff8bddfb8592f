// Frames of the same tiles with each topology of their meshes, strip code decoded into memories of several sizes.
//
// Flat colours are the same bytes. Topologies begin triangles with other corners, and rasterizers add up what they
// interpolate from the first: now and then a filtered texel is rounded to the next number.
#include <algorithm>

#include "tests/client/render/lit_scene.h"
#include "tests/client/render/page_scene.h"

namespace citystream::client::test {
namespace {

using codec::mesh::MeshTopology;

const Camera kCamera = make_camera({20, -30, 40}, 20, -30);

/// Hills whose triangles show a few charts, repeated.
codec::mesh::MeshTile hills(uint32_t side, uint32_t charts, uint64_t seed) {
    Random random{seed};
    codec::mesh::MeshTile tile;
    std::vector<int32_t> heights;
    for (uint32_t i = 0; i < (side + 1) * (side + 1); ++i) heights.push_back(random.between(0, 3 << 10));
    for (uint32_t y = 0; y < side; ++y) {
        for (uint32_t x = 0; x < side; ++x) {
            std::array<std::array<int32_t, 3>, 4> corners{};
            constexpr std::array<std::array<uint32_t, 2>, 4> kSteps = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
            for (size_t i = 0; i < 4; ++i) {
                const uint32_t cx = x + kSteps[i][0], cy = y + kSteps[i][1];
                corners[i] = {static_cast<int32_t>(cx << 11), static_cast<int32_t>(cy << 11),
                              heights[cy * (side + 1) + cx]};
            }
            add_quad(tile, corners, {0, 0, 1}, (x / 5 + y / 3) % charts);
        }
    }
    return tile;
}

std::vector<codec::mesh::MeshTile> landscape(uint32_t charts) {
    std::vector<codec::mesh::MeshTile> tiles;
    for (uint64_t i = 0; i < 16; ++i) tiles.push_back(hills(8, charts, i + 1));
    return tiles;
}

std::array<double, 3> origin_of(size_t tile) {
    return {16.0 * static_cast<double>(tile % 4), 16.0 * static_cast<double>(tile / 4), 0};
}

codec::mesh::MeshLayer layer_of(const codec::mesh::MeshTile& mesh, MeshTopology topology) {
    codec::mesh::MeshLayerOptions options;
    options.content.topology = topology;
    return codec::mesh::test::layer_of(mesh, options);
}

/// Corners of all ranges of strip code, as the arena holds them.
uint64_t corner_bytes(std::span<const TileDraw> tiles) {
    uint64_t bytes = 0;
    for (const TileDraw& tile : tiles) {
        for (const codec::mesh::MeshRange& range : tile.mesh_ranges)
            bytes += range.kind == RESIDENT_KIND_STRIP_CODE ? uint64_t{12} * range.triangles : 0;
    }
    return bytes;
}

enum class Atlas { kNone, kCharts, kPages };

/// Boxes and hills, with a topology.
std::vector<TileDraw> upload_topology(LayerStore& store, MeshTopology topology, Atlas atlas) {
    std::vector<TileDraw> tiles;
    const std::vector<codec::atlas::ChartImage> charts = mixed_charts();
    std::vector<codec::mesh::MeshTile> meshes = landscape(static_cast<uint32_t>(charts.size()));
    for (size_t i = 0; i < meshes.size(); ++i) {
        const codec::mesh::MeshTile& mesh = i % 4 == 3 ? mixed_boxes(9) : meshes[i];
        TileDraw tile = atlas == Atlas::kPages    ? upload_page_tile(store, mesh, charts, small_pages())
                        : atlas == Atlas::kCharts ? upload_tile(store, mesh, charts)
                                                  : upload_tile(store, mesh, {});
        tile.origin = origin_of(i);
        store.destroy(tile.mesh);
        const codec::mesh::MeshLayer layer = layer_of(mesh, topology);
        tile.mesh = upload(store, layer.words());
        tile.mesh_ranges = layer.resident.ranges;
        tiles.push_back(tile);
    }
    return tiles;
}

/// A frame of each topology, in the order of MeshTopology.
std::vector<FrameImage> frames_of_topologies(Atlas atlas) {
    std::vector<FrameImage> frames;
    for (const MeshTopology topology : {MeshTopology::kIndices, MeshTopology::kLocalStrips, MeshTopology::kStripCode}) {
        const auto renderer = make_renderer();
        if (renderer == nullptr) return frames;
        const std::vector<TileDraw> tiles = upload_topology(*renderer, topology, atlas);
        const bool is_strip_code = topology == MeshTopology::kStripCode;
        EXPECT_EQ(corner_bytes(tiles) > 0, is_strip_code);
        const uint64_t before = renderer->frame_buffer_bytes();
        frames.push_back(draw_or_fail(*renderer, kCamera, tiles));
        EXPECT_EQ(renderer->counts().strip_rounds, is_strip_code ? 1u : 0u);
        EXPECT_EQ(12 * renderer->counts().decoded_strip_triangles, corner_bytes(tiles));
        EXPECT_GE(renderer->frame_buffer_bytes(), before + corner_bytes(tiles));
        EXPECT_EQ(draw_or_fail(*renderer, kCamera, tiles).rgba, frames.back().rgba);
        EXPECT_EQ(renderer->counts().decoded_strip_triangles, 0u) << "it is still there";
        EXPECT_EQ(renderer->validation_messages(), 0u);
    }
    EXPECT_NE(pixel(frames[0], 160, 150), pixel(frames[0], 2, 2)) << "a hill is seen";
    return frames;
}

TEST(MeshTopologies, FramesOfFlatColoursAreTheSameBytes) {
    const std::vector<FrameImage> frames = frames_of_topologies(Atlas::kNone);
    ASSERT_EQ(frames.size(), 3u);
    EXPECT_EQ(frames[1].rgba, frames[0].rgba) << "local strips";
    EXPECT_EQ(frames[2].rgba, frames[0].rgba) << "strip code";
}

TEST(MeshTopologies, FramesOfTexturesAreTheSameBytesUpToTheRoundingOfInterpolation) {
    for (const Atlas atlas : {Atlas::kCharts, Atlas::kPages}) {
        const std::vector<FrameImage> frames = frames_of_topologies(atlas);
        ASSERT_EQ(frames.size(), 3u);
        for (const FrameImage* strips : {&frames[1], &frames[2]}) {
            uint64_t differing = 0;
            for (size_t i = 0; i < frames[0].rgba.size(); ++i) {
                const int difference = frames[0].rgba[i] - strips->rgba[i];
                ASSERT_LE(std::abs(difference), 1) << i;
                differing += difference != 0 ? 1 : 0;
            }
            EXPECT_LE(differing, frames[0].rgba.size() / 50000);
        }
    }
}

TEST(MeshTopologies, StripCodeOfTenTimesItsMemoryIsDrawnInRounds) {
    for (const Atlas atlas : {Atlas::kCharts, Atlas::kPages}) {
        RendererOptions options = small_options();
        const auto whole = make_renderer(options);
        ASSERT_NE(whole, nullptr);
        const std::vector<TileDraw> at_once = upload_topology(*whole, MeshTopology::kStripCode, atlas);
        const FrameImage wanted = draw_or_fail(*whole, kCamera, at_once);
        options.index_arena_bytes = corner_bytes(at_once) / 10 / 3 * 4;  // three quarters of it are corners
        options.chart_transport = atlas == Atlas::kPages ? ChartTransport::kUniform : ChartTransport::kTable;
        const auto renderer = make_renderer(options);
        ASSERT_NE(renderer, nullptr);
        const std::vector<TileDraw> tiles = upload_topology(*renderer, MeshTopology::kStripCode, atlas);
        for (int frame = 0; frame < 3; ++frame) {
            ASSERT_EQ(draw_or_fail(*renderer, kCamera, tiles).rgba, wanted.rgba) << frame;
            EXPECT_GE(renderer->counts().strip_rounds, 10u);
            EXPECT_GE(12 * renderer->counts().decoded_strip_triangles, corner_bytes(tiles) / 10 * 9);
        }
        EXPECT_EQ(renderer->validation_messages(), 0u);
    }
}

TEST(MeshTopologies, StripCodeInRoundsIsInTheSameShades) {
    FrameLight light = uniform_light({0.3F, 0.3F, 0.4F});
    light.sun = Sun{{-0.48, -0.6, 0.64}, {2, 2, 1.8}, kSunRadius};
    RendererOptions options = small_options();
    const auto whole = make_renderer(options);
    ASSERT_NE(whole, nullptr);
    const std::vector<TileDraw> at_once = upload_topology(*whole, MeshTopology::kStripCode, Atlas::kNone);
    ASSERT_TRUE(whole->set_light(&light).ok());
    const FrameImage wanted = draw_or_fail(*whole, kCamera, at_once);
    options.index_arena_bytes = corner_bytes(at_once) / 10 / 3 * 4;
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    const std::vector<TileDraw> tiles = upload_topology(*renderer, MeshTopology::kStripCode, Atlas::kNone);
    ASSERT_TRUE(renderer->set_light(&light).ok());
    for (int frame = 0; frame < 2; ++frame) {
        ASSERT_EQ(draw_or_fail(*renderer, kCamera, tiles).rgba, wanted.rgba) << frame;
        EXPECT_GE(renderer->counts().strip_rounds, 10u);
    }
    light.sun->irradiance = {0, 0, 0};
    ASSERT_TRUE(renderer->set_light(&light).ok());
    EXPECT_NE(draw_or_fail(*renderer, kCamera, tiles).rgba, wanted.rgba) << "the sun is seen";
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(MeshTopologies, ALayerThatTakesTheNumberOfAnotherShowsItsOwnStrips) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const std::vector<codec::mesh::MeshTile> meshes = landscape(1);
    const auto draw_one = [&](const codec::mesh::MeshTile& mesh, MeshTopology topology) {
        const codec::mesh::MeshLayer layer = layer_of(mesh, topology);
        TileDraw tile;
        tile.mesh = upload(*renderer, layer.words());
        tile.mesh_steps = layer.steps;
        tile.mesh_ranges = layer.resident.ranges;
        FrameImage frame = draw_or_fail(*renderer, make_camera({8, -12, 14}, 0, -35), std::span(&tile, 1));
        renderer->destroy(tile.mesh);
        return frame.rgba;
    };
    for (const size_t i : {0u, 1u, 2u})
        EXPECT_EQ(draw_one(meshes[i], MeshTopology::kStripCode), draw_one(meshes[i], MeshTopology::kIndices));
    EXPECT_NE(draw_one(meshes[0], MeshTopology::kStripCode), draw_one(meshes[1], MeshTopology::kStripCode));
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(MeshTopologies, AFrameThatCannotBeDrawnIsAnErrorAndHarmsNoOther) {
    RendererOptions options = small_options();
    options.index_arena_bytes = 256;
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    std::vector<TileDraw> tiles = upload_topology(*renderer, MeshTopology::kStripCode, Atlas::kNone);
    EXPECT_FALSE(renderer->draw(kCamera, tiles, nullptr).ok()) << "no range fits";
    tiles = upload_topology(*renderer, MeshTopology::kIndices, Atlas::kNone);
    const FrameImage indices = draw_or_fail(*renderer, kCamera, tiles);
    tiles[0].mesh_ranges[0].kind = RESIDENT_KIND_STRIP_CODE;
    EXPECT_FALSE(renderer->draw(kCamera, tiles, nullptr).ok()) << "a stream that is not there";
    tiles[0].mesh_ranges[0].kind = RESIDENT_KIND_INDICES;
    EXPECT_EQ(draw_or_fail(*renderer, kCamera, tiles).rgba, indices.rgba);
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

}  // namespace
}  // namespace citystream::client::test
