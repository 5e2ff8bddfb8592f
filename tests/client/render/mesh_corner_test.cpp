// Corners of resident meshes on the GPU against ResidentMeshView, word for word, through the include that draws.
#include "codec/mesh/mesh_resident.h"
#include "codec/mesh/strip_code.h"
#include "shaders/twin_mesh_corner.comp.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/codec/mesh/resident_contents.h"

namespace citystream::client::test {
namespace {

using namespace codec::mesh;

constexpr uint32_t kCharts = 5;

class MeshCornerTwin : public GpuTwin {
  protected:
    /// All corners of all ranges.
    void expect_same_corners(std::span<const uint32_t> words, const PositionView& camera, bool scattered) {
        const Result<ResidentMeshView> mesh = ResidentMeshView::create(words, kCharts);
        ASSERT_TRUE(mesh.ok()) << mesh.error().text();
        const LayerId layer = upload_words(words, scattered);
        uint32_t first = 0;
        for (uint32_t r = 0; r < mesh->ranges().size(); ++r) {
            const MeshRange& range = mesh->ranges()[r];
            std::vector<uint32_t> input;
            for (const int32_t c : camera.from_camera) input.push_back(static_cast<uint32_t>(c));
            input.push_back(camera.rule.distance_per_unit);
            input.push_back(camera.least_dropped);
            TwinConstants constants{};
            constants.count = 3 * range.triangles;
            constants.first = r;
            if (range.kind == RESIDENT_KIND_STRIP_CODE) {
                constants.second = 1;
                const auto corners = decode_strips(words.subspan(range.topology_begin, range.topology_words));
                for (const auto& triangle : *corners) input.insert(input.end(), triangle.begin(), triangle.end());
            }
            const auto gpu = run(k_twin_mesh_corner_comp, layer, constants, TWIN_CORNER_WORDS, input);
            for (uint32_t i = 0; i < constants.count; ++i) {
                SCOPED_TRACE("range " + std::to_string(r) + " corner " + std::to_string(i));
                ASSERT_EQ(cpu_words(*mesh, first + i / 3, i % 3, camera), words_of(gpu, i));
            }
            first += range.triangles;
        }
        forget_layers();
    }

  private:
    using Words = std::array<uint32_t, TWIN_CORNER_WORDS>;
    static Words words_of(std::span<const uint32_t> all, size_t i) {
        Words words{};
        std::copy_n(all.begin() + static_cast<ptrdiff_t>(i * TWIN_CORNER_WORDS), TWIN_CORNER_WORDS, words.begin());
        return words;
    }
    static Words cpu_words(const ResidentMeshView& mesh, uint32_t triangle, uint32_t k, const PositionView& camera) {
        const ResidentCorner corner = mesh.corner(triangle, k, camera);
        int32_t texcoord[2];
        mesh.texcoord(triangle, k, texcoord);
        Words words{};
        for (size_t c = 0; c < 3; ++c) {
            words[c] = static_cast<uint32_t>(corner.position[c]);
            words[3 + c] = static_cast<uint32_t>(corner.normal[c]);
        }
        words[6] = corner.chart_entry;
        words[7] = corner.texcoord;
        for (size_t c = 0; c < 2; ++c) words[8 + c] = static_cast<uint32_t>(texcoord[c]);
        return words;
    }
};

TEST_F(MeshCornerTwin, CornersOfAllKindsAreTheSameIntegersAtEveryStep) {
    uint32_t seed = 1;
    for (const MeshTopology topology : {MeshTopology::kIndices, MeshTopology::kLocalStrips, MeshTopology::kStripCode}) {
        for (const bool textured : {false, true}) {
            for (const bool constrained : {false, true}) {
                const ContentKind kind{.textured = textured, .topology = topology, .constrained = constrained};
                const ResidentMesh mesh = make_resident(random_content(terrain_mesh(20), kind, seed++));
                for (uint32_t steps = 1; steps <= 3; ++steps) {
                    expect_same_corners(mesh.with_steps(steps), near_view(3), seed % 2 == 0);
                    expect_same_corners(mesh.with_steps(steps), {{-90000, 1 << 19, -40}, {700, RESIDENT_CELL_BITS}, 0},
                                        seed % 2 == 1);
                }
            }
        }
    }
}

TEST_F(MeshCornerTwin, NormalsOfEveryWidthAreTheSameIntegers) {
    for (uint32_t bits = kLeastMeshNormalBits; bits <= kMostMeshNormalBits; ++bits) {
        const ContentKind kind{.charts = 1 + bits % 2, .normal_bits = bits, .dropped = {0}};
        const ResidentMesh mesh = make_resident(random_content(terrain_mesh(9), kind, bits));
        expect_same_corners(mesh.with_steps(1), near_view(), true);
    }
}

TEST_F(MeshCornerTwin, PositionsOfEveryWidthAreTheSameIntegers) {
    for (uint32_t bits = 2; bits < 29; ++bits) {
        const ContentKind kind{.textured = false, .smooth = false, .dropped = {0}};
        const MeshContent content = random_content(soup_mesh(90, 60, 1u << bits, bits), kind, bits);
        const PositionView camera{{-5000, 900, -(1 << 20)}, {250, RESIDENT_CELL_BITS}, bits % 5};
        expect_same_corners(make_resident(content).with_steps(1), camera, false);
    }
}

}  // namespace
}  // namespace citystream::client::test
