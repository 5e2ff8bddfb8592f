// Corners of resident meshes of all kinds, steps and widths on the GPU against the CPU.
#include "tests/client/render/mesh_corner_twin.h"
#include "tests/codec/mesh/resident_contents.h"

namespace citystream::client::test {
namespace {

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
