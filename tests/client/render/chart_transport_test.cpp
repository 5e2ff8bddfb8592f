// Table 1 of the paper: frames are the same by whatever transport the coordinates of charts come.
#include "client/render/chart_transport.h"

#include "client/render/chart_coordinates.h"
#include "codec/atlas/wrap_coordinate_layout.h"
#include "tests/client/render/page_scene.h"
#include "tests/client/render/pictures.h"

namespace citystream::client::test {
namespace {

const Camera kCamera = make_camera({-6, -14, 9}, 25, -12);

struct Shown {
    FrameImage image;
    FrameCounts counts;
};

Shown draw_with(ChartTransport transport, const codec::mesh::MeshTile& mesh) {
    RendererOptions options = small_options();
    options.chart_transport = transport;
    const auto renderer = make_renderer(options);
    if (renderer == nullptr) return {};
    const TileDraw tile = upload_page_tile(*renderer, mesh, mixed_charts(), small_pages());
    Shown shown{draw_or_fail(*renderer, kCamera, std::span(&tile, 1)), renderer->counts()};
    EXPECT_EQ(renderer->validation_messages(), 0u);
    EXPECT_EQ(draw_or_fail(*renderer, kCamera, std::span(&tile, 1)).rgba, shown.image.rgba) << "a second frame";
    renderer->destroy(tile.mesh);
    draw_or_fail(*renderer, kCamera, {});
    EXPECT_EQ(renderer->counts().coordinate_bytes, 0u) << "given back with the mesh";
    return shown;
}

TEST(ChartTransport, FramesOfAllFourAreTheSameBytes) {
    const codec::mesh::MeshTile mesh = mixed_boxes(30);
    const auto pages = codec::atlas::encode_pages(mixed_charts(), small_pages());
    ASSERT_TRUE(pages.ok());
    ASSERT_GT((*pages)[0].words[PAGES_WORD_PAGE_COUNT], 1u);
    const Shown table = draw_with(ChartTransport::kTable, mesh);
    keep(table.image, "transport_table");
    EXPECT_NE(pixel(table.image, 160, 150), pixel(table.image, 2, 2)) << "a box is seen";
    EXPECT_EQ(table.counts.page_tiles, 1u);
    EXPECT_EQ(table.counts.coordinate_bytes, 0u);
    for (const ChartTransport transport :
         {ChartTransport::kUniform, ChartTransport::kAttribute, ChartTransport::kPacked}) {
        const Shown shown = draw_with(transport, mesh);
        EXPECT_EQ(shown.image.rgba, table.image.rgba) << chart_transport_name(transport);
        EXPECT_EQ(shown.counts.fallback_tiles, 0u) << chart_transport_name(transport);
    }
}

TEST(ChartTransport, EachTakesWhatTableOneSays) {
    const codec::mesh::MeshTile mesh = mixed_boxes(30);
    const uint64_t triangles = mesh.triangle_chart.size();
    const auto in_slots = [](uint64_t bytes) { return (bytes + kSlotBytes - 1) / kSlotBytes * kSlotBytes; };
    const FrameCounts uniform = draw_with(ChartTransport::kUniform, mesh).counts;
    const std::vector<uint32_t> words = codec::mesh::test::layer_of(mesh).words();
    const auto view = codec::mesh::ResidentMeshView::create(words, 5);
    ASSERT_TRUE(view.ok());
    ASSERT_EQ(view->triangle_count(), triangles);
    uint32_t runs = 0, triangle = 0;
    for (const codec::mesh::MeshRange& range : view->ranges()) {
        for (uint32_t i = 0; i < range.triangles; ++i, ++triangle)
            runs += i == 0 || view->chart_word(triangle) != view->chart_word(triangle - 1) ? 1 : 0;
    }
    EXPECT_EQ(uniform.mesh_draws, runs);
    EXPECT_EQ(uniform.coordinate_bytes, 0u);
    const FrameCounts attribute = draw_with(ChartTransport::kAttribute, mesh).counts;
    EXPECT_LT(attribute.mesh_draws, 3u);
    EXPECT_EQ(attribute.coordinate_bytes, in_slots(3 * 16 * triangles));
    const FrameCounts packed = draw_with(ChartTransport::kPacked, mesh).counts;
    EXPECT_LT(packed.mesh_draws, 3u);
    EXPECT_EQ(packed.coordinate_bytes, in_slots(4 * COORDINATE_TRIANGLE_WORDS * triangles));
}

TEST(ChartTransport, ATileWithAPlaceThatCannotBePackedTakesAttributes) {
    const auto expect_fallback = [](const codec::mesh::MeshTile& mesh, const std::string& what) {
        const Shown table = draw_with(ChartTransport::kTable, mesh);
        const Shown packed = draw_with(ChartTransport::kPacked, mesh);
        EXPECT_EQ(packed.counts.fallback_tiles, 1u) << what;
        EXPECT_EQ(packed.counts.coordinate_bytes, draw_with(ChartTransport::kAttribute, mesh).counts.coordinate_bytes);
        EXPECT_EQ(packed.image.rgba, table.image.rgba) << what;
    };
    codec::mesh::MeshTile off_grid = mixed_boxes(30);
    for (codec::mesh::MeshVertex& vertex : off_grid.vertices) vertex.texcoord[0] += vertex.texcoord[0] / 3;
    expect_fallback(off_grid, "not a multiple of 1/512");
    codec::mesh::MeshTile far = mixed_boxes(30);
    for (size_t i = 0; i < far.vertices.size(); ++i) {
        if (far.vertices[i].texcoord[1] != 0) far.vertices[i].texcoord[1] = 65 << 16;
    }
    expect_fallback(far, "65 repeats");
    codec::mesh::MeshTile below = mixed_boxes(30);
    for (codec::mesh::MeshVertex& vertex : below.vertices) vertex.texcoord[1] -= 1 << 15;
    expect_fallback(below, "below a chart that is clamped");
}

TEST(ChartTransport, CoordinatesTakeWhatLayersLeaveOfTheBudgetAndGiveItBack) {
    const codec::mesh::MeshTile mesh = mixed_boxes(30);
    const FrameImage wanted = draw_with(ChartTransport::kTable, mesh).image;
    RendererOptions options = small_options();
    options.chart_transport = ChartTransport::kPacked;
    options.gpu_budget_bytes = 1 << 20;
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    const TileDraw tile = upload_page_tile(*renderer, mesh, mixed_charts(), small_pages());
    const auto fill = [&](uint64_t slots) {
        const LayerId layer = renderer->create();
        const std::vector<uint32_t> words(slots * kSlotBytes / 4);
        EXPECT_TRUE(renderer->append(layer, words).ok()) << slots;
        return layer;
    };
    const auto fallback_tiles = [&] {
        EXPECT_EQ(draw_or_fail(*renderer, kCamera, std::span(&tile, 1)).rgba, wanted.rgba);
        EXPECT_LE(renderer->slots_used(), renderer->slot_count());
        return renderer->counts().fallback_tiles;
    };
    const LayerId first = fill(renderer->slot_count() - renderer->slots_used() - 4);
    EXPECT_EQ(fallback_tiles(), 1u) << "four slots do not hold them";
    renderer->destroy(first);
    const uint64_t of_layers = renderer->slots_used();
    EXPECT_EQ(fallback_tiles(), 0u);
    EXPECT_EQ(renderer->slots_used() * kSlotBytes, of_layers * kSlotBytes + renderer->counts().coordinate_bytes);
    const LayerId second = fill(renderer->slot_count() - of_layers);
    EXPECT_EQ(fallback_tiles(), 1u) << "layers come first";
    renderer->destroy(second);
    EXPECT_EQ(fallback_tiles(), 0u);
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(ChartTransport, TilesInChartsFormTakeNone) {
    RendererOptions options = small_options();
    options.chart_transport = ChartTransport::kPacked;
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(32, 32)};
    const TileDraw tile = upload_tile(*renderer, cube_tile({0, 0, 0}, {4, 4, 4}), charts);
    draw_or_fail(*renderer, make_camera({2, -9, 3}, 0, -5), std::span(&tile, 1));
    EXPECT_EQ(renderer->counts().page_tiles, 0u);
    EXPECT_EQ(renderer->counts().coordinate_bytes, 0u);
    EXPECT_GT(renderer->counts().mesh_draws, 0u);
}

TEST(ChartTransport, NamesAreThoseOfTheOption) {
    for (const ChartTransport transport : kChartTransports)
        EXPECT_EQ(chart_transport_named(chart_transport_name(transport)), transport);
    EXPECT_EQ(chart_transport_named("tables"), std::nullopt);
    EXPECT_EQ(chart_transport_names(), (std::vector<std::string>{"table", "uniform", "attribute", "packed"}));
}

class ChartCoordinatesOfBytes : public testing::Test {
  protected:
    void SetUp() override {
        mesh_ = codec::mesh::test::layer_of(mixed_boxes(4)).words();
        const auto pages = codec::atlas::encode_pages(mixed_charts(), small_pages());
        ASSERT_TRUE(pages.ok());
        table_ = (*pages)[0].words;
        table_.resize(page_table_words(table_));
    }
    std::vector<uint32_t> mesh_, table_;
};

TEST_F(ChartCoordinatesOfBytes, PackedWordsAreThoseOfTheCodec) {
    const auto packed = make_chart_coordinates(ChartTransport::kPacked, mesh_, table_);
    ASSERT_TRUE(packed.ok());
    const auto mesh = codec::mesh::ResidentMeshView::create(mesh_, 5);
    ASSERT_TRUE(mesh.ok());
    for (uint32_t triangle = 0; triangle < mesh->triangle_count(); ++triangle) {
        const uint32_t* words = &packed->words[size_t{COORDINATE_TRIANGLE_WORDS} * triangle];
        if ((words[0] & PAGES_CHART_FLAT) != 0) continue;
        for (uint32_t corner = 0; corner < 3; ++corner) {
            int32_t texcoord[2];
            mesh->texcoord(triangle, corner, texcoord);
            for (size_t axis = 0; axis < 2; ++axis) {
                const auto own = codec::atlas::decode_wrap_axis(words[1 + 2 * corner + axis], 0);
                const double left_out = texcoord[axis] / 65536.0 - own.place * codec::atlas::kWrapStep;
                EXPECT_EQ(left_out, std::floor(left_out)) << "whole repeats";
            }
        }
    }
}

TEST_F(ChartCoordinatesOfBytes, EveryPrefixIsRefused) {
    for (const ChartTransport transport : kChartTransports) {
        EXPECT_TRUE(make_chart_coordinates(transport, mesh_, table_).ok());
        for (size_t words = 0; words < table_.size(); ++words)
            EXPECT_FALSE(make_chart_coordinates(transport, mesh_, std::span(table_).first(words)).ok()) << words;
        for (size_t words = 0; words < mesh_.size(); words += 7)
            EXPECT_FALSE(make_chart_coordinates(transport, std::span(mesh_).first(words), table_).ok()) << words;
    }
}

TEST_F(ChartCoordinatesOfBytes, DamagedWordsNeverReadOutsideThem) {
    Random random;
    for (int round = 0; round < 2000; ++round) {
        std::vector<uint32_t> mesh = mesh_, table = table_;
        for (int i = 0; i < 3; ++i) {
            table[random.below(static_cast<uint32_t>(table.size()))] = random.next() >> random.below(32);
            mesh[random.below(static_cast<uint32_t>(mesh.size()))] ^= 1u << random.below(32);
        }
        const auto made = make_chart_coordinates(kChartTransports[round % 4], mesh, table);
        if (!made) continue;
        EXPECT_LE(made->runs.size(), 32 * mesh.size()) << "of triangles that the mesh has bits for";
    }
}

}  // namespace
}  // namespace citystream::client::test
